//! DART: simulation folders and optical databases of the field's reference radiative transfer model.
//!
//! [`Simulation`] is what mmxrt understands of a simulation, in DART's own terms: everything meets there.

mod simulation;

pub use simulation::{
    Camera, Directions, Group, Links, Maket, Object, OpticalKind, OpticalProperty, Phase, Simulation, SpectralInterval,
    ThermalFunction, Version,
};
