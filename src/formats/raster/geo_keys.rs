//! Where a GeoTIFF lies.
//!
//! Source: OGC GeoTIFF 1.1 (OGC 19-008r4): tags ModelPixelScale, ModelTiepoint, ModelTransformation, and keys of the GeoKeyDirectory; codes of
//! units are those of EPSG.

use std::path::Path;

use crate::error::Location;
use crate::report::{Fate, Report};

use super::place::{Georeference, Grid, Unit, turned};

/// What a file has for it.
#[derive(Debug, Default)]
pub(super) struct Tags {
    pub(super) scale: Vec<f64>,
    pub(super) tie: Vec<f64>,
    pub(super) matrix: Vec<f64>,
    /// In rows of four.
    pub(super) keys: Vec<u64>,
    /// Those of keys that are no whole numbers.
    pub(super) numbers: Vec<f64>,
}

/// 1 is a map, 2 angles.
const MODEL_TYPE: u64 = 1024;
/// 2 if a place is that of a pixel's centre.
const RASTER_TYPE: u64 = 1025;
/// 9102: degrees.
const ANGLE_UNIT: u64 = 2054;
const LENGTH_UNIT: u64 = 3076;
/// Of a unit that has no code, m.
const LENGTH_UNIT_SIZE: u64 = 3077;

impl Tags {
    fn key(&self, id: u64) -> Option<u64> {
        let rows = self.keys.as_chunks::<4>().0;
        rows.iter().skip(1).find(|row| row[0] == id && row[1] == 0).map(|row| row[3])
    }

    /// A key that stands among the real numbers.
    fn real_key(&self, id: u64) -> Option<f64> {
        let rows = self.keys.as_chunks::<4>().0;
        let row = rows.iter().skip(1).find(|row| row[0] == id && row[1] == 34736)?;
        self.numbers.get(usize::try_from(row[3]).ok()?).copied()
    }

    /// The metres of a unit of length; what it is called if that is not known.
    fn unit_m(&self) -> std::result::Result<f64, String> {
        match self.key(LENGTH_UNIT) {
            None | Some(9001) => Ok(1.0),
            Some(9002) => Ok(0.3048),
            // The foot of the US survey.
            Some(9003) => Ok(1200.0 / 3937.0),
            Some(9036) => Ok(1000.0),
            Some(32767) => self
                .real_key(LENGTH_UNIT_SIZE)
                .filter(|m| *m > 0.0 && m.is_finite())
                .ok_or_else(|| "a unit of its own".into()),
            Some(code) => Err(format!("the unit EPSG {code}")),
        }
    }

    /// Where it lies, and whether lines and pixels are read in the other order for that; none if it does not say.
    pub(super) fn place(
        &self,
        path: &Path,
        size: [usize; 2],
        report: &mut Report,
    ) -> Option<(Georeference, [bool; 2])> {
        let at = || Location::file(path).with_item("ModelPixelScale");
        if self.matrix.len() < 8 && self.scale.get(1).is_some_and(|height| *height < 0.0) {
            let how = "ModelPixelScale has a negative height: by the standard the first line is the southernmost, but GDAL and others take it for the \
                       northernmost, as `gdal_translate IN.tif OUT.tif` writes it";
            return Some(turned(how.into(), at(), report));
        }
        // Pixel (column, row) is at (x0 + a column + b row, y0 + c column + d row).
        let [x0, a, b, y0, c, d] = match (&self.matrix[..], &self.scale[..], &self.tie[..]) {
            (m, ..) if m.len() >= 8 => [m[3], m[0], m[1], m[7], m[4], m[5]],
            (_, [width, height, ..], [column, row, _, x, y, ..]) => {
                [x - column * width, *width, 0.0, y + row * height, 0.0, -height]
            }
            (_, [width, height, ..], _) => [0.0, *width, 0.0, 0.0, 0.0, -height],
            _ => return None,
        };
        let other = |why: String, report: &mut Report| {
            report.note(Fate::Dropped, at(), why.as_str());
            Some((Georeference::Other(why), [false; 2]))
        };
        let unit = match self.key(MODEL_TYPE) {
            Some(2) => match self.key(ANGLE_UNIT) {
                None | Some(9102) => Unit::Degrees,
                Some(code) => return other(format!("pixels in the unit EPSG {code}, not in metres"), report),
            },
            model => {
                if model != Some(1) {
                    report.note(Fate::Defaulted, at(), "its unit is not stated: taken as m");
                }
                match self.unit_m() {
                    Ok(scale) => Unit::Metres(scale),
                    Err(unit) => return other(format!("pixels in {unit}, not in metres"), report),
                }
            }
        };
        let half = if self.key(RASTER_TYPE) == Some(2) { 0.5 } else { 0.0 };
        let corner = [x0 - half * (a + b), y0 - half * (c + d)];
        Some(Grid { corner, along: [a, c], across: [b, d] }.upright(unit, size, (at(), report)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_have_the_size_and_the_place_that_keys_say() {
        let place = |keys: &[u64], numbers: &[f64]| {
            let tags = Tags {
                scale: vec![10.0, 20.0, 0.0],
                tie: vec![1.0, 2.0, 0.0, 500.0, 900.0, 0.0],
                keys: [&[1, 1, 0, 9], keys].concat(),
                numbers: numbers.to_vec(),
                ..Tags::default()
            };
            let mut report = Report::default();
            let (place, mirrored) = tags.place(Path::new("a.tif"), [3, 4], &mut report).unwrap();
            assert_eq!(mirrored, [false; 2]);
            (place, report.notes.len())
        };
        let plane =
            |x, y, along_line_m, line_to_line_m| Georeference::Plane { corner_m: [x, y], along_line_m, line_to_line_m };
        assert_eq!(place(&[1024, 0, 1, 1], &[]), (plane(490.0, 940.0, 10.0, 20.0), 0));
        assert_eq!(place(&[1024, 0, 1, 1, 1025, 0, 1, 2], &[]), (plane(485.0, 950.0, 10.0, 20.0), 0));
        assert_eq!(place(&[1024, 0, 1, 1, 3076, 0, 1, 9036], &[]), (plane(490e3, 940e3, 10e3, 20e3), 0));
        let own = [1024, 0, 1, 1, 3076, 0, 1, 32767, 3077, 34736, 1, 1];
        assert_eq!(place(&own, &[7.0, 2.0]), (plane(980.0, 1880.0, 20.0, 40.0), 0));
        assert_eq!(place(&[], &[]), (plane(490.0, 940.0, 10.0, 20.0), 1));
        let degrees = Georeference::Degrees { corner_deg: [490.0, 940.0], pixel_deg: [10.0, 20.0] };
        assert_eq!(place(&[1024, 0, 1, 2], &[]), (degrees.clone(), 0));
        assert_eq!(place(&[1024, 0, 1, 2, 2054, 0, 1, 9102], &[]), (degrees, 0));
        // A unit of length and one of angles that are not known.
        for keys in [&[1024, 0, 1, 2, 2054, 0, 1, 9105][..], &[1024, 0, 1, 1, 3076, 0, 1, 9999]] {
            let (other, notes) = place(keys, &[]);
            assert!(matches!(other, Georeference::Other(_)) && notes == 1, "{other:?}");
        }
    }

    #[test]
    fn lines_are_put_in_order_unless_they_are_turned() {
        // Three lines of four pixels of 10 m x 20 m over 0 to 40 m and 0 to 60 m, stored in each of the orders.
        let place = |matrix: &[f64], scale: &[f64], is_point: bool| {
            let tags = Tags {
                matrix: matrix.to_vec(),
                scale: scale.to_vec(),
                tie: vec![0.0, 0.0, 0.0, 40.0, 60.0, 0.0],
                keys: [vec![1, 1, 0, 1, 1024, 0, 1, 1], if is_point { vec![1025, 0, 1, 2] } else { vec![] }].concat(),
                ..Tags::default()
            };
            let mut report = Report::default();
            let (place, mirrored) = tags.place(Path::new("a.tif"), [3, 4], &mut report).unwrap();
            assert_eq!(report.notes.is_empty(), mirrored == [false; 2] && !matches!(place, Georeference::Turned(_)));
            (place, mirrored)
        };
        let of = |a: f64, b: f64, x: f64, c: f64, d: f64, y: f64| [a, b, 0.0, x, c, d, 0.0, y];
        let plane = Georeference::Plane { corner_m: [0.0, 60.0], along_line_m: 10.0, line_to_line_m: 20.0 };
        for (matrix, mirrored) in [
            (of(10.0, 0.0, 0.0, 0.0, -20.0, 60.0), [false, false]),
            (of(10.0, 0.0, 0.0, 0.0, 20.0, 0.0), [true, false]),
            (of(-10.0, 0.0, 40.0, 0.0, -20.0, 60.0), [false, true]),
            (of(-10.0, 0.0, 40.0, 0.0, 20.0, 0.0), [true, true]),
            // What is left of a turn and its undoing.
            (of(10.0, 1e-15, 0.0, -1e-15, 20.0, 0.0), [true, false]),
        ] {
            assert_eq!(place(&matrix, &[], false), (plane.clone(), mirrored), "{matrix:?}");
        }
        // Of pixel centres: the first is that of the South-West.
        let matrix = of(10.0, 0.0, 5.0, 0.0, 20.0, 10.0);
        assert_eq!(place(&matrix, &[], true), (plane.clone(), [true, false]));
        assert_eq!(place(&[], &[-10.0, 20.0, 0.0], false), (plane, [false, true]));
        // By 90 deg, by a hundredth of a pixel over the image, and what programs do not agree about.
        for matrix in [of(0.0, 10.0, 0.0, 20.0, 0.0, 0.0), of(10.0, 0.034, 0.0, 0.0, -20.0, 60.0)] {
            assert!(matches!(place(&matrix, &[], false), (Georeference::Turned(_), [false, false])), "{matrix:?}");
        }
        assert!(matches!(place(&[], &[10.0, -20.0, 0.0], false).0, Georeference::Turned(_)));
        for matrix in [
            of(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
            of(10.0, 0.0, f64::NAN, 0.0, -20.0, 0.0),
            of(1.0, 0.0, 0.0, 0.0, f64::INFINITY, 0.0),
        ] {
            assert!(matches!(place(&matrix, &[], false).0, Georeference::Other(_)), "{matrix:?}");
        }
    }
}
