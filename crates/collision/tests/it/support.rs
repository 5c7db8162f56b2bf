//! Shapes in few words, placements, and parry as the second opinion.

use nalgebra::{Vector2, Vector3};
use parry2d_f64::{
    math,
    query::{self, NonlinearRigidMotion},
    shape::{ConvexPolygon, SharedShape},
};
use tangency_collision::{
    Collider, CollisionError, Contact, Placed, Pose, Shape, contacts, convex_hull, pose,
};

pub(crate) fn circle(radius: f64) -> Shape {
    Shape::Circle { radius, center: [0.0; 2] }
}

pub(crate) fn rectangle(width: f64, height: f64) -> Shape {
    Shape::Rectangle { width, height, center: [0.0; 2], angle: 0.0 }
}

/// Along the first axis, `length` between the centres of its ends.
pub(crate) fn capsule(length: f64, radius: f64) -> Shape {
    Shape::Capsule { a: [-length / 2.0, 0.0], b: [length / 2.0, 0.0], radius }
}

pub(crate) fn ground() -> Shape {
    Shape::HalfPlane { normal: [0.0, 1.0], offset: 0.0 }
}

pub(crate) fn at(x: f64, y: f64, angle: f64) -> Pose {
    Pose::new(x, y, angle)
}

pub(crate) fn collider(shape: &Shape) -> Collider {
    Collider::new(std::slice::from_ref(shape)).expect("a valid shape")
}

/// Contacts of two bodies of one shape each.
pub(crate) fn try_pair(
    (a, pose_a): (&Shape, Pose),
    (b, pose_b): (&Shape, Pose),
    reach: f64,
) -> Result<Vec<Contact>, CollisionError> {
    let (a, b) = (collider(a), collider(b));
    let bodies = [Placed { collider: &a, pose: pose_a }, Placed { collider: &b, pose: pose_b }];
    contacts(&bodies, reach, &|_, _| true)
}

pub(crate) fn pair(a: (&Shape, Pose), b: (&Shape, Pose), reach: f64) -> Vec<Contact> {
    try_pair(a, b, reach).expect("contacts of valid placements")
}

/// Distance by parry's GJK; `None` where parry has no such shape.
pub(crate) fn parry_distance(a: (&Shape, Pose), b: (&Shape, Pose)) -> Option<f64> {
    let (place_a, solid_a) = solid(a.0)?;
    let (place_b, solid_b) = solid(b.0)?;
    let (pose_a, pose_b) = (glam(&a.1) * place_a, glam(&b.1) * place_b);
    Some(query::distance(&pose_a, &*solid_a, &pose_b, &*solid_b).ok()?.distance)
}

/// Distance of two shapes whose cores are apart, by trying all vertices against all edges.
pub(crate) fn edge_distance(a: (&Shape, Pose), b: (&Shape, Pose)) -> f64 {
    let ((core_a, r_a), (core_b, r_b)) = (core(a), core(b));
    let one_way = |from: &[Vector2<f64>], to: &[Vector2<f64>]| {
        let edges = to.iter().zip(to.iter().cycle().skip(1));
        let each = edges.flat_map(|(p, q)| from.iter().map(move |x| from_segment(x, p, q)));
        each.fold(f64::INFINITY, f64::min)
    };
    one_way(&core_a, &core_b).min(one_way(&core_b, &core_a)) - r_a - r_b
}

fn from_segment(x: &Vector2<f64>, p: &Vector2<f64>, q: &Vector2<f64>) -> f64 {
    let e = q - p;
    let s = (x - p).dot(&e) / e.norm_squared();
    let s = if s.is_nan() { 0.0 } else { s.clamp(0.0, 1.0) }; // a circle's edge is a point
    (x - p - e * s).norm()
}

/// Vertices of the core in the world, and the radius around it.
fn core((shape, place): (&Shape, Pose)) -> (Vec<Vector2<f64>>, f64) {
    let vector = |p: &[f64; 2]| Vector2::new(p[0], p[1]);
    let (local, radius) = match shape {
        Shape::Circle { radius, center } => (vec![vector(center)], *radius),
        Shape::Capsule { a, b, radius } => (vec![vector(a), vector(b)], *radius),
        Shape::Polygon { points } => {
            (convex_hull(points).iter().map(|&i| vector(&points[i])).collect(), 0.0)
        }
        Shape::Rectangle { width, height, center, angle } => {
            let frame = at(center[0], center[1], *angle);
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corner =
                |(x, y)| pose::point(&frame, &Vector2::new(x * width / 2.0, y * height / 2.0));
            (corners.map(corner).to_vec(), 0.0)
        }
        Shape::HalfPlane { .. } => (Vec::new(), 0.0),
    };
    (local.iter().map(|l| pose::point(&place, l)).collect(), radius)
}

/// Time of impact by parry's nonlinear cast.
pub(crate) fn parry_impact(
    a: (&Shape, Pose, Vector3<f64>),
    b: (&Shape, Pose, Vector3<f64>),
    horizon: f64,
) -> Option<(String, f64)> {
    let motion = |(shape, pose, v): (&Shape, Pose, Vector3<f64>)| {
        let (place, solid) = solid(shape)?;
        let linear = math::Vector::new(v.x, v.y);
        let motion = NonlinearRigidMotion::new(glam(&pose), math::Vector::ZERO, linear, v.z);
        Some((motion.prepend(place), solid))
    };
    let ((m, s), (n, t)) = (motion(a)?, motion(b)?);
    let hit = query::cast_shapes_nonlinear(&m, &*s, &n, &*t, 0.0, horizon, true).ok()?;
    hit.map(|hit| (format!("{:?}", hit.status), hit.time_of_impact))
}

fn glam(p: &Pose) -> math::Pose {
    math::Pose::new(math::Vector::new(p.x, p.y), p.z)
}

fn solid(shape: &Shape) -> Option<(math::Pose, SharedShape)> {
    let vector = |p: &[f64; 2]| math::Vector::new(p[0], p[1]);
    Some(match shape {
        Shape::Circle { radius, center } => {
            (math::Pose::from_translation(vector(center)), SharedShape::ball(*radius))
        }
        Shape::Rectangle { width, height, center, angle } => (
            glam(&pose::compose(&Pose::zeros(), &at(center[0], center[1], *angle))),
            SharedShape::cuboid(width / 2.0, height / 2.0),
        ),
        Shape::Polygon { points } => {
            // Parry's own hull drops vertices that stick out little.
            let hull = convex_hull(points).into_iter().map(|i| vector(&points[i])).collect();
            let polygon = ConvexPolygon::from_convex_polyline_unmodified(hull)?;
            (math::Pose::IDENTITY, SharedShape::new(polygon))
        }
        Shape::Capsule { a, b, radius } => {
            (math::Pose::IDENTITY, SharedShape::capsule(vector(a), vector(b), *radius))
        }
        Shape::HalfPlane { .. } => return None,
    })
}
