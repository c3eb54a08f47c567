//! Scene and facet table to images: what each pixel sees, exactly.
//!
//! One pass (`sweep.rs`) over the image finds a pixel's entries (facet, area, lit areas), and, on request, the signed pieces they are made
//! of. What is made of them are gatherers: weights of spectra, backplanes, footprints, texels of maps, a census. None looks for itself.

mod backplanes;
mod census;
mod detector;
mod footprints;
mod globes;
mod ground;
mod lit_area;
mod maps;
mod parts;
mod pieces;
mod pixel;
mod radiance;
mod split;
mod sweep;
mod textures;
mod weights;

use crate::error::Result;
use crate::geometry::SphereImage;
use crate::product::{Backplanes, FacetTable, Footprints, Slab};
use crate::progress::{Watch, tell};
use crate::scene::Scene;
use crate::solve::Emission;

use backplanes::Planes;
use census::{Census, CensusLine};
use globes::Globes;
use lit_area::LitArea;
use maps::{MapLine, PixelTexels};
use parts::Polygons;
use pixel::Pixel;
use weights::{WeightLine, Weights};

pub use backplanes::plane_count;
pub use footprints::{GlobesShown, footprints, footprints_among_globes};
pub use ground::{GroundPiece, ground_pieces};
pub use maps::{MapImage, MapView, Maps, Unknown, ViewChoice, meets, seen_by_eye, texels_seen};
pub use radiance::radiance;

/// What a camera sees.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Radiance: all of it, under one sky.
    pub slab: Slab,
    /// Images of geometry.
    pub backplanes: Backplanes,
    /// Which facets each pixel sees, if that is wanted.
    pub footprints: Option<Footprints>,
    /// For each facet whether some pixel sees it.
    pub seen: Vec<bool>,
    /// Area that shows the inner side of a facet, pixels.
    pub back_area_px: f64,
    /// Largest amount by which the areas in a pixel exceed the pixel, pixels: rounding.
    pub excess_px: f64,
    /// What of the pixels the texels of maps fill, if there are maps.
    pub maps: Option<MapImage>,
}

/// What is wanted of an image besides its radiance and its backplanes.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted<'m> {
    /// Its radiance is that of maps. The slab holds what is solved where they know nothing, or everywhere, if that is asked for; their
    /// own radiance is to be added band by band, by the weights of their texels.
    pub maps: Option<&'m Maps<'m>>,
    /// Which facets each pixel sees.
    pub footprints: bool,
    /// Radiance alone: no backplanes.
    pub radiance_alone: bool,
    /// Of a filter that takes one band after the other: bands, from 0, whose exposures have backplanes of their own.
    pub planes_of: &'m [usize],
}

/// What a line of the image comes to.
#[derive(Default)]
struct Gathered {
    census: CensusLine,
    weights: WeightLine,
    maps: MapLine,
    footprints: Footprints,
}

/// Looks at a scene.
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported), as [`Setup::simulable`](crate::scene::Setup::simulable) says;
/// [`Error::Invalid`](crate::Error::Invalid) if the table is not of this scene;
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn integrate(scene: &Scene, table: &FacetTable, wanted: Wanted<'_>, watch: Watch<'_>) -> Result<Image> {
    scene.simulable()?;
    table.fits(scene)?;
    let (camera, mesh) = (&scene.exposure.camera, &scene.body.mesh);
    let topology = scene.body.topology_watched(watch)?;
    let views = wanted.maps.map_or(&[][..], |maps| &maps.terms);
    let map_polygons: Vec<Vec<_>> =
        views.iter().map(|views| views.iter().map(|view| view.polygons(mesh.facets.len())).collect()).collect();
    tell(watch, "image", 0, 1)?;
    let (drawing, detector) = detector::draw(mesh, topology, scene.body.bounds_m(), camera);
    // Of each source that is known by parts: the Sun first.
    let lit: Vec<_> = table.sources.iter().filter_map(|lighting| lighting.seen()).collect();
    let lit_polygons: Vec<Polygons> = lit.iter().map(|seen| Polygons::of_seen(seen)).collect();
    let lights = || lit.iter().zip(&lit_polygons).map(|(seen, polygons)| LitArea::new(&drawing, seen, polygons));
    let emission = Emission::new(scene, table);
    let globes_in_view: Vec<SphereImage> = scene.globes_in_view().into_iter().map(|(_, seen)| seen).collect();
    let planes = Planes::new(scene);
    let census = Census::new(mesh.facets.len());
    let (samples, rows) = (camera.samples as usize, camera.lines as usize);
    // Each plane asks for zeroed memory of its own: a clone would write it.
    let plane_count = if wanted.radiance_alone { 0 } else { planes.count() };
    let mut values: Vec<Vec<f64>> = (0..plane_count).map(|_| vec![0.0; samples * rows]).collect();
    // Each line of the image writes its own part of every plane.
    let mut parts: Vec<Vec<&mut [f64]>> = std::iter::repeat_with(Vec::new).take(rows).collect();
    for plane in &mut values {
        plane.chunks_mut(samples).zip(&mut parts).for_each(|(chunk, part)| part.push(chunk));
    }
    let start = || {
        let mut pixel = Pixel::new(&drawing, lights().collect());
        pixel.globes = Globes::new(mesh, &globes_in_view);
        pixel.wants_moments = emission.wants_moments();
        pixel.wants_centre = !wanted.radiance_alone;
        pixel.pieces.are_kept = wanted.maps.is_some() || !scene.body.textures.is_empty();
        let map_texels = wanted.maps.map(|maps| PixelTexels::new(scene, &drawing, maps, &map_polygons));
        (pixel, Weights::new(scene, &drawing, &emission), map_texels)
    };
    let look = |(pixel, weights, map_texels): &mut (Pixel, Weights, Option<PixelTexels>),
                line: &mut sweep::Line,
                mut planes_part: Vec<&mut [f64]>| {
        let (mut gathered, rows) = (Gathered::default(), line.pixels.rows);
        weights.new_line(rows);
        if let Some(map_texels) = map_texels {
            gathered.maps = map_texels.new_line(rows);
        }
        let varies = |pixel: &Pixel| pixel.wants_moments && weights::varies(&emission, pixel);
        line.each(pixel, varies, |pixel| {
            census.gather(pixel, &mut gathered.census);
            pixel.sort_pieces();
            if let Some(map_texels) = map_texels {
                map_texels.gather(pixel, &mut gathered.maps, |entry, area, lit| weights.add(entry, area, lit));
            }
            if wanted.maps.is_none_or(|maps| maps.adds_solved) {
                weights.gather(pixel);
            }
            weights.gather_globes(pixel);
            weights.end(&mut gathered.weights);
            if !wanted.radiance_alone {
                planes.gather(pixel, &mut planes_part);
            }
            if wanted.footprints {
                footprints::gather(pixel, &mut gathered.footprints);
            }
        })?;
        Ok(gathered)
    };
    let mut lines = sweep::sweep((&drawing, &detector), parts, ("image", watch), start, look)?;
    let mut backplanes = match wanted.radiance_alone {
        true => Backplanes::default(),
        false => planes.name(values, samples, rows),
    };
    let maps = wanted.maps.map(|maps| {
        let (image, planes) = maps::join(maps, lines.iter_mut().map(|line| std::mem::take(&mut line.maps)));
        backplanes.planes.extend(planes);
        image
    });
    let taken = lines.iter_mut().map(|line| std::mem::take(&mut line.footprints));
    let footprints = wanted.footprints.then(|| footprints::join(taken));
    let back_area_px = lines.iter().map(|line| line.census.back_area_px).sum();
    let excess_px = lines.iter().map(|line| line.census.excess_px).fold(0.0, f64::max);
    let slab = weights::slab(scene, &emission, lines.into_iter().map(|line| line.weights).collect());
    Ok(Image { back_area_px, excess_px, slab, backplanes, footprints, seen: census.into_seen(), maps })
}
