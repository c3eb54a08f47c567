//! Pictures in a page: images in grey, errors in colours.

use crate::formats::base64::base64;
use crate::formats::quicklook::{grey_as, png_bytes};
use crate::geometry::whole;
use crate::study::chart::Ground;

/// Errors from the darkest to the lightest colour, as powers of ten.
pub(super) const POWERS: [i32; 2] = [-6, 0];

/// Colours of errors, from small to large: dark blue, violet, red, orange, pale yellow (after "inferno" of matplotlib).
const COLOURS: [[f64; 3]; 7] = [
    [16.0, 12.0, 52.0],
    [60.0, 15.0, 110.0],
    [120.0, 28.0, 109.0],
    [181.0, 50.0, 86.0],
    [229.0, 92.0, 48.0],
    [251.0, 155.0, 6.0],
    [252.0, 240.0, 160.0],
];

/// Where there is no surface.
const SKY: [u8; 3] = [235, 238, 242];

/// An image in grey, stretched like the true one.
pub(super) fn image(size: [usize; 2], values: &[f64], truth: &[f64], ground: &[Ground]) -> String {
    let coverage: Vec<f64> = ground.iter().map(|g| f64::from(u8::from(*g != Ground::Sky))).collect();
    let grey = grey_as(values, truth, &coverage);
    uri(&png_bytes(size, png::ColorType::Grayscale, &grey))
}

/// Errors in colours; exactly 0 is black.
pub(super) fn errors(size: [usize; 2], errors: &[f64]) -> String {
    let pixels: Vec<u8> = errors.iter().flat_map(|error| colour(*error)).collect();
    uri(&png_bytes(size, png::ColorType::Rgb, &pixels))
}

pub(super) fn colour(error: f64) -> [u8; 3] {
    if error.is_nan() {
        return SKY;
    }
    if error <= 0.0 {
        return [0; 3];
    }
    let [low, high] = POWERS.map(f64::from);
    let place = ((error.log10() - low) / (high - low)).clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let first = whole(place).min(COLOURS.len() - 2);
    let share = place - first as f64;
    #[expect(clippy::cast_possible_truncation, reason = "shares of 255")]
    [0, 1, 2].map(|k| (COLOURS[first][k] + share * (COLOURS[first + 1][k] - COLOURS[first][k]) + 0.5) as u8)
}

/// A PNG file as an address that holds it.
fn uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(png))
}
