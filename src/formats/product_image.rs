//! The images of a product folder, in whatever format they are there.

use std::path::{Path, PathBuf};

use super::container::Container;

/// The file of an image of a product, such as its `cube`: that of ENVI, or else that of another format; that of ENVI, too, if there is none.
pub fn product_image(folder: &Path, stem: &str) -> PathBuf {
    let named = |ending: &str| folder.join(format!("{stem}.{ending}"));
    let mut others = Container::ALL.iter().map(|container| named(container.ending()));
    let envi = named("img");
    if envi.is_file() { envi } else { others.find(|path| path.exists()).unwrap_or(envi) }
}
