//! Scene files: TOML or JSON through serde, with errors that name file, line, key and remedy.
//!
//! Both formats describe the same [`SceneDef`]. Whatever is wrong with a file (its syntax, a
//! misspelt key, a value of the wrong type, a value that [`Scene::new`] refuses) is reported at
//! its place in the text, so that an editor can jump there.

mod error;
mod place;
mod surplus;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::Path;

use serde_json::value::RawValue;
use tangency_core::{Scene, SceneDef};

pub use error::SceneFileError;
pub use place::Place;

/// Some editors begin a file with it.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// How a scene is written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneFormat {
    /// TOML 1.1, for people.
    Toml,
    /// JSON, for programs.
    Json,
}

impl SceneFormat {
    /// The format that a file's extension says.
    ///
    /// # Errors
    /// [`SceneFileError::Extension`] unless it is `.toml` or `.json`.
    pub fn of(path: &Path) -> Result<Self, SceneFileError> {
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("toml") => Ok(Self::Toml),
            Some("json") => Ok(Self::Json),
            _ => Err(SceneFileError::Extension { file: path.to_owned() }),
        }
    }
}

/// Reads a scene file and builds its scene; the extension (`.toml` or `.json`) tells the format.
///
/// # Errors
/// A [`SceneFileError`] that names file, line and key.
pub fn load_scene(path: impl AsRef<Path>) -> Result<Scene, SceneFileError> {
    let (file, format, text) = read(path.as_ref())?;
    let def = parse_scene(&text, format).map_err(|error| error.in_file(file))?;
    Scene::new(&def)
        .map_err(|error| SceneFileError::refused(error, &text, format).in_file(path.as_ref()))
}

/// Reads a scene file without checking more than its form, so that a program can change the
/// definition before it builds the scene.
///
/// # Errors
/// A [`SceneFileError`] that names file, line and key.
pub fn read_scene(path: impl AsRef<Path>) -> Result<SceneDef, SceneFileError> {
    let (file, format, text) = read(path.as_ref())?;
    parse_scene(&text, format).map_err(|error| error.in_file(file))
}

/// Reads a scene's definition from text. Values are checked later, by [`Scene::new`].
///
/// # Errors
/// A [`SceneFileError`] that names line and key.
pub fn parse_scene(text: &str, format: SceneFormat) -> Result<SceneDef, SceneFileError> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let def = match format {
        SceneFormat::Toml => parse_toml(text),
        SceneFormat::Json => parse_json(text),
    }?;
    surplus::check(text, format, &def)?;
    Ok(def)
}

/// Writes a definition as TOML; [`parse_scene`] reads back exactly the same.
///
/// # Panics
/// Never: every definition has a form in TOML.
#[must_use]
pub fn scene_to_toml(def: &SceneDef) -> String {
    toml::to_string(def).expect("every field of a definition has a form in TOML")
}

/// Writes a definition as JSON; [`parse_scene`] reads back exactly the same if its numbers are
/// finite, as those of every valid scene are.
///
/// # Panics
/// Never: every definition has a form in JSON.
#[must_use]
pub fn scene_to_json(def: &SceneDef) -> String {
    serde_json::to_string_pretty(def).expect("every field of a definition has a form in JSON")
}

fn read(path: &Path) -> Result<(&Path, SceneFormat, String), SceneFileError> {
    let format = SceneFormat::of(path)?;
    let bytes =
        fs::read(path).map_err(|source| SceneFileError::Read { file: path.to_owned(), source })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let (valid, byte) = (error.utf8_error().valid_up_to(), error.as_bytes());
        let place = Place::at(&String::from_utf8_lossy(&byte[..valid]), valid).in_file(path);
        SceneFileError::NotUtf8 { place, byte: byte[valid] }
    })?;
    let text = text.strip_prefix(BYTE_ORDER_MARK).map(str::to_owned).unwrap_or(text);
    Ok((path, format, text))
}

fn parse_toml(text: &str) -> Result<SceneDef, SceneFileError> {
    let document = toml::Deserializer::parse(text).map_err(|error| {
        let offset = error.span().map_or(text.len(), |span| span.start);
        SceneFileError::syntax(Place::at(text, offset), error.message(), text)
    })?;
    serde_path_to_error::deserialize(document).map_err(|error| {
        let path = error.path().to_string();
        SceneFileError::malformed(&path, error.inner().message(), text, SceneFormat::Toml)
    })
}

fn parse_json(text: &str) -> Result<SceneDef, SceneFileError> {
    serde_json::from_str::<&RawValue>(text).map_err(|error| {
        let place = Place { file: None, line: error.line().max(1), column: error.column().max(1) };
        SceneFileError::syntax(place, &message_without_place(&error), text)
    })?;
    let mut reader = serde_json::Deserializer::from_str(text);
    serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let path = error.path().to_string();
        let message = message_without_place(error.inner());
        SceneFileError::malformed(&path, &message, text, SceneFormat::Json)
    })
}

/// `serde_json` ends its messages with a place of its own.
fn message_without_place(error: &serde_json::Error) -> String {
    let place = format!(" at line {} column {}", error.line(), error.column());
    let message = error.to_string();
    message.strip_suffix(&place).unwrap_or(&message).to_owned()
}
