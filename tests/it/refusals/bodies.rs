//! Bodies.

use tangency::{BodyDef, BodyKind, SceneDef, WORLD};

use super::check;

#[test]
fn bodies() {
    let body = |f: fn(&mut BodyDef)| move |d: &mut SceneDef| f(&mut d.bodies[1]);
    check(body(|b| b.mass = Some(0.0)), "bodies[1].mass is 0: give a positive finite number");
    check(body(|b| b.mass = Some(-2.0)), "bodies[1].mass is -2: give a positive finite number");
    check(
        body(|b| b.mass = Some(f64::NAN)),
        "bodies[1].mass is NaN: give a positive finite number",
    );
    check(body(|b| b.inertia = Some(0.0)), "bodies[1].inertia is 0: give a positive finite number");
    check(body(|b| b.density = Some(0.0)), "bodies[1].density is 0: give a positive finite number");
    check(
        body(|b| (b.mass, b.density) = (Some(1.0), Some(1.0))),
        "bodies[1].density: give either mass or density, not both",
    );
    check(
        body(|b| b.friction = -0.1),
        "bodies[1].friction is -0.1: give a finite number of 0 or more",
    );
    check(body(|b| b.restitution = 1.5), "bodies[1].restitution is 1.5: give a number from 0 to 1");
    check(
        body(|b| b.restitution = -0.5),
        "bodies[1].restitution is -0.5: give a number from 0 to 1",
    );
    check(body(|b| b.position[0] = f64::NAN), "bodies[1].position[0] is NaN: give a finite number");
    check(body(|b| b.angle = f64::INFINITY), "bodies[1].angle is inf: give a finite number");
    check(body(|b| b.velocity[1] = f64::NAN), "bodies[1].velocity[1] is NaN: give a finite number");
    check(
        body(|b| b.angular_velocity = f64::NEG_INFINITY),
        "bodies[1].angular_velocity is -inf: give a finite number",
    );
    check(body(|b| b.name = String::new()), "bodies[1].name is \"\": give it a name");
    check(
        body(|b| b.name = "floor".into()),
        "bodies[1].name is \"floor\": this name is taken; choose another",
    );
    check(
        body(|b| b.name = WORLD.into()),
        "bodies[1].name is \"world\": this name stands for the immovable world; choose another",
    );
    check(
        body(|b| (b.kind, b.velocity) = (BodyKind::Static, [1.0, 0.0])),
        "bodies[1].velocity: a static body cannot move; make it kinematic",
    );
    check(body(|b| b.shapes.clear()), "bodies[1]: a body without shapes needs `mass`");
    check(
        body(|b| {
            b.shapes.clear();
            b.mass = Some(1.0);
        }),
        "bodies[1]: a body without shapes needs `inertia`",
    );
    check(
        |d| d.bodies[0].kind = BodyKind::Dynamic,
        "bodies[0].shapes[0]: a half plane has no mass; make the body static or kinematic",
    );
}
