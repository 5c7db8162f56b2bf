//! Bodies as a person describes them.

use serde::{Deserialize, Serialize};
use tangency_collision::Shape;

/// How a body moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyKind {
    /// Moved by forces and impulses; its velocity is an unknown of every step.
    #[default]
    Dynamic,
    /// Never moves; has no unknowns.
    Static,
    /// Moves with its given velocity whatever touches it (conveyors, pistons); has no unknowns.
    Kinematic,
}

/// A body. Every field but `name` has a default, so that definitions stay short:
///
/// ```
/// use tangency_core::{BodyDef, Shape};
/// let ball = BodyDef {
///     name: "ball".into(),
///     position: [0.0, 1.0],
///     shapes: vec![Shape::Circle { radius: 0.1, center: [0.0, 0.0] }],
///     mass: Some(2.0),
///     ..BodyDef::default()
/// };
/// assert_eq!(ball.friction, 0.5);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BodyDef {
    /// Unique name; `world` is reserved.
    pub name: String,
    /// How it moves.
    pub kind: BodyKind,
    /// Where the body's frame lies at the start, m. Shapes are given in this frame; the state
    /// follows the centre of mass.
    pub position: [f64; 2],
    /// Angle at the start, rad, counter-clockwise.
    pub angle: f64,
    /// Velocity of the centre of mass at the start, m/s.
    pub velocity: [f64; 2],
    /// Angular velocity at the start, rad/s.
    pub angular_velocity: f64,
    /// Shapes in the body's frame; several make a compound; none makes a body that cannot touch.
    pub shapes: Vec<Shape>,
    /// Mass, kg. Give either `mass` or `density`; a body with shapes and neither has density 1.
    pub mass: Option<f64>,
    /// Density, kg/m².
    pub density: Option<f64>,
    /// Moment of inertia about the centre of mass, kg·m²; derived from the shapes if not given.
    pub inertia: Option<f64>,
    /// Friction coefficient μ ≥ 0. Two bodies touch with √(μ_a μ_b): one frictionless body is
    /// enough for a frictionless contact.
    pub friction: f64,
    /// Coefficient of restitution e in [0, 1]. Two bodies touch with (e_a + e_b)/2.
    pub restitution: f64,
    /// Factor on the scene's gravity.
    pub gravity_scale: f64,
    /// Tags that address several bodies at once, as in `mass:links`.
    pub groups: Vec<String>,
    /// Bits of the collision categories that the body belongs to.
    pub category: u32,
    /// Bits of the categories that the body collides with. Two bodies collide when each one's
    /// category is in the other's mask.
    pub mask: u32,
}

impl Default for BodyDef {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: BodyKind::Dynamic,
            position: [0.0; 2],
            angle: 0.0,
            velocity: [0.0; 2],
            angular_velocity: 0.0,
            shapes: Vec::new(),
            mass: None,
            density: None,
            inertia: None,
            friction: 0.5,
            restitution: 0.0,
            gravity_scale: 1.0,
            groups: Vec::new(),
            category: 1,
            mask: u32::MAX,
        }
    }
}
