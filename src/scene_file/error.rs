//! What can be wrong with a scene file.

use std::io;
use std::path::{Path, PathBuf};

use tangency_core::SceneError;

use super::{Place, SceneFormat};

/// What is wrong with a scene file, and where.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneFileError {
    /// The file cannot be read.
    #[error("{}: cannot be read; check the path and its permissions", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The extension names no format.
    #[error("{}: unknown scene format; name the file `.toml` or `.json`", file.display())]
    Extension {
        /// The file.
        file: PathBuf,
    },
    /// The bytes are no text.
    #[error("{place}: byte {byte:#04x} is not UTF-8; save the file as UTF-8")]
    NotUtf8 {
        /// Where the first wrong byte stands.
        place: Place,
        /// The byte.
        byte: u8,
    },
    /// The text is not TOML or JSON.
    #[error("{place}: {message}")]
    Syntax {
        /// Where the text stops making sense.
        place: Place,
        /// What was found and what was expected.
        message: String,
    },
    /// A key is unknown or missing, or its value has the wrong type.
    #[error("{place}: {key}: {message}")]
    Malformed {
        /// Where the key stands; where its table begins if it is missing.
        place: Place,
        /// Path of the key, as in `bodies[2].mass`.
        key: String,
        /// What was found, what was expected and what to do.
        message: String,
    },
    /// The file is well formed, but no scene can be built from its values.
    #[error("{place}: {error}")]
    Refused {
        /// Where the value stands.
        place: Place,
        /// The value and the remedy.
        error: Box<SceneError>,
    },
}

impl SceneFileError {
    /// The same error, in a file.
    #[must_use]
    pub(super) fn in_file(mut self, path: &Path) -> Self {
        match &mut self {
            Self::Syntax { place, .. }
            | Self::Malformed { place, .. }
            | Self::Refused { place, .. } => place.file = Some(path.to_owned()),
            Self::Read { .. } | Self::Extension { .. } | Self::NotUtf8 { .. } => {}
        }
        self
    }

    /// A refusal of [`Scene::new`](tangency_core::Scene::new), found again in the text.
    pub(super) fn refused(error: SceneError, text: &str, format: SceneFormat) -> Self {
        Self::Refused { place: Place::of(error.path(), text, format), error: Box::new(error) }
    }

    /// A complaint of the parser.
    pub(super) fn syntax(place: Place, message: &str, text: &str) -> Self {
        let mut message = message.trim_end_matches(", expected nothing").to_owned();
        let line = text.lines().nth(place.line - 1).unwrap_or_default();
        if !line.trim().is_empty() {
            message = format!("{message}, in `{}`", excerpt(line, place.column));
        }
        Self::Syntax { place, message: shortened(&message) }
    }

    /// A complaint of serde about the key at `path`.
    pub(super) fn malformed(path: &str, message: &str, text: &str, format: SceneFormat) -> Self {
        let (mut key, mut message) = (path.trim_end_matches(".?").to_owned(), message.to_owned());
        if let Some((unknown, rest)) = unexpected_key(&message) {
            key = format!("{key}.{unknown}");
            message = rest;
        }
        let place = Place::of(&key, text, format);
        if key.is_empty() || key == "." || key == "?" {
            key = "scene".into();
        }
        Self::Malformed { place, key: shortened(&key), message: shortened(&explain(&message)) }
    }
}

/// Longer messages lose their middle, in characters.
const LONGEST: usize = 600;
/// Lines are quoted up to this many characters around the column.
const QUOTED: usize = 80;

/// A message without the middle of what it quotes, if that is very long.
fn shortened(message: &str) -> String {
    let count = message.chars().count();
    if count <= LONGEST {
        return message.into();
    }
    let head: String = message.chars().take(LONGEST / 2).collect();
    let tail: String = message.chars().skip(count - LONGEST / 2).collect();
    format!("{head} … {tail}")
}

/// What stands on a line around a column.
fn excerpt(line: &str, column: usize) -> String {
    let line: Vec<char> = line.trim_end().chars().collect();
    let start = column.saturating_sub(QUOTED / 2);
    let start = if line.len() <= QUOTED { 0 } else { start.min(line.len() - QUOTED) };
    let end = line.len().min(start + QUOTED);
    let part: String = line[start..end].iter().collect();
    let before = if start > 0 { "… " } else { "" };
    let after = if end < line.len() { " …" } else { "" };
    format!("{before}{}{after}", part.trim())
}

/// Serde's message in the words of a scene file, with a remedy.
fn explain(message: &str) -> String {
    let mut text = message.to_owned();
    for (rust, plain) in [
        ("expected f64", "expected a number"),
        ("expected u32", "expected a whole number from 0 to 4294967295"),
        ("expected a sequence", "expected an array"),
        ("expected a boolean", "expected true or false"),
        ("trailing characters", "more elements than this array takes; remove them"),
        ("wanted exactly 1 element, found 0 elements", "an empty table, expected one key"),
        ("wanted exactly 1 element, found", "expected one key, found"),
        ("wanted string or table", "expected a name, or a table with one key"),
    ] {
        text = text.replace(rust, plain);
    }
    if let Some(at) = text.find("expected struct ") {
        text.replace_range(at.., "expected a table");
    }
    text + &remedy(message)
}

/// The toml crate checks the keys of enum variants itself and words the complaint in its own way:
/// the first unknown key, and the message as serde words it.
fn unexpected_key(message: &str) -> Option<(&str, String)> {
    let (unknown, known) =
        message.strip_prefix("unexpected keys in table: ")?.split_once(", available keys: ")?;
    let unknown = unknown.split(", ").next()?;
    let known = known.replace(", ", "`, `");
    Some((unknown, format!("unknown field `{unknown}`, expected one of `{known}`")))
}

fn remedy(message: &str) -> String {
    let mut words = message.split('`').skip(1).step_by(2);
    let found = words.next().unwrap_or_default();
    if message.starts_with("missing field") {
        return "; add it".into();
    }
    if !message.starts_with("unknown ") {
        return String::new();
    }
    match words.min_by_key(|word| edit_distance(found, word)) {
        Some(word) if 2 * edit_distance(found, word) <= word.len().max(2) => {
            format!("; did you mean `{word}`?")
        }
        _ => "; correct or remove it".into(),
    }
}

/// Levenshtein's distance: insertions, deletions and substitutions that turn `a` into `b`.
fn edit_distance(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.chars().count()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.chars().enumerate() {
            let substituted = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.chars().count()]
}
