//! Reflectance at the ends of angles: light and view in one direction, and both near the horizon.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::physics::reflectance::{Brdf, LommelSeeliger, Minnaert, PhaseFunction, PhotometricAngles, Preset};
use crate::physics::thesis_projection::Precision;

/// Phase angles down to 0: the opposition effect.
pub(super) fn opposition() -> Result<Hazard> {
    let brdf = Preset::PhobosAssumed.brdf();
    let incidence = 0.6;
    let truth = |phase: f64| brdf.eval(&PhotometricAngles::of_angles(incidence, incidence + phase, 0.0));
    let directions = |phase: f64| {
        let at = |polar: f64| DVec3::new(polar.sin(), 0.0, polar.cos());
        [at(incidence), at(incidence + phase)]
    };
    let by_acos = |phase: f64, precision: Precision| {
        let [sun, eye] = directions(phase).map(|v| precision.round_each(v));
        let r = |x: f64| precision.round(x);
        let dot = r(r(r(sun.x * eye.x) + r(sun.y * eye.y)) + r(sun.z * eye.z)).min(1.0);
        brdf.eval(&PhotometricAngles::of_angles(incidence, incidence + r(dot.acos()), 0.0))
    };
    let phases: Vec<f64> = (1..=12).map(|power| 10f64.powi(-power)).collect();
    let sweep = |method, is_ours, then, of: &dyn Fn(f64) -> f64| Sweep {
        method,
        is_ours,
        then,
        points: phases
            .iter()
            .map(|phase| Point { at: *phase, error: (of(*phase) / truth(*phase) - 1.0).abs() })
            .collect(),
    };
    Ok(Hazard {
        name: "opposition",
        parameter: "phase angle, rad",
        truth: "The Phobos surface (Hapke, surge 0.057 rad wide) at a phase angle that is known, against the angle found from directions; error of the BRDF.",
        sweeps: vec![
            sweep("half-angle tangents from |s x o|", true, "All digits at 0 and at 180 deg.", &|phase| {
                let [sun, eye] = directions(phase);
                brdf.eval(&PhotometricAngles::of_directions(DVec3::Z, sun, eye))
            }),
            sweep(
                "arc cosine, f64",
                false,
                "The angle is off by 1e-8 rad near 0: harmless for a surge as wide as this.",
                &|phase| by_acos(phase, Precision::Double),
            ),
            sweep("arc cosine, f32", false, "The angle is off by 3e-4 rad near 0: it shows in the surge.", &|phase| {
                by_acos(phase, Precision::Single)
            }),
        ],
    })
}

/// Incidence and emission towards 90 deg.
pub(super) fn grazing() -> Result<Hazard> {
    let emission = 1.0_f64;
    let minnaert = Minnaert { albedo: 0.07, exponent: 0.6 };
    let lommel_seeliger = LommelSeeliger { albedo: 0.2, phase: PhaseFunction::Isotropic };
    let heights: Vec<f64> = (0..=9).map(|power| 10f64.powi(1 - power)).collect();
    // Radiance over irradiance normal to the beam, f mu0, relative to that at 30 deg.
    let radiance = |brdf: &Brdf, height_deg: f64| {
        let incidence = PI * (0.5 - height_deg / 180.0);
        let mu0 = height_deg.to_radians().sin();
        let at = |incidence: f64| brdf.eval(&PhotometricAngles::of_angles(incidence, emission, 0.5 * PI));
        at(incidence) * mu0 / (at(PI / 6.0) * (PI / 6.0).cos())
    };
    let sweep = |method, is_ours, then, brdf: Brdf, truth: &dyn Fn(f64) -> f64| {
        let scale = truth((PI / 6.0).cos()) * (PI / 6.0).cos();
        let point = |height: &f64| {
            let mu0 = height.to_radians().sin();
            Point { at: *height, error: (radiance(&brdf, *height) - truth(mu0) * mu0 / scale).abs() }
        };
        Sweep { method, is_ours, then, points: heights.iter().map(point).collect() }
    };
    let mu = emission.cos();
    // For models without a closed form of their own here: light and view exchanged must give the same, and what the horizon sends is 0.
    let exchanged = |brdf: Brdf, method, then| {
        let point = |height: &f64| {
            let angles = PhotometricAngles::of_angles(PI * (0.5 - height / 180.0), emission, 0.5 * PI);
            let (one, other) = (brdf.eval(&angles), brdf.eval(&angles.swapped()));
            let is_possible = one.is_finite() && one >= 0.0 && radiance(&brdf, *height) <= 1.0;
            Point { at: *height, error: if is_possible { (one / other - 1.0).abs() } else { f64::INFINITY } }
        };
        Sweep { method, is_ours: true, then, points: heights.iter().map(point).collect() }
    };
    Ok(Hazard {
        name: "the Sun at the horizon of a facet",
        parameter: "height of the Sun over the facet, deg",
        truth: "Radiance relative to that at 30 deg incidence, by the model's formula; of Hapke's and Mars's surface, that light and view can be exchanged.",
        sweeps: vec![
            sweep("Lommel-Seeliger", true, "Finite everywhere.", Brdf::LommelSeeliger(lommel_seeliger), &|mu0| {
                0.2 / (4.0 * PI) / (mu0 + mu)
            }),
            sweep(
                "Minnaert, exponent 0.6",
                true,
                "Its power of the cosine is infinite at the horizon; below a cosine of 1e-6 it is held, and radiance falls to 0 faster than the formula.",
                Brdf::Minnaert(minnaert),
                &|mu0| 0.07 / PI * (mu0 * mu).powf(0.6 - 1.0),
            ),
            exchanged(
                Preset::PhobosAssumed.brdf(),
                "Hapke, Phobos",
                "Finite, and the same with light and view exchanged.",
            ),
            exchanged(Preset::Mars.brdf(), "Minnaert, Mars", "Finite, and the same with light and view exchanged."),
        ],
    })
}
