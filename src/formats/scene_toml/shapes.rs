//! Reflectance models as a scene file has them.

use crate::physics::reflectance::hapke::{HFormula, Parameters, Roughness, Surge};
use crate::physics::reflectance::{Partition, PhaseCurve, PhaseFunction, Shape};

use super::super::number::exact;
use super::types::{
    HFormulaToml, HapkeNumbersToml, HapkeToml, MaterialToml, PhaseCurveToml, RpvToml, ShareToml, SurgeToml,
};

impl HapkeToml {
    /// Path of the table.
    pub(super) fn file(&self) -> Option<&str> {
        if let HapkeToml::File(name) = self { Some(name) } else { None }
    }
}

impl RpvToml {
    /// Path of the table.
    pub(super) fn file(&self) -> Option<&str> {
        if let RpvToml::File(name) = self { Some(name) } else { None }
    }
}

impl MaterialToml {
    /// The keys of all models that are given.
    pub(super) fn models(&self) -> Vec<&'static str> {
        let all = [
            ("lommel_seeliger", self.lommel_seeliger.is_some()),
            ("lunar_lambert", self.lunar_lambert.is_some()),
            ("minnaert", self.minnaert.is_some()),
            ("akimov", self.akimov.is_some()),
            ("hapke", self.hapke.is_some()),
            ("rpv", self.rpv.is_some()),
        ];
        all.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }

    /// The first model by numbers, with its key.
    pub(super) fn shape(&self) -> Option<(&'static str, Shape)> {
        if let Some(model) = &self.lommel_seeliger {
            return Some(("lommel_seeliger", Shape::LommelSeeliger(phase_function(model.b, model.c))));
        }
        if let Some(model) = &self.lunar_lambert {
            let partition = match &model.share {
                ShareToml::Constant(share) => Partition::Constant(*share),
                ShareToml::Named(_) => Partition::Moon,
                ShareToml::Exponential(of) => Partition::Exponential { scale_rad: of.scale_deg.to_radians() },
            };
            return Some(("lunar_lambert", Shape::LunarLambert(phase_curve(model.phase.as_ref()), partition)));
        }
        if let Some(model) = &self.minnaert {
            return Some(("minnaert", Shape::Minnaert(model.exponent)));
        }
        if let Some(model) = &self.akimov {
            return Some(("akimov", Shape::Akimov(phase_curve(model.phase.as_ref()))));
        }
        if let Some(HapkeToml::Given(model)) = &self.hapke {
            return Some(("hapke", Shape::Hapke(hapke(model))));
        }
        if let Some(RpvToml::Given(model)) = &self.rpv {
            return Some(("rpv", Shape::Rpv { exponent: model.k, asymmetry: model.g, hot_spot: model.h }));
        }
        None
    }
}

fn phase_function(b: Option<f64>, c: Option<f64>) -> PhaseFunction {
    match (b, c) {
        (None, None) => PhaseFunction::Isotropic,
        (Some(b), None) => PhaseFunction::HenyeyGreenstein { b },
        (b, Some(c)) => PhaseFunction::TwoTerms { b: b.unwrap_or(0.0), c },
    }
}

fn phase_curve(curve: Option<&PhaseCurveToml>) -> PhaseCurve {
    let of = |value: fn(&PhaseCurveToml) -> Option<f64>| curve.and_then(value).unwrap_or(0.0);
    PhaseCurve { beta: of(|c| c.beta), gamma: of(|c| c.gamma), delta: of(|c| c.delta) }
}

fn hapke(model: &HapkeNumbersToml) -> Parameters {
    let surge = |surge: Option<&SurgeToml>| match surge {
        Some(&SurgeToml { amplitude, width }) => Surge { amplitude, width },
        None => Surge::NONE,
    };
    Parameters {
        phase: phase_function(model.b, model.c),
        shadow_hiding: surge(model.shadow_hiding.as_ref()),
        coherent: surge(model.coherent.as_ref()),
        roughness: match model.mean_slope_deg {
            Some(mean_slope_deg) => Roughness::of_mean_slope(mean_slope_deg.to_radians()),
            None => Roughness::SMOOTH,
        },
        porosity_factor: model.porosity_factor.unwrap_or(1.0),
        h: match model.h {
            None | Some(HFormulaToml::Exact) => HFormula::Exact,
            Some(HFormulaToml::Hapke1981) => HFormula::Hapke1981,
            Some(HFormulaToml::Hapke2002) => HFormula::Hapke2002,
        },
    }
}

/// A model's parameters as an inline table.
pub(super) fn text(shape: &Shape) -> String {
    let keys = match *shape {
        Shape::LommelSeeliger(phase) => phase_keys(&phase),
        Shape::LunarLambert(curve, partition) => {
            let share = match partition {
                Partition::Constant(share) => format!("share = {share:?}"),
                Partition::Moon => "share = \"moon\"".into(),
                Partition::Exponential { scale_rad } => {
                    format!("share = {{ scale_deg = {:?} }}", exact(scale_rad.to_degrees(), f64::to_radians, scale_rad))
                }
            };
            [vec![share], curve_keys(&curve)].concat()
        }
        Shape::Minnaert(exponent) => vec![format!("exponent = {exponent:?}")],
        Shape::Akimov(curve) => curve_keys(&curve),
        Shape::Hapke(parameters) => hapke_keys(&parameters),
        Shape::Rpv { exponent, asymmetry, hot_spot } => {
            vec![format!("k = {exponent:?}"), format!("g = {asymmetry:?}"), format!("h = {hot_spot:?}")]
        }
    };
    if keys.is_empty() { "{}".into() } else { format!("{{ {} }}", keys.join(", ")) }
}

fn phase_keys(phase: &PhaseFunction) -> Vec<String> {
    match *phase {
        PhaseFunction::HenyeyGreenstein { b } => vec![format!("b = {b:?}")],
        PhaseFunction::TwoTerms { b, c } => vec![format!("b = {b:?}"), format!("c = {c:?}")],
        // Only tables have Legendre's, which are written as tables.
        PhaseFunction::Isotropic | PhaseFunction::Legendre { .. } => vec![],
    }
}

fn curve_keys(curve: &PhaseCurve) -> Vec<String> {
    let PhaseCurve { beta, gamma, delta } = curve;
    match *curve == PhaseCurve::FLAT {
        true => vec![],
        false => vec![format!("phase = {{ beta = {beta:?}, gamma = {gamma:?}, delta = {delta:?} }}")],
    }
}

fn hapke_keys(parameters: &Parameters) -> Vec<String> {
    let mut keys = phase_keys(&parameters.phase);
    for (key, surge) in [("shadow_hiding", parameters.shadow_hiding), ("coherent", parameters.coherent)] {
        if surge != Surge::NONE {
            keys.push(format!("{key} = {{ amplitude = {:?}, width = {:?} }}", surge.amplitude, surge.width));
        }
    }
    if parameters.roughness != Roughness::SMOOTH {
        let slope_deg = parameters.roughness.mean_slope_rad().to_degrees();
        let is_other =
            |deg: f64| f64::from(u8::from(Roughness::of_mean_slope(deg.to_radians()) != parameters.roughness));
        keys.push(format!("mean_slope_deg = {:?}", exact(slope_deg, is_other, 0.0)));
    }
    if parameters.porosity_factor != 1.0 {
        keys.push(format!("porosity_factor = {:?}", parameters.porosity_factor));
    }
    match parameters.h {
        HFormula::Exact => {}
        HFormula::Hapke1981 => keys.push("h = \"hapke1981\"".into()),
        HFormula::Hapke2002 => keys.push("h = \"hapke2002\"".into()),
    }
    keys
}
