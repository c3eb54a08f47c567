//! Any bytes are a raster of NetCDF, HDF5 or FITS, or an error. Pieces replace good files, as `files.rs` says.
//!
//! What the crate for NetCDF does wrong with damaged files is an error in the program, and is found here.
#![no_main]

use std::sync::LazyLock;

use files::{Folder, told};
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::registry;

mod files;

/// Of `tests/data/containers`, in the order in which the numbers of pieces count them.
macro_rules! containers {
    ($($name:literal),*) => { [
        $(($name, include_bytes!(concat!("../../tests/data/containers/", $name)).as_slice())),*
    ] };
}
static GOOD: [(&str, &[u8]); 6] =
    containers!("packed.nc", "groups.nc", "classic.nc", "cube.fits", "extensions.fits", "compressed.fits");
static FOLDER: LazyLock<Folder> = LazyLock::new(|| Folder::holding("containers", &GOOD));

fuzz_target!(|data: &[u8]| FOLDER.with(data, |folder| {
    for (name, _) in GOOD {
        let Some(mut raster) = told(registry::image(&folder.join(name))) else { continue };
        if raster.pixels() < 1 << 16 {
            let mut values = Vec::new();
            for band in [0, raster.bands.len() - 1] {
                if told(raster.read(band, &mut values)).is_some() {
                    assert_eq!(values.len(), raster.pixels());
                }
            }
        }
    }
}));
