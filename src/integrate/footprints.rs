//! Which facets each pixel sees, as a product.

use std::sync::atomic::AtomicU64;

use rayon::prelude::*;

use super::lit::LitArea;
use super::parts::Polygons;
use super::pixel::Pixel;
use crate::error::Result;
use crate::geometry::Mesh;
use crate::product::Footprints;
use crate::progress::{Pulse, unwatched};
use crate::scene::FrameCamera;
use crate::visibility::Seen;
use crate::visibility::{Coverage, Drawing, Grid, Scratch, Topology, View};

/// The drawing of a mesh in a camera.
pub(super) fn draw<'a>(mesh: &'a Mesh, topology: &'a Topology, camera: &FrameCamera) -> Drawing<'a> {
    let axes = camera.world_from_sensor.rotation;
    let axes = [axes.x_axis, axes.y_axis, axes.z_axis];
    let scale = camera.pitch.map(|pitch| 1.0 / pitch);
    let view = View::pinhole(mesh, camera.centre_m(), axes, scale, camera.boresight_px);
    Drawing::new(mesh, topology, view, Grid { columns: camera.samples, rows: camera.lines })
}

/// The facets that each pixel sees and the share of them that is lit: exact area fractions.
pub fn footprints(mesh: &Mesh, topology: &Topology, sunlit: &Seen, camera: &FrameCamera) -> Footprints {
    let drawing = draw(mesh, topology, camera);
    let coverage = Coverage::new(&drawing);
    let lit = Polygons::of_sunlit(sunlit);
    let done = AtomicU64::new(0);
    let pulse = || Pulse::new(&unwatched, "footprints", &done, u64::from(camera.lines));
    let lines: Result<Vec<Footprints>> = (0..camera.lines)
        .into_par_iter()
        .map_init(
            || (Scratch::new(pulse()), Pixel::new(&drawing, LitArea::new(&drawing, sunlit, &lit))),
            |(scratch, pixel), row| {
                let mut line = Footprints::default();
                pixel.new_line(row);
                for column in 0..camera.samples {
                    pixel.look(&coverage, column, row, scratch)?;
                    line.row_start.push(line.facet.len());
                    for e in &pixel.entries {
                        line.facet.push(e.facet);
                        line.fraction.push(e.area);
                        line.lit_fraction.push(e.lit);
                    }
                }
                Ok(line)
            },
        )
        .collect();
    let mut all = Footprints::default();
    // Nobody asks to stop.
    for line in lines.unwrap_or_default() {
        let base = all.facet.len();
        all.row_start.extend(line.row_start.iter().map(|s| base + s));
        all.facet.extend(line.facet);
        all.fraction.extend(line.fraction);
        all.lit_fraction.extend(line.lit_fraction);
    }
    all.row_start.push(all.facet.len());
    all
}
