//! DART: simulation folders and optical databases of the field's reference radiative transfer model.
//!
//! [`Simulation`] is what mmxrt understands of a simulation, in DART's own terms: everything meets there.

pub mod database;
mod folder;
pub mod groups;
pub(crate) mod kind;
mod read;
mod simulation;
#[cfg_attr(feature = "sqlite", path = "sqlite.rs")]
#[cfg_attr(not(feature = "sqlite"), path = "no_sqlite.rs")]
mod store;
pub mod text_spectra;

pub use folder::Folder;
pub use read::sequence::{Step, flight, rows};
pub use read::{Options, read, terrain};
pub use simulation::{
    Camera, Directions, Group, Links, Maket, Object, ObjectField, OpticalKind, OpticalProperty, Phase, Placement,
    Sequence, SequenceEntry, SequenceGroup, SequenceValues, Simulation, SpectralInterval, ThermalFunction, Version,
};
