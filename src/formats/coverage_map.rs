//! Maps of coverage as pictures: how finely, and how often, each place has been seen.

use super::drawing::{Anchor, Colour, Drawing};
use super::quicklook::png_bytes;
use crate::error::number;
use crate::product::Coverage;
use crate::study::SurfaceMap;

/// Left, right, above and below the map, px.
const MARGIN: [f64; 4] = [64.0, 24.0, 64.0, 106.0];
const INK: Colour = [34, 40, 49];
const GREY: Colour = [108, 117, 128];
/// Surface that is not seen, and no surface.
const UNSEEN: Colour = [214, 217, 222];
const NOTHING: Colour = [255, 255, 255];
/// Height of the scale of colours, px, and how far below the map it begins.
const BAR: [f64; 2] = [14.0, 44.0];
/// Scales of colours go to where this share of what is seen lies: a few facets would take most of the colours.
const MOST: f64 = 0.98;
/// Labels of an axis are at least so far apart, px.
const APART: f64 = 72.0;

/// A scale of colours that is even to the eye, also without colour: viridis (van der Walt & Smith 2015), at even steps.
pub(super) const VIRIDIS: [Colour; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

fn viridis(share: f64) -> Colour {
    let steps = (VIRIDIS.len() - 1) as f64;
    let at = share.clamp(0.0, 1.0) * steps;
    let step = crate::geometry::whole(at).min(VIRIDIS.len() - 2);
    let between = at - step as f64;
    [0, 1, 2].map(|k| {
        let [a, b] = [VIRIDIS[step][k], VIRIDIS[step + 1][k]].map(f64::from);
        byte(a + (b - a) * between)
    })
}

fn byte(value: f64) -> u8 {
    u8::try_from(crate::geometry::whole(value.round().clamp(0.0, 255.0))).unwrap_or(255)
}

/// What a scale of colours says: where numbers lie along it, and which of them it names.
struct Scale {
    title: &'static str,
    unit: &'static str,
    ticks: Vec<(f64, String)>,
}

/// How finely each place has been seen at best, as PNG: the finer, the brighter.
pub(super) fn sampling(map: &SurfaceMap, coverage: &Coverage, said: &str) -> Vec<u8> {
    let mut known: Vec<f64> = coverage.sampling_m.iter().copied().filter(|m| m.is_finite()).collect();
    known.sort_by(f64::total_cmp);
    let (finest, coarsest) = sampling_ends(&known);
    let beyond = known.len() - known.partition_point(|m| *m <= coarsest * (1.0 + 1e-9));
    let beyond = known.last().filter(|_| beyond > 0).map(|most| {
        let percent = 100.0 * beyond as f64 / known.len() as f64;
        format!("{percent:.1} % of the facets seen are beyond the scale, up to {} m", two_digits(*most))
    });
    let share = |m: f64| (coarsest / m).ln() / (coarsest / finest).ln();
    let digits: &[f64] = if coarsest > 10.0 * finest { &DIGITS } else { &FINE_DIGITS };
    let ticks = round(digits, finest, |_, _| true)
        .chain(round(digits, coarsest, |_, _| true))
        .filter(|m| (finest * (1.0 - 1e-9)..=coarsest * (1.0 + 1e-9)).contains(m));
    let mut ticks: Vec<(f64, String)> = ticks.map(|m| (share(m), number(m))).collect();
    ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
    ticks.dedup_by(|a, b| a.1 == b.1);
    let scale = Scale { title: "Finest ground sampling", unit: "m", ticks };
    let of = |facet: usize| coverage.sampling_m[facet].is_finite().then(|| share(coverage.sampling_m[facet]));
    picture(map, &scale, [said, beyond.as_deref().unwrap_or_default()], of)
}

fn two_digits(x: f64) -> String {
    number(format!("{x:.1e}").parse().unwrap_or(x))
}

/// The ends of a scale, m, of samplings in their order: round numbers around all but a few at either end, which are facets seen along the ground or at the rim.
fn sampling_ends(sorted: &[f64]) -> (f64, f64) {
    let (Some(low), Some(high)) = (at_share(sorted, 1.0 - MOST), at_share(sorted, MOST)) else { return (1.0, 10.0) };
    let finest = round(&FINE_DIGITS, low, |x, end| x <= end * (1.0 + 1e-9)).next_back().unwrap_or(low);
    let coarsest = round(&FINE_DIGITS, high, |x, end| x * (1.0 + 1e-9) >= end).next().unwrap_or(high);
    (finest, if coarsest <= finest { 2.0 * finest } else { coarsest })
}

/// The value that this share of some in their order does not go beyond.
fn at_share<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let last = sorted.len().checked_sub(1)?;
    sorted.get(crate::geometry::whole((share * last as f64).round())).copied()
}

/// How often each place has been seen, as PNG.
pub(super) fn count(map: &SurfaceMap, coverage: &Coverage, said: &str) -> Vec<u8> {
    let mut seen: Vec<u32> = coverage.sights.iter().copied().filter(|count| *count > 0).collect();
    seen.sort_unstable();
    let most = f64::from(at_share(&seen, MOST).unwrap_or(1));
    let beyond = seen.last().filter(|last| f64::from(**last) > most);
    let beyond = beyond.map_or_else(String::new, |last| format!("a few facets are beyond the scale, up to {last}"));
    let step = (most / 8.0).max(1.0);
    let step = round(&DIGITS, step, |x, end| x * (1.0 + 1e-9) >= end).next().unwrap_or(step);
    let shown = (0..=crate::geometry::whole(most / step)).map(|i| i as f64 * step);
    let ticks = shown.map(|n| (n / most, number(n))).collect();
    let scale = Scale { title: "Number of sights", unit: "acquisitions", ticks };
    let of = |facet: usize| Some(f64::from(coverage.sights[facet]) / most).filter(|share| *share > 0.0);
    picture(map, &scale, [said, &beyond], of)
}

/// First digits of round numbers, and of those that part a scale of less than a decade.
const DIGITS: [f64; 3] = [1.0, 2.0, 5.0];
const FINE_DIGITS: [f64; 10] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];

/// Round numbers around a number, ascending, of those that are as they should be beside it.
fn round(digits: &[f64], around: f64, is_good: impl Fn(f64, f64) -> bool) -> std::vec::IntoIter<f64> {
    let power = around.log10().floor();
    let steps = (-1..=1).flat_map(|k| digits.iter().map(move |digit| digit * 10_f64.powf(power + f64::from(k))));
    steps.filter(|x| is_good(*x, around)).collect::<Vec<f64>>().into_iter()
}

/// A map with its axes and its scale, what is said above, and below of what is beyond the scale; `share` is where a facet lies on the scale, if it has been seen.
fn picture(
    map: &SurfaceMap,
    scale: &Scale,
    [said, beyond]: [&str; 2],
    share: impl Fn(usize) -> Option<f64>,
) -> Vec<u8> {
    let [left, right, above, below] = MARGIN;
    let [width, height] = [map.samples, map.lines].map(|n| n as f64);
    let mut drawing = Drawing::new(left + width.max(480.0) + right, above + height + below);
    drawing.bold([left, 26.0], Anchor::Start, 16.0, INK, &format!("{}, {}", scale.title, scale.unit));
    drawing.text([left, 48.0], Anchor::Start, 12.0, GREY, said);
    let frame = [[left, above], [left + width, above], [left + width, above + height], [left, above + height]];
    drawing.line(&[frame[0], frame[1], frame[2], frame[3], frame[0]], GREY, 2.0, 1.0);
    let [first, last] = map.longitude_deg;
    for (share, label) in degrees([first, last], width, |deg| deg.rem_euclid(360.0)) {
        let x = left + share * width;
        drawing.line(&[[x, above + height], [x, above + height + 5.0]], GREY, 1.0, 1.0);
        drawing.text([x, above + height + 18.0], Anchor::Middle, 11.0, INK, &format!("{label}\u{b0}E"));
    }
    for (share, label) in degrees(map.latitude_deg, height, |deg| deg) {
        let y = above + height - share * height;
        drawing.line(&[[left - 5.0, y], [left, y]], GREY, 1.0, 1.0);
        drawing.text([left - 8.0, y + 4.0], Anchor::End, 11.0, INK, &format!("{label}\u{b0}"));
    }
    let top = above + height + BAR[1];
    let length = 360.0;
    for i in 0..180_u32 {
        let x = left + length * f64::from(i) / 180.0;
        drawing.rectangle(
            [x, top],
            [x + length / 180.0 + 0.5, top + BAR[0]],
            viridis((f64::from(i) + 0.5) / 180.0),
            1.0,
        );
    }
    let mut free = f64::NEG_INFINITY;
    for (share, label) in &scale.ticks {
        let x = left + share * length;
        drawing.line(&[[x, top + BAR[0]], [x, top + BAR[0] + 4.0]], GREY, 1.0, 1.0);
        if x >= free {
            drawing.text([x, top + BAR[0] + 16.0], Anchor::Middle, 11.0, INK, label);
            free = x + 34.0;
        }
    }
    drawing.text([left, top + BAR[0] + 34.0], Anchor::Start, 11.0, GREY, beyond);
    drawing.rectangle([left + length + 24.0, top], [left + length + 38.0, top + BAR[0]], UNSEEN, 1.0);
    drawing.text([left + length + 44.0, top + 11.0], Anchor::Start, 11.0, INK, "not seen");
    let (mut rgb, size) = drawing.rgb(1.0).unwrap_or_default();
    let [x0, y0] = [left, above].map(crate::geometry::whole);
    for (pixel, facet) in map.facet.iter().enumerate() {
        let (line, sample) = (pixel / map.samples, pixel % map.samples);
        let colour = match facet {
            Some(facet) => share(*facet as usize).map_or(UNSEEN, viridis),
            None => NOTHING,
        };
        let at = 3 * ((y0 + line) * size[0] + x0 + sample);
        if let Some(place) = rgb.get_mut(at..at + 3) {
            place.copy_from_slice(&colour);
        }
    }
    png_bytes(size, png::ColorType::Rgb, &rgb)
}

/// Round degrees along an axis of so many px, by their shares of it, and what they are called.
fn degrees([first, last]: [f64; 2], length: f64, named: impl Fn(f64) -> f64) -> Vec<(f64, String)> {
    let span = last - first;
    const STEPS: [f64; 14] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0];
    let step = STEPS.into_iter().find(|step| step / span * length >= APART).unwrap_or(90.0);
    let from = (first / step).ceil();
    let all = (0..=crate::geometry::whole(length)).map(|i| (from + i as f64) * step).take_while(|deg| *deg <= last);
    // Steps are written with two digits: a hundredth is rounded no further.
    all.map(|deg| ((deg - first) / span, number((named(deg) * 100.0).round() / 100.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_go_around_what_is_there() {
        // An image of 14 m, of which five facets of a thousand are seen along the ground.
        let mut of: Vec<f64> = (0..995).map(|i| 13.5 + 1e-3 * f64::from(i)).collect();
        of.extend([100.0, 300.0, 500.0, 1000.0, 1900.0]);
        assert_eq!(sampling_ends(&of), (12.0, 15.0));
        assert_eq!((sampling_ends(&[]), sampling_ends(&[20.0])), ((1.0, 10.0), (20.0, 40.0)));
        let counts: Vec<u32> = (1..=101).collect();
        assert_eq!(
            (at_share(&counts, MOST), at_share::<u32>(&[], MOST), at_share(&[7], MOST)),
            (Some(99), None, Some(7))
        );
    }
}
