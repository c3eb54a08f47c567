//! Cubes and backplanes are written: their numbers, and their headers.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::write_header::{HeaderBand, HeaderText, plain};
use super::{Interleave, Precision};
use crate::error::{Error, Location, Result};
use crate::formats::flat::{AxisOrder, Flat, FlatFile};
use crate::formats::number::single;
use crate::formats::quicklook;
use crate::geometry::whole;
use crate::product::{Backplanes, Cube, CubeAxes, Filling, Plane, Slab};
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

impl Sample for u16 {
    const BYTES: usize = 2;
    fn store(value: f64, at: &mut [u8]) {
        at.copy_from_slice(&u16::try_from(whole(value)).unwrap_or(u16::MAX).to_le_bytes());
    }
}

impl Sample for u32 {
    const BYTES: usize = 4;
    fn store(value: f64, at: &mut [u8]) {
        at.copy_from_slice(&u32::try_from(whole(value)).unwrap_or(u32::MAX).to_le_bytes());
    }
}

/// Pixels expanded by one task. Not a power of two, so that 16 bands of a block do not share cache sets.
const BLOCK: usize = 4112;
/// Bands of a band-sequential file that are expanded at a time: what [`Slab::expand`] computes at once,
/// less if that were more memory than this.
const PASS_BANDS: usize = 16;
const PASS_BYTES: usize = 64 << 20;
/// Lines expanded at a time in the other interleaves.
const PASS_LINES: usize = 16;

/// A radiance cube that is written slab by slab, in any order: the numbers, at the end the header beside them (`.hdr`).
///
/// Slabs are expanded on the way to the disk, and none is kept; the bytes depend neither on their order nor on the number of threads.
/// Of [`Interleave::Bip`] slabs should have all bands: else each pixel of each slab is a write of its own.
#[derive(Debug)]
pub struct EnviCube {
    path: PathBuf,
    file: FlatFile,
    axes: CubeAxes,
    interleave: Interleave,
    precision: Precision,
    description: String,
    filling: Filling,
}

impl EnviCube {
    /// Begins a file.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn create(
        path: &Path,
        axes: CubeAxes,
        interleave: Interleave,
        precision: Precision,
        description: &str,
    ) -> Result<Self> {
        let size = [axes.lines, axes.samples, axes.bands.len()];
        let flat = Flat::new(size, precision.data_type(), AxisOrder::from(interleave));
        let file = FlatFile::create(path, flat, &[]).map_err(|e| Error::io(path, "writing", e))?;
        let filling = Filling::new(&axes);
        Ok(EnviCube { path: path.into(), file, axes, interleave, precision, description: description.into(), filling })
    }

    /// Writes a slab.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written, [`Error::Interrupted`] if `watch` asks to stop, and those of [`Filling::admits`].
    pub fn put(&mut self, slab: &Slab, watch: Watch<'_>) -> Result<()> {
        self.filling.admits(slab)?;
        let so_far = SoFar::new(&self.filling, watch);
        match self.precision {
            Precision::F32 => self.stream::<f32>(slab, &so_far)?,
            Precision::F64 => self.stream::<f64>(slab, &so_far)?,
            Precision::U16 => self.stream::<u16>(slab, &so_far)?,
            Precision::U32 => self.stream::<u32>(slab, &so_far)?,
        }
        self.filling.add(slab);
        Ok(())
    }

    /// Expands a slab into the file, pass by pass, in one buffer.
    fn stream<S: Sample>(&mut self, slab: &Slab, so_far: &SoFar) -> Result<()> {
        let EnviCube { path, file, axes, interleave, .. } = self;
        let samples = axes.samples;
        let writing = |e| Error::io(path.as_path(), "writing", e);
        if *interleave != Interleave::Bsq {
            let mut put =
                |lines: Range<usize>, bytes: &[u8]| file.bytes(lines, slab.bands.clone(), bytes).map_err(writing);
            return stream_lines::<S>(slab, samples, *interleave == Interleave::Bil, &mut put, so_far);
        }
        let (bands, pixels) = (slab.bands.len(), samples * slab.lines.len());
        let step = (PASS_BYTES / (pixels * S::BYTES).max(1)).clamp(1, PASS_BANDS);
        let mut buffer = vec![0; pixels * step.min(bands) * S::BYTES];
        for first in (0..bands).step_by(step) {
            so_far.tell(first * slab.lines.len())?;
            let pass = first..(first + step).min(bands);
            // Block after block, each [band, pixel].
            let pass_bytes = &mut buffer[..pixels * pass.len() * S::BYTES];
            let block_bytes = BLOCK * pass.len() * S::BYTES;
            pass_bytes.par_chunks_mut(block_bytes).enumerate().for_each(|(i, bytes)| {
                tile::<S>(slab, i * BLOCK..((i + 1) * BLOCK).min(pixels), pass.clone(), true, bytes);
            });
            for (i, band) in pass.clone().enumerate() {
                for (block, bytes) in pass_bytes.chunks(block_bytes).enumerate() {
                    let run = bytes.len() / pass.len();
                    let pixel = slab.lines.start * samples + block * BLOCK;
                    file.pixels(slab.bands.start + band, pixel, &bytes[i * run..][..run]).map_err(writing)?;
                }
            }
        }
        Ok(())
    }

    /// Ends the file, and writes its header.
    ///
    /// # Errors
    /// [`Error::Invalid`] if slabs have not filled it; [`Error::Io`].
    pub fn end(self) -> Result<()> {
        self.filling.end()?;
        let CubeAxes { samples, lines, bands, quantity } = &self.axes;
        let size = [*samples, *lines, bands.len()];
        let mut text = HeaderText::of_image(Some(&self.description), size, self.precision.data_type(), self.interleave);
        text.field("data units", quantity.unit());
        text.bands(bands.iter().map(|of| HeaderBand {
            name: &of.name,
            centre_um: Some(of.centre_um),
            fwhm_um: of.fwhm_um,
            is_bad: false,
        }));
        if bands.len() >= 3 {
            text.list("default bands", quicklook::colour_bands(bands).map(|b| (b + 1).to_string()).into_iter());
        }
        text.write(&self.path.with_extension("hdr"))
    }
}

/// Writes all slabs of a cube with [`EnviCube`].
///
/// # Errors
/// Those of [`EnviCube::create`] and [`EnviCube::put`].
pub fn write_cube(
    path: &Path,
    cube: &Cube,
    interleave: Interleave,
    precision: Precision,
    description: &str,
    watch: Watch<'_>,
) -> Result<()> {
    let mut file = EnviCube::create(path, cube.axes.clone(), interleave, precision, description)?;
    cube.slabs().iter().try_for_each(|slab| file.put(slab, watch))?;
    file.end()
}

/// How far a cube is while a slab is written.
pub(in crate::formats) struct SoFar<'w> {
    filled: usize,
    all: usize,
    watch: Watch<'w>,
}

impl<'w> SoFar<'w> {
    /// Before a slab is taken.
    pub(in crate::formats) fn new(filling: &Filling, watch: Watch<'w>) -> Self {
        SoFar { filled: filling.filled(), all: filling.all(), watch }
    }

    /// Reports that this many lines of the slab are written, those of each band counted by themselves.
    fn tell(&self, lines: usize) -> Result<()> {
        tell(self.watch, "writing the cube", (self.filled + lines) as u64, self.all as u64)
    }
}

/// Hands out the lines of a slab, by their place in the cube, each [band, sample] or [sample, band], several at a time.
fn stream_lines<S: Sample>(
    slab: &Slab,
    samples: usize,
    band_major: bool,
    put: &mut impl FnMut(Range<usize>, &[u8]) -> Result<()>,
    so_far: &SoFar,
) -> Result<()> {
    let (lines, bands) = (slab.lines.len(), slab.bands.len());
    let line_bytes = samples * bands * S::BYTES;
    let mut buffer = vec![0; line_bytes * PASS_LINES.min(lines)];
    for first in (0..lines).step_by(PASS_LINES) {
        so_far.tell(first * bands)?;
        let pass = first..lines.min(first + PASS_LINES);
        let pass_bytes = &mut buffer[..line_bytes * pass.len()];
        pass_bytes.par_chunks_mut(line_bytes.max(1)).enumerate().for_each(|(i, bytes)| {
            let pixel = (first + i) * samples;
            tile::<S>(slab, pixel..pixel + samples, 0..bands, band_major, bytes);
        });
        put(slab.lines.start + pass.start..slab.lines.start + pass.end, pass_bytes)?;
    }
    Ok(())
}

/// Hands out the lines of a slab as f32, each [band, sample], several at a time.
pub(in crate::formats) fn stream_lines_f32(
    slab: &Slab,
    samples: usize,
    put: &mut impl FnMut(Range<usize>, &[u8]) -> Result<()>,
    so_far: &SoFar,
) -> Result<()> {
    stream_lines::<f32>(slab, samples, true, put, so_far)
}

/// The bytes of some pixels of a slab in some of its bands: [band, pixel] or [pixel, band].
fn tile<S: Sample>(slab: &Slab, pixels: Range<usize>, bands: Range<usize>, band_major: bool, bytes: &mut [u8]) {
    let (pixel_step, band_step) = if band_major { (1, pixels.len()) } else { (bands.len(), 1) };
    slab.expand(pixels.clone(), bands.clone(), |pixel, band, values| {
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
    let all = planes.planes.iter().map(Cow::Borrowed);
    write_planes(path, [planes.samples, planes.lines], all, precision, description)
}

/// The same of planes that come one after the other.
///
/// # Errors
/// As [`write_backplanes`].
pub fn write_planes<'p>(
    path: &Path,
    size: [usize; 2],
    planes: impl ExactSizeIterator<Item = Cow<'p, Plane>>,
    precision: Precision,
    description: &str,
) -> Result<()> {
    write_placed(path, size, planes.map(|plane| (plane, None)), precision, (description, None))
}

/// Where a map lies, as its header says.
#[derive(Debug, Clone)]
pub struct MapPlace {
    /// What ENVI calls `map info`.
    pub map_info: String,
    /// The coordinate system in well-known text, of the kind of ESRI.
    pub coordinate_system: String,
}

/// The same of a map, in which the planes may be bands of a spectrum: centre and full width at half maximum of each that is one, um.
///
/// # Errors
/// As [`write_backplanes`].
pub fn write_map<'p>(
    path: &Path,
    size: [usize; 2],
    planes: impl ExactSizeIterator<Item = (Cow<'p, Plane>, Option<[Option<f64>; 2]>)>,
    precision: Precision,
    (description, place): (&str, &MapPlace),
) -> Result<()> {
    write_placed(path, size, planes, precision, (description, Some(place)))
}

fn write_placed<'p>(
    path: &Path,
    [samples, lines]: [usize; 2],
    planes: impl ExactSizeIterator<Item = (Cow<'p, Plane>, Option<[Option<f64>; 2]>)>,
    precision: Precision,
    (description, place): (&str, Option<&MapPlace>),
) -> Result<()> {
    let writing = |e| Error::io(path, "writing", e);
    let bands = planes.len();
    let flat = Flat::new([lines, samples, bands], precision.data_type(), AxisOrder::BandRowColumn);
    let mut file = FlatFile::create(path, flat, &[]).map_err(writing)?;
    let mut of_planes = Vec::new();
    for (band, (plane, spectral)) in planes.enumerate() {
        if plane.values.len() != samples * lines {
            let message = format!("{} values for an image of {samples} x {lines}", plane.values.len());
            return Err(Error::invalid(Location::item(format!("backplane {}", plane.name)), message));
        }
        file.tile(0..lines, band..band + 1, &plane.values).map_err(writing)?;
        let name = match plane.unit.as_str() {
            "" | "1" => plain(&plane.name),
            unit => plain(&format!("{} ({unit})", plane.name)),
        };
        of_planes.push((name, spectral.unwrap_or_default()));
    }
    let size = [samples, lines, bands];
    let mut text = HeaderText::of_image(Some(description), size, precision.data_type(), Interleave::Bsq);
    text.field("data ignore value", "nan");
    if let Some(MapPlace { map_info, coordinate_system }) = place {
        text.field("map info", format_args!("{{{map_info}}}"));
        text.field("coordinate system string", format_args!("{{{coordinate_system}}}"));
    }
    // ENVI has one unit for a file; ours differ, so that a plane's name carries its own.
    text.bands(of_planes.iter().map(|(name, [centre_um, fwhm_um])| HeaderBand {
        name,
        centre_um: *centre_um,
        fwhm_um: *fwhm_um,
        is_bad: false,
    }));
    // Of planes the first is shown, and of a map its first band.
    let first = of_planes.iter().position(|(_, [centre_um, _])| centre_um.is_some()).unwrap_or(0);
    if !of_planes.is_empty() {
        text.field("default bands", format_args!("{{{}}}", first + 1));
    }
    text.write(&path.with_extension("hdr"))
}
