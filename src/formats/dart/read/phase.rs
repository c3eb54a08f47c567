//! phase.xml: bands, illumination, products and cameras.

use crate::formats::xml::Element;
use crate::geometry::index_u32;
use crate::report::Fate;

use super::super::{Maket, Phase, SpectralInterval, ThermalFunction};
use super::reading::{Reading, number};
use super::{camera, temperatures};

pub(super) fn read(phase: &Element, maket: &Maket, thermal: &[ThermalFunction], reading: &mut Reading) -> Phase {
    let bands = bands(phase, reading);
    let (irradiance_mode, irradiance) = irradiance(phase, bands.len(), reading);
    let (temperature_mode, cells) = temperatures::read(phase, &bands, maket, thermal, reading);
    let products = phase.descendant("BrfProductsProperties");
    Phase {
        bands,
        irradiance_mode,
        irradiance,
        temperature_mode,
        cells,
        radiance_products: products.is_some_and(|p| reading.flag(p, "luminanceProducts")),
        cameras: camera::read(phase, maket, reading),
    }
}

/// Elements in the order of their `bandNumber`, from 0 without gaps: in that of the file where it is missing.
fn numbered<'e>(mut elements: Vec<&'e Element>, reading: &mut Reading) -> Vec<&'e Element> {
    let number = |(i, e): (usize, &&Element)| match e.get("bandNumber") {
        Some(_) => reading.integer(e, "bandNumber"),
        None => index_u32(i),
    };
    let numbers: Vec<u32> = elements.iter().enumerate().map(number).collect();
    let mut order: Vec<usize> = (0..elements.len()).collect();
    order.sort_by_key(|&i| numbers[i]);
    for (wanted, &i) in order.iter().enumerate() {
        if numbers[i] as usize != wanted && elements[i].get("bandNumber").is_some() {
            let message =
                format!("`bandNumber` is {} where {wanted} belongs: bands count from 0 without gaps", numbers[i]);
            reading.problem(elements[i].at_attribute("bandNumber"), message);
            break;
        }
    }
    elements = order.into_iter().map(|i| elements[i]).collect();
    elements
}

fn bands(phase: &Element, reading: &mut Reading) -> Vec<SpectralInterval> {
    let Some(list) = phase.descendant("SpectralIntervals") else {
        reading.problem(phase.at(), "has no `<SpectralIntervals>` within");
        return Vec::new();
    };
    let elements = numbered(list.all("SpectralIntervalsProperties").collect(), reading);
    if elements.is_empty() {
        reading.problem(list.at(), "holds no band");
    }
    let mut bands = Vec::new();
    for element in elements {
        let mean_um = reading.positive(element, "meanLambda");
        let width_um = reading.number(element, "deltaLambda");
        if width_um < 0.0 || width_um > 2.0 * mean_um {
            let message = format!("a band {width_um} um wide at {mean_um} um");
            reading.problem(element.at_attribute("deltaLambda"), message);
        }
        let mode = reading.code(element, "spectralDartMode", 0, 2);
        if let Some(law) = element.child("emissionLawNode").filter(|_| mode == 2)
            && reading.integer_or(law, "emissionLaw", 1) == 0
        {
            let message = "emission by the law of Boltzmann over all wavelengths: taken is Planck's law in the band";
            reading.note(Fate::Approximated, law.at(), message);
        }
        bands.push(SpectralInterval { mean_um, width_um, mode, at: element.at() });
    }
    bands
}

fn irradiance(phase: &Element, bands: usize, reading: &mut Reading) -> (u32, Vec<Option<(f64, f64)>>) {
    let Some(node) = phase.descendant("nodeIlluminationMode") else {
        reading.note(Fate::Defaulted, phase.at(), "says nothing of illumination: taken is DART's solar spectrum");
        return (0, Vec::new());
    };
    let mode = reading.integer_or(node, "irradianceMode", 0);
    let what = match mode {
        2 => Some("illumination by a radiance file of DART"),
        3 => Some("illumination by a text file: give the values for each band, or a solar spectrum"),
        0 | 1 => None,
        _ => Some("illumination of a kind that is not known"),
    };
    if let Some(what) = what {
        reading.note(Fate::Dropped, node.at_attribute("irradianceMode"), what);
    }
    let Some(list) = node.child("SpectralIrradiance") else {
        if mode == 1 {
            let message = "says no irradiance of bands, as in old versions: taken is a solar spectrum";
            reading.note(Fate::Approximated, node.at(), message);
        }
        return (if mode == 1 { 0 } else { mode }, Vec::new());
    };
    let mut values: Vec<Option<(f64, f64)>> = vec![None; bands];
    let mut first = None;
    for (i, element) in list.all("SpectralIrradianceValue").enumerate() {
        let number =
            if element.get("bandNumber").is_some() { reading.integer(element, "bandNumber") as usize } else { i };
        let value = (reading.number_or(element, "irradiance", 0.0), reading.number_or(element, "Skyl", 0.0));
        first.get_or_insert(value);
        if mode == 1 && (value.0 < 0.0 || !(0.0..=1.0).contains(&value.1)) {
            let message = format!(
                "irradiance {} with a diffuse share of {}: not below 0, and a share of 0 to 1",
                value.0, value.1
            );
            reading.problem(element.at(), message);
        }
        match values.get_mut(number) {
            Some(known @ None) => *known = Some(value),
            Some(Some(_)) if mode == 1 => {
                reading.problem(element.at_attribute("bandNumber"), format!("a second irradiance of band {number}"));
            }
            None if mode == 1 => {
                let message = format!("an irradiance of band {number}: there are {bands} bands, counted from 0");
                reading.note(Fate::Dropped, element.at(), message);
            }
            _ => {}
        }
    }
    if mode != 1 {
        return (mode, values);
    }
    if let Some(common) = list.child("CommonParameters") {
        let first = first.unwrap_or_default();
        if reading.flag(common, "commonIrradianceCheckBox") {
            values.iter_mut().for_each(|v| *v = Some((first.0, v.map_or(first.1, |v| v.1))));
        }
        if reading.flag(common, "commonSkylCheckBox") {
            values.iter_mut().flatten().for_each(|v| v.1 = first.1);
        }
        if reading.integer_or(common, "irraDef", 0) != 0 {
            let message =
                "irradiance on a horizontal surface: taken as it is, which is that on a surface towards the Sun";
            reading.note(Fate::Approximated, common.at_attribute("irraDef"), message);
        }
    }
    let missing: Vec<String> = (0..bands).filter(|i| values[*i].is_none()).map(|i| i.to_string()).collect();
    if !missing.is_empty() {
        let message = format!(
            "no irradiance of the bands {}: there the solar spectrum is taken as the other bands have it",
            missing.join(", ")
        );
        reading.note(Fate::Defaulted, list.at(), message);
    }
    if values.iter().flatten().any(|v| v.1 > 0.0) {
        let message = "diffuse light from the sky: there is none without an atmosphere";
        let element = list.all("SpectralIrradianceValue").find(|e| e.get("Skyl").and_then(number) > Some(0.0));
        reading.note(Fate::Dropped, element.map_or(list.at(), |e| e.at_attribute("Skyl")), message);
    }
    (mode, values)
}
