//! README.md and the book in `docs/`: every block of code is run, every link leads somewhere, and the reference of our own files is that of the schemas.

mod blocks;
mod links;
mod markdown;
mod reference;

use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
