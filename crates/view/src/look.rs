//! How bodies look, whoever draws them: the page's script or [`Picture`](crate::Picture).

use std::collections::BTreeMap;

use tangency_collision::convex_hull;
use tangency_core::{BodyKind, Scene, Shape};

/// How a body looks in its centre-of-mass frame.
#[derive(Clone, Debug)]
pub(crate) struct BodyLook {
    /// Whether nothing can push it.
    pub(crate) fixed: bool,
    /// Whether it moves as it was told.
    pub(crate) kinematic: bool,
    /// Which colour, by number.
    pub(crate) hue: usize,
    /// Of the circle about the centre of mass that holds all its bounded shapes, m.
    pub(crate) radius: f64,
    /// How far the mark that shows the angle goes along the body's x, m.
    pub(crate) mark: f64,
    pub(crate) forms: Vec<Form>,
}

/// A shape as it is drawn: no more kinds than there are ways to draw.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Form {
    Circle { center: [f64; 2], radius: f64 },
    Capsule { a: [f64; 2], b: [f64; 2], radius: f64 },
    Polygon { points: Vec<[f64; 2]> },
    HalfPlane { normal: [f64; 2], offset: f64 },
}

impl BodyLook {
    /// The looks of all bodies, in the scene's order.
    pub(crate) fn all(scene: &Scene) -> Vec<Self> {
        let hues = hues(scene);
        let looks = scene.bodies().iter().zip(scene.colliders()).zip(hues);
        looks.map(|((body, collider), hue)| Self::new(body.kind, collider.shapes(), hue)).collect()
    }

    fn new(kind: BodyKind, shapes: &[Shape], hue: usize) -> Self {
        let forms: Vec<Form> = shapes.iter().map(Form::of).collect();
        Self {
            fixed: kind != BodyKind::Dynamic,
            kinematic: kind == BodyKind::Kinematic,
            hue,
            radius: forms.iter().map(Form::farthest).fold(0.0, f64::max),
            mark: shapes.iter().zip(&forms).map(mark).fold(0.0, f64::max),
            forms,
        }
    }

    /// Whether it is drawn where the state says, with a mark.
    pub(crate) fn moves(&self) -> bool {
        !self.fixed || self.kinematic
    }
}

/// Bodies of one group share a colour; others take the next one. What is fixed uses none up.
fn hues(scene: &Scene) -> Vec<usize> {
    let mut of_group: BTreeMap<&str, usize> = BTreeMap::new();
    let mut next = 0;
    let mut hue = |index: usize| {
        let group = scene.bodies()[index].groups.first();
        if let Some(hue) = group.and_then(|group| of_group.get(group.as_str())) {
            return *hue;
        }
        let hue = next;
        group.map(|group| of_group.insert(group, hue));
        next += usize::from(scene.is_dynamic(index));
        hue
    };
    (0..scene.bodies().len()).map(&mut hue).collect()
}

/// Length of the mark in the body's x direction: to the rim of a disc, part of the way in others.
fn mark((shape, form): (&Shape, &Form)) -> f64 {
    match shape {
        Shape::Circle { radius, .. } => *radius,
        Shape::Capsule { radius, .. } => 0.8 * radius,
        Shape::Rectangle { width, height, .. } => 0.35 * width.min(*height),
        Shape::Polygon { .. } => 0.35 * form.farthest(),
        Shape::HalfPlane { .. } => 0.0,
    }
}

impl Form {
    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Circle { radius, center } => Self::Circle { center: *center, radius: *radius },
            Shape::Capsule { a, b, radius } => Self::Capsule { a: *a, b: *b, radius: *radius },
            Shape::Rectangle { width, height, center, angle } => {
                Self::Polygon { points: corners([*width, *height], *center, *angle).into() }
            }
            Shape::Polygon { points } => {
                let hull = convex_hull(points);
                Self::Polygon { points: hull.into_iter().map(|i| points[i]).collect() }
            }
            Shape::HalfPlane { normal: [x, y], offset } => {
                let length = x.hypot(*y);
                Self::HalfPlane { normal: [x / length, y / length], offset: *offset }
            }
        }
    }

    /// Greatest distance of a bounded form's points from the origin, m.
    fn farthest(&self) -> f64 {
        let norm = |[x, y]: &[f64; 2]| x.hypot(*y);
        match self {
            Self::Circle { center, radius } => norm(center) + radius,
            Self::Capsule { a, b, radius } => norm(a).max(norm(b)) + radius,
            Self::Polygon { points } => points.iter().map(norm).fold(0.0, f64::max),
            Self::HalfPlane { .. } => 0.0,
        }
    }
}

fn corners([width, height]: [f64; 2], [x, y]: [f64; 2], angle: f64) -> [[f64; 2]; 4] {
    let (s, c) = angle.sin_cos();
    [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
        .map(|[u, v]| [u * width, v * height])
        .map(|[u, v]| [x + c * u - s * v, y + s * u + c * v])
}
