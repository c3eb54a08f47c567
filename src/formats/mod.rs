//! Files: one format, one file or folder. Only here and in the command line is the disk touched.

mod input;
pub mod mtl;
pub mod obj;
mod picture;

pub use input::InputFile;
pub use picture::picture;
