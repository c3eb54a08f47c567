//! The page of a chart: what it says, how to read it, all numbers, and the image and errors of each method. It loads nothing.

use std::fmt::Write as _;

use super::picture::{asked, style, thousands};
use super::pixels::{self, POWERS};
use crate::formats::drawing::{Drawing, escaped};
use crate::spectral::Band;
use crate::study::chart::{Chart, Entry, FLOOR, Question};

/// Columns of a band.
const COLUMNS: [&str; 7] = ["p50", "p99", "p99.9", "max", "rms", "p99 lit", "p99 shadowed"];

pub(super) fn page(chart: &Chart, drawing: &Drawing, timed: &str) -> String {
    let [samples, lines] = chart.size;
    let mut html = head(&format!("Error against time: {}", chart.scene));
    let _ = write!(
        html,
        "<h1>How wrong, for how much time</h1>\n<p class=\"muted\">{}: {samples} x {lines} pixels, {} facets. {}</p>\n",
        escaped(&chart.scene),
        thousands(chart.facets),
        escaped(timed)
    );
    html.push_str("<div class=\"advice\">\n");
    for advice in chart.advice() {
        let class = if advice.is_main { " class=\"main\"" } else { "" };
        let _ = writeln!(html, "<p{class}>{}</p>", escaped(&advice.said));
    }
    html.push_str("</div>\n");
    html.push_str(&format!("<div class=\"drawing\">{}</div>\n", drawing.inline_svg()));
    meaning(&mut html, chart);
    html.push_str(
        "<h2>All numbers</h2>\n<p class=\"muted\">By time; a click on a heading sorts by it. Bold: on the line of what is worth its time. p50: half of the pixels are off by less; \
         p99: all but 1 %; p99.9: all but 0.1 %; max: the worst; rms: root of the mean square; lit, shadowed: pixels of which more is sunlit than not, and the others.</p>\n",
    );
    Question::ALL.iter().for_each(|question| table(&mut html, chart, *question));
    gallery(&mut html, chart);
    html.push_str(&foot());
    html
}

/// The beginning of a page.
pub(super) fn head(title: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>{}</title>\n<style>\n{}</style></head><body>\n",
        escaped(title),
        include_str!("page.css")
    )
}

/// The end of a page.
pub(super) fn foot() -> String {
    format!(
        "<p class=\"muted\">Made by mmxrt {}. This page holds all that it shows; it loads nothing.</p>\n<script>\n{}</script>\n</body></html>\n",
        env!("CARGO_PKG_VERSION"),
        include_str!("sort.js")
    )
}

fn meaning(html: &mut String, chart: &Chart) {
    let bands: Vec<String> = chart.bands.iter().map(|band| format!("{} um", um(band))).collect();
    let _ = write!(
        html,
        "<h2>How to read this</h2>\n\
         <p>Each mark is a way to compute the same image. <b>To the left</b> it takes less time, <b>further down</b> it is nearer to the truth, the \
         star. There are two questions, each with a truth of its own:</p>\n\
         <ul><li><b>Which effects?</b> Every image has exact areas and shadows; what differs is which effects are computed, as \
         <code>mmxrt simulate --model .. --tolerance ..</code> chooses them. The truth has all that the scene has inputs for, each finer than any of the \
         others takes it. The time includes choosing.</li>\n\
         <li><b>How are pixels and shadows computed?</b> Every image has the same effects: light straight from the Sun, Mars and lamps, and heat, without light between \
         facets, so that the error is that of the shortcut alone. The truth has exact areas, and exact shadows of 37 points of the Sun's disc.</li></ul>\n\
         <p>The error of a truth is 0 by definition; what no model here knows is in no error.</p>\n\
         <p><b>Error of a pixel</b> = |its radiance &minus; the true one| / the true one. In dark places it is taken relative to {} % of the \
         median sunlit radiance, so that what is nearly black does not count for more than it shows. 0.1 % is one part in a thousand. The mark is the \
         99th percentile: 99 of 100 pixels are off by less. The bar reaches from the median pixel to the worst. Errors are given at {}.</p>\n\
         <p><b>Time</b> is CPU time, all cores together, from a checked scene to the radiance of every pixel; reading files is not in it, nor are \
         backplanes. Of quick methods the fastest of three runs counts. The dashed line joins what is worth its time: nothing is both \
         faster and nearer.</p>\n",
        100.0 * FLOOR,
        bands.join(" and ")
    );
    if !chart.notes.is_empty() {
        html.push_str("<h2>What to know of these numbers</h2>\n<ul>\n");
        chart.notes.iter().for_each(|note| html.push_str(&format!("<li>{}</li>\n", escaped(note))));
        html.push_str("</ul>\n");
    }
}

fn table(html: &mut String, chart: &Chart, question: Question) {
    let _ = writeln!(html, "<h3>{}</h3>\n<p class=\"muted\">{}</p>", asked(question)[0], asked(question)[1]);
    html.push_str("<div class=\"wide\"><table><thead><tr><th>method</th><th class=\"text\">as in simulate</th><th>facets</th><th>CPU s</th><th>x faster</th>");
    for band in &chart.bands {
        for what in COLUMNS {
            let _ = write!(html, "<th>{what}<br>{} um</th>", um(band));
        }
    }
    html.push_str("</tr></thead><tbody>\n");
    let truth_s = chart.truth(question).cpu_s;
    let mut entries: Vec<&Entry> = chart.answers(question).collect();
    entries.sort_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
    for entry in entries {
        let class = if entry.is_best { " class=\"best\"" } else { "" };
        let _ = write!(
            html,
            "<tr{class}><td>{}{}</td><td class=\"text\">{}</td><td data-value=\"{}\">{}</td><td data-value=\"{}\">{:.3}</td><td data-value=\"{}\">{:.2}</td>",
            dot(entry.family),
            escaped(&entry.name),
            escaped(&entry.model),
            entry.facets,
            thousands(entry.facets),
            entry.cpu_s,
            entry.cpu_s,
            truth_s / entry.cpu_s,
            truth_s / entry.cpu_s
        );
        for errors in &entry.errors {
            let (all, lit, shadowed) = (&errors.all, &errors.lit, &errors.shadowed);
            for value in [all.p50, all.p99, all.p999, all.max, all.rms, lit.p99, shadowed.p99] {
                let _ = write!(html, "<td data-value=\"{value}\">{}</td>", percent(value));
            }
        }
        let missing = COLUMNS.len() * (chart.bands.len() - entry.errors.len());
        html.push_str(&"<td>&ndash;</td>".repeat(missing));
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
}

fn gallery(html: &mut String, chart: &Chart) {
    html.push_str("<h2>Pictures, and where they are wrong</h2>\n");
    let [low, high] = POWERS;
    let stops: Vec<String> = (0..=12)
        .map(|i| {
            let [r, g, b] = pixels::colour(10f64.powf(f64::from(low) + f64::from(high - low) * f64::from(i) / 12.0));
            format!("rgb({r},{g},{b})")
        })
        .collect();
    let _ = writeln!(
        html,
        "<div class=\"scale\">error {} <span class=\"bar\" style=\"background:linear-gradient(to right,{})\"></span> {} or more; black: none</div>",
        percent(10f64.powi(low)),
        stops.join(","),
        percent(10f64.powi(high))
    );
    for question in Question::ALL {
        let _ = writeln!(html, "<h3>{}</h3>\n<div class=\"cards\">", asked(question)[0]);
        let truth = chart.truth(question);
        chart.answers(question).for_each(|entry| card(html, chart, entry, truth));
        html.push_str("</div>\n");
    }
}

/// A method: what it does, its image, and where it is wrong.
fn card(html: &mut String, chart: &Chart, entry: &Entry, truth: &Entry) {
    let _ = write!(
        html,
        "<div class=\"card\"><h4>{}{}</h4><p>{} <b>{:.3} CPU s</b>, p99 {}.</p><div class=\"row\">",
        dot(entry.family),
        escaped(&entry.name),
        escaped(&entry.account),
        entry.cpu_s,
        percent(entry.p99())
    );
    let mut figure = |uri: &str, said: &str| {
        let _ =
            write!(html, "<figure><img src=\"{uri}\" alt=\"{0}\"><figcaption>{0}</figcaption></figure>", escaped(said));
    };
    if let (Some(image), Some(band)) = (entry.image.first(), chart.bands.first()) {
        let said = format!("image at {} um", um(band));
        figure(&pixels::image(chart.size, image, &truth.image[0], &chart.ground), &said);
    }
    if std::ptr::eq(entry, truth) {
        for (band, image) in chart.bands.iter().zip(&entry.image).skip(1) {
            let said = format!("image at {} um", um(band));
            figure(&pixels::image(chart.size, image, image, &chart.ground), &said);
        }
    } else {
        for (band, errors) in chart.bands.iter().zip(&entry.errors) {
            figure(&pixels::errors(chart.size, &errors.of_pixel), &format!("error at {} um", um(band)));
        }
    }
    html.push_str("</div></div>\n");
}

/// The centre of a band, um, to a nm.
fn um(band: &Band) -> f64 {
    (1e3 * band.centre_um).round() / 1e3
}

fn dot(family: crate::study::chart::Family) -> String {
    let ([r, g, b], _) = style(family);
    format!("<span class=\"dot\" style=\"background:rgb({r},{g},{b})\"></span>")
}

/// An error with two digits that count.
pub(super) fn percent(error: f64) -> String {
    let percent = 100.0 * error;
    match percent {
        // Something where the truth is nothing.
        f64::INFINITY => "infinite".into(),
        0.0 => "0".into(),
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 1.0 => format!("{p:.1} %"),
        p if p >= 0.1 => format!("{p:.2} %"),
        p if p >= 0.01 => format!("{p:.3} %"),
        p if p >= 0.001 => format!("{p:.4} %"),
        p if p >= 0.0001 => format!("{p:.5} %"),
        _ => "below 0.0001 %".into(),
    }
}
