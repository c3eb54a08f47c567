//! Where temperatures come from: illumination, cells, layers or the atmosphere.

use std::path::Path;

use crate::error::{Location, Problem};
use crate::formats::input;
use crate::formats::xml::Element;
use crate::geometry::whole;
use crate::report::Fate;

use super::super::{CellTemperatures, Maket, SpectralInterval, ThermalFunction};
use super::reading::{Reading, number};

/// No file of temperatures is longer, bytes.
const FILE: u64 = 256 << 20;
/// What is read instead of what is not.
const INSTEAD: &str = "taken are those of the thermal functions";

/// `temperatureMode`, and the temperatures of cells if they count.
pub(super) fn read(
    phase: &Element,
    bands: &[SpectralInterval],
    maket: &Maket,
    thermal: &[ThermalFunction],
    reading: &mut Reading,
) -> (u32, Option<CellTemperatures>) {
    let glows = bands.iter().any(|band| band.mode != 0);
    if glows
        && let Some(sky) = phase.descendant("temperatureAtmosphere")
        && reading.number_or(sky, "atmosphericApparentTemperature", 0.0) > 0.0
    {
        reading.note(Fate::Dropped, sky.at_attribute("atmosphericApparentTemperature"), "heat from the sky");
    }
    let Some(node) = phase.descendant("SpectralDomainTir") else { return (0, None) };
    if !glows && node.get("temperatureMode").is_none() {
        return (0, None);
    }
    let mode = reading.code(node, "temperatureMode", 0, 3);
    let at = || node.at_attribute("temperatureMode");
    match mode {
        _ if !glows => {}
        1 if thermal.iter().all(|function| function.overrides_cells) => {}
        1 => return (mode, cells(node, maket, reading)),
        2 => {
            let message = format!(
                "temperatures of layers from a file (`temperatureMode` 2), whose form is not documented: {INSTEAD}. Write them as cells, layer by \
                 layer from below, with `temperatureMode` 1"
            );
            reading.note(Fate::Dropped, at(), message);
        }
        3 => {
            let message = format!(
                "temperatures that DART makes from those of its atmosphere (`temperatureMode` 3): {INSTEAD}. Give them the temperatures \
                 that are meant, with `deltaT` 0"
            );
            reading.note(Fate::Dropped, at(), message);
        }
        _ => {}
    }
    (mode, None)
}

fn cells(node: &Element, maket: &Maket, reading: &mut Reading) -> Option<CellTemperatures> {
    let element = reading.child(node, "TemperatureFile")?;
    let file = reading.text(element, "temperatureFileName");
    let at = element.at_attribute("temperatureFileName");
    let path = match reading.folder.locate(&file, &at) {
        Ok(Some(path)) => path,
        Ok(None) => {
            let message = format!("temperatures of cells from `{file}`, which is not in the input folder: {INSTEAD}");
            reading.note(Fate::Dropped, at, message);
            return None;
        }
        Err(problem) => {
            reading.problems.push(|| problem);
            return None;
        }
    };
    let text = match input::text(&path, FILE) {
        Ok((text, input)) => {
            reading.inputs.push(input);
            text
        }
        Err(error) => {
            reading.problem(at, error.to_string());
            return None;
        }
    };
    let values_k = values(&text, &path, reading)?;
    let [x, y] = maket.size_m.map(|size_m| whole((size_m / maket.cell_m[0]).round()).max(1));
    let layer = x.saturating_mul(y);
    if values_k.is_empty() || values_k.len() % layer != 0 {
        let message = format!(
            "holds {} temperatures: of a scene of {x} x {y} cells each layer has {layer} (maket.xml, SceneDimensions over CellDimensions)",
            values_k.len()
        );
        reading.problem(Location::file(&path), message);
        return None;
    }
    Some(CellTemperatures { file, count: [x, y, values_k.len() / layer], values_k, at })
}

/// Numbers above 0; what is none is told at its place.
fn values(text: &str, path: &Path, reading: &mut Reading) -> Option<Vec<f64>> {
    let (mut values, mut start, mut are_good) = (Vec::new(), 0, true);
    for line in text.split_inclusive('\n') {
        for word in line.split_whitespace() {
            match number(word).filter(|t_k| *t_k > 0.0) {
                Some(t_k) => values.push(t_k),
                None => {
                    are_good = false;
                    let end = start + line.trim_end().len();
                    let message = || format!("`{}`: temperatures are numbers above 0, K", short(word));
                    reading.problems.push(|| Problem::new(Location::span(path, text, start, end), message()));
                }
            }
        }
        start += line.len();
    }
    are_good.then_some(values)
}

/// The beginning of a word that may be anything.
fn short(word: &str) -> String {
    word.chars().take(20).collect()
}
