//! What a person at the terminal sees: results on stdout, progress and errors on stderr.

use std::error::Error;
use std::fmt::Display;
use std::io::{self, Write as _};

use indicatif::{ProgressBar, ProgressStyle};

/// The terminal. With `quiet` only errors are shown.
#[derive(Clone, Debug)]
pub struct Console {
    /// Nothing but errors.
    pub quiet: bool,
}

impl Console {
    /// Prints a result to stdout. A reader that has closed the pipe has seen enough.
    pub fn say(&self, text: impl Display) {
        if !self.quiet {
            let _ = writeln!(io::stdout(), "{text}");
        }
    }

    /// Prints an error and its causes to stderr.
    pub fn report(&self, error: &dyn Error) {
        let mut shown = error.to_string();
        let _ = writeln!(io::stderr(), "error: {shown}");
        let mut cause = error.source();
        while let Some(error) = cause {
            let text = error.to_string();
            // Some errors quote their cause in their own message.
            if !shown.contains(&text) {
                let _ = writeln!(io::stderr(), "  because: {text}");
                shown = text;
            }
            cause = error.source();
        }
    }

    /// A progress bar on stderr; hidden when quiet or when nobody looks.
    ///
    /// # Panics
    /// Never: the template is a constant.
    #[must_use]
    pub fn progress(&self, length: usize, what: &'static str) -> ProgressBar {
        if self.quiet {
            return ProgressBar::hidden();
        }
        let style = ProgressStyle::with_template(
            "{msg} {wide_bar:.cyan/dim} {pos}/{len} {per_sec} {elapsed}",
        );
        ProgressBar::new(length as u64)
            .with_style(style.expect("the template is valid"))
            .with_message(what)
    }
}
