//! Refuses arrays that serde would read only in part.
//!
//! Serde takes a pair from the first two elements of a longer TOML array, and a table from an
//! array of its values, and says nothing; a `position = [1, 2, 3]` must not pass. What was read is
//! written again and compared with what the file says.

use serde_json::Value;
use tangency_core::SceneDef;

use super::{SceneFileError, SceneFormat};

/// # Errors
/// [`SceneFileError::Malformed`] at the first array of `text` that is not what `def` has there.
pub(super) fn check(text: &str, format: SceneFormat, def: &SceneDef) -> Result<(), SceneFileError> {
    let said: Option<Value> = match format {
        SceneFormat::Toml => toml::from_str(text).ok(),
        SceneFormat::Json => serde_json::from_str(text).ok(),
    };
    let read = serde_json::to_value(def).ok();
    match said.zip(read).and_then(|(said, read)| difference(&said, &read)) {
        Some((path, message)) => Err(SceneFileError::malformed(&path, &message, text, format)),
        None => Ok(()),
    }
}

/// Path of the first array in `said` whose counterpart in `read` is shorter or a table, and what
/// is wrong with it.
fn difference(said: &Value, read: &Value) -> Option<(String, String)> {
    match (said, read) {
        (Value::Array(_), Value::Object(_)) => {
            Some((String::new(), "invalid type: array, expected a table".into()))
        }
        (Value::Array(said), Value::Array(read)) if said.len() > read.len() => Some((
            String::new(),
            format!("invalid length {}, expected an array of length {}", said.len(), read.len()),
        )),
        (Value::Array(said), Value::Array(read)) => {
            said.iter().zip(read).enumerate().find_map(|(index, (said, read))| {
                let (path, message) = difference(said, read)?;
                Some((join(&format!("[{index}]"), &path), message))
            })
        }
        (Value::Object(said), Value::Object(read)) => said.iter().find_map(|(key, said)| {
            let (path, message) = difference(said, read.get(key)?)?;
            Some((join(key, &path), message))
        }),
        _ => None,
    }
}

fn join(key: &str, path: &str) -> String {
    let dot = if path.is_empty() || path.starts_with('[') { "" } else { "." };
    format!("{key}{dot}{path}")
}
