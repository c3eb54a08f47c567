//! Which facets each pixel sees, as a product.

use super::detector::draw;
use super::lit_area::LitArea;
use super::parts::Polygons;
use super::pixel::Pixel;
use super::sweep::{Line, sweep};
use crate::geometry::{FrameCamera, Mesh};
use crate::product::Footprints;
use crate::progress::unwatched;
use crate::visibility::{Seen, Topology};

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
    let drawing = draw(mesh, topology, mesh.bounds_m(), camera);
    let polygons = Polygons::of_seen(sunlit);
    let start = || Pixel::new(&drawing, vec![LitArea::new(&drawing, sunlit, &polygons)]);
    let look = |pixel: &mut Pixel, line: &mut Line, ()| {
        let mut footprints = Footprints::default();
        line.each(pixel, |_| false, |pixel| gather(pixel, &mut footprints))?;
        Ok(footprints)
    };
    let parts = vec![(); camera.lines as usize];
    // Nothing asks to stop.
    let lines = sweep(&drawing, parts, ("footprints", &unwatched), start, look).unwrap_or_default();
    join(lines.into_iter())
}
