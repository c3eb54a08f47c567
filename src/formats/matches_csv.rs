//! Tables of windows that were matched between two bands, against what is true.

use std::fmt::Write as _;

use crate::study::coregister::{Match, Tried};

/// Names of the columns: the middle of a window in the first band, pixels from the outer corner of the first one; where it was found, and where it is, in the second, less that. Cells
/// that are not known are empty.
pub const COLUMNS: &str = "sample,line,found_samples,found_lines,correlation,true_samples,true_lines,error_px";

/// A row for each window.
pub fn table(tried: &[Tried]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for window in tried {
        let [sample, line] = window.pixel.map(|i| i as f64 + 0.5);
        let found = window
            .found
            .map_or(",,".to_owned(), |Match { moved_px: [x, y], correlation }| format!("{x},{y},{correlation}"));
        let truth = window.truth_px.map_or(",".to_owned(), |[x, y]| format!("{x},{y}"));
        let error = window.error_px().map_or(String::new(), |error| error.to_string());
        let _ = writeln!(text, "{sample},{line},{found},{truth},{error}");
    }
    text
}
