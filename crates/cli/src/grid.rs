//! Rows and columns of text: aligned for people, or as CSV.

use std::fmt;
use std::path::Path;

use crate::Failure;

/// A heading and rows of equally many cells.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    rows: Vec<Vec<String>>,
}

/// A heading, and what stands below it of a thing.
pub(crate) type Column<T> = (&'static str, fn(&T) -> String);

impl Grid {
    /// A grid with only its heading.
    #[must_use]
    pub fn new<const N: usize>(heading: [&str; N]) -> Self {
        Self { rows: vec![heading.map(str::to_owned).into()] }
    }

    /// A grid with only its heading, of any width.
    #[must_use]
    pub fn with_heading(heading: Vec<String>) -> Self {
        Self { rows: vec![heading] }
    }

    /// A row for each of some things, a column for each of what is shown of them.
    #[must_use]
    pub(crate) fn of<T>(things: impl IntoIterator<Item = T>, columns: &[Column<T>]) -> Self {
        let mut grid = Self::with_heading(columns.iter().map(|(name, _)| (*name).into()).collect());
        for thing in things {
            grid.row(columns.iter().map(|(_, show)| show(&thing)));
        }
        grid
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// All rows, the heading first.
    #[must_use]
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// Writes it as CSV.
    ///
    /// # Errors
    /// [`Failure::Write`].
    pub fn write_csv(&self, file: &Path) -> Result<(), Failure> {
        let write = || {
            let mut writer = csv::Writer::from_path(file)?;
            self.rows.iter().try_for_each(|row| writer.write_record(row))?;
            writer.flush().map_err(csv::Error::from)
        };
        write().map_err(|error| Failure::Write { file: file.to_owned(), source: error.into() })
    }

    /// The same as a table of Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |row: &Vec<String>| format!("| {} |\n", row.join(" | "));
        let rule = format!("|{}\n", " --- |".repeat(self.rows[0].len()));
        line(&self.rows[0]) + &rule + &self.rows[1..].iter().map(line).collect::<String>()
    }
}

impl fmt::Display for Grid {
    /// The first column to the left, the others to the right.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |k: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(k));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.rows[0].len()).map(width).collect();
        for (index, row) in self.rows.iter().enumerate() {
            f.write_str(if index == 0 { "" } else { "\n" })?;
            for (k, (cell, width)) in row.iter().zip(&widths).enumerate() {
                match k {
                    0 => write!(f, "{cell:width$}")?,
                    _ => write!(f, "  {cell:>width$}")?,
                }
            }
        }
        Ok(())
    }
}
