//! `.npz`: NumPy arrays in a zip file, stored. Facet tables are written and read back bit for bit; footprints are written.
//!
//! The member `header` is a text of JSON (`str(np.load(f)["header"])`): format, versions, scene, and what each array holds.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use super::input;
use crate::error::{Error, Location, Problem, Result, number};
use crate::formats::input::MOST_DEFLATED;
use crate::geometry::Direction;
use crate::product::{FacetTable, Footprints, Lit, Sunlit};

/// What the header of a facet table says it is.
pub const TABLE: &str = "mmxrt facet table";
const FOOTPRINTS: &str = "mmxrt footprints";
const FORMAT_VERSION: u32 = 1;
const COMPRESSED: &str =
    "a .npz file compressed otherwise than by deflate (save it with np.savez or np.savez_compressed)";

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

/// An array about to be written.
struct Column<'a> {
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    values: Values<'a>,
}

enum Values<'a> {
    F64(&'a [f64]),
    U32(&'a [u32]),
    Lit(&'a [Lit]),
    Uv(&'a [[f64; 2]]),
    Vector([f64; 3]),
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
            Values::Lit(&sunlit.lit),
        ),
        column("sun_polygon_facet", "1", "facet of each sunlit polygon, ascending", Values::U32(&sunlit.polygon_facet)),
        column(
            "sun_polygon_start",
            "1",
            "first vertex of each sunlit polygon, and the number of vertices as the last element",
            Values::U32(&sunlit.polygon_start),
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
            Values::U32(&footprints.row_start),
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

fn write(path: &Path, format: &str, scene: &str, columns: &[Column<'_>]) -> Result<()> {
    let fields = columns
        .iter()
        .map(|c| (c.name.to_owned(), Field { unit: c.unit.to_owned(), meaning: c.meaning.to_owned() }))
        .collect();
    let header = Header {
        format: format.to_owned(),
        format_version: FORMAT_VERSION,
        mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.to_owned(),
        fields,
    };
    let io = |e| Error::io(path, "writing", e);
    let text = serde_json::to_string(&header).map_err(|e| io(e.into()))?;
    let mut file = KeepError {
        file: BufWriter::with_capacity(1 << 20, File::create(path).map_err(io)?),
        at: 0,
        end: 0,
        error: None,
    };
    let done: std::io::Result<()> = (|| {
        let mut zip = ZipWriter::new(&mut file);
        // NumPy's text is UTF-32.
        let utf32: Vec<u8> = text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        start(&mut zip, "header", &format!("<U{}", utf32.len() / 4), "()", utf32.len())?;
        zip.write_all(&utf32)?;
        for column in columns {
            column.write(&mut zip)?;
        }
        zip.finish()?;
        Ok(())
    })();
    // The file's own error tells more than what the zip made of it.
    file.error.map_or(done, Err).and_then(|()| file.file.flush()).map_err(io)
}

/// A file that keeps its first error and pretends that all is well, because `ZipWriter` prints, when dropped, what it
/// could not write.
struct KeepError {
    file: BufWriter<File>,
    at: u64,
    end: u64,
    error: Option<std::io::Error>,
}

impl KeepError {
    fn attempt(&mut self, act: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) {
        if self.error.is_none() {
            self.error = act(&mut self.file).err();
        }
    }
}

impl Write for KeepError {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.attempt(|file| file.write_all(bytes));
        self.at += bytes.len() as u64;
        self.end = self.end.max(self.at);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.attempt(Write::flush);
        Ok(())
    }
}

impl Seek for KeepError {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        // Positions are told without asking the file, which may have failed.
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(offset) => self.at.saturating_add_signed(offset),
            SeekFrom::End(offset) => self.end.saturating_add_signed(offset),
        };
        let at = self.at;
        self.attempt(
            |file| if file.stream_position()? == at { Ok(()) } else { file.seek(SeekFrom::Start(at)).map(drop) },
        );
        Ok(self.at)
    }
}

/// Starts a member: its entry in the zip file, and NumPy's preamble.
fn start<W: Write + Seek>(
    zip: &mut ZipWriter<W>,
    name: &str,
    descr: &str,
    shape: &str,
    bytes: usize,
) -> std::io::Result<()> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(bytes as u64 >= u64::from(u32::MAX) - 1024);
    zip.start_file(format!("{name}.npy"), options)?;
    let mut preamble = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic and length take 10 bytes; the data begins at a multiple of 64.
    let padding = 63 - (10 + preamble.len()) % 64;
    preamble.extend(std::iter::repeat_n(' ', padding));
    preamble.push('\n');
    zip.write_all(b"\x93NUMPY\x01\x00")?;
    zip.write_all(&(preamble.len() as u16).to_le_bytes())?;
    zip.write_all(preamble.as_bytes())
}

impl Column<'_> {
    fn write<W: Write + Seek>(&self, zip: &mut ZipWriter<W>) -> std::io::Result<()> {
        let (descr, shape, bytes) = match &self.values {
            Values::F64(v) => ("<f8", format!("({},)", v.len()), 8 * v.len()),
            Values::U32(v) => ("<u4", format!("({},)", v.len()), 4 * v.len()),
            Values::Lit(v) => ("|u1", format!("({},)", v.len()), v.len()),
            Values::Uv(v) => ("<f8", format!("({}, 2)", v.len()), 16 * v.len()),
            Values::Vector(_) => ("<f8", "(3,)".to_owned(), 24),
        };
        start(zip, self.name, descr, &shape, bytes)?;
        match &self.values {
            Values::F64(v) => pieces(zip, v, |x| x.to_le_bytes()),
            Values::U32(v) => pieces(zip, v, |x| x.to_le_bytes()),
            Values::Lit(v) => pieces(zip, v, |x| [*x as u8]),
            Values::Uv(v) => pieces(zip, v.as_flattened(), |x| x.to_le_bytes()),
            Values::Vector(v) => pieces(zip, v, |x| x.to_le_bytes()),
        }
    }
}

/// Writes values as bytes, a few thousand at a time.
fn pieces<T, const N: usize>(out: &mut impl Write, values: &[T], bytes: impl Fn(&T) -> [u8; N]) -> std::io::Result<()> {
    values.chunks(8192).try_for_each(|piece| out.write_all(&piece.iter().flat_map(&bytes).collect::<Vec<u8>>()))
}

/// Name, NumPy's type and shape of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArrayInfo {
    /// Name of the member, without `.npy`.
    pub name: String,
    /// Type, as in `<f8`.
    pub descr: String,
    /// Length of each axis.
    pub shape: Vec<usize>,
}

/// The header of one of our files (`None` in any other `.npz`) and its arrays.
///
/// # Errors
/// [`Error::Io`], or [`Error::Syntax`] if it is not an `.npz` file.
pub fn list(path: &Path) -> Result<(Option<Header>, Vec<ArrayInfo>)> {
    let mut file = Npz::open(path)?;
    let names = file.zip.file_names().filter_map(|n| Some(n.ok()?.strip_suffix(".npy")?.to_owned()));
    let names: Vec<String> = names.filter(|n| n != "header").collect();
    let header = file.array("header").ok().flatten().and_then(|a| serde_json::from_str(&a.text()?).ok());
    let mut arrays = Vec::new();
    for name in names {
        if let Some(array) = file.array(&name)? {
            arrays.push(ArrayInfo { name, descr: array.descr, shape: array.shape });
        }
    }
    Ok((header, arrays))
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
    let polygon_start = file.u32s("sun_polygon_start", &mut problems)?;
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
    let lit = lit_codes.iter().map(|code| [Lit::Dark, Lit::Full, Lit::Part][usize::from(*code).min(2)]).collect();
    let uv = uv.chunks_exact(2).map(|p| [p[0], p[1]]).collect();
    let sunlit = Sunlit { lit, polygon_facet, polygon_start, uv };
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

/// Shape and values of an array.
pub type Shaped = (Vec<usize>, Vec<f64>);

/// Arrays of numbers (f4, f8) by name, as f64; `None` where there is none of that name.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] naming the array that is damaged; [`Error::Unsupported`] for a compressed file;
/// [`Error::Invalid`] for an array of another type.
pub fn read_f64s(path: &Path, names: &[&str]) -> Result<Vec<Option<Shaped>>> {
    let mut file = Npz::open(path)?;
    names
        .iter()
        .map(|name| {
            let Some(array) = file.array(name)? else { return Ok(None) };
            let values = match array.descr.as_str() {
                "<f8" => array.data.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
                "<f4" => array.data.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
                other => {
                    return Err(Error::invalid(file.at(name), format!("is of type {other:?}; expected <f8 or <f4")));
                }
            };
            Ok(Some((array.shape, values)))
        })
        .collect()
}

/// What is refused as out of range is so by more than numbers of far or thin facets are by rounding: finer bounds are those of the product.
const ROUNDING: f64 = 1e-3;

/// Tells what of a table does not fit together or is out of range: (item, message). Lengths are compared only on request.
fn check(
    columns: [(&str, &[f64]); 4],
    sunlit: &Sunlit,
    has_mars: bool,
    is_comparable: bool,
    mut problem: impl FnMut(String, String),
) {
    let [(_, sun), (_, mars), (_, lit_k), (_, shaded_k)] = columns;
    let facets = sun.len();
    if is_comparable && sunlit.lit.len() != facets {
        problem("sun_lit".into(), format!("has {} values, but sun_irradiance has {facets}", sunlit.lit.len()));
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

struct Npz {
    path: PathBuf,
    file_bytes: u64,
    /// Of all arrays so far.
    array_bytes: u64,
    zip: ZipArchive<BufReader<File>>,
}

/// An array as it is in the file.
struct Array {
    descr: String,
    shape: Vec<usize>,
    data: Vec<u8>,
}

impl Array {
    /// The text of a `<U` array without axes.
    fn text(&self) -> Option<String> {
        let is_text = self.descr.starts_with("<U") && self.shape.is_empty();
        let chars = self.data.chunks_exact(4).map(|c| char::from_u32(u32::from_le_bytes([c[0], c[1], c[2], c[3]])));
        is_text.then(|| chars.collect::<Option<String>>()).flatten().map(|s| s.trim_end_matches('\0').to_owned())
    }
}

impl Npz {
    fn open(path: &Path) -> Result<Self> {
        let io = |e| Error::io(path, "reading", e);
        let file = input::open(path).map_err(io)?;
        let file_bytes = file.metadata().map_err(io)?.len();
        let zip = ZipArchive::new(BufReader::with_capacity(1 << 16, file)).map_err(|e| match e {
            zip::result::ZipError::Io(e) if e.kind() != std::io::ErrorKind::UnexpectedEof => io(e),
            e => Error::syntax(Location::file(path), format!("not a complete .npz file: {e}")),
        })?;
        Ok(Npz { path: path.to_owned(), file_bytes, array_bytes: 0, zip })
    }

    fn at(&self, name: &str) -> Location {
        Location::file(&self.path).with_item(name)
    }

    fn header(&mut self, format: &str) -> Result<Header> {
        let Some(array) = self.array("header")? else {
            return Err(Error::invalid(self.at("header"), format!("is missing: this is no {format}")));
        };
        let header: Header = array
            .text()
            .ok_or_else(|| "not a text".to_owned())
            .and_then(|text| serde_json::from_str(&text).map_err(|e| e.to_string()))
            .map_err(|e| Error::syntax(self.at("header"), e))?;
        if header.format != format {
            return Err(Error::invalid(self.at("header"), format!("says {:?}; expected {format:?}", header.format)));
        }
        if header.format_version != FORMAT_VERSION {
            let feature = format!("format version {} of {format}", header.format_version);
            return Err(Error::Unsupported { at: self.at("header"), feature });
        }
        Ok(header)
    }

    /// The bytes of an array; `None` if there is none of this name. Never holds more than the file can; nor do all arrays together,
    /// which could be the same bytes over and over.
    fn bytes_of(&mut self, name: &str) -> Result<Option<Vec<u8>>> {
        let at = self.at(name);
        let damaged = |message: String| Error::syntax(at.clone(), message);
        let compressed = || Error::Unsupported { at: at.clone(), feature: COMPRESSED.to_owned() };
        let mut member = match self.zip.by_name(&format!("{name}.npy")) {
            Ok(member) => member,
            Err(zip::result::ZipError::FileNotFound) => return Ok(None),
            Err(zip::result::ZipError::UnsupportedArchive(_)) => return Err(compressed()),
            Err(e) => return Err(damaged(e.to_string())),
        };
        let most = match member.compression() {
            CompressionMethod::Stored => self.file_bytes,
            CompressionMethod::Deflated => self.file_bytes.saturating_mul(MOST_DEFLATED),
            _ => return Err(compressed()),
        };
        self.array_bytes = self.array_bytes.saturating_add(member.size());
        if self.array_bytes > most {
            let (size, all, file) = (member.size(), self.array_bytes, self.file_bytes);
            return Err(damaged(format!(
                "claims {size} bytes, and with the arrays before it {all}, in a file of {file}"
            )));
        }
        let mut bytes = Vec::new();
        bytes
            .try_reserve_exact(usize::try_from(member.size()).unwrap_or(usize::MAX))
            .map_err(|e| Error::io(&self.path, "reading", e.into()))?;
        // One more than promised: the checksum is compared at the end.
        let size = member.size();
        (&mut member).take(size.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| damaged(e.to_string()))?;
        if bytes.len() as u64 != size {
            return Err(damaged(format!("{} bytes where {size} are promised", bytes.len())));
        }
        Ok(Some(bytes))
    }

    /// An array; `None` if there is none of this name.
    fn array(&mut self, name: &str) -> Result<Option<Array>> {
        let at = self.at(name);
        let damaged = |message: String| Error::syntax(at.clone(), message);
        let Some(mut bytes) = self.bytes_of(name)? else { return Ok(None) };
        let Preamble { descr, shape, fortran_order, start } = preamble(&bytes).map_err(&damaged)?;
        if fortran_order && shape.len() > 1 {
            return Err(damaged("is in Fortran order; save it with np.ascontiguousarray".into()));
        }
        let width: Option<usize> = match descr.split_at_checked(2) {
            Some(("<U", length)) => length.parse::<usize>().ok().and_then(|n| n.checked_mul(4)),
            Some((_, width)) => width.parse().ok(),
            None => None,
        };
        let wanted = shape.iter().try_fold(width.unwrap_or(usize::MAX), |product, n| product.checked_mul(*n));
        if width.is_none() || wanted != Some(bytes.len() - start) {
            let message = format!("{} bytes of data do not make an array {shape:?} of {descr:?}", bytes.len() - start);
            return Err(damaged(message));
        }
        bytes.drain(..start);
        Ok(Some(Array { descr, shape, data: bytes }))
    }

    /// The data of an array of a type with `columns` values a row (1: a plain list); empty, and a problem if it is
    /// needed, when it is not there or of another type.
    fn data(
        &mut self,
        name: &str,
        descr: &str,
        columns: usize,
        needed: bool,
        problems: &mut Vec<Problem>,
    ) -> Result<Vec<u8>> {
        let Some(array) = self.array(name)? else {
            if needed {
                problems.push(Problem::new(self.at(name), "is missing"));
            }
            return Ok(Vec::new());
        };
        let is_shaped = match array.shape[..] {
            [_] => columns == 1,
            [_, n] => columns == n && n > 1,
            _ => false,
        };
        if array.descr != descr || !is_shaped {
            let rows = if columns == 1 { "(n,)".to_owned() } else { format!("(n, {columns})") };
            let message = format!("is {:?} of {:?}, expected {descr:?} of shape {rows}", array.descr, array.shape);
            problems.push(Problem::new(self.at(name), message));
            return Ok(Vec::new());
        }
        Ok(array.data)
    }

    fn f64s(&mut self, name: &str, columns: usize, needed: bool, problems: &mut Vec<Problem>) -> Result<Vec<f64>> {
        let data = self.data(name, "<f8", columns, needed, problems)?;
        Ok(data.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect())
    }

    fn u32s(&mut self, name: &str, problems: &mut Vec<Problem>) -> Result<Vec<u32>> {
        let data = self.data(name, "<u4", 1, true, problems)?;
        Ok(data.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect())
    }

    fn bytes(&mut self, name: &str, problems: &mut Vec<Problem>) -> Result<Vec<u8>> {
        self.data(name, "|u1", 1, true, problems)
    }

    fn direction(&mut self, name: &str, needed: bool, problems: &mut Vec<Problem>) -> Result<Option<Direction>> {
        let values = self.f64s(name, 1, needed, problems)?;
        if values.is_empty() {
            return Ok(None);
        }
        let direction = <[f64; 3]>::try_from(values).ok().and_then(|v| Direction::from_unit(DVec3::from_array(v)));
        if direction.is_none() {
            problems.push(Problem::new(self.at(name), "is not a unit vector of three components"));
        }
        Ok(direction)
    }
}

/// Where an array is in an `.npz` file.
pub(super) struct Member {
    /// Its name, without `.npy`.
    pub(super) name: String,
    /// Where its `.npy` file begins, bytes.
    pub(super) start: u64,
    /// Size of that, bytes.
    pub(super) bytes: u64,
    /// Whether its bytes are not in the file as they are, but compressed: `start` is then 0.
    pub(super) is_packed: bool,
}

/// All arrays of a file.
///
/// # Errors
/// As [`list`], and [`Error::Unsupported`] for compressed ones.
pub(super) fn members(path: &Path) -> Result<Vec<Member>> {
    let mut file = Npz::open(path)?;
    let mut members = Vec::new();
    for i in 0..file.zip.len() {
        let damaged = |message: String| Error::syntax(Location::file(path), message);
        let member = file.zip.by_index_raw(i).map_err(|e| damaged(e.to_string()))?;
        let Some(name) = member.name().ok().and_then(|n| Some(n.strip_suffix(".npy")?.to_owned())) else { continue };
        let at = Location::file(path).with_item(&name);
        match member.compression() {
            CompressionMethod::Stored => {}
            CompressionMethod::Deflated => {
                let bytes = member.size();
                members.push(Member { name, start: 0, bytes, is_packed: true });
                continue;
            }
            _ => return Err(Error::Unsupported { at, feature: COMPRESSED.to_owned() }),
        }
        let (start, bytes) = (member.data_start(), member.size());
        let end = start.and_then(|start| start.checked_add(bytes));
        let (Some(start), Some(_)) = (start, end.filter(|end| *end <= file.file_bytes)) else {
            return Err(Error::syntax(at, format!("claims {bytes} bytes in a file of {}", file.file_bytes)));
        };
        members.push(Member { name, start, bytes, is_packed: false });
    }
    Ok(members)
}

/// The `.npy` file of a compressed array, whole; of others, its first bytes, at most `most`.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] for a damaged one.
pub(super) fn beginning(path: &Path, member: &Member, most: u64) -> Result<Vec<u8>> {
    if member.is_packed {
        return Ok(Npz::open(path)?.bytes_of(&member.name)?.unwrap_or_default());
    }
    let mut bytes = Vec::new();
    let mut read = || {
        let mut file = input::open(path)?;
        file.seek(SeekFrom::Start(member.start))?;
        file.take(member.bytes.min(most)).read_to_end(&mut bytes)
    };
    read().map_err(|e| Error::io(path, "reading", e))?;
    Ok(bytes)
}

/// The text of an array that is one.
///
/// # Errors
/// As [`read_table`].
pub(super) fn text(path: &Path, member: &Member) -> Result<Option<String>> {
    Ok(Npz::open(path)?.array(&member.name)?.and_then(|array| array.text()))
}

/// What a `.npy` file says of its numbers.
pub(super) struct Preamble {
    /// Type, as in `<f8`.
    pub(super) descr: String,
    /// Length of each axis.
    pub(super) shape: Vec<usize>,
    /// Whether the first index runs fastest.
    pub(super) fortran_order: bool,
    /// Where the numbers begin, bytes.
    pub(super) start: usize,
}

/// The preamble of a `.npy` file, of which `bytes` holds at least the beginning.
///
/// # Errors
/// What is wrong with it, as a sentence.
pub(super) fn preamble(bytes: &[u8]) -> std::result::Result<Preamble, String> {
    let short = || "is cut short".to_owned();
    if bytes.get(..6) != Some(b"\x93NUMPY") {
        return Err("is not a NumPy array".into());
    }
    let (length, start) = match bytes.get(6).ok_or_else(short)? {
        1 => (bytes.get(8..10).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]]))), 10),
        _ => (bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize), 12),
    };
    let end = length.and_then(|l| l.checked_add(start)).ok_or_else(short)?;
    let text = bytes.get(start..end).ok_or_else(short)?;
    let text = std::str::from_utf8(text).map_err(|_| "its preamble is not text".to_owned())?;
    let value = |key: &str| text.split_once(&format!("'{key}':")).map(|(_, rest)| rest.trim_start());
    let descr = value("descr").and_then(|v| v.strip_prefix('\'')).and_then(|v| v.split_once('\'')).map(|v| v.0);
    let shape = value("shape").and_then(|v| v.strip_prefix('(')).and_then(|v| v.split_once(')')).map(|v| v.0);
    let shape: Option<Vec<usize>> =
        shape.and_then(|s| s.split(',').map(str::trim).filter(|s| !s.is_empty()).map(|s| s.parse().ok()).collect());
    match (descr, shape, value("fortran_order")) {
        (Some(descr), Some(shape), Some(order)) => {
            Ok(Preamble { descr: descr.to_owned(), shape, fortran_order: order.starts_with("True"), start: end })
        }
        _ => Err(format!("its preamble is not understood: {}", text.trim())),
    }
}
