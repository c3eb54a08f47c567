//! coeff_diff.xml: lists of optical properties, and temperatures.

use crate::formats::xml::Element;

use super::super::{OpticalKind, OpticalProperty, ThermalFunction};
use super::reading::{Reading, number};

/// The elements of the lists, in the order of the file.
const LISTS: [(OpticalKind, &str, &str); 3] = [
    (OpticalKind::Lambertian, "LambertianMultiFunctions", "LambertianMulti"),
    (OpticalKind::Hapke, "HapkeSpecularMultiFunctions", "HapkeSpecularMulti"),
    (OpticalKind::Rpv, "RPVMultiFunctions", "RPVMulti"),
];

pub(super) fn optical(coeff_diff: &Element, bands: usize, reading: &mut Reading) -> Vec<OpticalProperty> {
    let mut properties = Vec::new();
    for (kind, list, entry) in LISTS {
        // From 5.10 lists are wrapped in `Surfaces`.
        for element in coeff_diff.descendant(list).iter().flat_map(|l| l.all(entry)) {
            // From 5.10 database and table are wrapped in an element of their own.
            let model = element.child("Lambertian").unwrap_or(element);
            let transmittance = (kind != OpticalKind::Lambertian).then(|| {
                let [database, table] = ["transmittanceDatabaseName", "transmittanceModelName"];
                (reading.text(element, database), reading.text(element, table))
            });
            properties.push(OpticalProperty {
                kind,
                ident: reading.text(element, "ident"),
                database: reading.text(model, "databaseName"),
                model: reading.text(model, "ModelName"),
                transmittance,
                factors: factors(element, bands, reading),
                at: element.at(),
            });
        }
    }
    properties
}

/// The element of multiplicative factors of an optical property, if they are used.
pub(in crate::formats::dart) fn factor_node(property: &Element) -> Option<&Element> {
    let used = |e: &Element| e.get("useMultiplicativeFactorForLUT").is_some_and(|u| u.trim() == "1");
    let wrapped = property.child("Lambertian").filter(|model| used(model));
    let holder = if used(property) { property } else { wrapped? };
    let is_node = |e: &&Element| e.name.ends_with("NodeMultiplicativeFactorForLUT");
    holder.children.iter().find(is_node).or_else(|| property.children.iter().find(is_node))
}

/// The factors in each band: elements within a node.
pub(in crate::formats::dart) fn factors_of_bands(node: &Element) -> impl Iterator<Item = &Element> {
    node.children.iter().filter(|e| e.name.ends_with("MultiplicativeFactorForLUT"))
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
    // What is no factor: switches, and how quickly transmittance acts.
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
            at: element.at(),
        });
    }
    functions
}
