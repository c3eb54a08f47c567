//! Where an image's corners lie on the ground: `georef`, one for all images of a folder, or the image's own `.gr#`.

use std::path::Path;

use glam::DVec2;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::input;

/// Longer files are refused, bytes.
const LIMIT: u64 = 64 << 20;
/// Digits behind the point in `georef`: a corner is known to half of the last, m.
const GEOREF_ROUNDING_M: f64 = 0.5e-6;
/// A `.gr#`: a header, then a record (X, Y, Row, Col, Active) for each corner.
const HEADER: usize = 128;
const RECORD: usize = 28;

/// Outer corners of an image on the ground plane, in DART's x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corners {
    /// First row and column; last row, first column; last row and column; first row, last column, m.
    pub(super) xy_m: [DVec2; 4],
    /// To what each is known, m.
    pub(super) rounding_m: f64,
}

/// The corners of the image whose header is `image`, with this many rows and columns, from the file that has them.
///
/// The image's own file is taken where it is there: it has all digits.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] where neither file has them, or they are not numbers.
pub(super) fn read(image: &Path, number: u32, size: [usize; 2]) -> Result<(Corners, Location)> {
    let own = image.with_extension("gr#");
    let common = image.with_file_name("georef");
    if own.is_file() {
        let bytes = input::bytes(&own, LIMIT)?;
        return Ok((of_table(&bytes, &own, size)?, Location::file(own)));
    }
    if common.is_file() {
        let bytes = input::bytes(&common, LIMIT)?;
        return of_text(&String::from_utf8_lossy(&bytes), &common, number);
    }
    let message = "the image's corners are not known: neither this file nor `georef` is there";
    let help = "copy the whole folder IMAGES_DART of the simulation";
    Err(Error::Invalid(vec![Problem::new(Location::file(own), message).with_help(help)]))
}

fn of_table(bytes: &[u8], path: &Path, [rows, columns]: [usize; 2]) -> Result<Corners> {
    let invalid = |message: String| Error::invalid(Location::file(path), message);
    if !bytes.starts_with(b"ILWIS") || bytes.len() != HEADER + 4 * RECORD {
        let wanted = HEADER + 4 * RECORD;
        return Err(invalid(format!(
            "holds {} bytes where an ILWIS table of four corners has {wanted}: delete the file to take `georef`",
            bytes.len()
        )));
    }
    let mut xy_m = [DVec2::NAN; 4];
    let expected = [(0, [1, 1]), (3, [1, columns]), (1, [rows, 1]), (2, [rows, columns])];
    for (record, (corner, [row, column])) in bytes[HEADER..].as_chunks::<RECORD>().0.iter().zip(expected) {
        let f64_at = |i: usize| f64::from_le_bytes(std::array::from_fn(|k| record[i + k]));
        let i32_at = |i: usize| i32::from_le_bytes(std::array::from_fn(|k| record[i + k]));
        let (r, c) = (i32_at(16), i32_at(20));
        if usize::try_from(r) != Ok(row) || usize::try_from(c) != Ok(column) {
            return Err(invalid(format!(
                "a corner at row {r}, column {c} where row {row}, column {column} belongs: the image has {rows} rows and {columns} columns"
            )));
        }
        xy_m[corner] = DVec2::new(f64_at(0), f64_at(8));
    }
    if xy_m.iter().any(|p| !p.is_finite()) {
        return Err(invalid("holds corners that are not finite numbers".into()));
    }
    Ok(Corners { xy_m, rounding_m: 0.0 })
}

/// Two lines are titles; then an image has two, of which the first begins with its number.
fn of_text(text: &str, path: &Path, number: u32) -> Result<(Corners, Location)> {
    for (i, line) in text.lines().enumerate().skip(2) {
        let mut words = line.split_ascii_whitespace();
        let values: Vec<&str> = words.by_ref().collect();
        let [first, corners @ ..] = values.as_slice() else { continue };
        if corners.len() != 8 || first.parse::<u32>() != Ok(number) {
            continue;
        }
        let at = Location::line(path, i + 1);
        let numbers: Option<Vec<f64>> =
            corners.iter().map(|n| n.parse::<f64>().ok().filter(|n| n.is_finite())).collect();
        let Some(n) = numbers else {
            return Err(Error::invalid(at, "eight finite numbers, X1 Y1 to X4 Y4, belong behind the image's number"));
        };
        let xy_m = std::array::from_fn(|k| DVec2::new(n[2 * k], n[2 * k + 1]));
        return Ok((Corners { xy_m, rounding_m: GEOREF_ROUNDING_M }, at));
    }
    let message = format!("has no line `{number} X1 Y1 X2 Y2 X3 Y3 X4 Y4` for image {number}");
    Err(Error::invalid(Location::file(path), message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(records: &[([f64; 2], [i32; 2])]) -> Vec<u8> {
        let mut bytes = b"ILWIS 2.00 Table\r\n\x1a".to_vec();
        bytes.resize(HEADER, 0);
        for ([x, y], [row, column]) in records {
            bytes.extend([x.to_le_bytes(), y.to_le_bytes()].concat());
            bytes.extend([row.to_le_bytes(), column.to_le_bytes(), 2i32.to_le_bytes()].concat());
        }
        bytes
    }

    #[test]
    fn corners_of_a_table_go_by_row_and_column() {
        let path = Path::new("a.gr#");
        let four = [([0.0, 0.0], [1, 1]), ([0.0, 3.0], [1, 3]), ([2.0, 0.0], [2, 1]), ([2.0, 3.0], [2, 3])];
        let wanted = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]].map(DVec2::from_array);
        assert_eq!(of_table(&table(&four), path, [2, 3]).unwrap().xy_m, wanted);
        // One row: the first two records are of its upper edge.
        let one = [([0.0, 0.0], [1, 1]), ([0.0, 3.0], [1, 3]), ([2.0, 0.0], [1, 1]), ([2.0, 3.0], [1, 3])];
        assert_eq!(of_table(&table(&one), path, [1, 3]).unwrap().xy_m, wanted);
        let error = of_table(&table(&four), path, [3, 2]).unwrap_err().to_string();
        assert!(error.contains("a corner at row 1, column 3 where row 1, column 2 belongs"), "{error}");
        assert!(of_table(&table(&four[..3]), path, [2, 3]).unwrap_err().to_string().contains("holds 212 bytes where"));
        let mut nan = four;
        nan[2].0[1] = f64::NAN;
        assert!(of_table(&table(&nan), path, [2, 3]).is_err());
    }

    #[test]
    fn corners_of_a_text_go_by_number() {
        let text =
            "Ima X1 Y1\n (same)\n1 0 0 1 0 1 2 0 2\n  0 0 1 0 1 2 0 2\n3 5 6 7 8 9 10 11 12\n 5 6 7 8 9 10 11 12\n";
        let (corners, at) = of_text(text, Path::new("georef"), 3).unwrap();
        assert_eq!(corners.xy_m[3], DVec2::new(11.0, 12.0));
        assert_eq!(at.to_string(), "georef:5");
        assert!(of_text(text, Path::new("georef"), 2).unwrap_err().to_string().contains("georef: has no line `2 X1"));
        let bad = text.replace("5 6 7", "5 x 7");
        assert!(of_text(&bad, Path::new("georef"), 3).unwrap_err().to_string().contains("georef:5: eight finite"));
    }
}
