//! Labels in PVL: keywords with values, in objects and groups, as PDS3 and ISIS cubes begin.
//!
//! Sources: CCSDS 641.0-B-2 (PVL); PDS Standards Reference 3.8, chapter 12 (ODL). Keywords are compared in capitals.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::input;

/// Labels end before this, bytes.
const LONGEST: usize = 4 << 20;
/// Objects are nested no deeper.
const DEEPEST: usize = 32;

/// An object or a group, or the whole label.
#[derive(Debug, Default)]
pub(super) struct Block {
    path: PathBuf,
    name: String,
    line: usize,
    statements: Vec<Statement>,
    /// Objects and groups within.
    pub(super) blocks: Vec<Block>,
}

/// A keyword with its values: one, or those of a list.
#[derive(Debug)]
pub(super) struct Statement {
    key: String,
    line: usize,
    /// In the order of the text.
    pub(super) values: Vec<Word>,
}

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Word {
    /// Without quotation marks.
    pub(super) text: String,
    /// What stands behind it as `<KM>`, in small letters.
    pub(super) unit: Option<String>,
}

/// Reads the label that a file begins with.
pub(super) fn read(path: &Path) -> Result<Block> {
    let bytes = input::beginning(path, LONGEST)?;
    parse(&String::from_utf8_lossy(&bytes), path)
}

/// Reads a label, to its END.
pub(super) fn parse(text: &str, path: &Path) -> Result<Block> {
    let mut cursor = Cursor { rest: text, line: 1, path };
    let mut open = vec![Block { path: path.to_owned(), line: 1, ..Block::default() }];
    loop {
        cursor.skip();
        let line = cursor.line;
        let key = cursor.take(|c| c.is_whitespace() || matches!(c, '=' | ';')).to_uppercase();
        match key.as_str() {
            "" if cursor.rest.is_empty() => return Err(cursor.wrong("the label has no END: it is cut short")),
            "" => return Err(cursor.wrong("a keyword is missing before `=`")),
            "END" => break,
            "END_OBJECT" | "END_GROUP" | "ENDOBJECT" | "ENDGROUP" => {
                if cursor.is_next('=') {
                    cursor.values()?;
                }
                let Some(done) = open.pop().filter(|_| !open.is_empty()) else {
                    return Err(cursor.wrong(&format!("{key} of nothing that has begun")));
                };
                if let Some(around) = open.last_mut() {
                    around.blocks.push(done);
                }
            }
            _ => {
                if !cursor.is_next('=') {
                    return Err(cursor.wrong(&format!("`=` is missing behind {}", shown(&key))));
                }
                let values = cursor.values()?;
                let is_block = ["OBJECT", "GROUP", "BEGIN_OBJECT", "BEGIN_GROUP"].contains(&key.as_str());
                let Some(inner) = open.last_mut() else { break };
                if !is_block {
                    inner.statements.push(Statement { key, line, values });
                    continue;
                }
                let name = values.first().map(|word| word.text.to_uppercase()).unwrap_or_default();
                if open.len() > DEEPEST {
                    return Err(cursor.wrong(&format!("objects are nested deeper than {DEEPEST}")));
                }
                open.push(Block { path: path.to_owned(), name, line, ..Block::default() });
            }
        }
    }
    if let [_, .., inner] = &open[..] {
        return Err(cursor.wrong(&format!("END before that of {}, which begins at line {}", inner.name, inner.line)));
    }
    Ok(open.swap_remove(0))
}

fn shown(text: &str) -> String {
    format!("{:?}", text.chars().take(40).collect::<String>())
}

struct Cursor<'a> {
    rest: &'a str,
    line: usize,
    path: &'a Path,
}

impl<'a> Cursor<'a> {
    fn wrong(&self, message: &str) -> Error {
        Error::syntax(Location::line(self.path, self.line), message)
    }

    /// Goes on by so many bytes.
    fn step(&mut self, bytes: usize) -> &'a str {
        let (before, rest) = self.rest.split_at(bytes);
        self.line += before.matches('\n').count();
        self.rest = rest;
        before
    }

    /// White space and comments.
    fn skip(&mut self) {
        loop {
            let blank = self.rest.len()
                - self.rest.trim_start_matches([' ', '\t', '\r', '\n', '\0', ';', '\x0b', '\x0c']).len();
            self.step(blank);
            let line_end = || self.rest.find('\n').unwrap_or(self.rest.len());
            if self.rest.starts_with("/*") {
                let end = self.rest.find("*/").map_or_else(line_end, |end| end + 2);
                self.step(end);
            } else if self.rest.starts_with('#') {
                self.step(line_end());
            } else {
                return;
            }
        }
    }

    /// What comes before the first such character.
    fn take(&mut self, ends: impl Fn(char) -> bool) -> &'a str {
        self.step(self.rest.find(ends).unwrap_or(self.rest.len()))
    }

    /// Whether this character comes next, behind white space; it is passed over.
    fn is_next(&mut self, wanted: char) -> bool {
        self.skip();
        let is_it = self.rest.starts_with(wanted);
        if is_it {
            self.step(wanted.len_utf8());
        }
        is_it
    }

    /// One value, or those of a list; of lists within lists all.
    fn values(&mut self) -> Result<Vec<Word>> {
        let (mut values, mut depth) = (Vec::new(), 0_usize);
        loop {
            self.skip();
            match self.rest.chars().next() {
                None => return Err(self.wrong("a value is missing: the label is cut short")),
                Some('(' | '{') => {
                    self.step(1);
                    depth += 1;
                }
                Some(')' | '}') if depth > 0 => {
                    self.step(1);
                    depth -= 1;
                }
                Some(',') if depth > 0 => {
                    self.step(1);
                }
                Some(_) => values.push(self.word()?),
            }
            if depth == 0 {
                // A unit may stand behind a list, for all of it.
                if let Some(unit) = self.unit()? {
                    values
                        .iter_mut()
                        .filter(|word| word.unit.is_none())
                        .for_each(|word| word.unit = Some(unit.clone()));
                }
                return Ok(values);
            }
        }
    }

    fn word(&mut self) -> Result<Word> {
        let text = match self.rest.chars().next() {
            Some(mark @ ('"' | '\'')) => {
                self.step(1);
                if !self.rest.contains(mark) {
                    return Err(self.wrong(&format!("{mark} is not closed")));
                }
                let text = self.take(|c| c == mark);
                self.step(1);
                // Lines are joined: by a blank, or by nothing where they end in a hyphen.
                text.split_whitespace().collect::<Vec<_>>().join(" ").replace("- ", "")
            }
            _ => {
                let text = self.take(|c| c.is_whitespace() || matches!(c, ',' | ')' | '}' | ';' | '<'));
                if text.is_empty() {
                    return Err(self.wrong("a value is missing"));
                }
                text.to_owned()
            }
        };
        Ok(Word { text, unit: self.unit()? })
    }

    /// `<KM>`, on the same line.
    fn unit(&mut self) -> Result<Option<String>> {
        let blank = self.rest.len() - self.rest.trim_start_matches([' ', '\t']).len();
        if !self.rest[blank..].starts_with('<') {
            return Ok(None);
        }
        self.step(blank + 1);
        let unit = self.take(|c| matches!(c, '>' | '\n')).trim().to_lowercase();
        if !self.rest.starts_with('>') {
            return Err(self.wrong("< is not closed"));
        }
        self.step(1);
        Ok(Some(unit))
    }
}

impl Block {
    /// The first object or group of this name, at any depth.
    pub(super) fn within(&self, name: &str) -> Option<&Block> {
        let here = self.blocks.iter().find(|block| block.name == name);
        here.or_else(|| self.blocks.iter().find_map(|block| block.within(name)))
    }

    /// What a keyword says.
    pub(super) fn get(&self, key: &str) -> Option<&Statement> {
        self.statements.iter().find(|statement| statement.key == key)
    }

    /// The first value of a keyword.
    pub(super) fn word(&self, key: &str) -> Option<&Word> {
        self.get(key)?.values.first()
    }

    /// That, as text in capitals.
    pub(super) fn text(&self, key: &str) -> Option<String> {
        self.word(key).map(|word| word.text.to_uppercase())
    }

    /// All keywords.
    pub(super) fn keys(&self) -> impl Iterator<Item = &str> {
        self.statements.iter().map(|statement| statement.key.as_str())
    }

    /// Where a keyword stands, or where it is missing.
    pub(super) fn at(&self, key: &str) -> Location {
        let line = self.get(key).map_or(self.line, |statement| statement.line);
        Location::line(&self.path, line).with_item(key)
    }

    /// The number that a keyword has, if it is there and no word such as "N/A".
    ///
    /// # Errors
    /// What is there instead.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>> {
        let Some(word) = self.word(key) else { return Ok(None) };
        if ["N/A", "NULL", "UNK", "NONE"].contains(&word.text.to_uppercase().as_str()) {
            return Ok(None);
        }
        match word.text.parse() {
            Ok(number) => Ok(Some(number)),
            Err(_) => Err(Error::invalid(self.at(key), format!("{} is not a number", shown(&word.text)))),
        }
    }

    /// The count that a keyword has, or this one.
    ///
    /// # Errors
    /// What is there instead, or that nothing is and must be.
    pub(super) fn count(&self, key: &str, default: Option<usize>) -> Result<usize> {
        match (self.word(key), default) {
            (Some(word), _) => word
                .text
                .parse()
                .map_err(|_| Error::invalid(self.at(key), format!("{} is not a count", shown(&word.text)))),
            (None, Some(default)) => Ok(default),
            (None, None) => {
                let problem = Problem::new(self.at(key), format!("is missing in {}", self.name));
                Err(Error::Invalid(vec![problem]))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LABEL: &str = "PDS_VERSION_ID = PDS3 /* a comment = 1 */\r\n# another\r\n^IMAGE = (\"A.IMG\", 3 <BYTES>)\r\n\
        OBJECT = IMAGE\r\n  LINES=2;LINE_SAMPLES = 3\r\n  MAP_SCALE = 0.5 <KM/PIXEL>\r\n  NOTE = \"two\r\n    lines-\r\n  joined\"\r\n\
          SCALES = (1, 2.5) <M>\r\n  BAD = none\r\nEND_OBJECT = IMAGE\r\nEND\r\n\0\x01\x02 = (";

    #[test]
    fn labels_are_read_to_their_end() {
        let label = parse(LABEL, Path::new("a.lbl")).unwrap();
        let word = |text: &str, unit: Option<&str>| Word { text: text.into(), unit: unit.map(str::to_owned) };
        assert_eq!(label.get("^IMAGE").unwrap().values, [word("A.IMG", None), word("3", Some("bytes"))]);
        let image = label.within("IMAGE").unwrap();
        assert_eq!((image.count("LINES", None).unwrap(), image.count("BANDS", Some(1)).unwrap()), (2, 1));
        assert_eq!(image.word("MAP_SCALE"), Some(&word("0.5", Some("km/pixel"))));
        assert_eq!(image.word("NOTE").unwrap().text, "two linesjoined");
        assert_eq!(image.get("SCALES").unwrap().values, [word("1", Some("m")), word("2.5", Some("m"))]);
        assert_eq!(image.number("BAD").unwrap(), None);
        assert_eq!(
            image.count("NOTE", None).unwrap_err().to_string(),
            "a.lbl:7 NOTE: \"two linesjoined\" is not a count"
        );
        assert!(image.count("BANDS", None).unwrap_err().to_string().contains("a.lbl:4 BANDS: is missing in IMAGE"));
    }

    #[test]
    fn what_is_wrong_is_told_at_its_line() {
        for (text, message) in [
            ("", ":1: the label has no END"),
            ("A = 1\n", ":2: the label has no END"),
            ("A = 1\nB 2\nEND", ":2: `=` is missing behind \"B\""),
            ("A = \"x\nEND\n", ":1: \" is not closed"),
            ("A = 3 <M\nEND\n", ":1: < is not closed"),
            ("A = (1, 2\nEND", ":2: a value is missing"),
            ("= 3\nEND\n", ":1: a keyword is missing"),
            ("A =", ":1: a value is missing"),
            ("END_OBJECT = A\nEND", "END_OBJECT of nothing"),
            ("OBJECT = A\nEND", ":2: END before that of A, which begins at line 1"),
            (&"OBJECT = A\n".repeat(99), "nested deeper than 32"),
        ] {
            let error = parse(text, Path::new("a.lbl")).unwrap_err().to_string();
            assert!(error.contains(message), "{text:?}: {error}");
        }
    }
}
