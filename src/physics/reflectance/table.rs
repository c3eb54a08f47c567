//! Reflectance as measured: a table over angles.

use std::f64::consts::PI;

use super::PhotometricAngles;

/// Reflectance factors REFF on a grid of angles; linear in each angle between them.
///
/// Source: equations (13) to (15) of Domagala (2020), by incidence, by incidence and emission, and with the azimuth. Reciprocal only if its
/// numbers are. Limits: beyond the first and last angle of an axis that one's value holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    incidence: Axis,
    emission: Axis,
    azimuth: Axis,
    reflectance_factor: Vec<f64>,
}

/// Angles of a table, rad, that rise.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis(Vec<f64>);

impl Axis {
    /// An axis; `None` unless angles are finite, rise, and are one at least.
    pub fn new(angles_rad: Vec<f64>) -> Option<Self> {
        let rises = angles_rad.windows(2).all(|pair| pair[0] < pair[1]);
        (!angles_rad.is_empty() && rises && angles_rad.iter().all(|a| a.is_finite())).then_some(Axis(angles_rad))
    }

    /// The angles, rad.
    pub fn angles_rad(&self) -> &[f64] {
        &self.0
    }

    /// How many angles it has.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The two angles next to this one, each with its share.
    fn shares(&self, angle_rad: f64) -> [(usize, f64); 2] {
        let above = self.0.partition_point(|&a| a <= angle_rad).clamp(1, self.0.len().max(2) - 1);
        let Some(&high) = self.0.get(above) else { return [(0, 1.0), (0, 0.0)] };
        let low = self.0[above - 1];
        let share = ((angle_rad - low) / (high - low)).clamp(0.0, 1.0);
        [(above - 1, 1.0 - share), (above, share)]
    }
}

impl Table {
    /// By incidence alone: a factor for each of its angles; `None` if their numbers differ.
    pub fn by_incidence(incidence: Axis, reflectance_factor: Vec<f64>) -> Option<Self> {
        Self::by_incidence_and_emission(incidence, Axis(vec![0.0]), reflectance_factor)
    }

    /// By incidence and emission, \[incidence, emission\]; `None` if there are not as many factors as that.
    pub fn by_incidence_and_emission(incidence: Axis, emission: Axis, reflectance_factor: Vec<f64>) -> Option<Self> {
        Self::bidirectional(incidence, emission, Axis(vec![0.0]), reflectance_factor)
    }

    /// By incidence, emission and azimuth, \[incidence, emission, azimuth\], the azimuth from 0 (view on the side of the light) to pi;
    /// `None` if there are not as many factors as that, or one is not a number from 0.
    pub fn bidirectional(incidence: Axis, emission: Axis, azimuth: Axis, reflectance_factor: Vec<f64>) -> Option<Self> {
        let count = incidence.count() * emission.count() * azimuth.count();
        let all_right = reflectance_factor.iter().all(|&factor| factor >= 0.0 && factor.is_finite());
        (reflectance_factor.len() == count && all_right).then_some(Table {
            incidence,
            emission,
            azimuth,
            reflectance_factor,
        })
    }

    /// Its angles of incidence.
    pub fn incidence(&self) -> &Axis {
        &self.incidence
    }

    /// Its angles of emission.
    pub fn emission(&self) -> &Axis {
        &self.emission
    }

    /// Its azimuths.
    pub fn azimuth(&self) -> &Axis {
        &self.azimuth
    }

    /// Its reflectance factors, \[incidence, emission, azimuth\].
    pub fn factors(&self) -> &[f64] {
        &self.reflectance_factor
    }

    /// Whether it has the angles of another one.
    pub fn has_axes_of(&self, other: &Table) -> bool {
        self.incidence == other.incidence && self.emission == other.emission && self.azimuth == other.azimuth
    }

    /// The sum of this one and another, which has the same angles, each times its share.
    #[must_use]
    pub fn mixed(&self, share: f64, other: &Table, other_share: f64) -> Table {
        let pairs = self.reflectance_factor.iter().zip(&other.reflectance_factor);
        let reflectance_factor = pairs.map(|(a, b)| share * a + other_share * b).collect();
        Table { reflectance_factor, ..self.clone() }
    }

    /// The same with all factors multiplied.
    #[must_use]
    pub fn scaled(&self, by: f64) -> Table {
        Table { reflectance_factor: self.reflectance_factor.iter().map(|factor| by * factor).collect(), ..self.clone() }
    }

    /// The BRDF, 1/sr.
    pub fn brdf(&self, angles: &PhotometricAngles) -> f64 {
        let mut factor = 0.0;
        for (i, of_incidence) in self.incidence.shares(angles.cos_incidence().acos()) {
            for (e, of_emission) in self.emission.shares(angles.cos_emission().acos()) {
                for (a, of_azimuth) in self.azimuth.shares(angles.azimuth_rad()) {
                    factor += of_incidence * of_emission * of_azimuth * self.factor(i, e, a);
                }
            }
        }
        factor / PI
    }

    fn factor(&self, i: usize, e: usize, a: usize) -> f64 {
        self.reflectance_factor[(i * self.emission.count() + e) * self.azimuth.count() + a]
    }

    /// Whether incidence and emission may change places in it, to the last bit.
    pub fn is_reciprocal(&self) -> bool {
        let first = self.reflectance_factor[0];
        let all = |axis: &Axis| 0..axis.count();
        self.reflectance_factor.iter().all(|&factor| factor == first)
            || self.incidence == self.emission
                && all(&self.incidence)
                    .all(|i| (0..i).all(|e| all(&self.azimuth).all(|a| self.factor(i, e, a) == self.factor(e, i, a))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis_deg<const N: usize>(angles: [f64; N]) -> Axis {
        Axis::new(angles.map(f64::to_radians).to_vec()).unwrap()
    }

    fn factor(table: &Table, i_deg: f64, e_deg: f64, azimuth_deg: f64) -> f64 {
        let [i, e, a] = [i_deg, e_deg, azimuth_deg].map(f64::to_radians);
        PI * table.brdf(&PhotometricAngles::of_angles(i, e, a))
    }

    #[test]
    fn by_incidence() {
        let table = Table::by_incidence(axis_deg([0.0, 30.0, 60.0]), vec![0.1, 0.2, 0.4]).unwrap();
        for (i_deg, expected) in [(0.0, 0.1), (15.0, 0.15), (30.0, 0.2), (50.0, 1.0 / 3.0), (60.0, 0.4), (80.0, 0.4)] {
            assert!((factor(&table, i_deg, 70.0, 33.0) - expected).abs() < 1e-15, "{i_deg}");
        }
        assert!(!table.is_reciprocal());
    }

    #[test]
    fn by_incidence_and_emission() {
        let axis = axis_deg([0.0, 90.0]);
        let table = Table::by_incidence_and_emission(axis.clone(), axis, vec![0.1, 0.3, 0.3, 0.7]).unwrap();
        // A quarter of the way in one, half of it in the other: 3/8 0.1 + 3/8 0.3 + 1/8 0.3 + 1/8 0.7.
        assert!((factor(&table, 22.5, 45.0, 10.0) - 0.275).abs() < 1e-15);
        assert!((factor(&table, 45.0, 22.5, 10.0) - 0.275).abs() < 1e-15);
        assert!(table.is_reciprocal());
    }

    #[test]
    fn with_the_azimuth() {
        let (zenith, azimuth) = (axis_deg([0.0, 80.0]), axis_deg([0.0, 180.0]));
        let values = (0..8).map(f64::from).collect();
        let table = Table::bidirectional(zenith.clone(), zenith, azimuth, values).unwrap();
        // [incidence, emission, azimuth]: 4 i + 2 e + a.
        assert!((factor(&table, 40.0, 20.0, 45.0) - (2.0 + 0.5 + 0.25)).abs() < 1e-14);
        assert!(!table.is_reciprocal());
    }

    #[test]
    fn what_is_no_table() {
        assert!(
            Axis::new(vec![]).is_none() && Axis::new(vec![1.0, 1.0]).is_none() && Axis::new(vec![f64::NAN]).is_none()
        );
        let one = || Axis::new(vec![0.5]).unwrap();
        assert!(Table::by_incidence(one(), vec![]).is_none() && Table::by_incidence(one(), vec![-0.1]).is_none());
        let constant = Table::by_incidence(one(), vec![0.1]).unwrap();
        assert!((factor(&constant, 10.0, 20.0, 30.0) - 0.1).abs() < 1e-16 && constant.is_reciprocal());
    }
}
