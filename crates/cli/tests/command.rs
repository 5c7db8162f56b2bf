//! The `tangency` command, run as a person would.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tangency_cli::trajectory_file::{COLUMNS, Row, read_rows};
use tempfile::TempDir;

const BALL: &str = r#"
dt = 0.1
duration = 1.0

[[bodies]]
name = "ball"
position = [0.1, 3.0]
velocity = [0.3, 0.0]
shapes = [{ circle = { radius = 0.1 } }]
"#;

fn folder() -> TempDir {
    tempfile::tempdir().expect("the temporary folder is writable")
}

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// Runs the command in a folder.
fn tangency(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
    command.current_dir(folder).args(arguments).output().expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the command prints UTF-8")
}

#[track_caller]
fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = tangency(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// The command fails with this exit code and these lines on stderr, and prints nothing else.
#[track_caller]
fn fail(folder: &Path, arguments: &[&str], code: i32, stderr: &str) {
    let output = tangency(folder, arguments);
    assert_eq!(text(&output.stderr), stderr);
    assert_eq!(output.status.code(), Some(code));
    assert_eq!(text(&output.stdout), "");
}

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).expect("the temporary folder is writable");
}

#[test]
fn simulate_writes_trajectory_and_replay_and_prints_a_summary() {
    let folder = folder();
    write(&folder, "ball.toml", BALL);
    let summary = succeed(folder.path(), &["simulate", "ball.toml"]);
    for line in [
        "ball",
        "simulated          1.000000 s in 10 steps",
        "worst residual     0.0e0",
        "paths              10 free, 0 linear, 0 complementarity steps; 0 mended",
        "written            out/ball/trajectory.csv",
        "written            out/ball/replay.html",
    ] {
        assert!(summary.lines().any(|found| found == line), "no line {line:?} in\n{summary}");
    }
    let csv = fs::read_to_string(folder.path().join("out/ball/trajectory.csv")).expect("written");
    assert_eq!(csv.lines().next(), Some(COLUMNS.join(",").as_str()));
    assert_eq!(csv.lines().nth(1), Some("0.0,ball,0.1,3.0,0.0,0.3,0.0,0.0"));
    assert_eq!(csv.lines().count(), 12);
    let page = fs::read_to_string(folder.path().join("out/ball/replay.html")).expect("written");
    assert!(page.contains("\"times\":[0,0.1,0.2"));
}

#[test]
fn both_formats_hold_exactly_the_same_numbers() {
    let folder = folder();
    write(&folder, "ball.toml", BALL);
    let read = |format: &str| -> Vec<Row> {
        succeed(folder.path(), &["simulate", "ball.toml", "--format", format, "--no-replay"]);
        read_rows(&folder.path().join(format!("out/ball/trajectory.{format}"))).expect("ours")
    };
    let (csv, jsonl) = (read("csv"), read("jsonl"));
    assert_eq!(csv, jsonl);
    // Semi-implicit Euler in free flight, in the engine's own order of operations.
    let (mut y, mut vy) = (3.0, 0.0);
    for row in &csv[1..] {
        vy += 0.1 * -9.81;
        y += 0.1 * vy;
        assert!((row.y - y).abs() < 1e-14 && (row.vy - vy).abs() < 1e-14, "{row:?}");
    }
    assert!(!folder.path().join("out/ball/replay.html").exists());
}

#[test]
fn options_change_step_length_and_folder() {
    let folder = folder();
    write(&folder, "ball.toml", BALL);
    let options = ["simulate", "ball.toml", "--dt", "0.05", "--duration", "0.5", "--out", "here"];
    let summary = succeed(folder.path(), &options);
    assert!(summary.contains("0.500000 s in 10 steps"), "{summary}");
    assert!(folder.path().join("here/trajectory.csv").exists());
}

#[test]
fn quiet_prints_nothing() {
    let folder = folder();
    write(&folder, "ball.toml", BALL);
    assert_eq!(succeed(folder.path(), &["--quiet", "simulate", "ball.toml"]), "");
    assert_eq!(succeed(folder.path(), &["inspect", "ball.toml", "-q"]), "");
}

#[test]
fn bad_scene_files_are_bad_input() {
    let folder = folder();
    write(&folder, "typo.toml", &BALL.replace("velocity", "velocty"));
    write(&folder, "sign.toml", &format!("{BALL}mass = -1.0\n"));
    write(&folder, "broken.toml", "dt = \n");
    write(&folder, "sign.json", "{\n  \"dt\": -0.1\n}\n");
    let path = folder.path();
    fail(
        path,
        &["simulate", "typo.toml"],
        2,
        "error: typo.toml:8:1: bodies[0].velocty: unknown field `velocty`, expected one of `name`, \
         `kind`, `position`, `angle`, `velocity`, `angular_velocity`, `shapes`, `mass`, `density`, \
         `inertia`, `friction`, `restitution`, `gravity_scale`, `groups`, `category`, `mask`; did \
         you mean `velocity`?\n",
    );
    fail(
        path,
        &["inspect", "sign.toml"],
        2,
        "error: sign.toml:10:1: bodies[0].mass is -1: give a positive finite number\n",
    );
    fail(
        path,
        &["inspect", "sign.json"],
        2,
        "error: sign.json:2:9: dt is -0.1: give a positive finite number\n",
    );
    fail(
        path,
        &["simulate", "broken.toml"],
        2,
        "error: broken.toml:1:6: string values must be quoted, expected literal string, in `dt =`\n",
    );
    fail(
        path,
        &["simulate", "gone.toml"],
        2,
        "error: gone.toml: cannot be read; check the path and its permissions\n  \
         because: No such file or directory (os error 2)\n",
    );
    fail(
        path,
        &["simulate", "scene.yaml"],
        2,
        "error: scene.yaml: unknown scene format; name the file `.toml` or `.json`\n",
    );
}

#[test]
fn bad_options_are_wrong_usage() {
    let folder = folder();
    write(&folder, "ball.toml", BALL);
    let usage = "\n\nFor more information, try '--help'.\n";
    fail(
        folder.path(),
        &["simulate", "ball.toml", "--dt", "-1"],
        2,
        &format!(
            "error: invalid value '-1' for '--dt <DT>': give a positive, finite number of seconds{usage}"
        ),
    );
    fail(
        folder.path(),
        &["inspect", "ball.toml", "--time", "soon"],
        2,
        &format!(
            "error: invalid value 'soon' for '--time <TIME>': give a number of seconds, such as 0.01{usage}"
        ),
    );
    fail(
        folder.path(),
        &["simulate", "ball.toml", "--backend", "magic"],
        2,
        &format!(
            "error: unknown backend `magic`; this build has: {}\n",
            tangency::BACKENDS.join(", ")
        ),
    );
    fail(
        folder.path(),
        &["simulate", "ball.toml", "--duration", "1e40"],
        2,
        "error: 1e41 steps of 0.1 s are more than 10000000; give a shorter time or a longer --dt\n",
    );
    assert_eq!(tangency(folder.path(), &["simulat"]).status.code(), Some(2));
}

#[test]
fn files_that_cannot_be_written_are_failures() {
    let folder = folder();
    write(&folder, "ball.toml", BALL);
    write(&folder, "taken", "a file where a folder should be");
    fail(
        folder.path(),
        &["simulate", "ball.toml", "--out", "taken"],
        1,
        "error: taken: cannot be written\n  because: File exists (os error 17)\n",
    );
}

#[test]
fn bad_trajectories_are_named_by_line_and_column() {
    let folder = folder();
    let header = COLUMNS.join(",");
    let file = folder.path().join("seen.csv");
    write(&folder, "seen.csv", &format!("{header}\n0,ball,1,2,3,4,5,six\n"));
    let message = read_rows(&file).expect_err("six is not a number").to_string();
    assert_eq!(
        message.replace(&folder.path().display().to_string(), "folder"),
        "folder/seen.csv:2: omega: invalid float literal; the columns are time, body, x, y, angle, \
         vx, vy, omega"
    );
}

#[test]
fn inspect_shows_what_is_modelled() {
    let folder = folder();
    write(&folder, "ball.toml", BALL);
    let shown = succeed(folder.path(), &["inspect", "ball.toml", "--time", "0.5"]);
    assert!(shown.contains("\nat 0.500000 s\n"), "{shown}");
    assert!(shown.contains("free flight      1: ball"), "{shown}");
}

#[test]
fn every_scene_of_the_repository_is_valid() {
    let folder = folder();
    let entries = fs::read_dir(scenes()).expect("the scenes are in the repository");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("readable").path()).collect();
    files.sort();
    assert!(files.len() >= 14, "only {} scenes", files.len());
    for file in files {
        let shown = succeed(folder.path(), &["inspect", &file.to_string_lossy()]);
        let described =
            shown.lines().any(|line| line.starts_with("description  ") && line.len() > 40);
        assert!(described, "{}: no description in\n{shown}", file.display());
    }
}

#[test]
fn every_scene_of_the_repository_runs_for_twenty_steps() {
    let folder = folder();
    for entry in fs::read_dir(scenes()).expect("the scenes are in the repository") {
        let file = entry.expect("readable").path();
        let scene = tangency::load_scene(&file).expect("valid");
        let duration = (20.0 * scene.dt()).to_string();
        let scene = file.to_string_lossy();
        let shown = succeed(folder.path(), &["simulate", &scene, "--duration", &duration]);
        assert!(shown.contains("in 20 steps"), "{scene}:\n{shown}");
    }
}
