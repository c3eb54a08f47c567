//! The radiative budget of DART's cells: `3D_nx_ny_nz_A_B_....bin`, whose name says what is in it.
//!
//! Numbers of 8 bytes, little-endian: for each variable in the order of the name, layers of cells from the top down, rows along x
//! (South), columns along y (East). A layer of a variable is a band here.

use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::flat::{AxisOrder, Flat};
use crate::formats::format::{Format, Holds};
use crate::formats::number::DataType;

use super::{BandReader, Raster, RasterBand, check_size};

/// The radiative budget of DART's cells.
pub(in crate::formats) static DART_CELLS: Format = Format {
    name: "dart-cells",
    // Other files end in .bin as well: the whole name tells.
    extensions: &[],
    reads: "DART's radiative budget of cells, 3D_nx_ny_nz_....bin",
    writes: "",
    mark: &[],
    told: Some(|path, _| layout(path).is_some().then(|| path.to_owned())),
    holds: Holds::Image {
        kind: "radiative budget of DART's cells",
        open,
        target: Err("write .npy, .nc, .zarr or .img: a layer of a variable is a band"),
    },
};

/// Cells along x, y and z, and the variables, as a name says.
fn layout(path: &Path) -> Option<([usize; 3], Vec<String>)> {
    let name = path.file_name()?.to_str()?.strip_prefix("3D_")?.strip_suffix(".bin")?;
    let mut parts = name.split('_');
    let mut count = || parts.next()?.parse().ok().filter(|n: &usize| *n > 0);
    let cells = [count()?, count()?, count()?];
    let variables: Vec<String> = parts.map(str::to_owned).collect();
    (!variables.is_empty() && variables.iter().all(|name| !name.is_empty())).then_some((cells, variables))
}

fn open(path: &Path) -> Result<Raster> {
    let Some(([rows, columns, layers], variables)) = layout(path) else {
        let help = "keep the name that DART gives it";
        let message = "its name does not say what is in it, as in 3D_30_33_11_Intercepted_Scattered.bin";
        return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
    };
    let bands = variables.len().saturating_mul(layers);
    check_size(Location::file(path), rows, columns, bands)?;
    let flat = Flat::new([rows, columns, bands], DataType::F64, AxisOrder::BandRowColumn);
    let there = std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len();
    // A length that is another one is that of other variables: which, nobody knows.
    if flat.data_bytes() != Some(there) {
        let message = format!(
            "has {there} bytes where {} variables x {layers} layers x {rows} x {columns} cells x 8 bytes belong, says its name",
            variables.len()
        );
        let help = "it is cut short, or was given another name";
        return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
    }
    let of_layers = |variable: &String| {
        let band =
            |above: usize| RasterBand { name: format!("{variable} layer {}", layers - above), ..Default::default() };
        (0..layers).map(band).collect::<Vec<_>>()
    };
    let bands = variables.iter().flat_map(of_layers).collect();
    let mut raster = Raster::of(path, (rows, columns), bands, DataType::F64, BandReader::Flat(flat));
    let message = "layers of cells are counted from the lowest one, 1; rows go South, columns East";
    raster.report.note(crate::report::Fate::Defaulted, Location::file(path), message);
    Ok(raster)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_says_what_is_in_a_file() {
        let of = |name: &str| layout(&Path::new("a/b").join(name));
        let names = |list: &[&str]| list.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        assert_eq!(
            of("3D_30_33_11_Intercepted_+ZFaceExit.bin"),
            Some(([30, 33, 11], names(&["Intercepted", "+ZFaceExit"])))
        );
        for other in [
            "3D_30_33_11.bin",
            "3D_30_33_11_.bin",
            "3D_30_33_A.bin",
            "3D_0_33_11_A.bin",
            "3D_-1_33_11_A.bin",
            "3D_30_33_11_A_.bin",
            "30_33_11_A.bin",
            "3D_30_33_11_A.npy",
            "3D_99999999999999999999_1_1_A.bin",
            "",
        ] {
            assert_eq!(of(other), None, "{other}");
        }
    }
}
