//! The ground without craters: layers, each a height at any place.

mod dunes;
mod elevation;
mod mound;

use super::noise::{Form, Octaves};
use super::random::{Purpose, key_in};
use super::recipe::{Recipe, Relief};
use super::sources::Sources;
use crate::error::Problem;
use dunes::Dunes;
use elevation::Elevation;
use mound::Mound;

/// One layer of relief.
#[derive(Debug, Clone)]
pub(super) enum Layer {
    Octaves(Form, Octaves),
    Dunes(Dunes),
    Mound(Mound),
    Elevation(Elevation),
}

/// Waves shorter than this share of the longest are never made: no mesh is so fine.
const SHORTEST: f64 = 1e-6;

/// The layers of a recipe: those below its craters (`relief`), or those above (`cover`).
///
/// # Errors
/// What is wrong with the heights of a file, each at `recipe.relief[i].key`.
pub(super) fn layers(recipe: &Recipe, list: &'static str, sources: &Sources) -> Result<Vec<Layer>, Vec<Problem>> {
    let (reliefs, purpose) = match list {
        "cover" => (&recipe.cover, Purpose::Cover),
        _ => (&recipe.relief, Purpose::Relief),
    };
    let mut problems = Vec::new();
    let mut layers = Vec::new();
    for (i, relief) in reliefs.iter().enumerate() {
        let key = |k: u64| key_in(recipe.seed, purpose, i, k);
        let octaves = |rms_m, longest_m, hurst| Octaves::new(key, rms_m, longest_m, hurst, SHORTEST * longest_m);
        layers.push(match *relief {
            Relief::Rolling { rms_m, longest_m, hurst } => {
                Layer::Octaves(Form::Rolling, octaves(rms_m, longest_m, hurst))
            }
            Relief::Ridged { rms_m, longest_m, hurst } => {
                Layer::Octaves(Form::Ridged, octaves(rms_m, longest_m, hurst))
            }
            Relief::Dunes { height_m, wavelength_m, towards_deg, rise, wander } => Layer::Dunes(Dunes::new(
                height_m,
                wavelength_m,
                towards_deg,
                rise,
                wander,
                // Crests are lines: they do not wander within a wavelength.
                Octaves::new(key, 1.0, 4.0 * wavelength_m, 0.8, wavelength_m),
            )),
            Relief::Mound { x_m, y_m, height_m, flank_deg, length_m, along_deg, top_m, ragged } => {
                let flank_m = mound::flank_m(height_m, flank_deg);
                let octaves = octaves(ragged, 4.0 * flank_m, 0.8);
                Layer::Mound(Mound::new([x_m, y_m], height_m, flank_m, length_m, along_deg, top_m, octaves))
            }
            Relief::Elevation { .. } => match Elevation::new(relief, recipe.size_m, sources) {
                Ok(elevation) => Layer::Elevation(elevation),
                Err((key, message)) => {
                    problems.push(super::check::at(&format!("{list}[{i}].{key}"), message));
                    continue;
                }
            },
        });
    }
    if problems.is_empty() { Ok(layers) } else { Err(problems) }
}

impl Layer {
    /// Height at a place of a grid with this step, m.
    pub(super) fn height_m(&self, x_m: f64, y_m: f64, step_m: f64) -> f64 {
        match self {
            Layer::Octaves(form, octaves) => octaves.height_m(*form, x_m, y_m, step_m),
            Layer::Dunes(dunes) => dunes.height_m(x_m, y_m, step_m),
            Layer::Mound(mound) => mound.height_m(x_m, y_m, step_m),
            Layer::Elevation(elevation) => elevation.height_m(x_m, y_m, step_m),
        }
    }
}
