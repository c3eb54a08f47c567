//! NetCDF, classic and on HDF5, and plain HDF5: the image among the arrays (see `arrays.rs`), unpacked and without what stands for no data, as the CF
//! conventions have it. By the crate `netcdf-reader`.

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use netcdf_reader::{FileStorage, NcFile, NcGroup, NcSliceInfo, NcSliceInfoElem, NcType, NcVariable};

use crate::error::{Error, Location, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::number::DataType;

use super::arrays::{self, Array, BandAxis, LONGEST};
use super::{BandReader, Raster, Target};
use crate::formats::container::Container;

/// NetCDF.
pub(in crate::formats) static NETCDF: Format = Format {
    name: "netcdf",
    extensions: &["nc", "nc4", "cdf", "h5", "hdf5"],
    reads: "NetCDF and HDF5: the array of three axes, or all of two that are alike; wavelengths, where a map lies",
    writes: "NetCDF classic, by the CF conventions (.nc)",
    mark: &[],
    told: Some(|path, beginning| is_netcdf(beginning).then(|| path.to_owned())),
    holds: Holds::Image { kind: "NetCDF", open, target: Ok(|_| Target::Container(Container::NetCdf)) },
};

fn is_netcdf(beginning: &[u8]) -> bool {
    beginning.starts_with(b"\x89HDF\r\n\x1a\n")
        || [1, 2, 5].iter().any(|version| beginning.starts_with(&[b'C', b'D', b'F', *version]))
}

/// Bands that are read together of HDF5, whose chunks may hold several.
const TOGETHER: usize = 16;

/// Where the bands of a file are.
#[derive(Debug, Clone)]
pub(super) struct Bands {
    /// Names of the arrays: one, or one for each band.
    names: Vec<String>,
    band_axis: BandAxis,
    /// Axes of length 1 before those of the image.
    before: usize,
    pub(super) count: usize,
    is_hdf5: bool,
}

/// Runs what is the crate's. It is not ours: should it panic on a damaged file, that is an error as any other.
fn guarded<T>(path: &Path, what: impl FnOnce() -> netcdf_reader::Result<T>) -> Result<T> {
    let broken = |why: &str| Error::syntax(Location::file(path), format!("cannot be read as NetCDF or HDF5: {why}"));
    match catch_unwind(AssertUnwindSafe(what)) {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(netcdf_reader::Error::Io(e))) => Err(Error::io(path, "reading", e)),
        Ok(Err(e)) => Err(broken(&e.to_string())),
        Err(_) => Err(broken("it is damaged")),
    }
}

fn file(path: &Path) -> netcdf_reader::Result<NcFile> {
    let file = std::fs::File::open(path)?;
    let storage = FileStorage::from_file(file).map_err(|e| netcdf_reader::Error::InvalidData(e.to_string()))?;
    NcFile::from_storage(Arc::new(storage))
}

/// The type of an array's numbers; `None` of texts and structures.
fn data_type(of: &NcType) -> Option<DataType> {
    Some(match of {
        NcType::Byte => DataType::I8,
        NcType::Short => DataType::I16,
        NcType::Int => DataType::I32,
        NcType::Float => DataType::F32,
        NcType::Double => DataType::F64,
        NcType::UByte => DataType::U8,
        NcType::UShort => DataType::U16,
        NcType::UInt => DataType::U32,
        NcType::Int64 => DataType::I64,
        NcType::UInt64 => DataType::U64,
        NcType::Enum { base, .. } => data_type(base)?,
        _ => return None,
    })
}

fn text(variable: &NcVariable, name: &str) -> Option<String> {
    variable.attribute(name).and_then(|attribute| attribute.value.as_string())
}

/// All arrays of a group and those below it, by their paths.
fn listed(file: &NcFile, group: &NcGroup, above: &str, found: &mut Vec<(Array, Option<DataType>)>) {
    for variable in &group.variables {
        let name = format!("{above}{}", variable.name);
        let data_type = data_type(variable.dtype());
        let length = |size: u64| usize::try_from(size).unwrap_or(usize::MAX);
        let axes: Vec<(String, usize)> =
            variable.dimensions().iter().map(|axis| (axis.name.clone(), length(axis.size))).collect();
        let is_short = axes.len() == 1 && axes[0].1 <= LONGEST && data_type.is_some();
        let values = is_short.then(|| file.read_variable_unpacked_masked(&name).ok()).flatten();
        let is_packed = ["scale_factor", "add_offset"].iter().any(|key| variable.attribute(key).is_some());
        let array = Array {
            axes,
            is_number: data_type.is_some(),
            unit: text(variable, "units"),
            standard_name: text(variable, "standard_name"),
            coordinates: text(variable, "coordinates")
                .iter()
                .flat_map(|names| names.split_whitespace().map(|name| format!("{above}{name}")))
                .collect(),
            band_names: text(variable, "band_names"),
            values: values.map(|values| values.iter().copied().collect()),
            name,
        };
        found.push((array, data_type.map(|data_type| if is_packed { DataType::F64 } else { data_type })));
    }
    for inner in &group.groups {
        listed(file, inner, &format!("{above}{}/", inner.name), found);
    }
}

/// Opens a file.
fn open(path: &Path) -> Result<Raster> {
    let (found, is_hdf5) = guarded(path, || {
        let file = file(path)?;
        let mut found = Vec::new();
        listed(&file, file.root_group()?, "", &mut found);
        Ok((found, matches!(file.format(), netcdf_reader::NcFormat::Nc4 | netcdf_reader::NcFormat::Nc4Classic)))
    })?;
    let arrays: Vec<Array> = found.iter().map(|(array, _)| array.clone()).collect();
    let image = arrays::image(path, &arrays)?;
    let types: Vec<DataType> = image.arrays.iter().filter_map(|i| found[*i].1).collect();
    let data_type = match types[..] {
        [first, ref others @ ..] if others.iter().all(|other| *other == first) => first,
        _ => DataType::F64,
    };
    let names = image.arrays.iter().map(|i| arrays[*i].name.clone()).collect();
    let (band_axis, before, count) = (image.band_axis, image.before, image.bands.len());
    let reader = BandReader::NetCdf(Bands { names, band_axis, before, count, is_hdf5 });
    // What stands for no data is NaN when it is read: of whole numbers, too.
    let data_type = if data_type.is_integer() { DataType::F64 } else { data_type };
    Ok(image.raster(path, data_type, reader))
}

impl Bands {
    /// How many bands are read in one go, where so many fit into the memory for them.
    pub(super) fn together(&self, fit: usize) -> usize {
        match self.band_axis {
            BandAxis::Last => fit,
            BandAxis::First if self.is_hdf5 => fit.min(TOGETHER),
            _ => 1,
        }
    }

    /// Reads some bands, [band, row, column].
    pub(super) fn read(&self, path: &Path, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
        let file = guarded(path, || file(path))?;
        let all = NcSliceInfoElem::Slice { start: 0, end: u64::MAX, step: 1 };
        let some = NcSliceInfoElem::Slice { start: bands.start as u64, end: bands.end as u64, step: 1 };
        let before = std::iter::repeat_n(NcSliceInfoElem::Index(0), self.before);
        let axes = match self.band_axis {
            BandAxis::None => vec![all.clone(), all],
            BandAxis::First => vec![some, all.clone(), all],
            BandAxis::Last => vec![all.clone(), all, some],
        };
        let selection = NcSliceInfo { selections: before.chain(axes).collect() };
        let slice = |name: &String, values: &mut [f64]| {
            let array = guarded(path, || file.read_variable_slice_unpacked_masked(name, &selection))?;
            if array.len() != values.len() {
                let message = format!("{name} has {} numbers where {} belong", array.len(), values.len());
                return Err(Error::invalid(Location::file(path), message));
            }
            match self.band_axis {
                BandAxis::Last => {
                    let pixels = values.len() / bands.len();
                    for (i, value) in array.iter().enumerate() {
                        values[i % bands.len() * pixels + i / bands.len()] = *value;
                    }
                }
                _ => values.iter_mut().zip(array.iter()).for_each(|(value, number)| *value = *number),
            }
            Ok(())
        };
        match self.band_axis {
            BandAxis::None => {
                let pixels = values.len() / bands.len().max(1);
                bands
                    .clone()
                    .zip(values.chunks_exact_mut(pixels))
                    .try_for_each(|(band, plane)| slice(&self.names[band], plane))
            }
            _ => slice(&self.names[0], values),
        }
    }
}
