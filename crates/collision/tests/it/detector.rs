//! A detector that is kept answers as a new one does.

use tangency_collision::{Collider, CollisionError, Contact, Detector, Frame, Pose, Shape};

use crate::support::{at, capsule, circle, collider, ground, rectangle};

/// Some bodies, which of them are fixed, and where they are after `k` moves.
fn scene(n: u32, k: u32) -> (Vec<Collider>, Vec<bool>, Vec<Frame>) {
    let shape = |i: u32| match i % 4 {
        0 => circle(0.4),
        1 => rectangle(0.9, 0.7),
        2 => capsule(0.6, 0.3),
        _ => Shape::Polygon { points: vec![[-0.5, -0.4], [0.6, -0.3], [0.1, 0.6]] },
    };
    let mut colliders: Vec<Collider> = (0..n).map(|i| collider(&shape(i))).collect();
    colliders.push(collider(&ground()));
    let fixed = (0..=n).map(|i| i == n || i % 2 == 0).collect();
    let pose = |i: u32| {
        let moves = if i % 2 == 1 || i == 4 { 0.07 * f64::from(k) } else { 0.0 };
        at(0.8 * f64::from(i % 9) + moves, 0.8 * f64::from(i / 9) - moves, f64::from(i) + moves)
    };
    let frames = (0..n).map(|i| Frame::new(&pose(i))).chain([Frame::new(&Pose::zeros())]).collect();
    (colliders, fixed, frames)
}

fn contacts_of(
    detector: &mut Detector,
    (colliders, fixed, frames): &(Vec<Collider>, Vec<bool>, Vec<Frame>),
) -> Result<Vec<Contact>, CollisionError> {
    detector.place(colliders, frames, fixed)?;
    let (mut near, mut found) = (Vec::new(), Vec::new());
    detector.near(&vec![0.1; frames.len()], &mut near);
    near.iter().try_for_each(|pair| detector.between(pair.bodies, 0.1, &mut found))?;
    Ok(found)
}

#[test]
fn what_it_remembers_does_not_show() {
    let mut kept = Detector::default();
    // Two scenes in turn, of many bodies and of few, some of which move.
    for (n, k) in [(60, 0), (60, 0), (60, 1), (60, 1), (7, 1), (7, 2), (60, 2), (60, 0)] {
        let scene = scene(n, k);
        let found = contacts_of(&mut kept, &scene).expect("contacts");
        assert_eq!(found, contacts_of(&mut Detector::default(), &scene).expect("contacts"));
        assert!(found.len() > 3);
        assert!(found.is_sorted_by_key(|contact| contact.feature.id));
        assert!(
            found.iter().all(|c| !c
                .feature
                .id
                .bodies
                .map(|b| scene.1[b as usize])
                .iter()
                .all(|f| *f))
        );
    }
}

#[test]
fn a_refused_placement_changes_nothing() {
    let mut detector = Detector::default();
    let good = scene(20, 0);
    let found = contacts_of(&mut detector, &good).expect("contacts");
    let mut bad = scene(20, 3);
    bad.2[11] = Frame::new(&at(0.0, f64::NAN, 0.0));
    let error = contacts_of(&mut detector, &bad).expect_err("a pose that is not finite");
    assert!(matches!(error, CollisionError::PoseNotFinite { body: 11, .. }));
    assert_eq!(contacts_of(&mut detector, &good).expect("contacts"), found);
}
