//! A surface by tables of measured reflectance factors.

use crate::physics::reflectance::albedo::Measure;
use crate::physics::reflectance::{Brdf, Table};
use crate::spectral::{Extend, Spectrum, between};

/// Reflectance factors by angles, at one or more wavelengths, times a factor that is a spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    tables: Vec<Table>,
    /// Hemispherical reflectance of each table, at its wavelength; for a single one it holds at all.
    albedo: Spectrum,
    /// By which the tables are multiplied.
    factor: Spectrum,
}

impl Tabulated {
    /// Tables at wavelengths, um; linear between them, as `extend` says beyond. A single one holds at all wavelengths.
    ///
    /// `None` without tables, unless there are as many wavelengths, which rise from above 0, or if their axes are not the same.
    pub fn new(wavelength_um: Vec<f64>, tables: Vec<Table>, extend: Extend) -> Option<Self> {
        let first = tables.first()?;
        if tables.len() != wavelength_um.len() || tables.iter().any(|table| !table.has_axes_of(first)) {
            return None;
        }
        let extend = if tables.len() == 1 { Extend::Hold } else { extend };
        let albedos = tables.iter().map(|table| Measure::Spherical.of(&Brdf::Table(table.clone()))).collect();
        let albedo = Spectrum::new(wavelength_um, albedos, extend)?;
        Some(Tabulated { tables, albedo, factor: Spectrum::constant(1.0) })
    }

    /// The same surface, with a factor.
    #[must_use]
    pub fn times(self, factor: Spectrum) -> Self {
        Tabulated { factor, ..self }
    }

    /// The same surface, with the factor by which it has this reflectance; `None` where it is black, or if there is no wavelength at which both are known.
    pub fn measured(self, reflectance: &Spectrum, measure: &Measure) -> Option<Self> {
        let of_tables: Vec<f64> =
            self.tables.iter().map(|table| measure.of(&Brdf::Table(table.clone())).recip()).collect();
        let inverse = Spectrum::new(self.albedo.wavelength_um().to_vec(), of_tables, self.albedo.extend())?;
        let factor = product(reflectance, &inverse.map(f64::recip), |reflectance, measured| reflectance / measured)?;
        Some(self.times(factor))
    }

    /// The wavelengths of the tables, um.
    pub fn wavelength_um(&self) -> &[f64] {
        self.albedo.wavelength_um()
    }

    /// The tables, as they are before the factor.
    pub fn tables(&self) -> &[Table] {
        &self.tables
    }

    /// The hemispherical reflectance of the tables.
    pub fn albedo(&self) -> &Spectrum {
        &self.albedo
    }

    /// By which the tables are multiplied.
    pub fn factor(&self) -> &Spectrum {
        &self.factor
    }

    /// Its hemispherical reflectance; `None` if tables and factor are known nowhere together.
    pub fn hemispherical(&self) -> Option<Spectrum> {
        product(&self.factor, &self.albedo, |factor, albedo| factor * albedo)
    }

    /// The surface at a wavelength, um; `None` where it is not known.
    pub fn brdf(&self, um: f64) -> Option<Brdf> {
        let factor = self.factor.at(um)?;
        self.albedo.at(um)?;
        let (before, share) = between(self.albedo.wavelength_um(), um);
        let table = &self.tables[before];
        let table = match self.tables.get(before + 1).filter(|_| share > 0.0) {
            Some(next) => table.mixed(1.0 - share, next, share),
            None => table.clone(),
        };
        Some(Brdf::Table(table.scaled(factor)))
    }

    /// The most that a table, times the factor, reflects of light from one of its angles: share, angle (rad) and wavelength (um).
    pub fn brightest(&self) -> (f64, f64, f64) {
        let mut most = (0.0, 0.0, 0.0);
        for (table, um) in self.tables.iter().zip(self.wavelength_um()) {
            let factor = if self.tables.len() == 1 { Some(self.factor.range().1) } else { self.factor.at(*um) };
            let brdf = Brdf::Table(table.clone());
            for angle_rad in table.incidence().angles_rad() {
                let measure = Measure::DirectionalHemispherical { cos_incidence: angle_rad.cos() };
                let share = factor.unwrap_or(0.0) * measure.of(&brdf);
                if share > most.0 {
                    most = (share, *angle_rad, *um);
                }
            }
        }
        most
    }

    /// Whether light and view may change places, at all wavelengths.
    pub fn is_reciprocal(&self) -> bool {
        self.tables.iter().all(Table::is_reciprocal)
    }
}

/// Two spectra combined on the union of their points; known where both are. `None` if that is nowhere, or not finite.
fn product(a: &Spectrum, b: &Spectrum, combine: impl Fn(f64, f64) -> f64) -> Option<Spectrum> {
    let both = [(0.5, a), (0.5, b)];
    let points = Spectrum::mixture(&both)?;
    let value: Option<Vec<f64>> =
        points.wavelength_um().iter().map(|um| Some(combine(a.at(*um)?, b.at(*um)?))).collect();
    Spectrum::new(points.wavelength_um().to_vec(), value?, points.extend())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::{Axis, PhotometricAngles};

    fn axis_deg(angles: &[f64]) -> Axis {
        Axis::new(angles.iter().map(|deg| f64::to_radians(*deg)).collect()).unwrap()
    }

    fn by_incidence(factors: [f64; 2]) -> Table {
        Table::by_incidence(axis_deg(&[0.0, 90.0]), factors.to_vec()).unwrap()
    }

    fn at(surface: &Tabulated, um: f64, incidence_deg: f64) -> f64 {
        let angles = PhotometricAngles::of_angles(incidence_deg.to_radians(), 0.3, 0.2);
        surface.brdf(um).unwrap().reflectance_factor(&angles)
    }

    #[test]
    fn tables_are_linear_between_wavelengths() {
        let tables = vec![by_incidence([0.1, 0.3]), by_incidence([0.2, 0.6])];
        let surface = Tabulated::new(vec![1.0, 2.0], tables, Extend::Error).unwrap();
        // At 45 deg 0.2 and 0.4; a quarter of the way.
        assert!((at(&surface, 1.25, 45.0) - 0.25).abs() < 1e-14);
        assert!(surface.brdf(0.9).is_none() && surface.brdf(2.1).is_none() && !surface.is_reciprocal());
        let doubled = surface.clone().times(Spectrum::constant(2.0));
        assert!((at(&doubled, 1.25, 45.0) - 0.5).abs() < 1e-14);
        let (um, unlike) = (vec![1.0, 2.0], Table::by_incidence(axis_deg(&[0.0]), vec![0.1]).unwrap());
        assert!(Tabulated::new(um, vec![by_incidence([0.1, 0.3]), unlike], Extend::Error).is_none());
    }

    #[test]
    fn a_spectrum_of_stated_geometry_sets_the_level() {
        let reflectance = Spectrum::new(vec![0.5, 3.0], vec![0.05, 0.1], Extend::Error).unwrap();
        let angles = PhotometricAngles::of_angles(45f64.to_radians(), 0.0, 0.0);
        let surface = Tabulated::new(vec![1.0], vec![by_incidence([0.1, 0.3])], Extend::Error).unwrap();
        let surface = surface.measured(&reflectance, &Measure::ReflectanceFactor(angles)).unwrap();
        assert!((at(&surface, 0.5, 45.0) - 0.05).abs() < 1e-15 && (at(&surface, 3.0, 0.0) - 0.05).abs() < 1e-15);
        assert!(surface.brdf(0.4).is_none());
        // A constant table reflects its factor, from all sides.
        let flat = Tabulated::new(vec![1.0], vec![by_incidence([0.4, 0.4])], Extend::Error).unwrap();
        assert!((flat.hemispherical().unwrap().value()[0] - 0.4).abs() < 1e-6 && flat.is_reciprocal());
        let (share, _, um) = flat.times(Spectrum::constant(3.0)).brightest();
        assert!((share - 1.2).abs() < 1e-6 && um == 1.0);
        let black = Tabulated::new(vec![1.0], vec![by_incidence([0.0, 0.0])], Extend::Error).unwrap();
        assert!(black.measured(&reflectance, &Measure::Spherical).is_none());
    }
}
