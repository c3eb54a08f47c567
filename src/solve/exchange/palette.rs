//! The few wavelengths at which light between facets is carried, and what they say of all others.
//!
//! A source's light becomes another colour with every material that reflects it, so that there are more and more colours. But their spectra are alike:
//! a few of them, known at as many wavelengths, give all others. Cross approximation finds both (Bebendorf 2000, Numer. Math. 86, 565): the
//! colour and the wavelength at which what has been found is furthest off come next, until nothing is off by more than a tolerance. How many materials, sources and
//! bounces there are then makes no difference, nor what becomes of others if one of them is left out.

use crate::geometry::MaterialId;
use crate::product::{FacetTable, Reflected, ReflectedPart};
use crate::scene::{Scene, Source};
use crate::spectral::Light;

/// No colour is further off, over the most of itself, relative to the strongest source.
const TOLERANCE: f64 = 1e-5;
/// So many wavelengths at most: each is a number for every facet.
const MOST: usize = 24;
/// Colours of further bounces are looked at while there are no more than these, those of the first in any case.
const MOST_COLOURS: usize = 1024;
/// Wide bands are looked at in so many places, evenly from end to end.
const OF_BAND: u32 = 5;

/// At which wavelengths light is carried.
#[derive(Debug, Default)]
pub(super) struct Palette {
    /// Each with what it says of others.
    pub(super) nodes: Vec<Node>,
    /// By how much a colour is off at most where there are not enough of them; over the most of itself, relative to the strongest source.
    pub(super) error: f64,
}

/// A wavelength.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) um: f64,
    pub(super) light: Light,
    /// Irradiance normal to the beam of each source, W m-2 um-1.
    pub(super) sources: Vec<f64>,
    /// Reflectance of each material.
    pub(super) reflectance: Vec<f64>,
    /// The spectrum of light that is 1 at this wavelength and 0 at the others.
    pub(super) spectrum: Vec<ReflectedPart>,
}

/// A source, and the materials that have reflected its light, ascending.
type Colour = (usize, Vec<MaterialId>);

impl Palette {
    /// For the bands of a scene.
    pub(super) fn of(scene: &Scene, bounces: u32) -> Self {
        let lights = lights(scene, &places(scene));
        let (colours, spectra) = known(scene, &lights, bounces);
        let Cross { pivots, error } = cross(spectra.clone());
        let matrix: Vec<Vec<f64>> =
            pivots.iter().map(|(_, p)| pivots.iter().map(|(c, _)| spectra[*c][*p]).collect()).collect();
        let inverse = inverse(matrix);
        let node = |(j, (_, p)): (usize, &(usize, usize))| {
            let at = &lights[*p];
            let part = |(k, (c, _)): (usize, &(usize, usize))| ReflectedPart {
                factor: inverse[k][j] / at.strongest,
                source: colours[*c].0,
                by: colours[*c].1.clone(),
            };
            Node {
                um: at.place.um,
                light: at.place.light,
                sources: at.sources.clone(),
                reflectance: at.reflectance.clone(),
                spectrum: pivots.iter().enumerate().map(part).collect(),
            }
        };
        Palette { nodes: pivots.iter().enumerate().map(node).collect(), error }
    }
}

/// A wavelength in bands of one kind.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    um: f64,
    light: Light,
}

/// The middles of bands with light; wide ones from end to end.
fn places(scene: &Scene) -> Vec<Place> {
    let mut all = Vec::new();
    for band in scene.exposure.bands.iter().filter(|band| band.light.is_lit()) {
        let (low, high) = band.support_within_um(scene.known_um(band.light));
        let at = |um| Place { um, light: band.light };
        match low < high {
            true => all.extend((0..OF_BAND).map(|i| at(low + (high - low) * f64::from(i) / f64::from(OF_BAND - 1)))),
            false => all.push(at(band.centre_um)),
        }
    }
    all.sort_by(|a, b| a.um.total_cmp(&b.um).then(a.light.glows().cmp(&b.light.glows())));
    all.dedup();
    all
}

/// What light there is, and what surfaces reflect of it.
struct LightAt {
    place: Place,
    /// Of each source, W m-2 um-1, and the most of them.
    sources: Vec<f64>,
    strongest: f64,
    /// Of each material.
    reflectance: Vec<f64>,
}

impl LightAt {
    fn new(scene: &Scene, sources: &[Source], place: Place) -> Self {
        let Place { um, light } = place;
        let of = |source: &Source| scene.incoming_w_m2_um(source.incoming, light, um).iter().product();
        let sources: Vec<f64> = sources.iter().map(of).collect();
        LightAt {
            place,
            strongest: sources.iter().copied().fold(0.0, f64::max),
            sources,
            reflectance: scene.body.materials.iter().map(|m| m.reflectance.at(um).unwrap_or(f64::NAN)).collect(),
        }
    }

    /// Of a colour, relative to the strongest source.
    fn of(&self, (source, by): &Colour) -> f64 {
        let reflected: f64 = by.iter().map(|m| self.reflectance[m.0 as usize]).product();
        self.sources[*source] / self.strongest * reflected
    }
}

/// Where there is any light, and it is known.
fn lights(scene: &Scene, places: &[Place]) -> Vec<LightAt> {
    let sources = scene.sources();
    let all = places.iter().map(|place| LightAt::new(scene, &sources, *place));
    all.filter(|at| at.strongest > 0.0 && at.strongest.is_finite()).collect()
}

/// Colours of which there is any light, and the light of each.
fn known(scene: &Scene, lights: &[LightAt], bounces: u32) -> (Vec<Colour>, Vec<Vec<f64>>) {
    let mut used: Vec<MaterialId> = scene.body.mesh.material.clone();
    used.sort_unstable();
    used.dedup();
    colours(scene.sources().len(), &used, bounces)
        .into_iter()
        .map(|colour| (lights.iter().map(|at| at.of(&colour)).collect::<Vec<_>>(), colour))
        .filter(|(spectrum, _)| spectrum.iter().all(|x| x.is_finite()) && most(spectrum) > 0.0)
        .map(|(spectrum, colour)| (colour, spectrum))
        .unzip()
}

/// By how much spectra of light between facets are off in the bands of a scene, which may be others than those that a table was solved for: the most of any
/// colour, over the most of itself, relative to the strongest source.
pub fn spectra_error(scene: &Scene, table: &FacetTable) -> f64 {
    let (Some(exchange), false) = (table.models.exchange, table.reflected.is_empty()) else { return 0.0 };
    let lights = lights(scene, &places(scene));
    let (colours, spectra) = known(scene, &lights, exchange.bounces);
    let columns: Vec<Place> = table.reflected.iter().map(|r| Place { um: r.um, light: r.light }).collect();
    let sources = scene.sources();
    let columns: Vec<LightAt> = columns.iter().map(|place| LightAt::new(scene, &sources, *place)).collect();
    // [column, place]: the spectrum of what is 1 in a column, relative to the strongest source in both places.
    let spectrum = |(reflected, column): (&Reflected, &LightAt)| -> Vec<f64> {
        let part = |at: &LightAt, part: &ReflectedPart| part.factor * at.of(&(part.source, part.by.clone()));
        lights.iter().map(|at| column.strongest * reflected.parts.iter().map(|p| part(at, p)).sum::<f64>()).collect()
    };
    let of_columns: Vec<Vec<f64>> = table.reflected.iter().zip(&columns).map(spectrum).collect();
    let mut error = 0.0_f64;
    for (colour, expected) in colours.iter().zip(&spectra) {
        let known: Vec<f64> = columns.iter().map(|column| column.of(colour)).collect();
        let off = |(p, expected): (usize, &f64)| {
            let got: f64 = known.iter().zip(&of_columns).map(|(known, spectrum)| known * spectrum[p]).sum();
            (got - expected).abs()
        };
        error = error.max(expected.iter().enumerate().map(off).fold(0.0, f64::max) / most(expected));
    }
    error
}

/// Those of light that has been reflected once, twice ..., on its way.
fn colours(sources: usize, materials: &[MaterialId], bounces: u32) -> Vec<Colour> {
    let mut all: Vec<Colour> = Vec::new();
    let mut before: Vec<Colour> = (0..sources).map(|source| (source, vec![])).collect();
    for _ in 0..bounces {
        let mut after = Vec::new();
        for (source, by) in &before {
            // Ascending, so that which surface came first makes no difference.
            for material in materials.iter().filter(|m| by.last().is_none_or(|last| last <= *m)) {
                after.push((*source, [by.as_slice(), &[*material]].concat()));
            }
        }
        if !all.is_empty() && all.len() + after.len() > MOST_COLOURS {
            break;
        }
        all.extend(after.iter().cloned());
        before = after;
    }
    all
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().map(f64::abs).fold(0.0, f64::max)
}

/// Lines and columns of a matrix that give all of it, to within an error.
struct Cross {
    /// [line, column], each once.
    pivots: Vec<(usize, usize)>,
    /// What is left, over the most of each line.
    error: f64,
}

/// Of lines that are not 0.
fn cross(mut rest: Vec<Vec<f64>>) -> Cross {
    for line in &mut rest {
        let most = most(line);
        line.iter_mut().for_each(|x| *x /= most);
    }
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    loop {
        let mut worst = (0.0, (0, 0));
        for (c, line) in rest.iter().enumerate() {
            for (p, x) in line.iter().enumerate() {
                if x.abs() > worst.0 {
                    worst = (x.abs(), (c, p));
                }
            }
        }
        let (error, (c, p)) = worst;
        if error <= TOLERANCE || pivots.len() == MOST {
            return Cross { pivots, error };
        }
        pivots.push((c, p));
        let pivot = rest[c].clone();
        for line in &mut rest {
            let factor = line[p] / pivot[p];
            line.iter_mut().zip(&pivot).for_each(|(x, q)| *x -= factor * q);
            // Not what rounding leaves.
            line[p] = 0.0;
        }
    }
}

/// By elimination with row pivots, for a few lines that are far from dependent.
fn inverse(mut matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = matrix.len();
    let mut inverse: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for column in 0..n {
        let largest = (column..n).max_by(|a, b| matrix[*a][column].abs().total_cmp(&matrix[*b][column].abs()));
        let largest = largest.unwrap_or(column);
        matrix.swap(column, largest);
        inverse.swap(column, largest);
        let pivot = matrix[column][column];
        matrix[column].iter_mut().chain(&mut inverse[column]).for_each(|x| *x /= pivot);
        let (line, of_inverse) = (matrix[column].clone(), inverse[column].clone());
        for other in (0..n).filter(|other| *other != column) {
            let factor = matrix[other][column];
            matrix[other].iter_mut().zip(&line).for_each(|(x, y)| *x -= factor * y);
            inverse[other].iter_mut().zip(&of_inverse).for_each(|(x, y)| *x -= factor * y);
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_surfaces_makes_no_difference() {
        // Of two sources and three materials: 2 x 3 and 2 x 6.
        let materials = [0, 3, 7].map(MaterialId);
        let all = colours(2, &materials, 2);
        assert_eq!(all.len(), 18);
        assert!(all.iter().all(|(_, by)| by.is_sorted()));
        assert_eq!(all.iter().filter(|(source, by)| *source == 1 && by == &[MaterialId(0), MaterialId(7)]).count(), 1);
        // Very many are cut after the first bounce, at the earliest.
        let many: Vec<MaterialId> = (0..5000).map(MaterialId).collect();
        assert_eq!(colours(1, &many, 3).len(), 5000);
    }

    #[test]
    fn what_has_three_spectra_takes_three_wavelengths() {
        // 1, x and x^2, and 40 sums of them.
        let at = |k: u32, x: f64| (1.0 + f64::from(k) * 0.3) + f64::from(k % 7) * x + f64::from(k % 5) * x * x;
        let lines: Vec<Vec<f64>> = (0..40).map(|k| (0..50).map(|i| at(k, f64::from(i) / 50.0)).collect()).collect();
        let Cross { pivots, error } = cross(lines.clone());
        assert_eq!(pivots.len(), 3);
        assert!(error < 1e-13, "{error}");
        let matrix: Vec<Vec<f64>> =
            pivots.iter().map(|(_, p)| pivots.iter().map(|(c, _)| lines[*c][*p]).collect()).collect();
        let inverse = inverse(matrix);
        for line in &lines {
            for (i, expected) in line.iter().enumerate() {
                let got: f64 = (0..3)
                    .map(|k| {
                        let factor: f64 = (0..3).map(|j| inverse[k][j] * line[pivots[j].1]).sum();
                        factor * lines[pivots[k].0][i]
                    })
                    .sum();
                assert!((got - expected).abs() < 1e-11 * most(line), "{got} {expected}");
            }
        }
    }

    #[test]
    fn noise_ends_at_the_most() {
        let noise = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
        let lines = (0..60).map(|c| (0..60).map(|p| noise(60 * c + p) + 0.1).collect()).collect();
        let Cross { pivots, error } = cross(lines);
        assert_eq!(pivots.len(), MOST);
        assert!(error > 1e-2 && error < 10.0, "{error}");
    }
}
