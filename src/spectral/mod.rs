//! Wavelength: tables of values, bands, and means over a band. Always um.

mod band;
mod spectrum;

pub use band::Band;
pub use spectrum::{Extend, Spectrum};
