//! The same scene told otherwise: in other units, from another frame, in another order.
//!
//! Physics does not know how it is told. What a retold scene does, told back, is what the scene
//! does; so are its derivatives.

mod frame;
mod order;
mod units;

pub use frame::Frame;
pub use order::Reversed;
pub use units::{Units, has_own_units};

use tangency_core::{Param, Scene, SceneDef, State};

/// Another way to tell a scene.
pub trait Retelling {
    /// The scene told so.
    fn scene(&self, def: &SceneDef) -> SceneDef;

    /// A state of the retold scene, told back.
    fn told_back(&self, state: &State) -> State;

    /// A number of the state as a weighted sum of those of the retold state of as many `bodies`.
    fn number(&self, bodies: usize, number: Number) -> Vec<(Number, f64)>;

    /// How fast the numbers of the retold scene change with a number of the scene.
    fn param(&self, scene: &Scene, param: Param) -> Vec<(Param, f64)>;
}

/// A number of a state: body and axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Of a pose.
    Pose(usize, usize),
    /// Of a velocity.
    Velocity(usize, usize),
}

/// Every number of a scene that may be differentiated by.
#[must_use]
pub fn params(scene: &Scene) -> Vec<Param> {
    let mut all = vec![Param::Dt, Param::Gravity(0), Param::Gravity(1)];
    for (i, collider) in scene.colliders().iter().enumerate() {
        all.extend([Param::Mass(i), Param::Density(i), Param::Inertia(i)]);
        all.extend([Param::Friction(i), Param::Restitution(i)]);
        for (k, shape) in collider.shapes().iter().enumerate() {
            all.push(Param::Radius(i, k));
            all.extend(shape.numbers().into_iter().map(|number| Param::Shape(i, k, number)));
        }
        all.extend((0..3).flat_map(|axis| [Param::Position(i, axis), Param::Velocity(i, axis)]));
    }
    for j in 0..scene.joints().len() {
        all.extend((0..2).flat_map(|axis| [Param::AnchorA(j, axis), Param::AnchorB(j, axis)]));
        all.extend([Param::Length(j), Param::Stiffness(j), Param::Damping(j)]);
        all.extend([Param::MotorSpeed(j), Param::MotorMax(j), Param::Lower(j), Param::Upper(j)]);
    }
    all.extend((0..scene.forces().len()).flat_map(|f| (0..3).map(move |k| Param::Force(f, k))));
    all.retain(|param| scene.get(*param).is_some());
    all
}
