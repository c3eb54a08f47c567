//! `.npz`: NumPy arrays in a zip file, stored. Facet tables are written and read back bit for bit; footprints are written.
//!
//! The member `header` is a text of JSON (`str(np.load(f)["header"])`): format, versions, scene, and what each array holds.

mod archive;
mod write;

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use self::archive::Npz;
use self::write::{Column, Values, write};
use crate::error::{Error, Location, Problem, Result, number};
use crate::product::{FacetTable, Footprints};
use crate::visibility::{Seen, Shown};

pub use self::archive::{ArrayInfo, Shaped, list, read_f64s};
pub(super) use self::archive::{Member, Preamble, beginning, members, preamble, text};

/// What the header of a facet table says it is.
pub const TABLE: &str = "mmxrt facet table";
const FOOTPRINTS: &str = "mmxrt footprints";
const FORMAT_VERSION: u32 = 1;

/// What the member `header` says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// What the file holds: `mmxrt facet table` or `mmxrt footprints`.
    pub format: String,
    /// Version of that format.
    pub format_version: u32,
    /// Version of mmxrt that wrote it.
    pub mmxrt: String,
    /// Which scene it belongs to, as its writer named it.
    pub scene: String,
    /// Every array: its unit and meaning.
    pub fields: BTreeMap<String, Field>,
}

/// What an array holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Unit; 1 for what has none.
    pub unit: String,
    /// Meaning.
    pub meaning: String,
}

/// Writes a facet table. `scene` says which scene it belongs to; it comes back from [`read_table`].
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write_table(path: &Path, table: &FacetTable, scene: &str) -> Result<()> {
    let sunlit = &table.sunlit;
    let column = |name, unit, meaning, values| Column { name, unit, meaning, values };
    let mut columns = vec![
        column(
            "sun_direction",
            "1",
            "unit vector from the scene's origin to the Sun, body-fixed axes",
            Values::Vector(table.sun_direction.vec().to_array()),
        ),
        column(
            "sun_irradiance",
            "1",
            "irradiance by the Sun on each facet's lit part over that normal to the beam: cos i, or 0",
            Values::F64(&table.sun_irradiance),
        ),
        column(
            "sun_lit",
            "1",
            "each facet: 0 dark, 1 lit all over, 2 lit in the polygons below",
            Values::Shown(&sunlit.shown),
        ),
        column("sun_polygon_facet", "1", "facet of each sunlit polygon, ascending", Values::U32(&sunlit.polygon_facet)),
        column(
            "sun_polygon_start",
            "1",
            "first vertex of each sunlit polygon, and the number of vertices as the last element",
            Values::Ends(&sunlit.polygon_start),
        ),
        column(
            "sun_polygon_uv",
            "1",
            "vertices (u, v) of the sunlit polygons: the point a + u (b - a) + v (c - a) of the facet",
            Values::Uv(&sunlit.uv),
        ),
    ];
    if let Some(direction) = table.mars_direction {
        columns.push(column(
            "mars_direction",
            "1",
            "unit vector from the scene's origin to the centre of Mars, body-fixed axes",
            Values::Vector(direction.vec().to_array()),
        ));
    }
    let optional = [
        (
            "mars_irradiance",
            "1",
            "irradiance by Mars on each facet over Mars' reflectance times the solar irradiance normal to the beam",
            &table.mars_irradiance,
        ),
        ("temperature_lit_k", "K", "temperature of each facet's lit part", &table.temperature_lit_k),
        ("temperature_shaded_k", "K", "temperature of each facet's shaded part", &table.temperature_shaded_k),
    ];
    for (name, unit, meaning, values) in optional {
        if !values.is_empty() {
            columns.push(column(name, unit, meaning, Values::F64(values)));
        }
    }
    write(path, TABLE, scene, &columns)
}

/// Writes footprints: which facets each pixel sees, as a sparse matrix [pixel, facet] (CSR).
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write_footprints(path: &Path, footprints: &Footprints, scene: &str) -> Result<()> {
    let column = |name, meaning, values| Column { name, unit: "1", meaning, values };
    let columns = [
        column(
            "row_start",
            "first entry of each pixel (line by line), and the number of entries as the last element",
            Values::Ends(&footprints.row_start),
        ),
        column("facet", "facet of each entry, from 0, ascending within a pixel", Values::U32(&footprints.facet)),
        column("fraction", "share of the pixel's area that sees the facet", Values::F64(&footprints.fraction)),
        column(
            "lit_fraction",
            "share of the pixel's area that sees the facet's sunlit part",
            Values::F64(&footprints.lit_fraction),
        ),
    ];
    write(path, FOOTPRINTS, scene, &columns)
}

/// Reads a facet table: the one written, bit for bit, and its header.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] naming the array that is damaged; [`Error::Unsupported`] for a newer format or a
/// compressed file; [`Error::Invalid`] with everything that is missing, of the wrong size, or out of range.
pub fn read_table(path: &Path) -> Result<(FacetTable, Header)> {
    let mut file = Npz::open(path)?;
    let header = file.header(TABLE)?;
    let mut problems = Vec::new();
    let sun_irradiance = file.f64s("sun_irradiance", 1, true, &mut problems)?;
    let lit_codes = file.bytes("sun_lit", &mut problems)?;
    let polygon_facet = file.u32s("sun_polygon_facet", &mut problems)?;
    let polygon_start = file.ends("sun_polygon_start", &mut problems)?;
    let uv = file.f64s("sun_polygon_uv", 2, true, &mut problems)?;
    let sun_direction = file.direction("sun_direction", true, &mut problems)?;
    let mars_direction = file.direction("mars_direction", false, &mut problems)?;
    let mars_irradiance = file.f64s("mars_irradiance", 1, false, &mut problems)?;
    let temperature_lit_k = file.f64s("temperature_lit_k", 1, false, &mut problems)?;
    let temperature_shaded_k = file.f64s("temperature_shaded_k", 1, false, &mut problems)?;

    // If it cannot be used, that has been told, and all others would be of another length.
    let is_comparable = !sun_irradiance.is_empty() || problems.is_empty();
    let at = |item: String| Location::file(path).with_item(item);
    if let Some(i) = lit_codes.iter().position(|code| *code > 2) {
        problems.push(Problem::new(at(format!("sun_lit[{i}]")), format!("{} is none of 0, 1, 2", lit_codes[i])));
    }
    let lit =
        lit_codes.iter().map(|code| [Shown::Nothing, Shown::Whole, Shown::Part][usize::from(*code).min(2)]).collect();
    let uv = uv.chunks_exact(2).map(|p| [p[0], p[1]]).collect();
    let sunlit = Seen { shown: lit, polygon_facet, polygon_start, uv };
    let columns = [
        ("sun_irradiance", sun_irradiance.as_slice()),
        ("mars_irradiance", &mars_irradiance),
        ("temperature_lit_k", &temperature_lit_k),
        ("temperature_shaded_k", &temperature_shaded_k),
    ];
    let problem = |item, message: String| problems.push(Problem::new(at(item), message));
    check(columns, &sunlit, mars_direction.is_some(), is_comparable, problem);
    match sun_direction {
        Some(sun_direction) if problems.is_empty() => Ok((
            FacetTable {
                sun_direction,
                sun_irradiance,
                sunlit,
                mars_direction,
                mars_irradiance,
                temperature_lit_k,
                temperature_shaded_k,
            },
            header,
        )),
        _ => Err(Error::Invalid(problems)),
    }
}

/// What is refused as out of range is so by more than numbers of far or thin facets are by rounding: finer bounds are those of the product.
const ROUNDING: f64 = 1e-3;

/// Tells what of a table does not fit together or is out of range: (item, message). Lengths are compared only on request.
fn check(
    columns: [(&str, &[f64]); 4],
    sunlit: &Seen,
    has_mars: bool,
    is_comparable: bool,
    mut problem: impl FnMut(String, String),
) {
    let [(_, sun), (_, mars), (_, lit_k), (_, shaded_k)] = columns;
    let facets = sun.len();
    if is_comparable && sunlit.shown.len() != facets {
        problem("sun_lit".into(), format!("has {} values, but sun_irradiance has {facets}", sunlit.shown.len()));
    }
    for (name, values) in columns {
        // All but the Sun's may be left out.
        if is_comparable && values.len() != facets && !values.is_empty() {
            problem(name.into(), format!("has {} values, but sun_irradiance has {facets}", values.len()));
        }
    }
    if lit_k.len() != shaded_k.len() {
        problem("temperature_lit_k".into(), "lit and shaded parts need a temperature, or neither".into());
    }
    if has_mars == mars.is_empty() && facets > 0 {
        problem("mars_irradiance".into(), "Mars needs both mars_direction and mars_irradiance, or neither".into());
    }
    for (name, values) in columns {
        if let Some(i) = values.iter().position(|v| !(*v >= 0.0 && v.is_finite())) {
            problem(format!("{name}[{i}]"), format!("{} is not a number from 0", values[i]));
        }
    }
    for (name, values) in &columns[..2] {
        if let Some(i) = values.iter().position(|v| *v > 1.0 + ROUNDING) {
            let what =
                if *name == "sun_irradiance" { "the cosine of an angle" } else { "a share of what Mars could send" };
            problem(format!("{name}[{i}]"), format!("{} is above 1: it is {what}", number(values[i])));
        }
    }
    let is_inside = |[u, v]: &[f64; 2]| [*u, *v, 1.0 - u - v].iter().all(|x| *x >= -ROUNDING && x.is_finite());
    if let Some(i) = sunlit.uv.iter().position(|uv| !is_inside(uv)) {
        let [u, v] = sunlit.uv[i];
        problem(format!("sun_polygon_uv[{i}]"), format!("{} {} is not a point of the facet", number(u), number(v)));
    }
    if let Err(message) = sunlit.validate() {
        problem("sun_polygon_start".into(), message);
    } else if let Some(i) = sunlit.polygon_start.windows(2).position(|w| w[1] - w[0] < 3) {
        problem(format!("sun_polygon_start[{i}]"), "a polygon needs three vertices".into());
    } else if let Some((facet, share)) = sunlit.overfull(1.0 + ROUNDING) {
        let message = format!("the sunlit polygons of facet {facet} are {} of it", number(share));
        problem("sun_polygon_uv".into(), message);
    }
}
