//! Which formats there are, and which one a file is.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::input;
use crate::formats::{envi, foreign, gltf, raster, spectra};

/// A format that is read, written, or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `scene.toml`, with the files it names.
    Scene,
    /// Wavefront OBJ with its MTL.
    Obj,
    /// glTF 2.0 as text, with its buffers.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
    /// The folder of a DART simulation.
    Dart,
    /// A DART optical database.
    Database,
    /// DART's spectra as text.
    DartText,
    /// An ENVI spectral library.
    Sli,
    /// Spectra as comma-separated values.
    Csv,
    /// An ENVI image with its header.
    Envi,
    /// An ILWIS 2 map, as DART writes images.
    Ilwis,
    /// An OpenEXR image.
    Exr,
    /// A NumPy array.
    Npy,
    /// NumPy arrays in a zip file.
    Npz,
    /// A picture.
    Png,
    /// A photograph.
    Jpeg,
    /// A band as comma-separated values: numbers alone.
    Grid,
}

/// What a format is called on the command line, how its files' names end, and what is read and written of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct About {
    /// For `--from` and `--to`.
    pub name: &'static str,
    /// How files' names end; nothing for folders.
    pub extensions: &'static [&'static str],
    /// What is read.
    pub reads: &'static str,
    /// What is written.
    pub writes: &'static str,
}

/// The first bytes of every SQLite file.
const SQLITE: &[u8] = b"SQLite format 3\0";
/// As much of a file is looked at to tell what it is, bytes.
const BEGINNING: u64 = 1 << 16;

impl Format {
    /// All formats, in the order they are listed.
    pub const ALL: [Format; 17] = [
        Format::Scene,
        Format::Obj,
        Format::Gltf,
        Format::Glb,
        Format::Dart,
        Format::Database,
        Format::DartText,
        Format::Sli,
        Format::Csv,
        Format::Envi,
        Format::Ilwis,
        Format::Exr,
        Format::Npy,
        Format::Npz,
        Format::Png,
        Format::Jpeg,
        Format::Grid,
    ];

    /// What there is to say of a format.
    pub fn about(self) -> About {
        let about = |name, extensions, reads, writes| About { name, extensions, reads, writes };
        match self {
            Format::Scene => {
                about("scene", &["toml"][..], "everything", "all but textures: scene file, OBJ, MTL, tables")
            }
            Format::Obj => about("obj", &["obj"], "mesh, names and colours of materials", "the same"),
            Format::Gltf => about(
                "gltf",
                &["gltf"],
                "meshes of the default scene, names and colours of materials, origin",
                "the same, in f32 with residuals, and a .bin",
            ),
            Format::Glb => about("glb", &["glb"], "as gltf", "as gltf, in one file"),
            Format::Dart => about(
                "dart",
                &[],
                "simulations of DART 5.4 to 5.11",
                "a simulation of DART 5.7.4, or 5.11.0: a name without an ending",
            ),
            Format::Database => {
                about("db", &["db"], "DART optical databases", "a new one, or more into one with --append")
            }
            Format::DartText => about("dart-text", &["txt"], "DART spectra", "the same"),
            Format::Sli => about("sli", &["sli"], "ENVI spectral libraries, with .hdr", "the same"),
            Format::Csv => about(
                "csv",
                &["csv"],
                "spectra: tables, ECOSTRESS, USGS splib07, RELAB (.txt, .tab, .dat too)",
                "a table with a header that states units",
            ),
            Format::Envi => about(
                "envi",
                &["img", "bsq", "bil", "bip", "dat", "raw"],
                "images with .hdr: real numbers in any order",
                "the same; .bil and .bip interleave bands so",
            ),
            Format::Ilwis => about("ilwis", &["mpr", "mp#"], "maps of values", "one band as DART writes it, with .grf"),
            Format::Exr => about("exr", &["exr"], "channels, wavelengths", "the same, f32"),
            Format::Npy => about("npy", &["npy"], "[row, column] or [row, column, band]", "the same"),
            Format::Npz => about("npz", &["npz"], "the array in it, or that named raster; wavelength_um", ""),
            Format::Png => about("png", &["png"], "grey or colours, 0 to 1; transparent is no data", ""),
            Format::Jpeg => about("jpeg", &["jpg", "jpeg"], "grey or colours, 0 to 1", ""),
            Format::Grid => about("grid", &[], "CSV of numbers alone: one band", "the same"),
        }
    }

    /// The format of a name, as `--from` and `--to` give it.
    pub fn named(name: &str) -> Option<Self> {
        Format::ALL.into_iter().find(|format| format.about().name == name)
    }

    /// Whether it holds spectra and nothing else.
    pub fn is_spectral(self) -> bool {
        matches!(self, Format::Database | Format::DartText | Format::Sli | Format::Csv)
    }

    /// Whether it holds an image and nothing else.
    pub fn is_raster(self) -> bool {
        use Format::{Envi, Exr, Grid, Ilwis, Jpeg, Npy, Npz, Png};
        matches!(self, Envi | Ilwis | Exr | Npy | Npz | Png | Jpeg | Grid)
    }

    /// The format of what is there, and its main file or folder: by its content, and where that does not tell, by its name.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] if neither tells.
    pub fn of_input(path: &Path) -> Result<(Self, PathBuf)> {
        if path.is_dir() {
            let is_dart = ["maket.xml", "input/maket.xml"].iter().any(|name| path.join(name).is_file());
            let scene = path.join("scene.toml");
            return match (is_dart, scene.is_file()) {
                (true, _) => Ok((Format::Dart, path.to_owned())),
                (false, true) => Ok((Format::Scene, scene)),
                _ => refused(path, "a folder with neither maket.xml nor scene.toml in it"),
            };
        }
        let reading = |e| Error::io(path, "reading", e);
        let mut beginning = Vec::new();
        input::open(path).and_then(|file| file.take(BEGINNING).read_to_end(&mut beginning)).map_err(reading)?;
        let of_numbers = raster::holds_numbers_alone(path);
        if let Some(error) = foreign::refused(path, &beginning).filter(|_| !of_numbers) {
            return Err(error);
        }
        let format = match Format::of_name(path) {
            format if of_numbers => format.unwrap_or(Format::Envi),
            _ if beginning.starts_with(SQLITE) => Format::Database,
            _ if beginning.starts_with(gltf::MAGIC) => Format::Glb,
            // A GLB that is none: its reader says why.
            Some(Format::Glb) => Format::Glb,
            _ if gltf::told_apart(&beginning) => Format::Gltf,
            _ if path.file_name().is_some_and(|name| name == "maket.xml") => {
                let folder = path.parent().unwrap_or(Path::new(""));
                return Ok((Format::Dart, if folder.as_os_str().is_empty() { ".".into() } else { folder.to_owned() }));
            }
            _ if beginning.starts_with(b"\x93NUMPY") => Format::Npy,
            _ if beginning.starts_with(b"\x89PNG") => Format::Png,
            _ if beginning.starts_with(&[0x76, 0x2f, 0x31, 0x01]) => Format::Exr,
            _ if beginning.starts_with(foreign::JPEG) => Format::Jpeg,
            Some(Format::Csv) if raster::is_grid(&beginning) => Format::Grid,
            // An image's numbers, called so, with a header beside them.
            Some(Format::Envi) if envi::pair(path).is_ok() => Format::Envi,
            Some(Format::DartText | Format::Envi) | None
                if spectra::Format::of_text(path, &beginning) == Some(spectra::Format::Csv) =>
            {
                Format::Csv
            }
            // A header of ENVI says of what.
            Some(Format::Sli) if is_envi(&beginning) && !is_of_library(&beginning) => Format::Envi,
            Some(format) => format,
            None if !is_no_image(path) && envi::pair(path).is_ok() => Format::Envi,
            None => return refused(path, "neither what it holds nor how its name ends tells a format"),
        };
        Ok((format, path.to_owned()))
    }

    /// The format that a name asks to be written.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an ending that no format has.
    pub fn of_output(path: &Path) -> Result<Self> {
        match Format::of_name(path) {
            Some(format) => Ok(format),
            None if is_folder(path) => Ok(Format::Dart),
            None => refused(path, "no format's names end like this"),
        }
    }

    fn of_name(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_lowercase();
        // A spectral library is often named by its header.
        let extension = if extension == "hdr" { "sli" } else { &extension };
        Format::ALL.into_iter().find(|format| format.about().extensions.contains(&extension))
    }
}

/// Whether a name ends as that of something else, which may have a header of ENVI beside it by chance.
fn is_no_image(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ["json", "mtl"].iter().any(|other| ending.eq_ignore_ascii_case(other)))
}

fn is_envi(header: &[u8]) -> bool {
    let text = header.strip_prefix("\u{feff}".as_bytes()).unwrap_or(header);
    text.get(..4).is_some_and(|word| word.eq_ignore_ascii_case(b"ENVI"))
}

/// Whether a name is a folder's: it ends in nothing, or in a number, as of a version.
pub(super) fn is_folder(path: &Path) -> bool {
    let is_number = |ending: &str| ending.trim_start_matches(['v', 'V']).starts_with(|c: char| c.is_ascii_digit());
    path.is_dir() || path.extension().is_none_or(|ending| ending.to_str().is_some_and(is_number))
}

fn is_of_library(header: &[u8]) -> bool {
    String::from_utf8_lossy(header).to_lowercase().contains(&envi::SPECTRAL_LIBRARY.to_lowercase())
}

fn refused<T>(path: &Path, message: &str) -> Result<T> {
    let names: Vec<&str> = Format::ALL.iter().map(|format| format.about().name).collect();
    let help = format!("say it with --from or --to: {}", names.join(", "));
    Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
}
