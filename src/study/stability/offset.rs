//! A mesh far from the origin of its coordinates.

use glam::DVec3;

use super::scenes::{camera, cuboid, exact, ground, in_single, joined, scene, sun, worst};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::geometry::Mesh;

/// Generic directions: along an axis rounding might be kinder.
const ALONG: DVec3 = DVec3::new(0.48, 0.6, 0.64);

pub(super) fn hazard() -> Result<Hazard> {
    let site = || joined([ground(20.0, 0), cuboid(DVec3::new(-3.1, -2.3, 0.0), DVec3::new(1.7, 2.9, 4.3), 1)]);
    let image = |mesh: Mesh, at_m: DVec3| {
        let camera = camera(at_m + DVec3::new(30.0, -20.0, 90.0), at_m, DVec3::Y, 24, 0.4 / 24.0)?;
        exact(&scene(mesh, &[0.5, 1.0], sun(55.0, 200.0)?, camera)?)
    };
    let moved =
        |mesh: Mesh, by_m: DVec3| Mesh { vertices_m: mesh.vertices_m.iter().map(|v| *v + by_m).collect(), ..mesh };
    let truth = image(site(), DVec3::ZERO)?;
    let offsets: Vec<f64> = std::iter::once(0.0).chain((1..=12).map(|power| 10f64.powi(power))).collect();
    let sweep = |method, is_ours, then, of: &dyn Fn(f64) -> Result<Vec<f64>>| -> Result<Sweep> {
        let mut points = Vec::new();
        for at in &offsets {
            // What a scene's check refuses has no image.
            let error = of(*at).map_or(f64::INFINITY, |image| worst(&image, &truth));
            points.push(Point { at: *at, error });
        }
        Ok(Sweep { method, is_ours, then, points })
    };
    Ok(Hazard {
        name: "mesh far from the origin",
        parameter: "offset, m",
        truth: "A box on ground of 40 m, 24 x 24 pixels, against the same at the origin; error is the largest of a pixel over the brightest.",
        sweeps: vec![
            sweep(
                "local coordinates, offset in `origin_m`",
                true,
                "The offset does not enter: a mesh in body coordinates is read in f64, and its origin taken off.",
                &|_| image(site(), DVec3::ZERO),
            )?,
            sweep(
                "offset in the coordinates, f64",
                false,
                "Coordinates are 2.2e-16 of the offset apart: corners move by that before anything is computed.",
                &|at| image(moved(site(), at * ALONG), at * ALONG),
            )?,
            sweep(
                "offset in the coordinates, f32",
                false,
                "On Phobos (12 km) a step is 1 mm, at Mars's centre (9400 km) 1 m; farther out the site is one point.",
                &|at| image(in_single(&moved(site(), at * ALONG)), at * ALONG),
            )?,
        ],
    })
}
