//! Files: one format, one module. Only here and in the command line is the disk touched.

pub mod convert;
pub mod dart;
pub mod envi;
pub mod exr_cube;
mod file_name;
pub mod folder;
mod foreign;
pub mod gltf;
pub mod ilwis;
mod input;
mod length;
pub mod located;
pub mod mtl;
pub mod npz;
mod number;
pub mod obj;
pub mod photometry_csv;
pub mod pixel;
mod picture;
pub mod quicklook;
pub mod radiance_map;
pub mod raster;
pub mod recipe_toml;
pub mod report_json;
pub mod response_csv;
pub mod scene_toml;
pub mod sli;
pub mod spectra;
pub mod spectrum_csv;
pub mod spectrum_svg;
pub mod surface;
mod spectral_table;
mod table;
pub mod xml;

pub use input::{InputFile, text};
pub use picture::picture;
