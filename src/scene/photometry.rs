//! How a surface's reflectance depends on the directions of light and view.

use std::f64::consts::{FRAC_PI_2, PI};

use super::coverage::uncovered;
use super::tabulated::Tabulated;
use crate::error::number;
use crate::physics::reflectance::albedo::Measure;
use crate::physics::reflectance::hapke::{HFormula, NoAlbedo, Parameters, Surge};
use crate::physics::reflectance::{
    Albedos, Brdf, DirectionalAlbedos, Partition, PhaseCurve, PhaseFunction, PhotometricAngles, Preset, Separated,
    Shape,
};
use crate::spectral::{Band, Spectrum};

/// The model of a surface's bidirectional reflectance.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Photometry {
    /// The same radiance in every direction: the material's reflectance is all there is.
    #[default]
    Lambert,
    /// A model by numbers, and an albedo that is a spectrum.
    Model(Box<Model>),
    /// Hapke's by tables: every parameter is a spectrum.
    Hapke(Box<Hapke>),
    /// That of Rahman, Pinty and Verstraete by tables.
    Rpv(Box<Rpv>),
    /// Reflectance factors as they were measured.
    Table(Box<Tabulated>),
}

/// A model whose parameters are the same at all wavelengths, except for its albedo.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The model and its parameters.
    pub shape: Shape,
    /// Its albedo: single-scattering, normal, or RPV's amplitude.
    pub albedo: Spectrum,
    /// The surface by name that its numbers are from, if they are, all or some of them.
    pub preset: Option<Preset>,
}

/// Parameters of Hapke's model as SOILSPECT has it (Jacquemoud, Baret & Hanocq 1992), all dimensionless.
///
/// R = w / 4 / (mu0 + mu) [(1 + B) P + H(mu0) H(mu) - 1]; B = h1 / (1 + tan(g / 2) / h2);
/// P = 1 + c1 cos g + c2 (3 cos^2 g - 1) / 2 + c3 cos g' + c4 (3 cos^2 g' - 1) / 2, with g the phase angle and g' that to the
/// specular direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Hapke {
    /// Single-scattering albedo, 0 to 1.
    pub w: Spectrum,
    /// Phase function: first Legendre coefficient about the direction of light.
    pub c1: Spectrum,
    /// Second.
    pub c2: Spectrum,
    /// First about the specular direction.
    pub c3: Spectrum,
    /// Second.
    pub c4: Spectrum,
    /// Amplitude of the opposition effect (B0 elsewhere), from 0.
    pub h1: Spectrum,
    /// Its angular width, above 0.
    pub h2: Spectrum,
}

/// Parameters of the RPV model (Rahman, Pinty & Verstraete 1993), all dimensionless.
///
/// R = rho0 {mu0 mu (mu0 + mu)}^(k - 1) F(g) [1 + (1 - h) / (1 + G)].
#[derive(Debug, Clone, PartialEq)]
pub struct Rpv {
    /// Amplitude, from 0; a fraction.
    pub rho0: Spectrum,
    /// Minnaert's exponent, from 0; 1 is flat, less is a bowl.
    pub k: Spectrum,
    /// Asymmetry of Henyey and Greenstein, within -1 and 1; below 0 scatters back. (Theta elsewhere.)
    pub g: Spectrum,
    /// Of the hot spot (rho_c elsewhere).
    pub h: Spectrum,
}

impl Hapke {
    /// Names of the parameters, in the order of the fields.
    pub const NAMES: [&str; 7] = ["w", "c1", "c2", "c3", "c4", "h1", "h2"];
}

impl Rpv {
    /// Names of the parameters, in the order of the fields.
    pub const NAMES: [&str; 4] = ["rho0", "k", "g", "h"];
}

impl From<[Spectrum; 7]> for Hapke {
    fn from([w, c1, c2, c3, c4, h1, h2]: [Spectrum; 7]) -> Self {
        Hapke { w, c1, c2, c3, c4, h1, h2 }
    }
}

impl From<[Spectrum; 4]> for Rpv {
    fn from([rho0, k, g, h]: [Spectrum; 4]) -> Self {
        Rpv { rho0, k, g, h }
    }
}

impl Model {
    /// Of a surface whose reflectance was measured.
    ///
    /// # Errors
    /// [`NoAlbedo`] at the first value that no albedo gives.
    pub fn measured(shape: Shape, reflectance: &Spectrum, measure: &Measure) -> Result<Self, NoAlbedo> {
        let albedos = Albedos::new(&shape, measure, reflectance.range().1);
        Ok(Model { shape, albedo: reflectance.try_map(|value| albedos.of(value))?, preset: None })
    }

    /// As products of what angles and what wavelengths give, to a relative tolerance.
    pub fn separated(&self, tolerance: f64) -> Separated {
        let (low, high) = self.albedo.range();
        Separated::new(&self.shape, &(low..=high), tolerance)
    }

    /// Its directional albedo where the spherical one is `bond_albedo`: a table, and the factor of its weights; `None` if no albedo gives that.
    pub fn absorbing(&self, bond_albedo: f64) -> Option<(DirectionalAlbedos, f64)> {
        let albedo = Albedos::new(&self.shape, &Measure::Spherical, bond_albedo).of(bond_albedo).ok()?;
        let separated = Separated::new(&self.shape, &(albedo..=albedo), TOLERANCE);
        // At a single albedo it is one product.
        Some((DirectionalAlbedos::new(&separated), albedo))
    }

    /// Its hemispherical (spherical, Bond's) reflectance.
    pub fn hemispherical(&self) -> Spectrum {
        let separated = self.separated(TOLERANCE);
        let measured = separated.measured(&Measure::Spherical);
        self.albedo.map(|albedo| separated.rows(albedo).iter().zip(&measured).map(|(row, of)| row * of).sum())
    }

    /// What is wrong with the parameters: of each its key and a sentence.
    pub fn problems(&self) -> Vec<(&'static str, String)> {
        let mut problems = problems(&self.shape);
        let most = self.shape.most();
        if let Some(v) = self.albedo.value().iter().find(|v| !(0.0..=most).contains(*v) || v.is_infinite()) {
            problems.push(("", out_of_range(*v, "from 0 to 1")));
        }
        problems
    }
}

/// Reflectance factors of models are no more than this, at angles up to [`ANGLES_DEG`]: of order 1 they are measured.
const MOST_FACTOR: f64 = 1e12;
/// Angles of incidence and emission at which models are looked at, deg.
const ANGLES_DEG: [f64; 8] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0];
/// Azimuths at which they are, deg.
const AZIMUTHS_DEG: [f64; 7] = [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0];
/// The least albedo at which they are: of a black surface all is 0.
const LEAST_ALBEDO: f64 = 1e-9;

/// A reflectance factor, and where a model has it.
struct At {
    factor: f64,
    incidence_deg: f64,
    emission_deg: f64,
    azimuth_deg: f64,
    um: f64,
}

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let At { factor, incidence_deg, emission_deg, azimuth_deg, um } = self;
        let (factor, um) = (number(*factor), number(*um));
        write!(
            f,
            "{factor} at {um} um, incidence {incidence_deg}, emission {emission_deg} and azimuth {azimuth_deg} deg"
        )
    }
}

/// Relative error that a model may have by being separated.
pub(crate) const TOLERANCE: f64 = 1e-9;

fn out_of_range(v: f64, range: &str) -> String {
    format!("{} is out of range, which is {range}", number(v))
}

/// What is wrong with a number of a table of parameters, if anything is.
pub fn out_of_parameters(name: &str, v: f64) -> Option<String> {
    let (low, high) = match name {
        "w" => (0.0, 1.0),
        // Beyond 2 the hot spot would be negative.
        "h" => (f64::NEG_INFINITY, 2.0),
        "h1" | "h2" | "rho0" | "k" | "factor" => (0.0, f64::INFINITY),
        "g" => (-1.0, 1.0),
        _ => return None,
    };
    // A peak without width, or a scattering into one direction only, is not a function.
    let open = matches!(name, "h2" | "g");
    let is_right = (low..=high).contains(&v) && !(open && (v == low || v == high));
    let range = match (low.is_infinite(), high.is_infinite()) {
        (true, _) => format!("up to {high}"),
        (_, true) => format!("from {low}"),
        _ => format!("from {low} to {high}"),
    };
    let ends = if open { ", ends excluded" } else { "" };
    (!is_right).then(|| format!("{name} = {v} is out of range, which is {range}{ends}"))
}

/// What is wrong with the parameters of a model: of each its key and a sentence.
pub fn problems(shape: &Shape) -> Vec<(&'static str, String)> {
    let mut found = Vec::new();
    let mut check = |key: &'static str, v: f64, is_right: bool, range: &str| {
        if !(is_right && v.is_finite()) {
            found.push((key, out_of_range(v, range)));
        }
    };
    match *shape {
        Shape::LommelSeeliger(phase) => check_phase(&phase, &mut check),
        Shape::LunarLambert(curve, partition) => {
            check_curve(&curve, &mut check);
            match partition {
                Partition::Constant(share) => check("share", share, (0.0..=1.0).contains(&share), "from 0 to 1"),
                Partition::Exponential { scale_rad } => {
                    let scale_deg = scale_rad.to_degrees();
                    check("share.scale_deg", scale_deg, scale_deg > 0.0, "above 0");
                }
                Partition::Moon => {}
            }
        }
        Shape::Minnaert(exponent) => check("exponent", exponent, exponent >= 0.0, "from 0"),
        Shape::Akimov(curve) => check_curve(&curve, &mut check),
        Shape::Hapke(Parameters { phase, shadow_hiding, coherent, roughness, porosity_factor, h: _ }) => {
            check_phase(&phase, &mut check);
            for ([amplitude, width], surge) in [
                (["shadow_hiding.amplitude", "shadow_hiding.width"], shadow_hiding),
                (["coherent.amplitude", "coherent.width"], coherent),
            ] {
                check(amplitude, surge.amplitude, surge.amplitude >= 0.0, "from 0");
                check(width, surge.width, surge.width > 0.0, "above 0");
            }
            let slope_rad = roughness.mean_slope_rad();
            let is_right = (0.0..FRAC_PI_2).contains(&slope_rad);
            check("mean_slope_deg", slope_rad.to_degrees(), is_right, "from 0 to below 90");
            check("porosity_factor", porosity_factor, porosity_factor >= 1.0, "from 1");
        }
        Shape::Rpv { exponent, asymmetry, hot_spot } => {
            check("k", exponent, exponent >= 0.0, "from 0");
            check("g", asymmetry, asymmetry.abs() < 1.0, "from -1 to 1, ends excluded");
            // Beyond 2 the hot spot would be negative.
            check("h", hot_spot, hot_spot <= 2.0, "up to 2");
        }
    }
    found
}

fn check_curve(curve: &PhaseCurve, check: &mut impl FnMut(&'static str, f64, bool, &str)) {
    for (key, v) in [("phase.beta", curve.beta), ("phase.gamma", curve.gamma), ("phase.delta", curve.delta)] {
        check(key, v, true, "finite");
    }
}

fn check_phase(phase: &PhaseFunction, check: &mut impl FnMut(&'static str, f64, bool, &str)) {
    match *phase {
        PhaseFunction::Isotropic => {}
        PhaseFunction::HenyeyGreenstein { b } => check("b", b, b.abs() < 1.0, "from -1 to 1, ends excluded"),
        PhaseFunction::TwoTerms { b, c } => {
            check("b", b, (0.0..1.0).contains(&b), "from 0 to below 1 if there is a `c`");
            let at = |phase_rad: f64| phase.at(&PhotometricAngles::of_angles(0.5 * phase_rad, 0.5 * phase_rad, PI));
            let is_never_negative = (0..=180).all(|deg| at(f64::from(deg).to_radians()) >= 0.0);
            check("c", c, is_never_negative, "where the phase function is negative nowhere");
        }
        PhaseFunction::Legendre { about_source, about_specular } => {
            about_source.into_iter().chain(about_specular).for_each(|v| check("phase", v, true, "finite"));
        }
    }
}

impl Hapke {
    /// The model of parameters that `value` gives.
    fn shape(&self, value: impl Fn(&Spectrum) -> Option<f64>) -> Option<Shape> {
        Some(Shape::Hapke(Parameters {
            phase: PhaseFunction::Legendre {
                about_source: [value(&self.c1)?, value(&self.c2)?],
                about_specular: [value(&self.c3)?, value(&self.c4)?],
            },
            shadow_hiding: Surge { amplitude: value(&self.h1)?, width: value(&self.h2)? },
            h: HFormula::Hapke1981,
            ..Parameters::PLAIN
        }))
    }
}

impl Rpv {
    /// The model of parameters that `value` gives.
    fn shape(&self, value: impl Fn(&Spectrum) -> Option<f64>) -> Option<Shape> {
        Some(Shape::Rpv { exponent: value(&self.k)?, asymmetry: value(&self.g)?, hot_spot: value(&self.h)? })
    }
}

impl Photometry {
    /// The model's name in a scene file; `None` for Lambert, which needs none.
    pub fn key(&self) -> Option<&'static str> {
        match self {
            Photometry::Lambert => None,
            Photometry::Model(model) => Some(model.shape.key()),
            Photometry::Hapke(_) => Some("hapke"),
            Photometry::Rpv(_) => Some("rpv"),
            Photometry::Table(_) => Some("table"),
        }
    }

    /// The model, if it is one by numbers.
    pub fn model(&self) -> Option<&Model> {
        if let Photometry::Model(model) = self { Some(model) } else { None }
    }

    /// Whether radiance is proportional to the material's reflectance.
    pub fn is_proportional(&self) -> bool {
        match self {
            Photometry::Lambert => true,
            Photometry::Model(model) => !matches!(model.shape, Shape::Hapke(_)),
            Photometry::Hapke(_) | Photometry::Rpv(_) | Photometry::Table(_) => false,
        }
    }

    /// As a model of which only the albedo depends on wavelength; `None` if it is not one, and for Lambert.
    pub fn to_model(&self) -> Option<Model> {
        let constant = |s: &Spectrum| s.value().iter().all(|v| *v == s.value()[0]).then(|| s.value()[0]);
        match self {
            Photometry::Lambert | Photometry::Table(_) => None,
            Photometry::Model(model) => Some(model.as_ref().clone()),
            Photometry::Hapke(hapke) => {
                Some(Model { shape: hapke.shape(constant)?, albedo: hapke.w.clone(), preset: None })
            }
            Photometry::Rpv(rpv) => Some(Model { shape: rpv.shape(constant)?, albedo: rpv.rho0.clone(), preset: None }),
        }
    }

    /// The surface at a wavelength, um; `None` where it is not known, and for Lambert.
    pub fn brdf(&self, um: f64) -> Option<Brdf> {
        let (shape, albedo) = match self {
            Photometry::Lambert => return None,
            Photometry::Model(model) => (model.shape, &model.albedo),
            Photometry::Hapke(hapke) => (hapke.shape(|s| s.at(um))?, &hapke.w),
            Photometry::Rpv(rpv) => (rpv.shape(|s| s.at(um))?, &rpv.rho0),
            Photometry::Table(table) => return table.brdf(um),
        };
        Some(shape.brdf(albedo.at(um)?))
    }

    /// The least and the largest reflectance factor of a model, of its darkest and brightest albedo, at the wavelengths of its tables; what is not a number counts as
    /// the largest. `None` for Lambert, and for tables of factors.
    fn extremes(&self) -> Option<[At; 2]> {
        let albedo = match self {
            Photometry::Lambert | Photometry::Table(_) => return None,
            Photometry::Model(model) => &model.albedo,
            Photometry::Hapke(hapke) => &hapke.w,
            Photometry::Rpv(rpv) => &rpv.rho0,
        };
        let surfaces: Vec<(f64, Brdf)> = match self.model() {
            Some(model) => {
                let (low, high) = albedo.range();
                let um = albedo.wavelength_um().first().copied()?;
                [low, high].map(|albedo| (um, model.shape.brdf(albedo.max(LEAST_ALBEDO)))).to_vec()
            }
            None => albedo.wavelength_um().iter().filter_map(|um| Some((*um, self.brdf(*um)?))).collect(),
        };
        let at = |factor: f64| At { factor, incidence_deg: 0.0, emission_deg: 0.0, azimuth_deg: 0.0, um: 0.0 };
        let [mut least, mut most] = [at(f64::INFINITY), at(f64::NEG_INFINITY)];
        for (um, brdf) in &surfaces {
            for incidence_deg in ANGLES_DEG {
                for emission_deg in ANGLES_DEG {
                    for azimuth_deg in AZIMUTHS_DEG {
                        let [i, e, azimuth] = [incidence_deg, emission_deg, azimuth_deg].map(f64::to_radians);
                        let factor = brdf.reflectance_factor(&PhotometricAngles::of_angles(i, e, azimuth));
                        let factor = if factor.is_nan() { f64::INFINITY } else { factor };
                        let found = || At { factor, incidence_deg, emission_deg, azimuth_deg, um: *um };
                        if factor < least.factor {
                            least = found();
                        }
                        if factor > most.factor {
                            most = found();
                        }
                    }
                }
            }
        }
        Some([least, most])
    }

    /// Says if a model sends less than nothing somewhere, as sums of polynomials may.
    pub(super) fn below_nothing(&self) -> Option<String> {
        let [least, _] = self.extremes()?;
        (least.factor < 0.0).then(|| {
            format!(
                "reflects less than nothing: its reflectance factor is {least}. Radiances there are negative: bring the coefficients of its phase function nearer to 0, so \
                 that it is negative at no angle"
            )
        })
    }

    /// The tables of parameters with their names; none for Lambert and models by numbers.
    pub fn parameters(&self) -> Vec<(&'static str, &Spectrum)> {
        match self {
            Photometry::Lambert | Photometry::Model(_) => vec![],
            Photometry::Hapke(p) => {
                Hapke::NAMES.into_iter().zip([&p.w, &p.c1, &p.c2, &p.c3, &p.c4, &p.h1, &p.h2]).collect()
            }
            Photometry::Rpv(p) => Rpv::NAMES.into_iter().zip([&p.rho0, &p.k, &p.g, &p.h]).collect(),
            Photometry::Table(table) => vec![("table", table.albedo()), ("factor", table.factor())],
        }
    }

    /// A sentence for each parameter that bands need where it is not known.
    pub(super) fn covers(&self, bands: &[Band], problem: impl FnMut(String)) {
        let of = |(name, spectrum): (&str, &Spectrum)| uncovered(name, spectrum, bands, |band| band.light.is_lit());
        self.parameters().into_iter().filter_map(of).for_each(problem);
    }

    /// What is wrong with the parameters: of each its key, empty for the model's own, and a sentence.
    pub(super) fn check(&self, mut tell: impl FnMut(&str, String)) {
        let mut is_right = true;
        let mut problem = |key: &str, message: String| {
            is_right = false;
            tell(key, message);
        };
        if let Photometry::Model(model) = self {
            model.problems().into_iter().for_each(|(key, message)| problem(key, message));
        }
        for (name, spectrum) in self.parameters() {
            if let Some(message) = spectrum.value().iter().find_map(|v| out_of_parameters(name, *v)) {
                problem("", message);
            }
        }
        let too_bright = match self {
            Photometry::Table(table) => Some(table.brightest().0).filter(|share| *share > MOST_FACTOR).map(|share| {
                format!("reflects {} times the light that arrives: factors are of order 1", number(share))
            }),
            _ => self.extremes().filter(|[_, most]| is_right && most.factor > MOST_FACTOR).map(|[_, most]| {
                format!(
                    "its reflectance factor is {most}, more than {MOST_FACTOR:e}: a number of it is out of all range"
                )
            }),
        };
        if let Some(message) = too_bright {
            tell("", message);
        }
    }
}
