//! The radiance of an image alone: what it costs without backplanes.

use super::detector::draw;
use super::globes::Globes;
use super::lit_area::LitArea;
use super::parts::Polygons;
use super::pixel::Pixel;
use super::sweep::{Line, sweep};
use super::weights::{self, WeightLine, Weights};
use crate::error::Result;
use crate::geometry::SphereImage;
use crate::product::{FacetTable, Slab};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::solve::Emission;

/// The slab of [`integrate`](super::integrate), and nothing else.
///
/// # Errors
/// As [`integrate`](super::integrate).
pub fn radiance(scene: &Scene, table: &FacetTable, watch: Watch<'_>) -> Result<Slab> {
    scene.simulable()?;
    table.fits(scene)?;
    let (camera, mesh) = (&scene.exposure.camera, &scene.body.mesh);
    let (drawing, detector) = draw(mesh, scene.body.topology_watched(watch)?, scene.body.bounds_m(), camera);
    let lit: Vec<_> = table.sources.iter().filter_map(|lighting| lighting.seen()).collect();
    let polygons: Vec<Polygons> = lit.iter().map(|seen| Polygons::of_seen(seen)).collect();
    let emission = Emission::new(scene, table);
    let globes_in_view: Vec<SphereImage> = scene.globes_in_view().into_iter().map(|(_, seen)| seen).collect();
    let start = || {
        let lights = lit.iter().zip(&polygons).map(|(seen, polygons)| LitArea::new(&drawing, seen, polygons));
        let mut pixel = Pixel::new(&drawing, lights.collect());
        pixel.globes = Globes::new(mesh, &globes_in_view);
        pixel.wants_moments = emission.wants_moments();
        pixel.pieces.are_kept = !scene.body.textures.is_empty();
        (pixel, Weights::new(scene, &drawing, &emission))
    };
    let look = |(pixel, weights): &mut (Pixel, Weights), line: &mut Line, ()| {
        let mut gathered = WeightLine::default();
        weights.new_line(line.pixels.rows);
        let varies = |pixel: &Pixel| pixel.wants_moments && weights::varies(&emission, pixel);
        line.each(pixel, varies, |pixel| {
            pixel.sort_pieces();
            weights.gather(pixel);
            weights.gather_globes(pixel);
            weights.end(&mut gathered);
        })?;
        Ok(gathered)
    };
    let lines = sweep((&drawing, &detector), vec![(); camera.lines as usize], ("image", watch), start, look)?;
    Ok(weights::slab(scene, &emission, lines))
}
