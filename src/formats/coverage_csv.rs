//! `coverage.csv`: how each facet has been seen.

use std::fmt::Write as _;
use std::io::{self, Write};

use crate::geometry::planetocentric_deg;
use crate::product::Coverage;
use crate::scene::Body;

/// Names of the columns. Facets count from 0; places are those of their centroids, planetocentric, longitude east; `part` is the largest share of the
/// facet's area that one acquisition has seen. What a facet that is never seen does not have is left empty.
const COLUMNS: &str = "facet,latitude_deg,longitude_deg,area_m2,sights,sampling_m,incidence_min_deg,incidence_max_deg,emission_min_deg,emission_max_deg,part";

/// Writes a row for each facet.
///
/// # Errors
/// Those of `out`.
pub(super) fn write(out: &mut impl Write, coverage: &Coverage, body: &Body) -> io::Result<()> {
    writeln!(out, "{COLUMNS}")?;
    let mut row = String::new();
    for facet in 0..body.mesh.facets.len() {
        let plane = body.mesh.facet(facet);
        let [latitude_deg, longitude_deg] = planetocentric_deg(plane.centroid_m() + body.origin_m);
        row.clear();
        let sights = coverage.sights[facet];
        // Writing to a text does not fail.
        let _ = write!(row, "{facet},{latitude_deg},{longitude_deg},{},{sights}", plane.area_m2());
        if sights == 0 {
            row.push_str(",,,,,,0");
        } else {
            let ([i, most_i], [e, most_e]) = (coverage.incidence_deg[facet], coverage.emission_deg[facet]);
            let (sampling_m, part) = (coverage.sampling_m[facet], coverage.part[facet]);
            let _ = write!(row, ",{sampling_m},{i},{most_i},{e},{most_e},{part}");
        }
        writeln!(out, "{row}")?;
    }
    Ok(())
}
