//! Any bytes are a raster of TIFF, PDS3, PDS4, ISIS, PNM or ESRI, or an error. Pieces replace good files, as `files.rs` says.
#![no_main]

use std::sync::LazyLock;

use files::{Folder, told};
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::registry;

mod files;

/// Of `tests/data/rasters`, in the order in which the numbers of pieces count them.
macro_rules! rasters {
    ($($name:literal),*) => { [
        $(($name, include_bytes!(concat!("../../tests/data/rasters/", $name)).as_slice())),*
    ] };
}
static GOOD: [(&str, &[u8]); 22] = rasters!(
    "bands.cub",
    "bands.lbl",
    "colours.ppm",
    "degrees.tif",
    "doubles.tif",
    "grey.pgm",
    "grey16.png",
    "interleaved.img",
    "interleaved.xml",
    "pds3.img",
    "pds4.img",
    "pds4.xml",
    "pixels.tif",
    "planes.tif",
    "sparse.tif",
    "square.asc",
    "square.prj",
    "strips.tif",
    "tiled.cub",
    "tiled.lbl",
    "tiles.tif",
    "wide.asc"
);
static FOLDER: LazyLock<Folder> = LazyLock::new(|| Folder::holding("rasters", &GOOD));

fuzz_target!(|data: &[u8]| FOLDER.with(data, |folder| {
    for (name, _) in GOOD {
        let Some(mut raster) = told(registry::image(&folder.join(name))) else { continue };
        assert!(raster.spacing_m().is_none_or(|m| m.iter().all(|m| *m > 0.0 && m.is_finite())));
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
