//! By how much an image differs from the true one, pixel by pixel.

/// Of the median sunlit radiance of a band; where less is true, errors are relative to this much.
pub const FLOOR: f64 = 0.01;

/// How errors are distributed over some pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Number of pixels.
    pub pixels: usize,
    /// Half of the pixels are off by less.
    pub p50: f64,
    /// All but 1 % of the pixels are off by less.
    pub p99: f64,
    /// All but 0.1 % of the pixels are off by less.
    pub p999: f64,
    /// The worst pixel.
    pub max: f64,
    /// Root of the mean square.
    pub rms: f64,
}

/// Errors of an image in one band.
#[derive(Debug, Clone, PartialEq)]
pub struct BandErrors {
    /// Of each pixel; NaN where there is no surface.
    pub of_pixel: Vec<f64>,
    /// Over all pixels that see the surface.
    pub all: Spread,
    /// Over those of which more is lit than not.
    pub lit: Spread,
    /// Over the others.
    pub shadowed: Spread,
}

/// What pixels see in the true image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ground {
    /// No surface.
    Sky,
    /// More sunlit surface than not.
    Lit,
    /// More surface in shadow than not.
    Shadowed,
}

impl Spread {
    /// Of these errors; all 0 of none.
    pub fn of(mut errors: Vec<f64>) -> Self {
        let pixels = errors.len();
        if pixels == 0 {
            return Spread::default();
        }
        errors.sort_by(f64::total_cmp);
        // The least error that this share of the pixels does not exceed.
        let below = |share: f64| errors[crate::geometry::whole((share * pixels as f64).ceil()).clamp(1, pixels) - 1];
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / pixels as f64).sqrt();
        Spread { pixels, p50: below(0.5), p99: below(0.99), p999: below(0.999), max: errors[pixels - 1], rms }
    }
}

/// Median radiance of the sunlit pixels; of all with a surface if none are lit.
pub fn reference_radiance(truth: &[f64], ground: &[Ground]) -> f64 {
    let of = |wanted: &dyn Fn(Ground) -> bool| -> Vec<f64> {
        truth.iter().zip(ground).filter(|(_, g)| wanted(**g)).map(|(l, _)| *l).collect()
    };
    let mut values = of(&|g| g == Ground::Lit);
    if values.is_empty() {
        values = of(&|g| g != Ground::Sky);
    }
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Error of a pixel: |difference| / max(|truth|, [`FLOOR`] x the median sunlit radiance of the band).
pub fn pixel_error(value: f64, truth: f64, reference: f64) -> f64 {
    let off = (value - truth).abs();
    if off == 0.0 { 0.0 } else { off / truth.abs().max(FLOOR * reference) }
}

impl BandErrors {
    /// Of an image against the true one.
    pub fn new(image: &[f64], truth: &[f64], ground: &[Ground]) -> Self {
        let reference = reference_radiance(truth, ground);
        let of_pixel: Vec<f64> = image
            .iter()
            .zip(truth)
            .zip(ground)
            .map(|((l, t), g)| if *g == Ground::Sky { f64::NAN } else { pixel_error(*l, *t, reference) })
            .collect();
        let over = |wanted: &dyn Fn(Ground) -> bool| {
            Spread::of(of_pixel.iter().zip(ground).filter(|(_, g)| wanted(**g)).map(|(e, _)| *e).collect())
        };
        BandErrors {
            all: over(&|g| g != Ground::Sky),
            lit: over(&|g| g == Ground::Lit),
            shadowed: over(&|g| g == Ground::Shadowed),
            of_pixel,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_a_hundred_numbers() {
        let spread = Spread::of((1..=1000).map(f64::from).collect());
        assert_eq!((spread.p50, spread.p99, spread.p999, spread.max), (500.0, 990.0, 999.0, 1000.0));
        assert_eq!(Spread::of(vec![3.0, 4.0]).rms, 12.5_f64.sqrt());
        assert_eq!(Spread::of(vec![]), Spread::default());
    }

    #[test]
    fn dark_pixels_are_judged_by_the_floor() {
        let ground = [Ground::Lit, Ground::Shadowed, Ground::Sky];
        let errors = BandErrors::new(&[11.0, 0.05, 7.0], &[10.0, 0.0, 0.0], &ground);
        // 1 / 10, and 0.05 / (0.01 x 10).
        assert!((errors.lit.max - 0.1).abs() < 1e-15 && (errors.shadowed.max - 0.5).abs() < 1e-15);
        assert!(errors.of_pixel[2].is_nan());
        assert_eq!(errors.all.pixels, 2);
    }
}
