//! Tests a plain matcher on the bands of a product, against the truth.

use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::folder::Staged;
use crate::formats::{matches_csv, product_image, registry};
use crate::progress::{Watch, tell};
use crate::study::coregister::{Image, Quality, Truth, Windows, quality, tried};

/// Matches windows of one band in another, both counted from 0; on request a table (whether it may be replaced)
/// receives them all.
///
/// # Errors
/// [`Error::Io`], and what else is wrong with the product's images; [`Error::Invalid`] if it has no displacements, or no such band; [`Error::Interrupted`].
pub fn coregister(
    product: &Path,
    bands: [usize; 2],
    windows: Windows,
    output: Option<(&Path, bool)>,
    watch: Watch<'_>,
) -> Result<Quality> {
    let (cube, displacement) = (product_image(product, "cube"), product.join("displacement.img"));
    let staged = output.map(|(target, replace)| Staged::file(target, replace)).transpose()?;
    if let Some(staged) = &staged {
        staged.spares([cube.as_path(), displacement.as_path()])?;
    }
    if cube.exists() && !displacement.is_file() {
        let problem =
            Problem::new(Location::file(product), "has no displacement.img: all its bands were taken at once");
        let help = "simulate a scene with a `[flight]` and `kind = \"tunable_filter\"`";
        return Err(Error::Invalid(vec![problem.with_help(help)]));
    }
    tell(watch, "reading", 0, 1)?;
    let (mut radiance, mut moved) = (registry::image(&cube)?, registry::image(&displacement)?);
    let (samples, lines) = (radiance.columns, radiance.rows);
    if [moved.columns, moved.rows, moved.bands.len()] != [samples, lines, 2 * radiance.bands.len()] {
        let message = format!(
            "{} x {} pixels and {} planes: cube.img's size and two planes per band are expected",
            moved.columns,
            moved.rows,
            moved.bands.len()
        );
        return Err(Error::invalid(Location::file(&displacement), message));
    }
    let mut read = |band: usize| -> Result<[Vec<f64>; 3]> {
        let mut all: [Vec<f64>; 3] = Default::default();
        radiance.read(band, &mut all[0])?;
        moved.read(2 * band, &mut all[1])?;
        moved.read(2 * band + 1, &mut all[2])?;
        Ok(all)
    };
    let [from, to] = [read(bands[0])?, read(bands[1])?];
    tell(watch, "reading", 1, 1)?;
    tell(watch, "matching", 0, 1)?;
    let size = [samples, lines];
    let truth =
        Truth { from: [image(&from[1], size), image(&from[2], size)], to: [image(&to[1], size), image(&to[2], size)] };
    let tried = tried(image(&from[0], size), image(&to[0], size), truth, windows);
    tell(watch, "matching", 1, 1)?;
    if let Some(staged) = staged {
        staged.put(staged.path(), |out| std::io::Write::write_all(out, matches_csv::table(&tried).as_bytes()))?;
        staged.commit()?;
    }
    Ok(quality(&tried))
}

fn image(values: &[f64], [samples, lines]: [usize; 2]) -> Image<'_> {
    Image { values, samples, lines }
}
