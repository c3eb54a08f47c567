//! maket.xml: the scene's extent, its ground and terrain.

use crate::formats::xml::Element;
use crate::report::Fate;

use super::super::{Links, Maket, Topography};
use super::reading::Reading;

pub(super) fn read(maket: &Element, reading: &mut Reading) -> Maket {
    let scene = reading.child(maket, "Scene");
    let size = scene.and_then(|s| reading.child(s, "SceneDimensions"));
    let cell = scene.and_then(|s| reading.child(s, "CellDimensions"));
    let soil = reading.child(maket, "Soil");
    let two = |element: Option<&Element>, names: [&str; 2], reading: &mut Reading| {
        element.map_or([1.0; 2], |e| names.map(|name| reading.positive(e, name)))
    };
    let ground = soil.and_then(|soil| {
        let ground = reading.links(soil, None);
        if ground.is_none() {
            reading.problem(soil.at(), "has no `<OpticalPropertyLink>` within");
        }
        ground
    });
    let nowhere = || Links {
        kind: 0,
        index: 0,
        ident: String::new(),
        thermal_index: 0,
        thermal_ident: String::new(),
        at: maket.at(),
    };
    let [latitude, longitude, altitude] = match maket.child("LatLon") {
        Some(place) => ["latitude", "longitude", "altitude"].map(|name| reading.number_or(place, name, 0.0)),
        None => [0.0; 3],
    };
    Maket {
        size_m: two(size, ["x", "y"], reading),
        cell_m: two(cell, ["x", "z"], reading),
        boundary: reading.code(maket, "exactlyPeriodicScene", 1, 2),
        ground: ground.unwrap_or_else(nowhere),
        ground_enabled: soil.and_then(|s| s.get("groundEnabled")).is_none_or(|e| e.trim() != "0"),
        topography: soil.and_then(|soil| topography(soil, reading)),
        latitude_longitude_altitude: [latitude, longitude, altitude],
        at: maket.at(),
    }
}

/// `caseDEM`: what the generator makes a terrain from.
const GENERATORS: [&str; 5] = [
    "synthetic shapes",
    "a part of another raster",
    "a text of hills",
    "another raster, turned",
    "a raster of another format",
];

fn topography(soil: &Element, reading: &mut Reading) -> Option<Topography> {
    let made = generated(soil, reading);
    let topography = soil.child("Topography")?;
    if !reading.flag(topography, "presenceOfTopography") {
        return None;
    }
    let properties = reading.child(topography, "TopographyProperties")?;
    let name = reading.text(properties, "fileName");
    if let Err(problem) = reading.folder.locate(&name, &properties.at_attribute("fileName")) {
        reading.problems.push(|| problem);
    }
    let generated = made.is_some_and(|output| output.is_none_or(|output| output == name));
    Some(Topography { file: name, generated, at: properties.at_attribute("fileName") })
}

/// The raster that DART makes before it runs, if it makes one: `Some(None)` if it is not said which.
fn generated(soil: &Element, reading: &mut Reading) -> Option<Option<String>> {
    let properties = soil.child("DEM_properties").filter(|d| reading.flag(d, "createTopography"))?;
    let generator = properties.child("DEMGenerator");
    let case = generator.and_then(|g| g.get("caseDEM"));
    let known = case.and_then(|c| GENERATORS.get(c.trim().parse::<usize>().ok()?.checked_sub(1)?));
    let at = match generator {
        Some(generator) if case.is_some() => generator.at_attribute("caseDEM"),
        _ => properties.at_attribute("createTopography"),
    };
    let message = format!(
        "DART makes a terrain of {} before it runs: read is the raster as it lies in the folder",
        known.unwrap_or(&"what is not known here")
    );
    reading.note(Fate::Dropped, at, message);
    Some(generator.and_then(|g| g.get("outputFileName")).map(str::to_owned))
}
