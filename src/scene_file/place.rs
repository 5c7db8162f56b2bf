//! Places in the text of a scene file, found again from the path of a key.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use serde_json::value::RawValue;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::SceneFormat;

/// A place in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, if the text came from one.
    pub file: Option<PathBuf>,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(file) => write!(f, "{}:{}:{}", file.display(), self.line, self.column),
            None => write!(f, "line {}, column {}", self.line, self.column),
        }
    }
}

impl Place {
    /// The place of a byte offset.
    pub(super) fn at(text: &str, offset: usize) -> Self {
        let end = (0..=offset.min(text.len())).rev().find(|end| text.is_char_boundary(*end));
        let before = &text[..end.unwrap_or(0)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            file: None,
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
        }
    }

    /// The same place, in a file.
    pub(super) fn in_file(self, file: &Path) -> Self {
        Self { file: Some(file.to_owned()), ..self }
    }

    /// The place of a key such as `bodies[2].mass`; of the innermost table that is there if the
    /// key is not.
    pub(super) fn of(key: &str, text: &str, format: SceneFormat) -> Self {
        let path = segments(key);
        Self::at(
            text,
            match format {
                SceneFormat::Toml => toml_offset(text, &path),
                SceneFormat::Json => json_offset(text, &path),
            },
        )
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Segment<'a> {
    Key(&'a str),
    Index(usize),
}

fn segments(path: &str) -> Vec<Segment<'_>> {
    path.split(['.', '['])
        .filter(|part| !part.is_empty())
        .map(|part| match part.strip_suffix(']').map(str::parse) {
            Some(Ok(index)) => Segment::Index(index),
            _ => Segment::Key(part),
        })
        .collect()
}

/// Offset of the last key along `path` that the document has.
fn toml_offset(text: &str, path: &[Segment<'_>]) -> usize {
    let Ok(document) = DeTable::parse(text) else { return 0 };
    let Some((&Segment::Key(first), rest)) = path.split_first() else { return 0 };
    let Some((mut offset, mut value)) = entry(document.get_ref(), first) else { return 0 };
    for &segment in rest {
        let next = match (segment, value) {
            (Segment::Key(key), DeValue::Table(table)) => entry(table, key),
            (Segment::Index(index), DeValue::Array(array)) => {
                array.get(index).map(|item| (item.span().start, item.get_ref()))
            }
            _ => None,
        };
        let Some(next) = next else { break };
        (offset, value) = next;
    }
    offset
}

/// Offset of a table's key, and its value.
fn entry<'a, 'i>(table: &'a DeTable<'i>, key: &str) -> Option<(usize, &'a DeValue<'i>)> {
    let (name, value): (&Spanned<_>, &Spanned<_>) =
        table.iter().find(|(name, _)| name.get_ref() == key)?;
    Some((name.span().start, value.get_ref()))
}

/// Offset of the last value along `path` that the document has: raw values are slices of the
/// text, so their addresses say where they stand.
fn json_offset(text: &str, path: &[Segment<'_>]) -> usize {
    let mut value = text;
    for segment in path {
        let next = match *segment {
            Segment::Key(key) => serde_json::from_str::<BTreeMap<String, &RawValue>>(value)
                .ok()
                .and_then(|table| table.get(key).copied()),
            Segment::Index(index) => serde_json::from_str::<Vec<&RawValue>>(value)
                .ok()
                .and_then(|array| array.get(index).copied()),
        };
        let Some(raw) = next else { break };
        value = raw.get();
    }
    value.as_ptr() as usize - text.as_ptr() as usize
}
