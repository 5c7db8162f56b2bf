//! The replay page: one HTML file that plays runs of a scene on a canvas, without a network.

use serde::{Serialize, Serializer};
use tangency_core::measure::Measure;
use tangency_core::{BodyKind, Joint, JointDef, JointKind, Scene, Shape};

use crate::{Frame, Push, Run};

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
    /// Of the circle about the centre of mass that holds all its bounded shapes.
    radius: Short,
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
    kind: &'static str,
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
        let moves = |i: &usize| scene.bodies()[*i].kind != BodyKind::Static;
        let moving: Vec<usize> = (0..scene.bodies().len()).filter(moves).collect();
        let frames: usize = runs.iter().map(|run| run.frames.len()).sum();
        let stride = (frames * moving.len()).div_ceil(MOST_POSES).max(1);
        let joints = scene.joints().iter().zip(&scene.def().joints);
        Self {
            title,
            description: &scene.def().description,
            stride,
            bodies: (0..scene.bodies().len()).map(|i| PageBody::new(scene, i)).collect(),
            joints: joints.filter_map(|(joint, def)| PageJoint::new(joint, def)).collect(),
            runs: runs.iter().map(|run| PageRun::new(run, &moving, stride)).collect(),
            moving,
        }
    }
}

impl<'a> PageBody<'a> {
    fn new(scene: &'a Scene, index: usize) -> Self {
        let body = &scene.bodies()[index];
        let shapes = scene.colliders()[index].shapes();
        let radius = shapes.iter().map(farthest).fold(0.0, f64::max);
        Self {
            name: &body.name,
            fixed: body.kind != BodyKind::Dynamic,
            kinematic: body.kind == BodyKind::Kinematic,
            hue: hue(scene, index),
            pose: short(scene.initial_state().q[index]),
            radius: Short(radius),
            mark: Short(shapes.iter().map(reach_along_x).fold(0.0, f64::max)),
            shapes: shapes.iter().map(PageShape::of).collect(),
        }
    }
}

/// Bodies of one group share a colour; others take the next one.
fn hue(scene: &Scene, index: usize) -> usize {
    let group = |i: usize| scene.bodies()[i].groups.first();
    let first = match group(index) {
        Some(_) => (0..=index).find(|i| group(*i) == group(index)).unwrap_or(index),
        None => index,
    };
    let starts = |i: &usize| {
        scene.is_dynamic(*i)
            && (group(*i).is_none() || !(0..*i).any(|earlier| group(earlier) == group(*i)))
    };
    (0..first).filter(starts).count()
}

/// Greatest distance of a bounded shape's points from the origin.
fn farthest(shape: &Shape) -> f64 {
    let norm = |[x, y]: [f64; 2]| x.hypot(y);
    match shape {
        Shape::Circle { radius, center } => norm(*center) + radius,
        Shape::Capsule { a, b, radius } => norm(*a).max(norm(*b)) + radius,
        Shape::Rectangle { .. } | Shape::Polygon { .. } => {
            corners(shape).into_iter().map(norm).fold(0.0, f64::max)
        }
        Shape::HalfPlane { .. } => 0.0,
    }
}

/// Length of the mark in the body's x direction: to the rim of a disc, part of the way in others.
fn reach_along_x(shape: &Shape) -> f64 {
    match shape {
        Shape::Circle { radius, .. } => *radius,
        Shape::Capsule { radius, .. } => 0.8 * radius,
        Shape::Rectangle { width, height, .. } => 0.35 * width.min(*height),
        Shape::Polygon { .. } => 0.35 * farthest(shape),
        Shape::HalfPlane { .. } => 0.0,
    }
}

fn corners(shape: &Shape) -> Vec<[f64; 2]> {
    match shape {
        Shape::Rectangle { width, height, center: [x, y], angle } => {
            let (s, c) = angle.sin_cos();
            [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
                .map(|[u, v]| [u * width, v * height])
                .map(|[u, v]| [x + c * u - s * v, y + s * u + c * v])
                .into()
        }
        Shape::Polygon { points } => {
            tangency_collision::convex_hull(points).into_iter().map(|i| points[i]).collect()
        }
        Shape::Circle { .. } | Shape::Capsule { .. } | Shape::HalfPlane { .. } => Vec::new(),
    }
}

impl PageShape {
    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Circle { radius, center } => {
                Self::Circle { c: short(*center), r: Short(*radius) }
            }
            Shape::Capsule { a, b, radius } => {
                Self::Capsule { a: short(*a), b: short(*b), r: Short(*radius) }
            }
            Shape::Rectangle { .. } | Shape::Polygon { .. } => {
                Self::Polygon { points: corners(shape).into_iter().map(short).collect() }
            }
            Shape::HalfPlane { normal: [x, y], offset } => {
                let length = x.hypot(*y);
                let n = short([x / length, y / length]);
                Self::HalfPlane { halfplane: true, n, offset: Short(*offset) }
            }
        }
    }
}

impl PageJoint {
    /// How a joint is drawn; locks are not.
    fn new(joint: &Joint, def: &JointDef) -> Option<Self> {
        let kind = match def.kind {
            JointKind::Revolute { .. } => "revolute",
            JointKind::Weld { .. } => "weld",
            JointKind::Prismatic { .. } => "prismatic",
            JointKind::Distance { .. } => "distance",
            JointKind::Slot { .. } => "slot",
            JointKind::Spring { .. } => "spring",
            JointKind::Lock { .. } => return None,
        };
        let axis = joint.free.and_then(|row| match row.measure {
            Measure::World { axis } | Measure::OnA { axis_local: axis } => Some(short(axis)),
            Measure::Length | Measure::Angle => None,
        });
        Some(Self {
            kind,
            bodies: joint.bodies.map(|b| b.and_then(|b| b.try_into().ok()).unwrap_or(-1)),
            ends: joint.anchors.map(short),
            axis,
            lower: joint.limits.lower.map(Short),
            upper: joint.limits.upper.map(Short),
        })
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
