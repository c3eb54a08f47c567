//! ILWIS 2 raster maps of numbers: a header `.mpr` in the manner of INI files, and its values `.mp#` next to it.
//!
//! Values are little-endian, line after line, without a header of their own. DART writes and reads `Type=Real`, f64 as they
//! stand; integers, which others write, are values by `Range=least:largest:step:offset=o`: (number + o) step.
//! Headers are not believed where they contradict themselves or the values; `MinMax` never is.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};

use super::input::{self, InputFile, Problems};
use super::number::DataType;

/// No header is longer, bytes.
const HEADER: u64 = 1 << 20;
/// No map has more values.
const VALUES: u64 = 1 << 28;

/// A raster map.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Lines.
    pub rows: usize,
    /// Values in a line.
    pub columns: usize,
    /// Extent from line to line and along a line, m, if the header bounds the map.
    pub pixel_m: Option<[f64; 2]>,
    /// Values, line after line, unchanged: DART marks undefined ones by -1 or NaN.
    pub values: Vec<f64>,
}

/// Finds the two files of a map by the path of either.
fn pair(path: &Path) -> Result<(PathBuf, PathBuf)> {
    let header_path = path.with_extension("mpr");
    let values_path = path.with_extension("mp#");
    let missing = |path: &Path, other, why: &str| {
        let message = format!("has no {other} beside it: without a file of the same name that ends in {why}");
        Err(Error::invalid(Location::file(path), message))
    };
    match (header_path.exists(), values_path.exists()) {
        (false, true) => missing(&values_path, "header", "`.mpr`, rows and columns are not known"),
        (true, false) => missing(&header_path, "values", "`.mp#` there are none"),
        _ => Ok((header_path, values_path)),
    }
}

/// Reads the header of a map by the path of either of its files: header, and the paths of header and values.
///
/// # Errors
/// As [`read`], except for the values.
pub fn open(path: &Path) -> Result<(Header, PathBuf, PathBuf)> {
    let (header_path, values_path) = pair(path)?;
    let (text, _) = input::text(&header_path, HEADER)?;
    Ok((parse_header(&text, &header_path)?, header_path, values_path))
}

/// Reads a map's header, and checks that the file of values has the right size, without reading it.
///
/// # Errors
/// As [`read`].
pub fn read_header(path: &Path) -> Result<Header> {
    let (header, _, values_path) = open(path)?;
    let length = std::fs::metadata(&values_path).map_err(|e| Error::io(&values_path, "reading", e))?.len();
    header.fits(length, &values_path)?;
    Ok(header)
}

/// Reads a map of reals by the path of its header or of its values. The header is read first, then the values that lie beside it.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all that is wrong in the header, or where header and values do not agree in
/// size; [`Error::Unsupported`] for other kinds of maps.
pub fn read(path: &Path) -> Result<(Raster, Vec<InputFile>)> {
    let (header_path, values_path) = pair(path)?;
    let (text, of_header) = input::text(&header_path, HEADER)?;
    let header = parse_header(&text, &header_path)?;
    // The length is checked before that many bytes are read.
    let length = std::fs::metadata(&values_path).map_err(|e| Error::io(&values_path, "reading", e))?.len();
    header.fits(length, &values_path).or_else(|e| if length <= HEADER { Ok(()) } else { Err(e) })?;
    let bytes = input::bytes(&values_path, length)?;
    let of_values = InputFile::of(&values_path, &bytes);
    Ok((header.raster(&bytes, &values_path)?, vec![of_header, of_values]))
}

/// No data in images of DART.
pub const NO_DATA: f64 = -1.0;

/// The no-data value in images that DART writes, which their headers do not state: -1, where it occurs and no value is less.
/// Terrains, which are called `DEM`, have heights of -1.
///
/// # Errors
/// [`Error::Io`].
pub fn no_data_of_dart(values_path: &Path) -> Result<Option<f64>> {
    let stem = values_path.file_stem().unwrap_or_default().to_string_lossy().to_uppercase();
    if stem.starts_with("DEM") {
        return Ok(None);
    }
    let reading = |e| Error::io(values_path, "reading", e);
    let mut file = input::open(values_path).map_err(reading)?;
    let (mut chunk, mut is_there) = (Vec::new(), false);
    loop {
        chunk.clear();
        (&mut file).take(1 << 20).read_to_end(&mut chunk).map_err(reading)?;
        if chunk.is_empty() {
            return Ok(is_there.then_some(NO_DATA));
        }
        for value in chunk.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)) {
            if value < NO_DATA {
                return Ok(None);
            }
            is_there |= value == NO_DATA;
        }
    }
}

/// What a header says of the values.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    rows: usize,
    columns: usize,
    pixel_m: Option<[f64; 2]>,
    bounds: Option<[f64; 4]>,
    store: Storage,
    /// Where the header states the type.
    type_at: Location,
    path: PathBuf,
}

/// How a map's values are stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Storage {
    /// Type of the numbers.
    pub data_type: DataType,
    /// The number that means "undefined".
    pub undefined: Option<f64>,
    /// Step and offset: value = (number + offset) step; `None` if the numbers are the values.
    pub scale: Option<[f64; 2]>,
}

/// ILWIS' names of types, and the number of each that is undefined in a map of values.
const TYPES: [(&str, DataType, f64); 5] = [
    ("Byte", DataType::U8, 0.0),
    ("Int", DataType::I16, -32767.0),
    ("Long", DataType::I32, -2147483647.0),
    ("Float", DataType::F32, -1e38),
    ("Real", DataType::F64, -1e308),
];

impl Header {
    /// Lines, and values in a line.
    pub fn size(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Extent from line to line and along a line, m, if the header bounds the map.
    pub fn pixel_m(&self) -> Option<[f64; 2]> {
        self.pixel_m
    }

    /// How its values are stored.
    pub fn store(&self) -> Storage {
        self.store
    }

    fn values(&self) -> u64 {
        self.rows as u64 * self.columns as u64
    }

    /// Checks that the values take this many bytes.
    fn fits(&self, length: u64, path: &Path) -> Result<()> {
        let wanted = self.values() * 8;
        if length == wanted {
            return Ok(());
        }
        let message = format!(
            "holds {length} bytes where {wanted} ({} rows x {} columns x 8 bytes) belong: {} says Size={0} {1}",
            self.rows,
            self.columns,
            self.path.display(),
        );
        Err(Error::invalid(Location::file(path), message))
    }

    /// The map, from the bytes of its values. `path` is for messages.
    ///
    /// # Errors
    /// [`Error::Invalid`] if their number is not that of the header.
    pub fn raster(&self, bytes: &[u8], path: &Path) -> Result<Raster> {
        if bytes.starts_with(b"DRTDB") {
            let feature = "a terrain in the format of newer versions of DART (it begins with DRTDB)".into();
            return Err(Error::Unsupported { at: Location::file(path), feature });
        }
        if self.store.data_type != DataType::F64 {
            let name = TYPES.iter().find(|t| t.1 == self.store.data_type).map_or("?", |t| t.0);
            let feature = format!("a map of type {name} (DART's are Real: f64)");
            return Err(Error::Unsupported { at: self.type_at.clone(), feature });
        }
        self.fits(bytes.len() as u64, path)?;
        let values = bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        Ok(Raster { rows: self.rows, columns: self.columns, pixel_m: self.pixel_m, values })
    }
}

/// Where a map lies.
#[derive(Debug, Clone, PartialEq)]
pub struct MapExtent {
    /// The header's box: first and second coordinate of one corner, then of the other.
    bounds: [f64; 4],
    /// x and y of the outer corners, m: first row and column, first row and last column, last row and first column, last of both.
    corners_m: [[f64; 2]; 4],
}

impl MapExtent {
    /// A map from the origin on: x runs from row to row, y along a row, as in DART. `pixel_m` is the size of a pixel, m.
    pub fn of_pixels(pixel_m: [f64; 2], rows: usize, columns: usize) -> Self {
        let (x, y) = (rows as f64 * pixel_m[0], columns as f64 * pixel_m[1]);
        MapExtent { bounds: [0.0, -y, x, 0.0], corners_m: [[0.0, 0.0], [0.0, y], [x, 0.0], [x, y]] }
    }

    /// Size of a pixel of so many rows and columns, m: along a row, and from row to row.
    pub fn pixel_m(&self, rows: usize, columns: usize) -> Option<[f64; 2]> {
        let [first, along, across, _] = self.corners_m;
        let side = |to: [f64; 2], count: usize| (to[0] - first[0]).hypot(to[1] - first[1]) / count as f64;
        let size = [side(along, columns), side(across, rows)];
        size.iter().all(|m| *m > 0.0 && m.is_finite()).then_some(size)
    }
}

/// Head of a table of ILWIS, and of its records: x, y, row, column, and whether it counts.
const TABLE: &[u8] = b"ILWIS 2.00 Table\r\n\x1a";
const TABLE_HEAD: usize = 128;
const RECORD: usize = 28;
const ACTIVE: i32 = 2;

/// Where a map lies: its corners from the table `.gr#` beside its values, if there is one, and else from the header's box;
/// `None` if that says nothing either.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] for a damaged table.
pub fn place(header: &Header, values_path: &Path) -> Result<Option<MapExtent>> {
    let mut place = MapExtent::of_pixels(header.pixel_m.unwrap_or([1.0; 2]), header.rows, header.columns);
    if let Some(bounds) = header.bounds {
        place.bounds = bounds;
    }
    let path = values_path.with_extension("gr#");
    if !path.exists() {
        return Ok(header.bounds.map(|_| place));
    }
    let bytes = input::bytes(&path, HEADER)?;
    let records = bytes.get(TABLE_HEAD..).filter(|rest| bytes.starts_with(TABLE) && rest.len() % RECORD == 0);
    let Some(records) = records else {
        return Err(Error::syntax(Location::file(&path), "not a table of control points of ILWIS 2"));
    };
    let int = |record: &[u8], at: usize| record[at..].first_chunk().map_or(0, |b| i64::from(i32::from_le_bytes(*b)));
    let real = |record: &[u8], at: usize| record[at..].first_chunk().map_or(f64::NAN, |b| f64::from_le_bytes(*b));
    let (rows, columns) = (header.rows as i64, header.columns as i64);
    for record in records.chunks_exact(RECORD) {
        let corner = [(1, 1), (1, columns), (rows, 1), (rows, columns)];
        let row_column = (int(record, 16), int(record, 20));
        // Of a map of one row or column the ends coincide: records come in this order.
        for (i, _) in corner.iter().enumerate().filter(|(_, c)| **c == row_column) {
            place.corners_m[i] = [real(record, 0), real(record, 8)];
        }
    }
    Ok(Some(place))
}

/// The table `.gr#` of a map's corners.
pub fn corner_table(rows: usize, columns: usize, place: &MapExtent) -> Vec<u8> {
    let mut bytes = TABLE.to_vec();
    bytes.resize(TABLE_HEAD, 0);
    // A map of more lines would be of 2^31 numbers at least.
    let int = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
    for (i, [x, y]) in place.corners_m.iter().enumerate() {
        let (row, column) = (if i < 2 { 1 } else { int(rows) }, if i % 2 == 0 { 1 } else { int(columns) });
        [x, y].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        [row, column, ACTIVE].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    }
    bytes
}

/// The header `.mpr` of a real map, as DART writes it; `extremes` are the least and the largest value.
pub fn header_text(name: &str, rows: usize, columns: usize, place: &MapExtent, extremes: [f64; 2]) -> String {
    let [a, b, c, d] = place.bounds.map(plain);
    let [least, largest] = extremes.map(|v| if v.is_finite() { six_digits(v) } else { "0".into() });
    format!(
        "[Ilwis]\nDescription=Raster Map {name}\nTime=0\nType=BaseMap\n\n[BaseMap]\nCoordSystem=unknown.csy\n\
         CoordBounds={a} {b} {c} {d}\nDomain=value.dom\nDomainInfo=value.dom;Long;value;0;-9999999.9:9999999.9:0.1:offset=0;\n\
         Range=-1e+300:1e+300:0.000000:offset=0\nType=Map\nMinMax={least}:{largest}\n\n[Map]\nGeoRef={name}.grf\n\
         Size={rows} {columns}\nType=MapStore\n\n[MapStore]\nData={name}.mp#\nType=Real\nStructure=Line\nStartOffset=0\n\
         RowLength={columns}\n"
    )
}

/// The georeference `.grf` of a map, as DART writes it: four control points in the table `.gr#`.
pub fn georeference_text(name: &str, rows: usize, columns: usize) -> String {
    let common = "Time=0\nDataReadOnly=no\nPropertiesReadOnly=no\n";
    let column = |title: &str, domain: &str, range: &str, store: &str| {
        format!(
            "[Col:{title}]\nDescription=\nDomain={domain}\nRange={range}\n{common}Type=ColumnStore\nStored=yes\n\
             NrDepObjects=0\nStoreType={store}\n\n"
        )
    };
    let coordinate = |title| {
        let text = column(title, "value.dom", "-1000000000.000:1000000000.000:0.001", "Real");
        text.replace("Real\n", "Real\nMinMax=0:50\n")
    };
    let [row, mut col] = [("Row", rows), ("Col", columns)]
        .map(|(title, n)| column(title, "value.dom", &format!("-{n}:{}:offset=0", 2 * n), "Int"));
    col = col.replace("Int\n", &format!("Int\nMinMax=1:{columns}\n"));
    let active = column("Active", "bool.dom", "0:1", "Int").replace("Int\n", "Int\nMinMax=1:1\n");
    let (x, y) = (coordinate("X"), coordinate("Y"));
    format!(
        "[Ilwis]\nDescription=\n{common}Type=GeoRef\n\n[Table]\nDomain=None\nColumns=5\nRecords=4\nType=TableStore\n\n\
         [TableStore]\nData={name}.gr#\nCol0=X\nType=TableBinary\nCol1=Y\nCol2=Row\nCol3=Col\nCol4=Active\n\n\
         {x}{y}{row}{col}{active}[GeoRef]\nCoordSystem=unknown.csy\nlines={rows}\ncolumns={columns}\nType=GeoRefCTP\n\n\
         [GeoRefCTP]\nTransformation=Affine\nReference Map={name}.mpr\n"
    )
}

/// A number in decimals; minus nothing is nothing.
fn plain(x: f64) -> String {
    (x + 0.0).to_string()
}

/// A number as C's `%g` writes it.
fn six_digits(x: f64) -> String {
    let scientific = format!("{x:.5e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if (-4..6).contains(&exponent) {
        trimmed(&format!("{x:.*}", (5 - exponent) as usize))
    } else {
        let sign = if exponent < 0 { '-' } else { '+' };
        format!("{}e{sign}{:02}", trimmed(digits), exponent.abs())
    }
}

/// Reads the text of a header. `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse_header(text: &str, path: &Path) -> Result<Header> {
    let mut problems = Problems::default();
    let mut section = "";
    let (mut size, mut bounds, mut row_length) = (None, None, None);
    let (_, mut data_type, mut undefined) = TYPES[4];
    let (mut domain, mut step_offset) = ("value.dom".to_owned(), [1.0, 0.0]);
    let mut type_at = Location::file(path);
    let mut is_map = false;
    let mut start = 0;
    for raw in text.split_inclusive('\n') {
        let line = raw.trim();
        let here = || Location::span(path, text, start, start + raw.trim_end().len());
        if let Some(name) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            section = name;
            is_map |= name == "MapStore";
        }
        let (key, value) = line.split_once('=').unwrap_or((line, ""));
        let unsupported = |feature: String| Error::Unsupported { at: here().with_item(key), feature };
        let expected = |what: &str| {
            Problem::new(here().with_item(key), format!("`{value}` where {what} belongs: as in `{key}=..`"))
        };
        match (section, key) {
            ("Map", "Size") => match numbers::<usize, 2>(value).filter(|n| n.iter().all(|n| *n > 0)) {
                Some([rows, columns]) if (rows as u64).saturating_mul(columns as u64) <= VALUES => {
                    size = Some((rows, columns));
                }
                Some(_) => problems.push(|| expected(&format!("a size of at most {VALUES} values"))),
                None => problems.push(|| expected("a number of rows and a number of columns")),
            },
            ("BaseMap", "CoordBounds") if value.starts_with("undef") => {}
            ("BaseMap", "CoordBounds") => match numbers::<f64, 4>(value) {
                Some(n) if n.iter().all(|n| n.is_finite()) && n[0] != n[2] && n[1] != n[3] => bounds = Some(n),
                _ => problems.push(|| expected("a box of four numbers")),
            },
            ("BaseMap", "Domain") => domain = value.to_lowercase(),
            ("BaseMap", "Range") => match range(value) {
                Some(found) => step_offset = found,
                None => problems.push(|| expected("least:largest:step:offset=number")),
            },
            ("MapStore", "Type") => match TYPES.iter().find(|t| t.0 == value) {
                Some(found) => {
                    (_, data_type, undefined) = *found;
                    type_at = here().with_item(key);
                }
                None => return Err(unsupported(format!("a map of type {value}"))),
            },
            ("MapStore", "Structure") if value != "Line" => return Err(unsupported(format!("the structure {value}"))),
            ("MapStore", "StartOffset") if value != "0" => {
                return Err(unsupported(format!("values that begin at byte {value}")));
            }
            ("MapStore", "RowLength") => match value.parse::<usize>() {
                Ok(n) => row_length = Some((n, start..start + raw.trim_end().len())),
                Err(_) => problems.push(|| expected("a number of columns")),
            },
            _ => {}
        }
        start += raw.len();
    }
    if !is_map {
        let message = "has no section [MapStore]: it is not the header of a raster map";
        problems.push(|| Problem::new(Location::file(path), message));
    } else if size.is_none() && problems.is_empty() {
        problems.push(|| Problem::new(Location::file(path), "says no `Size=` (rows columns) in its section [Map]"));
    }
    if let (Some((length, at)), Some((_, columns))) = (row_length, size)
        && length != columns
    {
        let message = format!("rows of {length} values, but `Size=` says {columns} columns");
        problems.push(|| Problem::new(Location::span(path, text, at.start, at.end).with_item("RowLength"), message));
    }
    problems.finish(path)?;
    match size {
        Some((rows, columns)) => {
            // The second coordinate runs along lines, the first from line to line.
            let pixel_m =
                bounds.map(|[x0, y0, x1, y1]| [(x1 - x0).abs() / rows as f64, (y1 - y0).abs() / columns as f64]);
            let store = match (data_type.is_integer(), domain.as_str()) {
                (false, _) => Storage { data_type, undefined: Some(undefined), scale: None },
                (true, "value.dom") => {
                    let scale = (step_offset != [1.0, 0.0]).then_some(step_offset);
                    Storage { data_type, undefined: Some(undefined), scale }
                }
                (true, "image.dom") => Storage { data_type, undefined: None, scale: None },
                _ => {
                    let at = Location::file(path).with_item("Domain");
                    let feature = format!("a map of the domain {domain}, whose numbers are not values,");
                    return Err(Error::Unsupported { at, feature });
                }
            };
            Ok(Header { rows, columns, pixel_m, bounds, store, type_at, path: path.to_owned() })
        }
        None => Err(Error::invalid(Location::file(path), "says no `Size=`")),
    }
}

/// Step and offset of a range: `least:largest:step:offset=number`, or without a step.
fn range(text: &str) -> Option<[f64; 2]> {
    let (bounds, offset) = text.split_once(":offset=").unwrap_or((text, "0"));
    let bounds: Option<Vec<f64>> = bounds.split(':').map(|n| n.trim().parse().ok()).collect();
    let (step, offset): (f64, f64) = match bounds?[..] {
        [_, _] => (1.0, offset.trim().parse().ok()?),
        [_, _, step] => (step, offset.trim().parse().ok()?),
        _ => return None,
    };
    // A step of 0: reals, which have none.
    (step.is_finite() && offset.is_finite()).then_some([if step == 0.0 { 1.0 } else { step }, offset])
}

/// `N` numbers with blanks between them.
fn numbers<T: std::str::FromStr + Copy + Default, const N: usize>(text: &str) -> Option<[T; N]> {
    let mut numbers = [T::default(); N];
    let mut words = text.split_ascii_whitespace();
    for number in &mut numbers {
        *number = words.next()?.parse().ok()?;
    }
    words.next().is_none().then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "[Ilwis]\r\nType=BaseMap\r\n\r\n[BaseMap]\r\nCoordBounds=0 -6 4 0\r\nType=Map\r\n[Map]\r\nSize=2 3\r\n\
                        [MapStore]\r\nType=Real\r\nStructure=Line\r\nStartOffset=0\r\nRowLength=3\r\n";

    #[test]
    fn rows_come_first() {
        let header = parse_header(GOOD, Path::new("a.mpr")).unwrap();
        let bytes: Vec<u8> = (0..6).flat_map(|i| f64::from(i).to_le_bytes()).collect();
        let raster = header.raster(&bytes, Path::new("a.mp#")).unwrap();
        assert_eq!((raster.rows, raster.columns, raster.pixel_m), (2, 3, Some([2.0, 2.0])));
        assert_eq!(raster.values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let short = header.raster(&bytes[..47], Path::new("a.mp#")).unwrap_err().to_string();
        assert!(short.contains("a.mp#: holds 47 bytes where 48 (2 rows x 3 columns x 8 bytes)"), "{short}");
        assert!(matches!(header.raster(b"DRTDB123", Path::new("a")), Err(Error::Unsupported { .. })));
        let header = parse_header(&GOOD.replace("Type=Real", "Type=Byte"), Path::new("a.mpr")).unwrap();
        assert!(matches!(header.raster(&bytes[..6], Path::new("a.mp#")), Err(Error::Unsupported { .. })));
    }

    #[test]
    fn six_digits_are_those_of_c() {
        // printf("%g").
        for (x, text) in [
            (1.206012999, "1.20601"),
            (0.010077103, "0.0100771"),
            (-1.0, "-1"),
            (0.0, "0"),
            (100000.0, "100000"),
            (999999.5, "1e+06"),
            (0.0001, "0.0001"),
            (0.00001234, "1.234e-05"),
            (1e300, "1e+300"),
        ] {
            assert_eq!(six_digits(x), text);
        }
    }

    #[test]
    fn a_header_that_cannot_be_is_refused_at_its_line() {
        for (from, to, message) in [
            ("Size=2 3", "Size=2", "a.mpr:8:1 Size: `2` where a number of rows"),
            ("Size=2 3", "Size=0 3", "a.mpr:8:1 Size"),
            ("Size=2 3", "Size=99999999 99999999", "at most"),
            ("Size=2 3\r\n", "", "no `Size=`"),
            ("RowLength=3", "RowLength=2", "a.mpr:13:1 RowLength: rows of 2 values, but `Size=` says 3"),
            ("Type=Real", "Type=Bit", "a map of type Bit"),
            ("0 -6 4 0", "0 -6 4", "a.mpr:5:1 CoordBounds: `0 -6 4` where a box"),
            ("[MapStore]", "[Store]", "no section [MapStore]"),
        ] {
            let error = parse_header(&GOOD.replace(from, to), Path::new("a.mpr")).unwrap_err().to_string();
            assert!(error.contains(message), "{to}: {error}");
        }
    }
}
