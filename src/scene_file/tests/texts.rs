//! Texts of an unusual encoding, length or depth.

use std::fs;

use super::{BODY, toml};
use crate::scene_file::{SceneFileError, SceneFormat, load_scene, parse_scene};

#[test]
fn encodings() {
    let marked = format!("\u{feff}{BODY}shapes = [{{ circle = {{ radius = 1.0 }} }}]");
    parse_scene(&marked, SceneFormat::Toml).expect("a byte order mark is no fault");
    parse_scene("\u{feff}{}", SceneFormat::Json).expect("a byte order mark is no fault");
    let name = format!("tangency-encoding-{}.toml", std::process::id());
    let file = std::env::temp_dir().join(name);
    fs::write(&file, b"dt = 0.1\nname = \"M\xfcnchen\"").expect("the temporary folder is writable");
    let message = load_scene(&file).expect_err("it is not UTF-8").to_string();
    assert_eq!(
        message.replace(&file.display().to_string(), "file"),
        "file:2:10: byte 0xfc is not UTF-8; save the file as UTF-8"
    );
    fs::remove_file(&file).expect("the file is ours");
}

#[test]
fn long_lines_are_quoted_in_part() {
    let long = "x".repeat(1000);
    toml(
        &format!("dt = 0.1.2 # {long}"),
        &format!("line 1, column 9: invalid float, in `dt = 0.1.2 # {} …`", "x".repeat(67)),
    );
    let Err(error) = parse_scene(&format!("{long} = 1"), SceneFormat::Toml) else {
        panic!("no such key")
    };
    assert!(error.to_string().len() < 2000, "{} bytes are no message", error.to_string().len());
}

#[test]
fn nesting_is_bounded() {
    for (open, format) in [("a = ", SceneFormat::Toml), ("{\"bodies\": ", SceneFormat::Json)] {
        let text = format!("{open}{}", "[".repeat(100_000));
        assert!(matches!(parse_scene(&text, format), Err(SceneFileError::Syntax { .. })));
        let text = format!("{text}{}", "]".repeat(100_000));
        let text = if format == SceneFormat::Json { text + "}" } else { text };
        parse_scene(&text, format).expect_err("no such scene");
    }
}
