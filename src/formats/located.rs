//! TOML that people write: read into typed values, with every problem at its place.
//!
//! Serde stops at the first thing it cannot use and often does not know where. Here the text becomes a tree that
//! remembers its places; the tree is compared with the JSON Schema of the type it should be, and *all* that is unknown,
//! missing or of another kind is reported; only then does serde read it. The schema is the published one, so that editors
//! and this reader cannot disagree.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::input::{self, InputFile};
use super::key_units;
use super::spelling::nearest;
use crate::error::{Error, Location, Problem, Result, number};

/// Longer files are refused, bytes: no one writes them by hand.
const LIMIT: u64 = 16 << 20;
/// At most this many problems are reported: the place of each is counted from the beginning of the text.
const TOLD: usize = 100;
/// Longer names of items are refused, bytes: each item of a table or list carries the names of all around it.
pub(super) const LONGEST_NAME: usize = 400;

/// The keys that identify what a text is, and what to do with it.
const KINDS: [(&str, &str); 7] = [
    ("mmxrt_scene", "is a scene file: `mmxrt simulate` takes it"),
    ("mmxrt_map", "is a map file: `mmxrt integrate SCENE --radiance` takes it"),
    ("mmxrt_campaign", "is a campaign: `mmxrt campaign` takes it, and `mmxrt locate` with --acquisition NAME"),
    ("mmxrt_knowledge", "says how well something is known: `mmxrt locate SCENE --knowledge` takes it"),
    ("mmxrt_instrument", "is an instrument: `mmxrt instrument CUBE --instrument` takes it"),
    ("mmxrt_flight", "is a table of positions: `mmxrt inspect` says what it holds"),
    (
        "seed",
        "is the recipe of a landscape: `mmxrt landscape` makes a mesh of it, and a scene has it as `recipe` in `[[mesh]]`",
    ),
];

/// What a file is that is not a TOML text, by the ending of its name, and what is to be done with it.
fn other_kind(path: &Path) -> Option<(&'static str, String)> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    let scene_of = || format!("`mmxrt convert {} SCENE.toml` makes a scene of it", path.display());
    Some(match ending.as_str() {
        "obj" => ("a mesh (OBJ)", scene_of()),
        "gltf" | "glb" => ("a mesh (glTF)", scene_of()),
        "blend" => ("a scene of Blender", scene_of()),
        "stl" | "ply" | "fbx" => ("a mesh in a format that is not read", "save it as OBJ or glTF".into()),
        "img" | "hdr" | "exr" | "npy" | "npz" | "png" | "jpg" | "jpeg" | "csv" => {
            ("a table or an image", format!("`mmxrt inspect {}` says what it holds", path.display()))
        }
        _ => return None,
    })
}

/// A TOML text as a tree whose items know their places.
///
/// Items are named as in `sensor.bands.start_um`, `mesh[0].obj` and `materials."blue unit".reflectance`.
#[derive(Debug, Clone)]
pub struct Document {
    path: PathBuf,
    text: String,
    tree: Value,
    places: BTreeMap<String, Spans>,
    /// Items that are not of the text but were put into the tree, and where they are said.
    put: BTreeMap<String, Location>,
    /// What cannot be used of the text itself; the first of it, and one more if there is more.
    problems: Vec<Problem>,
}

#[derive(Debug, Clone)]
struct Spans {
    key: Range<usize>,
    value: Range<usize>,
}

impl Document {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] for a file of more than 16 MiB; [`Error::Syntax`] at the first place that is not
    /// UTF-8 or not TOML.
    pub fn open(path: &Path) -> Result<(Self, InputFile)> {
        let read = || {
            let (text, input) = input::text(path, LIMIT)?;
            Ok((Self::parse(text, path)?, input))
        };
        read().map_err(|error| match (error, other_kind(path)) {
            (Error::Syntax { .. } | Error::Invalid(_), Some((what, help))) => Error::Invalid(vec![
                Problem::new(Location::file(path), format!("is {what}, no TOML text")).with_help(help),
            ]),
            (error, _) => error,
        })
    }

    /// Parses a text; `path` is for messages.
    ///
    /// # Errors
    /// [`Error::Syntax`] at the first place that is not TOML.
    pub fn parse(text: String, path: &Path) -> Result<Self> {
        let root = DeTable::parse(&text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            Error::syntax(Location::span(path, &text, span.start, span.end), e.message())
        })?;
        let mut document = Document {
            path: path.to_owned(),
            text: String::new(),
            tree: Value::Null,
            places: BTreeMap::new(),
            put: BTreeMap::new(),
            problems: Vec::new(),
        };
        document.tree = document.table(root.get_ref(), "", &text);
        document.text = text;
        document.problems.sort_by_key(|p| p.at.span);
        Ok(document)
    }

    fn table(&mut self, table: &DeTable<'_>, path: &str, text: &str) -> Value {
        let mut map = Map::new();
        for (key, value) in table.iter() {
            let item = member(path, key.get_ref());
            if item.len() > LONGEST_NAME {
                let at = key.span();
                self.refuse(text, at, path, || format!("a name of {} bytes, with those around it", item.len()));
                continue;
            }
            self.places.insert(item.clone(), Spans { key: key.span(), value: value.span() });
            map.insert(key.get_ref().to_string(), self.value(value, &item, text));
        }
        Value::Object(map)
    }

    /// The value without its places; `Null`, which TOML does not have, for what was reported as a problem.
    fn value(&mut self, value: &Spanned<DeValue<'_>>, item: &str, text: &str) -> Value {
        let refused = match value.get_ref() {
            DeValue::String(s) => return Value::String(s.to_string()),
            DeValue::Boolean(b) => return Value::Bool(*b),
            DeValue::Table(table) => return self.table(table, item, text),
            DeValue::Array(array) => {
                let elements = array.iter().enumerate().map(|(i, element)| {
                    let item = format!("{item}[{i}]");
                    self.places.insert(item.clone(), Spans { key: element.span(), value: element.span() });
                    self.value(element, &item, text)
                });
                return Value::Array(elements.collect());
            }
            DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
                Ok(i) => return Value::from(i),
                Err(_) => format!("{i} does not fit in 64 bits"),
            },
            DeValue::Float(f) => match f.as_str().parse::<f64>() {
                Ok(f) if f.is_finite() => return Value::from(f),
                _ => format!("{f} is not a finite number"),
            },
            DeValue::Datetime(d) => format!("{d} is a date: nothing here is"),
        };
        self.refuse(text, value.span(), item, || refused);
        Value::Null
    }

    fn refuse(&mut self, text: &str, span: Range<usize>, item: &str, message: impl FnOnce() -> String) {
        if self.problems.len() <= TOLD {
            let at = Location::span(&self.path, text, span.start, span.end).with_item(item);
            self.problems.push(Problem::new(at, message()));
        }
    }

    /// What it says, without its places.
    pub fn tree(&self) -> &Value {
        &self.tree
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The place of an item's value; of the nearest item around it, if the text does not have it (a default, say).
    pub fn at(&self, item: &str) -> Location {
        let mut known = item;
        while !known.is_empty() {
            if let Some(said) = self.put.get(known) {
                return said.clone();
            }
            if let Some(place) = self.places.get(known) {
                return Location::span(&self.path, &self.text, place.value.start, place.value.end).with_item(item);
            }
            known = parent(known);
        }
        Location::file(&self.path).with_item(item)
    }

    /// An element of a list of tables.
    pub(super) fn element(&self, list: &str, i: usize) -> Option<&Map<String, Value>> {
        self.tree.get(list)?.get(i)?.as_object()
    }

    /// Whether the text has an item.
    pub fn has(&self, item: &str) -> bool {
        self.places.contains_key(item) || self.put.contains_key(item)
    }

    /// Changes an item of the tree, as it is said elsewhere: by `edit`, which makes, replaces or removes it.
    ///
    /// # Errors
    /// Those of `edit`; then nothing is changed.
    pub(super) fn edit(
        &mut self,
        item: &str,
        said: Location,
        edit: impl FnOnce(&mut Value) -> Result<()>,
    ) -> Result<()> {
        let mut tree = self.tree.clone();
        edit(&mut tree)?;
        self.tree = tree;
        let is_within =
            |name: &str| name.strip_prefix(item).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
        self.places.retain(|name, _| !is_within(name));
        self.put.retain(|name, _| !is_within(name));
        // What the text says wrong there does not count any more.
        self.problems.retain(|problem| !problem.at.item.as_deref().is_some_and(is_within));
        // What is there now, in it and around it.
        let mut now = Vec::new();
        names("", &self.tree, &mut now);
        for name in now {
            if !self.has(&name) {
                self.put.insert(name, said.clone());
            }
        }
        Ok(())
    }

    /// The keys of a table, in the order of the text.
    pub fn keys(&self, item: &str) -> Vec<String> {
        let mut table = Some(&self.tree);
        for key in item.split('.').filter(|k| !k.is_empty()) {
            table = table.and_then(|t| t.get(key));
        }
        let mut keys: Vec<&String> = table.and_then(Value::as_object).map_or(vec![], |map| map.keys().collect());
        keys.sort_by_key(|key| self.places.get(&member(item, key)).map(|place| place.key.start));
        keys.into_iter().cloned().collect()
    }

    /// The whole text as a `T`.
    ///
    /// # Errors
    /// [`Error::Invalid`] with every key that is unknown or missing and every value of another kind or out of range.
    pub fn read<T: DeserializeOwned + JsonSchema>(&self) -> Result<T> {
        let schema = schemars::schema_for!(T).to_value();
        if let Some(what) = self.of_other_kind(&schema) {
            return Err(Error::invalid(Location::file(&self.path), what));
        }
        let mut problems = self.problems.clone();
        self.compare(&schema, &schema, &self.tree, "", &mut problems);
        if !problems.is_empty() {
            problems.sort_by_key(|p| p.at.span);
            if problems.len() > TOLD {
                problems.truncate(TOLD);
                problems.push(Problem::new(Location::file(&self.path), "and more problems"));
            }
            return Err(Error::Invalid(problems));
        }
        serde_json::from_value(self.tree.clone()).map_err(|e| Error::invalid(Location::file(&self.path), e.to_string()))
    }

    /// What the text is, if it is of another kind than the schema's by the key that identifies its kind.
    fn of_other_kind(&self, schema: &Value) -> Option<&'static str> {
        let choices = choices(schema, schema);
        let is_of_schema =
            |key: &str| choices.iter().chain([&schema]).any(|schema| schema["properties"].get(key).is_some());
        KINDS.iter().find(|(key, _)| self.has(key)).filter(|(key, _)| !is_of_schema(key)).map(|(_, what)| *what)
    }

    /// Adds what is wrong with a value by its schema; `root` holds the definitions that schemas refer to.
    fn compare(&self, root: &Value, schema: &Value, value: &Value, item: &str, problems: &mut Vec<Problem>) {
        let schema = resolved(root, schema);
        // Reported when the text was read; or enough has been reported.
        if value.is_null() || problems.len() > TOLD {
            return;
        }
        let choices = choices(root, schema);
        if !choices.is_empty() {
            return self.compare_choices(root, &choices, value, item, problems);
        }
        let words = words(schema);
        match value {
            Value::String(found) if !words.is_empty() && !words.contains(&found.as_str()) => {
                problems.push(self.not_a_word(found, &words, item));
            }
            _ if !kind_fits(schema, value) => problems.push(self.other_kind(&described(schema), value, item)),
            Value::Object(map) => self.compare_table(root, schema, map, item, problems),
            Value::Array(elements) => self.compare_list(root, schema, elements, item, problems),
            Value::Number(number) => {
                if let Some(message) = number.as_f64().and_then(|x| out_of_range(schema, x)) {
                    problems.push(Problem::new(self.at(item), message));
                }
            }
            _ => {}
        }
    }

    /// Of schemas that each would do, the one that a value comes nearest to says what is wrong.
    fn compare_choices(
        &self,
        root: &Value,
        choices: &[&Value],
        value: &Value,
        item: &str,
        problems: &mut Vec<Problem>,
    ) {
        let words: Vec<&str> = choices.iter().flat_map(|c| words(c)).collect();
        if let (Value::String(found), false) = (value, words.is_empty())
            && !choices.iter().any(|c| words_free(c))
        {
            if !words.contains(&found.as_str()) {
                problems.push(self.not_a_word(found, &words, item));
            }
            return;
        }
        if let Value::Object(map) = value
            && let Some(tag) = tag(root, choices)
        {
            return self.compare_tagged(root, choices, tag, map, item, problems);
        }
        let outcomes = choices.iter().filter(|choice| kind_fits(choice, value)).map(|choice| {
            let mut found = Vec::new();
            self.compare(root, choice, value, item, &mut found);
            found
        });
        match outcomes.min_by_key(Vec::len) {
            Some(found) => problems.extend(found),
            None => {
                let expected: Vec<String> = choices.iter().map(|c| described(c)).collect();
                problems.push(self.other_kind(&expected.join(" or "), value, item));
            }
        }
    }

    /// Of tables that one key tells apart, the one that its value names.
    fn compare_tagged(
        &self,
        root: &Value,
        choices: &[&Value],
        tag: &str,
        map: &Map<String, Value>,
        item: &str,
        problems: &mut Vec<Problem>,
    ) {
        let constants: Vec<(&Value, &&Value)> =
            choices.iter().filter_map(|choice| Some((constant(root, choice, tag)?, choice))).collect();
        let Some(found) = map.get(tag) else {
            let known: Vec<String> = constants.iter().map(|(c, _)| c.to_string()).collect();
            let problem = Problem::new(self.at(item), format!("`{tag}` is missing"));
            return problems.push(problem.with_help(format!("it is {}", known.join(" or "))));
        };
        if let Some((_, choice)) = constants.iter().find(|(constant, _)| *constant == found) {
            return self.compare_table(root, choice, map, item, problems);
        }
        let member = member(item, tag);
        let words: Vec<&str> = constants.iter().filter_map(|(c, _)| c.as_str()).collect();
        match found {
            Value::String(found) if !words.is_empty() => problems.push(self.not_a_word(found, &words, &member)),
            _ => {
                let known: Vec<String> = constants.iter().map(|(c, _)| c.to_string()).collect();
                problems.push(self.other_kind(&known.join(" or "), found, &member));
            }
        }
    }

    fn compare_list(&self, root: &Value, schema: &Value, elements: &[Value], item: &str, problems: &mut Vec<Problem>) {
        let limit =
            |key: &str| schema.get(key).and_then(Value::as_u64).map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        let (least, most) = (limit("minItems").unwrap_or(0), limit("maxItems").unwrap_or(usize::MAX));
        if !(least..=most).contains(&elements.len()) {
            let expected = match (least, most) {
                _ if least == most => format!("{least}"),
                (_, usize::MAX) => format!("at least {least}"),
                _ => format!("{least} to {most}"),
            };
            let message = format!("expected a list of {expected}, found {}", elements.len());
            problems.push(Problem::new(self.at(item), message));
        }
        if let Some(schema) = schema.get("items") {
            for (i, element) in elements.iter().enumerate() {
                self.compare(root, schema, element, &format!("{item}[{i}]"), problems);
            }
        }
    }

    fn compare_table(
        &self,
        root: &Value,
        schema: &Value,
        map: &Map<String, Value>,
        item: &str,
        problems: &mut Vec<Problem>,
    ) {
        let empty = Map::new();
        let known = schema.get("properties").and_then(Value::as_object).unwrap_or(&empty);
        let others = schema.get("additionalProperties");
        for (key, value) in map {
            if problems.len() > TOLD {
                return;
            }
            let member = member(item, key);
            match (known.get(key), others) {
                (Some(schema), _) => self.compare(root, schema, value, &member, problems),
                (None, Some(Value::Bool(false))) => {
                    let at = match (self.put.get(&member), self.places.get(&member)) {
                        (Some(said), _) => said.clone(),
                        (None, Some(place)) => {
                            let span = Location::span(&self.path, &self.text, place.key.start, place.key.end);
                            span.with_item(&member)
                        }
                        (None, None) => Location::file(&self.path).with_item(&member),
                    };
                    let names: Vec<&str> = known.keys().map(String::as_str).collect();
                    let help = match key_units::meant(key, value, &names) {
                        Some(meant) => meant,
                        None => format!("known here: {}", names.join(", ")),
                    };
                    problems.push(Problem::new(at, format!("unknown key `{key}`")).with_help(help));
                }
                (None, Some(schema)) if schema.is_object() => self.compare(root, schema, value, &member, problems),
                (None, _) => {}
            }
        }
        for key in schema.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str) {
            if !map.contains_key(key) {
                let described = known.get(key).and_then(|s| s.get("description")).and_then(Value::as_str);
                let mut problem = Problem::new(self.at(item), format!("`{key}` is missing"));
                problem.help = described.and_then(|d| d.lines().next()).map(str::to_owned);
                problems.push(problem);
            }
        }
    }

    fn other_kind(&self, expected: &str, found: &Value, item: &str) -> Problem {
        let found = match found {
            Value::String(s) => format!("the string {s:?}"),
            Value::Bool(b) => format!("{b}"),
            Value::Number(n) => format!("{n}"),
            Value::Array(_) => "a list".into(),
            Value::Object(_) => "a table".into(),
            Value::Null => "nothing".into(),
        };
        Problem::new(self.at(item), format!("expected {expected}, found {found}"))
    }

    fn not_a_word(&self, found: &str, words: &[&str], item: &str) -> Problem {
        let known: Vec<String> = words.iter().map(|w| format!("{w:?}")).collect();
        let problem = Problem::new(self.at(item), format!("expected {}, found {found:?}", known.join(" or ")));
        match nearest(found, words) {
            Some(word) => problem.with_help(format!("did you mean {word:?}?")),
            None => problem,
        }
    }
}

/// The name of a table's item.
pub fn member(table: &str, key: &str) -> String {
    let bare = !key.is_empty() && key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
    match (table, bare) {
        ("", true) => key.to_owned(),
        ("", false) => format!("{key:?}"),
        (_, true) => format!("{table}.{key}"),
        (_, false) => format!("{table}.{key:?}"),
    }
}

/// Names of all items in a value.
fn names(of: &str, value: &Value, found: &mut Vec<String>) {
    let mut enter = |name: String, value: &Value| {
        names(&name, value, found);
        found.push(name);
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| enter(member(of, key), value)),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, value)| enter(format!("{of}[{i}]"), value)),
        _ => {}
    }
}

/// The item around an item: `a.b[3]` is in `a.b` is in `a`. A quoted key may hold anything, so cuts within one find nothing.
fn parent(item: &str) -> &str {
    item.rfind(['.', '[']).map_or("", |i| &item[..i])
}

fn resolved<'a>(root: &'a Value, mut schema: &'a Value) -> &'a Value {
    while let Some(target) = schema.get("$ref").and_then(Value::as_str) {
        match target.strip_prefix('#').and_then(|pointer| root.pointer(pointer)) {
            Some(next) => schema = next,
            None => break,
        }
    }
    schema
}

/// What a value may be instead, without `null`, which TOML does not have.
fn choices<'a>(root: &'a Value, schema: &'a Value) -> Vec<&'a Value> {
    let listed = ["anyOf", "oneOf"].iter().filter_map(|key| schema.get(*key)?.as_array()).flatten();
    let mut all = Vec::new();
    for choice in listed.map(|choice| resolved(root, choice)) {
        let inner = choices(root, choice);
        if inner.is_empty() {
            all.push(choice);
        } else {
            all.extend(inner);
        }
    }
    all.retain(|choice| choice.get("type").and_then(Value::as_str) != Some("null"));
    all
}

/// The value that a key of a table must have.
fn constant<'a>(root: &'a Value, schema: &'a Value, key: &str) -> Option<&'a Value> {
    resolved(root, schema.get("properties")?.get(key)?).get("const")
}

/// The key that tells the tables among several schemas apart: in each of them it must have a value of its own.
fn tag<'a>(root: &'a Value, choices: &[&'a Value]) -> Option<&'a str> {
    let tables: Vec<&&Value> = choices.iter().filter(|choice| choice.get("properties").is_some()).collect();
    let keys = tables.first()?.get("properties")?.as_object()?.keys();
    keys.map(String::as_str).find(|key| {
        let constants: Vec<_> = tables.iter().filter_map(|table| constant(root, table, key)).collect();
        constants.len() == tables.len()
            && tables.len() > 1
            && constants.iter().enumerate().all(|(i, c)| !constants[..i].contains(c))
    })
}

/// The strings that a schema allows, if it allows only some.
fn words(schema: &Value) -> Vec<&str> {
    let constant = schema.get("const").into_iter();
    constant
        .chain(schema.get("enum").and_then(Value::as_array).into_iter().flatten())
        .filter_map(Value::as_str)
        .collect()
}

/// Whether a schema allows any string.
fn words_free(schema: &Value) -> bool {
    words(schema).is_empty() && kinds(schema).contains(&"string")
}

fn kinds(schema: &Value) -> Vec<&str> {
    match schema.get("type") {
        Some(Value::String(kind)) => vec![kind],
        Some(Value::Array(kinds)) => kinds.iter().filter_map(Value::as_str).filter(|k| *k != "null").collect(),
        _ => vec![],
    }
}

fn kind_fits(schema: &Value, value: &Value) -> bool {
    let kinds = kinds(schema);
    kinds.is_empty()
        || kinds.iter().any(|kind| match *kind {
            "number" => value.is_number(),
            "integer" => value.is_i64() || value.is_u64(),
            "string" => value.is_string(),
            "boolean" => value.is_boolean(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            _ => false,
        })
}

fn described(schema: &Value) -> String {
    let words = words(schema);
    if !words.is_empty() {
        return words.iter().map(|w| format!("{w:?}")).collect::<Vec<_>>().join(" or ");
    }
    let length = schema.get("minItems").filter(|n| Some(*n) == schema.get("maxItems"));
    let names = kinds(schema).into_iter().map(|kind| match (kind, length) {
        ("number", _) => "a number".into(),
        ("integer", _) => "a whole number".into(),
        ("string", _) => "a string".into(),
        ("boolean", _) => "true or false".into(),
        ("array", Some(n)) => format!("a list of {n}"),
        ("array", None) => "a list".into(),
        (_, _) => "a table".to_owned(),
    });
    names.collect::<Vec<String>>().join(" or ")
}

fn out_of_range(schema: &Value, x: f64) -> Option<String> {
    let shown = number(x);
    let limit = |key: &str| schema.get(key).and_then(Value::as_f64);
    if let Some(least) = limit("minimum").filter(|least| x < *least) {
        return Some(format!("{shown} is less than {least}"));
    }
    if let Some(most) = limit("maximum").filter(|most| x > *most) {
        return Some(format!("{shown} is more than {most}"));
    }
    if schema.get("format").and_then(Value::as_str) == Some("uint32") && x > f64::from(u32::MAX) {
        return Some(format!("{shown} is more than {}", u32::MAX));
    }
    if let Some(bound) = limit("exclusiveMinimum").filter(|bound| x <= *bound) {
        return Some(format!("{shown} is not more than {bound}"));
    }
    limit("exclusiveMaximum").filter(|bound| x >= *bound).map(|bound| format!("{shown} is not less than {bound}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Outer {
        /// Where it is, m.
        position_m: [f64; 3],
        count: Option<u32>,
        inner: BTreeMap<String, Inner>,
    }

    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        value: Either,
        kind: Option<Kind>,
    }

    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(untagged)]
    enum Either {
        Number(f64),
        Text(String),
    }

    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(rename_all = "lowercase")]
    enum Kind {
        /// One.
        Hold,
        /// The other.
        Error,
    }

    fn read(text: &str) -> Result<Outer> {
        Document::parse(text.to_owned(), Path::new("a.toml"))?.read()
    }

    #[test]
    fn what_is_told_is_bounded() {
        let list = format!("position_m = [{}]\n", "nan,".repeat(300_000));
        for text in [list.clone(), list.replace("nan", "''")] {
            let document = Document::parse(text, Path::new("a.toml")).unwrap();
            let told = document.read::<Outer>().unwrap_err().to_string();
            assert_eq!(told.lines().count(), TOLD + 1);
            assert!(told.ends_with("a.toml: and more problems"), "{told}");
        }
        let name = "n".repeat(LONGEST_NAME + 1);
        let document = Document::parse(format!("{name} = {{ a = 1 }}"), Path::new("a.toml")).unwrap();
        assert!(!document.has(&name));
        let told = document.read::<Outer>().unwrap_err().to_string();
        assert!(told.contains("a.toml:1:1: a name of 401 bytes"), "{told}");
    }

    #[test]
    fn good_text_is_read() {
        let outer = read("position_m = [1, 2.5, 0x10]\n[inner.\"b c\"]\nvalue = \"x\"\nkind = \"hold\"\n").unwrap();
        assert_eq!(outer.position_m, [1.0, 2.5, 16.0]);
        assert_eq!(outer.inner["b c"], Inner { value: Either::Text("x".into()), kind: Some(Kind::Hold) });
    }

    #[test]
    fn all_problems_are_told_at_their_places() {
        let text = "position_m = [1, nan]\ncount = -3\npositon_m = 1\n[inner.a]\nvalue = true\nkind = \"hodl\"\n[inner.\"b c\"]\nzzz = 1979-05-27\n";
        let told = read(text).unwrap_err().to_string();
        let expected = [
            "a.toml:1:14 position_m: expected a list of 3, found 2",
            "a.toml:1:18 position_m[1]: nan is not a finite number",
            "a.toml:2:9 count: -3 is less than 0",
            "a.toml:3:1 positon_m: unknown key `positon_m` (help: did you mean `position_m`?)",
            "a.toml:5:9 inner.a.value: expected a number or a string, found true",
            "a.toml:6:8 inner.a.kind: expected \"hold\" or \"error\", found \"hodl\" (help: did you mean \"hold\"?)",
            "a.toml:7:1 inner.\"b c\": `value` is missing",
            "a.toml:8:1 inner.\"b c\".zzz: unknown key `zzz` (help: known here: kind, value)",
            "a.toml:8:7 inner.\"b c\".zzz: 1979-05-27 is a date",
        ];
        assert_eq!(told.lines().count(), expected.len(), "{told}");
        for (line, expected) in told.lines().zip(expected) {
            assert!(line.starts_with(expected), "{line}\n{expected}");
        }
    }

    #[test]
    fn a_missing_key_is_described() {
        assert!(read("[inner]\n").unwrap_err().to_string().contains("`position_m` is missing (help: Where it is, m.)"));
    }

    #[test]
    fn the_first_syntax_error_is_told() {
        let error = read("a = 1\nb = [1,\nc = \n").unwrap_err();
        assert!(matches!(error, Error::Syntax { .. }));
        assert!(error.to_string().starts_with("a.toml:3:"), "{error}");
    }

    #[test]
    fn keys_keep_their_order_and_items_their_places() {
        let document = Document::parse("[m]\nz = 1\n\"a.b\" = {c = 2}\n".into(), Path::new("a.toml")).unwrap();
        assert_eq!(document.keys("m"), ["z", "a.b"]);
        assert_eq!(document.at("m.\"a.b\".c").to_string(), "a.toml:3:14 m.\"a.b\".c");
        assert_eq!(document.at("m.\"a.b\".d").to_string(), "a.toml:3:9 m.\"a.b\".d");
        assert_eq!(document.at("q").to_string(), "a.toml q");
    }
}
