//! Every pair of shapes in placements whose contacts are known by hand.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4};

use approx::assert_relative_eq;
use nalgebra::Vector2;
use tangency_collision::{
    Collider, CollisionError, Contact, ContactId, Part, Placed, Pose, Shape, contacts,
};

use crate::support::{at, capsule, circle, collider, ground, pair, rectangle, try_pair};

/// Compares gap, normal and point of all contacts, in any order of the expected ones.
#[track_caller]
fn check(a: (&Shape, Pose), b: (&Shape, Pose), expected: &[(f64, [f64; 2], [f64; 2])]) {
    compare(&pair(a, b, 0.5), expected, 1.0);
    compare(&pair(b, a, 0.5), expected, -1.0);
}

#[track_caller]
fn compare(found: &[Contact], expected: &[(f64, [f64; 2], [f64; 2])], sign: f64) {
    assert_eq!(found.len(), expected.len(), "{found:#?}");
    for &(gap, normal, point) in expected {
        let near = |c: &&Contact| (c.point - Vector2::from(point)).norm() < 1e-9;
        let contact = found.iter().find(near).unwrap_or_else(|| panic!("{point:?} in {found:#?}"));
        assert_relative_eq!(contact.gap, gap, epsilon = 1e-12);
        assert_relative_eq!(contact.normal, Vector2::from(normal) * sign, epsilon = 1e-12);
    }
}

const UP: [f64; 2] = [0.0, 1.0];
const RIGHT: [f64; 2] = [1.0, 0.0];

#[test]
fn circle_on_circle() {
    let disc = circle(1.0);
    let apart = (&circle(0.5), at(1.2, 1.6, 0.3)); // centres 2 apart along (0.6, 0.8)
    check((&disc, at(0.0, 0.0, 1.0)), apart, &[(0.5, [0.6, 0.8], [0.75, 1.0])]);
    check((&disc, at(0.0, 0.0, 0.0)), (&disc, at(0.0, 1.5, 0.0)), &[(-0.5, UP, [0.0, 0.75])]);
    assert!(pair((&disc, at(0.0, 0.0, 0.0)), (&disc, at(0.0, 3.0, 0.0)), 0.5).is_empty());
}

#[test]
fn circle_on_half_plane() {
    let plane = (&ground(), at(0.0, 0.0, 0.0));
    check(plane, (&circle(0.5), at(3.0, 0.7, 2.0)), &[(0.2, UP, [3.0, 0.1])]);
    check(plane, (&circle(0.5), at(3.0, -4.0, 2.0)), &[(-4.5, UP, [3.0, -2.25])]);
    // A slope of 45° through (0, 1), its normal given with length 2√2.
    let slope = Shape::HalfPlane { normal: [-2.0, 2.0], offset: FRAC_1_SQRT_2 };
    let expected = (2.0_f64.sqrt() - 1.0, [-FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    let foot = (2.0_f64.sqrt() - 1.0) / 2.0 * FRAC_1_SQRT_2;
    let point = [-foot, 1.0 + foot];
    let disc = (&circle(1.0), at(-1.0, 2.0, 0.0));
    check((&slope, at(0.0, 0.0, 0.0)), disc, &[(expected.0, expected.1, point)]);
}

#[test]
fn circle_on_rectangle() {
    let slab = rectangle(4.0, 2.0);
    let slab = (&slab, at(0.0, 0.0, 0.0));
    check(slab, (&circle(0.5), at(1.0, 1.8, 0.0)), &[(0.3, UP, [1.0, 1.15])]);
    // Beyond the corner (2, 1), along (0.6, 0.8).
    let corner = (&circle(0.5), at(2.36, 1.48, 0.0));
    check(slab, corner, &[(0.1, [0.6, 0.8], [2.03, 1.04])]);
    // Centre inside, nearest to the right side.
    let inside = (&circle(0.5), at(1.8, 0.3, 0.0));
    check(slab, inside, &[(-0.7, RIGHT, [1.65, 0.3])]);
    // Centre on the edge, and on the corner.
    check(slab, (&circle(0.5), at(0.0, 1.0, 0.0)), &[(-0.5, UP, [0.0, 0.75])]);
    let found = pair(slab, (&circle(0.5), at(2.0, 1.0, 0.0)), 0.5);
    assert_eq!(found.iter().map(|c| c.gap).collect::<Vec<_>>(), [-0.5]);
}

#[test]
fn circle_on_capsule() {
    let rod = capsule(2.0, 0.5);
    let rod = (&rod, at(0.0, 0.0, 0.0));
    check(rod, (&circle(0.5), at(0.5, 1.1, 0.0)), &[(0.1, UP, [0.5, 0.55])]);
    check(rod, (&circle(0.5), at(2.1, 0.0, 0.0)), &[(0.1, RIGHT, [1.55, 0.0])]);
    check(rod, (&circle(0.5), at(1.6, 0.8, 0.0)), &[(0.0, [0.6, 0.8], [1.3, 0.4])]);
    // A centre on the axis still has a contact: one of the sides.
    let found = pair(rod, (&circle(0.5), at(0.2, 0.0, 0.0)), 0.5);
    assert_eq!((found.len(), found[0].gap), (1, -1.0));
}

#[test]
fn rectangle_on_half_plane() {
    let plane = (&ground(), at(0.0, 0.0, 0.0));
    let flat = (&rectangle(2.0, 1.0), at(5.0, 0.6, 0.0));
    check(plane, flat, &[(0.1, UP, [4.0, 0.05]), (0.1, UP, [6.0, 0.05])]);
    // On its corner: neighbours are √2 higher, out of reach.
    let half = 2.0_f64.sqrt() / 2.0;
    let tilted = (&rectangle(1.0, 1.0), at(0.0, half + 0.1, FRAC_PI_4));
    check(plane, tilted, &[(0.1, UP, [0.0, 0.05])]);
    // Upside down: the two contacts are the other two vertices.
    let turned = (&rectangle(2.0, 1.0), at(0.0, 0.5, 2.0 * FRAC_PI_2));
    check(plane, turned, &[(0.0, UP, [-1.0, 0.0]), (0.0, UP, [1.0, 0.0])]);
}

#[test]
fn capsule_on_half_plane() {
    let plane = (&ground(), at(0.0, 0.0, 0.0));
    let flat = (&capsule(2.0, 0.25), at(0.0, 0.3, 0.0));
    check(plane, flat, &[(0.05, UP, [-1.0, 0.025]), (0.05, UP, [1.0, 0.025])]);
    let upright = (&capsule(2.0, 0.25), at(0.0, 1.3, FRAC_PI_2));
    check(plane, upright, &[(0.05, UP, [0.0, 0.025])]);
}

#[test]
fn rectangle_on_rectangle() {
    let lower = rectangle(4.0, 2.0);
    let lower = (&lower, at(0.0, 0.0, 0.0));
    let centred = (&rectangle(1.0, 1.0), at(0.2, 1.6, 0.0));
    check(lower, centred, &[(0.1, UP, [-0.3, 1.05]), (0.1, UP, [0.7, 1.05])]);
    // Over the end: the overlap ends at the lower one's corner.
    let overhanging = (&rectangle(1.0, 1.0), at(2.2, 1.6, 0.0));
    check(lower, overhanging, &[(0.1, UP, [1.7, 1.05]), (0.1, UP, [2.0, 1.05])]);
    // Wider than the lower one.
    let wide = (&rectangle(6.0, 1.0), at(0.3, 1.4, 0.0));
    check(lower, wide, &[(-0.1, UP, [-2.0, 0.95]), (-0.1, UP, [2.0, 0.95])]);
    // Same width, exactly above, and from the right.
    let above = (&rectangle(4.0, 2.0), at(0.0, 2.0, 0.0));
    check(lower, above, &[(0.0, UP, [-2.0, 1.0]), (0.0, UP, [2.0, 1.0])]);
    let beside = (&rectangle(4.0, 2.0), at(4.2, 0.0, 0.0));
    check(lower, beside, &[(0.2, RIGHT, [2.1, -1.0]), (0.2, RIGHT, [2.1, 1.0])]);
    // Corner to corner, along (0.6, 0.8).
    let diagonal = (&rectangle(1.0, 1.0), at(2.8, 1.9, 0.0));
    check(lower, diagonal, &[(0.5, [0.6, 0.8], [2.15, 1.2])]);
    // Corner on side, and corner in side.
    let half = 2.0_f64.sqrt() / 2.0;
    let standing = (&rectangle(1.0, 1.0), at(0.5, 1.05 + half, FRAC_PI_4));
    check(lower, standing, &[(0.05, UP, [0.5, 1.025])]);
    let stuck = (&rectangle(1.0, 1.0), at(0.5, 0.9 + half, FRAC_PI_4));
    let found = pair(lower, stuck, 0.0);
    compare(&found, &[(-0.1, UP, [0.5, 0.95])], 1.0);
}

#[test]
fn nearly_parallel_faces_have_both_ends() {
    let (lower, upper) = (rectangle(4.0, 2.0), rectangle(1.0, 1.0));
    for tilt in [1e-3, -1e-3, 1e-9] {
        let found = pair((&lower, at(0.0, 0.0, 0.0)), (&upper, at(0.0, 1.51, tilt)), 0.1);
        let mut gaps: Vec<f64> = found.iter().map(|c| c.gap).collect();
        gaps.sort_by(f64::total_cmp);
        // Ends half a metre from the centre, half a metre below it.
        let lift = |s: f64| 1.51 - 0.5 * tilt.cos() + s * 0.5 * tilt.abs().sin() - 1.0;
        assert_eq!(gaps.len(), 2);
        assert_relative_eq!(gaps[0], lift(-1.0), epsilon = 1e-14);
        assert_relative_eq!(gaps[1], lift(1.0), epsilon = 1e-14);
    }
    // Equal widths: the tilt puts one lower corner outside the supporting edge.
    for tilt in [1e-3, -1e-3] {
        let found = pair((&upper, at(0.0, 0.0, 0.0)), (&upper, at(0.0, 1.01, tilt)), 0.1);
        assert_eq!(found.len(), 2, "{found:#?}");
        assert!(found.iter().all(|c| c.gap > 0.009 && c.gap < 0.011 && c.normal.y > 0.99));
    }
}

#[test]
fn capsule_on_capsule() {
    let rod = capsule(2.0, 0.25);
    let rod = (&rod, at(0.0, 0.0, 0.0));
    let parallel = (&capsule(2.0, 0.25), at(0.5, 0.6, 0.0));
    check(rod, parallel, &[(0.1, UP, [-0.5, 0.3]), (0.1, UP, [1.0, 0.3])]);
    let crossed = (&capsule(2.0, 0.25), at(0.3, 1.6, FRAC_PI_2));
    check(rod, crossed, &[(0.1, UP, [0.3, 0.3])]);
    let in_line = (&capsule(2.0, 0.25), at(2.6, 0.0, 0.0));
    check(rod, in_line, &[(0.1, RIGHT, [1.3, 0.0])]);
    // Crossing axes: the shorter way out is over the upper end, by 0.2 and both radii.
    let through = (&capsule(2.0, 0.25), at(0.3, 0.8, FRAC_PI_2));
    let found = pair(rod, through, 0.0);
    assert!(found.iter().any(|c| (c.gap + 0.7).abs() < 1e-12), "{found:#?}");
}

#[test]
fn capsule_on_rectangle() {
    let slab = rectangle(4.0, 2.0);
    let slab = (&slab, at(0.0, 0.0, 0.0));
    let lying = (&capsule(1.0, 0.25), at(0.0, 1.35, 0.0));
    check(slab, lying, &[(0.1, UP, [-0.5, 1.05]), (0.1, UP, [0.5, 1.05])]);
    let overhanging = (&capsule(1.0, 0.25), at(2.0, 1.35, 0.0));
    check(slab, overhanging, &[(0.1, UP, [1.5, 1.05]), (0.1, UP, [2.0, 1.05])]);
    let corner = (&capsule(1.0, 0.25), at(2.8, 1.4, 0.0)); // its end at (2.3, 1.4)
    check(slab, corner, &[(0.25, [0.6, 0.8], [2.075, 1.1])]);
}

#[test]
fn polygon_on_half_plane_and_circle() {
    let triangle = Shape::Polygon { points: vec![[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]] };
    let placed = (&triangle, at(0.0, 0.1, 0.0));
    check(
        (&ground(), at(0.0, 0.0, 0.0)),
        placed,
        &[(0.1, UP, [0.0, 0.05]), (0.1, UP, [2.0, 0.05])],
    );
    // The long side has the normal (1, 2)/√5.
    let n = Vector2::new(1.0, 2.0) / 5.0_f64.sqrt();
    let centre = Vector2::new(1.0, 0.5) + n * 0.5;
    let point = Vector2::new(1.0, 0.5) + n * 0.1;
    let disc = (&circle(0.3), at(centre.x, centre.y, 0.0));
    check((&triangle, at(0.0, 0.0, 0.0)), disc, &[(0.2, n.into(), point.into())]);
}

#[test]
fn half_planes_do_not_touch() {
    let wall = Shape::HalfPlane { normal: [1.0, 0.0], offset: 0.0 };
    let found = pair((&ground(), at(0.0, 0.0, 0.0)), (&wall, at(0.0, 0.0, 0.0)), f64::INFINITY);
    assert!(found.is_empty());
}

#[test]
fn coincident_centres_are_refused() {
    let found = try_pair((&circle(1.0), at(1.0, 2.0, 0.0)), (&circle(0.5), at(1.0, 2.0, 0.0)), 0.1);
    assert_eq!(found, Err(CollisionError::CoincidentPoints { bodies: [0, 1] }));
}

#[test]
fn poses_must_be_finite() {
    let lost = at(0.0, f64::NAN, 0.0);
    let found = try_pair((&circle(1.0), at(0.0, 0.0, 0.0)), (&circle(1.0), lost), 0.1);
    assert!(matches!(found, Err(CollisionError::PoseNotFinite { body: 1, .. })), "{found:?}");
    let blind = try_pair((&circle(1.0), at(0.0, 0.0, 0.0)), (&ground(), lost), f64::NAN);
    assert!(blind.is_err());
}

#[test]
fn compounds_number_their_shapes() {
    let feet = [-1.0, 1.0].map(|x| Shape::Circle { radius: 0.5, center: [x, 0.0] });
    let (feet, floor) = (Collider::new(&feet).expect("valid"), collider(&ground()));
    let bodies = [
        Placed { collider: &feet, pose: at(0.0, 0.5, 0.0) },
        Placed { collider: &floor, pose: at(0.0, 0.0, 0.0) },
    ];
    let found = contacts(&bodies, 0.1, &|_, _| true).expect("contacts");
    let expected = [0, 1].map(|foot| ContactId {
        bodies: [0, 1],
        shapes: [foot, 0],
        parts: [Part::Vertex(0), Part::Edge(0)],
    });
    assert_eq!(found.iter().map(|c| c.feature.id).collect::<Vec<_>>(), expected);
    assert!(contacts(&bodies, 0.1, &|_, _| false).expect("contacts").is_empty());
}

#[test]
fn order_is_that_of_identifiers() {
    let (box_, floor) = (collider(&rectangle(1.0, 1.0)), collider(&ground()));
    let mut bodies: Vec<Placed> = (0..12)
        .map(|k| Placed {
            collider: &box_,
            pose: at(f64::from((k * 5) % 12) * 0.9, 0.5, 0.1 * f64::from(k)),
        })
        .collect();
    bodies.insert(4, Placed { collider: &floor, pose: at(0.0, 0.0, 0.0) });
    let found = contacts(&bodies, 0.3, &|_, _| true).expect("contacts");
    assert!(found.len() > 20);
    assert!(found.windows(2).all(|w| w[0].feature.id < w[1].feature.id));
    assert!(found.iter().all(|c| c.feature.id.bodies[0] < c.feature.id.bodies[1]));
}
