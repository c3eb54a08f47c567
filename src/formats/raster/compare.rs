//! What rasters hold: statistics of a band, and in what two rasters differ.

use crate::error::Result;
use crate::formats::envi::BandStatistics;
use crate::progress::{Watch, tell};

use super::Raster;

/// At most this many lines are listed one by one.
const TOLD: usize = 20;

/// What the values of a band are like; NaN does not count.
pub fn statistics(values: &[f64]) -> BandStatistics {
    let mut all = BandStatistics { count: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0 };
    for value in values.iter().filter(|v| !v.is_nan()) {
        all.count += 1;
        all.min = all.min.min(*value);
        all.max = all.max.max(*value);
        all.mean += *value;
    }
    match all.count {
        0 => BandStatistics { count: 0, min: f64::NAN, max: f64::NAN, mean: f64::NAN },
        n => BandStatistics { mean: all.mean / n as f64, ..all },
    }
}

/// What two rasters differ in: one line each. No data is the same as no data.
///
/// # Errors
/// What [`Raster::read`] says; [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn differences(a: &mut Raster, b: &mut Raster, watch: Watch<'_>) -> Result<Vec<String>> {
    let size = |r: &Raster| format!("{} rows x {} columns x {} bands", r.rows, r.columns, r.bands.len());
    if size(a) != size(b) {
        return Ok(vec![format!("size: {}, and {}", size(a), size(b))]);
    }
    let mut lines = Vec::new();
    if a.unit != b.unit {
        let shown = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "none".into());
        lines.push(format!("unit: {}, and {}", shown(&a.unit), shown(&b.unit)));
    }
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for band in 0..a.bands.len() {
        tell(watch, "comparing", band as u64, a.bands.len() as u64)?;
        let at = format!("band {}", band + 1);
        let about = |r: &Raster| {
            let shown = |um: Option<f64>| um.map_or_else(|| "unknown".into(), |um| format!("{um} um"));
            format!("centre {}, width {}", shown(r.bands[band].centre_um), shown(r.bands[band].fwhm_um))
        };
        if about(a) != about(b) {
            lines.push(format!("{at}: {}, and {}", about(a), about(b)));
        }
        a.read(band, &mut ours)?;
        b.read(band, &mut theirs)?;
        let different = |(a, b): &(&f64, &f64)| a != b && !(a.is_nan() && b.is_nan());
        let pairs = || ours.iter().zip(&theirs).filter(different);
        let count = pairs().count();
        if count > 0 {
            let most = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            lines.push(format!("{at}: {count} values differ, by up to {most:.3e}"));
        }
    }
    if lines.len() > TOLD {
        let more = lines.len() - TOLD;
        lines.truncate(TOLD);
        lines.push(format!("{more} more differences"));
    }
    Ok(lines)
}
