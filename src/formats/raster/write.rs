//! Rasters are written band by band as they are read, and what a format cannot hold is reported.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::container::Container;
use crate::formats::dataset::Value;
use crate::formats::envi::{self, HeaderBand, HeaderText, Interleave};
use crate::formats::folder::{FolderKind, Staged};
use crate::formats::number::DataType;
use crate::formats::{exr_cube, ilwis, npy};
use crate::product::{Backplanes, Quantity};
use crate::progress::{Watch, tell};
use crate::report::{Fate, Report};
use crate::spectral::Band;

use super::cube_dataset::{self, CubeNotes};
use super::{PASS_BYTES, Raster, RasterBand, resize};
use crate::formats::flat::{AxisOrder, Flat, FlatFile};

/// A format that rasters are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// ENVI, little-endian, with its header beside it.
    Envi(Interleave),
    /// A real map of ILWIS as DART writes it: `.mpr`, `.mp#`, `.grf`, `.gr#`.
    Ilwis,
    /// OpenEXR: f32 scan lines, a channel for each band.
    Exr,
    /// NumPy: [row, column], or [row, column, band].
    Npy,
    /// Comma-separated numbers, a line for each row.
    Csv,
    /// NetCDF, Zarr or FITS.
    Container(Container),
}

/// Endings of the files of a map of ILWIS: header, numbers, georeference, its corners.
const ILWIS: [&str; 4] = ["mpr", "mp#", "grf", "gr#"];

/// A folder of Zarr. It holds a folder for each array, whatever that is called.
const ZARR: FolderKind = FolderKind { marks: &["zarr.json"], parts: &["zarr.json"], holds: Some("zarr.json") };

/// What is left to the caller.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Type of the numbers in ENVI and NumPy; the raster's own if not given. The other formats have one.
    pub data_type: Option<DataType>,
    /// Bands to write, from 0; all if there are none.
    pub bands: Vec<usize>,
    /// What is there may be replaced.
    pub replace: bool,
}

/// Writes a raster under hidden names: [`Staged::commit`] gives all files their own. The report lists what is lost.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for bands that are not there, for what exists and is not to be replaced, and for
/// what the format cannot hold; what [`Raster::read`] says; [`Error::Interrupted`] if `watch` asks to stop.
pub fn write(
    raster: &mut Raster,
    path: &Path,
    target: Target,
    options: &Options,
    report: &mut Report,
    watch: Watch<'_>,
) -> Result<Staged> {
    let chosen: Vec<usize> =
        if options.bands.is_empty() { (0..raster.bands.len()).collect() } else { options.bands.clone() };
    if let Some(band) = chosen.iter().find(|band| **band >= raster.bands.len()) {
        let message = format!("band {} is asked for: it has {}", band.saturating_add(1), raster.bands.len());
        return Err(Error::invalid(Location::file(&raster.path), message));
    }
    if matches!(target, Target::Ilwis | Target::Csv) && chosen.len() != 1 {
        let message = format!("{} bands where such a file holds one", chosen.len());
        let problem = Problem::new(Location::file(path), message).with_help("choose one: --band 1");
        return Err(Error::Invalid(vec![problem]));
    }
    // A type of integers has no number for pixels that a mask hides.
    let own = match raster.may_have_holes() && raster.ignore.is_none() && raster.data_type.is_integer() {
        true => DataType::F64,
        false => raster.data_type,
    };
    let data_type = match target {
        Target::Envi(_) | Target::Npy => options.data_type.unwrap_or(own),
        Target::Container(container) => container.type_of(options.data_type.unwrap_or(own)),
        Target::Exr => DataType::F32,
        Target::Ilwis | Target::Csv => DataType::F64,
    };
    // ENVI has no signed bytes.
    let data_type = match (target, data_type) {
        (Target::Envi(_), DataType::I8) => DataType::I16,
        _ => data_type,
    };
    let bands: Vec<RasterBand> = chosen.iter().map(|band| raster.bands[*band].clone()).collect();
    let all_bands = chosen.len() == raster.bands.len() && chosen.is_sorted();
    tell_places(raster, target, &bands, all_bands, report);

    // Of a map's four files one is named; if none is, the one by which it is read.
    let is_part = path.extension().is_some_and(|e| ILWIS.iter().any(|part| e.eq_ignore_ascii_case(part)));
    let main = if target == Target::Ilwis && !is_part { &path.with_extension(ILWIS[0]) } else { path };
    let mut staged = match target {
        Target::Container(Container::Zarr) => Staged::folder_of(&ZARR, main, options.replace)?,
        _ => Staged::file(main, options.replace)?,
    };
    let mut job = Job { raster, chosen: chosen.clone(), data_type, loss: Loss::default(), watch };
    let (rows, columns) = (job.raster.rows, job.raster.columns);
    let flat = |order| Flat::new([rows, columns, chosen.len()], data_type, order);
    if target != Target::Csv {
        staged.has_room(flat(AxisOrder::BandRowColumn).data_bytes().unwrap_or(u64::MAX))?;
    }
    match target {
        Target::Envi(interleave) => {
            let header = staged.beside(&envi::header_of(path)?)?;
            job.numbers(&staged, staged.path(), flat(AxisOrder::from(interleave)), &[])?;
            let text = envi_header(job.raster, &bands, all_bands, interleave, data_type, &job.loss);
            staged.put(&header, |out| out.write_all(text.as_bytes()))?;
        }
        Target::Npy => {
            let shape = match bands.len() {
                1 => format!("({rows}, {columns})"),
                n => format!("({rows}, {columns}, {n})"),
            };
            let preamble = npy::written(&npy_type(data_type), &shape);
            job.numbers(&staged, staged.path(), flat(AxisOrder::RowColumnBand), &preamble)?;
        }
        Target::Exr => {
            let (names, spectral) = channel_names(&bands, path, report)?;
            let mut order: Vec<usize> = (0..names.len()).collect();
            order.sort_by(|a, b| names[*a].cmp(&names[*b]));
            let sorted: Vec<&str> = order.iter().map(|band| names[*band].as_str()).collect();
            let unit = job.raster.unit.clone();
            let about = exr_cube::About {
                description: "",
                spectral,
                unit: unit.as_deref(),
                widths: exr_cube::widths(order.iter().map(|band| bands[*band].fwhm_um).filter(|_| spectral)),
                names: exr_cube::band_names(order.iter().map(|band| bands[*band].name.as_str()).filter(|_| spectral)),
            };
            let head = exr_cube::head(path, &sorted, [columns, rows], &about)?;
            let in_file: Vec<usize> = order.iter().map(|band| chosen[*band]).collect();
            job.chosen = in_file;
            job.numbers(&staged, staged.path(), exr_cube::flat([rows, columns, names.len()]), &head)?;
        }
        Target::Ilwis => {
            // One of them is what the output is called.
            let mut file = |extension: &str| match main.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) {
                true => Ok(staged.path().to_owned()),
                false => staged.beside(&main.with_extension(extension)),
            };
            let [header, numbers, georeference, corners] = ILWIS.map(&mut file);
            let (header, numbers, georeference, corners) = (header?, numbers?, georeference?, corners?);
            // As DART had it.
            job.loss.no_data_is = job.raster.ignore.filter(|ignore| *ignore == ilwis::NO_DATA);
            job.numbers(&staged, &numbers, flat(AxisOrder::BandRowColumn), &[])?;
            let place = match &job.raster.place {
                Some(place) => place.clone(),
                None => {
                    report.note(Fate::Defaulted, Location::file(path), "pixels: 1 m, from the scene's origin");
                    ilwis::MapExtent::of_pixels([1.0; 2], rows, columns)
                }
            };
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let Loss { least, largest, .. } = job.loss;
            let text = ilwis::header_text(&name, rows, columns, &place, [least, largest]);
            staged.put(&header, |out| out.write_all(text.as_bytes()))?;
            let text = ilwis::georeference_text(&name, rows, columns);
            staged.put(&georeference, |out| out.write_all(text.as_bytes()))?;
            staged.put(&corners, |out| out.write_all(&ilwis::corner_table(rows, columns, &place)))?;
        }
        Target::Csv => {
            job.text(&staged)?;
        }
        Target::Container(container) => job.container(&staged, container, &bands)?,
    }
    let loss = job.loss;
    loss.tell(raster, data_type, target, report);
    Ok(staged)
}

/// Writes a cube, with what is said of it and planes that belong to it, into a new file, or a new folder. Nothing is told: its numbers are written as they are,
/// or in a type that holds them all.
///
/// # Errors
/// [`Error::Io`], what [`Raster::read`] says, [`Error::Interrupted`] if `watch` asks to stop.
pub(in crate::formats) fn write_cube(
    raster: &mut Raster,
    path: &Path,
    container: Container,
    planes: Option<&Backplanes>,
    notes: CubeNotes<'_>,
    watch: Watch<'_>,
) -> Result<()> {
    let data_type = container.type_of(raster.data_type);
    let size = [raster.rows, raster.columns];
    let data = cube_dataset::of_cube(size, &raster.bands, data_type, planes, None, notes);
    let mut band = Vec::new();
    container.write(path, &data, |_, mut file| {
        for i in 0..raster.bands.len() {
            tell(watch, "writing the cube in other formats", i as u64, raster.bands.len() as u64)?;
            raster.read(i, &mut band)?;
            file.tile(0..raster.rows, i..i + 1, &band).map_err(|e| Error::io(path, "writing", e))?;
        }
        Ok(())
    })
}

/// What the numbers lose.
#[derive(Debug)]
struct Loss {
    /// Numbers that are not what they were.
    changed: u64,
    /// The most that one changed by, in the unit of the values.
    most: f64,
    /// Pixels without data.
    no_data: u64,
    /// Those of them that the type has no number for.
    unmarked: u64,
    least: f64,
    largest: f64,
    /// What a map of reals has where there is no data, if not NaN.
    no_data_is: Option<f64>,
}

impl Default for Loss {
    fn default() -> Self {
        Loss {
            changed: 0,
            most: 0.0,
            no_data: 0,
            unmarked: 0,
            least: f64::INFINITY,
            largest: f64::NEG_INFINITY,
            no_data_is: None,
        }
    }
}

impl Loss {
    /// Makes numbers what they will be in the file.
    fn round(&mut self, data_type: DataType, ignore: Option<f64>, values: &mut [f64]) {
        // Only what can be told apart again marks what is not there.
        let marker = ignore.filter(|ignore| {
            let (mut bytes, mut back) = (Vec::new(), [0.0]);
            data_type.encode(false, &[*ignore], &mut bytes);
            data_type.decode(false, &bytes, &mut back);
            back == [*ignore]
        });
        let mut bytes = Vec::new();
        let mut rounded = Vec::new();
        for piece in values.chunks_mut(1 << 16) {
            for value in piece.iter_mut() {
                if value.is_nan() && self.no_data_is.is_some() {
                    *value = self.no_data_is.unwrap_or(f64::NAN);
                    self.least = self.least.min(*value);
                    self.largest = self.largest.max(*value);
                } else if value.is_nan() {
                    self.no_data += 1;
                    if data_type.is_integer() {
                        self.unmarked += u64::from(marker.is_none());
                        *value = marker.unwrap_or(0.0);
                    }
                } else if value.is_finite() {
                    self.least = self.least.min(*value);
                    self.largest = self.largest.max(*value);
                }
            }
            bytes.clear();
            data_type.encode(false, piece, &mut bytes);
            rounded.resize(piece.len(), 0.0);
            data_type.decode(false, &bytes, &mut rounded);
            for (value, rounded) in piece.iter_mut().zip(&rounded) {
                if *value != *rounded && !value.is_nan() {
                    self.changed += 1;
                    self.most = self.most.max((*value - rounded).abs());
                    *value = *rounded;
                }
            }
        }
    }

    fn tell(&self, raster: &Raster, data_type: DataType, target: Target, report: &mut Report) {
        let at = || Location::file(&raster.path).with_item("numbers");
        if self.changed > 0 {
            let message =
                format!("{} are not exact in {}: up to {:.3e} off", self.changed, data_type.name(), self.most);
            report.note(Fate::Approximated, at(), message);
        }
        if self.unmarked > 0 {
            let message = format!("{} pixels without data are 0 in {}", self.unmarked, data_type.name());
            report.note(Fate::Dropped, at(), message);
        } else if self.no_data > 0 && data_type.is_integer() && target == Target::Npy {
            let marker = raster.ignore.unwrap_or(f64::NAN);
            report.note(Fate::Dropped, at(), format!("that {marker} means no data: the file has no place to say so"));
        }
    }
}

/// Tells what the target has no place for, apart from numbers.
fn tell_places(raster: &Raster, target: Target, bands: &[RasterBand], all_bands: bool, report: &mut Report) {
    let at = |item: &str| Location::file(&raster.path).with_item(item);
    let mut dropped = |item: &str, message: String| report.note(Fate::Dropped, at(item), message);
    let is_envi = matches!(target, Target::Envi(_) | Target::Container(_));
    let (wave, width) = (bands.iter().any(|b| b.centre_um.is_some()), bands.iter().any(|b| b.fwhm_um.is_some()));
    if wave && !(is_envi || target == Target::Exr) {
        dropped("wavelengths", "the format has no place for them".into());
    } else if wave && bands.iter().any(|b| b.centre_um.is_none()) {
        dropped("wavelengths", "not all bands have one, so that none is written".into());
    }
    let is_spectral = target == Target::Exr && bands.iter().all(|b| b.centre_um.is_some());
    if width && !(is_envi || is_spectral) {
        dropped("widths of bands", "the format has no place for them".into());
    }
    if bands.iter().any(|b| !b.name.is_empty()) && matches!(target, Target::Npy | Target::Csv) {
        dropped("names of bands", "the format has no place for them".into());
    }
    if raster.unit.is_some() && !(is_envi || target == Target::Exr) {
        dropped("unit", format!("{}: the format has no place for it", raster.unit.as_deref().unwrap_or_default()));
    }
    if raster.place.is_some() && target != Target::Ilwis {
        dropped("georeference", "where the map lies is not carried over".into());
    }
    let keeps_header = matches!(target, Target::Envi(_)) && all_bands;
    if !raster.extra.is_empty() && !keeps_header {
        let names: Vec<&str> = raster.extra.iter().map(|(key, _)| key.as_str()).collect();
        dropped("header", format!("not carried over: {}", names.join(", ")));
    }
}

struct Job<'a> {
    raster: &'a mut Raster,
    /// Bands in the order of the file.
    chosen: Vec<usize>,
    data_type: DataType,
    loss: Loss,
    watch: Watch<'a>,
}

impl Job<'_> {
    /// Writes what comes first, and then all numbers.
    fn numbers(&mut self, staged: &Staged, path: &Path, flat: Flat, first: &[u8]) -> Result<()> {
        let writing = |e| staged.named(Error::io(path, "writing", e));
        let pixels = self.raster.pixels();
        let together = flat.together(PASS_BYTES);
        let mut file = FlatFile::create(path, flat, first).map_err(writing)?;
        let (mut pass, mut band) = (Vec::new(), Vec::new());
        resize(&mut pass, together * pixels, &self.raster.path)?;
        for start in (0..self.chosen.len()).step_by(together) {
            let bands = start..self.chosen.len().min(start + together);
            for (i, values) in bands.clone().zip(pass.chunks_exact_mut(pixels)) {
                tell(self.watch, "converting the image", i as u64, self.chosen.len() as u64)?;
                self.raster.read(self.chosen[i], &mut band)?;
                self.loss.round(self.data_type, self.raster.ignore, &mut band);
                values.copy_from_slice(&band);
            }
            let rows = 0..self.raster.rows;
            file.tile(rows, bands.clone(), &pass[..bands.len() * pixels]).map_err(writing)?;
        }
        Ok(())
    }

    /// Writes a file, or what belongs into a folder, that says what its numbers are.
    fn container(&mut self, staged: &Staged, container: Container, bands: &[RasterBand]) -> Result<()> {
        let Raster { rows, columns, ignore, .. } = *self.raster;
        let (unit, place) = (self.raster.unit.clone(), self.raster.georeference().cloned());
        let of_unit = [Quantity::Radiance, Quantity::BandRadiance, Quantity::BrightnessTemperature, Quantity::Counts];
        let quantity = of_unit.into_iter().find(|quantity| unit.as_deref() == Some(quantity.unit()));
        let notes = CubeNotes {
            quantity: quantity.map_or(("image", "Image"), |quantity| (quantity.name(), quantity.title())),
            unit: unit.as_deref(),
            no_data: ignore,
            attributes: vec![
                ("Conventions", "CF-1.11".into()),
                ("source", Value::Text(format!("mmxrt {}", env!("CARGO_PKG_VERSION")))),
            ],
            texts: vec![],
        };
        let data = cube_dataset::of_cube([rows, columns], bands, self.data_type, None, place.as_ref(), notes);
        let (mut band, path) = (Vec::new(), staged.path());
        let written = container.write(path, &data, |_, mut file| {
            for (i, chosen) in self.chosen.iter().enumerate() {
                tell(self.watch, "converting the image", i as u64, self.chosen.len() as u64)?;
                self.raster.read(*chosen, &mut band)?;
                self.loss.round(self.data_type, ignore, &mut band);
                file.tile(0..rows, i..i + 1, &band).map_err(|e| Error::io(path, "writing", e))?;
            }
            Ok(())
        });
        written.map_err(|e| staged.named(e))
    }

    /// Writes a band as text: the shortest decimals that are the same numbers again.
    fn text(&mut self, staged: &Staged) -> Result<()> {
        let writing = |e| staged.named(Error::io(staged.path(), "writing", e));
        let mut values = Vec::new();
        self.raster.read(self.chosen[0], &mut values)?;
        self.loss.round(self.data_type, None, &mut values);
        let mut file = BufWriter::with_capacity(1 << 20, File::create(staged.path()).map_err(writing)?);
        let mut line = String::new();
        for row in values.chunks_exact(self.raster.columns) {
            line.clear();
            for (i, value) in row.iter().enumerate() {
                let comma = if i == 0 { "" } else { "," };
                let _ = if value.is_nan() { write!(line, "{comma}nan") } else { write!(line, "{comma}{value:?}") };
            }
            line.push('\n');
            file.write_all(line.as_bytes()).map_err(writing)?;
        }
        file.flush().map_err(writing)
    }
}

fn envi_header(
    raster: &Raster,
    bands: &[RasterBand],
    all_bands: bool,
    interleave: Interleave,
    data_type: DataType,
    loss: &Loss,
) -> HeaderText {
    let mut text = HeaderText::of_image(None, [raster.columns, raster.rows, bands.len()], data_type, interleave);
    match raster.ignore {
        Some(ignore) if data_type.is_integer() && loss.unmarked == 0 => text.field("data ignore value", ignore),
        _ if loss.no_data > 0 && !data_type.is_integer() => text.field("data ignore value", "nan"),
        _ => {}
    }
    if let Some(unit) = &raster.unit {
        text.field("data units", envi::plain(unit));
    }
    text.bands(bands.iter().map(|RasterBand { name, centre_um, fwhm_um, is_bad }| HeaderBand {
        name,
        centre_um: *centre_um,
        fwhm_um: *fwhm_um,
        is_bad: *is_bad,
    }));
    if all_bands {
        raster.extra.iter().for_each(|(key, value)| text.field(key, format_args!("{{{value}}}")));
    }
    text
}

/// NumPy's name of a type.
fn npy_type(data_type: DataType) -> String {
    let kind = match data_type {
        DataType::F32 | DataType::F64 => 'f',
        _ if data_type.name().starts_with('u') => 'u',
        _ => 'i',
    };
    let order = if data_type.bytes() == 1 { '|' } else { '<' };
    format!("{order}{kind}{}", data_type.bytes())
}

/// What channels are called, and whether that is their wavelength.
fn channel_names(bands: &[RasterBand], path: &Path, report: &mut Report) -> Result<(Vec<String>, bool)> {
    let centres_um: Option<Vec<f64>> = bands.iter().map(|b| b.centre_um).collect();
    let twice = |names: &[String]| {
        let mut sorted: Vec<&String> = names.iter().collect();
        sorted.sort();
        sorted.windows(2).find(|w| w[0] == w[1]).map(|w| w[0].clone())
    };
    if let Some(centres_um) = centres_um {
        let names: Vec<String> = centres_um.iter().map(|um| exr_cube::channel_name(&Band::new(*um, None))).collect();
        if bands.iter().any(|b| !b.name.is_empty() && super::names::wavelength(&b.name).is_none()) {
            let at = Location::file(path).with_item("names of bands");
            report.note(Fate::Carried, at, "in the attribute `bandNames`: channels are called by their wavelength");
        }
        return match twice(&names) {
            None => Ok((names, true)),
            Some(name) => {
                let problem = Problem::new(Location::file(path), format!("two bands have the wavelength of {name}"))
                    .with_help("OpenEXR knows bands by their wavelength, here to 1e-6 nm: choose bands with --band");
                Err(Error::Invalid(vec![problem]))
            }
        };
    }
    let names: Vec<String> = bands.iter().map(|b| b.name.clone()).collect();
    let fits = |name: &String| (1..32).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic() || b == b' ');
    if names.iter().all(fits) && twice(&names).is_none() {
        return Ok((names, false));
    }
    if names.iter().any(|name| !name.is_empty()) {
        let at = Location::file(path).with_item("names of bands");
        report.note(Fate::Dropped, at, "channels are numbered: names are longer than 31 bytes, or appear twice");
    }
    Ok(match bands.len() {
        1 => (vec!["Y".to_owned()], false),
        n => ((1..=n).map(|i| format!("band_{i:05}")).collect(), false),
    })
}
