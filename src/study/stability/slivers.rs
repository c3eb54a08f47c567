//! Facets that are much longer than wide.

use glam::{DMat3, DVec3};

use super::scenes::{above, by_rays, exact, in_single, mesh, scene, sun, worst};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::geometry::Mesh;

/// A square of 8 m on a tilt, with a strip of eight slivers across it, of length 8 m and width 8 m / aspect each; no corner is a round number.
fn square(aspect: f64) -> Mesh {
    const STRIPS: u32 = 8;
    let width = 8.0 / aspect;
    let heights: Vec<f64> = std::iter::once(-4.0)
        .chain((0..=STRIPS).map(|i| 0.137 + (f64::from(i) - 4.0) * width))
        .chain([4.0])
        .map(|y: f64| y.clamp(-4.0, 4.0))
        .collect();
    let tilt = DMat3::from_rotation_z(0.61) * DMat3::from_rotation_x(0.23) * DMat3::from_rotation_y(-0.17);
    let corners: Vec<DVec3> = heights.iter().flat_map(|y| [-4.0, 4.0].map(|x| tilt * DVec3::new(x, *y, 0.0))).collect();
    let facets: Vec<[u32; 3]> = (0..STRIPS + 2)
        .flat_map(|i| {
            let a = 2 * i;
            [[a, a + 1, a + 3], [a, a + 3, a + 2]]
        })
        .collect();
    mesh(&corners, &facets, 0)
}

pub(super) fn hazard() -> Result<Hazard> {
    let scene_of = |mesh: Mesh| scene(mesh, &[1.0], sun(40.0, 70.0)?, above(500.0, 10.0, 16)?);
    let truth = {
        let whole = square(4.0);
        exact(&scene_of(Mesh {
            facets: vec![[0, 1, 21], [0, 21, 20]],
            material: whole.material[..2].to_vec(),
            ..whole
        })?)?
    };
    let aspects: Vec<f64> = (0..=12).map(|power| 10f64.powi(power)).collect();
    let sweep = |method, is_ours, then, of: &dyn Fn(Mesh) -> Result<Vec<f64>>| -> Result<Sweep> {
        let point = |at: &f64| Ok(Point { at: *at, error: worst(&of(square(at.max(10.0)))?, &truth) });
        Ok(Sweep { method, is_ours, then, points: aspects.iter().map(point).collect::<Result<_>>()? })
    };
    Ok(Hazard {
        name: "slivers",
        parameter: "length of a facet over its width",
        truth: "A tilted square with eight slivers across it looks like the same square of two facets; error is the largest of a pixel, over the brightest.",
        sweeps: vec![
            sweep(
                "exact",
                true,
                "A facet that is too thin for a normal is too thin to be seen: areas stay whole, and each keeps the radiance of its own corners.",
                &|mesh| exact(&scene_of(mesh)?),
            )?,
            sweep("64 rays per pixel", false, "Noise at the square's rim; slivers are rarely hit.", &|mesh| {
                by_rays(&scene_of(mesh)?, 64)
            })?,
            sweep(
                "exact, corners in f32",
                false,
                "Rounded corners turn a sliver's normal at random: where it is as wide as rounding its radiance means nothing.",
                &|mesh| exact(&scene_of(in_single(&mesh))?),
            )?,
        ],
    })
}
