//! Text kernels: variables and their values between `\begindata` and `\begintext`, and any text elsewhere.
//!
//! The grammar is that of NAIF's Kernel Required Reading.

use std::path::Path;

use crate::error::{Error, Location, Result};
use crate::flight::{Pool, Values, calendar_s};

/// Months as dates have them.
const MONTHS: [&str; 12] = ["JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC"];

/// One assignment to a variable.
#[derive(Debug, PartialEq)]
pub(super) struct Assignment<'a> {
    /// The variable.
    pub(super) name: &'a str,
    /// Whether it is `+=`.
    pub(super) appends: bool,
    /// Its new or additional values.
    pub(super) values: Values,
    /// Byte offset of each value.
    pub(super) places: Vec<usize>,
    /// Byte offset of the name.
    start: usize,
}

/// A piece of an assignment.
#[derive(Debug, Clone, PartialEq)]
enum Token<'a> {
    Word(&'a str),
    Text(String),
    Open,
    Close,
    Is,
    IsMore,
}

/// A text, its path for messages, and the pieces of its data that are not yet read, each with its place.
struct Reader<'a> {
    text: &'a str,
    path: &'a Path,
    tokens: std::iter::Peekable<std::vec::IntoIter<(usize, Token<'a>)>>,
}

/// Whether a text has data as a kernel has them.
pub(super) fn has_data(text: &str) -> bool {
    text.lines().any(|line| line.trim() == "\\begindata")
}

/// All assignments of a text kernel, in order.
///
/// # Errors
/// [`Error::Syntax`] at the first place that does not follow the grammar.
pub(super) fn parse<'a>(text: &'a str, path: &'a Path) -> Result<Vec<Assignment<'a>>> {
    let tokens = tokens(text, path)?.into_iter().peekable();
    let mut reader = Reader { text, path, tokens };
    let mut all = Vec::new();
    while let Some((start, token)) = reader.tokens.next() {
        let Token::Word(name) = token else {
            return Err(reader.error(start, "a variable's name is expected, e.g. NAME = ( 1, 2 )"));
        };
        let appends = match reader.tokens.next() {
            Some((_, Token::Is)) => false,
            Some((_, Token::IsMore)) => true,
            _ => return Err(reader.error(start, format!("{name}: = or += is expected behind it"))),
        };
        let (values, places) = reader.values(start, name)?;
        all.push(Assignment { name, appends, values, places, start });
    }
    Ok(all)
}

/// Applies assignments, in order.
///
/// # Errors
/// [`Error::Invalid`] for texts added to numbers, or numbers to texts.
pub(super) fn assign(assignments: Vec<Assignment<'_>>, text: &str, path: &Path, pool: &mut Pool) -> Result<()> {
    let mut lines = Lines { text, path, at: 0, line: 1 };
    for assignment in assignments {
        let at = lines.location(assignment.start);
        match assignment.appends {
            true => pool.append(assignment.name, assignment.values, at)?,
            false => pool.assign(assignment.name, assignment.values, at),
        }
    }
    Ok(())
}

/// Counts lines once for places asked for in order.
struct Lines<'a> {
    text: &'a str,
    path: &'a Path,
    at: usize,
    line: usize,
}

impl Lines<'_> {
    fn location(&mut self, start: usize) -> Location {
        self.line += self.text[self.at..start].matches('\n').count();
        self.at = start;
        Location::line(self.path, self.line)
    }
}

/// All tokens of the data. A token never spans lines.
fn tokens<'a>(text: &'a str, path: &Path) -> Result<Vec<(usize, Token<'a>)>> {
    let (mut tokens, mut in_data, mut start) = (Vec::new(), false, 0);
    for line in text.split_inclusive('\n') {
        match line.trim() {
            "\\begindata" => in_data = true,
            "\\begintext" => in_data = false,
            _ if in_data => tokens_of(line, start, &mut tokens).map_err(|place| {
                Error::syntax(Location::span(path, text, place, place + 1), "this text has no closing '")
            })?,
            _ => {}
        }
        start += line.len();
    }
    Ok(tokens)
}

/// The pieces of a line that begins at `start`. The error is the place of a text that does not end.
fn tokens_of<'a>(line: &'a str, start: usize, tokens: &mut Vec<(usize, Token<'a>)>) -> std::result::Result<(), usize> {
    let mut rest = line;
    loop {
        rest = rest.trim_start_matches(|c: char| c.is_whitespace() || c.is_control() || c == ',');
        let place = start + line.len() - rest.len();
        let Some(first) = rest.chars().next() else { return Ok(()) };
        let (token, length) = match first {
            '(' => (Token::Open, 1),
            ')' => (Token::Close, 1),
            '=' => (Token::Is, 1),
            '+' if rest.starts_with("+=") => (Token::IsMore, 2),
            '\'' => {
                let (text, length) = quoted(rest).ok_or(place)?;
                (Token::Text(text), length)
            }
            _ => {
                let is_end = |(at, c): &(usize, char)| {
                    c.is_whitespace() || c.is_control() || ",()='".contains(*c) || rest[*at..].starts_with("+=")
                };
                let length = rest.char_indices().find(is_end).map_or(rest.len(), |(at, _)| at);
                (Token::Word(&rest[..length]), length)
            }
        };
        tokens.push((place, token));
        rest = &rest[length..];
    }
}

/// A quoted string at the beginning of `rest` (a doubled quote is one quote), and its length with the quotes.
fn quoted(rest: &str) -> Option<(String, usize)> {
    let mut text = String::new();
    let mut at = 1;
    loop {
        let end = at + rest[at..].find('\'')?;
        text.push_str(&rest[at..end]);
        if !rest[end + 1..].starts_with('\'') {
            return Some((text, end + 1));
        }
        text.push('\'');
        at = end + 2;
    }
}

impl Reader<'_> {
    fn error(&self, place: usize, message: impl Into<String>) -> Error {
        let length = self.text[place..].find(char::is_whitespace).unwrap_or(1).max(1);
        Error::syntax(Location::span(self.path, self.text, place, place + length), message)
    }

    /// One value, or a parenthesised list; of one kind, and not empty.
    fn values(&mut self, start: usize, name: &str) -> Result<(Values, Vec<usize>)> {
        let (mut numbers, mut texts, mut places) = (Vec::new(), Vec::new(), Vec::new());
        let is_list = self.tokens.next_if(|(_, token)| *token == Token::Open).is_some();
        loop {
            let (place, token) = match self.tokens.next() {
                Some((_, Token::Close)) if is_list => break,
                Some(next) => next,
                None if is_list => return Err(self.error(start, format!("{name}: its list has no closing )"))),
                None => return Err(self.error(start, format!("{name} has no value"))),
            };
            match token {
                Token::Word(word) => numbers.push(number(word).ok_or_else(|| {
                    self.error(place, format!("{name}: {word:?} is neither a number nor a date, and no text without '"))
                })?),
                Token::Text(text) => texts.push(text),
                _ => return Err(self.error(place, format!("{name}: a value is expected here"))),
            }
            places.push(place);
            if !is_list {
                break;
            }
        }
        match (numbers.is_empty(), texts.is_empty()) {
            (false, true) => Ok((Values::Numbers(numbers), places)),
            (true, false) => Ok((Values::Texts(texts), places)),
            (true, true) => Err(self.error(start, format!("{name} has no value"))),
            (false, false) => Err(self.error(start, format!("{name} has both numbers and texts"))),
        }
    }
}

/// A number (D is allowed for E, as in Fortran), or a date after @.
fn number(word: &str) -> Option<f64> {
    if let Some(date) = word.strip_prefix('@') {
        return date_s(date);
    }
    // Names of infinity are not numbers here.
    let is_plain = word.bytes().all(|b| b.is_ascii_digit() || b"+-.eEdD".contains(&b));
    let value: f64 = is_plain.then(|| word.replace(['d', 'D'], "e").parse().ok())??;
    value.is_finite().then_some(value)
}

/// A date, e.g. 1972-JAN-1, 1-JAN-1972 or 1972-01-01, optionally with a time after `T`, `-`, `/` or `:`, in s since
/// 2000-01-01 12:00.
fn date_s(text: &str) -> Option<f64> {
    let is_gap = |c: char| "-/:Tt".contains(c);
    let parts: Vec<String> = match text.to_ascii_uppercase() {
        // The T of a month's name is not a separator.
        upper if upper.contains("OCT") => upper.replace("OCT", "10").split(is_gap).map(str::to_owned).collect(),
        upper => upper.split(is_gap).map(str::to_owned).collect(),
    };
    let [a, b, c, clock @ ..] = parts.as_slice() else { return None };
    let whole = |text: &str| -> Option<i64> {
        (text.len() <= 6 && !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
    };
    let month_named = |text: &str| (1..).zip(MONTHS).find(|(_, name)| text.starts_with(name)).map(|(month, _)| month);
    let month = month_named(b).or_else(|| whole(b))?;
    let (a, c) = (whole(a)?, whole(c)?);
    let (year, day) = if a > 31 { (a, c) } else { (c, a) };
    let mut second_s = 0.0;
    for (part, unit_s) in clock.iter().zip([3600.0, 60.0, 1.0]) {
        let value: f64 = part.bytes().all(|b| b.is_ascii_digit() || b == b'.').then(|| part.parse().ok())??;
        second_s += value * unit_s;
    }
    (clock.len() <= 3 && second_s < 86_401.0).then(|| calendar_s([year, month, day], second_s))?
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pool(text: &str) -> Result<Pool> {
        let mut pool = Pool::default();
        let path = Path::new("k.tpc");
        assign(parse(text, path)?, text, path, &mut pool)?;
        Ok(pool)
    }

    #[test]
    fn variables_are_read_between_the_marks_alone() {
        let text = "KPL/PCK\nX = ( 1 )\n  \\begindata  \nA=1.5D3\nB = ( 1, 2.\n -3e-2\t+.5 )\nB += ( 7 ) C = 'it''s' D=(''\n'b c')\n\
                    \\begintext\nY = 2\n\\begindata\nE/F = ( @1972-JAN-1 @2-Oct-2000 @2000-01-01T12:00:01.5 )\n\\begintext";
        for text in [text.to_owned(), text.replace('\n', "\r\n")] {
            let pool = pool(&text).unwrap();
            let numbers = |name: &str| pool.numbers(name).unwrap().map(<[f64]>::to_vec);
            assert_eq!(numbers("A"), Some(vec![1500.0]));
            assert_eq!(numbers("B"), Some(vec![1.0, 2.0, -0.03, 0.5, 7.0]));
            assert_eq!(pool.texts("C").unwrap().unwrap(), ["it's"]);
            assert_eq!(pool.texts("D").unwrap().unwrap(), ["", "b c"]);
            // 28 years of which 7 are leap years, and half a day, before; 2 October 2000 is day 275 from 0.
            let days = [-(28.0 * 365.0 + 7.0) - 0.5, 275.0 - 0.5];
            assert_eq!(numbers("E/F"), Some(vec![days[0] * 86_400.0, days[1] * 86_400.0, 1.5]));
            assert_eq!((numbers("X"), numbers("Y")), (None, None));
            assert!(pool.wrong("D", "no").to_string().starts_with("k.tpc:7 D"), "{}", pool.wrong("D", "no"));
        }
    }

    #[test]
    fn what_is_no_assignment_is_told_with_its_place() {
        for (data, told) in [
            ("A = ", "k.tpc:2:1: A has no value"),
            ("A = ()", "k.tpc:2:1: A has no value"),
            ("A = ( 1", "k.tpc:2:1: A: its list has no closing )"),
            ("A = ( 1 'x' )", "both numbers and texts"),
            ("A = ( 1 B = 2 )", "k.tpc:2:9: A: \"B\" is neither"),
            ("A = 'x", "k.tpc:2:5: this text has no closing '"),
            ("A 1", "A: = or += is expected"),
            ("= 1", "a variable's name is expected"),
            ("A = inf", "\"inf\" is neither"),
            ("A = 1e999", "\"1e999\" is neither"),
            ("A = @1972-FEB-30", "is neither"),
            ("A = 1\nA += 'x'", "k.tpc:3: A: += cannot mix numbers and strings"),
        ] {
            let error = pool(&format!("\\begindata\n{data}")).unwrap_err().to_string();
            assert!(error.contains(told), "{data}: {error}");
        }
    }
}
