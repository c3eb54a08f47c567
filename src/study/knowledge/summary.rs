//! Summary statistics of an image's errors.

use serde::Serialize;

use super::budget::{Budget, Part, PixelBudget};
use super::drawn::nearest_rank;

/// Statistics over pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Their mean.
    pub mean: f64,
    /// Their root mean square.
    pub rms: f64,
    /// 95th percentile.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

/// A source's errors over all pixels; each pixel's is its root mean square, bias and scatter together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// A source; `rss`, the root of the sum of their squares; `total`, all at once; or `monte_carlo`, the same from draws.
    pub source: &'static str,
    /// Pixels whose believed rays hit the surface.
    pub pixels: usize,
    /// 3D error, m.
    pub error_m: Spread,
    /// Horizontal error, m.
    pub level_m: Spread,
    /// Horizontal error, pixels.
    pub level_px: Spread,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        let n = values.len() as f64;
        Some(Spread {
            mean: values.iter().sum::<f64>() / n,
            rms: (values.iter().map(|x| x * x).sum::<f64>() / n).sqrt(),
            p95: nearest_rank(&values, 0.95)?,
            max: *values.last()?,
        })
    }
}

/// A row for each source that has an error anywhere, and for all of them.
pub fn summary(budget: &Budget) -> Vec<Row> {
    let row = |source: &'static str, of: &dyn Fn(&PixelBudget) -> Option<[f64; 2]>| {
        let found: Vec<([f64; 2], f64)> =
            budget.pixels.iter().flatten().filter_map(|pixel| Some((of(pixel)?, pixel.pixel_m))).collect();
        Some(Row {
            source,
            pixels: found.len(),
            error_m: Spread::of(found.iter().map(|([error, _], _)| *error).collect())?,
            level_m: Spread::of(found.iter().map(|([_, level], _)| *level).collect())?,
            level_px: Spread::of(found.iter().map(|([_, level], pixel_m)| level / pixel_m).collect())?,
        })
    };
    let sizes = |part: &Part| [part.rms_m(), part.level_m()];
    let by_source = budget.sources.iter().enumerate();
    let by_source = by_source.map(|(i, source)| row(source.name(), &|pixel| pixel.sources[i].as_ref().map(sizes)));
    let rss = row("rss", &|pixel| {
        let parts: Option<Vec<[f64; 2]>> = pixel.sources.iter().map(|part| part.as_ref().map(sizes)).collect();
        Some(parts?.iter().fold([0.0, 0.0], |sum: [f64; 2], part| [sum[0].hypot(part[0]), sum[1].hypot(part[1])]))
    });
    let total = row("total", &|pixel| pixel.total.as_ref().map(sizes));
    let sampled = row("monte_carlo", &|pixel| {
        let sampled = pixel.sampled.filter(|sampled| sampled.met > 0)?;
        Some(sizes(&Part { bias_m: sampled.mean_m, covariance_m2: sampled.covariance_m2 }))
    });
    by_source.chain([rss, total, sampled]).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_are_those_of_a_hundred_numbers() {
        let spread = Spread::of((1..=100).rev().map(f64::from).collect()).unwrap();
        // 1 + .. + 100 = 5050; 1 + 4 + .. + 10000 = 338350.
        assert_eq!(spread, Spread { mean: 50.5, rms: 3383.5_f64.sqrt(), p95: 95.0, max: 100.0 });
        assert_eq!(Spread::of(vec![]), None);
    }
}
