//! The page of stability: what it says, the panels, and the table of methods and hazards. It loads nothing.

use std::fmt::Write as _;

use super::page::{foot, head};
use super::stability_picture::value;
use crate::formats::drawing::{Drawing, escaped};
use crate::study::stability::{Hazard, LEVELS};

pub(super) fn page(hazards: &[Hazard], drawing: &Drawing) -> String {
    let mut html = head("Where methods fail");
    html.push_str(
        "<h1>Where methods fail</h1>\n\
         <p>Every method is right on a benign scene. Here each is driven along a hazard until its error shows, against a closed form or the same \
         scene where the hazard is absent. An error of <b>1e-6</b> is one that nobody would see, <b>0.001</b> spoils a measurement, and \
         <b>0.1</b> is seen by eye. <b>Bold</b>: what this program does.</p>\n\
         <p class=\"muted\"><b>f64, f32</b>: numbers of 16 and of 7 digits. <b>Rays</b>: a pixel is the mean of what some rays through it meet. <b>Painter's \
         algorithm</b>: whole facets are painted one over the other, from the farthest to the nearest. <b>Sun as a camera</b>: shadows by the thesis's \
         perspective projection from the Sun, with its distance divided so that digits suffice; here the Sun's rays are parallel instead.</p>\n",
    );
    html.push_str(&format!("<div class=\"drawing\">{}</div>\n", drawing.inline_svg()));
    html.push_str("<h2>Where each starts to fail</h2>\n");
    for hazard in hazards {
        let _ = write!(
            html,
            "<h3>{}</h3>\n<p class=\"muted\">{}</p>\n<div class=\"wide\"><table><thead><tr><th>method</th><th>above 1e-6 from</th>\
             <th>above 0.001 from</th><th>above 0.1 from</th><th>worst</th><th class=\"text\">what it does</th></tr></thead><tbody>\n",
            escaped(&capital(hazard.name)),
            escaped(&format!("{} Parameter: {}.", hazard.truth, hazard.parameter))
        );
        for sweep in &hazard.sweeps {
            let _ = write!(
                html,
                "<tr{}><td>{}</td>",
                if sweep.is_ours { " class=\"best\"" } else { "" },
                escaped(sweep.method)
            );
            for (level, colour) in LEVELS.into_iter().zip(["#fff6d6", "#ffe0b8", "#ffc9bd"]) {
                let _ = match sweep.fails_from(level) {
                    Some(at) => write!(html, "<td style=\"background:{colour}\">{}</td>", value(at)),
                    None => write!(html, "<td style=\"background:#e5f4ea\">never</td>"),
                };
            }
            let worst = sweep.worst();
            let worst = if worst.is_finite() { value(two_digits(worst)) } else { "no result".into() };
            let _ = writeln!(html, "<td>{worst}</td><td class=\"text said\">{}</td></tr>", escaped(sweep.then));
        }
        html.push_str("</tbody></table></div>\n");
    }
    html.push_str(&foot());
    html
}

/// A number to two digits that count.
fn two_digits(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
