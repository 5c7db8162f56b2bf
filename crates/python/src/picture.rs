//! Pictures and replay pages.

use numpy::{IntoPyArray, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use tangency::{Scene, State};
use tangency_view::{Image, Picture, Run, Style, View, replay_html};

use crate::errors;

/// What part of the world is shown, as Python says it: x from, to, y from, to.
pub(crate) type Corners = (f64, f64, f64, f64);

/// Greatest length of a page inside of a notebook, bytes; larger ones would make the notebook slow.
const LONGEST_INLINE: usize = 3_000_000;

/// The view that was asked for; one that holds `states` otherwise.
pub(crate) fn view<'a>(
    scene: &Scene,
    given: Option<Corners>,
    states: impl IntoIterator<Item = &'a State>,
) -> PyResult<View> {
    match given {
        Some((left, right, low, high)) => Ok(View { lower: [left, low], upper: [right, high] }),
        None => View::fit(scene, states).map_err(errors::value),
    }
}

/// A scene at a state.
pub(crate) fn draw(
    py: Python<'_>,
    scene: &Scene,
    state: &State,
    (width, height): (u32, u32),
    view: View,
) -> PyResult<Image> {
    let picture = Picture { width, height, view, style: Style::default() };
    py.detach(|| picture.draw(scene, state)).map_err(errors::value)
}

/// Its pixels, (height, width, 3).
pub(crate) fn rgb<'py>(py: Python<'py>, image: &Image) -> PyResult<Bound<'py, PyArray3<u8>>> {
    let shape = [image.height(), image.width(), 3].map(|side| side as usize);
    image.to_rgb().into_pyarray(py).reshape(shape)
}

/// The page that plays a run; named after its scene unless it has a title.
pub(crate) fn page(scene: &Scene, run: &tangency::Rollout, title: Option<&str>) -> String {
    let name = match &scene.def().name[..] {
        "" => "Replay",
        name => name,
    };
    replay_html(title.unwrap_or(name), scene, &[Run::from_rollout("run", scene, run)])
}

/// A page inside of a frame, as notebooks show it; of one that is too long, what to do.
pub(crate) fn inline(page: &str) -> String {
    if page.len() > LONGEST_INLINE {
        let megabytes = page.len() / 1_000_000;
        return format!(
            "<p>The replay page has {megabytes} MB: see it with <code>save_replay</code>.</p>"
        );
    }
    let quoted = page.replace('&', "&amp;").replace('"', "&quot;");
    format!(
        "<iframe srcdoc=\"{quoted}\" sandbox=\"allow-scripts\" width=\"100%\" height=\"560\" \
         style=\"border: 0\"></iframe>"
    )
}
