//! Which facets each pixel sees, as a product.

use super::detector::{Detector, draw};
use super::globes::Globes;
use super::lit_area::LitArea;
use super::parts::Polygons;
use super::pixel::Pixel;
use super::sweep::{Line, sweep};
use crate::geometry::{FrameCamera, Mesh, SphereImage, SphereShown};
use crate::product::Footprints;
use crate::progress::unwatched;
use crate::scene::Scene;
use crate::visibility::{Drawing, Seen, Topology};

/// Adds what a pixel sees.
pub(super) fn gather(pixel: &Pixel, line: &mut Footprints) {
    line.row_start.push(line.facet.len());
    for e in &pixel.entries {
        line.facet.push(e.facet);
        line.fraction.push(e.shown.area);
        line.lit_fraction.push(e.lit.area);
    }
}

/// All lines together.
pub(super) fn join(lines: impl Iterator<Item = Footprints>) -> Footprints {
    let mut all = Footprints::default();
    for line in lines {
        let base = all.facet.len();
        all.row_start.extend(line.row_start.iter().map(|s| base + s));
        all.facet.extend(line.facet);
        all.fraction.extend(line.fraction);
        all.lit_fraction.extend(line.lit_fraction);
    }
    all.row_start.push(all.facet.len());
    all
}

/// The facets that each pixel sees and the share of them that is lit: exact area fractions.
pub fn footprints(mesh: &Mesh, topology: &Topology, sunlit: &Seen, camera: &FrameCamera) -> Footprints {
    let (drawing, detector) = draw(mesh, topology, mesh.bounds_m(), camera);
    seen((&drawing, &detector), sunlit, &[]).0
}

/// What a pixel shows of bodies of the sky, by their places among those in view.
pub type GlobesShown = Vec<(usize, SphereShown)>;

/// The same of a scene with bodies of the sky, and what each pixel shows of these.
pub fn footprints_among_globes(scene: &Scene, sunlit: &Seen) -> (Footprints, Vec<GlobesShown>) {
    let camera = &scene.exposure.camera;
    let (drawing, detector) = draw(&scene.body.mesh, scene.body.topology(), scene.body.bounds_m(), camera);
    let globes: Vec<SphereImage> = scene.globes_in_view().into_iter().map(|(_, seen)| seen).collect();
    seen((&drawing, &detector), sunlit, &globes)
}

fn seen(
    (drawing, detector): (&Drawing, &Detector),
    sunlit: &Seen,
    globes: &[SphereImage],
) -> (Footprints, Vec<GlobesShown>) {
    let polygons = Polygons::of_seen(sunlit);
    let start = || {
        let mut pixel = Pixel::new(drawing, vec![LitArea::new(drawing, sunlit, &polygons)]);
        pixel.globes = Globes::new(drawing.mesh(), globes);
        pixel
    };
    let look = |pixel: &mut Pixel, line: &mut Line, ()| {
        let (mut footprints, mut shown) = (Footprints::default(), Vec::new());
        line.each(
            pixel,
            |_| false,
            |pixel| {
                gather(pixel, &mut footprints);
                shown.push(pixel.globes.shown().to_vec());
            },
        )?;
        Ok((footprints, shown))
    };
    let parts = vec![(); detector.size[1] as usize];
    // Nothing asks to stop.
    let lines = sweep((drawing, detector), parts, ("footprints", &unwatched), start, look).unwrap_or_default();
    let (footprints, shown): (Vec<Footprints>, Vec<Vec<GlobesShown>>) = lines.into_iter().unzip();
    (join(footprints.into_iter()), shown.concat())
}
