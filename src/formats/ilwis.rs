//! ILWIS 2 raster maps of real numbers: a header `.mpr` in the manner of INI files, and its values `.mp#` beside it.
//!
//! Values are little-endian f64, line after line, without a header of their own. Read is what DART writes and reads:
//! `Type=Real`, one value a cell as it stands. Headers are not believed where they contradict themselves or the values.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};

use super::input::{self, InputFile, Problems};

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
    /// Values, line after line, as they stand: DART marks what is undefined by -1 or NaN.
    pub values: Vec<f64>,
}

/// Reads a map by the path of its header or of its values. The header is read first, then the values that lie beside it.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all that is wrong in the header, or where header and values do not agree in
/// size; [`Error::Unsupported`] for other kinds of maps.
pub fn read(path: &Path) -> Result<(Raster, Vec<InputFile>)> {
    let header_path = path.with_extension("mpr");
    let values_path = path.with_extension("mp#");
    if !header_path.exists() && values_path.exists() {
        let message = "has no header beside it: without a file of the same name that ends in `.mpr`, rows and columns are not known";
        return Err(Error::invalid(Location::file(&values_path), message));
    }
    let (text, of_header) = input::text(&header_path, HEADER)?;
    let header = parse_header(&text, &header_path)?;
    // The length is told before as many bytes are read.
    let length = std::fs::metadata(&values_path).map_err(|e| Error::io(&values_path, "reading", e))?.len();
    header.fits(length, &values_path).or_else(|e| if length <= HEADER { Ok(()) } else { Err(e) })?;
    let bytes = input::bytes(&values_path, length)?;
    let of_values = InputFile::of(&values_path, &bytes);
    Ok((header.raster(&bytes, &values_path)?, vec![of_header, of_values]))
}

/// What a header says of the values.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    rows: usize,
    columns: usize,
    pixel_m: Option<[f64; 2]>,
    path: PathBuf,
}

impl Header {
    fn values(&self) -> u64 {
        self.rows as u64 * self.columns as u64
    }

    /// Whether the values take as many bytes.
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
    /// [`Error::Invalid`] if there are not as many as the header says.
    pub fn raster(&self, bytes: &[u8], path: &Path) -> Result<Raster> {
        if bytes.starts_with(b"DRTDB") {
            let feature = "a terrain in the format of newer versions of DART (it begins with DRTDB)".into();
            return Err(Error::Unsupported { at: Location::file(path), feature });
        }
        self.fits(bytes.len() as u64, path)?;
        let values = bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        Ok(Raster { rows: self.rows, columns: self.columns, pixel_m: self.pixel_m, values })
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
            ("MapStore", "Type") if value != "Real" => {
                return Err(unsupported(format!("a map of type {value} (DART's are Real: f64)")));
            }
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
            Ok(Header { rows, columns, pixel_m, path: path.to_owned() })
        }
        None => Err(Error::invalid(Location::file(path), "says no `Size=`")),
    }
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
    }

    #[test]
    fn a_header_that_cannot_be_is_refused_at_its_line() {
        for (from, to, message) in [
            ("Size=2 3", "Size=2", "a.mpr:8:1 Size: `2` where a number of rows"),
            ("Size=2 3", "Size=0 3", "a.mpr:8:1 Size"),
            ("Size=2 3", "Size=99999999 99999999", "at most"),
            ("Size=2 3\r\n", "", "no `Size=`"),
            ("RowLength=3", "RowLength=2", "a.mpr:13:1 RowLength: rows of 2 values, but `Size=` says 3"),
            ("Type=Real", "Type=Byte", "a map of type Byte"),
            ("0 -6 4 0", "0 -6 4", "a.mpr:5:1 CoordBounds: `0 -6 4` where a box"),
            ("[MapStore]", "[Store]", "no section [MapStore]"),
        ] {
            let error = parse_header(&GOOD.replace(from, to), Path::new("a.mpr")).unwrap_err().to_string();
            assert!(error.contains(message), "{to}: {error}");
        }
    }
}
