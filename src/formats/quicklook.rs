//! Quick looks: PNG pictures of one band, and of three bands as colours.
//!
//! Grey is radiance between a black and a white, linearly where the median is mid-grey or brighter then, else by the power
//! that makes it mid-grey: so that shadows lit only by Mars show next to sunlit ground, and evenly lit ground keeps its
//! contrast. The text `Description` in the file gives the radiances that are black and white, and the power.

use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::Path;

use super::{compass, input};
use crate::error::{Error, Location, Result};
use crate::geometry::whole;
use crate::product::ShownBands;
use crate::spectral::Band;
use crate::study::Orientation;

/// Black and white are the radiances that these shares of the covered pixels are below.
pub(super) const BLACK_WHITE: [f64; 2] = [0.005, 0.995];
/// The least power: below the cube root the 8-bit steps become visible in dark areas.
pub(super) const LEAST_POWER: f64 = 1.0 / 3.0;

/// The band that a grey picture shows: the middle one.
pub fn grey_band(bands: &[Band]) -> usize {
    bands.len() / 2
}

/// Light of longer waves is not seen, um.
const VISIBLE_UM: f64 = 0.78;

/// The bands shown as red, green and blue: those nearest to 0.65, 0.55 and 0.45 um if the bands reach that far into
/// the visible, else those nearest to 5/6, 1/2 and 1/6 of their range: longer waves are redder. If these are not three, the longest, the
/// shortest, and the one nearest to their middle, of the visible ones if they are three, else of all.
pub fn colour_bands(bands: &[Band]) -> [usize; 3] {
    let centres = || bands.iter().map(|b| b.centre_um);
    let (first, last) = (centres().fold(f64::INFINITY, f64::min), centres().fold(f64::NEG_INFINITY, f64::max));
    let wanted = if first <= 0.46 && last >= 0.64 {
        [0.65, 0.55, 0.45]
    } else {
        [5.0, 3.0, 1.0].map(|sixths| first + (last - first) * sixths / 6.0)
    };
    let nearest = |of: &[usize], um: f64| {
        let distance = |band: &usize| (bands[*band].centre_um - um).abs();
        of.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    };
    let mut order: Vec<usize> = (0..bands.len()).collect();
    let [red, green, blue] = wanted.map(|um| nearest(&order, um));
    if bands.len() < 3 || (red != green && green != blue && blue != red) {
        return [red, green, blue];
    }
    order.sort_by(|a, b| bands[*a].centre_um.total_cmp(&bands[*b].centre_um));
    let visible = order.iter().filter(|band| bands[**band].centre_um <= VISIBLE_UM).count();
    let shown = if visible >= 3 { &order[..visible] } else { &order };
    let (blue, red) = (shown[0], shown[shown.len() - 1]);
    let middle_um = 0.5 * (bands[blue].centre_um + bands[red].centre_um);
    [red, nearest(&shown[1..shown.len() - 1], middle_um), blue]
}

/// Writes one band as a grey PNG of 8 bits, from the 0.5th to the 99.5th percentile of the covered pixels.
/// `coverage`: share of each pixel that shows the surface or a body of the sky; pixels without any are black. `compass`: which way arrows point in its corner, if it
/// is large enough.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written; [`Error::Invalid`] for an image without pixels.
pub fn write_grey(
    path: &Path,
    cube: &ShownBands,
    band: usize,
    coverage: &[f64],
    compass: Option<&Orientation>,
) -> Result<()> {
    let (mut pixels, text) = channel(cube, band, coverage);
    let size = [cube.axes.samples, cube.axes.lines];
    compass.into_iter().for_each(|orientation| compass::draw(&mut pixels, size, 1, orientation));
    write(path, size, png::ColorType::Grayscale, &pixels, &text)
}

/// Writes three bands as a colour PNG, each stretched separately: colours show differences, not true colour.
///
/// # Errors
/// As [`write_grey`].
pub fn write_colour(
    path: &Path,
    cube: &ShownBands,
    bands: [usize; 3],
    coverage: &[f64],
    compass: Option<&Orientation>,
) -> Result<()> {
    let red = channel(cube, bands[0], coverage);
    let other = |band: usize| if band == bands[0] { red.clone() } else { channel(cube, band, coverage) };
    let ((green, green_text), (blue, blue_text)) = (other(bands[1]), other(bands[2]));
    let (red, red_text) = &red;
    let mut pixels: Vec<u8> = (0..red.len()).flat_map(|i| [red[i], green[i], blue[i]]).collect();
    let text = format!("red: {red_text}; green: {green_text}; blue: {blue_text}");
    let size = [cube.axes.samples, cube.axes.lines];
    compass.into_iter().for_each(|orientation| compass::draw(&mut pixels, size, 3, orientation));
    write(path, size, png::ColorType::Rgb, &pixels, &text)
}

/// Writes one band as grey, or three as red, green and blue, of any image: [row, column], each stretched separately and called
/// by its label. What is not finite is black. `size` is rows and columns, each of which becomes `times` of the picture.
///
/// # Errors
/// As [`write_grey`]; [`Error::Invalid`] for another number of bands.
pub fn write_bands(path: &Path, size: [usize; 2], times: usize, bands: &[(String, Vec<f64>)]) -> Result<()> {
    let colour = match bands.len() {
        1 => png::ColorType::Grayscale,
        3 => png::ColorType::Rgb,
        n => return Err(Error::invalid(Location::file(path), format!("a picture shows 1 band or 3, not {n}"))),
    };
    let [rows, columns] = size;
    let mut pixels = vec![0; rows * columns * bands.len()];
    let mut texts = Vec::new();
    for (i, (label, values)) in bands.iter().enumerate() {
        let coverage: Vec<f64> = values.iter().map(|v| f64::from(u8::from(v.is_finite()))).collect();
        let (bytes, text) = stretched(values, &coverage, label, "");
        pixels.iter_mut().skip(i).step_by(bands.len()).zip(bytes).for_each(|(pixel, byte)| *pixel = byte);
        texts.push(text);
    }
    let pixels = if times > 1 { enlarged(&pixels, columns * bands.len(), bands.len(), times) } else { pixels };
    write(path, [columns, rows].map(|side| side * times), colour, &pixels, &texts.join("; "))
}

/// Rows of so many bytes with pixels of so many, each pixel as a square of `times` by `times`.
fn enlarged(pixels: &[u8], row: usize, pixel: usize, times: usize) -> Vec<u8> {
    let wide = |row: &[u8]| -> Vec<u8> { row.chunks(pixel).flat_map(|of| of.repeat(times)).collect() };
    pixels.chunks(row.max(1)).flat_map(|row| wide(row).repeat(times)).collect()
}

/// How many times as large an image is drawn whose longer side is this, pixels: a stamp of 16 pixels shows nothing.
pub fn enlargement(side: usize) -> usize {
    /// Up to this side it is enlarged, up to twice that.
    const SMALL: usize = 256;
    if (1..SMALL).contains(&side) { 2 * SMALL / side } else { 1 }
}

/// Width and height of a PNG, pixels, and whether it has colours.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] if it is not a PNG.
pub fn read_info(path: &Path) -> Result<(u32, u32, bool)> {
    let file = input::open(path).map_err(|e| Error::io(path, "reading", e))?;
    let reader = png::Decoder::new(BufReader::new(file)).read_info();
    let reader = reader.map_err(|e| Error::syntax(Location::file(path), format!("not a PNG: {e}")))?;
    let info = reader.info();
    Ok((info.width, info.height, info.color_type != png::ColorType::Grayscale))
}

/// The bytes of a band, and what they mean.
fn channel(cube: &ShownBands, band: usize, coverage: &[f64]) -> (Vec<u8>, String) {
    let um = cube.axes.bands[band].centre_um;
    let unit = format!(" {}", cube.axes.quantity.unit());
    stretched(cube.band(band), coverage, &format!("{um} um"), &unit)
}

fn stretched(values: &[f64], coverage: &[f64], label: &str, unit: &str) -> (Vec<u8>, String) {
    match Stretch::of(values, coverage) {
        Some(stretch) => {
            let Stretch { black, white, power } = stretch;
            let text = format!("{label}, black {black:.4e}, white {white:.4e}{unit}, power {power:.3}");
            (stretch.bytes(values, coverage), text)
        }
        None => (vec![0; values.len()], format!("{label}, nothing in view")),
    }
}

/// How radiance becomes grey.
struct Stretch {
    /// The radiance that is black, W m-2 sr-1 um-1.
    black: f64,
    /// The radiance that is white, W m-2 sr-1 um-1.
    white: f64,
    power: f64,
}

impl Stretch {
    /// `None` if no pixel is covered.
    fn of(radiance: &[f64], coverage: &[f64]) -> Option<Self> {
        let mut covered: Vec<f64> = radiance.iter().zip(coverage).filter(|(_, c)| **c > 0.0).map(|(l, _)| *l).collect();
        let last = covered.len().checked_sub(1)?;
        let [black, median, white] = [BLACK_WHITE[0], 0.5, BLACK_WHITE[1]].map(|share| {
            let place = whole((share * last as f64).round());
            *covered.select_nth_unstable_by(place, f64::total_cmp).1
        });
        let share = (median - black) / (white - black);
        let power = if share < 0.5 { (0.5_f64.ln() / share.ln()).max(LEAST_POWER) } else { 1.0 };
        Some(Stretch { black, white, power })
    }

    #[expect(clippy::cast_possible_truncation, reason = "255 shares of grey, rounded")]
    fn byte(&self, radiance: f64) -> u8 {
        match self.white - self.black {
            range if range > 0.0 => {
                let share = ((radiance - self.black) / range).clamp(0.0, 1.0);
                // A power of 1 is common, and powf is slow.
                let grey = if self.power == 1.0 { share } else { share.powf(self.power) };
                (255.0 * grey + 0.5) as u8
            }
            // One value everywhere: mid-grey if it shines, black if not.
            _ => 128 * u8::from(self.white > 0.0),
        }
    }

    fn bytes(&self, radiance: &[f64], coverage: &[f64]) -> Vec<u8> {
        radiance.iter().zip(coverage).map(|(l, c)| if *c > 0.0 { self.byte(*l) } else { 0 }).collect()
    }
}

fn write(path: &Path, size: [usize; 2], colour: png::ColorType, pixels: &[u8], text: &str) -> Result<()> {
    let file = File::create(path).map_err(|e| Error::io(path, "writing", e))?;
    encode(BufWriter::new(file), size, colour, pixels, text, png::Compression::Fast).map_err(|e| match e {
        png::EncodingError::IoError(e) => Error::io(path, "writing", e),
        other => Error::invalid(Location::file(path), other.to_string()),
    })
}

/// Pixels of 8 bits as a PNG file in memory; empty for an image that PNG cannot hold. `size` is columns and rows.
pub(super) fn png_bytes(size: [usize; 2], colour: png::ColorType, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    match encode(&mut bytes, size, colour, pixels, "", png::Compression::Balanced) {
        Ok(()) => bytes,
        Err(_) => vec![],
    }
}

/// An image as grey, stretched as another one would be: the two can be compared by eye.
pub(super) fn grey_as(values: &[f64], as_of: &[f64], coverage: &[f64]) -> Vec<u8> {
    Stretch::of(as_of, coverage).map_or_else(|| vec![0; values.len()], |stretch| stretch.bytes(values, coverage))
}

fn encode(
    out: impl Write,
    size: [usize; 2],
    colour: png::ColorType,
    pixels: &[u8],
    text: &str,
    compression: png::Compression,
) -> std::result::Result<(), png::EncodingError> {
    let side = |pixels: usize| {
        u32::try_from(pixels).map_err(|_| png::EncodingError::IoError(std::io::ErrorKind::FileTooLarge.into()))
    };
    let mut encoder = png::Encoder::new(out, side(size[0])?, side(size[1])?);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(compression);
    if !text.is_empty() {
        encoder.add_text_chunk("Description".to_owned(), text.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretched(radiance: &[f64], coverage: &[f64]) -> Vec<u8> {
        super::stretched(radiance, coverage, "", "").0
    }

    fn bands(centres: &[f64]) -> Vec<Band> {
        centres.iter().map(|um| Band::new(*um, None)).collect()
    }

    #[test]
    fn small_images_are_enlarged_by_whole_factors() {
        assert_eq!([0, 1, 16, 48, 255, 256, 4000].map(enlargement), [1, 512, 32, 10, 2, 1, 1]);
        // Two pixels of three bytes, and two rows of one pixel.
        assert_eq!(enlarged(&[1, 2, 3, 4, 5, 6], 6, 3, 2), [[1, 2, 3, 1, 2, 3, 4, 5, 6, 4, 5, 6]; 2].concat());
        assert_eq!(enlarged(&[7, 8], 1, 1, 2), [7, 7, 7, 7, 8, 8, 8, 8]);
    }

    #[test]
    fn longer_waves_are_redder() {
        assert_eq!(colour_bands(&bands(&[1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0])), [5, 3, 1]);
        assert_eq!(colour_bands(&bands(&[7.0, 5.9, 4.0, 2.0, 1.0])), [1, 2, 3]);
        assert_eq!(colour_bands(&bands(&[0.4, 0.45, 0.55, 0.65, 1.0])), [3, 2, 1]);
        assert_eq!(colour_bands(&bands(&[2.0])), [0, 0, 0]);
        // Three of them are three colours, whatever their centres.
        assert_eq!(colour_bands(&bands(&[0.48, 0.55, 0.7])), [2, 1, 0]);
        assert_eq!(colour_bands(&bands(&[3.5, 0.7, 0.48, 0.55])), [1, 3, 2]);
        assert_eq!(colour_bands(&bands(&[1.0, 1.0, 10.0])), [2, 1, 0]);
    }

    #[test]
    fn shadows_that_something_lights_show_beside_sunlit_ground() {
        // 2 of 3 pixels at 1 % of the rest: the median, 0.01, would be mid-grey by a power of 0.15. 255 x 0.01^(1/3) = 55.
        let mut radiance = vec![1.0; 600];
        radiance.extend([100.0; 290]);
        radiance[..10].fill(0.0);
        let grey = stretched(&radiance, &vec![1.0; 890]);
        assert_eq!((grey[0], grey[10], grey[889]), (0, 55, 255));
        // A median of a quarter is mid-grey by the square root.
        assert_eq!(stretched(&[0.0, 0.25, 1.0], &[1.0; 3]), [0, 128, 255]);
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
