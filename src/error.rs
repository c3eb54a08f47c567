//! Errors, sorted by what the user does next, each with the location it points at.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Everything that can go wrong between a user's files and a product.
///
/// Numeric code does not return errors: what it needs is checked once, when a
/// [`Scene`](crate::scene::Scene) is made.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file or folder could not be read or written: check the path, the permissions and the free space.
    #[error("{path}: {}", refusal(action, source), path = path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was being done, as in "reading".
        action: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// The text does not follow its format: fix it at this location. Only the first error is reported.
    #[error("{at}: {message}")]
    Syntax {
        /// Where.
        at: Location,
        /// What was expected, and what was found.
        message: String,
    },
    /// The text is well formed, but values in it are not usable: fix them. All are reported.
    #[error("{}", join(.0))]
    Invalid(Vec<Problem>),
    /// Understood, but not something this version can do.
    #[error("{at}: {feature} is not supported by this version")]
    Unsupported {
        /// Where it was asked for.
        at: Location,
        /// What was asked for.
        feature: String,
    },
    /// The caller's progress callback asked to stop (Ctrl-C on the command line). Nothing is left behind.
    #[error("interrupted: nothing was written")]
    Interrupted,
}

/// The result of anything that can fail.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An [`Error::Io`] while doing `action` on `path`.
    pub fn io(path: impl AsRef<Path>, action: &'static str, source: std::io::Error) -> Self {
        Error::Io { path: path.as_ref().to_owned(), action, source }
    }

    /// An [`Error::Invalid`] with one problem.
    pub fn invalid(at: Location, message: impl Into<String>) -> Self {
        Error::Invalid(vec![Problem::new(at, message)])
    }

    /// What to fix, each problem with its location; empty if the caller asked to stop.
    pub fn problems(&self) -> Vec<Problem> {
        match self {
            Error::Io { path, action, source } => {
                vec![Problem::new(Location::file(path), refusal(action, source))]
            }
            Error::Syntax { at, message } => vec![Problem::new(at.clone(), message)],
            Error::Invalid(problems) => problems.clone(),
            Error::Unsupported { at, feature } => {
                vec![Problem::new(at.clone(), format!("{feature} is not supported by this version"))]
            }
            Error::Interrupted => vec![],
        }
    }

    /// An [`Error::Syntax`].
    pub fn syntax(at: Location, message: impl Into<String>) -> Self {
        Error::Syntax { at, message: message.into() }
    }
}

/// The system's error, worded the same on every system and for every format.
fn refusal(action: &str, source: &std::io::Error) -> String {
    use std::io::ErrorKind;
    match (source.kind(), action) {
        (ErrorKind::NotFound, "reading") => "there is no such file or folder".into(),
        (ErrorKind::IsADirectory, "reading") => "is a folder, but a file is needed".into(),
        (ErrorKind::NotFound, _) => format!("{action}: there is no such file or folder"),
        (ErrorKind::IsADirectory, _) => format!("{action}: a folder with this name exists"),
        (ErrorKind::NotADirectory, _) => {
            format!("{action}: part of this path is a file, but a folder is needed")
        }
        (ErrorKind::PermissionDenied, _) => format!("{action}: permission denied"),
        (ErrorKind::AlreadyExists, "making this folder") => format!("{action}: a file with this name exists"),
        _ => format!("{action}: {source}"),
    }
}

fn join(problems: &[Problem]) -> String {
    problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n")
}

/// A number as messages show it: nobody wants to read the 309 digits of 1e308.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || (1e-5..1e15).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

/// One thing to fix: where, what is wrong, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Where it is.
    pub at: Location,
    /// What is wrong.
    pub message: String,
    /// What to do, if the message does not make it obvious.
    pub help: Option<String>,
}

impl Problem {
    /// A problem without further help.
    pub fn new(at: Location, message: impl Into<String>) -> Self {
        Problem { at, message: message.into(), help: None }
    }

    /// The same problem with a line of help.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.at.to_string();
        if !place.is_empty() {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.message)?;
        if let Some(help) = &self.help {
            write!(f, " (help: {help})")?;
        }
        Ok(())
    }
}

/// A location in a user's input: a file, a line and column in it, and the item there.
///
/// Printed as `scene.toml:14:9 sensor.bands[3]`; unknown parts are left out.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Location {
    /// The file.
    pub file: Option<PathBuf>,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: Option<usize>,
    /// The item, as in `sensor.bands[3]` or `facet 17`.
    pub item: Option<String>,
    /// Byte range in the file's text, for drawing the excerpt.
    pub span: Option<(usize, usize)>,
}

impl Location {
    /// A whole file.
    pub fn file(path: impl AsRef<Path>) -> Self {
        Location { file: Some(path.as_ref().to_owned()), ..Default::default() }
    }

    /// A line of a file (from 1).
    pub fn line(path: impl AsRef<Path>, line: usize) -> Self {
        Location { line: Some(line), ..Location::file(path) }
    }

    /// A byte range of a file whose text is available.
    pub fn span(path: impl AsRef<Path>, text: &str, start: usize, end: usize) -> Self {
        // A third-party parser's offsets may fall inside a character.
        let [start, end] =
            [start, end].map(|at| (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0));
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        Location {
            line: Some(before.matches('\n').count() + 1),
            column: Some(before[line_start..].chars().count() + 1),
            span: Some((start, end.max(start))),
            ..Location::file(path)
        }
    }

    /// An item that is in no file, such as an argument of a library call.
    pub fn item(item: impl Into<String>) -> Self {
        Location { item: Some(item.into()), ..Default::default() }
    }

    /// The same location, naming the item there.
    #[must_use]
    pub fn with_item(mut self, item: impl Into<String>) -> Self {
        self.item = Some(item.into());
        self
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut gap = "";
        if let Some(file) = &self.file {
            write!(f, "{}", file.display())?;
            if let Some(line) = self.line {
                write!(f, ":{line}")?;
                if let Some(column) = self.column {
                    write!(f, ":{column}")?;
                }
            }
            gap = " ";
        }
        if let Some(item) = self.item.as_ref().filter(|item| !item.is_empty()) {
            write!(f, "{gap}{item}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_prints_as_file_line_column_item() {
        let text = "a = 1\nb = [1, \u{3bc}2]\n";
        let at = Location::span("scene.toml", text, text.find('2').unwrap(), text.len()).with_item("b[1]");
        assert_eq!(at.to_string(), "scene.toml:2:10 b[1]");
        assert_eq!(Location::item("sun").to_string(), "sun");
        assert_eq!(Location::default().to_string(), "");
    }

    #[test]
    fn a_place_within_a_letter_is_where_that_begins() {
        let text = "\u{3bc}m\n\u{467}\u{3bc}x";
        for (start, end, column, span) in [(5, 7, 1, (4, 6)), (7, 7, 2, (6, 6)), (8, 99, 3, (8, 9)), (7, 1, 2, (6, 6))]
        {
            let at = Location::span("a.xml", text, start, end);
            assert_eq!((at.line, at.column, at.span), (Some(2), Some(column), Some(span)));
        }
    }

    #[test]
    fn all_problems_are_told() {
        let error = Error::Invalid(vec![
            Problem::new(Location::line("a.obj", 3), "x is NaN"),
            Problem::new(Location::line("a.obj", 9), "no such vertex").with_help("the file has 8"),
        ]);
        assert_eq!(error.to_string(), "a.obj:3: x is NaN\na.obj:9: no such vertex (help: the file has 8)");
    }
}
