//! `tangency gradient`, `fit` and `experiment`, run as a person would.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// A ball hits a box in free space, off its centre.
const HIT: &str = r#"
gravity = [0.0, 0.0]
dt = 0.01
duration = 1.0

[[bodies]]
name = "ball"
velocity = [2.0, 0.0]
mass = 1.0
restitution = 0.5
shapes = [{ circle = { radius = 0.1 } }]

[[bodies]]
name = "box"
position = [1.0, 0.05]
mass = 2.5
restitution = 0.5
groups = ["heavy"]
shapes = [{ rectangle = { width = 0.4, height = 0.4 } }]
"#;

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// A folder with the scene `hit.toml` in it.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    write(&folder, "hit.toml", HIT);
    folder
}

/// The same with what `simulate` sees of the scene, `seen/trajectory.csv`.
fn observed() -> TempDir {
    let folder = folder();
    succeed(&folder, &["simulate", "hit.toml", "--no-replay", "--out", "seen"]);
    folder
}

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).expect("the temporary folder is writable");
}

fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).expect("the file was written")
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("the command writes JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn tangency(folder: &TempDir, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
    command.current_dir(folder.path()).args(arguments).output().expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the command prints UTF-8")
}

#[track_caller]
fn succeed(folder: &TempDir, arguments: &[&str]) -> String {
    let output = tangency(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// The command exits with this code and this text on stderr.
#[track_caller]
fn fail(folder: &TempDir, arguments: &[&str], code: i32, stderr: &str) {
    let output = tangency(folder, arguments);
    assert_eq!(text(&output.stderr), stderr);
    assert_eq!(output.status.code(), Some(code));
}

#[test]
fn gradient_agrees_with_differences() {
    let folder = folder();
    let scene = scenes().join("pendulum.toml");
    let report = json(&succeed(
        &folder,
        &[
            "gradient",
            scene.to_str().expect("the path is UTF-8"),
            "--loss=-rod.x^2 + 0.1*{rod.omega}*sin(rod.angle)",
            "--wrt=mass:rod,gravity.y,gravity.x,anchor_b.x:pivot,velocity.angle:rod,dt",
            "--duration=0.5",
            "--check",
            "--json",
        ],
    ));
    assert_eq!(report["steps"], 500);
    let parameters = report["parameters"].as_array().expect("a list");
    assert_eq!(parameters.len(), 6);
    for parameter in parameters {
        assert!(number(&parameter["relative_error"]) < 1e-6, "{parameter}");
        assert!(number(&parameter["gradient"]) != 0.0, "{parameter}");
    }
}

#[test]
fn gradient_through_a_contact_agrees_with_differences() {
    let folder = observed();
    // Another mass, another time step: the observed times lie between the steps.
    write(&folder, "lighter.toml", &HIT.replace("2.5", "2.1").replace("0.01\n", "0.0077\n"));
    let table = succeed(
        &folder,
        &[
            "gradient",
            "lighter.toml",
            "--loss=seen/trajectory.csv",
            "--wrt=mass:box,mass:heavy,velocity.x:ball,friction:*,restitution:box",
            "--check",
        ],
    );
    assert!(table.contains(" after 130 steps (1.001000 s); rollout "), "{table}");
    let heading: Vec<&str> = table.lines().nth(2).expect("a table").split("  ").collect();
    assert_eq!(heading[0], "parameter");
    assert!(table.lines().any(|line| line.starts_with("mass:heavy ")), "{table}");
}

/// Few records, the same digits.
#[test]
fn gradient_from_checkpoints() {
    let folder = observed();
    write(&folder, "lighter.toml", &HIT.replace("2.5", "2.1"));
    let gradient = |more: &[&str]| {
        let own =
            ["gradient", "lighter.toml", "--loss=seen/trajectory.csv", "--wrt=mass:box", "--json"];
        let mut report = json(&succeed(&folder, &[&own, more].concat()));
        for time in ["forward_seconds", "reverse_seconds"] {
            report.as_object_mut().expect("an object").remove(time);
        }
        report
    };
    assert_eq!(gradient(&["--checkpoints"]), gradient(&[]));
    assert!(number(&gradient(&[])["growth"]["factor"]) >= 1.0);
}

/// V37 (a): after ten impacts between fixed discs a change of height is 22 619 537 times as large.
#[test]
fn gradient_tells_how_much_it_grows() {
    let folder = folder();
    write(&folder, "discs.toml", DISCS);
    let arguments = ["gradient", "discs.toml", "--loss=ball.y", "--wrt=position.y:ball"];
    let report = succeed(&folder, &arguments);
    assert!(report.contains("The gradient grows by 2.3e7 over steps 1 to "), "{report}");
    let short = succeed(&folder, &[&arguments[..], &["--duration=10"]].concat());
    assert!(!short.contains("grows"), "{short}");
}

const DISCS: &str = r#"
version = 1
dt = 0.02
duration = 20.0
gravity = [0.0, 0.0]
stepping = { impact_resolved = { max_impacts = 8 } }

[[bodies]]
name = "left"
kind = "static"
position = [-2.0, 0.0]
friction = 0.0
restitution = 1.0
shapes = [{ circle = { radius = 0.8 } }]

[[bodies]]
name = "right"
kind = "static"
position = [2.0, 0.0]
friction = 0.0
restitution = 1.0
shapes = [{ circle = { radius = 0.8 } }]

[[bodies]]
name = "ball"
mass = 1.0
velocity = [1.0, 0.0]
friction = 0.0
restitution = 1.0
shapes = [{ circle = { radius = 0.2 } }]
"#;

#[test]
fn gradient_tells_where_it_is_one_sided() {
    let folder = folder();
    // The ball has come to touch at the very end of a step.
    write(&folder, "touch.toml", &HIT.replace("[1.0, 0.05]", "[0.5, 0.0]"));
    let arguments = ["gradient", "touch.toml", "--loss=ball.x", "--wrt=velocity.x:ball"];
    let report = succeed(&folder, &arguments);
    assert!(report.contains("one-sided at 1 place(s), the first: step 10, contact of"), "{report}");
}

#[test]
fn every_method_finds_the_mass() {
    let folder = observed();
    for (method, tolerance) in
        [("gauss-newton", 1e-12), ("lbfgs", 1e-9), ("gradient-descent", 1e-4)]
    {
        let out = format!("--out={method}");
        let method_argument = format!("--method={method}");
        succeed(
            &folder,
            &[
                "fit",
                "hit.toml",
                "--observed=seen/trajectory.csv",
                "--learn=mass:box",
                "--start=1",
                "--rate=20",
                "--clip=0.02",
                &method_argument,
                &out,
            ],
        );
        let fitted = json(&read(&folder, &format!("{method}/fitted.json")));
        let mass = number(&fitted[0]["value"]);
        assert!((mass / 2.5 - 1.0).abs() < tolerance, "{method}: {mass}");
        for file in ["iterations.csv", "loss.svg", "loss.png", "replay.html"] {
            assert!(folder.path().join(method).join(file).is_file(), "{method}: {file}");
        }
        let heading = "update,horizon,loss,mass:box\n0,1,";
        assert!(read(&folder, &format!("{method}/iterations.csv")).starts_with(heading));
    }
}

#[test]
fn fit_continues_from_the_beginning_to_the_whole_and_learns_several_parameters() {
    let folder = observed();
    succeed(
        &folder,
        &[
            "fit",
            "hit.toml",
            "--observed=seen/trajectory.csv",
            "--learn=mass:box,velocity.x:ball",
            "--start=1,1.95",
            "--continuation",
            "--out=fit",
        ],
    );
    let fitted = json(&read(&folder, "fit/fitted.json"));
    for (index, truth) in [2.5, 2.0].into_iter().enumerate() {
        assert!((number(&fitted[index]["value"]) - truth).abs() < 1e-9, "{fitted}");
    }
}

#[test]
fn the_quick_experiment_writes_everything_and_meets_its_targets() {
    let folder = folder();
    succeed(&folder, &["--quiet", "experiment", "chain-mass", "--quick", "--out=chain"]);
    for figure in ["mass", "loss", "runtime", "landscape", "filmstrip"] {
        let svg = read(&folder, &format!("chain/{figure}.svg"));
        assert!(svg.starts_with("<svg") && svg.contains("<text"), "{figure}");
        let png = fs::read(folder.path().join(format!("chain/{figure}.png"))).expect("written");
        assert_eq!(&png[1..4], b"PNG", "{figure}");
    }
    assert!(read(&folder, "chain/replay.html").contains("\"name\":\"learned\""));
    assert!(read(&folder, "chain/report.md").starts_with("# The mass of a chain of 10 links\n"));
    assert!(read(&folder, "chain/results.csv").starts_with("figure,value,target\n"));

    let results = json(&read(&folder, "chain/results.json"));
    let masses = |fit: &Value| -> Vec<f64> {
        let updates = fit["trace"].as_array().expect("a list");
        updates.iter().map(|update| number(&update["mass"])).collect()
    };
    let plain = masses(&results["plain"]);
    assert_eq!(plain.len(), 31);
    for (update, mass) in plain.iter().enumerate() {
        let walked = 1.0 + update.min(6) as f64;
        assert!((mass - walked).abs() < 1e-12, "update {update}: {mass}");
    }
    let better = results["better"].as_array().expect("a list");
    assert_eq!(better.len(), 8);
    for fit in better {
        let found = *masses(fit).last().expect("a start at least");
        assert!((found / 7.0 - 1.0).abs() <= 1e-8, "{} from {}", fit["method"], fit["start"]);
    }
    assert!(number(&results["gradient_error"]) <= 1e-7);
    assert!(number(&results["worst_residual"]) <= 1e-10);
    assert!(number(&results["link_masses"]["worst_relative_error"]) <= 1e-8);
    assert!((number(&results["noise"]["mean"]) - 7.0).abs() < 0.01);
    assert!((number(&results["start_loss"]) - 7484.0).abs() < 1.0);
}

#[test]
fn wrong_formulas_name_the_column() {
    let folder = folder();
    let check = |formula: &str, message: &str| {
        let loss = format!("--loss={formula}");
        let stderr =
            format!("error: --loss {formula:?} is no file, and as a formula wrong at {message}\n");
        fail(&folder, &["gradient", "hit.toml", &loss, "--wrt=mass:box"], 2, &stderr);
    };
    check("box.x + bx.y", "column 9: the scene has no body `bx`; known: ball, box");
    check(
        "box.z",
        "column 1: unknown variable `box.z`; variables are BODY.x, .y, .angle, .vx, .vy or .omega",
    );
    check("2 * (box.x", "column 11: `)` is missing");
}

#[test]
fn wrong_parameters_are_named() {
    let folder = observed();
    let gradient = |wrt: &str, stderr: &str| {
        let wrt = format!("--wrt={wrt}");
        fail(&folder, &["gradient", "hit.toml", "--loss=box.x", &wrt], 2, stderr);
    };
    gradient(
        "mass:links",
        "error: parameter \"mass:links\": the scene has no body or group \"links\"\n",
    );
    gradient(
        "velocity:ball",
        "error: parameter \"velocity:ball\": name a component, as in `velocity.x:ball` (x, y or \
         angle)\n",
    );
    let fit = |learn: &str, start: &str, stderr: &str| {
        let (learn, start) = (format!("--learn={learn}"), format!("--start={start}"));
        let file = "--observed=seen/trajectory.csv";
        fail(&folder, &["fit", "hit.toml", file, &learn, &start], 2, stderr);
    };
    fit(
        "mass:box",
        "1,2",
        "error: --start has 2 numbers, --learn 1 parameters; give one for each\n",
    );
    fit(
        "mass:box,mass:heavy",
        "1,2",
        "error: --learn \"mass:box\" and \"mass:heavy\" set the same number; learn one of them\n",
    );
    fit(
        "mass:box",
        "-1",
        "error: parameter \"mass:box\" cannot have this value\n  because: Mass(1) is -1: give a \
         positive finite number\n",
    );
}

#[test]
fn wrong_trajectories_name_line_and_column() {
    let folder = folder();
    let check = |rows: &str, message: &str| {
        write(&folder, "seen.csv", &format!("time,body,x,y,angle,vx,vy,omega\n{rows}"));
        let arguments = ["fit", "hit.toml", "--observed=seen.csv", "--learn=mass:box"];
        fail(&folder, &arguments, 2, &format!("error: seen.csv:{message}\n"));
    };
    let columns = "the columns are time, body, x, y, angle, vx, vy, omega";
    check(
        "0,ball,0,0,0,0,0,0\n0.1,ball,oops,0,0,0,0,0\n",
        &format!("3: x: invalid float literal; {columns}"),
    );
    check("0,bell,0,0,0,0,0,0\n", "2: body: the scene has no \"bell\"; known: ball, box");
    check("", "2: no body of the scene that moves is observed");
    check("0.2,ball,0,0,0,0,0,0\n0.1,ball,0,0,0,0,0,0\n", "3: time: 0.1 comes after a later time");
    check(
        "0,ball,0,0,0,0,0,0\n0,box,0,0,0,0,0,0\n0.1,box,0,0,0,0,0,0\n",
        "4: body: every time needs the same bodies in the same order",
    );
    check(
        "0,ball,0,0,0,0,0,0\n0,box,0,0,0,0,0,0\n0.1,ball,0,0,0,0,0,0\n",
        "4: at time 0.1 some bodies are missing; every time needs the same",
    );
    check(
        "0,ball,NaN,0,0,0,0,0\n",
        "2: time, x, y and angle must be finite (at most 1e50), and time not negative",
    );
}
