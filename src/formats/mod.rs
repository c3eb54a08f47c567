//! Files: one format, one module. Nothing else in the library touches the disk.

pub mod envi;
pub mod exr_cube;
pub mod folder;
pub mod npz;
pub mod quicklook;
pub mod report_json;
