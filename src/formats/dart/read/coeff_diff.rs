//! coeff_diff.xml: lists of optical properties, and temperatures.

use crate::formats::xml::Element;
use crate::report::Fate;

use super::super::{OpticalKind, OpticalProperty, ThermalFunction};
use super::reading::{Reading, number};

/// More factors, those of all properties in all bands, are refused: one element can stand for those of every band.
const SETS: usize = 1 << 20;
/// The elements of the lists, in the order of the file.
const LISTS: [(OpticalKind, &str, &str); 3] = [
    (OpticalKind::Lambertian, "LambertianMultiFunctions", "LambertianMulti"),
    (OpticalKind::Hapke, "HapkeSpecularMultiFunctions", "HapkeSpecularMulti"),
    (OpticalKind::Rpv, "RPVMultiFunctions", "RPVMulti"),
];

pub(super) fn optical(coeff_diff: &Element, bands: usize, reading: &mut Reading) -> Vec<OpticalProperty> {
    let (mut properties, mut sets) = (Vec::new(), 0);
    for (kind, list, entry) in LISTS {
        // From 5.10 lists are wrapped in `Surfaces`.
        for element in coeff_diff.descendant(list).iter().flat_map(|l| l.all(entry)) {
            // Before 5.7 a property is a text, with one table.
            let text = || holder(element, "fileName")?.get("fileName").filter(|name| !name.trim().is_empty());
            let named = table(element, "databaseName", "ModelName");
            let named = named.or_else(|| Some((text()?.to_owned(), String::new())));
            if named.is_none() {
                reading.note(Fate::Dropped, element.at(), "an optical property that is not a table of a database");
            }
            let (database, model) = named.unwrap_or_default();
            let transmittance = match kind {
                OpticalKind::Lambertian => None,
                _ => table(element, "transmittanceDatabaseName", "transmittanceModelName"),
            };
            if kind != OpticalKind::Lambertian && transmittance.is_none() {
                reading.note(Fate::Defaulted, element.at(), "names no table of transmittance: none is taken");
            }
            let factors = factors(element, bands, reading);
            // Old versions have one set for all bands.
            if factors.len() > 1 && factors.len() != bands {
                let what = match factors.len() < bands {
                    true => "bands without one are taken to have the last one's",
                    false => "those beyond are of no band",
                };
                let message = format!("{} sets of factors for {bands} bands: {what}", factors.len());
                reading.note(Fate::Approximated, element.at(), message);
            }
            sets += factors.len();
            if sets > SETS {
                let message = format!("with this property there are factors for more than {SETS} bands in all");
                reading.problem(element.at(), message);
                return properties;
            }
            properties.push(OpticalProperty {
                kind,
                ident: reading.text(element, "ident"),
                database,
                model,
                transmittance,
                factors,
                at: element.at(),
            });
        }
    }
    properties
}

/// The element that has an attribute: a property, or, from 5.10 on, one within that wraps its model.
fn holder<'e>(property: &'e Element, attribute: &str) -> Option<&'e Element> {
    std::iter::once(property).chain(&property.children).find(|e| e.get(attribute).is_some())
}

/// A database and a table in it.
fn table(property: &Element, database: &str, model: &str) -> Option<(String, String)> {
    let [database, model] = [database, model].map(|name| holder(property, name)?.get(name).map(str::to_owned));
    Some((database?, model?))
}

/// Whether multiplicative factors are used.
pub(in crate::formats::dart) fn uses_factors(property: &Element) -> bool {
    const SWITCH: &str = "useMultiplicativeFactorForLUT";
    holder(property, SWITCH).and_then(|e| e.get(SWITCH)).is_some_and(|used| used.trim() == "1")
}

/// The element of multiplicative factors of an optical property, if they are used.
pub(in crate::formats::dart) fn factor_node(property: &Element) -> Option<&Element> {
    let is_node = |e: &&Element| e.name.to_ascii_lowercase().ends_with("nodemultiplicativefactorforlut");
    let within = property.children.iter().chain(property.children.iter().flat_map(|c| &c.children));
    within.filter(|_| uses_factors(property)).find(is_node)
}

/// The factors in each band: elements within a node.
pub(in crate::formats::dart) fn factors_of_bands(node: &Element) -> impl Iterator<Item = &Element> {
    node.children.iter().filter(|e| e.name.to_ascii_lowercase().ends_with("multiplicativefactorforlut"))
}

fn factors(property: &Element, bands: usize, reading: &mut Reading) -> Vec<Vec<(String, f64)>> {
    let Some(node) = factor_node(property) else { return Vec::new() };
    if reading.flag(node, "useSameFactorForAllBands") {
        return vec![factors_at(node, reading); bands];
    }
    factors_of_bands(node).map(|band| factors_at(band, reading)).collect()
}

fn factors_at(element: &Element, reading: &mut Reading) -> Vec<(String, f64)> {
    let mut factors = Vec::new();
    // What is not a factor: switches, and how quickly transmittance acts.
    let is_factor = |name: &str| !name.starts_with("use") && name != "diffuseTransmittanceAcceleration";
    for attribute in element.attributes.iter().filter(|a| is_factor(&a.name)) {
        match number(&attribute.value) {
            Some(value) => factors.push((attribute.name.clone(), value)),
            None => {
                let message =
                    format!("the factor `{}` is `{}`: a finite number belongs here", attribute.name, attribute.value);
                reading.problem(element.at_attribute(&attribute.name), message);
            }
        }
    }
    factors.sort_by(|a, b| a.0.cmp(&b.0));
    factors
}

pub(super) fn thermal(coeff_diff: &Element, reading: &mut Reading) -> Vec<ThermalFunction> {
    let Some(list) = coeff_diff.descendant("Temperatures") else {
        reading.problem(coeff_diff.at(), "has no `<Temperatures>` within");
        return Vec::new();
    };
    let mut functions = Vec::new();
    for element in list.all("ThermalFunction") {
        let [mean_k, range_k] = ["meanT", "deltaT"].map(|name| reading.number(element, name));
        if mean_k < 0.0 || range_k < 0.0 || range_k > 2.0 * mean_k {
            let message = format!("temperatures of {mean_k} K +- {range_k} / 2 K: they must not be below 0");
            reading.problem(element.at(), message);
        }
        functions.push(ThermalFunction {
            ident: reading.text(element, "idTemperature"),
            mean_k,
            range_k,
            overrides_cells: reading.flag(element, "override3DMatrix"),
            at: element.at(),
        });
    }
    functions
}
