//! The bands of a sensor out of the bands of a map.

use super::{Band, between};

/// Two bands are one and the same within this share of their width, or of their wavelength if they have none.
const SAME_WIDTH: f64 = 0.01;
const SAME_WAVELENGTH: f64 = 1e-6;

/// Weights of a map's bands in a sensor's band, ascending by the map's index; they sum to 1.
pub type Mix = Vec<(usize, f64)>;

/// For each band of a sensor its mix of the bands of a map.
///
/// A band that the map has too is taken as it is: of several the nearest. Others are means, over the sensor's response, of what is linear between the
/// centres of the map's bands; beyond the first and last centre, but within these bands, it is held.
///
/// # Errors
/// A sentence for each band of the sensor whose centre the map does not reach, or half of whose width.
pub fn mixes(map: &[Band], sensor: &[Band]) -> Result<Vec<Mix>, Vec<String>> {
    let mut order: Vec<usize> = (0..map.len()).collect();
    order.sort_by(|a, b| map[*a].centre_um.total_cmp(&map[*b].centre_um));
    let mut wrong = Vec::new();
    let mut mixes = Vec::new();
    for (i, band) in sensor.iter().enumerate() {
        match mix(map, &order, band) {
            Some(mix) => mixes.push(mix),
            None => wrong.push(format!(
                "band {} of the sensor, {}, is not among the map's{}",
                i + 1,
                describe(band),
                reach(map, &order).map_or(String::new(), |(a, b)| format!(", which reach from {a} to {b} um"))
            )),
        }
    }
    if wrong.is_empty() { Ok(mixes) } else { Err(wrong) }
}

fn describe(band: &Band) -> String {
    match band.fwhm_um {
        Some(width) => format!("{} um wide at {} um", width, band.centre_um),
        None => format!("at {} um", band.centre_um),
    }
}

fn half_width_um(band: &Band) -> f64 {
    0.5 * band.fwhm_um.unwrap_or(0.0)
}

/// First and last wavelength within the half-maxima of the map's bands, um.
fn reach(map: &[Band], order: &[usize]) -> Option<(f64, f64)> {
    let (first, last) = (&map[*order.first()?], &map[*order.last()?]);
    Some((first.centre_um - half_width_um(first), last.centre_um + half_width_um(last)))
}

fn mix(map: &[Band], order: &[usize], band: &Band) -> Option<Mix> {
    let is_same = |other: &Band| {
        let width_um = band.fwhm_um.unwrap_or(0.0).max(other.fwhm_um.unwrap_or(0.0));
        let tolerance_um = (SAME_WIDTH * width_um).max(SAME_WAVELENGTH * band.centre_um);
        (other.centre_um - band.centre_um).abs() <= tolerance_um
            && (other.fwhm_um.unwrap_or(0.0) - band.fwhm_um.unwrap_or(0.0)).abs() <= tolerance_um
    };
    let off_um = |i: usize| (map[i].centre_um - band.centre_um).abs();
    let same = order.iter().copied().filter(|i| is_same(&map[*i])).min_by(|a, b| off_um(*a).total_cmp(&off_um(*b)));
    if let Some(same) = same {
        return Some(vec![(same, 1.0)]);
    }
    let (low, high) = reach(map, order)?;
    let slack = SAME_WAVELENGTH * band.centre_um;
    let half = half_width_um(band);
    if !(low - slack <= band.centre_um - half && band.centre_um + half <= high + slack) {
        return None;
    }
    let centres: Vec<f64> = order.iter().map(|i| map[*i].centre_um).collect();
    let mut weights = vec![0.0; map.len()];
    for (um, weight) in band.quadrature(&centres) {
        let (before, share) = between(&centres, um);
        weights[order[before]] += weight * (1.0 - share);
        if share > 0.0 {
            weights[order[before + 1]] += weight * share;
        }
    }
    // A quadrature's weights sum to 1 but for rounding.
    let sum: f64 = weights.iter().sum();
    Some(weights.into_iter().map(|w| w / sum).enumerate().filter(|(_, w)| *w != 0.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn band(centre_um: f64, fwhm_um: Option<f64>) -> Band {
        Band { centre_um, fwhm_um }
    }

    #[test]
    fn a_band_that_is_there_is_taken() {
        let map = [band(2.0, Some(0.1)), band(1.0, Some(0.1))];
        assert_eq!(mixes(&map, &[band(1.0005, Some(0.1))]).unwrap(), [vec![(1, 1.0)]]);
    }

    #[test]
    fn of_several_that_could_be_it_the_nearest_is_taken() {
        // Steps of half a percent of the width, in descending order.
        let map: Vec<Band> = [1.0001, 1.0, 0.9999].map(|c| band(c, Some(0.02))).to_vec();
        assert_eq!(mixes(&map, &[band(1.0, Some(0.02))]).unwrap(), [vec![(1, 1.0)]]);
        assert_eq!(mixes(&map, &[band(1.000_08, Some(0.02))]).unwrap(), [vec![(0, 1.0)]]);
    }

    #[test]
    fn between_bands_lies_what_is_between() {
        let map = [band(1.0, None), band(2.0, None), band(4.0, None)];
        assert_eq!(
            mixes(&map, &[band(1.25, None), band(3.5, None)]).unwrap(),
            [vec![(0, 0.75), (1, 0.25)], vec![(1, 0.25), (2, 0.75)]]
        );
    }

    #[test]
    fn a_broad_band_is_the_mean_of_many() {
        // A triangle of height 1 at 2 um and base 1 um under a Gaussian of standard deviation s = 0.05:
        // 1 - E|x| / 0.5 = 1 - s sqrt(2 / pi) / 0.5, its flanks being 10 s away.
        let map: Vec<Band> = [1.0, 1.5, 2.0, 2.5, 3.0].map(|c| band(c, None)).to_vec();
        let s = 0.05;
        let found = mixes(&map, &[band(2.0, Some(s * 2.354_820_045_030_949))]).unwrap();
        let (middle, total): (f64, f64) =
            (found[0].iter().find(|m| m.0 == 2).unwrap().1, found[0].iter().map(|m| m.1).sum());
        assert!((middle - (1.0 - 2.0 * s * (2.0 / std::f64::consts::PI).sqrt())).abs() < 1e-6);
        assert!((total - 1.0).abs() < 1e-12);
    }

    #[test]
    fn one_broad_band_of_a_map_serves_what_lies_in_it() {
        let map = [band(1.0, Some(0.2))];
        assert_eq!(mixes(&map, &[band(1.05, None), band(1.0, Some(0.1))]).unwrap(), [vec![(0, 1.0)], vec![(0, 1.0)]]);
        let wrong = mixes(&map, &[band(1.0, None), band(1.2, None), band(1.05, Some(0.2))]).unwrap_err();
        assert_eq!(
            wrong,
            [
                "band 2 of the sensor, at 1.2 um, is not among the map's, which reach from 0.9 to 1.1 um",
                "band 3 of the sensor, 0.2 um wide at 1.05 um, is not among the map's, which reach from 0.9 to 1.1 um",
            ]
        );
    }
}
