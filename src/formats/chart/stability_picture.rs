//! The drawing of stability: a panel for each hazard, error along its parameter, a line for each method.

use super::picture::plain;
use crate::formats::drawing::{Anchor, Colour, Drawing, Labels, LogAxis, Mark, text_width};
use crate::study::stability::{Hazard, LEVELS};

const COLUMNS: usize = 3;
const PANEL: [f64; 2] = [400.0, 300.0];
const HEAD: f64 = 84.0;
/// Left, right, above, below a panel's frame.
const MARGIN: [f64; 4] = [58.0, 14.0, 34.0, 46.0];
/// Errors beyond these powers of ten lie at the edge.
const POWERS: [i32; 2] = [-16, 1];

const INK: Colour = [34, 40, 49];
const GREY: Colour = [108, 117, 128];
const PALE: Colour = [226, 229, 234];

/// Of what this program does, and of the others in their order.
const OURS: Colour = [0, 90, 170];
const OTHERS: [(Colour, Mark); 4] = [
    ([213, 94, 0], Mark::Square),
    ([0, 135, 95], Mark::Triangle),
    ([170, 85, 150], Mark::Diamond),
    ([166, 118, 0], Mark::Plus),
];

pub(super) fn draw(hazards: &[Hazard]) -> Drawing {
    let rows = hazards.len().div_ceil(COLUMNS);
    let mut drawing = Drawing::new(COLUMNS as f64 * PANEL[0] + 24.0, HEAD + rows as f64 * PANEL[1] + 12.0);
    drawing.bold([24.0, 32.0], Anchor::Start, 19.0, INK, "Where methods fail");
    let said = "Each panel drives methods along a hazard, from harmless (left) to harsh (right). Blue with discs: what this program does.";
    drawing.text([24.0, 54.0], Anchor::Start, 13.0, GREY, said);
    let said = "Lines across: errors of 1e-6, 0.001 and 0.1. At the top edge there is no result; at the bottom the error is below 1e-16.";
    drawing.text([24.0, 73.0], Anchor::Start, 13.0, GREY, said);
    for (i, hazard) in hazards.iter().enumerate() {
        let corner = [12.0 + PANEL[0] * (i % COLUMNS) as f64, HEAD + PANEL[1] * (i / COLUMNS) as f64];
        panel(&mut drawing, hazard, corner);
    }
    drawing
}

fn panel(drawing: &mut Drawing, hazard: &Hazard, [left, top]: [f64; 2]) {
    let frame = [left + MARGIN[0], top + MARGIN[2], left + PANEL[0] - MARGIN[1], top + PANEL[1] - MARGIN[3]];
    drawing.rectangle([frame[0], frame[1]], [frame[2], frame[3]], [250, 251, 252], 1.0);
    drawing.bold([frame[0], frame[1] - 10.0], Anchor::Start, 13.0, INK, hazard.name);
    let error = LogAxis { powers: POWERS, ends: [frame[3] - 6.0, frame[1] + 8.0] };
    for power in error.ticks().filter(|power| power % 4 == 0) {
        let y = error.at(10f64.powi(power));
        drawing.line(&[[frame[0], y], [frame[2], y]], PALE, 1.0, 1.0);
        drawing.text(
            [frame[0] - 6.0, y + 4.0],
            Anchor::End,
            10.5,
            INK,
            &if power == 0 { "1".into() } else { format!("1e{power}") },
        );
    }
    for level in LEVELS {
        let y = error.at(level);
        drawing.dashed(&[[frame[0], y], [frame[2], y]], GREY, 0.9, 0.8);
    }
    let most = hazard.sweeps.iter().map(|sweep| sweep.points.len()).max().unwrap_or(0);
    let step = (frame[2] - frame[0] - 28.0) / (most.max(2) - 1) as f64;
    let place = |i: usize| frame[0] + 14.0 + step * i as f64;
    ticks(drawing, hazard, &frame, place);
    drawing.text([0.5 * (frame[0] + frame[2]), frame[3] + 35.0], Anchor::Middle, 11.0, INK, hazard.parameter);
    let mut labels = Labels::new(frame, 10.5);
    let mut others = OTHERS.iter().cycle();
    let mut lines = Vec::new();
    for sweep in &hazard.sweeps {
        let (colour, mark) = if sweep.is_ours { (OURS, Mark::Disc) } else { *others.next().unwrap_or(&OTHERS[0]) };
        let height = |error_of: f64| if error_of.is_finite() { error.at(error_of) } else { error.ends[1] };
        let points: Vec<[f64; 2]> = sweep.points.iter().enumerate().map(|(i, p)| [place(i), height(p.error)]).collect();
        drawing.line(&points, colour, if sweep.is_ours { 2.2 } else { 1.5 }, 0.9);
        for [x, y] in &points {
            drawing.mark([*x, *y], mark, 3.2, colour);
            labels.keep_free([x - 4.0, y - 4.0, x + 4.0, y + 4.0]);
        }
        // A label may not lie across a line either.
        for ends in points.windows(2) {
            for part in 1..6 {
                let s = f64::from(part) / 6.0;
                let at = [0, 1].map(|k| ends[0][k] + s * (ends[1][k] - ends[0][k]));
                labels.keep_free([at[0] - 3.0, at[1] - 2.0, at[0] + 3.0, at[1] + 2.0]);
            }
        }
        lines.push((points, colour, sweep.method));
    }
    for (points, colour, method) in lines {
        // Where there is most room: at the middle of the line, which the label avoids.
        if let Some(at) = points.get(points.len() / 2) {
            labels.place(drawing, *at, colour, method);
        }
    }
}

/// Values of the parameter under the frame, as many as there is room for.
fn ticks(drawing: &mut Drawing, hazard: &Hazard, frame: &[f64; 4], place: impl Fn(usize) -> f64) {
    let Some(longest) = hazard.sweeps.iter().max_by_key(|sweep| sweep.points.len()) else { return };
    let mut free = f64::NEG_INFINITY;
    for (i, point) in longest.points.iter().enumerate() {
        let said = value(point.at);
        let (x, width) = (place(i), text_width(&said, 10.5, false));
        drawing.line(&[[x, frame[3]], [x, frame[3] + 4.0]], GREY, 1.0, 1.0);
        if x - 0.5 * width > free {
            drawing.text([x, frame[3] + 17.0], Anchor::Middle, 10.5, INK, &said);
            free = x + 0.5 * width + 7.0;
        }
    }
}

/// A value of a parameter as people write it.
pub(super) fn value(x: f64) -> String {
    let power = x.abs().log10();
    if x != 0.0 && power.fract().abs() < 1e-9 && !(-2.0..=3.0).contains(&power) {
        #[expect(clippy::cast_possible_truncation, reason = "a power of ten of an f64")]
        let power = power.round() as i32;
        return if !(-2..=3).contains(&power) { format!("1e{power}") } else { plain(power) };
    }
    if x == 0.0 || (0.01..1e5).contains(&x.abs()) {
        let decimals = if x.abs() >= 10.0 { 2 } else { 3 };
        let text = format!("{x:.decimals$}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{x:.1e}").replace(".0e", "e")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_short() {
        let told = [0.0, 1e-12, 89.99, 1e9, 3.5e-4, 12.0, 0.1].map(value);
        assert_eq!(told, ["0", "1e-12", "89.99", "1e9", "3.5e-4", "12", "0.1"]);
    }
}
