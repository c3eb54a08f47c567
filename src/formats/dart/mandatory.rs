//! Which elements and attributes DART 5.7.4 wants in its input files: of no other version are they known as well.

use std::sync::LazyLock;

use crate::error::Location;
use crate::formats::xml::Element;

use super::read::{FILES, Inputs};

/// The only version of which it is known.
const VERSION: &str = "5.7.4";
const TABLE: &str = include_str!("elements_5_7_4.txt");
static WANTED: LazyLock<Vec<Wanted>> = LazyLock::new(|| table(TABLE));

/// What is wanted and not there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Missing {
    /// Names from the section on, as in "Maket/Scene/CellDimensions" or "Maket/Scene/CellDimensions/@x".
    pub(super) path: String,
    /// The element around it; the first of several.
    pub(super) at: Location,
    pub(super) kind: MissingKind,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum MissingKind {
    /// An element, how many are there and how many are wanted.
    Element { found: usize, least: usize },
    /// An attribute, and in how many elements it is missing.
    Attribute { name: &'static str, places: usize },
}

/// An element, and those wanted in it.
#[derive(Debug, Clone)]
struct Wanted {
    name: &'static str,
    least: usize,
    /// Any of these, of which all terms hold; always, if there are none.
    condition: Vec<Vec<Term>>,
    /// Path of the element whose children are meant.
    like: Option<&'static str>,
    attributes: Vec<&'static str>,
    children: Vec<Wanted>,
}

/// What an attribute is to be.
#[derive(Debug, Clone)]
struct Term {
    /// Elements up: 1 is the one around.
    up: usize,
    /// Elements down from there.
    down: Vec<&'static str>,
    attribute: &'static str,
    is: bool,
    value: &'static str,
}

/// What is wanted and missing, file by file, in those of the version that is known.
pub(super) fn missing(inputs: &Inputs) -> Vec<Missing> {
    let mut missing = Vec::new();
    let is_known = |section: &str| inputs.root(section).is_some_and(|root| root.get("version") == Some(VERSION));
    for (_, section, _) in FILES.iter().filter(|(_, section, _)| is_known(section)) {
        let wanted = WANTED.iter().find(|wanted| wanted.name == *section);
        if let (Some(wanted), Some(element)) = (wanted, inputs.section(section)) {
            look(wanted, &mut vec![element], section, true, &mut missing);
        }
    }
    missing
}

/// `around`: the element, below those around it, from the section on. `is_used`: whether DART wants it there.
fn look(wanted: &Wanted, around: &mut Vec<&Element>, path: &str, is_used: bool, missing: &mut Vec<Missing>) {
    let Some(&element) = around.last() else { return };
    for &name in wanted.attributes.iter().filter(|name| is_used && element.get(name).is_none()) {
        let path = format!("{path}/@{name}");
        match missing.iter_mut().find(|before| before.path == path).map(|before| &mut before.kind) {
            Some(MissingKind::Attribute { places, .. }) => *places += 1,
            _ => missing.push(Missing { path, at: element.at(), kind: MissingKind::Attribute { name, places: 1 } }),
        }
    }
    let children = wanted.like.and_then(find).map_or(&wanted.children, |like| &like.children);
    for child in children {
        let path = format!("{path}/{}", child.name);
        let found = element.all(child.name).count();
        let holds = |terms: &Vec<Term>| terms.iter().all(|term| term.holds(around));
        let is_wanted = child.condition.is_empty() || child.condition.iter().any(holds);
        if found < child.least && is_wanted {
            let kind = MissingKind::Element { found, least: child.least };
            missing.push(Missing { path: path.clone(), at: element.at(), kind });
        }
        for within in element.all(child.name) {
            around.push(within);
            look(child, around, &path, is_used && is_wanted, missing);
            around.pop();
        }
    }
}

/// What is wanted at a path from a section on.
fn find(path: &str) -> Option<&'static Wanted> {
    let (mut level, mut found) = (WANTED.as_slice(), None);
    for name in path.split('/') {
        let wanted = level.iter().find(|wanted| wanted.name == name)?;
        (level, found) = (&wanted.children, Some(wanted));
    }
    found
}

impl Term {
    /// Whether it holds in the element that is the last of these; not where there is no such attribute, of which nothing is known.
    fn holds(&self, around: &[&Element]) -> bool {
        let from = around.len().checked_sub(self.up).map(|i| around[i]);
        let element = self.down.iter().try_fold(from, |element, name| Some(element?.child(name)));
        let value = element.flatten().and_then(|element| element.get(self.attribute));
        value.is_some_and(|value| (value.trim() == self.value) == self.is)
    }
}

/// The table's lines as a tree: two blanks a level.
fn table(text: &'static str) -> Vec<Wanted> {
    let lines =
        text.lines().filter(|line| !line.starts_with('#') && !line.ends_with(".xml") && !line.trim().is_empty());
    let mut open: Vec<Wanted> = Vec::new();
    let mut sections = Vec::new();
    let close = |open: &mut Vec<Wanted>, depth: usize, sections: &mut Vec<Wanted>| {
        while open.len() > depth {
            let Some(done) = open.pop() else { return };
            match open.last_mut() {
                Some(around) => around.children.push(done),
                None => sections.push(done),
            }
        }
    };
    for line in lines {
        let depth = (line.len() - line.trim_start().len()) / 2;
        close(&mut open, depth, &mut sections);
        open.push(wanted(line.trim()));
    }
    close(&mut open, 0, &mut sections);
    sections
}

/// A line of the table.
fn wanted(line: &'static str) -> Wanted {
    let (line, attributes) = line.split_once(" : ").unwrap_or((line, ""));
    let (line, like) = line.split_once(" as ").map_or((line, None), |(line, like)| (line, Some(like)));
    let (line, condition) = line.split_once(" if ").unwrap_or((line, ""));
    let (name, least) = line.split_once(" x").unwrap_or((line, "1"));
    let terms = |all: &'static str| all.split(" & ").filter_map(term).collect::<Vec<Term>>();
    let condition = condition.split(" | ").map(terms).filter(|terms| !terms.is_empty()).collect();
    let attributes = attributes.split_whitespace().collect();
    Wanted { name, least: least.parse().unwrap_or(1), condition, like, attributes, children: Vec::new() }
}

/// `^^a.b=1`, or with `!=`.
fn term(text: &'static str) -> Option<Term> {
    let (left, value) = text.split_once('=')?;
    let (left, is) = left.strip_suffix('!').map_or((left, true), |left| (left, false));
    let path = left.trim_start_matches('^');
    let mut down: Vec<&str> = path.split('.').collect();
    Some(Term { up: left.len() - path.len(), attribute: down.pop()?, down, is, value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_read_to_its_end() {
        let count = |wanted: &Wanted| {
            fn below(wanted: &Wanted) -> usize {
                1 + wanted.children.iter().map(below).sum::<usize>()
            }
            below(wanted)
        };
        assert_eq!(WANTED.len(), FILES.len());
        let lines = TABLE.lines().filter(|line| !line.starts_with('#') && !line.ends_with(".xml")).count();
        assert_eq!(WANTED.iter().map(count).sum::<usize>(), lines);
        let conditions = TABLE.matches(" if ").count();
        let with = |wanted: &Wanted| {
            fn below(wanted: &Wanted) -> usize {
                usize::from(!wanted.condition.is_empty()) + wanted.children.iter().map(below).sum::<usize>()
            }
            below(wanted)
        };
        // One stands in the table's heading, in quotes.
        assert_eq!(WANTED.iter().map(with).sum::<usize>(), conditions);
        assert!(FILES.iter().all(|(_, section, _)| find(section).is_some()));
        assert_eq!(find("Maket/Scene/CellDimensions").unwrap().attributes, ["x", "z"]);
        assert_eq!(find("Maket/Scene/DartZoneProperties/Point2D").unwrap().attributes, ["x", "y"]);
        assert!(find("object_3d/ObjectFields/Field/ModelList/Object").is_some_and(|o| o.like.and_then(find).is_some()));
        let plane = find("Maket/Soil/Topography").unwrap();
        let Term { up, down, attribute, is, value } = &plane.condition[0][0];
        assert_eq!((*up, &down[..], *attribute, *is, *value), (1, &["OpticalPropertyLink"][..], "type", false, "3"));
    }
}
