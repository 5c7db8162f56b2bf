//! Joints.

use tangency::{JointDef, JointKind, Limits, Motor, SceneDef, Softness, WORLD};

use super::check;

fn joint(kind: JointKind) -> impl FnOnce(&mut SceneDef) {
    |d| d.joints[0].kind = kind
}

fn revolute(limits: Limits, motor: Option<Motor>) -> JointKind {
    JointKind::Revolute { anchor: [3.0, 2.0], anchor_b: None, limits, motor }
}

#[test]
fn joints() {
    let no = Limits::default();
    let bodies = |a: &'static str, b: &'static str| {
        move |d: &mut SceneDef| d.joints[0].bodies = [a.into(), b.into()]
    };
    check(bodies("ball", "ball"), "joints[0].bodies: a joint needs two different bodies");
    check(bodies("world", "world"), "joints[0].bodies: a joint needs two different bodies");
    check(bodies("world", "floor"), "joints[0].bodies: at least one of them must be dynamic");
    check(
        bodies("world", "bal"),
        "joints[0].bodies[1] names \"bal\", which is not a body; known: floor, box, ball",
    );
    check(
        joint(revolute(no, Some(Motor { speed: f64::NAN, max: None }))),
        "joints[0].kind.revolute.motor.speed is NaN: give a finite number",
    );
    check(
        joint(revolute(no, Some(Motor { speed: 1.0, max: Some(0.0) }))),
        "joints[0].kind.revolute.motor.max is 0: give a positive finite number",
    );
    check(
        joint(revolute(Limits { lower: Some(1.0), upper: Some(0.5) }, None)),
        "joints[0].kind.revolute.limits.upper is 0.5: give an upper limit that is not below the \
         lower one",
    );
    check(
        joint(JointKind::Slot { anchor: [0.0; 2], axis: [0.0; 2], limits: no, motor: None }),
        "joints[0].kind.slot.axis: an axis needs a direction",
    );
    check(
        joint(JointKind::Distance { anchor_a: [1.0; 2], anchor_b: [1.0; 2], length: None }),
        "joints[0].kind.distance.anchor_b: the anchors coincide, so their distance has no \
         direction; use a (soft) revolute joint",
    );
    check(
        joint(JointKind::Lock { x: false, y: false, rotation: false }),
        "joints[0].kind.lock: lock at least one of x, y and rotation",
    );
    check(
        |d| {
            d.joints[0].bodies = ["ball".into(), WORLD.into()];
            d.joints[0].kind = JointKind::Lock { x: true, y: false, rotation: false };
        },
        "joints[0].bodies: a lock holds a body in the world: name `world` first",
    );
    check(
        |d| d.joints[0].softness = Some(Softness { stiffness: -1.0, damping: 0.0 }),
        "joints[0].softness.stiffness is -1: give a finite number of 0 or more",
    );
    check(
        |d| d.joints[0].softness = Some(Softness { stiffness: 0.0, damping: 0.0 }),
        "joints[0].softness.stiffness: with neither stiffness nor damping it does nothing",
    );
    check(
        |d| {
            let twin: JointDef = d.joints[0].clone();
            d.joints.push(twin);
        },
        "joints[1].name is \"pin\": this name is taken; choose another",
    );
}
