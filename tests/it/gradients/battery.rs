//! The scenes that gradients are checked on: short runs that stay clear of switches.

use tangency::{BodyDef, ContactModel, Correction, JointKind, Param, SceneDef, ShapeNumber};
use tangency_bench::scenes::{
    chain, compound_tumble, conveyor, disc, doubled_hinge, falling_disc, incline_block, material,
    misfit_hinges, motor_arm, narrow_slot, paper_chain, pendulum, piston, sliding_disc,
    soft_bridge, spring_cart, stack, unit_scene,
};

use crate::engine::with_dt;

/// A scene, how long it runs, and the numbers in which it sits on a switch.
pub(crate) struct Entry {
    pub(crate) def: SceneDef,
    pub(crate) steps: usize,
    pub(crate) except: Vec<Param>,
}

fn entry(def: SceneDef, steps: usize) -> Entry {
    Entry { def, steps, except: Vec::new() }
}

/// Contacts hold their positions through the velocity on both sides of gap zero, so that landing
/// and penetrating are one smooth formula.
fn two_sided(mut def: SceneDef) -> SceneDef {
    def.stabilisation.contacts = Correction::Baumgarte { fraction: 1.0 };
    def.recovery_speed = 1e3;
    def
}

pub(crate) fn battery() -> Vec<Entry> {
    vec![
        entry(pendulum(2.0), 60),
        entry(doubled_hinge(2.0, 1), 60),
        entry(swinging_chain(), 40),
        entry(two_sided(incline_block(0.5, 0.3, 0.7)), 30),
        entry(two_sided(sliding_disc()), 30),
        entry(two_sided(sliding_disc()), 80), // slides, then rolls
        entry(bouncing(), 30),
        entry(oblique(), 40),
        slow_ball(),
        entry(motor_arm(), 30),
        entry(spring_cart(), 40),
        entry(piston(), 40),
        entry(two_sided(conveyor()), 30),
        entry(compound_tumble(), 10),
        entry(post_stabilised(), 12),
        entry(slowly_closing(), 4),
        entry(velocity_model(), 8),
        shifted_stack(),
        entry(pushed_chain(), 20),
        entry(narrow_slot(0.8), 2),
        entry(misfit_hinges(0.004), 3),
    ]
}

fn swinging_chain() -> SceneDef {
    let mut def = chain(4, 0.3, 0.2);
    for (i, body) in def.bodies.iter_mut().enumerate() {
        body.velocity = [0.4 + 0.3 * i as f64, 0.0];
    }
    def
}

/// Falls with spin onto a rough floor and leaves it again.
fn bouncing() -> SceneDef {
    let mut def = material(falling_disc(0.15, 0.7), 0.2, 0.7);
    (def.bodies[1].angular_velocity, def.bodies[1].velocity) = (3.0, [0.5, -1.0]);
    def
}

/// Discs that meet off their centres.
fn oblique() -> SceneDef {
    let thrown = BodyDef {
        mass: Some(1.0),
        velocity: [2.0, 0.3],
        angular_velocity: 5.0,
        ..disc("thrown", 0.1, [0.0, 0.0])
    };
    let struck = BodyDef { mass: Some(2.0), ..disc("struck", 0.15, [0.6, 0.2]) };
    material(unit_scene("oblique discs", vec![thrown, struck]), 0.1, 0.6)
}

/// Joints that open so far in a step that it takes several displacements to close them.
fn post_stabilised() -> SceneDef {
    let mut def = with_dt(swinging_chain(), 0.02);
    def.stabilisation.joints = Correction::Post;
    for (i, body) in def.bodies.iter_mut().enumerate() {
        body.velocity = [1.5 + 1.5 * i as f64, 0.0];
        body.angular_velocity = 4.0;
    }
    def.name = "post-stabilised chain".into();
    def
}

/// A pin that closes at the recovery speed, while what turns by that is mended at once.
fn slowly_closing() -> SceneDef {
    let mut def = pendulum(2.0);
    def.stabilisation.joints = Correction::Post;
    if let JointKind::Revolute { anchor, anchor_b, .. } = &mut def.joints[0].kind {
        *anchor_b = Some([anchor[0] + 0.06, anchor[1] + 0.002]);
    }
    def.name = "slowly closing pin".into();
    def
}

/// The paper's contact model with Baumgarte's correction, deep enough to be corrected throughout.
fn velocity_model() -> SceneDef {
    let mut def = incline_block(0.5, 0.3, 0.7);
    def.name = "block, velocity model".into();
    def.contact_model = ContactModel::Velocity { contact_distance: 0.05 };
    def.stabilisation.contacts = Correction::Baumgarte { fraction: 0.05 };
    let (sin, cos) = 0.5_f64.sin_cos();
    def.bodies[1].position[0] += 0.01 * sin;
    def.bodies[1].position[1] -= 0.01 * cos;
    def
}

/// The ball rolls on the first plank; set down a little higher, the soft plank throws it up.
fn slow_ball() -> Entry {
    let mut def = two_sided(soft_bridge(3));
    let ball = &mut def.bodies[3];
    (ball.velocity, ball.angular_velocity) = ([0.5, 0.0], -0.5 / 0.15);
    ball.position[1] = 0.18;
    Entry { def, steps: 12, except: vec![Param::Position(3, 1), Param::Radius(3, 0)] }
}

/// The push ends within a step: at the end of one its derivative by dt has two sides.
fn pushed_chain() -> SceneDef {
    let mut def = paper_chain(4, 7.0);
    def.forces[0].end = Some(0.12);
    def
}

/// Flush boxes, no corner over another: a turn, of a side or of the floor too, lifts one of two corners,
/// and a lifted box lands in a later step.
fn shifted_stack() -> Entry {
    let mut def = two_sided(stack(&[2.0, 1.0]));
    def.bodies[2].position[0] = 0.1;
    let turns = (0..3).flat_map(|i| [Param::Position(i, 2), Param::Velocity(i, 2)]);
    let sides = (1..3).map(|i| Param::Shape(i, 0, ShapeNumber::Angle));
    let floor = Param::Shape(0, 0, ShapeNumber::Normal(0));
    let lifts = [Param::Position(2, 1), Param::Shape(1, 0, ShapeNumber::Size(1)), floor];
    let except = turns.chain(sides).chain(lifts).collect();
    Entry { def, steps: 10, except }
}
