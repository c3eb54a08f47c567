//! Wavelength: tables of values, bands, and means over a band. Always um.

mod band;
mod library;
mod light;
mod matching;
pub mod sinc_squared;
mod solar;
mod spectrum;

pub use band::{ALL_UM, Band, MOST_BEYOND, Response};
pub use library::{Column, SpectralLibrary};
pub use light::{KnownLight, Light};
pub use matching::{Mix, Mixes, mixes};
pub use solar::{SunTotal, solar_e490, solar_mean, sunlight_share};
pub use spectrum::{Extend, Spectrum, between};
