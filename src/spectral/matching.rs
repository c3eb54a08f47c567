//! The bands of a sensor out of the bands of a map.

use super::{ALL_UM, Band, KnownLight, Light, between};
use crate::units::um_from_nm;

/// Two bands are one and the same within this share of their width, or of their wavelength if they have none.
const SAME_WIDTH: f64 = 0.01;
const SAME_WAVELENGTH: f64 = 1e-6;

/// Weights of a map's bands in a sensor's band, ascending by the map's index; they sum to 1.
pub type Mix = Vec<(usize, f64)>;

/// The bands of a sensor out of those of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixes {
    /// For each band of the sensor its mix.
    pub mixes: Vec<Mix>,
    /// What a reader of the result should know, as sentences: bands replaced by another.
    pub told: Vec<String>,
}

/// For each band of a sensor its mix of the bands of a map; `light` is what is known of the light in the map's (nothing, beyond its end).
///
/// - A band known to hold light that the sensor's band excludes does not serve it. Of two that are otherwise the same, a band of
///   both serves before those that are known to lack sunlight, or heat.
/// - A band that the map has too is taken as it is: of several the nearest. So is one that the map has cut at one end, if nothing of
///   the map is where the rest was.
/// - Others are means, over the sensor's response, of what is linear between the centres of the map's bands; beyond the first and last
///   centre, but within these bands, it is held.
/// - Not so if one of these bands holds another within it, as a panchromatic band does: it says little of its centre. Then the
///   narrowest band that contains it replaces it.
///
/// # Errors
/// A sentence for each band of the sensor whose centre the map does not reach, or half of whose width.
pub fn mixes(map: &[Band], light: &[KnownLight], sensor: &[Band]) -> Result<Mixes, Vec<String>> {
    let known = |i: usize| light.get(i).copied().unwrap_or_default();
    let mut all: Vec<usize> = (0..map.len()).collect();
    all.sort_by(|a, b| map[*a].centre_um.total_cmp(&map[*b].centre_um));
    let mut wrong = Vec::new();
    let mut mixes = Vec::new();
    let mut strange: Vec<(Stand, usize, usize)> = Vec::new();
    for (i, band) in sensor.iter().enumerate() {
        let order = serving(map, &all, known, band);
        match mix(map, &order, band) {
            Some((mix, _)) if is_ambiguous(map, &order, known, band, &mix) => wrong.push(apart(i, band)),
            Some((mix, stand)) => {
                strange.extend(stand.zip(mix.first()).map(|(stand, (of_map, _))| (stand, i, *of_map)));
                mixes.push(mix);
            }
            None if order.len() < all.len() && mix(map, &all, band).is_some() => wrong.push(format!(
                "band {} of the sensor, {}, has {} alone, and the map's there also holds other light, which cannot be separated from it",
                i + 1,
                describe(band),
                band.light.name()
            )),
            None => wrong.push(format!(
                "band {} of the sensor, {}, is not among the map's{}{}",
                i + 1,
                describe(band),
                reach(map).map_or(String::new(), |(a, b)| format!(", which reach from {a} to {b} um")),
                cure(map, &all, band)
            )),
        }
    }
    let of_kind = |kind: Stand| {
        let mut all = strange.iter().filter(|(stand, ..)| *stand == kind);
        let (_, i, of_map) = *all.next()?;
        let (of_sensor, of_map) = (describe(&sensor[i]), describe(&map[of_map]));
        let more = match all.count() {
            0 => String::new(),
            n => format!("; the same holds for {n} more"),
        };
        Some(match kind {
            Stand::Points => format!(
                "band {} of the sensor, {of_sensor}: the map's bands have no width, and are taken as points of a spectrum; if they are \
                 bands, their widths are missing (`fwhm_um`){more}",
                i + 1
            ),
            Stand::Cut => {
                format!("band {} of the sensor, {of_sensor}, is the map's, {of_map}, which ends sooner{more}", i + 1)
            }
            Stand::Held => format!(
                "band {} of the sensor, {of_sensor}, has the value of the map's last one on that side, {of_map}, within whose width it lies{more}",
                i + 1
            ),
            Stand::Within => format!(
                "band {} of the sensor, {of_sensor}, has the value of the map's {of_map}, within which it lies: it is too wide to be interpolated between centres{more}",
                i + 1
            ),
        })
    };
    let told = [Stand::Points, Stand::Cut, Stand::Held, Stand::Within].into_iter().filter_map(of_kind).collect();
    if wrong.is_empty() { Ok(Mixes { mixes, told }) } else { Err(wrong) }
}

/// How a map's band replaces a sensor's band that is not the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stand {
    /// It has a width, and the map's have none.
    Points,
    /// It is the same, but for what the map has not.
    Cut,
    /// It is the first or last, and its centre is not reached.
    Held,
    /// It is a wide one.
    Within,
}

/// Bands of a map, ascending, that may serve one of a sensor by what light is in them.
fn serving(map: &[Band], all: &[usize], known: impl Fn(usize) -> KnownLight, band: &Band) -> Vec<usize> {
    let may: Vec<usize> = all.iter().copied().filter(|i| !known(*i).has_more_than(band.light)).collect();
    let is_whole = |i: usize| band.light != Light::Both || !known(i).lacks_some();
    let has_better = |i: usize| may.iter().any(|j| is_whole(*j) && is_same(&map[i], &map[*j]));
    may.iter().copied().filter(|i| is_whole(*i) || !has_better(*i)).collect()
}

/// Whether bands that are the same but for their light, or of whose light nothing is known, would serve one as well as the other, and have
/// to serve a band for which that matters.
fn is_ambiguous(
    map: &[Band],
    order: &[usize],
    known: impl Fn(usize) -> KnownLight,
    band: &Band,
    mix: &[(usize, f64)],
) -> bool {
    let is_twin = |i: usize, j: usize| i != j && ends_um(&map[i]) == ends_um(&map[j]);
    let matters = |i: usize, j: usize| known(i) != known(j) || known(i).may_have_more_than(band.light);
    mix.iter().any(|(i, _)| order.iter().any(|j| is_twin(*i, *j) && matters(*i, *j)))
}

fn apart(i: usize, band: &Band) -> String {
    format!(
        "band {} of the sensor, {}, could be several of the map's that are the same but for their light: say what light each has \
         (`light` in `bands` of a map file, and of the sensor)",
        i + 1,
        describe(band)
    )
}

/// What could be wrong with wavelengths and widths of a map that does not reach a band.
fn cure(map: &[Band], all: &[usize], band: &Band) -> &'static str {
    let serves = |change: &dyn Fn(&Band) -> Band| {
        let changed: Vec<Band> = map.iter().map(change).collect();
        mix(&changed, all, band).is_some()
    };
    let has_no_width = map.iter().all(|other| other.fwhm_um.is_none());
    let widened = |other: &Band| Band { fwhm_um: band.fwhm_um, ..other.clone() };
    let of_nm = |other: &Band| Band {
        centre_um: um_from_nm(other.centre_um),
        fwhm_um: other.fwhm_um.map(um_from_nm).or(band.fwhm_um),
        ..other.clone()
    };
    if has_no_width && serves(&widened) {
        ": they have no widths, which `fwhm_um` says"
    } else if serves(&of_nm) {
        ": if these are nm, write thousandths: wavelengths are in um"
    } else {
        ""
    }
}

fn describe(band: &Band) -> String {
    match band.fwhm_um {
        Some(width) => format!("{} um wide at {} um", width, band.centre_um),
        None => format!("at {} um", band.centre_um),
    }
}

/// First and last wavelength within the half-maxima of a band, um.
fn ends_um(band: &Band) -> (f64, f64) {
    let half = 0.5 * band.fwhm_um.unwrap_or(0.0);
    (band.centre_um - half, band.centre_um + half)
}

/// First and last wavelength within the half-maxima of the map's bands, um.
fn reach(map: &[Band]) -> Option<(f64, f64)> {
    map.iter().map(ends_um).reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}

/// Whether two bands have the same centre and width.
fn is_same(band: &Band, other: &Band) -> bool {
    let width_um = band.fwhm_um.unwrap_or(0.0).max(other.fwhm_um.unwrap_or(0.0));
    let tolerance_um = (SAME_WIDTH * width_um).max(SAME_WAVELENGTH * band.centre_um);
    (other.centre_um - band.centre_um).abs() <= tolerance_um
        && (other.fwhm_um.unwrap_or(0.0) - band.fwhm_um.unwrap_or(0.0)).abs() <= tolerance_um
}

fn mix(map: &[Band], order: &[usize], band: &Band) -> Option<(Mix, Option<Stand>)> {
    let off_um = |i: usize| (map[i].centre_um - band.centre_um).abs();
    let same =
        order.iter().copied().filter(|i| is_same(band, &map[*i])).min_by(|a, b| off_um(*a).total_cmp(&off_um(*b)));
    if let Some(same) = same {
        return Some((vec![(same, 1.0)], None));
    }
    if let Some(cut) = order.iter().copied().find(|i| is_cut(map, *i, band)) {
        return Some((vec![(cut, 1.0)], Some(Stand::Cut)));
    }
    let slack = SAME_WAVELENGTH * band.centre_um;
    let (from, to) = ends_um(band);
    let (first, last) = (&map[*order.first()?], &map[*order.last()?]);
    if ends_um(first).0 - slack <= from && to <= ends_um(last).1 + slack {
        let mix = linear(map, order, band);
        let is_nested = mix.iter().any(|(i, _)| mix.iter().any(|(j, _)| holds(&map[*i], &map[*j])));
        if !is_nested {
            let is_beyond = band.centre_um < first.centre_um - slack || last.centre_um + slack < band.centre_um;
            let are_points = band.fwhm_um.is_some() && mix.iter().all(|(i, _)| map[*i].fwhm_um.is_none());
            let stand = if are_points { Some(Stand::Points) } else { is_beyond.then_some(Stand::Held) };
            return Some((mix, stand));
        }
    }
    let within = order.iter().copied().filter(|i| {
        let (lo, hi) = ends_um(&map[*i]);
        lo - slack <= from && to <= hi + slack
    });
    let width_um = |i: usize| map[i].fwhm_um.unwrap_or(0.0);
    let narrowest = within.min_by(|a, b| width_um(*a).total_cmp(&width_um(*b)))?;
    Some((vec![(narrowest, 1.0)], Some(Stand::Within)))
}

/// Whether a band holds another one within its width, and is wider on both sides.
fn holds(outer: &Band, inner: &Band) -> bool {
    let ((lo, hi), (from, to)) = (ends_um(outer), ends_um(inner));
    lo < from && to < hi
}

/// Whether a map's band is a wider one of which the map has not one end: codes end bands where their tables do.
fn is_cut(map: &[Band], i: usize, band: &Band) -> bool {
    let (Some(width_um), Some(_)) = (band.fwhm_um, map[i].fwhm_um) else { return false };
    let ((lo, hi), (from, to)) = (ends_um(&map[i]), ends_um(band));
    let tolerance_um = SAME_WIDTH * width_um;
    let is_end = |a: f64, b: f64| (a - b).abs() <= tolerance_um;
    let rest = match (is_end(lo, from), is_end(hi, to)) {
        (true, false) if hi < to => (hi, to),
        (false, true) if from < lo => (from, lo),
        _ => return false,
    };
    let reaches = |other: &Band| {
        let (lo, hi) = ends_um(other);
        lo < rest.1 - tolerance_um && rest.0 + tolerance_um < hi
    };
    lo <= band.centre_um && band.centre_um <= hi && !map.iter().any(reaches)
}

/// The mean, over a band's response, of what is linear between the centres of the map's bands.
fn linear(map: &[Band], order: &[usize], band: &Band) -> Mix {
    let centres: Vec<f64> = order.iter().map(|i| map[*i].centre_um).collect();
    let mut weights = vec![0.0; map.len()];
    for (um, weight) in band.quadrature(&centres, ALL_UM) {
        let (before, share) = between(&centres, um);
        weights[order[before]] += weight * (1.0 - share);
        if share > 0.0 {
            weights[order[before + 1]] += weight * share;
        }
    }
    // A quadrature's weights sum to 1 but for rounding.
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|w| w / sum).enumerate().filter(|(_, w)| *w != 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn band(centre_um: f64, fwhm_um: Option<f64>) -> Band {
        Band::new(centre_um, fwhm_um)
    }

    #[test]
    fn a_band_that_is_there_is_taken() {
        let map = [band(2.0, Some(0.1)), band(1.0, Some(0.1))];
        assert_eq!(mixes(&map, &[], &[band(1.0005, Some(0.1))]).unwrap().mixes, [vec![(1, 1.0)]]);
    }

    #[test]
    fn of_several_that_could_be_it_the_nearest_is_taken() {
        // Steps of half a percent of the width, in descending order.
        let map: Vec<Band> = [1.0001, 1.0, 0.9999].map(|c| band(c, Some(0.02))).to_vec();
        assert_eq!(mixes(&map, &[], &[band(1.0, Some(0.02))]).unwrap().mixes, [vec![(1, 1.0)]]);
        assert_eq!(mixes(&map, &[], &[band(1.000_08, Some(0.02))]).unwrap().mixes, [vec![(0, 1.0)]]);
    }

    #[test]
    fn between_bands_lies_what_is_between() {
        let map = [band(1.0, None), band(2.0, None), band(4.0, None)];
        assert_eq!(
            mixes(&map, &[], &[band(1.25, None), band(3.5, None)]).unwrap().mixes,
            [vec![(0, 0.75), (1, 0.25)], vec![(1, 0.25), (2, 0.75)]]
        );
    }

    #[test]
    fn a_broad_band_is_the_mean_of_many() {
        // A triangle of height 1 at 2 um and base 1 um under a Gaussian of standard deviation s = 0.05:
        // 1 - E|x| / 0.5 = 1 - s sqrt(2 / pi) / 0.5, its flanks being 10 s away.
        let map: Vec<Band> = [1.0, 1.5, 2.0, 2.5, 3.0].map(|c| band(c, None)).to_vec();
        let s = 0.05;
        let found = mixes(&map, &[], &[band(2.0, Some(s * 2.354_820_045_030_949))]).unwrap().mixes;
        let (middle, total): (f64, f64) =
            (found[0].iter().find(|m| m.0 == 2).unwrap().1, found[0].iter().map(|m| m.1).sum());
        assert!((middle - (1.0 - 2.0 * s * (2.0 / std::f64::consts::PI).sqrt())).abs() < 1e-6);
        assert!((total - 1.0).abs() < 1e-12);
    }

    #[test]
    fn one_broad_band_of_a_map_serves_what_lies_in_it() {
        let map = [band(1.0, Some(0.2))];
        let served = mixes(&map, &[], &[band(1.05, None), band(1.0, Some(0.1))]).unwrap();
        assert_eq!(served.mixes, [vec![(0, 1.0)], vec![(0, 1.0)]]);
        assert!(
            served.told.len() == 1 && served.told[0].starts_with("band 1 of the sensor, at 1.05 um, "),
            "{served:?}"
        );
        let wrong = mixes(&map, &[], &[band(1.0, None), band(1.2, None), band(1.05, Some(0.2))]).unwrap_err();
        assert_eq!(
            wrong,
            [
                "band 2 of the sensor, at 1.2 um, is not among the map's, which reach from 0.9 to 1.1 um",
                "band 3 of the sensor, 0.2 um wide at 1.05 um, is not among the map's, which reach from 0.9 to 1.1 um",
            ]
        );
    }

    #[test]
    fn a_wide_band_is_no_point_between_centres() {
        // Red, blue, and a panchromatic band that holds both and whose middle lies between them.
        let map = [band(0.685, Some(0.05)), band(0.45, Some(0.02)), Band::boxed(0.5785, 0.657)];
        let sensor = [band(0.45, Some(0.02)), band(0.532, None), band(0.8, Some(0.05)), band(0.46, None)];
        let found = mixes(&map, &[], &sensor).unwrap();
        assert_eq!(found.mixes, [vec![(1, 1.0)], vec![(2, 1.0)], vec![(2, 1.0)], vec![(1, 1.0)]]);
        assert!(
            found.told.len() == 1 && found.told[0].contains("at 0.532 um") && found.told[0].contains("2 more"),
            "{found:?}"
        );
        // Beyond all of them, or in part.
        assert_eq!(mixes(&map, &[], &[band(0.95, None), band(0.9, Some(0.1))]).unwrap_err().len(), 2);
        // Bands that overlap their neighbours as those of spectrometers do are points.
        let map: Vec<Band> = (0..9).map(|i| band(1.0 + 0.01 * f64::from(i), Some(0.03))).collect();
        let found = mixes(&map, &[], &[band(1.0325, None)]).unwrap();
        assert_eq!(found.mixes[0].iter().map(|m| m.0).collect::<Vec<_>>(), [3, 4]);
        assert_eq!(found.told, [""; 0]);
    }

    #[test]
    fn a_band_that_the_map_has_cut_is_its_own() {
        // 0.157 to 0.907 um, of which a table that begins at 0.25 leaves 0.25 to 0.907.
        let map = [band(0.45, Some(0.02)), Band::boxed(0.5785, 0.657)];
        let own = Band::boxed(0.532, 0.75);
        let found = mixes(&map, &[], std::slice::from_ref(&own)).unwrap();
        assert_eq!(found.mixes, [vec![(1, 1.0)]]);
        assert!(found.told[0].contains("ends sooner"), "{found:?}");
        // Half of a band is not the band if the map has the other half, too.
        let halves = [Band::boxed(1.03, 0.06), Band::boxed(1.08, 0.04)];
        let found = mixes(&halves, &[], &[Band::boxed(1.05, 0.1)]).unwrap();
        assert!(found.mixes[0].len() == 2 && found.told.is_empty(), "{found:?}");
    }
}
