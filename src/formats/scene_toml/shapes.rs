//! Reflectance models as a scene file has them.

use crate::physics::reflectance::hapke::{HFormula, Parameters, Roughness, Surge};
use crate::physics::reflectance::{Partition, PhaseCurve, PhaseFunction, Preset, Shape};

use super::super::number::exact;
use super::types::{
    HFormulaToml, HapkeNumbersToml, HapkeToml, MaterialToml, PhaseCurveToml, PresetToml, RpvToml, ShareToml, SurgeToml,
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

impl PresetToml {
    /// What it names.
    pub(super) fn preset(self) -> Preset {
        match self {
            PresetToml::PhobosAssumed => Preset::PhobosAssumed,
            PresetToml::DeimosAssumed => Preset::DeimosAssumed,
            PresetToml::Moon => Preset::Moon,
            PresetToml::Mars => Preset::Mars,
            PresetToml::Thesis => Preset::Thesis,
        }
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
            ("table", self.table.is_some()),
        ];
        all.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }

    /// The first model by numbers, with its key; what it does not say is that of `base`, the model of a preset.
    pub(super) fn shape(&self, base: Option<&Shape>) -> Option<(&'static str, Shape)> {
        if let Some(model) = &self.lommel_seeliger {
            return Some((
                "lommel_seeliger",
                Shape::LommelSeeliger(phase_function(model.b, model.c, PhaseFunction::Isotropic)),
            ));
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
            let base = if let Some(Shape::Hapke(base)) = base { base } else { &Parameters::PLAIN };
            return Some(("hapke", Shape::Hapke(hapke(model, base))));
        }
        if let Some(RpvToml::Given(model)) = &self.rpv {
            return Some(("rpv", Shape::Rpv { exponent: model.k, asymmetry: model.g, hot_spot: model.h }));
        }
        base.map(|base| (base.key(), *base))
    }

    /// The numbers of surges that are given in half, and that no preset has.
    pub(super) fn missing(&self, base: Option<&Shape>) -> Vec<&'static str> {
        let Some(HapkeToml::Given(model)) = &self.hapke else { return vec![] };
        let base = if let Some(Shape::Hapke(base)) = base { base } else { &Parameters::PLAIN };
        let mut missing = Vec::new();
        for (keys, given, of_base) in [
            (["shadow_hiding.amplitude", "shadow_hiding.width"], &model.shadow_hiding, base.shadow_hiding),
            (["coherent.amplitude", "coherent.width"], &model.coherent, base.coherent),
        ] {
            if let Some(surge) = given.as_ref().filter(|_| of_base == Surge::NONE) {
                let is_missing = [surge.amplitude.is_none(), surge.width.is_none()];
                missing
                    .extend(keys.into_iter().zip(is_missing).filter(|(_, is_missing)| *is_missing).map(|(key, _)| key));
            }
        }
        missing
    }
}

fn phase_function(b: Option<f64>, c: Option<f64>, base: PhaseFunction) -> PhaseFunction {
    let of_base = match base {
        PhaseFunction::HenyeyGreenstein { b } => (Some(b), None),
        PhaseFunction::TwoTerms { b, c } => (Some(b), Some(c)),
        PhaseFunction::Isotropic | PhaseFunction::Legendre { .. } => (None, None),
    };
    match (b.or(of_base.0), c.or(of_base.1)) {
        (None, None) => PhaseFunction::Isotropic,
        (Some(b), None) => PhaseFunction::HenyeyGreenstein { b },
        (b, Some(c)) => PhaseFunction::TwoTerms { b: b.unwrap_or(0.0), c },
    }
}

fn phase_curve(curve: Option<&PhaseCurveToml>) -> PhaseCurve {
    let of = |value: fn(&PhaseCurveToml) -> Option<f64>| curve.and_then(value).unwrap_or(0.0);
    PhaseCurve { beta: of(|c| c.beta), gamma: of(|c| c.gamma), delta: of(|c| c.delta) }
}

fn hapke(model: &HapkeNumbersToml, base: &Parameters) -> Parameters {
    let surge = |surge: Option<&SurgeToml>, base: Surge| match surge {
        Some(&SurgeToml { amplitude, width }) => {
            Surge { amplitude: amplitude.unwrap_or(base.amplitude), width: width.unwrap_or(base.width) }
        }
        None => base,
    };
    Parameters {
        phase: phase_function(model.b, model.c, base.phase),
        shadow_hiding: surge(model.shadow_hiding.as_ref(), base.shadow_hiding),
        coherent: surge(model.coherent.as_ref(), base.coherent),
        roughness: match model.mean_slope_deg {
            Some(mean_slope_deg) => Roughness::of_mean_slope(mean_slope_deg.to_radians()),
            None => base.roughness,
        },
        porosity_factor: model.porosity_factor.unwrap_or(base.porosity_factor),
        h: match model.h {
            None => base.h,
            Some(HFormulaToml::Exact) => HFormula::Exact,
            Some(HFormulaToml::Hapke1981) => HFormula::Hapke1981,
            Some(HFormulaToml::Hapke2002) => HFormula::Hapke2002,
        },
    }
}

/// The preset to name beside a model, with its own model, if its numbers can be replaced by those of the model.
pub(super) fn base(shape: &Shape, preset: Option<Preset>) -> (Option<Preset>, Option<Shape>) {
    let base = preset.and_then(|preset| preset.known().shape);
    let is_replaceable = match (shape, &base) {
        (Shape::Hapke(own), Some(Shape::Hapke(base))) => {
            matches!(
                (own.phase, base.phase),
                (PhaseFunction::HenyeyGreenstein { .. }, PhaseFunction::HenyeyGreenstein { .. })
                    | (PhaseFunction::TwoTerms { .. }, _)
            )
        }
        (Shape::Minnaert(_), Some(Shape::Minnaert(_))) => true,
        _ => false,
    };
    if is_replaceable { (preset, base) } else { (None, None) }
}

/// A model's parameters as an inline table; of Hapke's those that are not `base`'s, the ones of a preset or else the plain ones.
pub(super) fn text(shape: &Shape, base: Option<&Shape>) -> String {
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
        Shape::Hapke(parameters) => {
            let base = if let Some(Shape::Hapke(base)) = base { base } else { &Parameters::PLAIN };
            hapke_keys(&parameters, base)
        }
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

fn hapke_keys(parameters: &Parameters, base: &Parameters) -> Vec<String> {
    let mut keys = if parameters.phase == base.phase { vec![] } else { phase_keys(&parameters.phase) };
    for (key, surge, of_base) in [
        ("shadow_hiding", parameters.shadow_hiding, base.shadow_hiding),
        ("coherent", parameters.coherent, base.coherent),
    ] {
        if surge != of_base {
            keys.push(format!("{key} = {{ amplitude = {:?}, width = {:?} }}", surge.amplitude, surge.width));
        }
    }
    if parameters.roughness != base.roughness {
        let slope_deg = parameters.roughness.mean_slope_rad().to_degrees();
        let is_other =
            |deg: f64| f64::from(u8::from(Roughness::of_mean_slope(deg.to_radians()) != parameters.roughness));
        keys.push(format!("mean_slope_deg = {:?}", exact(slope_deg, is_other, 0.0)));
    }
    if parameters.porosity_factor != base.porosity_factor {
        keys.push(format!("porosity_factor = {:?}", parameters.porosity_factor));
    }
    if parameters.h != base.h {
        let name = match parameters.h {
            HFormula::Exact => "exact",
            HFormula::Hapke1981 => "hapke1981",
            HFormula::Hapke2002 => "hapke2002",
        };
        keys.push(format!("h = {name:?}"));
    }
    keys
}
