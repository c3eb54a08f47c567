//! Scene and facet table to images: what each pixel sees, exactly.
//!
//! A pixel's entries (facet, area, lit area) are found once; weights of spectra and backplanes are sums over them.

mod backplanes;
mod footprints;
mod lit;
mod maps;
mod parts;
mod pixel;
mod sky;
mod texels;
mod textures;
mod together;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use crate::error::Result;
use crate::product::{Backplanes, Cube, FacetTable, Plane};
use crate::progress::{Pulse, Watch, tell};
use crate::scene::Scene;
use crate::solve::Emission;
use crate::visibility::{Coverage, Scratch};

use backplanes::Planes;
use lit::LitArea;
use maps::{Looker, MapLine};
use parts::Polygons;
use pixel::{Entry, Pixel};
use textures::Textures;

pub use backplanes::plane_count;
pub use footprints::footprints;
pub use maps::{Choice, MapImage, MapView, Maps, Unknown, meets};
pub use sky::texels_seen;

/// What a camera sees.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Radiance.
    pub cube: Cube,
    /// Images of geometry.
    pub backplanes: Backplanes,
    /// For each facet whether some pixel sees it.
    pub seen: Vec<bool>,
    /// Area that shows the inner side of a facet, pixels.
    pub back_area_px: f64,
    /// Largest amount by which the areas in a pixel exceed the pixel, pixels: rounding.
    pub excess_px: f64,
    /// What of the pixels the texels of maps fill, if there are maps.
    pub maps: Option<MapImage>,
}

/// Images of geometry that maps add: name and unit.
const MAP_PLANES: [(&str, &str); 2] = [("MAP_COVERAGE", "1"), ("MAP_ANGLE", "deg")];

/// One line of the image.
#[derive(Default)]
struct Line {
    maps: MapLine,
    row_start: Vec<usize>,
    row: Vec<u32>,
    weight: Vec<f64>,
    back_area_px: f64,
    excess_px: f64,
}

/// Looks at a scene.
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported), as [`Scene::simulable`] says;
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn integrate(scene: &Scene, table: &FacetTable, watch: Watch<'_>) -> Result<Image> {
    look(scene, table, None, watch)
}

/// Looks at a scene whose radiance maps give. The cube holds what is solved, where they know nothing or everywhere, if that is asked
/// for; their own radiance is to be added band by band, by the weights of their texels.
///
/// # Errors
/// As [`integrate`].
pub fn integrate_maps(scene: &Scene, table: &FacetTable, maps: &Maps<'_>, watch: Watch<'_>) -> Result<Image> {
    look(scene, table, Some(maps), watch)
}

fn look(scene: &Scene, table: &FacetTable, maps: Option<&Maps<'_>>, watch: Watch<'_>) -> Result<Image> {
    scene.simulable()?;
    let camera = &scene.exposure.camera;
    let prepared = maps.map(|maps| maps::prepare(maps, scene, watch)).transpose()?;
    let facets = scene.body.mesh.facets.len();
    let prepared = prepared.unwrap_or_default();
    let polygons: Vec<Vec<_>> =
        prepared.iter().map(|views| views.iter().map(|p| p.polygons(facets)).collect()).collect();
    let drawing = footprints::draw(&scene.body.mesh, scene.body.topology(), camera);
    let coverage = Coverage::new(&drawing);
    let sunlit = Polygons::of_sunlit(&table.sunlit);
    let emission = Emission::new(scene, table);
    let planes = Planes::new(scene, table);
    let (samples, rows) = (camera.samples as usize, camera.lines as usize);
    // Each plane asks for zeroed memory of its own: a clone would write it.
    let mut values: Vec<Vec<f64>> = (0..planes.count()).map(|_| vec![0.0; samples * rows]).collect();
    // Each line of the image writes its own part of every plane.
    let mut parts: Vec<Vec<&mut [f64]>> = std::iter::repeat_with(Vec::new).take(rows).collect();
    for plane in &mut values {
        plane.chunks_mut(samples).zip(&mut parts).for_each(|(chunk, part)| part.push(chunk));
    }
    let mut seen = Vec::with_capacity(scene.body.mesh.facets.len());
    seen.resize_with(scene.body.mesh.facets.len(), || AtomicBool::new(false));
    let done = AtomicU64::new(0);
    let pulse = || Pulse::new(watch, "image", &done, rows as u64);
    let lines: Result<Vec<Line>> = parts
        .into_par_iter()
        .enumerate()
        .map_init(
            || {
                let mut pixel = Pixel::new(&drawing, LitArea::new(&drawing, &table.sunlit, &sunlit));
                let looker = maps.map(|maps| Looker::new(scene, &drawing, maps, &prepared, &polygons));
                let textures = Textures::new(scene, &drawing);
                pixel.fragments.are_kept = looker.is_some() || !scene.body.textures.is_empty();
                (Scratch::new(pulse()), pixel, Weights::new(emission.rows()), looker, textures)
            },
            |(scratch, pixel, weights, looker, textures), (row, mut part)| {
                let row = row as u32;
                let mut line = Line::default();
                pixel.new_line(row);
                textures.new_line(row);
                if let Some(looker) = looker {
                    line.maps = looker.new_line(row);
                }
                for column in 0..camera.samples {
                    pixel.look(&coverage, column, row, scratch)?;
                    line.row_start.push(line.row.len());
                    line.look(pixel, &seen);
                    let rect = pixel.rect;
                    let send = |e: &Entry, area: f64, lit: f64, weights: &mut Weights| {
                        let [x, y] = e.centroid(&rect);
                        let add = |row, weight| weights.add(row, weight);
                        emission.towards(e.facet, -camera.ray(x, y), area, lit, add);
                    };
                    pixel.sort_fragments();
                    if let Some(looker) = looker {
                        looker.look(pixel, &mut line.maps, |e, area, lit| send(e, area, lit, weights));
                    }
                    if maps.is_none_or(|maps| maps.adds_solved) {
                        for index in 0..pixel.entries.len() {
                            let e = pixel.entries[index];
                            let material = scene.body.mesh.material[e.facet as usize].0 as usize;
                            if e.front && textures.has(material) {
                                textures.send(pixel, index, material, &emission, |row, w| weights.add(row, w));
                            } else if e.front {
                                send(&e, e.area, e.lit, weights);
                            }
                        }
                    }
                    line.take(weights);
                    planes.add(pixel, column, row, &mut part);
                }
                tell(watch, "image", done.fetch_add(1, Relaxed) + 1, u64::from(camera.lines))?;
                Ok(line)
            },
        )
        .collect();
    drop(coverage);
    let mut lines = lines?;
    let mut backplanes = planes.name(values, samples, rows);
    let maps = maps.map(|maps| {
        let mut image = MapImage::new(maps);
        let mut planes: [Vec<f64>; 2] = Default::default();
        for line in lines.iter_mut().map(|line| std::mem::take(&mut line.maps)) {
            planes[0].extend(&line.coverage);
            planes[1].extend(&line.angle_deg);
            image.append(line);
        }
        let named = MAP_PLANES.iter().zip(planes).map(|((name, unit), values)| Plane {
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            values,
        });
        backplanes.planes.extend(named);
        image
    });
    Ok(Image {
        back_area_px: lines.iter().map(|l| l.back_area_px).sum(),
        excess_px: lines.iter().map(|l| l.excess_px).fold(0.0, f64::max),
        cube: assemble(scene, &emission, lines),
        backplanes,
        seen: seen.into_iter().map(AtomicBool::into_inner).collect(),
        maps,
    })
}

impl Line {
    /// Notes what a pixel sees.
    fn look(&mut self, pixel: &Pixel, seen: &[AtomicBool]) {
        let mut area = 0.0;
        for e in &pixel.entries {
            area += e.area;
            seen[e.facet as usize].store(true, Relaxed);
            if !e.front {
                self.back_area_px += e.area;
            }
        }
        self.excess_px = self.excess_px.max(area - 1.0);
    }

    /// Takes over a pixel's weights.
    fn take(&mut self, weights: &mut Weights) {
        weights.drain(|row, weight| {
            self.row.push(row);
            self.weight.push(weight);
        });
    }
}

/// Weights of a pixel, by row.
struct Weights {
    value: Vec<f64>,
    used: Vec<u32>,
}

impl Weights {
    fn new(rows: usize) -> Self {
        Weights { value: vec![0.0; rows], used: vec![] }
    }

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

fn assemble(scene: &Scene, emission: &Emission, lines: Vec<Line>) -> Cube {
    let camera = &scene.exposure.camera;
    let entries = lines.iter().map(|l| l.row.len()).sum();
    let mut cube = Cube {
        samples: camera.samples as usize,
        lines: camera.lines as usize,
        bands: scene.exposure.bands.clone(),
        row_start: Vec::with_capacity(camera.samples as usize * camera.lines as usize + 1),
        row: Vec::with_capacity(entries),
        weight: Vec::with_capacity(entries),
        spectra: emission.spectra(),
        first_thermal_row: emission.first_thermal_row() as u32,
        added: vec![],
    };
    for line in lines {
        let base = cube.row.len();
        cube.row_start.extend(line.row_start.iter().map(|s| base + s));
        cube.row.extend(line.row);
        cube.weight.extend(line.weight);
    }
    cube.row_start.push(cube.row.len());
    cube
}
