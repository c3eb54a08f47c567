//! What two simulations' inputs differ in where they are not read: how DART computes, and features that mmxrt has no counterpart for.

use std::collections::BTreeMap;

use crate::formats::xml::Element;

use super::losses::{KNOWN, LISTED};
use super::reading::number;
use super::{FILES, Inputs};

/// What only names and colours things.
const LABELS: [&str; 3] = ["Types", "ObjectTypeProperties", "GroupTypeProperties"];
/// Attributes of elements that are read, which themselves are not.
const ATTRIBUTES: [(&str, &[&str]); 4] = [
    ("Maket", &["dartZone", "useRandomGenerationSeed", "hideRB"]),
    ("Directions", &["numberOfPropagationDirections", "ifCosWeighted"]),
    ("Phase", &["calculatorMethod", "accelerationEngine", "expertMode"]),
    ("CellDimensions", &["roundToExact"]),
];

/// One line for each attribute that is not alike. Entries of lists are passed over: their order may differ, and what is not read of them
/// is told when they are.
pub(in crate::formats::dart) fn differences(a: &Inputs, b: &Inputs) -> Vec<String> {
    let known: BTreeMap<&str, &str> = KNOWN.iter().copied().collect();
    let mut lines = Vec::new();
    for (file, section, _) in FILES {
        let mut of_file = Vec::new();
        match (a.section(section), b.section(section)) {
            (Some(a), Some(b)) => elements(a, b, &known, false, &mut of_file),
            (None, None) => {}
            (a, _) => of_file.push(if a.is_some() { "is there | is not".into() } else { "is not | is there".into() }),
        }
        lines.extend(of_file.into_iter().map(|line: String| format!("{file} {line}")));
    }
    lines
}

/// `all`: nothing below is read.
fn elements(a: &Element, b: &Element, known: &BTreeMap<&str, &str>, all: bool, lines: &mut Vec<String>) {
    let name = a.name.as_str();
    let all = all || known.get(name).is_none_or(|attributes| *attributes == "*");
    let of_element = ATTRIBUTES.iter().find(|(element, _)| *element == name).map_or(&[][..], |(_, names)| names);
    let mut names: Vec<&str> =
        a.attributes.iter().chain(&b.attributes).map(|attribute| attribute.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    for attribute in names.into_iter().filter(|attribute| all || of_element.contains(attribute)) {
        let (of_a, of_b) = (a.get(attribute), b.get(attribute));
        let is_same = match (of_a, of_b) {
            (Some(a), Some(b)) => a.trim() == b.trim() || number(a).is_some_and(|a| number(b) == Some(a)),
            _ => false,
        };
        if !is_same {
            let shown = |value: Option<&str>| value.unwrap_or("none").to_owned();
            lines.push(format!("{}/@{attribute}: {} | {}", a.path(), shown(of_a), shown(of_b)));
        }
    }
    let mut children: BTreeMap<&str, [Vec<&Element>; 2]> = BTreeMap::new();
    for (k, element) in [a, b].into_iter().enumerate() {
        element.children.iter().for_each(|child| children.entry(&child.name).or_default()[k].push(child));
    }
    let is_looked_at = |name: &str| (all || !LISTED.contains(&name)) && !LABELS.contains(&name);
    for (child, [of_a, of_b]) in children.into_iter().filter(|(name, _)| is_looked_at(name)) {
        let is_unread = all || known.get(child).is_none_or(|attributes| *attributes == "*");
        if of_a.len() != of_b.len() && is_unread {
            lines.push(format!("{}/{child}: {} of them | {}", a.path(), of_a.len(), of_b.len()));
        }
        of_a.into_iter().zip(of_b).for_each(|(a, b)| elements(a, b, known, all, lines));
    }
}
