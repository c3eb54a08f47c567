//! A Sun that sinks to the horizon.

use glam::DVec3;
use rayon::prelude::*;

use super::painter::painted_sunlight;
use super::scenes::{above, by_rays, cells, cuboid, facets, joined, lit_by, scene, sun};
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::study::chart::lit_at_centroid;
use crate::visibility::RayTree;

const HEIGHT_M: f64 = 5.0;

pub(super) fn hazard() -> Result<Hazard> {
    const METHODS: [(&str, bool, &str); 4] = [
        ("exact", true, "Cells of the Sun's view are as flat as facets are to it: no angle is special."),
        ("64 rays per pixel", false, "Noise of sampling; the same at all angles."),
        (
            "shadow by facet centroid",
            false,
            "A facet is lit or dark all over: wrong by the size of facets along the shadow's edge.",
        ),
        (
            "painter's algorithm",
            false,
            "A large ground facet is as far as its centroid is: beside a box it may be painted over its shadow.",
        ),
    ];
    let incidences = [0.0, 30.0, 60.0, 80.0, 85.0, 88.0, 89.0, 89.5, 89.9, 89.99];
    let errors_at = |incidence_deg: f64| -> Result<Vec<f64>> {
        let tan = incidence_deg.to_radians().tan();
        // Ground as large as the shadow, in 24 x 24 cells whatever its size; azimuth 33 deg.
        let half_m = 8.0 + 1.3 * HEIGHT_M * tan;
        let ground = cells([-half_m; 2], [half_m; 2], [24; 2], |_, _| 0);
        let stone = cuboid(DVec3::new(-2.0, -1.5, 0.0), DVec3::new(2.0, 1.5, HEIGHT_M), 1);
        let mesh = joined([ground, stone]);
        let towards = sun(incidence_deg, 33.0)?;
        let scene = scene(mesh, &[1.0, 0.0], towards, above(1e4 * half_m, 2.0 * half_m, 16)?)?;
        // The foot, and what its sides sweep: each is height x tan i times the width that it shows to the Sun's azimuth.
        let (sin, cos) = 33f64.to_radians().sin_cos();
        let shadow_m2 = HEIGHT_M * tan * (4.0 * sin + 3.0 * cos);
        let lit_m2 = 4.0 * half_m * half_m - 12.0 - shadow_m2;
        let cos_i = incidence_deg.to_radians().cos();
        let sum = |image: Vec<f64>| {
            // The box is black; from so high above, its sides hide nothing that counts, 1e-4 of its height.
            let pixel_m2 = (2.0 * half_m / 16.0).powi(2);
            (image.iter().sum::<f64>() * pixel_m2 / cos_i - lit_m2).abs() / (shadow_m2 + 12.0)
        };
        let exact_m2 = {
            let table = crate::solve::lit(&scene, &crate::progress::unwatched)?;
            let mesh = &scene.body.mesh;
            let ground = facets(mesh).filter(|f| mesh.material[*f as usize].0 == 0);
            let lit: f64 = table
                .sunlit()
                .map_or(0.0, |seen| ground.map(|f| seen.fraction(f) * mesh.facet(f as usize).area_m2()).sum());
            (lit - lit_m2).abs() / (shadow_m2 + 12.0)
        };
        Ok(vec![
            exact_m2,
            sum(by_rays(&scene, 64)?),
            sum(lit_by(&scene, lit_at_centroid(&scene, &RayTree::new(&scene.body.mesh)))?),
            sum(lit_by(&scene, painted_sunlight(&scene.body.mesh, towards))?),
        ])
    };
    let errors: Vec<Vec<f64>> = incidences.par_iter().map(|i| errors_at(*i)).collect::<Result<_>>()?;
    let sweep = |(k, (method, is_ours, then)): (usize, (&'static str, bool, &'static str))| {
        let points = incidences.iter().zip(&errors).map(|(at, errors)| Point { at: *at, error: errors[k] }).collect();
        Sweep { method, is_ours, then, points }
    };
    Ok(Hazard {
        name: "grazing sunlight",
        parameter: "incidence, deg",
        truth: "What a box of 4 x 3 x 5 m leaves dark of level ground: its foot and height x tan i along the Sun's azimuth; error over that area.",
        sweeps: METHODS.into_iter().enumerate().map(sweep).collect(),
    })
}
