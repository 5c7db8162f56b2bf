//! Pictures, pixel by pixel.

use tangency_core::{
    BodyDef, BodyKind, JointDef, JointKind, Limits, Scene, SceneDef, Shape, State, WORLD,
};
use tangency_view::{Image, Picture, Rgb, Style, View, ViewError};

const WHITE: Rgb = [255; 3];
const RED: Rgb = [255, 0, 0];
/// The first colour of the replay page.
const BLUE: Rgb = [0x4e, 0x79, 0xa7];

fn body(kind: BodyKind, position: [f64; 2], angle: f64, shapes: Vec<Shape>) -> BodyDef {
    BodyDef { name: "body".into(), kind, position, angle, shapes, ..BodyDef::default() }
}

fn scene(bodies: Vec<BodyDef>) -> Scene {
    let named = bodies.into_iter().enumerate();
    let bodies = named.map(|(i, body)| BodyDef { name: format!("body{i}"), ..body }).collect();
    Scene::new(&SceneDef { bodies, ..SceneDef::default() }).expect("valid")
}

fn one(shape: Shape, position: [f64; 2], angle: f64) -> Scene {
    scene(vec![body(BodyKind::Dynamic, position, angle, vec![shape])])
}

/// 4 m × 2 m on 400 × 200 pixels, so that a metre is 100 pixels and (0, 0) the middle.
fn picture() -> Picture {
    let view = View { lower: [-2.0, -1.0], upper: [2.0, 1.0] };
    Picture { width: 400, height: 200, view, style: Style::default() }
}

fn draw(picture: &Picture, scene: &Scene) -> Image {
    picture.draw(scene, &scene.initial_state()).expect("a picture")
}

/// The colour at a point of the world in [`picture`]'s view.
fn at(image: &Image, [x, y]: [f64; 2]) -> Rgb {
    let (column, row) = (200.0 + 100.0 * x, 100.0 - 100.0 * y);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in the picture")]
    let k = 3 * (400 * row as usize + column as usize);
    let rgb = image.to_rgb();
    [rgb[k], rgb[k + 1], rgb[k + 2]]
}

/// Area that is not background, m²: how far each pixel is from white towards the red of its body.
fn area(image: &Image) -> f64 {
    let covered = |pixel: &[u8]| 1.0 - f64::from(pixel[2]) / 255.0;
    image.to_rgb().chunks(3).map(covered).sum::<f64>() / 1e4
}

fn red() -> Picture {
    let colors = [(0, RED)].into();
    Picture { style: Style { colors, ..Style::default() }, ..picture() }
}

#[test]
fn a_disc_has_its_colour_and_nothing_the_background() {
    let image = draw(&picture(), &one(disc(0.5), [-1.0, 0.25], 0.7));
    assert_eq!(at(&image, [-1.0, 0.25]), BLUE);
    assert_eq!(at(&image, [-1.0, 0.7]), BLUE);
    for outside in [[-1.0, 0.8], [-1.0, -0.3], [-1.55, 0.25], [0.0, 0.0], [1.9, -0.9]] {
        assert_eq!(at(&image, outside), WHITE, "{outside:?}");
    }
}

fn disc(radius: f64) -> Shape {
    Shape::Circle { radius, center: [0.0, 0.0] }
}

#[test]
fn y_points_up_and_x_to_the_right() {
    let image = draw(&red(), &one(disc(0.2), [1.5, 0.7], 0.0));
    let rgb = image.to_rgb();
    let inked = rgb.chunks(3).enumerate().filter(|(_, pixel)| *pixel != WHITE);
    for (k, _) in inked {
        assert!(k / 400 < 51 && k % 400 > 328, "row {}, column {}", k / 400, k % 400);
    }
    assert_eq!(at(&image, [1.5, 0.7]), RED);
}

#[test]
fn forms_have_their_areas() {
    let root = 2.0_f64.sqrt();
    let rectangle = Shape::Rectangle { width: 1.2, height: 0.8, center: [0.1, -0.05], angle: 0.3 };
    let capsule = Shape::Capsule { a: [-0.4, 0.1], b: [0.4, -0.1], radius: 0.3 };
    let points = vec![[-0.5, -0.5], [0.7, -0.5], [0.0, 0.0], [-0.5, 0.6]];
    let pi = std::f64::consts::PI;
    let cases = [
        (rectangle, 1.2 * 0.8),
        (disc(0.6), 0.36 * pi),
        (capsule, 0.09 * pi + 0.6 * (0.64_f64 + 0.04).sqrt()),
        (Shape::Polygon { points }, 0.5 * 1.2 * 1.1), // of the hull; (0, 0) is within
        (Shape::Rectangle { width: root, height: root, center: [0.0; 2], angle: pi / 4.0 }, 2.0),
    ];
    for (shape, expected) in cases {
        for angle in [0.0, 0.4, 2.0] {
            let found = area(&draw(&red(), &one(shape.clone(), [0.0, 0.0], angle)));
            assert!((found / expected - 1.0).abs() < 0.003, "{shape:?}: {found}");
        }
    }
}

#[test]
fn a_half_plane_fills_what_is_below_it() {
    let slope = Shape::HalfPlane { normal: [-1.0, 2.0], offset: 0.1 };
    let image = draw(&picture(), &scene(vec![body(BodyKind::Static, [0.0; 2], 0.0, vec![slope])]));
    // The edge is y = x/2 + 0.1 √5/2, solid below.
    let edge = |x: f64| 0.5 * x + 0.05 * 5.0_f64.sqrt();
    let ground = at(&image, [1.9, -0.9]);
    assert_ne!(ground, WHITE);
    for x in [-1.9, -1.0, 0.0, 0.5, 1.5] {
        assert_eq!(at(&image, [x, edge(x) + 0.03]), WHITE, "above at {x}");
        assert_eq!(at(&image, [x, (edge(x) - 0.05).max(-0.99)]), ground, "below at {x}");
    }
}

/// Whatever lies outside of the picture, and however far.
#[test]
fn what_is_far_larger_than_the_picture_ends_at_its_border() {
    for size in [1e2, 1e6, 1e12, 1e40] {
        let [width, height, center] = [size, size, -0.5 * size];
        let block = Shape::Rectangle { width, height, center: [0.0, center], angle: 0.0 };
        let fixed = body(BodyKind::Static, [0.0, 0.0], 0.0, vec![block]);
        let image = draw(&red(), &scene(vec![fixed]));
        assert_eq!(at(&image, [-1.9, 0.02]), WHITE, "{size:e}");
        assert_eq!(at(&image, [-1.9, -0.03]), RED, "{size:e}");
        assert_eq!(at(&image, [1.9, -0.95]), RED, "{size:e}");
    }
}

#[test]
fn the_mark_turns_with_the_body() {
    let dark = |angle: f64| {
        let image = draw(&red(), &one(disc(0.8), [0.0, 0.0], angle));
        [0.0_f64, 1.0, 2.0].map(|a| at(&image, [0.5 * a.cos(), 0.5 * a.sin()]) != RED)
    };
    assert_eq!(dark(0.0), [true, false, false]);
    assert_eq!(dark(1.0), [false, true, false]);
    assert_eq!(dark(2.0), [false, false, true]);
}

#[test]
fn joints_are_shown_unless_they_are_not_wanted() {
    let mut def = SceneDef {
        bodies: vec![body(BodyKind::Dynamic, [1.0, 0.0], 0.0, vec![disc(0.1)])],
        ..SceneDef::default()
    };
    let bare = Scene::new(&def).expect("valid");
    let ends = ([-1.0, 0.0], [1.0, 0.0]);
    let kinds = [
        JointKind::Distance { anchor_a: ends.0, anchor_b: ends.1, length: None },
        JointKind::Spring {
            anchor_a: ends.0,
            anchor_b: ends.1,
            length: None,
            stiffness: 1.0,
            damping: 0.0,
        },
        JointKind::Slot {
            anchor: ends.1,
            axis: [1.0, 0.0],
            limits: Limits::default(),
            motor: None,
        },
    ];
    let mut hidden = picture();
    hidden.style.joints = false;
    for kind in kinds {
        let bodies = [WORLD.into(), "body".into()];
        let name = "joint".into();
        def.joints = vec![JointDef { name, bodies, kind, collide: false, softness: None }];
        let scene = Scene::new(&def).expect("valid");
        let shown = draw(&picture(), &scene);
        let row = (-180..80).map(|x| at(&shown, [f64::from(x) / 100.0, 0.0]));
        assert!(row.filter(|pixel| *pixel != WHITE).count() > 15, "{:?}", def.joints[0].kind);
        assert_eq!(draw(&hidden, &scene), draw(&picture(), &bare));
    }
}

#[test]
fn colours_follow_groups_and_can_be_chosen() {
    let at_x = |x: f64, groups: &[&str]| BodyDef {
        groups: groups.iter().map(|g| (*g).into()).collect(),
        ..body(BodyKind::Dynamic, [x, 0.0], 0.0, vec![disc(0.2)])
    };
    let scene = scene(vec![at_x(-1.5, &["a"]), at_x(-0.5, &[]), at_x(0.5, &["a"]), at_x(1.5, &[])]);
    let mut wanted = picture();
    wanted.style.colors = [(1, RED)].into();
    let image = draw(&wanted, &scene);
    let found = [-1.5, -0.5, 0.5, 1.5].map(|x| at(&image, [x, 0.0]));
    assert_eq!(found, [BLUE, RED, BLUE, [0x5b, 0x9f, 0x78]]);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let scene =
        one(Shape::Capsule { a: [-0.3, 0.0], b: [0.4, 0.2], radius: 0.21 }, [0.1, 0.2], 0.3);
    let image = draw(&picture(), &scene);
    assert_eq!(image.to_rgb(), draw(&picture(), &scene).to_rgb());
    assert_eq!((image.width(), image.height()), (400, 200));
    assert_eq!(image.to_rgb().len(), 3 * 400 * 200);
    let png = image.to_png().expect("encoded");
    assert_eq!(png, draw(&picture(), &scene).to_png().expect("encoded"));
    assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
    assert_eq!(png[16..24], [0, 0, 1, 144, 0, 0, 0, 200]); // width and height
}

#[test]
fn a_view_fits_bodies_and_runs() {
    let scene = one(disc(0.5), [3.0, 4.0], 0.0);
    let start = scene.initial_state();
    // The disc and 4 % of its size.
    let view = View::fit(&scene, [&start]).expect("a view");
    assert_close(view, View { lower: [2.46, 3.46], upper: [3.54, 4.54] });
    assert_close(View::fit(&scene, []).expect("a view"), view);
    let moved = |x: f64| {
        let mut state = start.clone();
        state.q[0].x += x;
        state
    };
    // A run to the right by 0.3, and 4 % of 1.3; one that flies off is followed for 0.6.
    let near = View::fit(&scene, [&start, &moved(0.3)]).expect("a view");
    assert_close(near, View { lower: [2.448, 3.448], upper: [3.852, 4.552] });
    let far = View::fit(&scene, [&start, &moved(100.0)]).expect("a view");
    assert_close(far, View { lower: [2.436, 3.436], upper: [4.164, 4.564] });
}

#[track_caller]
fn assert_close(found: View, expected: View) {
    let numbers = |v: View| [v.lower[0], v.lower[1], v.upper[0], v.upper[1]];
    for (a, b) in numbers(found).into_iter().zip(numbers(expected)) {
        assert!((a - b).abs() < 1e-12, "{found:?}, expected {expected:?}");
    }
}

#[test]
fn a_view_of_nothing_is_one_that_can_be_drawn() {
    let empty = scene(Vec::new());
    let view = View::fit(&empty, []).expect("a view");
    assert!(draw(&Picture { view, ..picture() }, &empty).to_rgb().iter().all(|c| *c == 255));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let scene = one(disc(0.5), [0.0, 0.0], 0.0);
    let state = scene.initial_state();
    let refuse = |picture: Picture, state: &State| picture.draw(&scene, state).expect_err("wrong");
    for [width, height] in [[0, 10], [10, 0], [8001, 10], [10, u32::MAX]] {
        let error = refuse(Picture { width, height, ..picture() }, &state);
        assert!(matches!(error, ViewError::Size { .. }), "{error}");
    }
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let views = [
        ([0.0, 0.0], [0.0, 1.0]),
        ([0.0, 2.0], [1.0, 1.0]),
        ([nan, 0.0], [1.0, 1.0]),
        ([0.0, 0.0], [1.0, nan]),
        ([-inf, 0.0], [1.0, 1.0]),
        ([0.0, 0.0], [inf, 1.0]),
        ([-1e308, 0.0], [1e308, 1.0]),
    ];
    for (lower, upper) in views {
        let error = refuse(Picture { view: View { lower, upper }, ..picture() }, &state);
        assert!(matches!(error, ViewError::View { .. }), "{error}");
    }
    let mut other = picture();
    other.style.colors = [(1, RED)].into();
    assert!(matches!(refuse(other, &state), ViewError::Body { body: 1, bodies: 1 }));
    let mut broken = state.clone();
    broken.q[0].x = nan;
    assert!(matches!(refuse(picture(), &broken), ViewError::State(_)));
    assert!(matches!(refuse(picture(), &State::default()), ViewError::State(_)));
    assert!(matches!(View::fit(&scene, [&broken]), Err(ViewError::State(_))));
}
