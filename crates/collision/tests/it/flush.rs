//! Boxes that slide over flat ground and over seams between flush plates.

use tangency_collision::{Contact, ContactId, Placed, Shape, contacts};

use crate::support::{at, collider, ground, pair, rectangle};

fn ids(found: &[Contact]) -> Vec<ContactId> {
    found.iter().map(|c| c.feature.id).collect()
}

#[test]
fn identities_last_while_a_box_slides() {
    let crate_ = rectangle(1.0, 0.6);
    for (floor, y) in [(ground(), 0.0), (rectangle(40.0, 2.0), 1.0)] {
        let placed = |k: i32| {
            let jitter = 1e-13 * f64::from(k % 7 - 3);
            let pose = at(0.037 * f64::from(k), y + 0.3 + jitter, 1e-13 * f64::from(k % 5 - 2));
            pair((&floor, at(0.0, 0.0, 0.0)), (&crate_, pose), 0.05)
        };
        let first = placed(0);
        assert_eq!(first.len(), 2);
        for k in 1..400 {
            assert_eq!(ids(&placed(k)), ids(&first), "step {k}");
        }
    }
}

#[test]
fn identities_last_in_a_stack_of_equals() {
    let crate_ = rectangle(1.0, 1.0);
    let placed = |k: i32| {
        let pose = at(1e-13 * f64::from(k % 7 - 3), 1.0, 1e-13 * f64::from(k % 5 - 2));
        pair((&crate_, at(0.0, 0.0, 0.0)), (&crate_, pose), 0.05)
    };
    for k in 1..50 {
        assert_eq!(ids(&placed(k)), ids(&placed(0)), "step {k}");
        assert_eq!(placed(k).len(), 2);
    }
}

/// Two plates with equal tops at y = 0 that meet at x = 0, and a box sliding over them.
fn over_plates(slider: &Shape, x: f64, y: f64, reach: f64) -> Vec<Contact> {
    let (plate, slider) = (collider(&rectangle(4.0, 1.0)), collider(slider));
    let bodies = [
        Placed { collider: &plate, pose: at(-2.0, -0.5, 0.0) },
        Placed { collider: &slider, pose: at(x, y, 0.0) },
        Placed { collider: &plate, pose: at(2.0, -0.5, 0.0) },
    ];
    contacts(&bodies, reach, &|i, j| (i, j) != (0, 2)).expect("contacts")
}

#[test]
fn nothing_catches_on_a_seam() {
    let slider = rectangle(1.0, 0.4);
    for lift in [1e-12, 0.0, -1e-12, -1e-9, -1e-7] {
        for k in -300..300 {
            let x = 0.01 * f64::from(k);
            let found = over_plates(&slider, x, 0.2 + lift, 0.3);
            assert!(found.iter().all(|c| c.normal.x.abs() < 1e-9), "{x} {lift}: {found:#?}");
            assert!(found.len() >= 2, "{x} {lift}: {found:#?}");
            assert!(found.iter().all(|c| (c.gap - lift).abs() < 1e-12));
        }
    }
}

#[test]
fn nothing_catches_near_the_corners_of_a_seam() {
    let slider = rectangle(1.0, 0.4);
    for lift in [1e-12, 0.0, -1e-12] {
        for offset in [0.0, 1e-15, 1e-12, 1e-10, 1e-8, 1e-7, 1e-5, 1e-3] {
            for x in [0.5 + offset, 0.5 - offset, -0.5 + offset, -0.5 - offset] {
                let found = over_plates(&slider, x, 0.2 + lift, 0.3);
                assert!(found.iter().all(|c| c.normal.x.abs() < 1e-9), "{x}: {found:#?}");
                assert!(found.len() >= 2, "{x} {lift}: {found:#?}");
            }
        }
    }
}

#[test]
fn over_a_seam_each_plate_carries_its_part() {
    let found = over_plates(&rectangle(1.0, 0.4), 0.1, 0.2, 0.3);
    let points: Vec<(f64, [u32; 2])> =
        found.iter().map(|c| (c.point.x, c.feature.id.bodies)).collect();
    assert_eq!(points.len(), 4);
    for (x, bodies) in [(-0.4, [0, 1]), (0.0, [0, 1]), (0.0, [1, 2]), (0.6, [1, 2])] {
        let there = |p: &&(f64, [u32; 2])| (p.0 - x).abs() < 1e-12 && p.1 == bodies;
        assert_eq!(points.iter().filter(there).count(), 1, "{points:?}");
    }
}

#[test]
fn neighbours_in_a_wall_press_only_across_their_faces() {
    // A 4 × 4 grid of touching boxes: diagonal neighbours share only a corner.
    let crate_ = collider(&rectangle(1.0, 1.0));
    let place = |k: i32| at(f64::from(k % 4), f64::from(k / 4), 0.0);
    let bodies: Vec<Placed> =
        (0..16).map(|k| Placed { collider: &crate_, pose: place(k) }).collect();
    let found = contacts(&bodies, 0.1, &|_, _| true).expect("contacts");
    assert_eq!(found.len(), 2 * 2 * 4 * 3);
    assert!(found.iter().all(|c| c.gap.abs() < 1e-12));
}

#[test]
fn a_real_wall_is_felt() {
    // The second plate is a step of 0.1: its side is hit.
    let (slider, step) = (rectangle(1.0, 0.4), rectangle(4.0, 1.0));
    let found = pair((&slider, at(-0.6, 0.2, 0.0)), (&step, at(2.0, -0.4, 0.0)), 0.3);
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|c| c.normal.x > 0.999 && (c.gap - 0.1).abs() < 1e-12));
    // Corner ahead and below: 0.1 right and 0.1 down, still felt.
    let found = pair((&slider, at(-0.6, 0.2, 0.0)), (&step, at(2.0, -0.6, 0.0)), 0.3);
    assert_eq!(found.len(), 1);
    assert!((found[0].gap - 0.1 * 2.0_f64.sqrt()).abs() < 1e-12);
}

/// A pyramid lost its supports when boxes at rest were turned by rounding.
#[test]
fn faces_that_just_touch_keep_both_contacts_whatever_the_rounding() {
    let square = rectangle(1.0, 1.0);
    for (tilt_a, tilt_b) in [(6e-23, 4e-22), (-3e-16, 2e-16), (1e-17, -1e-15), (1e-13, -1e-13)] {
        for shift in [0.525, -0.525, 0.3] {
            for lift in [0.0, 2e-16, -2e-16] {
                let lower = (&square, at(3.15, 0.5, tilt_a));
                let upper = (&square, at(3.15 + shift, 1.5 + lift, tilt_b));
                let found = pair(lower, upper, 1e-3);
                assert_eq!(found.len(), 2, "{tilt_a} {tilt_b} {shift} {lift}: {found:#?}");
                assert!(found.iter().all(|c| c.gap.abs() < 1e-12 && c.normal.y > 0.9));
            }
        }
    }
}
