//! The drawing of a chart: error against CPU time, both logarithmic, a panel for each question and band.

use crate::formats::drawing::{Anchor, Colour, Drawing, Labels, LogAxis, Mark, text_width};
use crate::study::chart::{Chart, Entry, Family, Question};

const WIDTH: f64 = 1120.0;
/// Heights of panels: of effects, whose bands are side by side, and of geometry.
const PANELS: [f64; 2] = [330.0, 420.0];
/// Above the first section, px, and above the panels of each.
const HEAD: f64 = 84.0;
const SECTION: f64 = 66.0;
/// Left, right of a panel's frame, and above, below it.
const MARGIN: [f64; 4] = [96.0, 24.0, 30.0, 58.0];
/// Errors beyond these powers of ten are drawn at the edge.
const ERROR_POWERS: [i32; 2] = [-8, 1];
/// Smaller errors are rounding: they do not stretch the axis.
const ROUNDING: f64 = 1e-6;

const INK: Colour = [34, 40, 49];
const PALE: Colour = [222, 226, 231];
const GREY: Colour = [108, 117, 128];
const BEST: Colour = [120, 130, 145];

/// Colour and mark of a family: distinct also to the colour-blind (Okabe and Ito 2008) and without colour.
pub(super) fn style(family: Family) -> (Colour, Mark) {
    match family {
        Family::Full | Family::Exact => ([20, 20, 20], Mark::Star),
        Family::Image => ([0, 114, 178], Mark::Disc),
        Family::Shadows => ([213, 94, 0], Mark::Square),
        Family::Models => ([0, 135, 95], Mark::Triangle),
        Family::Facets => ([170, 85, 150], Mark::Diamond),
        Family::Other => ([166, 118, 0], Mark::Plus),
    }
}

/// What a question is called, and what its errors are of.
pub(super) fn asked(question: Question) -> [&'static str; 2] {
    match question {
        Question::Effects => [
            "Which effects? What leaving some out costs in accuracy",
            "Exact areas and shadows, and the scene's own surfaces, in all rows. Errors are against all effects, each at its finest; the time includes choosing.",
        ],
        Question::Geometry => [
            "How are pixels and shadows computed? What shortcuts cost in accuracy",
            "The same effects throughout (direct light, and heat). Errors are against exact areas and the shadows of the Sun's disc.",
        ],
    }
}

pub(super) fn draw(chart: &Chart) -> Drawing {
    let bands = chart.bands.len();
    let height_of = |question: Question| match question {
        Question::Effects => SECTION + PANELS[0],
        Question::Geometry => SECTION + PANELS[1] * bands as f64,
    };
    let height = HEAD + Question::ALL.map(height_of).iter().sum::<f64>();
    let mut drawing = Drawing::new(WIDTH, height);
    drawing.bold([24.0, 32.0], Anchor::Start, 19.0, INK, "How wrong, for how much time");
    let facets = thousands(chart.facets);
    let [samples, lines] = chart.size;
    let size = format!("{samples} x {lines} pixels, {facets} facets");
    drawing.text([24.0, 53.0], Anchor::Start, 13.0, GREY, &shortened(&chart.scene, &size));
    let said = "Lower is nearer to the truth, left is faster. 99 of 100 pixels are below a mark; its bar reaches from the median pixel to the worst.";
    drawing.text([24.0, 71.0], Anchor::Start, 13.0, GREY, said);
    let mut top = HEAD;
    for question in Question::ALL {
        let [title, about] = asked(question);
        drawing.bold([24.0, top + 20.0], Anchor::Start, 15.5, INK, title);
        drawing.text([24.0, top + 39.0], Anchor::Start, 12.5, GREY, about);
        legend(&mut drawing, chart, question, top + 60.0);
        for band in 0..bands {
            let panel_of = match question {
                Question::Effects => {
                    let wide = WIDTH / bands as f64;
                    let left = wide * band as f64;
                    [left, top + SECTION, left + wide, top + SECTION + PANELS[0]]
                }
                Question::Geometry => {
                    let above = top + SECTION + PANELS[1] * band as f64;
                    [0.0, above, WIDTH, above + PANELS[1]]
                }
            };
            panel(&mut drawing, chart, (question, band), panel_of);
        }
        top += height_of(question);
    }
    drawing
}

/// A scene's name and what it is like, as far as there is room.
fn shortened(name: &str, about: &str) -> String {
    let mut shown: String = name.chars().filter(|c| !c.is_control()).collect();
    while text_width(&format!("{shown}: {about}"), 13.0, false) > WIDTH - 48.0 && !shown.is_empty() {
        shown.pop();
    }
    let dots = if shown.len() < name.len() { ".." } else { "" };
    format!("{shown}{dots}: {about}")
}

fn legend(drawing: &mut Drawing, chart: &Chart, question: Question, y: f64) {
    let mut families: Vec<Family> = chart.answers(question).map(|entry| entry.family).collect();
    families.sort();
    families.dedup();
    let mut x = 30.0;
    for family in families {
        let (colour, mark) = style(family);
        drawing.mark([x, y - 4.0], mark, 5.5, colour);
        drawing.text([x + 11.0, y], Anchor::Start, 12.0, INK, family.title());
        x += 11.0 + text_width(family.title(), 12.0, false) + 24.0;
    }
    drawing.dashed(&[[x - 6.0, y - 4.0], [x + 22.0, y - 4.0]], BEST, 1.3, 0.9);
    drawing.text([x + 28.0, y], Anchor::Start, 12.0, INK, "worth its time: nothing is both faster and nearer");
}

fn panel(drawing: &mut Drawing, chart: &Chart, (question, band): (Question, usize), outside: [f64; 4]) {
    let [left, right, above, below] = MARGIN;
    let frame = [outside[0] + left, outside[1] + above, outside[2] - right, outside[3] - below];
    let errors = |entry: &Entry| entry.errors[band].all;
    let entries: Vec<&Entry> = chart.answers(question).filter(|entry| entry.errors.len() > band).collect();
    let times = entries.iter().map(|entry| entry.cpu_s);
    let time = LogAxis::around(times, [-4, 6], [frame[0] + 14.0, frame[2] - 14.0]);
    let shown = entries.iter().flat_map(|entry| [errors(entry).p99, errors(entry).max, errors(entry).p50]);
    let shown = shown.filter(|error| *error > ROUNDING);
    let error = LogAxis::around(shown, ERROR_POWERS, [frame[3] - 16.0, frame[1] + 6.0]);
    axes(drawing, &frame, &time, &error);
    let um = chart.bands[band].centre_um;
    let um = (1e3 * um).round() / 1e3;
    let heat = chart.bands[band].light.glows() && um > 2.5;
    let title =
        format!("At {um} um: {}", if heat { "sunlight and the surface's own heat" } else { "reflected sunlight" });
    drawing.bold([frame[0], frame[1] - 12.0], Anchor::Start, 13.5, INK, &title);
    let best = front(drawing, &entries, band, (&time, &error), &frame);
    let mut labels = Labels::new(frame, 11.5);
    for ends in best.windows(2) {
        let [[x0, y0], [x1, y1]] = [ends[0], ends[1]];
        labels.keep_free([x0.min(x1) - 1.5, y0.min(y1) - 1.5, x0.max(x1) + 1.5, y0.max(y1) + 1.5]);
    }
    let places: Vec<[f64; 2]> =
        entries.iter().map(|entry| [time.at(entry.cpu_s), error.at(errors(entry).p99)]).collect();
    for (entry, [x, y]) in entries.iter().zip(&places) {
        let (colour, _) = style(entry.family);
        let (low, high) = (error.at(errors(entry).p50), error.at(errors(entry).max));
        drawing.line(&[[*x, low], [*x, high]], colour, 1.6, 0.45);
        for end in [low, high] {
            drawing.line(&[[x - 3.5, end], [x + 3.5, end]], colour, 1.6, 0.45);
        }
        labels.keep_free([x - 2.5, high.min(low), x + 2.5, high.max(low)]);
        labels.keep_free([x - 7.0, y - 7.0, x + 7.0, y + 7.0]);
        labels.mark([*x, *y]);
    }
    for (entry, place) in entries.iter().zip(&places) {
        let (colour, mark) = style(entry.family);
        drawing.mark(*place, mark, if is_truth(entry) { 7.0 } else { 5.5 }, colour);
    }
    for (entry, place) in entries.iter().zip(&places) {
        let (colour, _) = style(entry.family);
        let said = if is_truth(entry) { format!("{}: the truth here", entry.name) } else { entry.name.clone() };
        labels.place(drawing, *place, colour, &said);
    }
}

fn axes(drawing: &mut Drawing, frame: &[f64; 4], time: &LogAxis, error: &LogAxis) {
    drawing.rectangle([frame[0], frame[1]], [frame[2], frame[3]], [250, 251, 252], 1.0);
    for power in time.ticks() {
        let x = time.at(10f64.powi(power));
        drawing.line(&[[x, frame[1]], [x, frame[3]]], PALE, 1.0, 1.0);
        drawing.text([x, frame[3] + 18.0], Anchor::Middle, 12.0, INK, &format!("{} s", plain(power)));
    }
    for power in error.ticks() {
        let y = error.at(10f64.powi(power));
        drawing.line(&[[frame[0], y], [frame[2], y]], PALE, 1.0, 1.0);
        // What lies lower is drawn there too.
        let below = if power == error.powers[0] { "≤ " } else { "" };
        let percent = format!("{below}{} %", plain(power + 2));
        drawing.text([frame[0] - 9.0, y + 4.0], Anchor::End, 12.0, INK, &percent);
    }
    drawing.text(
        [0.5 * (frame[0] + frame[2]), frame[3] + 40.0],
        Anchor::Middle,
        12.5,
        INK,
        "CPU time for the image (all cores together)",
    );
    let said = "error of a pixel";
    drawing.text_upwards([18.0, 0.5 * (frame[1] + frame[3])], 12.0, INK, said);
}

/// Whether the others of its question are compared with it.
fn is_truth(entry: &Entry) -> bool {
    entry.family == entry.family.question().truth()
}

/// The line that nothing is below and left of.
fn front(
    drawing: &mut Drawing,
    entries: &[&Entry],
    band: usize,
    (time, error): (&LogAxis, &LogAxis),
    frame: &[f64; 4],
) -> Vec<[f64; 2]> {
    let ours = entries.iter().filter(|entry| entry.family != Family::Other);
    let mut known: Vec<(f64, f64)> = ours.map(|entry| (entry.cpu_s, entry.errors[band].all.p99)).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut line: Vec<[f64; 2]> = Vec::new();
    let mut least = f64::INFINITY;
    for (cpu_s, p99) in known.into_iter() {
        if p99 < least {
            let x = time.at(cpu_s);
            line.push([x, line.last().map_or(frame[1], |last| last[1])]);
            line.push([x, error.at(p99)]);
            least = p99;
        }
    }
    if let Some(last) = line.last().copied() {
        line.push([frame[2], last[1]]);
    }
    drawing.dashed(&line, BEST, 1.3, 0.9);
    line
}

/// A power of ten as people write it.
pub(super) fn plain(power: i32) -> String {
    match power {
        0..=5 => format!("{:.0}", 10f64.powi(power)),
        -7..0 => format!("{:.*}", power.unsigned_abs() as usize, 10f64.powi(power)),
        _ => format!("1e{power}"),
    }
}

/// A count with its thousands apart.
pub(super) fn thousands(count: usize) -> String {
    let digits = count.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).unwrap_or_default()).collect();
    groups.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_plainly() {
        assert_eq!([-8, -2, 0, 3, 6].map(plain), ["1e-8", "0.01", "1", "1000", "1e6"]);
        assert_eq!([7, 1234, 200_000].map(thousands), ["7", "1 234", "200 000"]);
    }
}
