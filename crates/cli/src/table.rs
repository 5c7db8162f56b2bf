//! Two columns of text.

use std::fmt;

/// Names and values, the values aligned.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<(&'static str, String)>,
}

impl Table {
    /// Adds a row.
    pub fn row(&mut self, name: &'static str, value: impl fmt::Display) {
        self.rows.push((name, value.to_string()));
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        for (index, (name, value)) in self.rows.iter().enumerate() {
            let newline = if index == 0 { "" } else { "\n" };
            write!(f, "{newline}{name:width$}  {value}")?;
        }
        Ok(())
    }
}
