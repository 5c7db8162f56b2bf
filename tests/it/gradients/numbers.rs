//! The numbers of a scene that have a derivative.

use tangency::{BodyKind, Param, Scene};

/// Every number that the scene has and that lies inside its range.
pub(crate) fn numbers(scene: &Scene) -> Vec<Param> {
    let mut all = vec![Param::Gravity(0), Param::Gravity(1), Param::Dt];
    for (i, body) in scene.bodies().iter().enumerate() {
        all.extend([Param::Mass(i), Param::Density(i), Param::Inertia(i)]);
        all.extend([Param::Friction(i), Param::Restitution(i)]);
        for (k, shape) in scene.colliders()[i].shapes().iter().enumerate() {
            all.push(Param::Radius(i, k));
            all.extend(shape.numbers().into_iter().map(|number| Param::Shape(i, k, number)));
        }
        all.extend((0..3).map(|axis| Param::Position(i, axis)));
        if body.kind != BodyKind::Static {
            all.extend((0..3).map(|axis| Param::Velocity(i, axis)));
        }
    }
    for j in 0..scene.joints().len() {
        all.extend((0..2).flat_map(|axis| [Param::AnchorA(j, axis), Param::AnchorB(j, axis)]));
        all.extend([Param::Length(j), Param::MotorSpeed(j), Param::MotorMax(j)]);
        all.extend([Param::Stiffness(j), Param::Damping(j), Param::Lower(j), Param::Upper(j)]);
    }
    for f in 0..scene.forces().len() {
        all.extend((0..3).map(|axis| Param::Force(f, axis)));
    }
    all.retain(|param| match (param, scene.get(*param)) {
        (_, None) => false,
        // At the end of their range a difference has one side only.
        (Param::Friction(_) | Param::Damping(_) | Param::Stiffness(_), Some(x)) => x > 0.0,
        (Param::Restitution(_), Some(x)) => x > 0.0 && x < 1.0,
        _ => true,
    });
    all
}

/// Controls that vary from step to step.
pub(crate) fn controls(channels: usize, steps: usize) -> Vec<Vec<f64>> {
    let at = |k: usize, channel: usize| 0.3 * (0.2 * k as f64 + channel as f64).sin();
    (0..steps).map(|k| (0..channels).map(|channel| at(k, channel)).collect()).collect()
}
