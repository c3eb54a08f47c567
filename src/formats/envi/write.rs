//! Cubes and backplanes are written: their numbers, and their headers.

use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;

use super::header_text::{HeaderText, plain};
use super::{Interleave, Precision};
use crate::error::{Error, Location, Result};
use crate::formats::flat::{AxisOrder, Flat, FlatFile};
use crate::formats::number::single;
use crate::formats::quicklook;
use crate::product::{Backplanes, Cube, Plane};
use crate::progress::{Watch, tell};

/// A number as it is written.
trait Sample {
    const BYTES: usize;
    fn store(value: f64, at: &mut [u8]);
}

impl Sample for f32 {
    const BYTES: usize = 4;
    fn store(value: f64, at: &mut [u8]) {
        at.copy_from_slice(&single(value).to_le_bytes());
    }
}

impl Sample for f64 {
    const BYTES: usize = 8;
    fn store(value: f64, at: &mut [u8]) {
        at.copy_from_slice(&value.to_le_bytes());
    }
}

/// Pixels expanded by one task. Not a power of two, so that 16 bands of a block do not share cache sets.
const BLOCK: usize = 4112;
/// Bands of a band-sequential file that are expanded at a time: what [`Cube::expand`] computes at once,
/// less if that were more memory than this.
const PASS_BANDS: usize = 16;
const PASS_BYTES: usize = 64 << 20;
/// Lines expanded at a time in the other interleaves.
const PASS_LINES: usize = 16;

/// Writes a radiance cube: the numbers to `path`, the header beside it (`.hdr`).
///
/// The cube is expanded on the way to the disk and never held in memory; the bytes do not depend on the number of threads.
///
/// # Errors
/// [`Error::Io`] if a file cannot be written, [`Error::Interrupted`] if `watch` asks to stop.
pub fn write_cube(
    path: &Path,
    cube: &Cube,
    interleave: Interleave,
    precision: Precision,
    description: &str,
    watch: Watch<'_>,
) -> Result<()> {
    let size = [cube.lines, cube.samples, cube.bands.len()];
    let flat = Flat::new(size, precision.data_type(), AxisOrder::from(interleave));
    let file = FlatFile::create(path, flat, &[]).map_err(|e| Error::io(path, "writing", e))?;
    match precision {
        Precision::F32 => stream::<f32>(path, file, cube, interleave, watch)?,
        Precision::F64 => stream::<f64>(path, file, cube, interleave, watch)?,
    }
    let size = [cube.samples, cube.lines, cube.bands.len()];
    let mut text = HeaderText::of_image(Some(description), size, precision.data_type(), interleave);
    text.field("data units", "W m-2 sr-1 um-1");
    text.bands(cube.bands.iter().map(|band| (Some(band.centre_um), band.fwhm_um, band.name.as_str())));
    if cube.bands.len() >= 3 {
        text.list("default bands", quicklook::colour_bands(&cube.bands).map(|b| (b + 1).to_string()).into_iter());
    }
    text.write(&path.with_extension("hdr"))
}

/// Expands a cube into a file, pass by pass, in one buffer.
fn stream<S: Sample>(
    path: &Path,
    mut file: FlatFile,
    cube: &Cube,
    interleave: Interleave,
    watch: Watch<'_>,
) -> Result<()> {
    let writing = |e| Error::io(path, "writing", e);
    let bands = cube.bands.len();
    if interleave != Interleave::Bsq {
        let mut put = |lines: Range<usize>, bytes: &[u8]| file.bytes(lines, 0..bands, bytes).map_err(writing);
        return stream_lines::<S>(cube, interleave == Interleave::Bil, &mut put, watch);
    }
    let pixels = cube.samples * cube.lines;
    let step = (PASS_BYTES / (pixels * S::BYTES).max(1)).clamp(1, PASS_BANDS);
    let mut buffer = vec![0; pixels * step.min(bands) * S::BYTES];
    for first in (0..bands).step_by(step) {
        tell(watch, "writing the cube", first as u64, bands as u64)?;
        let pass = first..(first + step).min(bands);
        // Block after block, each [band, pixel].
        let pass_bytes = &mut buffer[..pixels * pass.len() * S::BYTES];
        let block_bytes = BLOCK * pass.len() * S::BYTES;
        pass_bytes.par_chunks_mut(block_bytes).enumerate().for_each(|(i, bytes)| {
            tile::<S>(cube, i * BLOCK..((i + 1) * BLOCK).min(pixels), pass.clone(), true, bytes);
        });
        for (i, band) in pass.clone().enumerate() {
            for (block, bytes) in pass_bytes.chunks(block_bytes).enumerate() {
                let run = bytes.len() / pass.len();
                file.pixels(band, block * BLOCK, &bytes[i * run..][..run]).map_err(writing)?;
            }
        }
    }
    Ok(())
}

/// Hands out the lines of a cube, each [band, sample] or [sample, band], several at a time.
fn stream_lines<S: Sample>(
    cube: &Cube,
    band_major: bool,
    put: &mut impl FnMut(Range<usize>, &[u8]) -> Result<()>,
    watch: Watch<'_>,
) -> Result<()> {
    let bands = 0..cube.bands.len();
    let line_bytes = cube.samples * bands.len() * S::BYTES;
    let mut buffer = vec![0; line_bytes * PASS_LINES.min(cube.lines)];
    for first in (0..cube.lines).step_by(PASS_LINES) {
        tell(watch, "writing the cube", first as u64, cube.lines as u64)?;
        let lines = first..cube.lines.min(first + PASS_LINES);
        let pass_bytes = &mut buffer[..line_bytes * lines.len()];
        pass_bytes.par_chunks_mut(line_bytes.max(1)).enumerate().for_each(|(i, bytes)| {
            let pixel = (first + i) * cube.samples;
            tile::<S>(cube, pixel..pixel + cube.samples, bands.clone(), band_major, bytes);
        });
        put(lines, pass_bytes)?;
    }
    Ok(())
}

/// Hands out the lines of a cube as f32, each [band, sample], several at a time.
pub(in crate::formats) fn stream_lines_f32(
    cube: &Cube,
    put: &mut impl FnMut(Range<usize>, &[u8]) -> Result<()>,
    watch: Watch<'_>,
) -> Result<()> {
    stream_lines::<f32>(cube, true, put, watch)
}

/// The bytes of some pixels in some bands: [band, pixel] or [pixel, band].
fn tile<S: Sample>(cube: &Cube, pixels: Range<usize>, bands: Range<usize>, band_major: bool, bytes: &mut [u8]) {
    let (pixel_step, band_step) = if band_major { (1, pixels.len()) } else { (bands.len(), 1) };
    cube.expand(pixels.clone(), bands.clone(), |pixel, band, values| {
        let start = (pixel - pixels.start) * pixel_step + (band - bands.start) * band_step;
        for (k, value) in values.iter().enumerate() {
            let at = (start + k * band_step) * S::BYTES;
            S::store(*value, &mut bytes[at..at + S::BYTES]);
        }
    });
}

/// Writes backplanes, band-sequential: the numbers to `path`, the header beside it (`.hdr`). NaN is "no surface".
///
/// # Errors
/// [`Error::Io`] if a file cannot be written; [`Error::Invalid`] for a plane of another size than the image.
pub fn write_backplanes(path: &Path, planes: &Backplanes, precision: Precision, description: &str) -> Result<()> {
    let pixels = planes.samples * planes.lines;
    if let Some(plane) = planes.planes.iter().find(|p| p.values.len() != pixels) {
        let message = format!("{} values for an image of {} x {}", plane.values.len(), planes.samples, planes.lines);
        return Err(Error::invalid(Location::item(format!("backplane {}", plane.name)), message));
    }
    let writing = |e| Error::io(path, "writing", e);
    let (samples, lines, bands) = (planes.samples, planes.lines, planes.planes.len());
    let flat = Flat::new([lines, samples, bands], precision.data_type(), AxisOrder::BandRowColumn);
    let mut file = FlatFile::create(path, flat, &[]).map_err(writing)?;
    for (band, plane) in planes.planes.iter().enumerate() {
        file.tile(0..lines, band..band + 1, &plane.values).map_err(writing)?;
    }
    let size = [samples, lines, bands];
    let mut text = HeaderText::of_image(Some(description), size, precision.data_type(), Interleave::Bsq);
    text.field("data ignore value", "nan");
    // ENVI has one unit for a file; ours differ, so that a plane's name carries its own.
    let name = |p: &Plane| match p.unit.as_str() {
        "" | "1" => plain(&p.name),
        unit => plain(&format!("{} ({unit})", p.name)),
    };
    text.list("band names", planes.planes.iter().map(name));
    text.write(&path.with_extension("hdr"))
}
