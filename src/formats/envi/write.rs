//! What is written: cubes and backplanes, number after number, and the texts of their headers.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Write;
use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;

use super::{Interleave, Precision};
use crate::error::{Error, Location, Result};
use crate::formats::quicklook;
use crate::product::{Backplanes, Cube, Plane};
use crate::progress::{Watch, tell};
use crate::spectral::Band;

/// A number as it is written.
trait Sample {
    const BYTES: usize;
    fn store(value: f64, at: &mut [u8]);
}

impl Sample for f32 {
    const BYTES: usize = 4;
    fn store(value: f64, at: &mut [u8]) {
        at.copy_from_slice(&(value as f32).to_le_bytes());
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
    let mut file = File::create(path).map_err(|e| Error::io(path, "writing", e))?;
    let mut put = |bytes: &[u8]| file.write_all(bytes).map_err(|e| Error::io(path, "writing", e));
    match precision {
        Precision::F32 => stream::<f32>(cube, interleave, &mut put, watch)?,
        Precision::F64 => stream::<f64>(cube, interleave, &mut put, watch)?,
    }
    let mut text = common_header(description, cube.samples, cube.lines, cube.bands.len(), interleave, precision);
    text.push_str("data units = W m-2 sr-1 um-1\nwavelength units = Micrometers\n");
    list(&mut text, "wavelength", cube.bands.iter().map(|b| b.centre_um.to_string()));
    if cube.bands.iter().any(|b| b.fwhm_um.is_some()) {
        list(&mut text, "fwhm", cube.bands.iter().map(|b| b.fwhm_um.unwrap_or(0.0).to_string()));
    }
    if cube.bands.iter().any(|b| !b.name.is_empty()) {
        let name = |(i, band): (usize, &Band)| match plain(&band.name) {
            name if name.is_empty() => format!("band {}", i + 1),
            name => name,
        };
        list(&mut text, "band names", cube.bands.iter().enumerate().map(name));
    }
    let [red, green, blue] = quicklook::colour_bands(&cube.bands);
    if cube.bands.len() >= 3 {
        list(&mut text, "default bands", [red, green, blue].map(|b| (b + 1).to_string()).into_iter());
    }
    write_header(path, &text)
}

/// Expands a cube into the file's order, pass by pass, in one buffer.
fn stream<S: Sample>(
    cube: &Cube,
    interleave: Interleave,
    put: &mut impl FnMut(&[u8]) -> Result<()>,
    watch: Watch<'_>,
) -> Result<()> {
    if interleave != Interleave::Bsq {
        return stream_lines::<S>(cube, interleave == Interleave::Bil, put, watch);
    }
    let bands = cube.bands.len();
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
        for band in 0..pass.len() {
            for block in pass_bytes.chunks(block_bytes) {
                let run = block.len() / pass.len();
                put(&block[band * run..][..run])?;
            }
        }
    }
    Ok(())
}

/// Hands out the lines of a cube, each [band, sample] or [sample, band], several at a time.
fn stream_lines<S: Sample>(
    cube: &Cube,
    band_major: bool,
    put: &mut impl FnMut(&[u8]) -> Result<()>,
    watch: Watch<'_>,
) -> Result<()> {
    let bands = 0..cube.bands.len();
    let line_bytes = cube.samples * bands.len() * S::BYTES;
    let mut buffer = vec![0; line_bytes * PASS_LINES.min(cube.lines)];
    for first in (0..cube.lines).step_by(PASS_LINES) {
        tell(watch, "writing the cube", first as u64, cube.lines as u64)?;
        let pass_bytes = &mut buffer[..line_bytes * PASS_LINES.min(cube.lines - first)];
        pass_bytes.par_chunks_mut(line_bytes.max(1)).enumerate().for_each(|(i, bytes)| {
            let pixel = (first + i) * cube.samples;
            tile::<S>(cube, pixel..pixel + cube.samples, bands.clone(), band_major, bytes);
        });
        put(pass_bytes)?;
    }
    Ok(())
}

/// Hands out the lines of a cube as f32, each [band, sample], several at a time.
pub(in crate::formats) fn stream_lines_f32(
    cube: &Cube,
    put: &mut impl FnMut(&[u8]) -> Result<()>,
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
    let mut file = File::create(path).map_err(|e| Error::io(path, "writing", e))?;
    for plane in &planes.planes {
        let bytes: Vec<u8> = match precision {
            Precision::F32 => plane.values.iter().flat_map(|v| (*v as f32).to_le_bytes()).collect(),
            Precision::F64 => plane.values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        };
        file.write_all(&bytes).map_err(|e| Error::io(path, "writing", e))?;
    }
    let (samples, lines, bands) = (planes.samples, planes.lines, planes.planes.len());
    let mut text = common_header(description, samples, lines, bands, Interleave::Bsq, precision);
    text.push_str("data ignore value = nan\n");
    // ENVI has one unit for a file; ours differ, so that a plane's name carries its own.
    let name = |p: &Plane| match p.unit.as_str() {
        "" | "1" => plain(&p.name),
        unit => plain(&format!("{} ({unit})", p.name)),
    };
    list(&mut text, "band names", planes.planes.iter().map(name));
    write_header(path, &text)
}

fn common_header(
    description: &str,
    samples: usize,
    lines: usize,
    bands: usize,
    interleave: Interleave,
    precision: Precision,
) -> String {
    let data_type = match precision {
        Precision::F32 => 4,
        Precision::F64 => 5,
    };
    format!(
        "ENVI\ndescription = {{{}}}\nsamples = {samples}\nlines = {lines}\nbands = {bands}\nheader offset = 0\n\
         file type = ENVI Standard\ndata type = {data_type}\ninterleave = {}\nbyte order = 0\n",
        description.replace(['{', '}', '\n'], " "),
        interleave.name()
    )
}

/// A name that the header's lists can hold.
pub(in crate::formats) fn plain(name: &str) -> String {
    name.replace(['{', '}', ',', '\n'], " ")
}

pub(in crate::formats) fn list(text: &mut String, key: &str, values: impl Iterator<Item = String>) {
    let values: Vec<String> = values.collect();
    let rows: Vec<String> = values.chunks(8).map(|row| row.join(", ")).collect();
    let _ = writeln!(text, "{key} = {{\n {}}}", rows.join(",\n "));
}

fn write_header(data: &Path, text: &str) -> Result<()> {
    let path = data.with_extension("hdr");
    std::fs::write(&path, text).map_err(|e| Error::io(&path, "writing", e))
}
