//! Joints as lines and dots.

use tangency_collision::Pose;
use tangency_collision::pose::{direction, point};

use crate::canvas::Canvas;
use crate::clip::Point;
use crate::joint_look::{JointLook, Link, Rail};
use crate::palette::{Inks, Rgb};

/// Widths of lines and sizes, in units.
const LINE: f64 = 2.0;
const THIN: f64 = 1.3;
const PIN: f64 = 2.6;
const COIL: f64 = 5.0;
/// How far a rail without end goes on a body; in the world it crosses the picture.
const RAIL: f64 = 60.0;
const TURNS: u32 = 9;

/// One joint, its pins filled with the background.
pub(crate) fn draw_joint(
    canvas: &mut Canvas,
    joint: &JointLook,
    q: &[Pose],
    inks: &Inks,
    background: Rgb,
) {
    let [a, b] = [0, 1].map(|end| {
        let local = joint.ends[end].into();
        canvas.pixel(joint.bodies[end].map_or(local, |body| point(&q[body], &local)).into())
    });
    match (joint.kind, &joint.rail) {
        (_, Some(rail)) => {
            let turn = joint.bodies[0].map(|body| q[body]);
            let ends = rail_ends(canvas, rail, turn.as_ref(), a);
            canvas.dashed(ends, inks.soft, THIN);
        }
        (Link::Spring, None) => canvas.lines(&coil(a, b, COIL * canvas.unit()), inks.ink, THIN),
        (Link::Rod, None) => canvas.line([a, b], inks.ink, LINE),
        // Ends that are apart show that the joint has drifted.
        (Link::Pin | Link::Weld, None) => canvas.line([a, b], inks.accent, LINE),
    }
    for end in [a, b] {
        for (size, ink) in [(PIN + THIN, inks.ink), (PIN, background)] {
            canvas.fill(&pin(end, size * canvas.unit(), joint.kind), ink);
        }
    }
}

/// From where to where b may travel; `frame` is a's pose, absent if a is the world.
fn rail_ends(canvas: &Canvas, rail: &Rail, frame: Option<&Pose>, [x, y]: Point) -> [Point; 2] {
    let axis = rail.axis.into();
    let n = frame.map_or(axis, |pose| direction(pose, &axis));
    let endless = if frame.is_some() {
        RAIL * canvas.unit()
    } else {
        let [w, h] = canvas.middle();
        4.0 * (w + h)
    };
    let lower = rail.lower.map_or(-endless, |s| canvas.length(s));
    let upper = rail.upper.map_or(endless, |s| canvas.length(s));
    [lower, upper].map(|s| [x + s * n.x, y - s * n.y])
}

/// A zigzag of so many pixels to both sides between a tenth and nine tenths of the way.
fn coil(a: Point, b: Point, width: f64) -> Vec<Point> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length = d[0].hypot(d[1]);
    if length == 0.0 {
        return vec![a];
    }
    let [u, v] = d.map(|x| x / length);
    let bend = |k: u32| {
        let s = (0.1 + 0.8 * (f64::from(k) + 0.5) / f64::from(2 * TURNS)) * length;
        let side = if k % 2 == 1 { width } else { -width };
        [a[0] + u * s - v * side, a[1] + v * s + u * side]
    };
    [a].into_iter().chain((0..2 * TURNS).map(bend)).chain([b]).collect()
}

/// A square where nothing can turn, else a disc.
fn pin([x, y]: Point, r: f64, kind: Link) -> Vec<Point> {
    let corners: u32 = if kind == Link::Weld { 4 } else { 16 };
    let corner = |k: u32| {
        let (s, c) = (std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(corners)).sin_cos();
        [x + r * c, y + r * s]
    };
    (0..corners).map(corner).collect()
}
