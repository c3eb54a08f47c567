//! A picture of curves over wavelength, as SVG: axes with round numbers, a line and a name for each curve.

use std::fmt::Write as _;

use super::drawing::escaped;
use crate::geometry::whole;

/// Size of the picture and of the margins around the plot, px: left, top, right, bottom.
const SIZE: [f64; 2] = [720.0, 440.0];
const MARGIN: [f64; 4] = [84.0, 60.0, 20.0, 52.0];
/// Width of a letter, on average, px.
const LETTER: f64 = 7.0;
/// Lines of the curves, in turn; their widths distinguish neighbours even without colour.
const STROKES: [(&str, f64); 6] =
    [("#1b3a5c", 2.0), ("#b8860b", 1.4), ("#b22222", 1.0), ("#2e7d5b", 1.8), ("#6a4c93", 1.2), ("#7a7a7a", 1.6)];
/// So many curves are named one by one.
const NAMED: usize = 12;
/// From one line of names to the next, px.
const LINE: f64 = 18.0;

/// A curve to draw; what is not finite leaves a gap.
#[derive(Debug, Clone, Copy)]
pub struct Curve<'a> {
    /// Name; without one it is not named.
    pub name: &'a str,
    /// Where.
    pub x: &'a [f64],
    /// How much.
    pub values: &'a [f64],
}

/// Draws curves over the same places: a name and values for each.
pub fn draw(title: &str, x_label: &str, y_label: &str, x: &[f64], curves: &[(&str, Vec<f64>)]) -> String {
    let curves: Vec<Curve> = curves.iter().map(|(name, values)| Curve { name, x, values }).collect();
    draw_each(title, x_label, y_label, &curves)
}

/// Draws curves, each over places of its own.
pub fn draw_each(title: &str, x_label: &str, y_label: &str, curves: &[Curve<'_>]) -> String {
    let (x_low, x_high) = range(curves.iter().flat_map(|curve| curve.x.iter().copied()));
    // From 0: a spectrum's height is part of what it says.
    let (low, high) = range(curves.iter().flat_map(|curve| curve.values.iter().copied()).chain([0.0]));
    let [left, top, right, bottom] = MARGIN;
    let (names, lines) = placed_names(curves);
    // What the names take more than a line is added, so that the plot stays as large.
    let top = top + LINE * (lines - 1.0);
    let size = [SIZE[0], SIZE[1] + LINE * (lines - 1.0)];
    let (width, height) = (size[0] - left - right, size[1] - top - bottom);
    let px = |v: f64| left + (v - x_low) / (x_high - x_low) * width;
    let py = |v: f64| top + (high - v) / (high - low) * height;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        size[0], size[1]
    );
    let text = |svg: &mut String, x: f64, y: f64, anchor: &str, said: &str| {
        let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escaped(said));
    };
    text(&mut svg, left, 24.0, "start", title);
    text(&mut svg, left + 0.5 * width, size[1] - 12.0, "middle", x_label);
    let _ = writeln!(
        svg,
        "<text transform=\"translate(18 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        top + 0.5 * height,
        escaped(y_label)
    );
    for tick in ticks(x_low, x_high) {
        let _ = writeln!(svg, "<path d=\"M{0:.1} {top} V{1:.1}\" stroke=\"#ddd\"/>", px(tick.0), top + height);
        text(&mut svg, px(tick.0), top + height + 18.0, "middle", &tick.1);
    }
    for tick in ticks(low, high) {
        let _ = writeln!(svg, "<path d=\"M{left} {0:.1} H{1:.1}\" stroke=\"#ddd\"/>", py(tick.0), left + width);
        text(&mut svg, left - 8.0, py(tick.0) + 4.0, "end", &tick.1);
    }
    for (i, Curve { x, values, .. }) in curves.iter().enumerate() {
        let (colour, stroke) = STROKES[i % STROKES.len()];
        let mut path = String::new();
        let mut is_down = false;
        for (x, y) in x.iter().zip(*values) {
            if x.is_finite() && y.is_finite() {
                let _ = write!(path, "{}{:.2} {:.2} ", if is_down { 'L' } else { 'M' }, px(*x), py(*y));
            }
            is_down = x.is_finite() && y.is_finite();
        }
        let _ = writeln!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{stroke}\" stroke-linecap=\"round\"/>",
            path.trim_end()
        );
    }
    for Name { of, text: name, x, y } in names {
        if let Some((colour, stroke)) = of.map(|i| STROKES[i % STROKES.len()]) {
            let _ =
                writeln!(svg, "<path d=\"M{x:.1} {:.1} h24\" stroke=\"{colour}\" stroke-width=\"{stroke}\"/>", y - 4.0);
        }
        text(&mut svg, x + 30.0, y, "start", &name);
    }
    svg.push_str("</svg>\n");
    svg
}

/// A name above the plot, where no curve goes.
struct Name {
    /// The curve that it is of.
    of: Option<usize>,
    text: String,
    x: f64,
    y: f64,
}

/// The curves' names where they stand, in as many lines as they need, and how many these are.
fn placed_names(curves: &[Curve<'_>]) -> (Vec<Name>, f64) {
    let named = curves.iter().enumerate().filter(|(_, curve)| !curve.name.is_empty());
    let mut names: Vec<(Option<usize>, String)> = named.map(|(i, curve)| (Some(i), curve.name.to_owned())).collect();
    if names.len() > NAMED {
        let more = names.len() - NAMED;
        names.truncate(NAMED);
        names.push((None, format!("and {more} more")));
    }
    let (mut x, mut y, mut lines) = (MARGIN[0], 46.0, 1.0);
    let place = |(of, text): (Option<usize>, String)| {
        let width = 60.0 + LETTER * text.chars().count() as f64;
        if x > MARGIN[0] && x + width > SIZE[0] {
            (x, y, lines) = (MARGIN[0], y + LINE, lines + 1.0);
        }
        let name = Name { of, text, x, y };
        x += width;
        name
    };
    let names = names.into_iter().map(place).collect();
    (names, lines)
}

/// Least and greatest finite value; apart, so that a single value has an axis too.
pub(super) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    match () {
        () if low < high => (low, high),
        () if low.is_finite() && low != 0.0 => (low.min(low - 0.5 * low.abs()), low + 0.5 * low.abs()),
        () => (0.0, 1.0),
    }
}

/// Some four to eight round numbers in a range, and how they are written.
pub(super) fn ticks(low: f64, high: f64) -> Vec<(f64, String)> {
    let power = 10f64.powf(((high - low) / 5.0).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| (high - low) / step <= 8.0);
    let step = step.unwrap_or(high - low);
    let first = (low / step).ceil();
    // Enough digits to tell neighbours apart.
    let decimals = (-step.log10().floor()).max(0.0);
    (0..10)
        .map(|i| (first + f64::from(i)) * step)
        .take_while(|tick| *tick <= high + 1e-9 * step)
        .map(|tick| match decimals {
            d if d <= 4.0 && tick.abs() < 1e6 => (tick, format!("{:.*}", whole(d), tick + 0.0)),
            _ => (tick, format!("{tick:.2e}")),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_numbers() {
        let written = |low, high| ticks(low, high).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(written(0.95, 3.6), ["1.0", "1.5", "2.0", "2.5", "3.0", "3.5"]);
        assert_eq!(written(0.0, 7.2), ["0", "1", "2", "3", "4", "5", "6", "7"]);
        assert_eq!(written(0.0, 3.1e-7), ["0.00e0", "5.00e-8", "1.00e-7", "1.50e-7", "2.00e-7", "2.50e-7", "3.00e-7"]);
    }

    #[test]
    fn a_curve_goes_from_corner_to_corner_and_breaks_where_nothing_is_known() {
        let svg = draw("a < b", "um", "L", &[1.0, 2.0, 3.0], &[("one", vec![0.0, f64::NAN, 2.0])]);
        assert!(svg.contains("a &lt; b") && svg.contains("M84.00 388.00 M700.00 60.00"), "{svg}");
        // One band, and a dark pixel, are curves too.
        assert!(!draw("", "", "", &[1.0], &[("one", vec![0.0])]).contains("NaN"));
        assert!(!draw("", "", "", &[f64::NAN], &[("one", vec![f64::NAN])]).contains("NaN"));
    }
    #[test]
    fn many_curves_are_named_in_lines_and_in_the_end_counted() {
        let name = |i: usize| format!("a curve with a name, number {i}");
        let names: Vec<String> = (0..20).map(name).collect();
        let x = [1.0, 2.0];
        let curves: Vec<Curve> = names.iter().map(|name| Curve { name, x: &x, values: &[1.0, 2.0] }).collect();
        let svg = draw_each("", "", "", &curves);
        assert!(svg.contains(&name(11)) && !svg.contains(&name(12)) && svg.contains("and 8 more"));
        // 60 px and 28 letters of 7 px are 256 px: two fit beside each other, the last is alone.
        assert!(svg.contains(&format!("viewBox=\"0 0 720 {}\"", 440 + 6 * 18)), "{svg}");
        assert_eq!(svg.matches("stroke-linecap").count(), 20);
    }
}
