//! Quick looks: PNG pictures of one band, and of three bands as colours.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;

use crate::error::{Error, Location, Result};
use crate::product::Cube;
use crate::spectral::Band;

/// Black and white are these shares of the covered pixels.
const STRETCH: (f64, f64) = (0.005, 0.995);

/// The band that a grey picture shows: the middle one.
pub fn grey_band(bands: &[Band]) -> usize {
    bands.len() / 2
}

/// The bands shown as red, green and blue: those nearest to 0.65, 0.55 and 0.45 um if the bands reach that far into
/// the visible, else those nearest to 5/6, 1/2 and 1/6 of their range: longer waves are redder.
pub fn colour_bands(bands: &[Band]) -> [usize; 3] {
    let centres = || bands.iter().map(|b| b.centre_um);
    let (first, last) = (centres().fold(f64::INFINITY, f64::min), centres().fold(f64::NEG_INFINITY, f64::max));
    let wanted = if first <= 0.46 && last >= 0.64 {
        [0.65, 0.55, 0.45]
    } else {
        [5.0, 3.0, 1.0].map(|sixths| first + (last - first) * sixths / 6.0)
    };
    wanted.map(|um| {
        let distance = |band: &usize| (bands[*band].centre_um - um).abs();
        (0..bands.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    })
}

/// Writes one band as a grey PNG of 8 bits, stretched linearly between the 0.5th and the 99.5th percentile of the
/// covered pixels. `coverage`: share of each pixel that sees the surface; pixels without any are black.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written; [`Error::Invalid`] for an image without pixels.
pub fn write_grey(path: &Path, cube: &Cube, band: usize, coverage: &[f64]) -> Result<()> {
    write(path, cube, png::ColorType::Grayscale, &stretched(&cube.band(band), coverage))
}

/// Writes three bands as a colour PNG, each stretched by itself as [`write_grey`] does: colours show differences, not colour.
///
/// # Errors
/// As [`write_grey`].
pub fn write_colour(path: &Path, cube: &Cube, bands: [usize; 3], coverage: &[f64]) -> Result<()> {
    let [red, green, blue] = bands.map(|band| stretched(&cube.band(band), coverage));
    let pixels: Vec<u8> = (0..red.len()).flat_map(|i| [red[i], green[i], blue[i]]).collect();
    write(path, cube, png::ColorType::Rgb, &pixels)
}

/// Width and height of a PNG, pixels, and whether it has colours.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] if it is no PNG.
pub fn read_info(path: &Path) -> Result<(u32, u32, bool)> {
    let file = File::open(path).map_err(|e| Error::io(path, "reading", e))?;
    let reader = png::Decoder::new(BufReader::new(file)).read_info();
    let reader = reader.map_err(|e| Error::syntax(Location::file(path), format!("not a PNG: {e}")))?;
    let info = reader.info();
    Ok((info.width, info.height, info.color_type != png::ColorType::Grayscale))
}

fn stretched(radiance: &[f64], coverage: &[f64]) -> Vec<u8> {
    let is_covered = |i: usize| coverage.get(i).is_some_and(|c| *c > 0.0);
    let mut covered: Vec<f64> = (0..radiance.len()).filter(|i| is_covered(*i)).map(|i| radiance[i]).collect();
    covered.sort_unstable_by(f64::total_cmp);
    let rank = |share: f64| covered.get((share * (covered.len() as f64 - 1.0)).round().max(0.0) as usize).copied();
    let (Some(black), Some(white)) = (rank(STRETCH.0), rank(STRETCH.1)) else {
        return vec![0; radiance.len()];
    };
    let grey = |value: f64| match white - black {
        range if range > 0.0 => ((value - black) / range * 255.0).round().clamp(0.0, 255.0) as u8,
        // One value everywhere: mid-grey if it shines, black if not.
        _ => 128 * u8::from(white > 0.0),
    };
    (0..radiance.len()).map(|i| if is_covered(i) { grey(radiance[i]) } else { 0 }).collect()
}

fn write(path: &Path, cube: &Cube, colour: png::ColorType, pixels: &[u8]) -> Result<()> {
    let failed = |e: png::EncodingError| match e {
        png::EncodingError::IoError(e) => Error::io(path, "writing", e),
        other => Error::invalid(Location::file(path), other.to_string()),
    };
    let (Ok(width), Ok(height)) = (u32::try_from(cube.samples), u32::try_from(cube.lines)) else {
        return Err(Error::invalid(Location::file(path), "the image is too large for PNG"));
    };
    let file = File::create(path).map_err(|e| Error::io(path, "writing", e))?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bands(centres: &[f64]) -> Vec<Band> {
        centres.iter().map(|um| Band { centre_um: *um, fwhm_um: None }).collect()
    }

    #[test]
    fn longer_waves_are_redder() {
        assert_eq!(colour_bands(&bands(&[1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0])), [5, 3, 1]);
        assert_eq!(colour_bands(&bands(&[7.0, 5.9, 4.0, 2.0, 1.0])), [1, 2, 3]);
        assert_eq!(colour_bands(&bands(&[0.4, 0.45, 0.55, 0.65, 1.0])), [3, 2, 1]);
        assert_eq!(colour_bands(&bands(&[2.0])), [0, 0, 0]);
    }

    #[test]
    fn sky_is_black_and_does_not_stretch() {
        // Covered: 10 and 20; the two sky pixels must not become "black = 0".
        assert_eq!(stretched(&[0.0, 10.0, 20.0, 0.0], &[0.0, 1.0, 0.5, 0.0]), [0, 0, 255, 0]);
        assert_eq!(stretched(&[7.0, 7.0, 0.0], &[1.0, 1.0, 0.0]), [128, 128, 0]);
        assert_eq!(stretched(&[0.0, 0.0], &[1.0, 1.0]), [0, 0]);
        assert_eq!(stretched(&[0.0, 0.0], &[0.0, 0.0]), [0, 0]);
    }

    #[test]
    fn the_brightest_half_percent_is_white() {
        let values: Vec<f64> = (0..1001).map(f64::from).collect();
        let grey = stretched(&values, &vec![1.0; 1001]);
        // Percentiles 0.5 and 99.5 of 0..=1000 are 5 and 995: 500 is in the middle.
        assert_eq!((grey[5], grey[6] > 0, grey[995], grey[994] < 255, grey[500]), (0, false, 255, false, 128));
    }
}
