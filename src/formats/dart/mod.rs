//! DART: simulation folders and optical databases of the field's reference radiative transfer model.
//!
//! [`Simulation`] is what mmxrt understands of a simulation, in DART's own terms: everything meets there.

pub mod database;
mod simulation;
#[cfg_attr(feature = "sqlite", path = "sqlite.rs")]
#[cfg_attr(not(feature = "sqlite"), path = "no_sqlite.rs")]
mod store;

pub use simulation::{
    Camera, Directions, Group, Links, Maket, Object, OpticalKind, OpticalProperty, Phase, Simulation, SpectralInterval,
    ThermalFunction, Version,
};
