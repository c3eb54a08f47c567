//! The light that radiance maps hold: heat must count once, and a band without heat, or without sunlight, takes none of a map's either.

use crate::error::{Error, Location, Problem, Result, number};
use crate::product::RadianceMap;
use crate::scene::{Scene, Thermal};
use crate::spectral::{Band, Light, Mix};

/// From this wavelength on, um, what is as warm as rock in sunlight may emit enough to matter: 1e-2 of what it reflects at 1.5 au, if it is at
/// 300 K and its reflectance 0.07.
const HEAT_FROM_UM: f64 = 2.5;

/// Weights of a mean, in decimals, sum to 1 but for this.
const ROUNDED_MEAN: f64 = 1e-9;

/// Refuses thermal emission that would count more than once; where it is only possible, that is a note.
pub(super) fn heat_counts_once(scene: &Scene, terms: &[Vec<RadianceMap>], add_solved: bool) -> Result<Vec<String>> {
    let holds = |heat: Option<bool>| {
        // A term's views are of the same sum; what is subtracted does not count twice.
        let of_term = move |views: &Vec<RadianceMap>| {
            let weight = |map: &RadianceMap| if map.heat() == heat { map.weight } else { 0.0 };
            views.iter().map(|map| (weight(map), map.name.clone())).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        terms.iter().filter_map(of_term).filter(|(weight, _)| *weight > 0.0).collect::<Vec<(f64, String)>>()
    };
    let mut known = holds(Some(true));
    if add_solved && scene.models.thermal != Thermal::Off {
        known.push((1.0, "the scene's own table".into()));
    }
    let names = |held: &[(f64, String)]| held.iter().map(|h| h.1.as_str()).collect::<Vec<_>>().join(", ");
    let times: f64 = known.iter().map(|h| h.0).sum();
    if times > 1.0 + ROUNDED_MEAN {
        let message = format!("thermal emission would count {} times: it is in {}", number(times), names(&known));
        let problem = Problem::new(Location::item("--radiance"), message).with_help(
            "let one simulation emit, and set the bands of the others to reflection alone (mode R), or the scene's thermal model to \"off\"; \
             weights whose sum is 1 make a mean",
        );
        return Err(Error::Invalid(vec![problem]));
    }
    let unknown = holds(None);
    let is_warm = scene.exposure.bands.iter().any(|band| band.centre_um > HEAT_FROM_UM);
    if known.is_empty() || unknown.is_empty() || !is_warm {
        return Ok(vec![]);
    }
    Ok(vec![format!(
        "thermal emission is in {}; if it is in {} too, it counts twice: say `heat = true` or `heat = false` in a map file",
        names(&known),
        names(&unknown)
    )])
}

/// Reports bands without sunlight, or without heat, that get values of a map that may hold it.
pub(super) fn may_hold_more(map: &RadianceMap, sensor: &[Band], mixes: &[Mix]) -> Option<String> {
    let may = |(of_map, _): &(usize, f64), light: Light| {
        map.light.get(*of_map).copied().unwrap_or_default().may_have_more_than(light)
    };
    // This far below `HEAT_FROM_UM` there is no heat to distinguish from sunlight.
    let matters = |band: &Band| band.light == Light::Heat || band.centre_um > HEAT_FROM_UM;
    let mut unsure = sensor
        .iter()
        .zip(mixes)
        .enumerate()
        .filter(|(_, (band, mix))| matters(band) && mix.iter().any(|share| may(share, band.light)));
    let (i, (band, _)) = unsure.next()?;
    let more = match unsure.count() {
        0 => String::new(),
        n => format!("; the same holds for {n} more"),
    };
    let other = if band.light == Light::Heat { "sunlight" } else { "heat" };
    Some(format!(
        "band {} of the sensor has {} alone; whether {} holds {other} there, too, nobody says, and its numbers are taken as they are: `light` in \
         `bands` of its map file says it{more}",
        i + 1,
        band.light.name(),
        map.name
    ))
}
