//! Derivatives by the numbers of shapes, through bounces, in closed form.
//!
//! What falls onto a floor bounces as a disc does whose radius r is the height of its centre over its
//! lowest point.

use tangency::{
    BodyDef, Param, Parameter, RolloutVector, Scene, SceneDef, Shape, ShapeNumber, StateVector,
    gradient, simulate, tangent,
};
use tangency_bench::scenes::{block, floor, material};

use super::{bounced, dropped, resolved};
use crate::engine::{backends, built, near, near_relative};

const END: f64 = 0.7;

/// dy/d(number) at the end, of the second body, backwards and forwards.
#[track_caller]
fn slope(scene: &Scene, solver: &dyn tangency::LcpSolver, param: Param, height: f64) -> f64 {
    let steps = crate::engine::steps(END, scene.dt());
    let tape = simulate(scene, solver, steps).expect("a run");
    near("height", tape.last().q[1].y, height, 1e-9);
    let seed = |k: usize, _: &_| {
        let mut seed = StateVector::zeros(2);
        seed.q[1].y = 1.0;
        (k == steps).then_some(seed)
    };
    let reverse = gradient(scene, &tape, seed).expect("a gradient").by.by(scene, param);
    let mut along = RolloutVector::zeros(scene, steps);
    along.add(scene, param, 1.0);
    let forward = tangent(scene, &tape, &along).expect("a tangent")[steps].q[1].y;
    near("forwards", forward, reverse, 1e-12 * reverse.abs().max(1.0));
    reverse
}

/// Height after bounces, and its derivatives by y₀ and r.
fn exact(r: f64) -> [f64; 3] {
    let at = |d| bounced([1.0, -2.0, 0.8, 9.81, r], d, END);
    let [height, by_place] = at([1.0, 0.0, 0.0, 0.0, 0.0]);
    [height, by_place, at([0.0, 0.0, 0.0, 0.0, 1.0])[1]]
}

fn falling(shapes: Vec<Shape>) -> SceneDef {
    let body = BodyDef {
        mass: Some(1.0),
        inertia: Some(0.1),
        velocity: [0.0, -2.0],
        shapes,
        ..block("body", [1.0, 1.0], [0.0, 1.0])
    };
    let def = SceneDef { dt: 0.005, bodies: vec![floor(), body], ..SceneDef::default() };
    resolved(material(def, 0.0, 0.8))
}

/// A disc: by where its centre is in the body, and by the floor's line.
#[test]
fn disc() {
    let [height, by_place, by_radius] = exact(0.1);
    for solver in backends() {
        let scene = built(&dropped(0.1, 1.0, -2.0, 0.8));
        let by = |number| slope(&scene, &*solver, Param::Shape(1, 0, number), height);
        near_relative("by the centre", by(ShapeNumber::Center(1)), -by_radius, 1e-8);
        let offset = Param::Shape(0, 0, ShapeNumber::Offset);
        let by_offset = slope(&scene, &*solver, offset, height);
        near_relative("by the floor", by_offset, 1.0 - by_place, 1e-8);
        let long = Param::Shape(0, 0, ShapeNumber::Normal(1));
        near("by the length of its normal", slope(&scene, &*solver, long, height), 0.0, 1e-12);
    }
}

/// A box that lands flat: by its height ½ of that by r, by its width nothing.
#[test]
fn flat_box() {
    let [height, _, by_radius] = exact(0.1);
    for solver in backends() {
        let shape = Shape::Rectangle { width: 0.4, height: 0.2, center: [0.0; 2], angle: 0.0 };
        let scene = built(&falling(vec![shape]));
        let by =
            |axis| slope(&scene, &*solver, Param::Shape(1, 0, ShapeNumber::Size(axis)), height);
        near_relative("by its height", by(1), 0.5 * by_radius, 1e-8);
        near("by its width", by(0), 0.0, 1e-9);
    }
}

/// A wedge that lands on its lowest vertex, below its centre.
#[test]
fn wedge() {
    let points = vec![[0.0, -0.3], [0.2, 0.15], [-0.2, 0.15]];
    let [height, _, by_radius] = exact(0.3);
    for solver in backends() {
        let scene = built(&falling(vec![Shape::Polygon { points: points.clone() }]));
        let by = |vertex, axis| {
            let number = ShapeNumber::Vertex(vertex, axis);
            slope(&scene, &*solver, Param::Shape(1, 0, number), height)
        };
        near_relative("by its point", by(0, 1), -by_radius, 1e-8);
        near("by another", by(1, 1), 0.0, 1e-12);
    }
}

/// A capsule upright: by its lower end.
#[test]
fn capsule() {
    let [height, _, by_radius] = exact(0.3);
    for solver in backends() {
        let shape = Shape::Capsule { a: [0.0, -0.2], b: [0.0, 0.2], radius: 0.1 };
        let scene = built(&falling(vec![shape]));
        let by = |end| {
            let number = ShapeNumber::Vertex(end, 1);
            slope(&scene, &*solver, Param::Shape(1, 0, number), height)
        };
        near_relative("by its lower end", by(0), -by_radius, 1e-8);
        near("by its upper end", by(1), 0.0, 1e-12);
        let radius = slope(&scene, &*solver, Param::Radius(1, 0), height);
        near_relative("by its radius", radius, by_radius, 1e-8);
    }
}

/// What makes no such shape is refused, and nothing changes.
#[test]
fn refusals() {
    let triangle = Shape::Polygon { points: vec![[0.0, -0.3], [0.2, 0.15], [-0.2, 0.15]] };
    let square = Shape::Rectangle { width: 0.4, height: 0.2, center: [0.0; 2], angle: 0.0 };
    let mut scene = built(&falling(vec![triangle, square]));
    let before = scene.colliders()[1].shapes().to_vec();
    for (shape, number, value, message) in [
        (0, ShapeNumber::Vertex(0, 1), 0.5, "other vertices"),
        (0, ShapeNumber::Vertex(0, 1), 0.15, "area"),
        (0, ShapeNumber::Vertex(0, 1), f64::NAN, "finite"),
        (0, ShapeNumber::Vertex(3, 1), 0.0, "no such number"),
        (0, ShapeNumber::Size(0), 1.0, "no such number"),
        (1, ShapeNumber::Size(0), -1.0, "positive"),
        (1, ShapeNumber::Size(2), 1.0, "no such number"),
        (1, ShapeNumber::Center(2), 1.0, "no such number"),
    ] {
        let error = scene.set(Param::Shape(1, shape, number), value).expect_err("refused");
        let error = format!("{error}");
        assert!(error.contains(message), "{number:?} = {value}: {error}");
        assert_eq!(scene.colliders()[1].shapes(), before);
    }
}

/// The numbers of shapes by name: every shape of the body that has such a number.
#[test]
fn names() {
    let triangle = Shape::Polygon { points: vec![[0.0, -0.3], [0.2, 0.15], [-0.2, 0.15]] };
    let square = Shape::Rectangle { width: 0.4, height: 0.2, center: [0.0; 2], angle: 0.0 };
    let mut def = falling(vec![triangle, square.clone(), square]);
    def.bodies[1].shapes.push(Shape::Circle { radius: 0.1, center: [0.0; 2] });
    let scene = built(&def);
    for (name, targets) in [
        ("width:body", vec![(1, 1, ShapeNumber::Size(0)), (1, 2, ShapeNumber::Size(0))]),
        ("height:body", vec![(1, 1, ShapeNumber::Size(1)), (1, 2, ShapeNumber::Size(1))]),
        ("center.y:body", [1, 2, 3].map(|k| (1, k, ShapeNumber::Center(1))).to_vec()),
        ("shape_angle:body", [1, 2].map(|k| (1, k, ShapeNumber::Angle)).to_vec()),
        ("vertex.2.x:body", vec![(1, 0, ShapeNumber::Vertex(2, 0))]),
        ("offset:floor", vec![(0, 0, ShapeNumber::Offset)]),
        ("normal.x:floor", vec![(0, 0, ShapeNumber::Normal(0))]),
    ] {
        let found = Parameter::parse(&scene, name).expect("a name").targets;
        let expected = targets.into_iter().map(|(i, k, number)| (Param::Shape(i, k, number), 1.0));
        assert_eq!(found, expected.collect::<Vec<_>>(), "{name}");
    }
    for (name, message) in [
        (
            "vertex.x:body",
            "\"vertex.x:body\": name a point and a component, as in `vertex.2.x:wedge`",
        ),
        ("vertex.3.x:body", "\"vertex.3.x:body\": \"body\" has no vertex"),
        ("width:floor", "\"width:floor\": \"floor\" has no width"),
        (
            "width.x:body",
            "\"width.x:body\": this quantity has no components; leave out what follows `.`",
        ),
    ] {
        let error = Parameter::parse(&scene, name).expect_err("no such name");
        assert_eq!(error.to_string(), message);
    }
}
