//! The texture of a landscape, as a picture of 16 bit.

use std::io::{self, Write};

use crate::geometry::whole;
use crate::landscape::Grain;

/// A factor of 2, the largest, is written as this.
const FULL: f64 = 65535.0;

/// Writes factors from 0 to 2 as grey of 16 bit, linear, north up.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut impl Write, grain: &Grain) -> io::Result<()> {
    let side = u32::try_from(grain.texels).map_err(|_| io::Error::from(io::ErrorKind::FileTooLarge))?;
    let mut encoder = png::Encoder::new(out, side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    #[expect(clippy::cast_possible_truncation, reason = "factors are from 0 to 2")]
    let bytes: Vec<u8> =
        grain.factors.iter().flat_map(|f| (whole((0.5 * f * FULL).round()) as u16).to_be_bytes()).collect();
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer.write_image_data(&bytes).map_err(io::Error::other)?;
    writer.finish().map_err(io::Error::other)
}
