//! Times of impact in closed form, and never later than parry's.

use std::f64::consts::{FRAC_PI_2, PI};

use approx::assert_relative_eq;
use nalgebra::Vector3;
use tangency_collision::{Collider, CollisionError, Placed, Pose, Shape, time_of_impact};

use crate::support::{at, capsule, circle, collider, ground, rectangle};

type Moving<'a> = (&'a Shape, Pose, [f64; 3]);

fn impact(a: Moving<'_>, b: Moving<'_>, horizon: f64) -> Option<f64> {
    let (ca, cb) = (collider(a.0), collider(b.0));
    let (pa, pb) = (Placed { collider: &ca, pose: a.1 }, Placed { collider: &cb, pose: b.1 });
    time_of_impact(&pa, &Vector3::from(a.2), &pb, &Vector3::from(b.2), horizon)
        .expect("a located impact")
}

const REST: [f64; 3] = [0.0; 3];

#[test]
fn two_discs() {
    // Centres (0,0) and (4,1), radii 1 and 0.5, approaching at 2 m/s along x:
    // (4 − 2t)² + 1 = 1.5².
    let expected = (4.0 - 1.25_f64.sqrt()) / 2.0;
    let (a, b) = (circle(1.0), circle(0.5));
    let found =
        impact((&a, at(0.0, 0.0, 0.0), [2.0, 0.0, 3.0]), (&b, at(4.0, 1.0, 0.0), REST), 9.0);
    assert_relative_eq!(found.expect("an impact"), expected, epsilon = 1e-11);
    assert_eq!(
        impact((&a, at(0.0, 0.0, 0.0), [2.0, 0.0, 0.0]), (&b, at(4.0, 1.0, 0.0), REST), 1.0),
        None
    );
    assert_eq!(
        impact((&a, at(0.0, 0.0, 0.0), [2.0, 0.0, 0.0]), (&b, at(4.0, 1.6, 0.0), REST), 9.0),
        None
    );
}

#[test]
fn a_rod_swings_onto_the_ground() {
    // Pivot at height 0.5; the upright rod's end at radius 1 comes down to y = 0 at angle −30°,
    // clockwise from +90°.
    let rod = Shape::Polygon { points: vec![[0.0, 0.0], [1.0, 0.0], [0.5, 0.01]] };
    let found = impact(
        (&ground(), at(0.0, 0.0, 0.0), REST),
        (&rod, at(0.0, 0.5, FRAC_PI_2), [0.0, 0.0, -1.0]),
        9.0,
    );
    assert_relative_eq!(found.expect("an impact"), FRAC_PI_2 + PI / 6.0, epsilon = 1e-10);
}

#[test]
fn a_falling_spinning_square_meets_a_slab() {
    // Falls at 1 m/s from 3 and turns at π/4 rad/s: after 2 s it has made a quarter turn and stands
    // flat on the slab; before that its corner is lower, at √½ cos(π/4 − (π/4)t mod …).
    let square = rectangle(1.0, 1.0);
    let lowest = |t: f64| {
        let phase = (PI / 4.0 * t).rem_euclid(FRAC_PI_2) - PI / 4.0;
        3.0 - t - 0.5_f64.sqrt() * phase.cos()
    };
    let slab = (&rectangle(9.0, 1.0), at(0.0, -0.5, 0.0), REST);
    let found = impact(slab, (&square, at(0.0, 3.0, 0.0), [0.0, -1.0, PI / 4.0]), 9.0);
    let found = found.expect("an impact");
    assert!(lowest(found).abs() < 1e-10);
    assert!((0..1000).all(|k| lowest(found * f64::from(k) / 1000.0) > 0.0));
}

#[test]
fn a_disc_that_skims_the_ground_is_soon_settled() {
    // Conservative bounds that counted its spin would creep in steps of a nanosecond.
    let skimming = (&circle(0.5), at(0.0, 0.5 + 1e-9, 0.0), [1.0, 0.0, 50.0]);
    assert_eq!(impact((&ground(), at(0.0, 0.0, 0.0), REST), skimming, 1.0), None);
}

#[test]
fn a_compound_touches_with_its_first_shape() {
    let dumbbell = [-1.0, 1.0].map(|y| Shape::Circle { radius: 0.25, center: [0.0, y] });
    let (dumbbell, floor) = (Collider::new(&dumbbell).expect("valid"), collider(&ground()));
    let above = Placed { collider: &dumbbell, pose: at(0.0, 2.25, 0.0) };
    let floor = Placed { collider: &floor, pose: at(0.0, 0.0, 0.0) };
    let (falling, rest) = (Vector3::new(0.0, -2.0, 0.0), Vector3::zeros());
    assert_eq!(time_of_impact(&above, &falling, &floor, &rest, 1.0), Ok(Some(0.5)));
    let lost = Vector3::new(0.0, f64::NAN, 0.0);
    let refused = time_of_impact(&above, &lost, &floor, &rest, 1.0);
    assert!(matches!(refused, Err(CollisionError::NotFinite { what: "velocity", .. })));
}

#[test]
fn already_touching_is_now() {
    let rod = capsule(1.0, 0.2);
    let found = impact(
        (&ground(), at(0.0, 0.0, 0.0), REST),
        (&rod, at(0.0, 0.1, 0.0), [0.0, 1.0, 0.0]),
        1.0,
    );
    assert_eq!(found, Some(0.0));
}
