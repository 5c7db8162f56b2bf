//! Losses that name impulses, through the command.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// A ball that rests, a block that slides (μ = 1/2), a rod on a hinge that hangs, and a lever against its stop.
const SCENE: &str = r#"
version = 1
dt = 0.01
duration = 0.1

[[bodies]]
name = "floor"
kind = "static"
friction = 0.5
shapes = [{ half_plane = { normal = [0.0, 1.0], offset = 0.0 } }]

[[bodies]]
name = "ball"
mass = 2.0
position = [0.0, 0.1]
friction = 0.5
shapes = [{ circle = { radius = 0.1 } }]

[[bodies]]
name = "wide block"
mass = 3.0
position = [2.0, 0.1]
velocity = [2.0, 0.0]
friction = 0.5
shapes = [{ rectangle = { width = 0.8, height = 0.2 } }]

[[bodies]]
name = "rod"
mass = 0.5
inertia = 0.1
position = [5.0, 2.0]

[[bodies]]
name = "lever"
mass = 4.0
inertia = 0.2
position = [8.5, 2.0]

[[joints]]
name = "pin"
bodies = ["world", "rod"]
kind = { revolute = { anchor = [5.0, 2.5] } }

[[joints]]
name = "stop"
bodies = ["world", "lever"]
kind = { revolute = { anchor = [8.0, 2.0], limits = { lower = 0.0 } } }
"#;

fn folder(stepping: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let scene = SCENE.replace("version = 1", &format!("version = 1\nstepping = {stepping}"));
    fs::write(folder.path().join("rest.toml"), scene).expect("writable");
    folder
}

fn gradient(folder: &Path, loss: &str, wrt: &str, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
    command.current_dir(folder).args(["gradient", "rest.toml", "--json", "--loss", loss]);
    command.args(["--wrt", wrt]).args(more).output().expect("the command starts")
}

/// The loss and its derivative, which differences confirm.
#[track_caller]
fn check(folder: &Path, loss: &str, wrt: &str, exact: [f64; 2]) {
    let backends = tangency::BACKENDS.iter().map(|name| format!("--backend={name}"));
    let ways = backends
        .flat_map(|name| ["--check", "--checkpoints"].map(|way| [name.clone(), way.into()]));
    for more in ways {
        let more: [String; 2] = more;
        let output = gradient(folder, loss, wrt, &more.each_ref().map(String::as_str));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{loss} by {wrt}: {stderr}");
        let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let found = [&report["loss"], &report["parameters"][0]["gradient"]];
        for (found, exact) in found.into_iter().zip(exact) {
            let found = found.as_f64().expect("a number");
            assert!((found - exact).abs() < 1e-9, "{loss} by {wrt}: {found}, not {exact}");
        }
    }
}

#[test]
fn impulses_of_what_rests_slides_and_hangs() {
    let folder = folder(r#""fixed""#);
    let fall = 9.81 * 0.01;
    check(folder.path(), "impulse(ball, floor).n", "mass:ball", [2.0 * fall, fall]);
    check(
        folder.path(),
        "impulse(floor,ball).n^2",
        "gravity.y",
        [(2.0 * fall).powi(2), -0.08 * fall],
    );
    // To the left: along the normal turned by a quarter.
    let slides = 0.5 * 3.0 * fall;
    check(
        folder.path(),
        "{impulse(floor, wide block).t}",
        "mass:wide block",
        [slides, slides / 3.0],
    );
    check(folder.path(), "impulse(pin).y + ball.x", "mass:rod", [0.5 * fall, fall]);
    // The lever's weight has half a metre, and so has the stop's moment.
    check(folder.path(), "impulse(stop).lower", "mass:lever", [4.0 * fall * 0.5, fall * 0.5]);
    check(folder.path(), "impulse(ball, rod).n", "mass:ball", [0.0, 0.0]);
}

/// Over the parts of the last step.
#[test]
fn impulses_of_accurate_steps() {
    let folder = folder("{ accurate = {} }");
    let fall = 9.81 * 0.01;
    check(folder.path(), "impulse(ball, floor).n", "mass:ball", [2.0 * fall, fall]);
    let slides = 0.5 * 3.0 * fall;
    check(
        folder.path(),
        "{impulse(floor, wide block).t}",
        "mass:wide block",
        [slides, slides / 3.0],
    );
    check(folder.path(), "impulse(pin).y", "mass:rod", [0.5 * fall, fall]);
}

#[test]
fn unknown_impulses_are_named() {
    let folder = folder(r#""fixed""#);
    for (loss, message) in [
        ("impulse(ball, flor).n", "the scene has no body `flor`"),
        ("impulse(ball, floor).x", "contacts have no impulse `.x`; take .n or .t"),
        ("impulse(pin).n", "joint `pin` has no impulse `.n`; it has .x, .y"),
        ("impulse(pim).x", "the scene has no joint `pim`; known: pin, stop"),
        ("impulse(ball, floor)", "unknown impulse `impulse(ball, floor)`; impulses are"),
        ("impulse(ball, floor", "`)` is missing"),
    ] {
        let output = gradient(folder.path(), loss, "mass:ball", &[]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{loss}: {stderr}");
        assert!(stderr.contains(message), "{loss}: {stderr}");
    }
}
