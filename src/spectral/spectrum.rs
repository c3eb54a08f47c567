//! A quantity tabulated over wavelength, linear between its points.

/// What a spectrum is beyond its first and last point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extend {
    /// Unknown: [`Spectrum::at`] gives `None`.
    #[default]
    Error,
    /// The nearest end's value.
    Hold,
}

/// Where a wavelength lies among some (um, ascending): the index of the last that is not above it, and the fraction of the way to the
/// next one, 0 to below 1: the next one's weight in linear interpolation that holds the ends.
pub fn between(points_um: &[f64], um: f64) -> (usize, f64) {
    let after = points_um.partition_point(|point| *point <= um);
    if after == 0 || after == points_um.len() {
        return (after.saturating_sub(1), 0.0);
    }
    let (before, next) = (points_um[after - 1], points_um[after]);
    (after - 1, (um - before) / (next - before))
}

/// A table of values over wavelength (um), linear between the points.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    wavelength_um: Vec<f64>,
    value: Vec<f64>,
    extend: Extend,
}

impl Spectrum {
    /// A table; `None` unless wavelengths are finite, positive and strictly increasing, values finite, and there is at least one point.
    pub fn new(wavelength_um: Vec<f64>, value: Vec<f64>, extend: Extend) -> Option<Self> {
        let good = !wavelength_um.is_empty()
            && wavelength_um.len() == value.len()
            && wavelength_um.iter().chain(&value).all(|x| x.is_finite())
            && wavelength_um[0] > 0.0
            && wavelength_um.windows(2).all(|w| w[0] < w[1]);
        good.then_some(Spectrum { wavelength_um, value, extend })
    }

    /// The same value at every wavelength.
    pub fn constant(value: f64) -> Self {
        Spectrum { wavelength_um: vec![1.0], value: vec![value], extend: Extend::Hold }
    }

    /// The points' wavelengths, um.
    pub fn wavelength_um(&self) -> &[f64] {
        &self.wavelength_um
    }

    /// The points' values.
    pub fn value(&self) -> &[f64] {
        &self.value
    }

    /// What it is beyond its ends.
    pub fn extend(&self) -> Extend {
        self.extend
    }

    /// The first and last wavelength that the spectrum is known at, um: all of them if it is held beyond its ends.
    pub fn coverage_um(&self) -> (f64, f64) {
        match self.extend {
            Extend::Hold => (0.0, f64::INFINITY),
            Extend::Error => (self.wavelength_um[0], self.wavelength_um[self.wavelength_um.len() - 1]),
        }
    }

    /// The least and the largest value.
    pub fn range(&self) -> (f64, f64) {
        self.value.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)))
    }

    /// The value at a wavelength, um; `None` outside the coverage.
    pub fn at(&self, um: f64) -> Option<f64> {
        let (first, last) = self.coverage_um();
        if !(first <= um && um <= last) {
            return None;
        }
        let (before, share) = between(&self.wavelength_um, um);
        let value = self.value[before];
        Some(if share > 0.0 { value + share * (self.value[before + 1] - value) } else { value })
    }

    /// Integral over wavelength from `a_um` to `b_um` (trapezoids on the table's points and the two ends): value unit x um.
    pub fn integral(&self, a_um: f64, b_um: f64) -> Option<f64> {
        let mut previous = (a_um, self.at(a_um)?);
        let end = (b_um, self.at(b_um)?);
        let inside = self.wavelength_um.iter().zip(&self.value).filter(|(w, _)| **w > a_um && **w < b_um);
        let mut sum = 0.0;
        for (w, v) in inside.map(|(w, v)| (*w, *v)).chain([end]) {
            sum += 0.5 * (w - previous.0) * (v + previous.1);
            previous = (w, v);
        }
        Some(sum)
    }

    /// Sum of spectra times weights, on the union of their points. Known where all are; held only if all are.
    pub fn mixture(parts: &[(f64, &Spectrum)]) -> Option<Self> {
        let first = parts.iter().map(|(_, s)| s.coverage_um().0).fold(0.0, f64::max);
        let last = parts.iter().map(|(_, s)| s.coverage_um().1).fold(f64::INFINITY, f64::min);
        let mut points: Vec<f64> = parts
            .iter()
            .flat_map(|(_, s)| s.wavelength_um.iter().copied())
            .filter(|w| first <= *w && *w <= last)
            .collect();
        points.sort_by(f64::total_cmp);
        points.dedup();
        let value = points
            .iter()
            .map(|&um| parts.iter().map(|(weight, s)| Some(weight * s.at(um)?)).sum())
            .collect::<Option<Vec<f64>>>()?;
        let held = parts.iter().all(|(_, s)| s.extend == Extend::Hold);
        Spectrum::new(points, value, if held { Extend::Hold } else { Extend::Error })
    }

    /// The spectrum with every value changed by `f`, which may fail.
    ///
    /// # Errors
    /// The first failure.
    pub fn try_map<E>(&self, f: impl FnMut(f64) -> Result<f64, E>) -> Result<Self, E> {
        let value = self.value.iter().copied().map(f).collect::<Result<_, E>>()?;
        Ok(Spectrum { value, ..self.clone() })
    }

    /// The spectrum with every value changed by `f`.
    #[must_use]
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Spectrum { value: self.value.iter().map(|&v| f(v)).collect(), ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_between_points_and_unknown_beyond() {
        let s = Spectrum::new(vec![1.0, 2.0, 4.0], vec![0.0, 1.0, 5.0], Extend::Error).unwrap();
        assert_eq!(s.at(1.5), Some(0.5));
        assert_eq!(s.at(3.0), Some(3.0));
        assert_eq!(s.at(4.0), Some(5.0));
        assert_eq!(s.at(0.99), None);
        assert_eq!(s.at(f64::NAN), None);
        assert_eq!(s.integral(1.0, 4.0), Some(0.5 + 6.0));
        assert_eq!(s.integral(1.5, 3.0), Some(0.375 + 2.0));
    }

    #[test]
    fn held_ends() {
        let s = Spectrum::new(vec![1.0, 2.0], vec![0.1, 0.2], Extend::Hold).unwrap();
        assert_eq!((s.at(0.5), s.at(9.0)), (Some(0.1), Some(0.2)));
        assert_eq!(Spectrum::constant(0.07).at(3.6), Some(0.07));
    }

    #[test]
    fn refuses_disorder() {
        assert!(Spectrum::new(vec![1.0, 1.0], vec![0.0, 0.0], Extend::Error).is_none());
        assert!(Spectrum::new(vec![], vec![], Extend::Error).is_none());
        assert!(Spectrum::new(vec![1.0], vec![f64::NAN], Extend::Error).is_none());
        assert!(Spectrum::new(vec![-1.0], vec![0.0], Extend::Error).is_none());
    }

    #[test]
    fn mixture_is_linear() {
        let a = Spectrum::new(vec![1.0, 3.0], vec![0.0, 2.0], Extend::Error).unwrap();
        let b = Spectrum::constant(1.0);
        let m = Spectrum::mixture(&[(0.25, &a), (0.75, &b)]).unwrap();
        assert_eq!(m.at(2.0), Some(1.0));
        assert_eq!(m.at(3.5), None);
    }
}
