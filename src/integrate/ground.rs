//! Where on the ground a pixel's parts lie: the polygons of what it sees, carried from the image onto their facets.

use glam::DVec3;

use super::detector::draw;
use super::globes::Globes;
use super::pixel::Pixel;
use super::sweep::{Line, sweep};
use crate::error::Result;
use crate::geometry::SphereImage;
use crate::progress::Watch;
use crate::scene::Scene;
use crate::visibility::OnFacet;

/// A convex part of a facet's outer side that a pixel sees.
#[derive(Debug, Clone, Copy)]
pub struct GroundPiece<'p> {
    /// The pixel's sample, from 0.
    pub sample: u32,
    /// Its line.
    pub line: u32,
    /// 1; or -1: it is taken away again from what came before.
    pub sign: f64,
    /// Its outline, local, m.
    pub outline_m: &'p [DVec3],
}

/// Hands out what each pixel of an image sees of the ground; `start` makes what is gathered of a line.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn ground_pieces<T: Send>(
    scene: &Scene,
    watch: Watch<'_>,
    start: impl Fn() -> T + Sync + Send,
    put: impl Fn(&mut T, GroundPiece<'_>) + Sync + Send,
) -> Result<Vec<T>> {
    let (camera, mesh) = (&scene.exposure.camera, &scene.body.mesh);
    let (drawing, detector) = draw(mesh, scene.body.topology_watched(watch)?, scene.body.bounds_m(), camera);
    let globes: Vec<SphereImage> = scene.globes_in_view().into_iter().map(|(_, seen)| seen).collect();
    let pixel = || {
        let mut pixel = Pixel::new(&drawing, vec![]);
        pixel.globes = Globes::new(mesh, &globes);
        pixel.pieces.are_kept = true;
        (pixel, Vec::new())
    };
    let look = |(pixel, outline_m): &mut (Pixel, Vec<DVec3>), line: &mut Line, row: u32| {
        let mut gathered = start();
        line.each(
            pixel,
            |_| false,
            |pixel| {
                pixel.sort_pieces();
                for k in (0..pixel.entries.len()).flat_map(|entry| pixel.pieces.of(entry)) {
                    let (facet, sign, outline) = pixel.pieces.get(k);
                    let of_mesh = mesh.facet(facet as usize);
                    let on_facet = OnFacet::new(&drawing.view, &of_mesh);
                    outline_m.clear();
                    outline_m.extend(outline.iter().map(|point| {
                        let [u, v] = on_facet.uv(*point);
                        of_mesh.point_m(u, v)
                    }));
                    put(&mut gathered, GroundPiece { sample: pixel.site.sample, line: row, sign, outline_m });
                }
            },
        )?;
        Ok(gathered)
    };
    sweep((&drawing, &detector), (0..camera.lines).collect(), ("ground", watch), pixel, look)
}
