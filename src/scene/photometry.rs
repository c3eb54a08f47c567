//! How a surface's reflectance depends on the directions of light and view: parameters, carried as data.

use super::coverage::uncovered;
use crate::spectral::{Band, Spectrum};

/// The model of a surface's bidirectional reflectance.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Photometry {
    /// The same radiance in every direction: the material's reflectance is all there is.
    #[default]
    Lambert,
    /// Hapke's.
    Hapke(Box<Hapke>),
    /// That of Rahman, Pinty and Verstraete.
    Rpv(Box<Rpv>),
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

impl Photometry {
    /// The model's name in a scene file; `None` for Lambert, which needs none.
    pub fn key(&self) -> Option<&'static str> {
        match self {
            Photometry::Lambert => None,
            Photometry::Hapke(_) => Some("hapke"),
            Photometry::Rpv(_) => Some("rpv"),
        }
    }

    /// The parameters with their names; none for Lambert.
    pub fn parameters(&self) -> Vec<(&'static str, &Spectrum)> {
        match self {
            Photometry::Lambert => vec![],
            Photometry::Hapke(p) => {
                Hapke::NAMES.into_iter().zip([&p.w, &p.c1, &p.c2, &p.c3, &p.c4, &p.h1, &p.h2]).collect()
            }
            Photometry::Rpv(p) => Rpv::NAMES.into_iter().zip([&p.rho0, &p.k, &p.g, &p.h]).collect(),
        }
    }

    /// A sentence for each parameter that bands need where it is not known.
    pub(super) fn covers(&self, bands: &[Band], problem: impl FnMut(String)) {
        let of = |(name, spectrum): (&str, &Spectrum)| uncovered(name, spectrum, bands, |band| band.light.is_lit());
        self.parameters().into_iter().filter_map(of).for_each(problem);
    }

    /// What is wrong with the parameters, a sentence for each.
    pub(super) fn check(&self, mut problem: impl FnMut(String)) {
        for (name, spectrum) in self.parameters() {
            let (low, high) = match name {
                "w" => (0.0, 1.0),
                "h1" | "h2" | "rho0" | "k" => (0.0, f64::INFINITY),
                "g" => (-1.0, 1.0),
                _ => continue,
            };
            // A peak without width, or a scattering into one direction only, is no function.
            let open = matches!(name, "h2" | "g");
            let is_wrong = |v: &&f64| !(low..=high).contains(*v) || (open && (**v == low || **v == high));
            if let Some(v) = spectrum.value().iter().find(is_wrong) {
                let range = if high.is_infinite() { format!("from {low}") } else { format!("from {low} to {high}") };
                problem(format!(
                    "{name} = {v} is out of range, which is {range}{}",
                    if open { ", ends excluded" } else { "" }
                ));
            }
        }
    }
}
