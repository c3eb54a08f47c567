//! Rasters: images of one or many bands in the formats of other programs, read band by band.
//!
//! A band is f64, row by row, whatever the file stores; what the file says is no data is NaN. Of a file that interleaves its
//! bands, as many are read in one pass as 256 MiB hold; no more of any file is in memory.

mod compare;
mod exr;
mod flat;
mod headers;
mod npy;
mod picture;
mod text;
mod write;

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::report::Report;
use crate::spectral::Band;

pub use self::compare::{differences, statistics};
pub(crate) use self::text::{is_grid, open as open_csv};
pub use self::write::{Options, Target, write};
use super::ilwis;
use super::input::{Hashing, InputFile};
pub use super::number::DataType;
use super::quicklook;

use self::flat::{Flat, Order};

/// Bands that one pass through a file gives are kept up to this size, or one band if that is larger.
const PASS_BYTES: usize = 256 << 20;
/// No band has more pixels: as f64 they take 2 GiB.
const MOST_PIXELS: u64 = 1 << 28;
/// No raster has more bands.
const MOST_BANDS: u64 = 1 << 16;
/// As much of a file is looked at to tell what it is, bytes.
const BEGINNING: u64 = 4096;

/// A raster whose bands are read one by one.
#[derive(Debug, Clone)]
pub struct Raster {
    /// The file with its numbers.
    pub path: PathBuf,
    /// Lines.
    pub rows: usize,
    /// Pixels in a line.
    pub columns: usize,
    /// Bands, in the order of the file; of OpenEXR in that of wavelength, if all have one.
    pub bands: Vec<RasterBand>,
    /// Unit of the values, as the file states it.
    pub unit: Option<String>,
    /// The number that stands for "nothing here", as it is stored; NaN stands for it besides.
    pub ignore: Option<f64>,
    /// The least type that holds all values.
    pub data_type: DataType,
    /// What the file does not say and was taken for granted, and what of it is not taken.
    pub report: Report,
    /// How each band's numbers become values; none if they are the values.
    scale: Vec<Scale>,
    /// Where an ILWIS map lies.
    place: Option<ilwis::Place>,
    /// What else an ENVI header says: key and text.
    extra: Vec<(String, String)>,
    /// All files that the raster comes from.
    files: Vec<PathBuf>,
    reader: Reader,
    pass: Pass,
}

/// What a raster says of a band.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RasterBand {
    /// Name; may be empty.
    pub name: String,
    /// Centre wavelength, um.
    pub centre_um: Option<f64>,
    /// Full width at half maximum, um.
    pub fwhm_um: Option<f64>,
}

/// Value = (number x gain + offset) / divisor.
#[derive(Debug, Clone, Copy)]
struct Scale {
    gain: f64,
    offset: f64,
    divisor: f64,
}

/// How bands are read.
#[derive(Debug, Clone)]
enum Reader {
    Flat(Flat),
    Exr(Vec<exr::Channel>),
    Png,
    Held(Vec<f64>),
}

/// Bands that were read in one go.
#[derive(Debug, Clone, Default)]
struct Pass {
    bands: Range<usize>,
    /// [band, row, column].
    values: Vec<f64>,
}

/// Opens a raster, by any of its files. Its format is told by what it holds, and where that does not tell, by its name.
///
/// | format | what is read |
/// |---|---|
/// | ENVI | any interleave, real types and byte order; `data gain values`, `data offset values` and `reflectance scale factor` apply |
/// | ILWIS 2 (`.mpr`, `.mp#`) | maps of values; its undefined values are NaN; DART's -1 stays |
/// | OpenEXR | channels of the first part, and of others of its size; `S0.<wavelength>nm` is a wavelength |
/// | PNG | grey or red, green, blue, 0 to 1 as stored; NaN where transparent |
/// | CSV | numbers alone, a line for each row; `nan`, or nothing between two commas, is no data |
/// | NumPy (`.npy`, `.npz` with one array of numbers or one named `raster`) | \[row, column\] or \[row, column, band\]; of one axis: one row |
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] and [`Error::Invalid`] at all places of a header that cannot be used, for a file that is
/// not as long as its header says, and a partner that is not there; [`Error::Unsupported`] for what is not read.
pub fn open(path: &Path) -> Result<Raster> {
    let reading = |e| Error::io(path, "reading", e);
    let mut beginning = Vec::new();
    File::open(path).and_then(|file| file.take(BEGINNING).read_to_end(&mut beginning)).map_err(reading)?;
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let unsupported = |what: &str| {
        let feature = format!("{what} (`gdal_translate -of ENVI IN OUT.img` makes an image that is read)");
        Err(Error::Unsupported { at: Location::file(path), feature })
    };
    match extension.as_str() {
        _ if beginning.starts_with(&[0x76, 0x2f, 0x31, 0x01]) => exr::open(path),
        _ if beginning.starts_with(b"\x89PNG") => picture::open(path),
        _ if beginning.starts_with(b"\x93NUMPY") => npy::open(path),
        _ if beginning.starts_with(b"PK\x03\x04") => npy::open_npz(path),
        "npy" => npy::open(path),
        "npz" => npy::open_npz(path),
        "mpr" | "mp#" => headers::open_ilwis(path),
        "exr" => exr::open(path),
        "png" => picture::open(path),
        "csv" => text::open(path),
        _ if beginning.starts_with(b"II*\0") || beginning.starts_with(b"MM\0*") => unsupported("TIFF"),
        _ if beginning.starts_with(b"\x89HDF") || beginning.starts_with(b"CDF") => unsupported("HDF or NetCDF"),
        _ => headers::open_envi(path),
    }
}

impl Raster {
    /// The same numbers, a column for each band: of a table with a line for each thing. What has bands already stays as it is.
    #[must_use]
    pub fn columns_as_bands(mut self) -> Self {
        if let Reader::Flat(flat) = &mut self.reader
            && flat.bands == 1
            && self.scale.is_empty()
        {
            flat.order = match flat.order {
                Order::BandColumnRow => Order::BandRowColumn,
                _ => Order::RowColumnBand,
            };
            (flat.bands, flat.columns) = (flat.columns, 1);
            (self.columns, self.bands) = (1, vec![RasterBand::default(); flat.bands]);
        }
        self
    }

    /// A raster of numbers that are values, of which no more is known.
    fn of(
        path: &Path,
        (rows, columns): (usize, usize),
        bands: Vec<RasterBand>,
        data_type: DataType,
        reader: Reader,
    ) -> Self {
        Raster {
            path: path.to_owned(),
            rows,
            columns,
            bands,
            unit: None,
            ignore: None,
            data_type,
            report: Report::default(),
            scale: Vec::new(),
            place: None,
            extra: Vec::new(),
            files: vec![path.to_owned()],
            reader,
            pass: Pass::default(),
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.rows * self.columns
    }

    /// Reads a band, counted from 0: [row, column], row by row, in the file's unit; NaN where there is no data. `values` is
    /// cleared first.
    ///
    /// Ask in ascending order: where a file interleaves its bands, the next ones come with the same pass through it.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] for a band that is not there; what else is wrong with compressed numbers.
    pub fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        values.clear();
        if band >= self.bands.len() {
            let message =
                format!("band {} is asked for, counted from 1: it has {}", band.saturating_add(1), self.bands.len());
            return Err(Error::invalid(Location::file(&self.path), message));
        }
        let pixels = self.pixels();
        let together = if self.reader.is_banded() { 1 } else { PASS_BYTES / (8 * pixels) };
        if together < 2 {
            resize(values, pixels, &self.path)?;
            return self.fill(band..band + 1, values);
        }
        if !self.pass.bands.contains(&band) {
            let bands = band..self.bands.len().min(band + together);
            let mut pass = std::mem::take(&mut self.pass.values);
            self.pass.bands = 0..0;
            resize(&mut pass, bands.len() * pixels, &self.path)?;
            self.fill(bands.clone(), &mut pass)?;
            self.pass = Pass { bands, values: pass };
        }
        resize(values, pixels, &self.path)?;
        values.copy_from_slice(&self.pass.values[(band - self.pass.bands.start) * pixels..][..pixels]);
        Ok(())
    }

    /// Reads bands, [band, row, column].
    fn fill(&self, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
        match &self.reader {
            Reader::Flat(flat) => flat.read(&self.path, bands.clone(), values)?,
            Reader::Exr(channels) => exr::read(&self.path, (self.rows, self.columns), channels, bands.clone(), values)?,
            Reader::Png => picture::read(&self.path, bands.clone(), values)?,
            Reader::Held(held) => values.copy_from_slice(held),
        }
        let ignore = self.ignore.map(|v| self.as_stored(v));
        for (band, values) in bands.zip(values.chunks_exact_mut(self.pixels())) {
            if let Some(ignore) = ignore {
                values.iter_mut().filter(|v| **v == ignore).for_each(|v| *v = f64::NAN);
            }
            if let Some(Scale { gain, offset, divisor }) = self.scale.get(band) {
                values.iter_mut().for_each(|v| *v = (*v * gain + offset) / divisor);
            }
        }
        Ok(())
    }

    /// A number that was written in decimals, as it is among the file's numbers: those may be f32.
    pub fn as_stored(&self, number: f64) -> f64 {
        if self.reader.stores_f32() { f64::from(number as f32) } else { number }
    }

    /// The bands of a picture: three for colours where all wavelengths are known or there are three, else the middle one.
    pub fn colour_bands(&self) -> Vec<usize> {
        let bands: Option<Vec<Band>> =
            self.bands.iter().map(|b| Some(Band { centre_um: b.centre_um?, fwhm_um: None })).collect();
        match bands {
            Some(bands) if bands.len() >= 3 => quicklook::colour_bands(&bands).to_vec(),
            None if self.bands.len() == 3 => vec![0, 1, 2],
            _ => vec![self.bands.len() / 2],
        }
    }

    /// The files that it comes from.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The files that it comes from, for reports. They are read to the end for their hashes.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn inputs(&self) -> Result<Vec<InputFile>> {
        let hashed = |path: &PathBuf| {
            let reading = |e| Error::io(path, "reading", e);
            let mut file = Hashing::new(File::open(path).map_err(reading)?);
            std::io::copy(&mut file, &mut std::io::sink()).map_err(reading)?;
            Ok(file.finish(path))
        };
        self.files.iter().map(hashed).collect()
    }
}

impl Reader {
    /// Whether one band is read without the others.
    fn is_banded(&self) -> bool {
        match self {
            Reader::Flat(flat) => flat.is_banded(),
            Reader::Exr(_) | Reader::Png => false,
            Reader::Held(_) => true,
        }
    }

    fn stores_f32(&self) -> bool {
        matches!(self, Reader::Flat(flat) if flat.data_type == DataType::F32)
    }
}

/// Makes room, or says that there is none.
fn resize(values: &mut Vec<f64>, length: usize, path: &Path) -> Result<()> {
    values.clear();
    values.try_reserve_exact(length).map_err(|e| Error::io(path, "reading", e.into()))?;
    values.resize(length, 0.0);
    Ok(())
}

/// Refuses sizes that cannot be meant, before memory is taken for them.
fn check_size(at: Location, rows: usize, columns: usize, bands: usize) -> Result<()> {
    let pixels = (rows as u64).saturating_mul(columns as u64);
    let message = if pixels > MOST_PIXELS {
        format!("{rows} rows x {columns} columns are more than the {MOST_PIXELS} pixels that are read")
    } else if bands as u64 > MOST_BANDS {
        format!("{bands} bands are more than the {MOST_BANDS} that are read")
    } else if pixels == 0 || bands == 0 {
        format!("{rows} rows x {columns} columns x {bands} bands hold no pixels")
    } else {
        return Ok(());
    };
    Err(Error::invalid(at, message))
}

/// Refuses a file that is not as long as its header says.
fn check_length(path: &Path, flat: &Flat, end: Option<u64>, said_by: &Path) -> Result<()> {
    let there = match end {
        Some(end) => end,
        None => std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len(),
    };
    let wanted = flat.data_bytes().and_then(|n| n.checked_add(flat.start));
    if wanted == Some(there) {
        return Ok(());
    }
    let Flat { rows, columns, bands, data_type, start, .. } = flat;
    let message = format!(
        "has {there} bytes where {start} + {rows} rows x {columns} columns x {bands} bands x {} bytes belong, says {}",
        data_type.bytes(),
        said_by.display()
    );
    let help = match wanted {
        Some(wanted) if wanted < there => "its size, bands or type are others, or the header is another file's",
        _ => "it is cut short, or the header is another file's",
    };
    Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
}
