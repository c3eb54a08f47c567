//! Files and folders that hold an image and all that belongs to it: which there are, and how one is written.

use std::fs::{self, File};
use std::path::Path;

use super::dataset::{Dataset, Slot, Variable};
use super::flat::{AxisOrder, Flat, FlatFile};
use super::number::DataType;
use super::{fits, netcdf, zarr};
use crate::error::{Error, Result};

/// A format of such files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Container {
    /// NetCDF, classic, with the names of the CF conventions.
    NetCdf,
    /// Zarr, version 3: a folder.
    Zarr,
    /// FITS.
    Fits,
}

impl Container {
    /// All of them.
    pub const ALL: [Container; 3] = [Container::NetCdf, Container::Zarr, Container::Fits];

    /// How names of its files end.
    pub fn ending(self) -> &'static str {
        match self {
            Container::NetCdf => "nc",
            Container::Zarr => "zarr",
            Container::Fits => "fits",
        }
    }

    /// The type in which numbers of a type are written.
    pub(super) fn type_of(self, data_type: DataType) -> DataType {
        match self {
            Container::NetCdf => netcdf::type_of(data_type),
            Container::Zarr => data_type,
            Container::Fits => fits::type_of(data_type),
        }
    }

    /// Writes a file, or what belongs into a folder, new. `fill` writes the numbers that the dataset does not have, of the variable with this number.
    ///
    /// # Errors
    /// [`Error::Io`], and those of `fill`.
    pub(super) fn write(
        self,
        path: &Path,
        data: &Dataset<'_>,
        mut fill: impl FnMut(usize, FlatFile) -> Result<()>,
    ) -> Result<()> {
        let making = |path: &Path, e| Error::io(path, "writing", e);
        let slots = match self {
            Container::NetCdf => netcdf::slots(path, data),
            Container::Zarr => zarr::slots(path, data),
            Container::Fits => fits::slots(path, data),
        };
        if self == Container::Zarr {
            for folder in slots.iter().filter_map(|slot| slot.path.parent()) {
                fs::create_dir_all(folder).map_err(|e| making(folder, e))?;
            }
        } else {
            File::create(path).map_err(|e| making(path, e))?;
        }
        for (i, (variable, slot)) in data.variables.iter().zip(&slots).enumerate() {
            let flat = flat(&data.shape(variable), variable, slot);
            let [rows, bands] = [flat.rows, flat.bands];
            let mut file = FlatFile::open(&slot.path, flat).map_err(|e| making(&slot.path, e))?;
            match &variable.values {
                Some(values) => file.tile(0..rows, 0..bands, values).map_err(|e| making(&slot.path, e))?,
                None => fill(i, file)?,
            }
        }
        match self {
            Container::NetCdf => netcdf::finish(path, data),
            Container::Zarr => zarr::finish(path, data),
            Container::Fits => fits::finish(path, data),
        }
    }
}

/// How the numbers of a variable lie: the last axis is the columns, the one before it the rows.
fn flat(shape: &[usize], variable: &Variable<'_>, slot: &Slot) -> Flat {
    let [bands, rows, columns] = match *shape {
        [bands, rows, columns] => [bands, rows, columns],
        [rows, columns] => [1, rows, columns],
        [columns] => [1, 1, columns],
        _ => [1; 3],
    };
    let flat = Flat::new([rows, columns, bands], variable.data_type, AxisOrder::BandRowColumn);
    Flat { start: slot.start, big_endian: slot.big_endian, ..flat }
}
