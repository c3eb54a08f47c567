//! `.npz`: NumPy arrays in a zip file, stored. Facet tables are written and read back bit for bit; footprints and radiance of facets are written.
//!
//! The member `header` is a text of JSON (`str(np.load(f)["header"])`): format, versions, scene, and what each array holds.

mod archive;
mod radiance;
mod sights;
mod table;
mod write;

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use self::write::{About, Column, Values, write};
use crate::error::Result;
use crate::product::{CellPart, Footprints, MapGrid, ReflectedPart, Sampling};
use crate::scene::Models;
use crate::spectral::Light;

pub use self::archive::{ArrayInfo, Shaped, list, read_f64s};
pub(super) use self::archive::{Member, beginning, members, text};
pub(in crate::formats) use self::radiance::{FACET_RADIANCE, RADIANCE};
pub use self::radiance::{RadianceOfFacets, write_facet_radiance};
pub use self::sights::{read_sights, sights_id, write_sights};
pub use self::table::{read_table, write_table};

/// What the header of a facet table says it is.
pub const TABLE: &str = "mmxrt facet table";
const FOOTPRINTS: &str = "mmxrt footprints";
/// Versions of facet tables that are read.
const TABLE_VERSIONS: &[u32] = &[1, 2, 3];
/// The version of footprints that is written.
const FOOTPRINTS_VERSION: u32 = 1;
const LOOKUP: &str = "mmxrt map lookup";
/// The version of look-up tables that is written.
const LOOKUP_VERSION: u32 = 1;

/// What the member `header` says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// What the file holds: `mmxrt facet table`, `mmxrt footprints`, `mmxrt map lookup` or `mmxrt facet radiance`.
    pub format: String,
    /// Version of that format.
    pub format_version: u32,
    /// Version of mmxrt that wrote it.
    pub mmxrt: String,
    /// Which scene it belongs to, as its writer named it.
    pub scene: String,
    /// Of a facet table the names of its sources, in order: the first words of their arrays' names. Not in version 1, which has the
    /// Sun, and may have Mars.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<String>,
    /// By which equations a facet table was solved; `None` in those of older versions, which were solved as their scene said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub models: Option<Models>,
    /// How far off light between facets is by sampling; `None` where there is none, or in tables of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampling: Option<Sampling>,
    /// Of a facet table the light that facets send each other: what its arrays are called, and the spectra that they stand for. None before version 3.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reflected: Vec<ReflectedBy>,
    /// Of radiance of facets which facets, and towards whom; `None` in what older versions wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seen: Option<FacetsSeen>,
    /// Every array: its unit and meaning.
    pub fields: BTreeMap<String, Field>,
}

/// Facets, and towards whom they send their radiance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FacetsSeen {
    /// Name of the mesh and its origin: [`study::mesh_id`](crate::study::mesh_id).
    pub mesh: String,
    /// Where the observer is, body-fixed, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_m: Option<[f64; 3]>,
    /// Its direction, body-fixed, if it is so far away that this is the same from everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub towards: Option<[f64; 3]>,
}

/// Light that facets send each other, at a wavelength, and its spectrum for an irradiance of 1 there: a sum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReflectedBy {
    /// Name of the array of irradiances.
    pub array: String,
    /// The wavelength, um.
    pub um: f64,
    /// In bands of what light.
    pub light: Light,
    /// Irradiance normal to the beam of each source there, W m-2 um-1.
    pub sources: Vec<f64>,
    /// Reflectance of each material there.
    pub reflectance: Vec<f64>,
    /// What is added up.
    pub parts: Vec<ReflectedPart>,
}

/// What an array holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Unit; 1 if dimensionless.
    pub unit: String,
    /// Meaning.
    pub meaning: String,
}

/// Writes the look-up table of a map: which pixels are in which of its cells, and what each counts there.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) if the file cannot be written.
pub fn write_lookup(path: &Path, grid: &MapGrid, parts: &[CellPart], scene: &str) -> Result<()> {
    let column = |name, meaning, values| Column::new(name, "1", meaning, values);
    let of = |part: fn(&CellPart) -> u32| parts.iter().map(part).collect::<Vec<u32>>();
    let (cell, sample, line) = (of(|part| part.cell), of(|part| part.sample), of(|part| part.line));
    let weight = grid.weights(parts);
    let columns = [
        column("cell", "cell of the map, from 0, row after row", Values::U32(&cell)),
        column("sample", "sample of a pixel in it, from 0", Values::U32(&sample)),
        column("line", "line of that pixel, from 0", Values::U32(&line)),
        column("weight", "share of what is seen of the cell that the pixel sees", Values::F64(&weight)),
    ];
    write(path, (LOOKUP, LOOKUP_VERSION), scene, About::default(), &columns)
}

/// Writes footprints: which facets each pixel sees, as a sparse matrix [pixel, facet] (CSR).
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) if the file cannot be written.
pub fn write_footprints(path: &Path, footprints: &Footprints, scene: &str) -> Result<()> {
    let column = |name, meaning, values| Column::new(name, "1", meaning, values);
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
    write(path, (FOOTPRINTS, FOOTPRINTS_VERSION), scene, About::default(), &columns)
}
