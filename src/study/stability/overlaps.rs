//! Strips that overlap one another in a ring: none is the farthest.

use std::f64::consts::TAU;

use glam::DVec3;

use super::painter::painted_image;
use super::scenes::{above, by_rays, exact, joined, quad, scene, sun};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::geometry::Mesh;
use crate::study::chart::facing_the_sun;

const WIDTH_M: f64 = 1.0;
/// From the ring's centre to the middle of each strip, m.
const OUT_M: f64 = 3.0;

/// Strips along the sides of a polygon, each over the next one and under the one before; with two, one across the other. Each reflects another share.
fn ring(strips: u32) -> Mesh {
    if strips == 2 {
        let strip = |turn: f64, z: f64, material| {
            let (along, across) = (DVec3::new(turn.cos(), turn.sin(), 0.0), DVec3::new(-turn.sin(), turn.cos(), 0.0));
            let at = |s: f64, t: f64| s * along + t * across + z * DVec3::Z;
            quad([at(-4.0, -0.5), at(4.0, -0.5), at(4.0, 0.5), at(-4.0, 0.5)], material)
        };
        return joined([strip(0.2, 0.0, 0), strip(0.2 + 0.25 * TAU, 0.1, 1)]);
    }
    let strip = |k: u32| {
        let turn = 0.2 + TAU * f64::from(k) / f64::from(strips);
        let (out, along) = (DVec3::new(turn.cos(), turn.sin(), 0.0), DVec3::new(-turn.sin(), turn.cos(), 0.0));
        // Its ends reach past where the neighbours' middle lines are; it rises along its length.
        let reach = half_length_m(strips);
        let at = |s: f64, t: f64| OUT_M * out + s * along + t * out - 0.2 * s / reach * DVec3::Z;
        let half = 0.5 * WIDTH_M;
        quad([at(-reach, half), at(reach, half), at(reach, -half), at(-reach, -half)], material(k))
    };
    joined((0..strips).map(strip))
}

fn material(k: u32) -> u16 {
    u16::try_from(k % 4).unwrap_or(0)
}

/// Of a strip, m: to where it crosses its neighbour, and as wide as their crossing is long beyond.
fn half_length_m(strips: u32) -> f64 {
    let half_turn = 0.5 * TAU / f64::from(strips);
    OUT_M * half_turn.tan() + 1.2 * WIDTH_M / (2.0 * half_turn).sin()
}

const REFLECTANCES: [f64; 4] = [0.2, 0.6, 1.0, 0.4];

/// Sum of reflectance x area seen, m2: of each strip its area less one crossing.
fn truth_m2(strips: u32) -> f64 {
    if strips == 2 {
        return REFLECTANCES[0] * (8.0 - 1.0) + REFLECTANCES[1] * 8.0;
    }
    let crossing_m2 = WIDTH_M * WIDTH_M / (TAU / f64::from(strips)).sin();
    let area_m2 = 2.0 * half_length_m(strips) * WIDTH_M;
    (0..strips).map(|k| REFLECTANCES[material(k) as usize] * (area_m2 - crossing_m2)).sum()
}

pub(super) fn hazard() -> Result<Hazard> {
    let counts = [2, 3, 4];
    let sweep = |method, is_ours, then, of: &dyn Fn(&crate::scene::Scene) -> Result<Vec<f64>>| -> Result<Sweep> {
        let point = |strips: &u32| {
            let (width_m, pixels) = (16.0, 16);
            let scene = scene(ring(*strips), &REFLECTANCES, sun(0.0, 0.0)?, above(1e6, width_m, pixels)?)?;
            let pixel_m2 = (width_m / f64::from(pixels)).powi(2);
            // Strips are tilted, so darker by the cosine.
            let reach = half_length_m((*strips).max(3));
            let cos = if *strips == 2 { 1.0 } else { 1.0 / 1f64.hypot(0.2 / reach) };
            // From 1000 km a strip 0.2 m higher is 4e-7 larger.
            let seen_m2 = of(&scene)?.iter().sum::<f64>() * pixel_m2 / cos;
            Ok(Point { at: f64::from(*strips), error: (seen_m2 / truth_m2(*strips) - 1.0).abs() })
        };
        Ok(Sweep { method, is_ours, then, points: counts.iter().map(point).collect::<Result<_>>()? })
    };
    Ok(Hazard {
        name: "overlaps in a ring",
        parameter: "strips that overlap in turn (2: in order)",
        truth: "Strips of different reflectances along the sides of a polygon, each over the next: of each its area less one crossing is seen; error of the sum.",
        sweeps: vec![
            sweep(
                "exact",
                true,
                "Pieces are compared where they overlap; whole facets are never put in order.",
                &exact,
            )?,
            sweep(
                "64 rays per pixel",
                false,
                "Each ray finds the nearest facet by itself: noise of sampling.",
                &|scene| by_rays(scene, 64),
            )?,
            sweep(
                "painter's algorithm",
                false,
                "Two facets are put in the right order; in a ring there is none, and whichever is painted last covers too much.",
                &|scene| {
                    // Shadows fall where nothing is seen: the Sun is where the camera is.
                    Ok(painted_image(scene, &facing_the_sun(scene), &REFLECTANCES))
                },
            )?,
        ],
    })
}
