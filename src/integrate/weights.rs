//! Weights of spectra: what each pixel's facets send.

use super::pixel::{Entry, Pixel};
use super::split;
use super::textures::Textures;
use crate::geometry::index_u32;
use crate::geometry::polygon::Rect;
use crate::product::{Added, Slab};
use crate::scene::Scene;
use crate::solve::{Emission, Fragment, ImagePart};
use crate::visibility::Drawing;

/// Sums up what the facets of a pixel send.
pub(super) struct Weights<'a> {
    scene: &'a Scene,
    emission: &'a Emission<'a>,
    textures: Textures<'a>,
    sums: Sums,
    lit: Vec<ImagePart>,
}

/// Weights of a line's pixels, by ascending row.
#[derive(Default)]
pub(super) struct WeightLine {
    row_start: Vec<usize>,
    row: Vec<u32>,
    weight: Vec<f64>,
}

impl<'a> Weights<'a> {
    pub(super) fn new(scene: &'a Scene, drawing: &'a Drawing<'a>, emission: &'a Emission<'a>) -> Self {
        let sums = Sums { value: vec![0.0; emission.rows()], used: vec![] };
        Weights { scene, emission, textures: Textures::new(scene, drawing), sums, lit: vec![] }
    }

    pub(super) fn new_line(&mut self, rows: [u32; 2]) {
        self.textures.new_line(rows);
    }

    /// Adds the bodies of the sky that a pixel shows.
    pub(super) fn gather_globes(&mut self, pixel: &Pixel) {
        let (emission, sums) = (self.emission, &mut self.sums);
        for (globe, shown) in pixel.globes.shown() {
            emission.send_globe(*globe, shown, |row, weight| sums.add(row, weight));
        }
    }

    /// Adds all that a pixel sees; its pieces have been sorted if there are textures.
    pub(super) fn gather(&mut self, pixel: &mut Pixel) {
        for index in 0..pixel.entries.len() {
            let entry = pixel.entries[index];
            if !entry.front {
                continue;
            }
            // Most skies have the Sun alone.
            let lit = match pixel.lights() {
                1 => std::slice::from_ref(&entry.lit),
                lights => {
                    self.lit.clear();
                    self.lit.extend((0..lights).map(|light| pixel.lit_part(&entry, light)));
                    &self.lit
                }
            };
            let fragment = Fragment { facet: entry.facet, shown: entry.shown, lit };
            if pixel.pieces.are_kept && pixel.wants_moments {
                let Rect { min, max } = split::bounds(pixel, index);
                let extent = (0.5 * ((max[0] - min[0]).powi(2) + (max[1] - min[1]).powi(2))).sqrt();
                let parts = self.emission.parts(&fragment, extent);
                if parts > 1 {
                    let (emission, sums) = (self.emission, &mut self.sums);
                    split::each(pixel, index, parts, |shown, lit| {
                        let fragment = Fragment { facet: entry.facet, shown: *shown, lit };
                        emission.send(&fragment, None, |row, weight| sums.add(row, weight));
                    });
                    continue;
                }
            }
            let material = self.scene.body.mesh.material[entry.facet as usize].0 as usize;
            let texture = self.textures.look(pixel, index, material);
            let sums = &mut self.sums;
            self.emission.send(&fragment, texture.as_ref(), |row, weight| sums.add(row, weight));
        }
    }

    /// Adds a part of an entry of this area, pixels, and what of it each source lights.
    pub(super) fn add(&mut self, entry: &Entry, area: f64, lit: &[ImagePart]) {
        let fragment = Fragment { facet: entry.facet, shown: entry.shown.scaled_to(area), lit };
        let sums = &mut self.sums;
        self.emission.send(&fragment, None, |row, weight| sums.add(row, weight));
    }

    /// Ends a pixel: its weights go into the line.
    pub(super) fn end(&mut self, line: &mut WeightLine) {
        line.row_start.push(line.row.len());
        self.sums.drain(|row, weight| {
            line.row.push(row);
            line.weight.push(weight);
        });
    }
}

/// Whether something that a pixel shows is to be split.
pub(super) fn varies(emission: &Emission, pixel: &Pixel) -> bool {
    let is_split = |entry: &Entry| {
        let fragment = Fragment { facet: entry.facet, shown: entry.shown, lit: std::slice::from_ref(&entry.lit) };
        entry.front && emission.parts(&fragment, pixel.site.extent()) > 1
    };
    pixel.entries.iter().any(is_split)
}

/// Sums of a pixel, by row.
struct Sums {
    value: Vec<f64>,
    used: Vec<u32>,
}

impl Sums {
    #[inline]
    fn add(&mut self, row: u32, weight: f64) {
        let value = &mut self.value[row as usize];
        if *value == 0.0 {
            self.used.push(row);
        }
        *value += weight;
    }

    /// Hands out the weights by ascending row, and forgets them.
    fn drain(&mut self, mut put: impl FnMut(u32, f64)) {
        self.used.sort_unstable();
        self.used.dedup();
        for row in self.used.drain(..) {
            let weight = std::mem::take(&mut self.value[row as usize]);
            if weight != 0.0 {
                put(row, weight);
            }
        }
    }
}

/// The slab of all lines.
pub(super) fn slab(scene: &Scene, emission: &Emission, lines: Vec<WeightLine>) -> Slab {
    let entries = lines.iter().map(|line| line.row.len()).sum();
    let mut slab = Slab {
        lines: 0..lines.len(),
        bands: 0..scene.exposure.bands.len(),
        row_start: Vec::with_capacity(lines.iter().map(|line| line.row_start.len()).sum::<usize>() + 1),
        row: Vec::with_capacity(entries),
        weight: Vec::with_capacity(entries),
        spectra: emission.spectra(),
        first_thermal_row: index_u32(emission.first_thermal_row()),
        added: Added::default(),
    };
    for line in lines {
        let base = slab.row.len();
        slab.row_start.extend(line.row_start.iter().map(|start| base + start));
        slab.row.extend(line.row);
        slab.weight.extend(line.weight);
    }
    slab.row_start.push(slab.row.len());
    slab
}
