//! A corner of some facets on, or beside, an edge of another.

use glam::{DMat3, DVec3};

use super::scenes::{above, by_rays, exact, in_single, mesh, scene, sun};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::geometry::Mesh;

/// A square of which the western half has one edge along the seam, and the eastern half seven corners on it, moved off by `gap_m`.
fn square(gap_m: f64) -> Mesh {
    const CORNERS: u32 = 7;
    let tilt = DMat3::from_rotation_z(0.53) * DMat3::from_rotation_x(0.19);
    let mut corners = vec![(-4.0, -4.0), (0.0, -4.0), (0.0, 4.0), (-4.0, 4.0), (4.0, -4.0), (4.0, 4.0)];
    corners.extend((1..=CORNERS).map(|i| (gap_m, -4.0 + 8.0 * f64::from(i) / f64::from(CORNERS + 1))));
    let corners: Vec<DVec3> = corners.into_iter().map(|(x, y)| tilt * DVec3::new(x, y, 0.0)).collect();
    let mut facets = vec![[0, 1, 2], [0, 2, 3]];
    // A fan from the eastern side's lower corner, and the rest above.
    let seam: Vec<u32> = std::iter::once(1).chain((0..CORNERS).map(|i| 6 + i)).chain([2]).collect();
    facets.extend(seam.windows(2).map(|w| [4, w[1], w[0]]));
    facets.push([4, 5, 2]);
    mesh(&corners, &facets, 0)
}

pub(super) fn hazard() -> Result<Hazard> {
    let scene_of = |mesh: Mesh| scene(mesh, &[1.0], sun(20.0, 140.0)?, above(1e6, 4.0, 12)?);
    let whole = exact(&scene_of(mesh(&square(0.0).vertices_m[..6], &[[0, 4, 5], [0, 5, 3]], 0))?)?;
    let total: f64 = whole.iter().sum();
    let gaps: Vec<f64> = std::iter::once(0.0).chain((2..=16).rev().map(|power| 10f64.powi(-power))).collect();
    let pixel_m2 = (4.0_f64 / 12.0).powi(2);
    let sweep = |method, is_ours, then, of: &dyn Fn(Mesh) -> Result<Vec<f64>>| -> Result<Sweep> {
        let point = |gap: &f64| {
            let image = of(square(*gap))?;
            // What the hole takes: it reaches from the lower to the upper end of the image, 4 m, and is gap / cos(turn) wide along lines.
            let hole = gap * 4.0 / 0.53f64.cos() / pixel_m2;
            let brightest = whole.iter().copied().fold(0.0, f64::max);
            let missing = (total - image.iter().sum::<f64>()) / brightest;
            Ok(Point { at: *gap, error: (missing - hole).abs() / image.len() as f64 })
        };
        Ok(Sweep { method, is_ours, then, points: gaps.iter().map(point).collect::<Result<_>>()? })
    };
    Ok(Hazard {
        name: "T-junctions",
        parameter: "corners beside an edge by, m",
        truth: "A tilted square whose halves meet along a seam with corners on one side only. A gap is a hole of its own area, and what rounding opens is none; \
                error of the mean radiance.",
        sweeps: vec![
            sweep("exact", true, "A gap is seen as wide as it is; rounding opens 1e-16 of the drawing.", &|mesh| {
                exact(&scene_of(mesh)?)
            })?,
            sweep(
                "64 rays per pixel",
                false,
                "Gaps thinner than rays are apart are missed or hit by chance.",
                &|mesh| by_rays(&scene_of(mesh)?, 64),
            )?,
            sweep(
                "exact, corners in f32",
                false,
                "Rounded corners open gaps and overlaps of 1e-7 of the size.",
                &|mesh| exact(&scene_of(in_single(&mesh))?),
            )?,
        ],
    })
}
