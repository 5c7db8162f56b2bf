//! The replay page: one HTML file that plays runs of a scene on a canvas, without a network.

use serde::{Serialize, Serializer};
use tangency_core::{Scene, State};

use crate::joint_look::{JointLook, Link};
use crate::look::{BodyLook, Form};
use crate::palette::{HUES, css};
use crate::{Frame, Push, Run, View};

const TEMPLATE: &str = include_str!("replay.html");

/// Poses that one page holds at most, over all bodies and frames; beyond, frames are left out.
const MOST_POSES: usize = 150_000;

/// A page that plays `runs` of `scene`: the first one solid, the others as outlines over it.
///
/// Frames are left out at a constant stride where the page would grow too large; a frame then
/// shows the hardest pushes since the one before.
#[must_use]
pub fn replay_html(title: &str, scene: &Scene, runs: &[Run]) -> String {
    let page = Page::new(title, scene, runs);
    let data = serde_json::to_string(&page).unwrap_or_default();
    // `</script>` in a text would end the data; JSON may write `/` as `\/`.
    TEMPLATE.replace("@TITLE@", &escape_html(title)).replace("@DATA@", &data.replace("</", "<\\/"))
}

/// A text as it stands between tags.
#[must_use]
pub fn escape_html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// What the page's script reads.
#[derive(Serialize)]
struct Page<'a> {
    title: &'a str,
    description: &'a str,
    /// Steps per frame.
    stride: usize,
    hues: [String; HUES.len()],
    /// Lower and upper corner of what is shown.
    view: [[Short; 2]; 2],
    /// Bodies whose poses every frame lists.
    moving: Vec<usize>,
    bodies: Vec<PageBody<'a>>,
    joints: Vec<PageJoint>,
    runs: Vec<PageRun<'a>>,
}

#[derive(Serialize)]
struct PageBody<'a> {
    name: &'a str,
    /// Whether nothing can push it.
    fixed: bool,
    kinematic: bool,
    /// Index into the page's colours.
    hue: usize,
    /// Pose at the start.
    pose: [Short; 3],
    /// Length of the mark that shows the angle.
    mark: Short,
    shapes: Vec<PageShape>,
}

/// A shape in its body's centre-of-mass frame; the script knows the kinds by their keys.
#[derive(Serialize)]
#[serde(untagged)]
enum PageShape {
    Circle { c: [Short; 2], r: Short },
    Capsule { a: [Short; 2], b: [Short; 2], r: Short },
    Polygon { points: Vec<[Short; 2]> },
    HalfPlane { halfplane: bool, n: [Short; 2], offset: Short },
}

#[derive(Serialize)]
struct PageJoint {
    kind: Link,
    /// −1 is the world.
    bodies: [i64; 2],
    /// Anchors in the bodies' frames.
    ends: [[Short; 2]; 2],
    /// Direction in a's frame that b may travel along.
    axis: Option<[Short; 2]>,
    lower: Option<Short>,
    upper: Option<Short>,
}

#[derive(Serialize)]
struct PageRun<'a> {
    name: &'a str,
    times: Vec<Short>,
    energy: Vec<Short>,
    /// Per frame x, y, angle of every moving body.
    poses: Vec<Vec<Short>>,
    /// Per frame x, y and both components of every push.
    impulses: Vec<Vec<Short>>,
}

/// A number with six significant digits, written as briefly as JSON allows.
#[derive(Clone, Copy)]
struct Short(f64);

impl Serialize for Short {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rounded: f64 = format!("{:.5e}", self.0).parse().unwrap_or(self.0);
        if rounded.fract() == 0.0 && rounded.abs() < 1e15 {
            #[expect(clippy::cast_possible_truncation, reason = "a whole number below 1e15")]
            return serializer.serialize_i64(rounded as i64);
        }
        serializer.serialize_f64(rounded)
    }
}

fn short<const N: usize>(numbers: impl Into<[f64; N]>) -> [Short; N] {
    numbers.into().map(Short)
}

impl<'a> Page<'a> {
    fn new(title: &'a str, scene: &'a Scene, runs: &'a [Run]) -> Self {
        let (looks, joints) = (BodyLook::all(scene), JointLook::all(scene));
        let moving: Vec<usize> = (0..looks.len()).filter(|i| looks[*i].moves()).collect();
        let frames = || runs.iter().flat_map(|run| &run.frames);
        let stride = (frames().count() * moving.len()).div_ceil(MOST_POSES).max(1);
        let states: Vec<&State> = frames().map(|frame| &frame.state).collect();
        let View { lower, upper } = View::around(scene, &looks, &joints, &states);
        Self {
            title,
            description: &scene.def().description,
            stride,
            hues: HUES.map(css),
            view: [short(lower), short(upper)],
            bodies: looks
                .iter()
                .enumerate()
                .map(|(i, look)| PageBody::new(scene, i, look))
                .collect(),
            joints: joints.iter().map(PageJoint::new).collect(),
            runs: runs.iter().map(|run| PageRun::new(run, &moving, stride)).collect(),
            moving,
        }
    }
}

impl<'a> PageBody<'a> {
    fn new(scene: &'a Scene, index: usize, look: &BodyLook) -> Self {
        Self {
            name: &scene.bodies()[index].name,
            fixed: look.fixed,
            kinematic: look.kinematic,
            hue: look.hue,
            pose: short(scene.initial_state().q[index]),
            mark: Short(look.mark),
            shapes: look.forms.iter().map(PageShape::of).collect(),
        }
    }
}

impl PageShape {
    fn of(form: &Form) -> Self {
        match form {
            Form::Circle { center, radius } => {
                Self::Circle { c: short(*center), r: Short(*radius) }
            }
            Form::Capsule { a, b, radius } => {
                Self::Capsule { a: short(*a), b: short(*b), r: Short(*radius) }
            }
            Form::Polygon { points } => {
                Self::Polygon { points: points.iter().map(|p| short(*p)).collect() }
            }
            Form::HalfPlane { normal, offset } => {
                Self::HalfPlane { halfplane: true, n: short(*normal), offset: Short(*offset) }
            }
        }
    }
}

impl PageJoint {
    fn new(joint: &JointLook) -> Self {
        let rail = joint.rail.as_ref();
        Self {
            kind: joint.kind,
            bodies: joint.bodies.map(|b| b.and_then(|b| b.try_into().ok()).unwrap_or(-1)),
            ends: joint.ends.map(short),
            axis: rail.map(|rail| short(rail.axis)),
            lower: rail.and_then(|rail| rail.lower).map(Short),
            upper: rail.and_then(|rail| rail.upper).map(Short),
        }
    }
}

impl<'a> PageRun<'a> {
    fn new(run: &'a Run, moving: &[usize], stride: usize) -> Self {
        let shown: Vec<&Frame> = run.frames.iter().step_by(stride).collect();
        let pose = |frame: &Frame| moving.iter().flat_map(|i| short(frame.state.q[*i])).collect();
        let windows = (0..shown.len()).map(|k| {
            let last = k * stride;
            &run.frames[(last + 1).saturating_sub(stride)..=last]
        });
        Self {
            name: &run.name,
            times: shown.iter().map(|frame| Short(frame.state.time)).collect(),
            energy: shown.iter().map(|frame| Short(frame.energy)).collect(),
            poses: shown.iter().map(|frame| pose(frame)).collect(),
            impulses: windows.map(hardest_pushes).collect(),
        }
    }
}

/// The pushes of the frame with the greatest total impulse.
fn hardest_pushes(frames: &[Frame]) -> Vec<Short> {
    let size = |push: &Push| push.impulse[0].hypot(push.impulse[1]);
    let total = |frame: &&Frame| frame.pushes.iter().map(size).sum::<f64>();
    let hardest = frames.iter().max_by(|a, b| total(a).total_cmp(&total(b)));
    let pushes = hardest.map_or(&[][..], |frame| &frame.pushes);
    pushes
        .iter()
        .flat_map(|push| short([push.point[0], push.point[1], push.impulse[0], push.impulse[1]]))
        .collect()
}
