//! Chandrasekhar's H function: multiple scattering by isotropic particles.

use std::f64::consts::PI;

/// Which H.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HFormula {
    /// Chandrasekhar's own, which conserves energy.
    #[default]
    Exact,
    /// (1 + 2 x) / (1 + 2 x sqrt(1 - w)). Source: Hapke (1981). Off by up to 4 %: at w = 1 and normal incidence the albedo is 4 % too large.
    Hapke1981,
    /// 1 / (1 - w x (r0 + (1 - 2 r0 x) / 2 ln((1 + x) / x))), r0 = (1 - g) / (1 + g), g = sqrt(1 - w). Source: Hapke (2002). Off by up
    /// to 0.8 %: at w = 1 and normal incidence the albedo is 1.4 % too small.
    Hapke2002,
}

/// H(x) of one single-scattering albedo.
#[derive(Debug, Clone, PartialEq)]
pub struct H(Form);

#[derive(Debug, Clone, PartialEq)]
enum Form {
    Table(Table),
    Hapke1981 { gamma: f64 },
    Hapke2002 { albedo: f64, r0: f64 },
}

/// An argument x, prepared for the H of any albedo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HPlace {
    x: f64,
    aside: f64,
}

impl HFormula {
    /// H of a single-scattering albedo w, 0 to 1.
    pub fn function(self, albedo: f64) -> H {
        let gamma = (1.0 - albedo).max(0.0).sqrt();
        H(match self {
            HFormula::Exact => Form::Table(Table::new(&LogSamples::new(albedo))),
            HFormula::Hapke1981 => Form::Hapke1981 { gamma },
            HFormula::Hapke2002 => Form::Hapke2002 { albedo, r0: (1.0 - gamma) / (1.0 + gamma) },
        })
    }

    /// Prepares an argument, 0 to 1, for the H of any albedo.
    #[inline]
    pub fn place(self, x: f64) -> HPlace {
        let aside = match self {
            // H has terms x ln x: polynomials follow it in a root of x.
            HFormula::Exact => x.sqrt().sqrt() * INTERVALS as f64,
            HFormula::Hapke1981 => 0.0,
            HFormula::Hapke2002 => x.recip().ln_1p(),
        };
        HPlace { x, aside }
    }
}

impl H {
    /// Which H it is.
    pub fn formula(&self) -> HFormula {
        match self.0 {
            Form::Table(_) => HFormula::Exact,
            Form::Hapke1981 { .. } => HFormula::Hapke1981,
            Form::Hapke2002 { .. } => HFormula::Hapke2002,
        }
    }

    /// H at an argument prepared by the same formula.
    #[inline]
    pub fn at(&self, place: &HPlace) -> f64 {
        let x = place.x;
        match &self.0 {
            Form::Table(table) => table.at(place.aside),
            Form::Hapke1981 { gamma } => (1.0 + 2.0 * x) / (1.0 + 2.0 * x * gamma),
            Form::Hapke2002 { albedo, r0 } => {
                1.0 / (1.0 - albedo * x * (r0 + (0.5 - r0 * x) * if x > 0.0 { place.aside } else { 0.0 }))
            }
        }
    }

    /// H(x), x from 0 to 1.
    pub fn of(&self, x: f64) -> f64 {
        self.at(&self.formula().place(x))
    }
}

/// Step of the sum below in ln t: what is left out goes as exp(-pi^2 / step), 5e-15.
const STEP: f64 = 0.3;
/// From exp(-40), below which nothing adds 1e-16 to any H, ...
const FIRST: i32 = -134;
/// ... to exp(55): 20 beyond 1 / x of the table's least x.
const LAST: i32 = 184;

/// ln(1 - w atan(t) / t) at even steps of ln t.
///
/// ln H(x) = -(1 / pi) int_0^inf ln(1 - w atan(t) / t) x dt / (1 + x^2 t^2). Source: Chandrasekhar (1960), sec. 39; Stibbs & Weir (1959).
/// In v = ln t the integrand is (1 / 2) sech(v + ln x) times the logarithm, analytic within pi / 2 of the real line whatever x and w are:
/// the trapezoidal rule converges exponentially, also at w = 1, where the logarithm is infinite.
#[derive(Debug, Clone, PartialEq)]
struct LogSamples(Vec<(f64, f64)>);

impl LogSamples {
    fn new(albedo: f64) -> Self {
        let sample = |j: i32| {
            let t = (STEP * f64::from(j)).exp();
            (t, (1.0 - albedo + albedo * one_minus_atan_ratio(t)).ln())
        };
        LogSamples((FIRST..=LAST).map(sample).collect())
    }

    fn h(&self, x: f64) -> f64 {
        // Below the least place of the table H is 1 to the last bit.
        if x < 1e-17 {
            return 1.0;
        }
        let sum: f64 = self.0.iter().map(|(t, log)| log / (t * x + 1.0 / (t * x))).sum();
        (-STEP / PI * sum).exp()
    }
}

/// 1 - atan(t) / t.
fn one_minus_atan_ratio(t: f64) -> f64 {
    if t > 0.1 {
        return 1.0 - t.atan() / t;
    }
    // t^2 / 3 - t^4 / 5 + ...: the difference above loses digits.
    let t2 = t * t;
    let inner = (2..9).rev().fold(0.0, |sum, k| 1.0 / f64::from(2 * k + 1) - t2 * sum);
    t2 * (1.0 / 3.0 - t2 * inner)
}

/// Intervals of x^(1/4), each with a polynomial of degree 5: relative error below 2e-11 (tested).
const INTERVALS: usize = 64;
const POINTS: usize = 6;

/// Newton's divided differences of H in each interval.
#[derive(Debug, Clone, PartialEq)]
struct Table(Vec<[f64; POINTS]>);

/// Chebyshev's points from 0 to 1: cos^2 of odd multiples of pi / 24.
const POINT: [f64; POINTS] = [
    0.982_962_913_144_534_2,
    0.853_553_390_593_273_8,
    0.629_409_522_551_260_4,
    0.370_590_477_448_739_6,
    0.146_446_609_406_726_24,
    0.017_037_086_855_465_858,
];

impl Table {
    fn new(samples: &LogSamples) -> Self {
        let differences = |i: usize| {
            let mut d = POINT.map(|p| samples.h(((i as f64 + p) / INTERVALS as f64).powi(4)));
            for level in 1..POINTS {
                for k in (level..POINTS).rev() {
                    d[k] = (d[k] - d[k - 1]) / (POINT[k] - POINT[k - level]);
                }
            }
            d
        };
        Table((0..INTERVALS).map(differences).collect())
    }

    #[inline]
    fn at(&self, place: f64) -> f64 {
        // The last interval holds its end, and what rounding puts beyond it. NaN is at 0, and stays NaN.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place is from 0 to 64")]
        let i = (place as usize).min(INTERVALS - 1);
        let t = place - i as f64;
        let d = &self.0[i];
        let mut value = d[POINTS - 1];
        for k in (0..POINTS - 1).rev() {
            value = value * (t - POINT[k]) + d[k];
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::GaussLegendre;

    #[test]
    fn the_published_formulas() {
        // In 40 digits: (x, w, H of 1981, H of 2002).
        for (x, w, of_1981, of_2002) in [
            (0.5, 0.07, 1.018_140_682_877_271_4, 1.019_900_160_728_586_2),
            (0.5, 0.5, 1.171_572_875_253_81, 1.185_758_911_563_829_2),
            (1.0, 0.5, 1.242_640_687_119_285, 1.249_391_866_935_168_7),
            (0.1, 0.9, 1.128_619_815_417_629_5, 1.167_472_135_198_409_2),
            (0.1, 1.0, 1.2, 1.243_650_868_367_563),
            (0.5, 1.0, 2.0, 2.0),
        ] {
            assert!((HFormula::Hapke1981.function(w).of(x) / of_1981 - 1.0).abs() < 1e-14);
            assert!((HFormula::Hapke2002.function(w).of(x) / of_2002 - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_exact_one() {
        // Chandrasekhar's integral equation, solved on 400 Gauss points to 1e-8; at w = 1, x = 1 his own table (1960, table XI).
        for (x, w, expected, tolerance) in [
            (0.1, 0.07, 1.008_580_213_740_935_2, 1e-8),
            (0.5, 0.07, 1.019_925_769_958_717_9, 1e-8),
            (0.1, 0.5, 1.072_368_762_029_906_7, 1e-8),
            (0.5, 0.5, 1.187_735_132_670_429_5, 1e-8),
            (1.0, 0.9, 1.850_098_516_769_812, 1e-8),
            (0.1, 1.0, 1.247_350_442_494_430_8, 1e-8),
            (0.5, 1.0, 2.012_778_769_997_179_8, 1e-8),
            (1.0, 1.0, 2.907_81, 2e-6),
        ] {
            let got = HFormula::Exact.function(w).of(x);
            assert!((got / expected - 1.0).abs() < tolerance, "{x} {w}: {got}");
        }
    }

    #[test]
    fn the_exact_one_satisfies_its_equation() {
        // 1 / H(x) = sqrt(1 - w) + (w / 2) int_0^1 y H(y) / (x + y) dy; in y = z^4, of which H is almost a polynomial.
        let rule = GaussLegendre::new(48);
        for w in [0.0, 0.03, 0.3, 0.72, 0.95, 0.9999, 1.0] {
            let h = LogSamples::new(w);
            for x in [1e-3, 0.04, 0.3, 1.0] {
                let integral = rule.integral(0.0, 1.0, |z| 4.0 * z.powi(7) * h.h(z.powi(4)) / (x + z.powi(4)));
                let inverse = (1.0_f64 - w).sqrt() + 0.5 * w * integral;
                assert!((inverse * h.h(x) - 1.0).abs() < 3e-12, "{w} {x}: {:e}", inverse * h.h(x) - 1.0);
            }
        }
    }

    #[test]
    fn the_table_is_the_sum() {
        let mut worst = 0.0_f64;
        for w in [0.0, 0.01, 0.1, 0.35, 0.6, 0.9, 0.99, 0.9999, 1.0] {
            let (table, sum) = (HFormula::Exact.function(w), LogSamples::new(w));
            for k in 0..=3000 {
                let x = (f64::from(k) / 3000.0).powi(6);
                worst = worst.max((table.of(x) / sum.h(x) - 1.0).abs());
            }
            for x in [1e-16, 1e-12, 1e-9] {
                worst = worst.max((table.of(x) / sum.h(x) - 1.0).abs());
            }
        }
        assert!(worst < 2e-11, "{worst:e}");
    }

    #[test]
    fn no_argument_and_no_albedo_are_1() {
        for formula in [HFormula::Exact, HFormula::Hapke1981, HFormula::Hapke2002] {
            assert!((formula.function(0.7).of(0.0) - 1.0).abs() < 1e-10, "{formula:?}");
            assert!((formula.function(0.0).of(0.7) - 1.0).abs() < 1e-15, "{formula:?}");
            assert!(formula.function(0.7).of(f64::NAN).is_nan());
        }
    }
}
