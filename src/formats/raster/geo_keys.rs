//! Where a GeoTIFF lies.
//!
//! Source: OGC GeoTIFF 1.1 (OGC 19-008r4): tags ModelPixelScale, ModelTiepoint, ModelTransformation, and keys of the GeoKeyDirectory; codes of
//! units are those of EPSG.

use std::path::Path;

use crate::error::{Location, number};
use crate::report::{Fate, Report};

use super::place::{Georeference, in_degrees};

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

    /// Where it lies; none if it does not say.
    pub(super) fn place(&self, path: &Path, report: &mut Report) -> Option<Georeference> {
        let at = || Location::file(path).with_item("ModelPixelScale");
        // Pixel (column, row) is at (x0 + a column + b row, y0 + c column + d row).
        let [x0, a, b, y0, c, d] = match (&self.matrix[..], &self.scale[..], &self.tie[..]) {
            (m, ..) if m.len() >= 8 => [m[3], m[0], m[1], m[7], m[4], m[5]],
            (_, [width, height, ..], [column, row, _, x, y, ..]) => {
                [x - column * width, *width, 0.0, y + row * height, 0.0, -height]
            }
            (_, [width, height, ..], _) => [0.0, *width, 0.0, 0.0, 0.0, -height],
            _ => return None,
        };
        if ![x0, a, b, y0, c, d].iter().all(|n| n.is_finite()) {
            return Some(Georeference::Other("places that are no numbers".into()));
        }
        if b != 0.0 || c != 0.0 || !(a > 0.0 && d < 0.0) {
            let message =
                format!("lines that are turned or mirrored: {} {} {} {}", number(a), number(b), number(c), number(d));
            return Some(Georeference::Other(message));
        }
        match self.key(MODEL_TYPE) {
            Some(1) => {}
            Some(2) => {
                let message = format!("pixels are of {} x {} deg, not of metres", number(a), number(-d));
                report.note(Fate::Dropped, at(), message);
                return Some(in_degrees([a, -d]));
            }
            _ => report.note(Fate::Defaulted, at(), "its unit is not stated: taken as m"),
        }
        let scale = match self.unit_m() {
            Ok(scale) => scale,
            Err(unit) => {
                report.note(Fate::Dropped, at(), format!("in {unit}, not in metres"));
                return Some(Georeference::Other(format!("pixels in {unit}, not in metres")));
            }
        };
        let half = if self.key(RASTER_TYPE) == Some(2) { 0.5 } else { 0.0 };
        Some(Georeference::Plane {
            corner_m: [scale * (x0 - half * a), scale * (y0 - half * d)],
            along_line_m: scale * a,
            line_to_line_m: scale * -d,
        })
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
            (tags.place(Path::new("a.tif"), &mut report).unwrap(), report.notes.len())
        };
        let plane =
            |x, y, along_line_m, line_to_line_m| Georeference::Plane { corner_m: [x, y], along_line_m, line_to_line_m };
        assert_eq!(place(&[1024, 0, 1, 1], &[]), (plane(490.0, 940.0, 10.0, 20.0), 0));
        assert_eq!(place(&[1024, 0, 1, 1, 1025, 0, 1, 2], &[]), (plane(485.0, 950.0, 10.0, 20.0), 0));
        assert_eq!(place(&[1024, 0, 1, 1, 3076, 0, 1, 9036], &[]), (plane(490e3, 940e3, 10e3, 20e3), 0));
        let own = [1024, 0, 1, 1, 3076, 0, 1, 32767, 3077, 34736, 1, 1];
        assert_eq!(place(&own, &[7.0, 2.0]), (plane(980.0, 1880.0, 20.0, 40.0), 0));
        assert_eq!(place(&[], &[]), (plane(490.0, 940.0, 10.0, 20.0), 1));
        for keys in [&[1024, 0, 1, 2][..], &[1024, 0, 1, 1, 3076, 0, 1, 9999]] {
            let (other, notes) = place(keys, &[]);
            assert!(matches!(other, Georeference::Other(_)) && notes == 1, "{other:?}");
        }
    }
}
