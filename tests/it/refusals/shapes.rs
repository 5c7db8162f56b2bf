//! Shapes.

use tangency::{SceneDef, Shape};

use super::check;

#[test]
fn shapes() {
    let shape = |shape: Shape| move |d: &mut SceneDef| d.bodies[1].shapes = vec![shape];
    let polygon = |points: &[[f64; 2]]| Shape::Polygon { points: points.to_vec() };
    check(
        shape(Shape::Circle { radius: -1.0, center: [0.0; 2] }),
        "bodies[1].shapes[0]: radius is -1; it must be positive and finite",
    );
    check(
        shape(Shape::Rectangle { width: 0.0, height: 1.0, center: [0.0; 2], angle: 0.0 }),
        "bodies[1].shapes[0]: width is 0; it must be positive and finite",
    );
    check(
        shape(polygon(&[[0.0, 0.0], [1.0, 0.0]])),
        "bodies[1].shapes[0]: points has 2 entries; a polygon needs at least 3",
    );
    check(
        shape(polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])),
        "bodies[1].shapes[0]: points span an area of 0 m² over an extent of 2 m; move a point off \
         the line of the others",
    );
    check(
        shape(polygon(&[[0.0, f64::NAN], [1.0, 1.0], [2.0, 0.0]])),
        "bodies[1].shapes[0]: points is NaN; it must be finite",
    );
    check(
        shape(Shape::Capsule { a: [0.0; 2], b: [0.0; 2], radius: 0.5 }),
        "bodies[1].shapes[0]: a and b of the capsule are 0 m apart; use a circle of radius 0.5 \
         instead",
    );
    check(
        |d| d.bodies[0].shapes = vec![Shape::HalfPlane { normal: [0.0; 2], offset: 0.0 }],
        "bodies[0].shapes[0]: normal is [0.0, 0.0]; it must have a direction, give for example [0, 1]",
    );
}
