//! Errors shown on the text they are about.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::input::BYTE_ORDER_MARK;
use crate::error::{Error, Problem};

/// An error as text for a terminal: each problem with the lines of the file that it is about, as the compiler shows them.
///
/// Plain, without colour. A problem whose text cannot be read (again) is shown as [`Display`](std::fmt::Display) shows it.
pub fn picture(error: &Error) -> String {
    let problems = error.problems();
    if problems.is_empty() {
        return format!("error: {error}");
    }
    problems.iter().map(of_problem).collect::<Vec<_>>().join("\n")
}

fn of_problem(problem: &Problem) -> String {
    let Problem { at, message, help } = problem;
    let plain = || format!("error: {problem}");
    let (Some(path), Some(line), Some((start, end))) = (&at.file, at.line, at.span) else { return plain() };
    let Some((lines, start, end)) = lines_around(path, start, end) else { return plain() };
    let title = match &at.item {
        Some(item) => format!("{item}: {message}"),
        None => message.clone(),
    };
    let name = path.display().to_string();
    let snippet = Snippet::source(lines.as_str())
        .line_start(line)
        .path(name.as_str())
        .annotation(AnnotationKind::Primary.span(start..end));
    let mut group = Level::ERROR.primary_title(title.as_str()).element(snippet);
    if let Some(help) = help {
        group = group.element(Level::HELP.message(help));
    }
    Renderer::plain().render(&[group])
}

/// No more than this is read around a place, bytes: some files have one line.
const REACH: usize = 400;

/// The line a byte range begins in, and the range within it. Reads only that part of the file: an OBJ can have 80 MB.
fn lines_around(path: &Path, start: usize, end: usize) -> Option<(String, usize, usize)> {
    let mut file = File::open(path).ok()?;
    let mut first = Vec::new();
    file.by_ref().take(BYTE_ORDER_MARK.len() as u64).read_to_end(&mut first).ok()?;
    let mark = if first == BYTE_ORDER_MARK { first.len() as u64 } else { 0 };
    let from = start.saturating_sub(REACH);
    file.seek(SeekFrom::Start(mark + from as u64)).ok()?;
    let mut bytes = Vec::new();
    file.take((start - from + REACH) as u64).read_to_end(&mut bytes).ok()?;
    let at = start - from;
    let first = bytes.get(..at)?.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
    if first == 0 && from > 0 {
        return None;
    }
    let last = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |i| at + i);
    let text = std::str::from_utf8(bytes.get(first..last)?).ok()?;
    let text = text.trim_end_matches('\r');
    let start = at - first;
    let end = (start + (end.saturating_sub(from + at))).clamp(start, text.len().max(start));
    (start <= text.len() && text.is_char_boundary(start) && text.is_char_boundary(end))
        .then(|| (text.to_owned(), start, end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Location;

    #[test]
    fn a_problem_is_shown_on_its_line() {
        let path = std::env::temp_dir().join(format!("mmxrt-picture-{}.toml", std::process::id()));
        let text = "a = 1\nbands = 3 # \u{3bc}\n";
        std::fs::write(&path, text).unwrap();
        let at = Location::span(&path, text, 14, 15).with_item("sensor.bands");
        let error = Error::Invalid(vec![
            Problem::new(at.clone(), "expected a table, found 3").with_help("write { start_um = 1, ... }"),
            Problem::new(Location::item("mesh"), "has no facets"),
        ]);
        let shown = picture(&error);
        std::fs::remove_file(&path).unwrap();
        for part in [
            "error: sensor.bands: expected a table",
            ".toml:2:9",
            "2 | bands = 3",
            "^",
            "help: write {",
            "error: mesh: has no facets",
        ] {
            assert!(shown.contains(part), "{part:?} in\n{shown}");
        }
        // The file is gone: the same without its text.
        assert!(picture(&error).starts_with("error: /"), "{}", picture(&error));
    }
}
