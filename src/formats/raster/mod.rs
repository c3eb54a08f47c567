//! Rasters: images of one or many bands in the formats of other programs, read band by band.
//!
//! A band is f64, row by row, whatever the file stores; what the file marks as no data is NaN. Of a file that interleaves its
//! bands, as many are read in one pass as fit in 256 MiB; no more of a file is in memory, except for those compressed as a whole:
//! OpenEXR (see `exr.rs`).

mod arrays;
mod blocks;
mod compare;
mod cube_dataset;
pub(super) mod dart_cells;
pub(super) mod esri;
pub(super) mod exr;
pub(super) mod fits;
mod geo_keys;
pub(super) mod headers;
pub(super) mod isis;
pub(super) mod jpeg;
mod layers;
mod lengths;
mod mask;
mod names;
pub(super) mod netcdf;
pub(super) mod npy;
pub(super) mod pds3;
pub(super) mod pds4;
mod pds4_label;
pub(super) mod picture;
mod place;
pub(super) mod pnm;
mod pvl;
mod special;
pub(super) mod text;
pub(super) mod tiff;
mod tiff_packing;
mod write;
pub(super) mod zarr;

use std::io::Cursor;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::{Error, Location, Problem, Result, number};
use crate::formats::number::single;
use crate::report::{Fate, Report};
use crate::spectral::Band;

pub use self::compare::{differences, statistics};
pub(super) use self::cube_dataset::CubeNotes;
pub(super) use self::lengths::metres;
pub(crate) use self::names::{bare_number, colour};
pub(super) use self::pds4_label::write as write_pds4_label;
pub(crate) use self::place::Georeference;
pub(super) use self::write::write_cube;
pub use self::write::{Options, Target, write};
use super::envi::Scale;
use super::ilwis;
use super::input::InputFile;
pub use super::number::DataType;
use super::quicklook;

use self::blocks::Blocks;
use self::exr::Numbers;
use self::layers::{Chosen, Layer};
use self::mask::Alpha;
use self::special::Special;
use self::tiff::Chunks;
use super::flat::{AxisOrder, Flat};

/// Bands that one pass through a file gives are kept up to this size, or one band if that is larger.
const PASS_BYTES: usize = 256 << 20;
/// No band has more pixels: as f64 they take 2 GiB.
const MOST_PIXELS: u64 = 1 << 28;
/// No raster has more bands.
const MOST_BANDS: u64 = 1 << 16;
/// A raster whose bands are read one by one.
#[derive(Debug, Clone)]
pub struct Raster {
    /// The file with its numbers.
    pub path: PathBuf,
    /// Lines.
    pub rows: usize,
    /// Pixels in a line.
    pub columns: usize,
    /// Bands, in the order of the file; of OpenEXR, which sorts channels by name, in the order that their names say: by wavelength,
    /// red, green, blue, or by number, layer after layer, and coverage last.
    pub bands: Vec<RasterBand>,
    /// Width of a pixel over its height, as the file says; 1 if it does not.
    pub pixel_aspect: f64,
    /// Unit of the values, as the file states it.
    pub unit: Option<String>,
    /// The number that stands for "nothing here", as it is stored; NaN stands for it besides.
    pub ignore: Option<f64>,
    /// What the numbers of a picture were divided by, so that values are 0 to 1: times this they are what is stored.
    pub full_scale: Option<f64>,
    /// The least type that holds all values.
    pub data_type: DataType,
    /// What the file does not say and was taken for granted, and what of it is not taken.
    pub report: Report,
    /// How the numbers of each band of the file become values; none if they are the values.
    scale: Vec<Scale>,
    /// The number in the file of each band.
    in_file: Vec<usize>,
    /// What belongs together, where names say it.
    layers: Vec<Layer>,
    /// The band of the file that is coverage.
    alpha: Option<Alpha>,
    /// That coverage, once it is read.
    coverage: Option<Vec<f64>>,
    /// An image of one band that is 0 where there is no data, and which pixels those are once it is read.
    mask: Option<Box<Raster>>,
    hidden: Vec<bool>,
    /// What else means "nothing here".
    no_data: Option<f64>,
    /// What else does, of planetary files: as it is stored.
    special: Special,
    /// Where it lies, as it says itself.
    georeference: Option<Georeference>,
    /// Size of a pixel on the ground, m, where the file says no more than that.
    spacing_m: Option<[f64; 2]>,
    /// Whether the file's first line is at the bottom, and the first pixel of a line on the right.
    mirrored: [bool; 2],
    /// Where an ILWIS map lies.
    place: Option<ilwis::MapExtent>,
    /// What else an ENVI header says: key and text.
    extra: Vec<(String, String)>,
    /// All files that the raster comes from.
    files: Vec<PathBuf>,
    reader: BandReader,
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
    /// Whether the file says that it is not to be used.
    pub is_bad: bool,
}

/// How bands are read.
#[derive(Debug, Clone)]
enum BandReader {
    Flat(Flat),
    /// The same, of a file that was compressed.
    Unpacked(Flat, Arc<[u8]>),
    Exr(exr::Channels),
    Blocks(Blocks),
    Tiff(Chunks),
    /// Each band by itself.
    Flats(Vec<Flat>),
    NetCdf(netcdf::Bands),
    Zarr(zarr::Bands),
    /// Of so many samples: colours, and perhaps coverage behind them.
    Png {
        samples: usize,
    },
    Held(Vec<f64>),
}

/// Bands of the file that were read in one go.
#[derive(Debug, Clone, Default)]
struct Pass {
    bands: Range<usize>,
    /// [band, row, column].
    numbers: Numbers,
}

impl Raster {
    /// The same numbers, a column for each band: of a table with a line for each thing. What has bands already stays as it is.
    #[must_use]
    pub fn columns_as_bands(mut self) -> Self {
        if let BandReader::Flat(flat) | BandReader::Unpacked(flat, _) = &mut self.reader
            && flat.bands == 1
            && self.scale.is_empty()
            && flat.columns as u64 <= MOST_BANDS
        {
            flat.order = match flat.order {
                AxisOrder::BandColumnRow => AxisOrder::BandRowColumn,
                _ => AxisOrder::RowColumnBand,
            };
            (flat.bands, flat.columns) = (flat.columns, 1);
            (self.columns, self.bands) = (1, vec![RasterBand::default(); flat.bands]);
            self.in_file = (0..self.bands.len()).collect();
        }
        self
    }

    /// A raster of numbers that are values, of which no more is known.
    fn of(
        path: &Path,
        (rows, columns): (usize, usize),
        bands: Vec<RasterBand>,
        data_type: DataType,
        reader: BandReader,
    ) -> Self {
        Raster {
            path: path.to_owned(),
            rows,
            columns,
            in_file: (0..bands.len()).collect(),
            bands,
            pixel_aspect: 1.0,
            layers: Vec::new(),
            alpha: None,
            coverage: None,
            mask: None,
            hidden: Vec::new(),
            no_data: None,
            unit: None,
            ignore: None,
            full_scale: None,
            data_type,
            report: Report::default(),
            scale: Vec::new(),
            special: Special::default(),
            georeference: None,
            spacing_m: None,
            mirrored: [false; 2],
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

    /// Keeps the bands of the image that the file holds, in the order that is asked for by the names of channels, or in its own. Coverage
    /// (alpha) beside them is divided out of them from now on. What is left out is noted in the report.
    ///
    /// # Errors
    /// What is not there, or which bands are meant: a message and a help.
    pub fn take_image(&mut self, channels: Option<&[String]>) -> std::result::Result<(), (String, String)> {
        let all: Vec<&str> = self.bands.iter().map(|band| band.name.as_str()).collect();
        let Chosen { bands, alpha } = layers::choose(&self.layers, &all, channels)?;
        let is_left = |band: &usize| !bands.contains(band) && Some(*band) != alpha;
        let left: Vec<&str> = (0..all.len()).filter(is_left).map(|band| all[band]).collect();
        if !left.is_empty() && channels.is_none() {
            let more = if left.len() > 8 { ", ..." } else { "" };
            let message = format!("channels beside the image: {}{more}", left[..left.len().min(8)].join(", "));
            self.report.note(Fate::Dropped, Location::file(&self.path), message);
        }
        if let Some(alpha) = alpha {
            let message = format!("{}: coverage, by which the others are divided", all[alpha]);
            self.report.note(Fate::Defaulted, Location::file(&self.path), message);
        }
        if let Some(alpha) = alpha {
            self.alpha = Some(Alpha { band: self.in_file[alpha], whole: 1.0, is_multiplied: true });
            self.coverage = None;
        }
        self.in_file = bands.iter().map(|band| self.in_file[*band]).collect();
        self.bands = bands.iter().map(|band| self.bands[*band].clone()).collect();
        self.layers.clear();
        Ok(())
    }

    /// Size of a pixel on the ground, m, as the file says it: from a pixel to the next in its line, and from a line to the next. None where it says
    /// nothing, or angles.
    pub fn spacing_m(&self) -> Option<[f64; 2]> {
        let of_map = || self.place.as_ref().and_then(|place| place.pixel_m(self.rows, self.columns));
        self.spacing_m.or_else(|| self.georeference.as_ref()?.spacing_m()).or_else(of_map)
    }

    /// Where it lies in a plane, as it says itself.
    pub(crate) fn georeference(&self) -> Option<&Georeference> {
        self.georeference.as_ref()
    }

    /// West, south, east and north, deg, where the file says that it lies by longitude and latitude.
    pub fn extent_deg(&self) -> Option<[f64; 4]> {
        match self.georeference {
            Some(Georeference::Degrees { corner_deg: [west, north], pixel_deg: [width, height] }) => {
                let (east, south) = (west + width * self.columns as f64, north - height * self.rows as f64);
                Some([west, south, east, north])
            }
            _ => None,
        }
    }

    /// Width and height of a pixel, deg, where the file says angles.
    pub(crate) fn pixel_deg(&self) -> Option<[f64; 2]> {
        match self.georeference {
            Some(Georeference::Degrees { pixel_deg, .. }) => Some(pixel_deg),
            _ => None,
        }
    }

    /// Refuses lines that do not run from the West to the East, or may not follow one another to the South.
    pub(crate) fn is_upright(&self) -> Result<()> {
        match &self.georeference {
            Some(Georeference::Turned(how)) => {
                let help = "`gdalwarp IN.tif OUT.tif` turns it; `-a_ullr` of gdal_translate states another place";
                Err(Error::Invalid(vec![Problem::new(Location::file(&self.path), how.as_str()).with_help(help)]))
            }
            _ => Ok(()),
        }
    }

    /// What a raster of degrees covers: longitudes and latitudes, from and to, deg.
    pub(crate) fn covered_deg(&self, [west, north]: [f64; 2], [width, height]: [f64; 2]) -> [[f64; 2]; 2] {
        [[west, west + self.columns as f64 * width], [north - self.rows as f64 * height, north]]
    }

    /// The unit that it states, unless that leaves open what it is: spectral OpenEXR says W.m^-2.sr^-1 of radiance per wavelength.
    pub(crate) fn stated_unit(&self) -> Option<&str> {
        let is_open = matches!(self.reader, BandReader::Exr(_)) && self.unit.as_deref() == Some("W.m^-2.sr^-1");
        self.unit.as_deref().filter(|_| !is_open)
    }

    /// The sentence that tells that a header made fractions of the numbers which `percent` divides by 100 once more; `None` if it did not.
    pub(crate) fn percent_of_fractions(&self) -> Option<String> {
        let of_header = self.scale.first().filter(|_| self.full_scale.is_none());
        let divisor = of_header.map(|scale| scale.divisor).filter(|divisor| *divisor != 1.0)?;
        Some(format!(
            "the header's `reflectance scale factor = {}` makes fractions of the numbers, which the unit % divides by 100 once more",
            number(divisor)
        ))
    }

    /// Takes one more number for "nothing here": as it is stored, or as it is among the values.
    pub fn set_no_data(&mut self, no_data: Option<f64>) {
        self.no_data = no_data;
    }

    /// What share of each pixel shows something, row by row, 0 to 1, where the file says it: alpha, of PNG as of what
    /// [`take_image`](Self::take_image) has found. Values are means over that share.
    ///
    /// # Errors
    /// What [`read`](Self::read) says.
    pub fn coverage(&mut self) -> Result<Option<&[f64]>> {
        if self.coverage.is_none() {
            let Some(alpha) = self.alpha else { return Ok(None) };
            let mut shares = Vec::new();
            self.numbers(alpha.band, &mut shares)?;
            let share = |number: f64| if number.is_nan() { 0.0 } else { (number / alpha.whole).clamp(0.0, 1.0) };
            shares.iter_mut().for_each(|number| *number = share(*number));
            self.coverage = Some(shares);
        }
        Ok(self.coverage.as_deref())
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
        let band = self.in_file[band];
        self.numbers(band, values)?;
        let ignored = [self.ignore, self.no_data].map(|number| number.map(|n| self.as_stored(band, n)));
        if ignored.iter().any(Option::is_some) {
            values.iter_mut().filter(|v| ignored.contains(&Some(**v))).for_each(|v| *v = f64::NAN);
        }
        self.special.remove(values);
        if let Some(alpha) = self.alpha
            && let Some(coverage) = self.coverage()?
        {
            values.iter_mut().zip(coverage).for_each(|(value, share)| *value = alpha.value(*value, *share));
        }
        self.hide(values)?;
        if let Some(scale) = self.scale.get(band).copied() {
            values.iter_mut().for_each(|v| *v = scale.value(*v));
            if let Some(no_data) = self.no_data {
                values.iter_mut().filter(|v| **v == no_data).for_each(|v| *v = f64::NAN);
            }
        }
        Ok(())
    }

    /// Reads the numbers of a band of the file, the first line on top and its first pixel on the left.
    fn numbers(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        self.as_they_lie(band, values)?;
        if self.mirrored[1] {
            values.chunks_exact_mut(self.columns).for_each(<[f64]>::reverse);
        }
        if self.mirrored[0] {
            let (above, below) = values.split_at_mut(self.rows / 2 * self.columns);
            let of_below = below.rchunks_exact_mut(self.columns);
            above.chunks_exact_mut(self.columns).zip(of_below).for_each(|(a, b)| a.swap_with_slice(b));
        }
        Ok(())
    }

    /// The same in the order of the file.
    fn as_they_lie(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        let pixels = self.pixels();
        let together = match &self.reader {
            BandReader::Flat(flat) | BandReader::Unpacked(flat, _) if !flat.is_banded() => PASS_BYTES / (8 * pixels),
            BandReader::Png { .. } => PASS_BYTES / (8 * pixels),
            BandReader::Tiff(chunks) if !chunks.is_banded() => PASS_BYTES / (8 * pixels),
            BandReader::Exr(channels) => channels.together(pixels).max(2),
            BandReader::NetCdf(bands) => bands.together(PASS_BYTES / (8 * pixels)),
            BandReader::Zarr(bands) => bands.together(PASS_BYTES / (8 * pixels)),
            BandReader::Flats(_)
            | BandReader::Flat(_)
            | BandReader::Unpacked(..)
            | BandReader::Held(_)
            | BandReader::Blocks(_)
            | BandReader::Tiff(_) => 1,
        };
        if together < 2 {
            resize(values, pixels, &self.path)?;
            return self.fill(band..band + 1, values);
        }
        if !self.pass.bands.contains(&band) {
            let first = band / together * together;
            let all = match &self.reader {
                BandReader::Flat(flat) | BandReader::Unpacked(flat, _) => flat.bands,
                BandReader::Exr(channels) => channels.count(),
                BandReader::Png { samples } => *samples,
                BandReader::Tiff(chunks) => chunks.together(),
                BandReader::NetCdf(of) => of.count,
                BandReader::Zarr(of) => of.count,
                BandReader::Held(_) | BandReader::Blocks(_) | BandReader::Flats(_) => self.in_file.len(),
            };
            let bands = first..all.min(first + together);
            let before = std::mem::take(&mut self.pass).numbers;
            let numbers = match (&self.reader, before) {
                (BandReader::Exr(channels), before) => {
                    drop(before);
                    exr::read(&self.path, (self.rows, self.columns), channels, bands.clone())?
                }
                (_, before) => {
                    let mut all = if let Numbers::F64(all) = before { all } else { Vec::new() };
                    resize(&mut all, bands.len() * pixels, &self.path)?;
                    self.fill(bands.clone(), &mut all)?;
                    Numbers::F64(all)
                }
            };
            self.pass = Pass { bands, numbers };
        }
        resize(values, pixels, &self.path)?;
        self.pass.numbers.copy_to((band - self.pass.bands.start) * pixels, values);
        Ok(())
    }

    /// Reads the numbers of bands of the file, [band, row, column].
    fn fill(&self, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
        match &self.reader {
            BandReader::Flat(flat) => flat.read(&self.path, bands, values)?,
            BandReader::Unpacked(flat, bytes) => {
                flat.read_from(Cursor::new(bytes), bands, values).map_err(|e| Error::io(&self.path, "reading", e))?
            }
            BandReader::Exr(channels) => {
                exr::read(&self.path, (self.rows, self.columns), channels, bands)?.copy_to(0, values)
            }
            BandReader::Blocks(blocks) => blocks.read(&self.path, bands, values)?,
            BandReader::Tiff(chunks) => chunks.read(&self.path, bands, values)?,
            BandReader::Flats(flats) => {
                let planes = values.chunks_exact_mut(self.pixels());
                bands.zip(planes).try_for_each(|(band, plane)| flats[band].read(&self.path, 0..1, plane))?;
            }
            BandReader::NetCdf(of) => of.read(&self.path, bands, values)?,
            BandReader::Zarr(of) => of.read(bands, values)?,
            BandReader::Png { .. } => picture::read(&self.path, bands, values)?,
            BandReader::Held(held) => {
                values.copy_from_slice(&held[bands.start * self.pixels()..bands.end * self.pixels()])
            }
        }
        Ok(())
    }

    /// A number that was written in decimals, as it is among the numbers of a band of the file: those may be f32, or less.
    fn as_stored(&self, band: usize, number: f64) -> f64 {
        match &self.reader {
            BandReader::Flat(flat) | BandReader::Unpacked(flat, _) if flat.data_type == DataType::F32 => {
                f64::from(single(number))
            }
            BandReader::Blocks(blocks) if blocks.flat.data_type == DataType::F32 => f64::from(single(number)),
            BandReader::Tiff(chunks) if chunks.are_f32() => f64::from(single(number)),
            BandReader::Exr(channels) => channels.as_stored(band, number),
            _ => number,
        }
    }

    /// The bands of a picture: three for colours where all wavelengths are known or there are three that are named alike, else the middle one; of bands without
    /// wavelengths, which may be of different quantities, the first.
    pub fn colour_bands(&self) -> Vec<usize> {
        let bands: Option<Vec<Band>> = self.bands.iter().map(|b| Some(Band::new(b.centre_um?, None))).collect();
        let colours: Option<Vec<usize>> = (0..3)
            .map(|colour| {
                let mut of = (0..self.bands.len()).filter(|i| names::colour(&self.bands[*i].name) == Some(colour));
                of.next().filter(|_| of.next().is_none())
            })
            .collect();
        match (bands, colours) {
            (Some(bands), _) if bands.len() >= 3 => quicklook::colour_bands(&bands).to_vec(),
            (None, Some(colours)) => colours,
            (None, _) if self.bands.len() == 3 && self.are_alike() => vec![0, 1, 2],
            (None, _) => vec![0],
            _ => vec![self.bands.len() / 2],
        }
    }

    /// Whether its bands have no names, or numbers for names.
    fn are_alike(&self) -> bool {
        let names: Vec<&str> = self.bands.iter().map(|band| band.name.as_str()).collect();
        names.iter().all(|name| name.is_empty())
            || names::order(&names).is_some_and(|(order, _)| order == names::Order::Number)
    }

    /// The files that it comes from.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The files that it comes from, for reports: of a folder all that are in it, by their names. They are read to the end for their hashes.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn inputs(&self) -> Result<Vec<InputFile>> {
        let mut files = Vec::new();
        for path in &self.files {
            let mut found: Vec<PathBuf> = Vec::new();
            let mut open = vec![path.clone()];
            while let Some(path) = open.pop() {
                if !path.is_dir() {
                    found.push(path);
                    continue;
                }
                for entry in path.read_dir().map_err(|e| Error::io(&path, "reading", e))? {
                    open.push(entry.map_err(|e| Error::io(&path, "reading", e))?.path());
                }
            }
            found.sort();
            files.append(&mut found);
        }
        files.iter().map(|path| InputFile::hashed(path)).collect()
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

/// Refuses a file that ends before its numbers do.
fn check_end(path: &Path, end: Option<u64>, said_by: &Path) -> Result<()> {
    let there = std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len();
    if end.is_some_and(|end| end <= there) {
        return Ok(());
    }
    let message = format!("has {there} bytes, and its numbers do not end before that, says {}", said_by.display());
    let help = "it is cut short, or the label is another file's";
    Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
}

/// Refuses a file that is shorter than its header says; for a longer one, returns what to report.
fn check_length(path: &Path, flat: &Flat, end: Option<u64>, said_by: &Path) -> Result<Option<String>> {
    let there = match end {
        Some(end) => end,
        None => std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len(),
    };
    let wanted = flat.data_bytes().and_then(|n| n.checked_add(flat.start));
    if wanted == Some(there) {
        return Ok(None);
    }
    let Flat { rows, columns, bands, data_type, start, .. } = flat;
    let message = format!(
        "has {there} bytes where {start} + {rows} rows x {columns} columns x {bands} bands x {} bytes belong, says {}",
        data_type.bytes(),
        said_by.display()
    );
    if wanted.is_some_and(|wanted| wanted < there) {
        return Ok(Some(message));
    }
    let problem = Problem::new(Location::file(path), message);
    Err(Error::Invalid(vec![problem.with_help("it is cut short, or the header is another file's")]))
}
