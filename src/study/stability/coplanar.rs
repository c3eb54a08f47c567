//! Facets that lie close above one another, and facets that cross.

use glam::{DMat3, DVec3};

use super::painter::painted_image;
use super::scenes::{above, by_rays, exact, in_single, joined, quad, scene, sun, worst};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::geometry::Mesh;
use crate::scene::Scene;
use crate::study::chart::facing_the_sun;

/// A square of 8 m, tilted, at a height above its like along the normal; no corner is a round number.
fn square(height_m: f64, half_m: f64, material: u16) -> Mesh {
    let tilt = DMat3::from_rotation_z(0.4) * DMat3::from_rotation_x(0.21);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    quad(corners.map(|(x, y)| tilt * DVec3::new(half_m * x + 0.013, half_m * y - 0.029, height_m)), material)
}

/// A bright sheet just above a dark one.
pub(super) fn gap() -> Result<Hazard> {
    let (dark, bright) = (0.1, 1.0);
    // The lower material wins ties: the bright sheet has the higher one, so that a tie shows.
    let scene_of = |mesh: Mesh| scene(mesh, &[dark, bright], sun(35.0, 10.0)?, above(1000.0, 5.0, 16)?);
    let gaps: Vec<f64> = (0..=16).map(|power| 10f64.powi(-power)).collect();
    let sheets = |gap_m: f64| joined([square(0.0, 6.0, 0), square(gap_m, 4.0, 1)]);
    // The gap moves the bright sheet in the image, which is the gap itself, not an error: the true image is drawn at the same gap.
    let truth_at = |gap_m: f64| exact(&scene_of(square(gap_m, 4.0, 1))?);
    let sweep = |method, is_ours, then, of: &dyn Fn(f64) -> Result<Vec<f64>>| -> Result<Sweep> {
        let point = |at: &f64| Ok(Point { at: *at, error: worst(&of(*at)?, &truth_at(*at)?) });
        Ok(Sweep { method, is_ours, then, points: gaps.iter().map(point).collect::<Result<_>>()? })
    };
    Ok(Hazard {
        name: "one sheet close above another",
        parameter: "gap, m",
        truth: "A bright square of 8 m lies above a dark one, seen from 1 km: only the bright one is seen; error of the worst pixel.",
        sweeps: vec![
            sweep(
                "exact",
                true,
                "Told apart as they lie in space down to the rounding of their corners; below that they are one plane, and the rule for ties decides: the lower material.",
                &|gap| exact(&scene_of(sheets(gap))?),
            )?,
            sweep(
                "64 rays per pixel",
                false,
                "Depths along a ray of 1 km have steps of 1e-13 m: below, pixels are a mixture.",
                &|gap| by_rays(&scene_of(sheets(gap))?, 64),
            )?,
            sweep("exact, corners in f32", false, "Corners are rounded to 5e-7 m: sheets cross at random.", &|gap| {
                exact(&scene_of(in_single(&sheets(gap)))?)
            })?,
            sweep(
                "painter's algorithm",
                false,
                "Facets are as far as their centroids: a larger sheet below may be painted last.",
                &|gap| {
                    let scene = scene_of(sheets(gap))?;
                    Ok(painted_image(&scene, &facing_the_sun(&scene), &[dark, bright]))
                },
            )?,
        ],
    })
}

/// Two squares that cross along a line: each shows half.
pub(super) fn crossing() -> Result<Hazard> {
    let (dark, bright) = (0.1, 1.0);
    let scene_of = |mesh: Mesh| scene(mesh, &[dark, bright], sun(0.0, 0.0)?, above(1e6, 6.0, 8)?);
    // Two sheets that rise to the east and to the west by the same angle: seen from above, the dark one is on top in the west.
    let leaning = |angle_rad: f64, material: u16| {
        let at = |x: f64, y: f64| DVec3::new(x, y, x * angle_rad.tan());
        quad([at(-4.0, -4.0), at(4.0, -4.0), at(4.0, 4.0), at(-4.0, 4.0)], material)
    };
    let angles: Vec<f64> = [45.0, 10.0, 1.0].into_iter().chain((1..=12).map(|power| 10f64.powi(-power))).collect();
    let sheets = |deg: f64| joined([leaning(-deg.to_radians(), 0), leaning(deg.to_radians(), 1)]);
    let sweep = |method, is_ours, then, of: &dyn Fn(Scene) -> Result<Vec<f64>>| -> Result<Sweep> {
        let point = |at: &f64| {
            let half = |pixel: usize| if pixel % 8 < 4 { dark } else { bright };
            let truth: Vec<f64> = (0..64).map(|pixel| half(pixel) * at.to_radians().cos()).collect();
            Ok(Point { at: *at, error: worst(&of(scene_of(sheets(*at))?)?, &truth) })
        };
        Ok(Sweep { method, is_ours, then, points: angles.iter().map(point).collect::<Result<_>>()? })
    };
    Ok(Hazard {
        name: "sheets that cross",
        parameter: "angle of each, deg",
        truth: "A dark and a bright sheet lean by the same angle to either side and cross in the middle of 8 x 8 pixels: one half of them is dark, one bright. Worst pixel.",
        sweeps: vec![
            sweep(
                "exact",
                true,
                "The line where both are as near cuts them; nothing is special about small angles until they are one plane.",
                &|scene| exact(&scene),
            )?,
            sweep(
                "16 rays per pixel",
                false,
                "The line lies between pixels, so rays are right, until depths along them have no digits left.",
                &|scene| by_rays(&scene, 16),
            )?,
            sweep(
                "painter's algorithm",
                false,
                "A facet that crosses another has no order: one is painted over the other.",
                &|scene| Ok(painted_image(&scene, &facing_the_sun(&scene), &[dark, bright])),
            )?,
        ],
    })
}
