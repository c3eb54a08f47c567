//! Radiance maps from elsewhere: how much of each pixel each texel fills. Free of wavelength, like footprints: bands are
//! multiplied in afterwards.

mod charts;
mod choice;
mod eye;
mod lens;
mod lookup;
mod sums;
mod texels_of_pixel;
mod texels_seen;
mod together;

use crate::geometry::Texels;
use crate::product::{Placement, Plane, TexelWeights};
use crate::visibility::Seen;

pub use choice::ViewChoice;
pub use eye::{meets, seen_by_eye};
pub(super) use lookup::{Lookup, TexelLayout};
pub(super) use texels_of_pixel::{MapLine, PixelTexels};
pub use texels_seen::texels_seen;

/// What is shown where a map knows nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unknown {
    /// What is known of the facet, else of the pixel, stands for the rest.
    #[default]
    Mean,
    /// Nothing: the caller has something for it.
    Left,
    /// What the scene's own sources and heat send there.
    Solved,
}

/// A map in a scene.
#[derive(Debug, Clone, Copy)]
pub struct MapView<'a> {
    /// Where its texels lie.
    pub placement: &'a Placement,
    /// For each texel whether it holds a value.
    pub known: &'a [bool],
    /// For each texel whether its eye sees nothing of the scene there; empty if that is not asked for.
    pub sky: &'a [bool],
    /// What its eye sees of each facet, as [`seen_by_eye`] finds it.
    pub eye: Option<&'a Seen>,
}

/// How maps are put onto a scene.
#[derive(Debug, Clone)]
pub struct Maps<'a> {
    /// Terms of a sum; each is one of several maps of the scene, seen from different directions.
    pub terms: Vec<Vec<MapView<'a>>>,
    /// Which of the maps of a term.
    pub choice: ViewChoice,
    /// What holds between texel centres.
    pub texels: Texels,
    /// What is shown where nothing is known.
    pub unknown: Unknown,
    /// The scene's own light and heat are added, everywhere.
    pub adds_solved: bool,
}

/// How much of the pixels the texels of maps fill.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MapImage {
    /// For each map of each term.
    pub weights: Vec<Vec<TexelWeights>>,
    /// For each term and pixel the area that it knows nothing of, of what is seen of outer sides, pixels.
    pub unknown: Vec<Vec<f64>>,
    /// As much of that as the weights do not stand for either: with [`Unknown::Mean`] that of facets of which nothing is known.
    pub unfilled: Vec<Vec<f64>>,
    /// For each pixel the area that shows outer sides, pixels.
    pub area: Vec<f64>,
    /// Largest angle between a direction of view and that of the map that serves it, deg; 0 if no map has a direction.
    pub largest_angle_deg: f64,
    /// Largest error by quadrature between texel centres, relative to the largest value of the texels around.
    pub quadrature_error: f64,
}

/// Images of geometry that maps add: name and unit.
const PLANES: [(&str, &str); 2] = [("MAP_COVERAGE", "1"), ("MAP_ANGLE", "deg")];

/// All lines together, and the planes that they add.
pub(super) fn join(maps: &Maps, lines: impl Iterator<Item = MapLine>) -> (MapImage, Vec<Plane>) {
    let mut image = MapImage::new(maps);
    let mut values: [Vec<f64>; 2] = Default::default();
    for line in lines {
        values[0].extend(&line.coverage);
        values[1].extend(&line.angle_deg);
        image.append(line);
    }
    let named = PLANES.iter().zip(values);
    let plane = |((name, unit), values): (&(&str, &str), Vec<f64>)| Plane {
        name: (*name).to_owned(),
        unit: (*unit).to_owned(),
        values,
    };
    (image, named.map(plane).collect())
}

impl MapImage {
    fn new(maps: &Maps) -> Self {
        MapImage {
            weights: maps.terms.iter().map(|views| vec![TexelWeights::default(); views.len()]).collect(),
            unknown: vec![vec![]; maps.terms.len()],
            unfilled: vec![vec![]; maps.terms.len()],
            ..MapImage::default()
        }
    }

    fn append(&mut self, line: MapLine) {
        let ours = self.weights.iter_mut().flatten();
        ours.zip(line.weights.into_iter().flatten()).for_each(|(ours, line)| ours.lines.push(line));
        self.unknown.iter_mut().zip(&line.unknown).for_each(|(ours, line)| ours.extend(line));
        self.unfilled.iter_mut().zip(&line.unfilled).for_each(|(ours, line)| ours.extend(line));
        self.area.extend(&line.area);
        self.largest_angle_deg = line.angle_deg.iter().copied().fold(self.largest_angle_deg, f64::max);
        self.quadrature_error = self.quadrature_error.max(line.quadrature_error);
    }
}
