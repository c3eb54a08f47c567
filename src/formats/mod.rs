//! Files: one format, one file or folder. Only here and in the command line is the disk touched.

mod input;
pub mod located;
pub mod mtl;
pub mod obj;
mod picture;
pub mod scene_toml;
pub mod spectrum_csv;

pub use input::InputFile;
pub use picture::picture;
