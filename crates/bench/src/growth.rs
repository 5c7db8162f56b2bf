//! Time per step over the size of a scene.

use std::time::Duration;

use tangency_core::SceneDef;

use crate::engine::{Engine, Refusal};
use crate::scenes;
use crate::timing::{Patience, Quartiles, Work, interleaved, timed};

/// Scenes of one kind and growing size.
pub struct Family {
    /// Its name.
    pub name: &'static str,
    /// Number of dynamic bodies, and the scene.
    pub members: Vec<(usize, SceneDef)>,
}

/// Chains let go from level, up to so many links, and pyramids at rest, up to so many rows; dt = 1/60 s.
#[must_use]
pub fn families(links: usize, rows: usize) -> [Family; 2] {
    let dt = 1.0 / 60.0;
    let lengths = [10, 30, 100, 300, 1000, 3000, 10_000].into_iter().filter(|n| *n <= links);
    let chains = lengths.map(|n| (n, SceneDef { dt, ..scenes::race_chain(n) }));
    let bases = [4, 7, 10, 14, 20, 31, 44, 63, 99].into_iter().filter(|base| *base <= rows);
    let pyramids = bases.map(|b| (b * (b + 1) / 2, SceneDef { dt, ..scenes::pyramid(b) }));
    [
        Family { name: "chain", members: chains.collect() },
        Family { name: "pyramid", members: pyramids.collect() },
    ]
}

/// A point of a growth curve.
#[derive(Debug)]
pub struct Size {
    /// Dynamic bodies.
    pub bodies: usize,
    /// Steps timed per round.
    pub steps: usize,
    /// Time per step, s, or why there is none.
    pub step: Result<Quartiles, Left>,
}

/// Why a size was not measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Left {
    /// It would take too long.
    #[error("left out: one step would take about {0:.1?}, more than the cap")]
    TooSlow(Duration),
    /// The engine refused.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

/// One engine's curve.
#[derive(Debug)]
pub struct Curve {
    /// The engine.
    pub engine: String,
    /// Its points, the smallest first.
    pub sizes: Vec<Size>,
}

/// Most steps per run.
const STEPS: usize = 30;

/// Measures a family. After a size whose step took longer than a quarter of the cap allows for, the
/// next is predicted by the square of the ratio and left out if that exceeds the cap.
#[must_use]
pub fn grow(family: &Family, engine: &dyn Engine, patience: &Patience) -> Curve {
    let mut sizes: Vec<Size> = Vec::new();
    let mut last: Option<(usize, Duration)> = None;
    for (bodies, def) in &family.members {
        let guess = last
            .map_or(Duration::ZERO, |(n, step)| step.mul_f64((*bodies as f64 / n as f64).powi(2)));
        let (steps, step) = if guess > patience.cap {
            (0, Err(Left::TooSlow(guess)))
        } else {
            measure(def, engine, patience, &mut last, *bodies)
        };
        sizes.push(Size { bodies: *bodies, steps, step });
    }
    Curve { engine: engine.name(), sizes }
}

fn measure(
    def: &SceneDef,
    engine: &dyn Engine,
    patience: &Patience,
    last: &mut Option<(usize, Duration)>,
    bodies: usize,
) -> (usize, Result<Quartiles, Left>) {
    let steps = match try_out(def, engine, patience) {
        Ok((steps, spent)) => {
            *last = Some((bodies, spent / u32::try_from(steps).unwrap_or(u32::MAX)));
            steps
        }
        Err(refusal) => return (0, Err(refusal.into())),
    };
    let work: Work<'_, Refusal> = Box::new(move || {
        let mut world = engine.build(def)?;
        let (time, result) = timed(|| (0..steps).try_for_each(|_| world.step()));
        result.map(|()| time)
    });
    let time = interleaved(vec![work], patience).pop().unwrap_or_else(|| Ok(Quartiles::default()));
    (steps, time.map(|time| time.scaled(1.0 / steps as f64)).map_err(Left::from))
}

/// Steps that fit under the cap, at most [`STEPS`], and how long they took.
fn try_out(
    def: &SceneDef,
    engine: &dyn Engine,
    patience: &Patience,
) -> Result<(usize, Duration), Refusal> {
    let mut world = engine.build(def)?;
    let (mut steps, mut spent) = (0, Duration::ZERO);
    while steps < STEPS && spent < patience.cap {
        let (time, result) = timed(|| world.step());
        result?;
        (steps, spent) = (steps + 1, spent + time);
    }
    Ok((steps, spent))
}

impl Curve {
    /// The exponent p of time ∝ nᵖ by least squares on logarithms, over sizes of at least `least`
    /// bodies; `None` with fewer than two of them.
    #[must_use]
    pub fn exponent(&self, least: usize) -> Option<f64> {
        let large = self.sizes.iter().filter(|size| size.bodies >= least);
        let point = |size: &Size| {
            let step = size.step.as_ref().ok()?.least;
            Some(((size.bodies as f64).ln(), step.ln()))
        };
        let points: Vec<(f64, f64)> = large.filter_map(point).collect();
        slope(&points)
    }
}

/// The slope of the line of least squares.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let square: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    (points.len() > 1 && square > 0.0).then(|| cross / square)
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn slope_of_a_line() {
        assert_eq!(slope(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]), Some(2.0));
        assert_eq!(slope(&[(1.0, 1.0)]), None);
    }
}
