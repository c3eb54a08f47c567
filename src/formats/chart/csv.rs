//! The table of a chart: a row for each method and band.

use std::fmt::Write as _;

use crate::study::chart::{Chart, Entry, Family, Spread};

pub(super) fn csv(chart: &Chart) -> String {
    let mut text = String::from(
        "# error of a pixel: |difference from the image it is compared with| / max(that one's radiance, 0.01 x median sunlit radiance of the band); CPU s of all threads\n\
         family,method,model,compared_with,facets,band_um,cpu_s,runs,on_front",
    );
    for over in ["all", "lit", "shadowed"] {
        for what in ["pixels", "p50", "p99", "p99.9", "max", "rms"] {
            let _ = write!(text, ",{over}_{what}");
        }
    }
    text.push('\n');
    for entry in &chart.entries {
        for (band, errors) in chart.bands.iter().zip(&entry.errors) {
            let family = format!("{:?}", entry.family).to_lowercase();
            let _ = write!(
                text,
                "{family},{},{},{},{},{},{:.4},{},{}",
                quoted(&entry.name),
                quoted(&entry.model),
                quoted(compared_with(chart, entry)),
                entry.facets,
                band.centre_um,
                entry.cpu_s,
                entry.runs,
                u8::from(entry.is_best)
            );
            for Spread { pixels, p50, p99, p999, max, rms } in [errors.all, errors.lit, errors.shadowed] {
                let _ = write!(text, ",{pixels},{p50:.3e},{p99:.3e},{p999:.3e},{max:.3e},{rms:.3e}");
            }
            text.push('\n');
        }
    }
    text
}

/// What the errors of a method are of.
fn compared_with<'a>(chart: &'a Chart, entry: &Entry) -> &'a str {
    match entry.family {
        Family::Other => "exact sunlight on Lambert",
        family => &chart.truth(family.question()).name,
    }
}

/// A field: in quotes if it holds what ends one.
pub(super) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
