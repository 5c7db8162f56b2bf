//! The replay page in a real browser.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tangency::{Scene, SceneFormat, parse_scene};
use tangency_view::{Frame, Push, Run, replay_html};

/// One body of every kind and shape, a joint of every kind that is drawn.
const SCENE: &str = r#"
name = "</script> & <b>all</b>"
description = "Everything that a page can show: </script><script>throw 1</script>"
dt = 0.1

[[bodies]]
name = "ground"
kind = "static"
shapes = [{ half_plane = { normal = [0.1, 2.0], offset = -0.5 } }, { rectangle = { width = 0.5, height = 1.0, center = [3.0, 0.0] } }]

[[bodies]]
name = "roller"
kind = "kinematic"
position = [-1.0, 0.3]
angular_velocity = 2.0
shapes = [{ circle = { radius = 0.3 } }]

[[bodies]]
name = "ball"
position = [0.0, 0.5]
groups = ["round"]
shapes = [{ circle = { radius = 0.2 } }]

[[bodies]]
name = "pill"
position = [0.6, 1.0]
shapes = [{ capsule = { a = [-0.3, 0.0], b = [0.3, 0.1], radius = 0.1 } }]

[[bodies]]
name = "wedge"
position = [1.4, 1.0]
shapes = [{ polygon = { points = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.4]] } }]

[[bodies]]
name = "box"
position = [2.0, 2.0]
angle = 0.3
shapes = [{ rectangle = { width = 0.5, height = 0.3 } }]

[[joints]]
name = "pin"
bodies = ["ball", "pill"]
kind = { revolute = { anchor = [0.1, 0.8] } }

[[joints]]
name = "spring"
bodies = ["world", "wedge"]
kind = { spring = { anchor_a = [1.5, 2.2], anchor_b = [1.6, 1.1], stiffness = 10.0 } }

[[joints]]
name = "rod"
bodies = ["wedge", "box"]
kind = { distance = { anchor_a = [1.6, 1.1], anchor_b = [2.0, 2.0] } }

[[joints]]
name = "rail"
bodies = ["world", "box"]
kind = { slot = { anchor = [2.0, 2.0], axis = [1.0, 0.2], limits = { lower = -1.0, upper = 1.0 } } }
"#;

fn scene() -> Scene {
    let def = parse_scene(SCENE, SceneFormat::Toml).expect("well formed");
    Scene::new(&def).expect("valid")
}

/// A motion made by hand: everything drifts to the right and turns.
fn run(scene: &Scene, name: &str, frames: usize, speed: f64) -> Run {
    let initial = scene.initial_state();
    let frame = |k: usize| {
        let mut frame = Frame::initial(scene, &initial);
        frame.state.time = 0.1 * k as f64;
        for (i, q) in frame.state.q.iter_mut().enumerate().skip(1) {
            q.x += speed * frame.state.time;
            q.z += speed * frame.state.time * i as f64;
        }
        frame.pushes = vec![Push { point: [0.0, 0.3], impulse: [0.1, 0.1 * k as f64] }];
        frame
    };
    Run { name: name.into(), frames: (0..frames).map(frame).collect() }
}

/// The page after its script ran, or nothing where there is no browser and none is required.
fn open(folder: &Path, page: &str) -> Option<String> {
    let Some(browser) = browser() else {
        let required = std::env::var_os("TANGENCY_REQUIRE_BROWSER").is_some_and(|v| v == "1");
        assert!(!required, "TANGENCY_REQUIRE_BROWSER=1, but no Chromium is installed");
        return None;
    };
    let file = folder.join("page.html");
    fs::write(&file, page).expect("the temporary folder is writable");
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(["--window-size=1200,800", "--virtual-time-budget=2000", "--dump-dom"])
        .arg(format!("file://{}", file.display()))
        .output()
        .expect("Chromium starts");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    names.iter().flat_map(|name| folders.iter().map(move |f| f.join(name))).find(|f| f.exists())
}

/// The page ran to its end without a script error and counts its frames and runs.
#[track_caller]
fn check(title: &str, scene: &Scene, runs: &[Run], frames: usize) {
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let page = replay_html(title, scene, runs);
    for source in ["src=", "href=", "http://", "https://", "@DATA@", "@TITLE@"] {
        assert!(!page.contains(source), "the page is not self-contained: {source}");
    }
    let Some(dom) = open(folder.path(), &page) else { return };
    let body = dom.lines().find(|line| line.contains("<body")).unwrap_or("no body");
    assert!(!dom.contains("data-error"), "{body}");
    assert!(body.contains(&format!("data-frames=\"{frames}\"")), "{body}");
    assert!(body.contains(&format!("data-runs=\"{}\"", runs.len())), "{body}");
}

#[test]
fn a_page_plays_without_script_errors() {
    let scene = scene();
    check(&scene.def().name, &scene, &[run(&scene, "only", 21, 0.2)], 21);
}

#[test]
fn a_page_shows_two_runs_of_different_length() {
    let scene = scene();
    let runs = [run(&scene, "true", 21, 0.2), run(&scene, "learned", 11, 0.1)];
    check("True and learned", &scene, &runs, 21);
}

#[test]
fn a_page_of_one_frame_and_no_bodies_is_fine() {
    let scene = Scene::new(&tangency::SceneDef::default()).expect("an empty scene is valid");
    check("Empty", &scene, &[run(&scene, "only", 1, 0.0)], 1);
}

/// What a person would do: each action is followed by the step that the clock then shows.
const ACTIONS: &str = r#"<script>
{
const seen = [];
const note = () => seen.push(document.getElementById("clock").textContent.match(/step (\d+)/)[1]);
const key = (k) => { window.dispatchEvent(new KeyboardEvent("keydown", { key: k })); note(); };
key("Home"); key("ArrowRight"); key("ArrowRight"); key("ArrowLeft"); key("End"); key("ArrowRight");
for (const k of ["i", "j", "l", "f", "ArrowUp", "ArrowDown"]) key(k);
const scrub = document.getElementById("scrub");
scrub.value = 7; scrub.dispatchEvent(new Event("input")); note();
const stage = document.getElementById("stage");
stage.dispatchEvent(new WheelEvent("wheel", { deltaY: -100, cancelable: true })); note();
window.dispatchEvent(new Event("resize")); note();
document.getElementById("next").click(); note();
key(" "); key(" ");
document.body.dataset.seen = seen.slice(0, 16).join(" ");
}
</script></body>"#;

#[test]
fn keys_and_controls_move_the_clock() {
    let scene = scene();
    let folder = tempfile::tempdir().expect("the temporary folder is writable");
    let page = replay_html("Keys", &scene, &[run(&scene, "only", 21, 0.2)]);
    let Some(dom) = open(folder.path(), &page.replace("</body>", ACTIONS)) else { return };
    assert!(!dom.contains("data-error"), "{dom}");
    let expected = "0 1 2 1 20 20 20 20 20 20 20 20 7 7 7 8";
    assert!(dom.contains(&format!("data-seen=\"{expected}\"")), "{dom}");
}

#[test]
fn long_runs_leave_frames_out() {
    let scene = scene();
    // 5 moving bodies × 59 999 frames are twice what a page holds.
    check("Long", &scene, &[run(&scene, "only", 59_999, 0.0)], 30_000);
}
