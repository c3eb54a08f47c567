//! What a space camera sees of a small body: exact facet-to-pixel hyperspectral image simulation.

// Lowest layer first: a module uses only those above it in this list (tests/it/layers.rs).
pub mod error;
pub mod progress;
pub mod units;
pub mod geometry;
pub mod visibility;
pub mod spectral;
pub mod physics;
pub mod scene;
pub mod landscape;
pub mod product;
pub mod solve;
pub mod integrate;
pub mod study;
pub mod formats;

pub use error::{Error, Location, Problem, Result};
