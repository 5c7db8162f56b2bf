use std::fs;

use tangency_core::{
    BodyDef, ContactModel, ControlDef, ControlInput, Correction, ForceDef, JointDef, JointKind,
    Limits, Motor, PairDef, Shape, Softness, Stabilisation,
};

use super::*;

mod texts;

const BODY: &str = "[[bodies]]\nname = \"a\"\n";
const JOINT: &str = "[[joints]]\nname = \"j\"\nbodies = [\"a\", \"b\"]\n";

/// What is wrong with a text, its form or its values.
#[track_caller]
fn complaint(text: &str, format: SceneFormat) -> String {
    match parse_scene(text, format) {
        Err(error) => error.to_string(),
        Ok(def) => {
            let error = Scene::new(&def).expect_err("the scene should be refused");
            SceneFileError::refused(error, text, format).to_string()
        }
    }
}

#[track_caller]
fn toml(text: &str, expected: &str) {
    assert_eq!(complaint(text, SceneFormat::Toml), expected);
}

#[track_caller]
fn json(text: &str, expected: &str) {
    assert_eq!(complaint(text, SceneFormat::Json), expected);
}

#[test]
fn toml_syntax_errors_name_the_line_and_quote_it() {
    toml("dt = 0.1.2", "line 1, column 9: invalid float, in `dt = 0.1.2`");
    toml("dt = 1\ndt = 2", "line 2, column 1: duplicate key, in `dt = 2`");
    toml("[[bodies]\n", "line 1, column 10: unclosed array table, expected `]`, in `[[bodies]`");
}

#[test]
fn json_syntax_errors_name_the_line_and_quote_it() {
    json("{\"dt\": 0.1,\n", "line 2, column 1: EOF while parsing an object");
    json("{\"dt\": 0.1,}", "line 1, column 12: key must be a string, in `{\"dt\": 0.1,}`");
    json("{\"dt\": 0.1} x", "line 1, column 13: trailing characters, in `{\"dt\": 0.1} x`");
}

#[test]
fn unknown_keys_are_errors_with_a_suggestion() {
    let known = "expected one of `name`, `kind`, `position`, `angle`, `velocity`, \
                 `angular_velocity`, `shapes`, `mass`, `density`, `inertia`, `friction`, \
                 `restitution`, `gravity_scale`, `groups`, `category`, `mask`";
    toml(
        &format!("{BODY}masss = 3"),
        &format!(
            "line 3, column 1: bodies[0].masss: unknown field `masss`, {known}; did you mean `mass`?"
        ),
    );
    json(
        "{\"bodies\": [{\n\"masss\": 3}]}",
        &format!(
            "line 2, column 10: bodies[0].masss: unknown field `masss`, {known}; did you mean `mass`?"
        ),
    );
    toml(
        &format!("{BODY}wheels = 3"),
        &format!(
            "line 3, column 1: bodies[0].wheels: unknown field `wheels`, {known}; correct or remove it"
        ),
    );
    toml(
        &format!("{BODY}shapes = [{{ circle = {{ radus = 1.0 }} }}]"),
        "line 3, column 24: bodies[0].shapes[0].circle.radus: unknown field `radus`, expected one \
         of `radius`, `center`; did you mean `radius`?",
    );
    toml(
        &format!("{JOINT}[joints.kind]\nrevolute = {{ anchor = [0, 0], motor = {{ spid = 1 }} }}"),
        "line 5, column 41: joints[0].kind.revolute.motor.spid: unknown field `spid`, expected \
         `speed` or `max`; did you mean `speed`?",
    );
}

#[test]
fn unknown_variants_are_errors_with_a_suggestion() {
    let known = "expected one of `circle`, `rectangle`, `polygon`, `capsule`, `half_plane`";
    toml(
        &format!("{BODY}shapes = [{{ circel = {{ radius = 1.0 }} }}]"),
        &format!(
            "line 3, column 11: bodies[0].shapes[0]: unknown variant `circel`, {known}; did you mean `circle`?"
        ),
    );
    toml(
        &format!("{BODY}kind = \"dynamik\""),
        "line 3, column 1: bodies[0].kind: unknown variant `dynamik`, expected one of `dynamic`, \
         `static`, `kinematic`; did you mean `dynamic`?",
    );
    json(
        "{\"contact_model\": \"gapp\"}",
        "line 1, column 19: contact_model: unknown variant `gapp`, expected `gap` or `velocity`; \
         did you mean `gap`?",
    );
}

#[test]
fn missing_keys_are_errors_at_their_table() {
    toml(
        &format!("{JOINT}[joints.kind]\nrevolute = {{}}"),
        "line 5, column 1: joints[0].kind.revolute: missing field `anchor`; add it",
    );
    toml(
        &format!("{JOINT}[joints.kind]"),
        "line 4, column 9: joints[0].kind: an empty table, expected one key",
    );
    json(
        "{\"bodies\": [{\"shapes\": [\n{\"circle\": {}}]}]}",
        "line 2, column 12: bodies[0].shapes[0].circle: missing field `radius`; add it",
    );
}

#[test]
fn wrong_types_are_errors_that_quote_the_value() {
    toml(
        &format!("{BODY}mass = \"heavy\""),
        "line 3, column 1: bodies[0].mass: invalid type: string \"heavy\", expected a number",
    );
    json(
        "{\"bodies\": [{\n\"mass\": \"heavy\"}]}",
        "line 2, column 9: bodies[0].mass: invalid type: string \"heavy\", expected a number",
    );
    toml(
        &format!("{BODY}mask = -1"),
        "line 3, column 1: bodies[0].mask: invalid value: integer `-1`, expected a whole number \
         from 0 to 4294967295",
    );
    toml("bodies = 3", "line 1, column 1: bodies: invalid type: integer `3`, expected an array");
    json("3", "line 1, column 1: scene: invalid type: integer `3`, expected a table");
    toml(
        "contact_model = 3",
        "line 1, column 1: contact_model: expected a name, or a table with one key",
    );
}

#[test]
fn arrays_of_the_wrong_length_are_errors() {
    let path = "bodies[0].position: invalid length";
    toml(
        &format!("{BODY}position = [1, 2, 3]"),
        &format!("line 3, column 1: {path} 3, expected an array of length 2"),
    );
    toml(
        &format!("{BODY}position = [1]"),
        &format!("line 3, column 1: {path} 1, expected an array of length 2"),
    );
    json(
        "{\"bodies\": [{\n\"position\": [1, 2, 3]}]}",
        "line 2, column 13: bodies[0].position: more elements than this array takes; remove them",
    );
    json("[]", "line 1, column 1: scene: invalid type: array, expected a table");
    toml(
        "bodies = [[\"a\"]]",
        "line 1, column 11: bodies[0]: invalid type: array, expected a table",
    );
}

#[test]
fn refused_values_are_found_in_the_text() {
    let disc = "shapes = [{ circle = { radius = 1.0 } }]\n";
    toml("dt = -1.0", "line 1, column 1: dt is -1: give a positive finite number");
    toml(
        &format!("{BODY}{disc}mass = -2.0"),
        "line 4, column 1: bodies[0].mass is -2: give a positive finite number",
    );
    json(
        "{\"bodies\": [{\"name\": \"a\", \"shapes\": [{\"circle\": {\"radius\": 1}}],\n\"mass\": -2}]}",
        "line 2, column 9: bodies[0].mass is -2: give a positive finite number",
    );
    toml(
        &format!("{BODY}{disc}\n[[bodies]]\nname = \"a\"\n{disc}"),
        "line 6, column 1: bodies[1].name is \"a\": this name is taken; choose another",
    );
    toml(
        &format!(
            "{BODY}{disc}{JOINT}[joints.kind.revolute]\nanchor = [0, 0]\n\
             motor = {{ speed = 1, max = -2.0 }}"
        )
        .replace("\"b\"", "\"world\""),
        "line 9, column 22: joints[0].kind.revolute.motor.max is -2: give a positive finite number",
    );
}

#[test]
fn files_are_named_in_errors() {
    let folder = std::env::temp_dir().join(format!("tangency-scene-file-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("the temporary folder is writable");
    let complain = |name: &str, text: &str| {
        let file = folder.join(name);
        fs::write(&file, text).expect("the temporary folder is writable");
        let message = load_scene(&file).expect_err("the scene is wrong").to_string();
        message.replace(&folder.display().to_string(), "folder")
    };
    let file = "folder/scene.toml:3:1: bodies[0].mass";
    assert_eq!(
        complain("scene.toml", &format!("{BODY}mass = true")),
        format!("{file}: invalid type: boolean `true`, expected a number")
    );
    assert_eq!(
        complain(
            "scene.toml",
            &format!("{BODY}mass = -1.0\nshapes = [{{ circle = {{ radius = 1 }} }}]")
        ),
        format!("{file} is -1: give a positive finite number")
    );
    assert_eq!(
        complain("scene.yaml", "dt: 1"),
        "folder/scene.yaml: unknown scene format; name the file `.toml` or `.json`"
    );
    fs::remove_dir_all(&folder).expect("the temporary folder is ours");
    assert_eq!(
        load_scene(folder.join("gone.toml")).expect_err("there is no file").to_string(),
        format!(
            "{}/gone.toml: cannot be read; check the path and its permissions",
            folder.display()
        )
    );
}

#[test]
fn examples_of_the_documentation_are_scenes() {
    let page = include_str!("../../docs/scene-file.md");
    let examples: Vec<&str> = page.split("```toml\n").skip(1).collect();
    assert!(examples.len() >= 4);
    for example in examples {
        let text = example.split("```").next().unwrap_or_default();
        let def = parse_scene(text, SceneFormat::Toml).unwrap_or_else(|e| panic!("{e}\n{text}"));
        Scene::new(&def).unwrap_or_else(|e| panic!("{e}\n{text}"));
    }
}

#[test]
fn definitions_survive_both_formats() {
    let def = everything();
    assert_eq!(parse_scene(&scene_to_toml(&def), SceneFormat::Toml).expect("its own text"), def);
    assert_eq!(parse_scene(&scene_to_json(&def), SceneFormat::Json).expect("its own text"), def);
    let empty = SceneDef::default();
    assert_eq!(
        parse_scene(&scene_to_toml(&empty), SceneFormat::Toml).expect("its own text"),
        empty
    );
    assert_eq!(parse_scene("", SceneFormat::Toml).expect("all keys have defaults"), empty);
}

/// A definition with every kind of part and awkward numbers.
fn everything() -> SceneDef {
    let awkward = [0.1 + 0.2, 1.0 / 3.0];
    let limits = Limits { lower: Some(-1e-300), upper: None };
    let motor = Some(Motor { speed: 5e-324, max: Some(1.797_693_134_862_315_7e308) });
    let [anchor, axis, anchor_a, anchor_b] = [awkward; 4];
    let kinds = [
        JointKind::Revolute { anchor, anchor_b: Some(axis), limits, motor },
        JointKind::Weld { anchor },
        JointKind::Prismatic { anchor, axis, limits, motor: None },
        JointKind::Distance { anchor_a, anchor_b, length: None },
        JointKind::Slot { anchor, axis, limits: Limits::default(), motor },
        JointKind::Lock { x: true, y: false, rotation: true },
        JointKind::Spring { anchor_a, anchor_b, length: Some(0.7), stiffness: 1e9, damping: 0.1 },
    ];
    let shapes = vec![
        Shape::Circle { radius: 0.1, center: awkward },
        Shape::Rectangle { width: 0.1, height: 0.3, center: awkward, angle: -0.0 },
        Shape::Polygon { points: vec![awkward, [0.0, 1.0], [-1.0, 0.0]] },
        Shape::Capsule { a: awkward, b: [0.0, 1.0], radius: 2.0 },
        Shape::HalfPlane { normal: awkward, offset: 1e-17 },
    ];
    let joint = |(i, kind): (usize, JointKind)| JointDef {
        name: format!("joint \"{i}\"\n"),
        bodies: ["a".into(), "world".into()],
        kind,
        collide: i == 0,
        softness: (i == 1).then_some(Softness { stiffness: 1.0, damping: 0.1 }),
    };
    SceneDef {
        name: "everything: \"quotes\", ünïcode".into(),
        contact_model: ContactModel::Velocity { contact_distance: 1e-3 },
        stabilisation: Stabilisation {
            joints: Correction::None,
            contacts: Correction::Baumgarte { fraction: 0.2 },
        },
        bodies: vec![BodyDef {
            name: "a".into(),
            shapes,
            mass: Some(0.7),
            groups: vec!["links".into()],
            ..BodyDef::default()
        }],
        joints: kinds.into_iter().enumerate().map(joint).collect(),
        forces: vec![ForceDef { body: "a".into(), end: Some(0.1), ..ForceDef::default() }],
        controls: vec![ControlDef {
            name: "u".into(),
            input: ControlInput::MotorSpeed { joint: "j".into() },
        }],
        pairs: vec![PairDef { restitution: Some(1.0), ..PairDef::default() }],
        ..SceneDef::default()
    }
}
