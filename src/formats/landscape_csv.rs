//! `.._craters.csv` and `.._boulders.csv`: what a landscape was made with.

use std::io::{self, Write};

use crate::landscape::{MadeBoulder, MadeCrater};

/// Writes a row for each crater of the production: number of its group, from 0; centre east and north of the site's middle, m; rim-to-rim diameter, m; age, 0
/// (now) to 1 (the oldest); depth from rim to floor, m; whether the mesh is fine enough to show it (1 or 0).
///
/// # Errors
/// Those of `out`.
pub fn write_craters(out: &mut impl Write, craters: &[MadeCrater]) -> io::Result<()> {
    writeln!(out, "group,x_m,y_m,diameter_m,age,depth_m,shown")?;
    for c in craters {
        let [x_m, y_m] = c.centre_m;
        writeln!(out, "{},{x_m},{y_m},{},{},{},{}", c.group, c.diameter_m, c.age, c.depth_m, u8::from(c.shown))?;
    }
    Ok(())
}

/// Writes a row for each boulder: number of its group, from 0; place east and north of the site's middle, m; longest axis, m; share of its height below the
/// ground; its first facet in the mesh, from 0, and how many it has (empty and 0 if the mesh is too coarse for it).
///
/// # Errors
/// Those of `out`.
pub fn write_boulders(out: &mut impl Write, boulders: &[MadeBoulder]) -> io::Result<()> {
    writeln!(out, "group,x_m,y_m,diameter_m,buried,first_facet,facets")?;
    for b in boulders {
        let [x_m, y_m] = b.place_m;
        let [first, count] = b.facets.map_or([String::new(), "0".into()], |both| both.map(|n| n.to_string()));
        writeln!(out, "{},{x_m},{y_m},{},{},{first},{count}", b.group, b.diameter_m, b.buried)?;
    }
    Ok(())
}
