//! Closed forms of mass properties, refused shapes, and the scene file's spelling.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector2;
use tangency_collision::{Collider, MassProperties, Shape, ShapeError, convex_hull};

use crate::support::{capsule, circle, ground, rectangle};

#[track_caller]
fn check_mass(shape: &Shape, area: f64, centroid: [f64; 2], second_moment: f64) {
    let found = shape.mass_properties().expect("a bounded shape");
    assert_relative_eq!(found.area, area, max_relative = 1e-14);
    assert_relative_eq!(found.centroid, Vector2::from(centroid), epsilon = 1e-14);
    assert_relative_eq!(found.second_moment, second_moment, max_relative = 1e-13);
}

#[test]
fn closed_forms() {
    let off = Shape::Circle { radius: 2.0, center: [3.0, -1.0] };
    check_mass(&off, 4.0 * PI, [3.0, -1.0], 8.0 * PI);
    let turned = Shape::Rectangle { width: 3.0, height: 1.0, center: [1.0, 2.0], angle: 0.7 };
    check_mass(&turned, 3.0, [1.0, 2.0], 3.0 * 10.0 / 12.0);
    // Right triangle with legs 3 and 6: I = A (b² + h²)/18 about the centroid.
    let triangle = Shape::Polygon { points: vec![[1.0, 1.0], [4.0, 1.0], [1.0, 7.0]] };
    check_mass(&triangle, 9.0, [2.0, 3.0], 9.0 * 45.0 / 18.0);
    // Regular hexagon of side s: A = 3√3/2 s², I = 5√3/8 s⁴ about the centre (twice 5√3/16 s⁴).
    let corner = |k: i32| [(f64::from(k) * PI / 3.0).cos(), (f64::from(k) * PI / 3.0).sin()];
    let hexagon = Shape::Polygon { points: (0..6).map(corner).collect() };
    let root = 3.0_f64.sqrt();
    check_mass(&hexagon, 1.5 * root, [0.0; 2], 5.0 * root / 8.0);
    assert!(ground().mass_properties().is_none());
}

#[test]
fn capsule_is_a_rectangle_and_two_half_discs() {
    // L = 2, r = 1: area 4 + π; half discs' centroids at 1 + 4/(3π) from the middle.
    let c = 4.0 / (3.0 * PI);
    let half_disc = PI / 2.0;
    let about_own = PI / 4.0 - half_disc * c * c;
    let caps = 2.0 * (about_own + half_disc * (1.0 + c).powi(2));
    check_mass(&capsule(2.0, 1.0), 4.0 + PI, [0.0; 2], 4.0 * 8.0 / 12.0 + caps);
}

#[test]
fn halves_combine_to_the_whole() {
    let half = |x| Shape::Rectangle { width: 1.0, height: 3.0, center: [x, 0.5], angle: 0.0 };
    let parts = [half(-0.5), half(0.5)];
    let both = MassProperties::combined(parts.iter().filter_map(Shape::mass_properties))
        .expect("two parts");
    assert_relative_eq!(both.area, 6.0);
    assert_relative_eq!(both.centroid, Vector2::new(0.0, 0.5));
    assert_relative_eq!(both.second_moment, 6.0 * 13.0 / 12.0, max_relative = 1e-14);
    assert!(MassProperties::combined(std::iter::empty()).is_none());
}

#[test]
fn moving_a_shape_moves_its_centroid_only() {
    let by = Vector2::new(0.3, -2.0);
    let triangle = Shape::Polygon { points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] };
    for shape in [circle(0.4), rectangle(1.0, 2.0), capsule(1.0, 0.2), triangle] {
        let (here, there) = (shape.mass_properties(), shape.translated(by).mass_properties());
        let (here, there) = (here.expect("bounded"), there.expect("bounded"));
        assert_relative_eq!(there.centroid, here.centroid + by, epsilon = 1e-14);
        assert_relative_eq!(there.second_moment, here.second_moment, max_relative = 1e-12);
    }
    let slope = Shape::HalfPlane { normal: [0.0, 5.0], offset: 1.0 };
    assert_eq!(slope.translated(by), Shape::HalfPlane { normal: [0.0, 5.0], offset: -1.0 });
}

#[test]
fn bounding_radius() {
    let radius = |shapes: &[Shape]| Collider::new(shapes).expect("valid").radius();
    assert_relative_eq!(radius(&[rectangle(3.0, 4.0)]), 2.5);
    assert_relative_eq!(radius(&[capsule(2.0, 0.5), circle(0.1)]), 1.5);
    assert!(radius(&[circle(1.0), ground()]).is_infinite());
}

#[test]
fn hull_keeps_the_order_of_a_convex_polygon() {
    let square = [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]];
    assert_eq!(convex_hull(&square), [0, 1, 2, 3]);
    let clockwise = [[1.0, 0.0], [1.0, 1.0], [2.0, 1.0], [2.0, 0.0]];
    assert_eq!(convex_hull(&clockwise), [0, 3, 2, 1]);
    let with_more = [[0.5, 0.5], [0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert_eq!(convex_hull(&with_more), [1, 3, 4, 5]);
}

#[track_caller]
fn check_refused(shape: Shape, message: &str) {
    let error = Collider::new(&[shape]).expect_err("an invalid shape");
    assert_eq!(error.to_string(), message);
}

#[test]
fn refused_shapes() {
    check_refused(circle(-1.0), "radius is -1; it must be positive and finite");
    check_refused(circle(f64::NAN), "radius is NaN; it must be positive and finite");
    check_refused(rectangle(0.0, 1.0), "width is 0; it must be positive and finite");
    check_refused(rectangle(1.0, f64::INFINITY), "height is inf; it must be positive and finite");
    check_refused(
        Shape::Circle { radius: 1.0, center: [0.0, f64::NAN] },
        "center is NaN; it must be finite",
    );
    check_refused(
        Shape::Polygon { points: vec![[0.0; 2]; 2] },
        "points has 2 entries; a polygon needs at least 3",
    );
    check_refused(
        capsule(0.0, 0.5),
        "a and b of the capsule are 0 m apart; use a circle of radius 0.5 instead",
    );
    check_refused(
        Shape::HalfPlane { normal: [0.0; 2], offset: 0.0 },
        "normal is [0.0, 0.0]; it must have a direction, give for example [0, 1]",
    );
    let line = Shape::Polygon { points: vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0 + 1e-12]] };
    assert!(matches!(Collider::new(&[line]), Err(ShapeError::DegenerateHull { .. })));
    let point = Shape::Polygon { points: vec![[1.0, 1.0]; 5] };
    assert!(matches!(Collider::new(&[point]), Err(ShapeError::DegenerateHull { .. })));
    assert_eq!(Collider::new(&[]).map(|c| (c.is_empty(), c.radius())), Ok((true, 0.0)));
}

#[test]
fn scene_file_spelling() {
    let read = |text: &str| serde_json::from_str::<Shape>(text);
    assert_eq!(read(r#"{"circle": {"radius": 0.1}}"#).expect("a circle"), circle(0.1));
    let plane = read(r#"{"half_plane": {"normal": [0, 1]}}"#).expect("a half-plane");
    assert_eq!(plane, ground());
    assert!(read(r#"{"circle": {"radius": 0.1, "centre": [0, 0]}}"#).is_err());
    for shape in [rectangle(1.0, 2.0), capsule(1.0, 0.5)] {
        let text = serde_json::to_string(&shape).expect("numbers");
        assert_eq!(read(&text).expect("what was written"), shape);
    }
}
