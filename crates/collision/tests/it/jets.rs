//! Jets against central differences of `evaluate`.

use approx::assert_abs_diff_eq;
use nalgebra::{SMatrix, SVector, Vector2};
use tangency_collision::{Contact, ContactFeature, ContactId, Feature, Part, Pose};

use crate::support::at;

/// Truncation h²·f‴/6 and rounding 1e-16/h are both near 1e-10 here.
const STEP: f64 = 1e-5;

fn with(feature: Feature, radii: [f64; 2]) -> ContactFeature {
    let id = ContactId { bodies: [0, 1], shapes: [0, 0], parts: [Part::Vertex(0); 2] };
    ContactFeature { id, feature, radii }
}

/// The value as the jet's rows: point, angle of the normal from `reference`, gap.
fn rows(contact: &Contact, reference: &Vector2<f64>) -> SVector<f64, 4> {
    let psi = reference.perp(&contact.normal).atan2(reference.dot(&contact.normal));
    SVector::<f64, 4>::new(contact.point.x, contact.point.y, psi, contact.gap)
}

#[track_caller]
fn check(feature: Feature, radii: [f64; 2], a: Pose, b: Pose) {
    let jet = with(feature, radii).jet(&a, &b);
    assert_eq!(jet.contact, with(feature, radii).evaluate(&a, &b));
    let n = jet.contact.normal;
    let moved = |k: usize, h: f64| {
        let mut q = [a, b, Pose::new(radii[0], radii[1], 0.0)];
        q[k / 3][k % 3] += h;
        rows(&with(feature, [q[2].x, q[2].y]).evaluate(&q[0], &q[1]), &n)
    };
    let column = |k: usize| (moved(k, STEP) - moved(k, -STEP)) / (2.0 * STEP);
    let pose = SMatrix::<f64, 4, 6>::from_columns(&std::array::from_fn::<_, 6, _>(column));
    let radii = SMatrix::<f64, 4, 2>::from_columns(&[column(6), column(7)]);
    assert_abs_diff_eq!(jet.pose, pose, epsilon = 1e-8);
    assert_abs_diff_eq!(jet.radii, radii, epsilon = 1e-8);
}

#[test]
fn all_features() {
    let (p, q) = (Vector2::new(0.3, -0.2), Vector2::new(-0.1, 0.4));
    let normal = Vector2::new(0.6, 0.8);
    let (a, b) = (at(0.5, -0.3, 0.8), at(1.9, 1.1, -2.3));
    for radii in [[0.0, 0.0], [0.3, 0.0], [0.2, 0.7]] {
        check(Feature::Points { a: p, b: q }, radii, a, b);
        check(Feature::LineA { point: p, normal, b: q }, radii, a, b);
        check(Feature::LineB { a: p, point: q, normal }, radii, a, b);
    }
}

#[test]
fn overlapping_and_far_from_the_origin() {
    let (p, q) = (Vector2::new(0.5, 0.1), Vector2::new(0.2, -0.6));
    let normal = Vector2::new(0.0, 1.0);
    let (a, b) = (at(10.0, 20.0, 3.0), at(10.4, 20.3, 1.0));
    check(Feature::Points { a: p, b: q }, [1.0, 2.0], a, b);
    check(Feature::LineA { point: p, normal, b: q }, [0.1, 0.2], a, b);
    check(Feature::LineB { a: p, point: q, normal }, [0.1, 0.2], a, b);
}

#[test]
fn a_disc_that_rolls_in_place_does_not_change_its_contact() {
    let zero = Vector2::zeros();
    let jet = with(Feature::Points { a: zero, b: zero }, [1.0, 0.5])
        .jet(&at(0.0, 0.0, 0.4), &at(3.0, 0.0, 0.1));
    assert!(jet.pose.column(2).iter().chain(jet.pose.column(5).iter()).all(|&d| d == 0.0));
    // Gap 1.5 from x = 1 to x = 2.5.
    assert_eq!((jet.contact.gap, jet.contact.point), (1.5, Vector2::new(1.75, 0.0)));
}
