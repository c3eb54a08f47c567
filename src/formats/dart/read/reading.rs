//! The tools for reading inputs: typed values of attributes, and a record of what is wrong or lost.

use std::collections::BTreeSet;
use std::str::FromStr;

use crate::error::{Location, Problem};
use crate::formats::input::{InputFile, Problems};
use crate::formats::xml::Element;
use crate::report::{Fate, Report};

use super::super::Links;
use super::super::folder::Folder;
use super::super::mandatory::{self, Missing, MissingKind};
use super::{Inputs, ReadOptions, carried};

/// The state of reading one simulation. An unusable value is recorded as a problem, and reading continues with a stand-in.
pub(super) struct Reading<'a> {
    pub(super) folder: &'a Folder,
    pub(super) options: &'a ReadOptions,
    pub(super) problems: Problems,
    pub(super) report: Report,
    pub(super) inputs: Vec<InputFile>,
    /// Attributes whose default has been reported: once for all elements of a path.
    defaulted: BTreeSet<String>,
}

impl<'a> Reading<'a> {
    pub(super) fn new(folder: &'a Folder, options: &'a ReadOptions) -> Self {
        Reading {
            folder,
            options,
            problems: Problems::default(),
            report: Report::default(),
            inputs: Vec::new(),
            defaulted: BTreeSet::new(),
        }
    }

    pub(super) fn problem(&mut self, at: Location, message: impl Into<String>) {
        self.problems.push(|| Problem::new(at, message));
    }

    pub(super) fn note(&mut self, fate: Fate, at: Location, message: impl Into<String>) {
        self.report.note(fate, at, message);
    }

    /// An element within that must be there.
    pub(super) fn child<'e>(&mut self, element: &'e Element, name: &str) -> Option<&'e Element> {
        let child = element.child(name);
        if child.is_none() {
            self.problem(element.at(), format!("has no `<{name}>` within"));
        }
        child
    }

    /// An attribute that must be there.
    pub(super) fn text(&mut self, element: &Element, name: &str) -> String {
        match element.get(name) {
            Some(value) => value.to_owned(),
            None => {
                self.problem(element.at(), format!("has no attribute `{name}`"));
                String::new()
            }
        }
    }

    /// A finite number that must be there.
    pub(super) fn number(&mut self, element: &Element, name: &str) -> f64 {
        if element.get(name).is_none() {
            self.problem(element.at(), format!("has no attribute `{name}`"));
            return 0.0;
        }
        self.number_or(element, name, 0.0)
    }

    /// A finite number above 0 that must be there.
    pub(super) fn positive(&mut self, element: &Element, name: &str) -> f64 {
        let value = self.number(element, name);
        if value <= 0.0 && element.get(name).is_some_and(|text| number(text).is_some()) {
            self.problem(element.at_attribute(name), format!("`{name}` is {value}: a number above 0 belongs here"));
        }
        value
    }

    /// A finite number, or DART's default where there is none.
    pub(super) fn number_or(&mut self, element: &Element, name: &str, default: f64) -> f64 {
        self.value_or(element, name, default, "a finite number", number)
    }

    /// A code or a count, or DART's default where there is none.
    pub(super) fn integer_or(&mut self, element: &Element, name: &str, default: u32) -> u32 {
        self.value_or(element, name, default, "a whole number, not negative,", integer)
    }

    /// A code or a count that must be there.
    pub(super) fn integer(&mut self, element: &Element, name: &str) -> u32 {
        if element.get(name).is_none() {
            self.problem(element.at(), format!("has no attribute `{name}`"));
            return 0;
        }
        self.integer_or(element, name, 0)
    }

    /// A code from 0 to `last`, or DART's default where there is none.
    pub(super) fn code(&mut self, element: &Element, name: &str, default: u32, last: u32) -> u32 {
        let code = self.integer_or(element, name, default);
        if code > last {
            let message = format!("`{name}` is {code}: known are 0 to {last}");
            self.problem(element.at_attribute(name), message);
        }
        code.min(last)
    }

    /// The optical and thermal link in an element, wrapped or not; the thermal one from `thermal` if that is given.
    ///
    /// `None` if there is no optical link.
    pub(super) fn links(&mut self, element: &Element, thermal: Option<&Element>) -> Option<Links> {
        let optical = wrapped(element, "SurfaceOpticalProperties", "OpticalPropertyLink")?;
        let thermal = wrapped(thermal.unwrap_or(element), "SurfaceExitanceProperties", "ThermalPropertyLink");
        Some(self.pair(optical, thermal))
    }

    /// What an optical and a thermal link say.
    pub(super) fn pair(&mut self, optical: &Element, thermal: Option<&Element>) -> Links {
        Links {
            kind: self.integer_or(optical, "type", 0),
            index: self.integer(optical, "indexFctPhase"),
            ident: optical.get("ident").unwrap_or_default().to_owned(),
            thermal_index: thermal.map_or(0, |t| self.integer(t, "indexTemperature")),
            thermal_ident: thermal.and_then(|t| t.get("idTemperature")).unwrap_or_default().to_owned(),
            at: optical.at(),
        }
    }

    /// 1 or 0, and 0 where there is nothing: versions differ in the switches they have.
    pub(super) fn flag(&mut self, element: &Element, name: &str) -> bool {
        match element.get(name).map(str::trim) {
            None | Some("0") => false,
            Some("1") => true,
            Some(other) => {
                let message = format!("`{name}` is `{other}`: 0 or 1 belongs here");
                self.problem(element.at_attribute(name), message);
                false
            }
        }
    }

    /// Reports missing attributes that DART requires and that would be carried, unless already reported.
    pub(super) fn missing(&mut self, inputs: &Inputs) {
        for Missing { path, at, kind } in mandatory::missing(inputs) {
            let MissingKind::Attribute { name, places } = kind else { continue };
            let element = path.rsplit('/').nth(1).unwrap_or_default();
            if self.defaulted.contains(&path) || !carried::is_carried(element, name) {
                continue;
            }
            let where_ = if places > 1 { format!(" (in {places} places)") } else { String::new() };
            let message = format!("has no attribute `{name}`, which this version of DART wants{where_}");
            self.note(Fate::Defaulted, at, message);
        }
    }

    fn value_or<T: std::fmt::Display>(
        &mut self,
        element: &Element,
        name: &str,
        default: T,
        what: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> T {
        match element.get(name) {
            None => {
                if self.defaulted.insert(format!("{}/@{name}", element.path())) {
                    let message = format!("has no attribute `{name}`: taken is DART's default, {default}");
                    self.note(Fate::Defaulted, element.at(), message);
                }
                default
            }
            Some(text) => read(text).unwrap_or_else(|| {
                let message = format!("`{name}` is `{text}`: {what} belongs here");
                self.problem(element.at_attribute(name), message);
                default
            }),
        }
    }
}

/// An element within, or within a wrapper that it has from 5.10 on.
pub(super) fn wrapped<'e>(element: &'e Element, wrapper: &str, name: &str) -> Option<&'e Element> {
    element.child(name).or_else(|| element.child(wrapper)?.child(name))
}

/// A whole number from 0 on; old versions write some as `101.0`.
fn integer(text: &str) -> Option<u32> {
    u32::from_str(text.trim().trim_end_matches('0').strip_suffix('.').unwrap_or(text.trim())).ok()
}

/// A finite number as Java writes it: `1.0`, `1E-7`, `.5`, `4`.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|x| x.is_finite())
}
