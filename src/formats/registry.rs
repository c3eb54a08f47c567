//! The list of all formats, and recognising a file's: by how it begins and what lies next to it, and otherwise by its name.

use std::path::{Path, PathBuf};

use super::blend::BLEND;
use super::dart::format::SIMULATION;
use super::dart::{database, text_spectra};
use super::flight_table;
use super::foreign;
use super::format::{Format, Holds, ending};
use super::gltf::format::{BINARY, TEXT};
use super::mesh_file::MeshFile;
use super::meshes;
use super::obj::format::OBJ;
use super::raster::headers::ENVI;
use super::raster::{self, Raster};
use super::scene_toml::format::SCENE;
use super::{ccsds, envi, input, marks, sli, spectrum_csv};
use crate::error::{Error, Location, Problem, Result};

/// All formats, in the order in which they are listed and tried on a file.
pub static ALL: &[&Format] = &[
    &SCENE,
    &BLEND,
    &OBJ,
    &TEXT,
    &BINARY,
    &meshes::PLY,
    &meshes::stl::STL,
    &meshes::dsk::DSK,
    &meshes::shape_text::TAB,
    &meshes::shape_text::ICQ,
    &SIMULATION,
    &ENVI,
    &raster::headers::ILWIS,
    &raster::exr::OPEN_EXR,
    &raster::npy::NPY,
    &raster::npy::NPZ,
    &raster::picture::PNG,
    &raster::jpeg::JPEG,
    &raster::pnm::PNM,
    &raster::tiff::TIFF,
    &raster::esri::ESRI,
    &raster::pds3::PDS3,
    &raster::isis::ISIS,
    &raster::netcdf::NETCDF,
    &raster::fits::FITS,
    &raster::zarr::ZARR,
    &raster::dart_cells::DART_CELLS,
    &database::DATABASE,
    &ccsds::OEM,
    &ccsds::AEM,
    &ccsds::NDM,
    &flight_table::TABLE,
    &text_spectra::TEXT,
    &sli::SLI,
    &spectrum_csv::CSV,
    &raster::text::GRID,
    // Behind what else is called .xml.
    &raster::pds4::PDS4,
];

/// This much of a file is read to recognise its format, bytes.
const BEGINNING: usize = 1 << 16;
/// Extensions of companion files, which may have an ENVI header next to them by chance.
const COMPANIONS: [&str; 2] = ["json", "mtl"];

/// The format of a name, as `--from` and `--to` give it.
pub fn named(name: &str) -> Option<&'static Format> {
    ALL.iter().copied().find(|format| format.name == name)
}

/// The format of a path, and its main file or folder.
///
/// # Errors
/// [`Error::Io`]; [`Error::Unsupported`] for an image in a format that is not read; [`Error::Invalid`] if there is no telling.
pub fn of_input(path: &Path) -> Result<(&'static Format, PathBuf)> {
    let beginning = if path.is_dir() { Vec::new() } else { input::beginning(path, BEGINNING)? };
    if holds_numbers_alone(path) {
        return Ok((of_name(path).unwrap_or(&ENVI), path.to_owned()));
    }
    if let Some(error) = not_read(path, &beginning) {
        return Err(error);
    }
    if let Some(found) = told(path, &beginning, |_| true) {
        return Ok(found);
    }
    if path.is_dir() {
        return unknown(path, "a folder with neither maket.xml nor scene.toml in it");
    }
    match of_name(path) {
        Some(format) => Ok((format, path.to_owned())),
        None if !COMPANIONS.contains(&ending(path).as_str()) && envi::pair(path).is_ok() => {
            Ok((&ENVI, path.to_owned()))
        }
        None => unknown(path, "neither what it holds nor how its name ends tells a format"),
    }
}

/// The format that a name asks to be written.
///
/// # Errors
/// [`Error::Invalid`] for an ending that no format has.
pub fn of_output(path: &Path) -> Result<&'static Format> {
    match of_name(path) {
        Some(format) => Ok(format),
        None if is_folder(path) => Ok(&SIMULATION),
        None => unknown(path, "no format's names end like this"),
    }
}

/// The format of a file that should hold spectra; `None` if it is not one of these.
pub fn of_spectra(path: &Path) -> Option<&'static Format> {
    // Whether it exists is found out when it is read.
    let beginning = input::beginning(path, BEGINNING).unwrap_or_default();
    let found = told(path, &beginning, Format::is_spectral).map(|(format, _)| format);
    found.or_else(|| called(path, Format::is_spectral))
}

/// Opens an image, by any of its files, as whatever it is.
///
/// | format | what is read |
/// |---|---|
/// | ENVI | any interleave, real types and byte order; `data gain values`, `data offset values` and `reflectance scale factor` apply |
/// | ILWIS 2 (`.mpr`, `.mp#`) | maps of values; its undefined values are NaN, and -1 where nothing is less, which means no data in DART's images (not in a `DEM`) |
/// | OpenEXR | channels of all parts, on the display window; a name that ends in a wavelength (`S0.0950,000000nm`, `1000nm`, `0.95um`) says it |
/// | PNG, JPEG | grey or red, green, blue, 0 to 1 as stored; NaN where transparent |
/// | CSV | numbers alone, a line for each row; `nan`, or nothing between two commas, means no data |
/// | PGM, PPM | the same, 8 or 16 bits, as text or not |
/// | TIFF, GeoTIFF | integers and real numbers as stored; `GDAL_NODATA`, scale, offset and names of GDAL, where it lies |
/// | ESRI ASCII grid (`.asc`) | `NODATA_value`, cell size |
/// | PDS3, PDS4 | IMAGE; the first array of two or three axes; scaling and constants for no data; where a map lies |
/// | ISIS cube | bands or tiles, base and multiplier; special pixels are NaN; where a map lies |
/// | NetCDF, HDF5, FITS, Zarr | the array of three axes, or all of two that are alike; wavelengths, where a map lies |
/// | NumPy (`.npy`, `.npz` with one array of numbers or one named `raster`) | \[row, column\] or \[row, column, band\]; of one axis: one row |
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] and [`Error::Invalid`] at all places of a header that cannot be used, for a file that is
/// not as long as its header says, and a partner that is not there; [`Error::Unsupported`] for what is not read.
pub fn image(path: &Path) -> Result<Raster> {
    // A folder is an image only if a format says so.
    let is_folder = path.is_dir() && told(path, &[], Format::is_image).is_some();
    let beginning = if is_folder { Vec::new() } else { input::beginning(path, BEGINNING)? };
    let called = called(path, Format::is_image);
    let format = if holds_numbers_alone(path) {
        called.unwrap_or(&ENVI)
    } else if let Some(error) = not_read(path, &beginning) {
        return Err(error);
    } else if let Some((format, _)) = told(path, &beginning, Format::is_image) {
        format
    } else {
        // What has no header of ENVI beside it is told so if it may be its numbers, or is a header.
        let may_be_envi = || ["hdr", "sli"].contains(&ending(path).as_str()) || envi::pair(path).is_ok();
        let is_unknown = marks::named(&beginning).is_none();
        match called {
            Some(format) if *format == ENVI && is_unknown => format,
            Some(format) if *format != ENVI && format.may_begin(&beginning) => format,
            None if may_be_envi() => &ENVI,
            _ => return Err(no_image(path, &beginning)),
        }
    };
    match format.holds {
        Holds::Image { open, .. } => {
            let mut raster = open(path)?;
            raster.take_mask_beside(raster::tiff::open)?;
            Ok(raster)
        }
        _ => Err(no_image(path, &beginning)),
    }
}

/// Reads a mesh in any format. Files that it names may lie outside its folder if `outside` is set.
///
/// # Errors
/// What the format's reader says; [`Error::Invalid`] if it is not a mesh, or in a format that is not read.
pub fn mesh(path: &Path, outside: bool) -> Result<MeshFile> {
    let beginning = input::beginning(path, BEGINNING)?;
    let found = told(path, &beginning, Format::is_mesh).map(|(format, _)| format);
    // A file recognised as something else is not a mesh, whatever its name.
    let other = || marks::named(&beginning).filter(|name| !name.starts_with("text")).map(str::to_owned);
    let called = || called(path, Format::is_mesh).filter(|_| other().is_none());
    if let Some(Format { holds: Holds::Mesh { read }, .. }) = found.or_else(called) {
        return read(path, outside);
    }
    let wanted = format!("meshes are {}", dotted(Format::is_mesh));
    let (message, help) = match other().or_else(|| Some(of_input(path).ok()?.0.kind().to_owned())) {
        Some(other) => (format!("is {other}, but a mesh is needed"), wanted),
        None if foreign::MESHES.contains(&ending(path).as_str()) => {
            ("is a mesh in a format that is not read".to_owned(), "save it as OBJ or glTF".to_owned())
        }
        None => ("is not a mesh in a known format".to_owned(), wanted),
    };
    Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
}

/// How names of some formats' files end, for people.
pub(super) fn dotted(of: impl Fn(&Format) -> bool) -> String {
    endings(of).iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(", ")
}

/// How names of some formats' files end.
pub fn endings(of: impl Fn(&Format) -> bool) -> Vec<&'static str> {
    ALL.iter().copied().filter(|format| of(format)).flat_map(|format| format.extensions).copied().collect()
}

/// Whether a name is a folder's: it ends in nothing, or in a number, as of a version.
pub(super) fn is_folder(path: &Path) -> bool {
    let is_number = |ending: &str| ending.trim_start_matches(['v', 'V']).starts_with(|c: char| c.is_ascii_digit());
    path.is_dir() || path.extension().is_none_or(|ending| ending.to_str().is_some_and(is_number))
}

/// The first of some formats that recognises the file or folder.
fn told(path: &Path, beginning: &[u8], of: impl Fn(&Format) -> bool) -> Option<(&'static Format, PathBuf)> {
    ALL.iter().copied().filter(|format| of(format)).find_map(|format| Some((format, format.told(path, beginning)?)))
}

/// That a file is an image in a format that is not read, which none of ours claims by its mark.
fn not_read(path: &Path, beginning: &[u8]) -> Option<Error> {
    let is_ours = told(path, beginning, |format| !format.mark.is_empty()).is_some();
    foreign::refused(path, beginning).filter(|_| !is_ours)
}

/// The first format whose files are called like this.
fn of_name(path: &Path) -> Option<&'static Format> {
    called(path, |_| true)
}

/// The first of some formats whose files are called like this.
pub(super) fn called(path: &Path, of: impl Fn(&Format) -> bool) -> Option<&'static Format> {
    let ending = ending(path);
    ALL.iter().copied().find(|format| of(format) && format.extensions.contains(&ending.as_str()))
}

/// Whether names of images end so that begin with a mark, read or not.
fn has_mark(ending: &str) -> bool {
    let is_marked = |ending| foreign::ENDINGS.contains(&ending) || marks::ENDINGS.contains(&ending);
    is_marked(ending) || endings(|f| f.is_image() && !f.mark.is_empty()).contains(&ending)
}

/// Whether a file holds numbers alone, so that how it begins tells nothing: 2815 in the first pixel is the mark of JPEG XL. They are
/// ILWIS', or exactly as many as an ENVI header next to them says.
fn holds_numbers_alone(path: &Path) -> bool {
    let ending = ending(path);
    if ending == "mp#" {
        return true;
    }
    if ending == "hdr" || has_mark(&ending) {
        return false;
    }
    let Ok(header) = envi::pair(path).and_then(|(header, _)| envi::read_header(&header)) else { return false };
    let expected = header.data_bytes().and_then(|bytes| bytes.checked_add(header.header_offset));
    path.metadata().is_ok_and(|file| Some(file.len()) == expected)
}

/// The error for a file that is not an image: what it is instead, or how it begins.
fn no_image(path: &Path, beginning: &[u8]) -> Error {
    let ending = ending(path);
    let name = marks::named(beginning);
    let message = match (beginning, name) {
        ([], _) => "is empty".to_owned(),
        (_, Some(name)) => format!("is {name}, and no image"),
        (_, None) => {
            let first: String = beginning.iter().take(8).flat_map(|byte| byte.escape_ascii()).map(char::from).collect();
            match has_mark(&ending) {
                true => {
                    format!(
                        "begins with \"{first}\", as no whole .{ending} file does: damaged, or something else by that name"
                    )
                }
                false => format!(
                    "begins with \"{first}\", as no image does that is read; as numbers of ENVI, its header is not beside it"
                ),
            }
        }
    };
    let problem = Problem::new(Location::file(path), message);
    Error::Invalid(vec![match has_mark(&ending) || name.is_some() {
        true => problem,
        false => problem.with_help("a header of ENVI has the data file's name with .hdr"),
    }])
}

fn unknown<T>(path: &Path, message: &str) -> Result<T> {
    let names: Vec<&str> = ALL.iter().map(|format| format.name).collect();
    let help = format!("say it with --from or --to: {}", names.join(", "));
    Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
}
