//! What two simulations' inputs differ in where they are not read: how DART computes, and features that mmxrt has no counterpart for.
//!
//! Whatever [`CARRIED`] does not name is compared as it is written.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::xml::Element;

use super::super::simulation::Simulation;
use super::carried::{CARRIED, FACTORS, KEYS, is_factor, is_factors};
use super::losses::{KNOWN, LISTED};
use super::reading::number;
use super::{FILES, Inputs};

/// What only names and colours things: elements with all they hold, ...
const LABELS: [&str; 3] = ["Types", "ObjectTypeProperties", "GroupTypeProperties"];
/// ... and attributes.
const NAMES: [&str; 10] = [
    "ident",
    "idTemperature",
    "name",
    "num",
    "customImageName",
    "sensorName",
    "objectColor",
    "isDisplayed",
    "showObjectPositions",
    "fieldDescriptionFileName",
];
/// Numbers of one meaning that were computed along two ways differ by less: relative, and lengths, angles and temperatures in their unit.
pub(in crate::formats::dart) const ROUNDING: f64 = 1e-12;

/// One line for each attribute that is not alike.
pub(in crate::formats::dart) fn differences(
    (a, of_a): (&Inputs, &Simulation),
    (b, of_b): (&Inputs, &Simulation),
) -> Vec<String> {
    let cameras = |of: &Simulation| of.phase.cameras.iter().map(|camera| camera.at.to_string()).collect();
    let mut compared = Compared {
        known: KNOWN.iter().copied().collect(),
        carried: CARRIED.iter().copied().collect(),
        cameras: [cameras(of_a), cameras(of_b)],
        lines: Vec::new(),
    };
    let mut lines = Vec::new();
    for (file, section, _) in FILES {
        match (a.root(section), b.root(section)) {
            (Some(a), Some(b)) => compared.children(a, b, false),
            (None, None) => {}
            (a, _) => {
                compared.lines.push(if a.is_some() { "is there | is not".into() } else { "is not | is there".into() })
            }
        }
        lines.extend(compared.lines.drain(..).map(|line| format!("{file} {line}")));
    }
    lines
}

struct Compared<'a> {
    known: BTreeMap<&'a str, &'a str>,
    carried: BTreeMap<&'a str, &'a str>,
    /// Where the cameras stand that are read.
    cameras: [BTreeSet<String>; 2],
    lines: Vec<String>,
}

impl Compared<'_> {
    /// `all`: nothing below is read.
    fn elements(&mut self, a: &Element, b: &Element, all: bool) {
        let name = a.name.as_str();
        let carried = self.carried.get(name).copied().or_else(|| is_factors(name).then_some(FACTORS));
        let all = all || carried.is_none() && self.known.get(name).is_none_or(|attributes| *attributes == "*");
        let names: BTreeSet<&str> =
            a.attributes.iter().chain(&b.attributes).map(|attribute| attribute.name.as_str()).collect();
        for attribute in names.into_iter().filter(|attribute| !NAMES.contains(attribute)) {
            let is_carried = carried.filter(|_| !all).is_some_and(|names| {
                names.split_whitespace().any(|name| name == attribute) || names == FACTORS && is_factor(attribute)
            });
            let (of_a, of_b) = (a.get(attribute), b.get(attribute));
            let is_same = match (of_a, of_b) {
                (Some(a), Some(b)) => {
                    is_carried
                        || a.trim() == b.trim()
                        || number(a).zip(number(b)).is_some_and(|(a, b)| is_rounding(a, b))
                }
                // From 5.11 elements have empty attributes that link them to others.
                (Some(value), None) | (None, Some(value)) => attribute.starts_with("link") && value.is_empty(),
                (None, None) => true,
            };
            if !is_same {
                let shown = |value: Option<&str>| value.unwrap_or("none").to_owned();
                let what = if is_carried { "" } else { NOT_READ };
                self.lines.push(format!("{}/@{attribute}: {} | {}{what}", a.path(), shown(of_a), shown(of_b)));
            }
        }
        self.children(a, b, all);
    }

    fn children(&mut self, a: &Element, b: &Element, all: bool) {
        let mut children: BTreeMap<&str, [Vec<&Element>; 2]> = BTreeMap::new();
        for (k, element) in [a, b].into_iter().enumerate() {
            element.children.iter().for_each(|child| children.entry(&child.name).or_default()[k].push(child));
        }
        let is_camera = a.name == "SensorImageSimulation";
        for (name, [of_a, of_b]) in children.into_iter().filter(|(name, _)| !LABELS.contains(name)) {
            let is_unread = self.known.get(name).is_none_or(|attributes| *attributes == "*");
            // The numbers of what is read are compared with it.
            if of_a.len() != of_b.len() && (all || is_unread || !LISTED.contains(&name)) {
                self.lines.push(format!("{}/{name}: {} of them | {}{NOT_READ}", a.path(), of_a.len(), of_b.len()));
            }
            for (a, b) in pairs(of_a, of_b) {
                let is_read = |k: usize, camera: &Element| self.cameras[k].contains(&camera.at().to_string());
                let is_passed_over = is_camera && !(is_read(0, a) && is_read(1, b));
                self.elements(a, b, all || is_passed_over);
            }
        }
    }
}

const NOT_READ: &str = " (not read here)";

/// Entries that belong together: by what tells them apart, if that is the same on both sides; else as they stand.
fn pairs<'e>(a: Vec<&'e Element>, mut b: Vec<&'e Element>) -> Vec<(&'e Element, &'e Element)> {
    for key in KEYS {
        let places = |list: &[&'e Element]| -> BTreeMap<&'e str, usize> {
            list.iter().enumerate().filter_map(|(i, e)| Some((e.get(key)?, i))).collect()
        };
        let (of_a, of_b) = (places(&a), places(&b));
        if of_a.len() == a.len() && of_b.len() == b.len() && of_a.keys().eq(of_b.keys()) {
            b.sort_by_key(|e| e.get(key).and_then(|name| of_a.get(name)));
        }
    }
    a.into_iter().zip(b).collect()
}

fn is_rounding(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * a.abs().max(b.abs())
}
