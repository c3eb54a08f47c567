//! What a command line puts in place of an item of a text: `sensor.samples=64`, `materials."blue unit".reflectance=0.07`, `mesh[0].recipe=dunes`; nothing
//! behind the equals sign takes the item away.

use std::str::FromStr;

use serde_json::{Map, Value};

use super::located::{Document, member};
use crate::error::{Error, Location, Problem, Result};

/// An item and what takes its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    steps: Vec<Step>,
    value: Option<Value>,
    text: String,
}

/// A step from a table or list to what is in it.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    Key(String),
    Index(usize),
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (steps, rest) = steps(text)?;
        let value = match rest.trim() {
            "" => None,
            written => Some(value(written)?),
        };
        Ok(Setting { steps, value, text: text.to_owned() })
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

/// Names of a key: files are not deeper either.
const DEEPEST: usize = 64;

/// The steps before the equals sign, and what is behind it.
fn steps(text: &str) -> std::result::Result<(Vec<Step>, &str), String> {
    let (mut steps, mut rest) = (Vec::new(), text.trim_start());
    loop {
        let key = if rest.starts_with('"') {
            let (key, behind) = quoted(rest)?;
            rest = behind;
            key
        } else {
            let is_bare = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
            let end = rest.find(|c| !is_bare(c)).unwrap_or(rest.len());
            let key = &rest[..end];
            rest = &rest[end..];
            key.to_owned()
        };
        if key.is_empty() {
            return Err("KEY=VALUE is expected, as in sensor.samples=64".to_owned());
        }
        steps.push(Step::Key(key));
        if steps.len() > DEEPEST {
            return Err(format!("more than {DEEPEST} names: no item lies so deep"));
        }
        while let Some(inner) = rest.strip_prefix('[') {
            let (index, behind) = inner.split_once(']').ok_or("a `[` has no `]`")?;
            steps.push(Step::Index(
                index.trim().parse().map_err(|_| format!("[{index}] is no number of an element, from 0"))?,
            ));
            rest = behind;
        }
        rest = rest.trim_start();
        if let Some(value) = rest.strip_prefix('=') {
            return Ok((steps, value));
        }
        rest = rest.strip_prefix('.').ok_or("KEY=VALUE is expected, as in sensor.samples=64")?;
    }
}

/// A name in quotes, with the escapes of TOML, and what is behind it.
fn quoted(text: &str) -> std::result::Result<(String, &str), String> {
    let mut is_escaped = false;
    let end = text.bytes().enumerate().skip(1).find(|(_, byte)| {
        let is_end = *byte == b'"' && !is_escaped;
        is_escaped = *byte == b'\\' && !is_escaped;
        is_end
    });
    let (end, _) = end.ok_or("a quoted name has no end")?;
    let (name, behind) = text.split_at(end + 1);
    match toml::from_str::<toml::Table>(&format!("x = {name}")).ok().and_then(|mut table| table.remove("x")) {
        Some(toml::Value::String(key)) => Ok((key, behind)),
        _ => Err(format!("{name} is no name as TOML has it: a backslash is written \\\\, a quotation mark \\\"")),
    }
}

/// A value as TOML has it; what is none is a text, so that words need no quotes.
fn value(written: &str) -> std::result::Result<Value, String> {
    let table = toml::from_str::<toml::Table>(&format!("x = {written}")).ok();
    if table.as_ref().is_some_and(|table| table.len() > 1) {
        return Err("one item is set at a time: there is another one behind a line's end".to_owned());
    }
    // Dates, which nothing here is, would become tables.
    match table.and_then(|mut table| table.remove("x")) {
        None => Ok(Value::String(written.to_owned())),
        Some(toml::Value::Datetime(_)) => Err(format!("{written} is a date: nothing here is")),
        Some(value) => match serde_json::to_value(value) {
            Ok(Value::Null) | Err(_) => Err(format!("{written} is not a finite number")),
            Ok(value) => Ok(value),
        },
    }
}

/// A text with some items replaced.
///
/// # Errors
/// [`Error::Invalid`] with all that have no place in it.
pub(super) fn with(mut document: Document, settings: &[Setting]) -> Result<Document> {
    let mut problems = Vec::new();
    for setting in settings {
        match document.edit(&setting.item(), setting.at(), |tree| setting.put(tree)) {
            Err(Error::Invalid(more)) => problems.extend(more),
            other => other?,
        }
    }
    if problems.is_empty() { Ok(document) } else { Err(Error::Invalid(problems)) }
}

impl Setting {
    /// The item that it sets, as it is named in messages.
    fn item(&self) -> String {
        self.steps.iter().fold(String::new(), |item, step| match step {
            Step::Key(key) => member(&item, key),
            Step::Index(index) => format!("{item}[{index}]"),
        })
    }

    /// Where it is, in messages.
    fn at(&self) -> Location {
        Location::item(format!("--set {}", self.text))
    }

    /// Puts it into a tree.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is nothing that it could be in.
    fn put(&self, tree: &mut Value) -> Result<()> {
        let wrong = |message: String| Err(Error::Invalid(vec![Problem::new(self.at(), message)]));
        let Some((last, before)) = self.steps.split_last() else { return Ok(()) };
        let (mut place, mut item) = (tree, String::new());
        for step in before {
            (place, item) = match step {
                Step::Key(key) => {
                    let Value::Object(map) = place else { return wrong(format!("{item} is not a table")) };
                    (map.entry(key).or_insert_with(|| Value::Object(Map::new())), member(&item, key))
                }
                Step::Index(index) => {
                    let Value::Array(list) = place else { return wrong(format!("{item} is not a list")) };
                    let count = list.len();
                    let Some(element) = list.get_mut(*index) else {
                        return wrong(format!("{item} has {count} elements, counted from 0"));
                    };
                    (element, format!("{item}[{index}]"))
                }
            };
        }
        match (last, place) {
            (Step::Key(key), Value::Object(map)) => match &self.value {
                Some(value) => drop(map.insert(key.clone(), value.clone())),
                None => drop(map.remove(key)),
            },
            (Step::Index(index), Value::Array(list)) => match (&self.value, list.len()) {
                (Some(value), count) if *index < count => list[*index] = value.clone(),
                // The next one may be added.
                (Some(value), count) if *index == count => list.push(value.clone()),
                (None, count) if *index < count => drop(list.remove(*index)),
                (_, count) => return wrong(format!("{item} has {count} elements, counted from 0")),
            },
            (Step::Key(_), _) => return wrong(format!("{item} is not a table")),
            (Step::Index(_), _) => return wrong(format!("{item} is not a list")),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn settings_are_items_and_values_of_toml_or_words() {
        for (text, item, value) in [
            ("sensor.samples=64", "sensor.samples", Some(json!(64))),
            (" a.b = 1e-3 ", "a.b", Some(json!(1e-3))),
            ("mesh[0].recipe=dunes", "mesh[0].recipe", Some(json!("dunes"))),
            ("materials.\"blue unit\".reflectance = 0.07", "materials.\"blue unit\".reflectance", Some(json!(0.07))),
            (r#"materials."a\"b\\c]=".reflectance=1"#, r#"materials."a\"b\\c]=".reflectance"#, Some(json!(1))),
            ("observer.target_m=[1, 2.5, 3]", "observer.target_m", Some(json!([1, 2.5, 3]))),
            ("sun={ distance_au = 1.5 }", "sun", Some(json!({ "distance_au": 1.5 }))),
            ("a=\"7\"", "a", Some(json!("7"))),
            ("a=true", "a", Some(json!(true))),
            ("a=x=y", "a", Some(json!("x=y"))),
        ] {
            let setting = text.parse::<Setting>();
            match (setting, value) {
                (Ok(setting), Some(value)) => assert_eq!((setting.item().as_str(), setting.value), (item, Some(value))),
                (setting, None) => assert!(setting.is_err(), "{text}: {setting:?}"),
                (Err(error), _) => panic!("{text}: {error}"),
            }
        }
        for text in [
            "",
            "=1",
            "a",
            "a.=1",
            "a[x]=1",
            "a[0=1",
            "\"a=1",
            "\"a\\\"=1",
            "\"a\\q\"=1",
            "\"\"=1",
            "\"\"\"a=1",
            "a=1979-05-27",
        ] {
            assert!(text.parse::<Setting>().is_err(), "{text}");
        }
    }

    #[test]
    fn settings_make_replace_and_remove() {
        let mut tree = json!({ "sensor": { "samples": 4 }, "mesh": [{ "obj": "a" }] });
        for text in
            ["sensor.samples=8", "mars.position_m=[1,2,3]", "mesh[0].obj=b", "mesh[1]={ obj = \"c\" }", "sensor.lines="]
        {
            text.parse::<Setting>().unwrap().put(&mut tree).unwrap();
        }
        let wanted = json!({ "sensor": { "samples": 8 }, "mesh": [{ "obj": "b" }, { "obj": "c" }], "mars": { "position_m": [1, 2, 3] } });
        assert_eq!(tree, wanted);
        "mesh=".parse::<Setting>().unwrap().put(&mut tree).unwrap();
        assert!(tree.get("mesh").is_none());
        for (text, message) in
            [("sensor.samples.x=1", "sensor.samples is not a table"), ("sensor[0]=1", "sensor is not a list")]
        {
            let error = text.parse::<Setting>().unwrap().put(&mut tree).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
