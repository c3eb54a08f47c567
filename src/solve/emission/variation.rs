//! How much a surface's radiance varies over what a pixel shows of it, and so into how many parts that is to be split.

use crate::physics::reflectance::hapke::{Parameters, Surge};
use crate::physics::reflectance::{PhaseFunction, Shape};

/// Relative error that one pair of angles for a part may have.
const TOLERANCE: f64 = 1e-4;
/// At most so many parts along each side of what a pixel shows.
pub(super) const MOST_PARTS: f64 = 64.0;
/// Second derivatives by angles, relative: of phase functions, phase curves and shadows of roughness, away from surges and from the horizon.
const SMOOTH: f64 = 8.0;
/// The hot spot of RPV, as a surge.
const HOT_SPOT: Surge = Surge { amplitude: 1.0, width: 0.5 };

/// What varies most in a model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variation {
    /// Whether its limb follows the sum of both cosines, and not each of them.
    by_sum: bool,
    /// Second derivative by angles, but for surges and the limb.
    curvature: f64,
    surges: [Surge; 2],
}

impl Variation {
    /// Of a model; `None`: of tables, about which nothing is known.
    pub(super) fn of(shape: Option<&Shape>) -> Self {
        let plain = Variation { by_sum: false, curvature: SMOOTH, surges: [Surge::NONE; 2] };
        match shape {
            Some(Shape::LommelSeeliger(phase)) => Variation { by_sum: true, curvature: curvature(phase), ..plain },
            Some(Shape::LunarLambert(..)) => Variation { by_sum: true, ..plain },
            Some(Shape::Hapke(Parameters { phase, shadow_hiding, coherent, .. })) => {
                Variation { by_sum: true, curvature: curvature(phase), surges: [*shadow_hiding, *coherent] }
            }
            Some(Shape::Rpv { asymmetry, .. }) => {
                let phase = PhaseFunction::HenyeyGreenstein { b: *asymmetry };
                Variation { curvature: curvature(&phase), surges: [HOT_SPOT, Surge::NONE], ..plain }
            }
            Some(Shape::Minnaert(_) | Shape::Akimov(_)) | None => plain,
        }
    }

    /// Into how many parts along each side something is to be split that reaches over an angle, rad, whose middle is seen at these angles.
    ///
    /// The value in the middle of a rectangle of diagonal d differs from the mean by d^2 / 24 of the second derivative; by some d / 4 of the first
    /// one where a surge has its cusp there.
    pub(super) fn parts(&self, cos_incidence: f64, cos_emission: f64, cos_phase: f64, angle_rad: f64) -> f64 {
        let mu = cos_emission.max(0.0);
        let limb = if self.by_sum { mu + cos_incidence.max(0.0) } else { mu };
        let mut curvature = self.curvature + 2.0 / (limb * limb);
        let mut cusp = 0.0;
        let tan_half_phase = ((1.0 - cos_phase).max(0.0) / (1.0 + cos_phase).max(f64::MIN_POSITIVE)).sqrt();
        for Surge { amplitude, width } in self.surges {
            let (share, away) = (amplitude / (1.0 + amplitude), 1.0 + tan_half_phase / width);
            curvature += 0.5 * share / (width * width * away * away * away);
            if 2.0 * tan_half_phase < angle_rad {
                cusp += 0.25 * share * (0.5 * angle_rad / width).min(1.0);
            }
        }
        let error = curvature * angle_rad * angle_rad / 24.0 + cusp;
        (error / TOLERANCE).sqrt().ceil().clamp(1.0, MOST_PARTS)
    }
}

/// Second derivative of a phase function by its angle, relative: a lobe is as narrow as 1 - |b|.
fn curvature(phase: &PhaseFunction) -> f64 {
    match *phase {
        PhaseFunction::HenyeyGreenstein { b } | PhaseFunction::TwoTerms { b, .. } => {
            SMOOTH + 3.0 * b.abs() / ((1.0 - b.abs()) * (1.0 - b.abs()))
        }
        PhaseFunction::Isotropic | PhaseFunction::Legendre { .. } => SMOOTH,
    }
}
