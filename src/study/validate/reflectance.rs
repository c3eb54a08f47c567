//! What this program says of reflectance: models, their parts, and albedos.

use serde_json::json;

use super::patch::Patch;
use super::values::{from_zenith, reference, simulate};
use super::{Answer, Oracle, closed_forms};
use crate::physics::reflectance::albedo::Measure;
use crate::physics::reflectance::hapke::{HFormula, Parameters, Roughness, Surge};
use crate::physics::reflectance::{
    Akimov, Brdf, Hapke, Lambert, LommelSeeliger, LunarLambert, Minnaert, Partition, PhaseCurve, PhaseFunction,
    PhotometricAngles, Rpv,
};

impl Oracle<'_> {
    /// The model of a name such as "dh hapke_phobos(w=0.072, ...)", its parameters from inputs or name.
    ///
    /// Of Hapke's, "81" and "exact" in the name tell which H it is; it is that of 2002 else.
    pub(super) fn model(&self, kind: &str) -> Option<Brdf> {
        let input = |key| self.input(key);
        let named = |name: &str| kind.contains(name);
        let phase = PhaseCurve::FLAT;
        Some(if named("hapke") {
            return self.hapke(kind);
        } else if named("lommel_seeliger") {
            Brdf::LommelSeeliger(LommelSeeliger { albedo: input("w")?, phase: PhaseFunction::Isotropic })
        } else if named("lunar_lambert") {
            let partition = Partition::Constant(input("L")?);
            Brdf::LunarLambert(LunarLambert { albedo: input("A")?, phase, partition })
        } else if named("lambert") {
            Brdf::Lambert(Lambert { reflectance: input("rho").or_else(|| input("A"))? })
        } else if named("minnaert") {
            Brdf::Minnaert(Minnaert { albedo: input("A")?, exponent: input("k")? })
        } else if named("akimov") {
            Brdf::Akimov(Akimov { albedo: input("A")?, phase })
        } else if named("rpv") {
            let amplitude = input("rho0")?;
            let hot_spot = input("rhoc").unwrap_or(amplitude);
            Brdf::Rpv(Rpv { amplitude, exponent: input("k")?, asymmetry: input("Theta")?, hot_spot })
        } else {
            return None;
        })
    }

    fn hapke(&self, kind: &str) -> Option<Brdf> {
        let input = |key| self.input(key);
        let b = input("b")?;
        let phase = match input("c") {
            Some(c) => PhaseFunction::TwoTerms { b, c },
            None => PhaseFunction::HenyeyGreenstein { b },
        };
        let mean_slope_deg = input("theta_bar_deg").or_else(|| input("theta")).unwrap_or(0.0);
        let parameters = Parameters {
            phase,
            shadow_hiding: Surge { amplitude: input("B0")?, width: input("h")? },
            coherent: Surge::NONE,
            roughness: Roughness::of_mean_slope(mean_slope_deg.to_radians()),
            porosity_factor: input("K").unwrap_or(1.0),
            h: h_formula(kind).unwrap_or(HFormula::Hapke2002),
        };
        Some(Brdf::Hapke(Box::new(Hapke::new(input("w")?, parameters))))
    }

    /// BRDF of a Lambert surface at incidence and emission: radiance over irradiance, by a patch, a Sun and a camera.
    fn lambert_brdf(&self, incidence_deg: f64, emission_deg: f64, azimuth_deg: f64) -> Option<f64> {
        let patch = Patch {
            sun: from_zenith(incidence_deg, 0.0),
            observer_m: 1000.0 * from_zenith(emission_deg, azimuth_deg),
            reflectance: self.input("rho").or_else(|| self.input("A"))?,
            ..Patch::default()
        };
        Some(patch.radiance()? / incidence_deg.to_radians().cos())
    }

    pub(super) fn brdf(&self, kind: &str) -> Option<Vec<Answer>> {
        let (i_deg, e_deg) = (self.input("i_deg")?, self.input("e_deg")?);
        let azimuth_deg = self.input("psi_deg").unwrap_or(0.0);
        Some(match kind {
            "lambert" => simulate(self.lambert_brdf(i_deg, e_deg, azimuth_deg)?),
            // A name like "radf_model_vs_lambert0.07": the second of the two.
            _ if kind.starts_with("radf_") => {
                let reflectance = kind.split_once("lambert")?.1.parse().ok()?;
                let sun = from_zenith(i_deg, 0.0);
                let observer_m = 1000.0 * from_zenith(e_deg, azimuth_deg);
                let radiance = Patch { sun, observer_m, reflectance, ..Patch::default() }.radiance()?;
                simulate(json!({"radf_lambert": std::f64::consts::PI * radiance}))
            }
            _ => reference(self.model(kind)?.eval(&angles(i_deg, e_deg, azimuth_deg))),
        })
    }

    pub(super) fn brdf_property(&self, kind: &str) -> Option<Vec<Answer>> {
        let model = kind.strip_prefix("reciprocity ")?;
        let (i_deg, e_deg, azimuth_deg) = (self.input("i")?, self.input("e")?, self.input("psi")?);
        if model == "lambert" {
            let (one, other) =
                (self.lambert_brdf(i_deg, e_deg, azimuth_deg)?, self.lambert_brdf(e_deg, i_deg, azimuth_deg)?);
            return Some(simulate((one / other - 1.0).abs()));
        }
        let brdf = self.model(model)?;
        let (one, other) = (angles(i_deg, e_deg, azimuth_deg), angles(e_deg, i_deg, azimuth_deg));
        Some(reference((brdf.eval(&one) / brdf.eval(&other) - 1.0).abs()))
    }

    /// H, and what roughness makes of cosines.
    pub(super) fn hapke_parts(&self, kind: &str) -> Option<Vec<Answer>> {
        if kind != "roughness" {
            return Some(reference(h_formula(kind)?.function(self.input("w")?).of(self.input("x")?)));
        }
        let angles = angles(self.input("i_deg")?, self.input("e_deg")?, self.input("psi_deg")?);
        let seen = Roughness::of_mean_slope(self.input("theta_bar_deg")?.to_radians()).at(&angles);
        let [steep, flat] = seen.cosines;
        let (mu0, mu) = if angles.cos_incidence() >= angles.cos_emission() { (steep, flat) } else { (flat, steep) };
        let shadows = seen.shading * angles.cos_incidence() * (mu0 + mu) / mu0;
        Some(reference(json!({"mu0e": mu0, "mue": mu, "S": shadows})))
    }

    pub(super) fn albedo(&self, kind: &str) -> Option<Vec<Answer>> {
        let cos_incidence = || Some(self.input("i_deg")?.to_radians().cos());
        let measured =
            |brdf: &Brdf| Some(Measure::DirectionalHemispherical { cos_incidence: cos_incidence()? }.of(brdf));
        Some(reference(match kind {
            "lommel_seeliger_dh" => closed_forms::lommel_seeliger_albedo(self.input("w")?, cos_incidence()?),
            "lommel_seeliger_bihemispherical_per_w" => 2.0 / 3.0 * (1.0 - std::f64::consts::LN_2),
            "minnaert_dh" => {
                Minnaert { albedo: self.input("A")?, exponent: self.input("k")? }.albedo_without_limb(cos_incidence()?)
            }
            "lunar_lambert_dh" => {
                let (albedo, share) = (self.input("A")?, self.input("L")?);
                closed_forms::lommel_seeliger_albedo(8.0 * albedo * share, cos_incidence()?) + albedo * (1.0 - share)
            }
            _ if kind.starts_with("hapke_isotropic_w1_dh_") => {
                let parameters = Parameters { h: h_formula(kind)?, ..Parameters::PLAIN };
                measured(&Brdf::Hapke(Box::new(Hapke::new(self.input("w")?, parameters))))?
            }
            _ => measured(&self.model(kind.strip_prefix("dh ")?)?)?,
        }))
    }
}

/// Which H a name tells.
fn h_formula(name: &str) -> Option<HFormula> {
    [("81", HFormula::Hapke1981), ("02", HFormula::Hapke2002), ("exact", HFormula::Exact)]
        .into_iter()
        .find_map(|(part, formula)| name.contains(part).then_some(formula))
}

fn angles(incidence_deg: f64, emission_deg: f64, azimuth_deg: f64) -> PhotometricAngles {
    PhotometricAngles::of_angles(incidence_deg.to_radians(), emission_deg.to_radians(), azimuth_deg.to_radians())
}
