//! The tables of stability: where each method starts to fail, and every point.

use std::fmt::Write as _;

use super::csv::quoted;
use crate::study::stability::{Hazard, LEVELS};

/// A row for each method and hazard.
pub(super) fn table(hazards: &[Hazard]) -> String {
    let mut text = String::from(
        "# where the error first exceeds 1e-6, 1e-3, 1e-1, as a value of the parameter; empty: nowhere. Every point is in stability_points.csv\n\
         hazard,parameter,method,ours,from_1e-6,from_1e-3,from_1e-1,worst_error,what_it_does_then,truth\n",
    );
    for hazard in hazards {
        for sweep in &hazard.sweeps {
            let [a, b, c] = LEVELS.map(|level| sweep.fails_from(level).map_or(String::new(), |at| format!("{at}")));
            // Writing into a string does not fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{a},{b},{c},{:.3e},{},{}",
                quoted(hazard.name),
                quoted(hazard.parameter),
                quoted(sweep.method),
                u8::from(sweep.is_ours),
                sweep.worst(),
                quoted(sweep.then),
                quoted(hazard.truth)
            );
        }
    }
    text
}

/// A row for each value of a parameter.
pub(super) fn points(hazards: &[Hazard]) -> String {
    let mut text = String::from("hazard,method,parameter,value,error\n");
    for hazard in hazards {
        for sweep in &hazard.sweeps {
            for point in &sweep.points {
                let _ = writeln!(
                    text,
                    "{},{},{},{},{:.3e}",
                    quoted(hazard.name),
                    quoted(sweep.method),
                    quoted(hazard.parameter),
                    point.at,
                    point.error
                );
            }
        }
    }
    text
}
