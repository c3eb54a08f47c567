//! Spectra that share their wavelengths and belong together: what one table of a spectral library holds.

use crate::error::{Error, Location, Problem, Result, number};

use super::{Band, Extend, MOST_BEYOND, Spectrum};

/// What is known of one material over wavelength: its reflectance, or the parameters of a reflectance model.
///
/// Reflectances and transmittances are fractions, wavelengths um, whatever the file had.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SpectralLibrary {
    /// The material.
    pub name: String,
    /// What is said of it, for people; may have several lines.
    pub comment: String,
    /// Wavelengths of all columns, um; positive, strictly ascending.
    pub wavelength_um: Vec<f64>,
    /// The spectra.
    pub columns: Vec<Column>,
}

/// A spectrum of a [`SpectralLibrary`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Column {
    /// Its name, as "reflectance".
    pub name: String,
    /// A value for each wavelength.
    pub values: Vec<f64>,
}

impl SpectralLibrary {
    /// The values of a column; the case of its name does not matter.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|c| c.name.eq_ignore_ascii_case(name)).map(|c| c.values.as_slice())
    }

    /// A column as a spectrum; `None` if there is no such column, or if its values do not make a valid spectrum.
    pub fn spectrum(&self, name: &str, extend: Extend) -> Option<Spectrum> {
        Spectrum::new(self.wavelength_um.clone(), self.column(name)?.to_vec(), extend)
    }

    /// First and last wavelength, um; `None` if there are none.
    pub fn coverage_um(&self) -> Option<(f64, f64)> {
        Some((*self.wavelength_um.first()?, *self.wavelength_um.last()?))
    }

    /// Checks what the fields promise.
    ///
    /// # Errors
    /// [`Error::Invalid`]: no wavelengths or columns, wavelengths that do not ascend from above 0, columns of another
    /// length or of the same name, numbers that are not finite.
    pub fn check(&self) -> Result<()> {
        let at = || Location::item(format!("spectra of {:?}", self.name));
        let mut problems = Vec::new();
        let mut push = |message: String| problems.push(Problem::new(at(), message));
        let ascending = self.wavelength_um.windows(2).all(|w| w[0] < w[1]);
        if self.wavelength_um.is_empty() || self.columns.is_empty() {
            push("there is nothing in them".into());
        } else if !ascending || self.wavelength_um[0] <= 0.0 || !self.wavelength_um.iter().all(|w| w.is_finite()) {
            push("wavelengths must be positive and ascend".into());
        }
        for (i, column) in self.columns.iter().enumerate() {
            if column.values.len() != self.wavelength_um.len() {
                let (values, wavelengths) = (column.values.len(), self.wavelength_um.len());
                push(format!("{}: {values} values for {wavelengths} wavelengths", column.name));
            }
            if !column.values.iter().all(|v| v.is_finite()) {
                push(format!("{}: not all values are finite numbers", column.name));
            }
            if self.columns[..i].iter().any(|c| c.name.eq_ignore_ascii_case(&column.name)) {
                push(format!("{}: appears twice", column.name));
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
    }

    /// The spectra as bands see them: the mean of each column over each band's response, at the band's centre.
    ///
    /// Columns are linear between their wavelengths. Parameters of reflectance models are averaged directly, which
    /// is not the same as averaging the model's result. Responses end where the wavelengths do. Bands may be in any order; the result ascends.
    ///
    /// # Errors
    /// [`Error::Invalid`] for bands of which more than [`MOST_BEYOND`] lies beyond the wavelengths, or that share their centre; as
    /// [`check`](SpectralLibrary::check).
    pub fn resample(&self, bands: &[Band]) -> Result<SpectralLibrary> {
        self.check()?;
        let mut bands: Vec<(usize, &Band)> = bands.iter().enumerate().collect();
        bands.sort_by(|a, b| a.1.centre_um.total_cmp(&b.1.centre_um));
        let at = |band: usize| Location::item(format!("spectra of {:?}, band {}", self.name, band + 1));
        let (first, last) = self.coverage_um().unwrap_or_default();
        let mut problems: Vec<Problem> = Vec::new();
        for (i, band) in &bands {
            let (from, to) = band.support_um();
            if !(0.0..=MOST_BEYOND).contains(&band.share_beyond((first, last))) {
                let [from, to, first, last] = [from, to, first, last].map(number);
                let message = format!("looks at {from} to {to} um, which is not within the known {first} to {last} um");
                problems.push(Problem::new(at(*i), message));
            }
        }
        let same = bands.windows(2).filter(|pair| pair[0].1.centre_um == pair[1].1.centre_um);
        problems.extend(same.map(|pair| Problem::new(at(pair[1].0), "has the centre of another band")));
        if !problems.is_empty() {
            return Err(Error::Invalid(problems));
        }
        let nodes: Vec<_> = bands.iter().map(|(_, band)| band.quadrature(&self.wavelength_um, (first, last))).collect();
        let mean = |column: &Column| {
            let spectrum = self.spectrum(&column.name, Extend::Error)?;
            let values = nodes.iter().map(|n| n.iter().map(|(um, weight)| Some(weight * spectrum.at(*um)?)).sum());
            Some(Column { name: column.name.clone(), values: values.collect::<Option<_>>()? })
        };
        let columns = self.columns.iter().map(mean).collect::<Option<Vec<_>>>();
        Ok(SpectralLibrary {
            name: self.name.clone(),
            comment: self.comment.clone(),
            wavelength_um: bands.iter().map(|(_, band)| band.centre_um).collect(),
            columns: columns.ok_or_else(|| Error::invalid(Location::item(&*self.name), "cannot be resampled"))?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library() -> SpectralLibrary {
        let column = |name: &str, values: &[f64]| Column { name: name.into(), values: values.into() };
        SpectralLibrary {
            name: "a".into(),
            comment: String::new(),
            wavelength_um: vec![1.0, 2.0, 4.0],
            columns: vec![column("reflectance", &[0.0, 0.5, 0.1]), column("flat", &[0.3; 3])],
        }
    }

    #[test]
    fn bands_see_means_in_ascending_order() {
        let bands = [(3.0, None), (2.0, Some(0.1)), (1.5, Some(0.1))].map(|(c, f)| Band::new(c, f));
        let seen = library().resample(&bands).unwrap();
        assert_eq!(seen.wavelength_um, [1.5, 2.0, 3.0]);
        let reflectance = seen.column("Reflectance").unwrap();
        // Linear: the centre's value. At the corner, half a Gaussian on slopes of 0.5 and -0.2: 0.5 - 0.35 s sqrt(2 / pi).
        let s = 0.1 / 2.354_820_045_030_949;
        let corner = 0.5 - 0.35 * s * (2.0 / std::f64::consts::PI).sqrt();
        for (value, expected) in reflectance.iter().zip([0.25, corner, 0.3]) {
            assert!((value - expected).abs() < 1e-8, "{value} {expected}");
        }
        assert!(seen.column("flat").unwrap().iter().all(|v| (v - 0.3).abs() < 1e-15));
    }

    #[test]
    fn bands_beyond_the_wavelengths_are_told() {
        let bands = [Band::new(4.0, Some(0.01)), Band::new(1.5, None)];
        let told = library().resample(&bands).unwrap_err().to_string();
        assert!(told.contains("band 1: looks at 3.97") && told.ends_with("known 1 to 4 um"), "{told}");
        let nan = Band::new(f64::NAN, None);
        assert!(library().resample(&[nan]).is_err());
        assert!(
            library()
                .resample(&[bands[1].clone(), bands[1].clone()])
                .unwrap_err()
                .to_string()
                .contains("centre of another")
        );
    }

    #[test]
    fn what_is_no_table_is_told() {
        let mut bad = library();
        bad.columns[1].values.pop();
        bad.columns[1].name = "Reflectance".into();
        bad.columns[0].values[0] = f64::NAN;
        bad.wavelength_um[1] = 1.0;
        assert_eq!(bad.check().unwrap_err().to_string().lines().count(), 4);
        assert!(SpectralLibrary::default().check().is_err());
    }
}
