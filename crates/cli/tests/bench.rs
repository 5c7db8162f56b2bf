//! `tangency bench`, short: its files, their columns, and the page. Times are never judged.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

fn bench(folder: &Path, arguments: &[&str]) -> Output {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut command = Command::new(env!("CARGO_BIN_EXE_tangency"));
    command.current_dir(folder).args(["--quiet", "bench", "--scenes"]).arg(scenes);
    command.args(arguments).output().expect("the command starts")
}

#[track_caller]
fn succeed(arguments: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let output = bench(folder.path(), arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// The rows of a table; every row has all columns.
fn rows(file: &Path) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(file).expect("written");
    reader.records().map(|row| row.expect("as many cells as columns")).collect()
}

/// Numbers of a column; where `empty`, cells may be empty.
#[track_caller]
fn numbers(file: &Path, column: &str, empty: bool) -> Vec<f64> {
    numbers_of(file, column, empty, "")
}

/// The same of those rows alone whose engine's name begins so, where the table has engines.
#[track_caller]
fn numbers_of(file: &Path, column: &str, empty: bool, engine: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(file).expect("written");
    let headers = reader.headers().expect("a heading").clone();
    let place = headers.iter().position(|name| name == column);
    let place = place.unwrap_or_else(|| panic!("no column {column} in {headers:?}"));
    let engines = headers.iter().position(|name| name == "engine");
    let mut rows = rows(file);
    rows.retain(|row| engines.is_none_or(|place| row[place].starts_with(engine)));
    let cells = rows.into_iter().map(|row| row[place].to_owned());
    let cells = cells.filter(|cell| !empty || !cell.is_empty());
    cells.map(|cell| cell.parse().unwrap_or_else(|_| panic!("{column}: {cell:?}"))).collect()
}

#[test]
fn a_quick_run_writes_tables_figures_and_a_page() {
    let folder = succeed(&["--quick"]);
    let out = folder.path().join("out/bench");
    for (table, column, most) in [
        ("race.csv", "us_per_step", f64::INFINITY),
        ("race.csv", "residual", 1e-10),
        ("race.csv", "penetration", 1e-9),
        ("paths.csv", "residual", 1e-10),
        ("precision.csv", "seconds_per_second", f64::INFINITY),
        ("precision.csv", "position", 2.0),
        ("precision.csv", "residual", 1e-10),
        ("growth.csv", "us_per_step", f64::INFINITY),
        ("solvers.csv", "us_per_problem", f64::INFINITY),
        ("lean.csv", "found", f64::INFINITY),
        ("batch.csv", "steps_per_second", f64::INFINITY),
    ] {
        let found = numbers_of(&out.join(table), column, false, "tangency");
        assert!(!found.is_empty(), "{table} has rows");
        let fits = |number: &f64| *number >= 0.0 && *number <= most;
        assert!(found.iter().all(fits), "{table}, {column}: {found:?}");
    }
    assert!(!numbers(&out.join("gradients.csv"), "over_value", true).is_empty());
    let page = fs::read_to_string(out.join("bench.html")).expect("written");
    assert!(!page.contains('@'), "every mark of the template is filled");
    for stem in ["precision-V02", "precision-V36", "growth-chain", "growth-pyramid", "solvers"] {
        let figure = fs::read_to_string(out.join(format!("{stem}.svg"))).expect("drawn");
        assert!(page.contains(&figure), "{stem} is in the page");
        assert!(out.join(format!("{stem}.png")).exists());
    }
    assert!(!page.contains("http://") || page.contains("http://www.w3.org"), "no network");
}

/// Errors of a motion that is known fall with the time step, and counts are what they must be.
#[test]
fn what_is_known_beforehand() {
    let folder = succeed(&["--quick", "--only", "precision,lean"]);
    let out = folder.path().join("out/bench");
    let mut pendulum: Vec<f64> = Vec::new();
    for row in rows(&out.join("precision.csv")) {
        if &row[0] == "V02" && !row[2].contains("projected") && row[2] == *"tangency ipm" {
            pendulum.push(row[10].parse().expect("a number"));
        }
    }
    assert!(pendulum.len() > 3, "{pendulum:?}");
    assert!(pendulum.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{pendulum:?}");
    for row in rows(&out.join("lean.csv")) {
        if row[2].starts_with('=') {
            assert_eq!(&row[3], "yes", "{row:?}");
        }
    }
}

/// Gradients agree with differences, tapes take about what their states and rows do, and goals are told
/// with what the run found of them.
#[test]
fn gradients_and_goals() {
    let folder = succeed(&["--quick", "--only", "gradients"]);
    let out = folder.path().join("out/bench");
    let errors = numbers(&out.join("gradients.csv"), "error", false);
    assert!(errors.len() >= 4, "{errors:?}");
    assert!(errors.iter().all(|error| *error < 1e-6), "{errors:?}");
    let compared: f64 = numbers(&out.join("gradients.csv"), "compared", false).iter().sum();
    assert!(compared > 15.0, "{compared}");

    let tapes = numbers(&out.join("gradients.csv"), "tape_kib", true);
    if let [_, _, chain, _] = tapes[..] {
        // 300 states of ten poses and velocities, and 20 rows of two bodies' Jacobians each.
        let least = 300.0 * 8.0 * f64::from(10 * 6 + 20 * 6) / 1024.0;
        assert!(chain > least && chain < 16.0 * least, "{chain} KiB");
    }
    for row in rows(&out.join("goals.csv")) {
        let (found, goal) = (row[1].parse::<f64>(), row[2].chars().skip(2).collect::<String>());
        let goal: f64 = goal.parse().expect("a number after the sign");
        let holds = match (found, row[2].chars().next()) {
            (Err(_), _) => "not measured",
            (Ok(found), Some('≤')) if found <= goal => "yes",
            (Ok(found), Some('≥')) if found >= goal => "yes",
            _ => "no",
        };
        assert_eq!(&row[3], holds, "{row:?}");
    }
}

/// Rows of other engines come from files and go into table and page.
#[test]
fn other_engines_are_merged() {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let heading = "engine,scene,dt,steps,us_per_step,us_lower,us_upper,us_least,penetration,drift,\
                   residual,factorisations,iterations,gradient,gradient_us,note\n";
    let row = "other <1>,bounce,0.005,400,2.5,2.4,2.6,2.3,0.001,0,,,,7.5,3e9,by differences\n\
               mujoco 4,bounce,0.005,400,9e9,9e9,9e9,9e9,0.001,0,,,,2,4e9,\n";
    fs::write(folder.path().join("other.csv"), format!("{heading}{row}")).expect("writable");
    let output = bench(folder.path(), &["--quick", "--only", "race", "--peers", "other.csv"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let out = folder.path().join("out/bench");
    let page = fs::read_to_string(out.join("bench.html")).expect("written");
    assert!(page.contains("other &lt;1>") && page.contains("by differences"));
    assert!(numbers(&out.join("race.csv"), "gradient", true).contains(&7.5));
    let compared = numbers(&out.join("gradients.csv"), "us_value_and_gradient", false);
    assert!(compared.contains(&3e9), "{compared:?}");
    // A step that takes hours: whatever the machine, ours is faster.
    let goals = rows(&out.join("goals.csv"));
    for what in ["bounce: speed over MuJoCo", "bounce: value and gradient over those of MuJoCo"] {
        let goal = goals.iter().find(|row| &row[0] == what).expect("a goal");
        assert_eq!(&goal[3], "yes", "{goal:?}");
    }

    fs::write(folder.path().join("bad.csv"), format!("{heading}other,bounce,soon\n")).expect("ok");
    let output = bench(folder.path(), &["--quick", "--only", "race", "--peers", "bad.csv"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.starts_with("error: bad.csv:2:"), "{message}");
}

/// What other languages read are scenes that this program reads, too.
#[test]
fn exported_scenes_are_scene_files() {
    let folder = succeed(&["--export", "race.json"]);
    let text = fs::read_to_string(folder.path().join("race.json")).expect("written");
    let all: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let heats = all.as_array().expect("a list");
    assert!(heats.len() > 8);
    for heat in heats {
        let def =
            tangency::parse_scene(&heat["definition"].to_string(), tangency::SceneFormat::Json)
                .expect("a scene");
        assert_eq!(heat["dt"].as_f64(), Some(def.dt));
        tangency::Scene::new(&def).expect("a valid scene");
    }
    assert!(!folder.path().join("out").exists());
}
