//! DART: simulation folders and optical databases of the field's reference radiative transfer model.
//!
//! [`Simulation`] is what mmxrt understands of a simulation, in DART's own terms: everything meets there.

pub mod database;
mod diff;
mod folder;
mod frame;
mod from_scene;
pub mod groups;
mod inputs;
mod sidecar;
mod simulation;
#[cfg_attr(feature = "sqlite", path = "sqlite.rs")]
#[cfg_attr(not(feature = "sqlite"), path = "no_sqlite.rs")]
mod store;
mod to_scene;
mod write;

pub use diff::diff;
pub use folder::Folder;
pub use from_scene::{Options as FromSceneOptions, Package, Size, Surface, from_scene, group_names};
pub use inputs::{Target, inputs};
pub use sidecar::Sidecar;
pub use simulation::{
    Camera, Directions, Group, Links, Maket, Object, ObjectField, OpticalKind, OpticalProperty, Phase, Placement, Sequence,
    SequenceEntry, SequenceGroup, SequenceValues, Simulation, SpectralInterval, ThermalFunction, Version,
};
pub use to_scene::{Converted, Options as ToSceneOptions, to_scene};
pub use write::write;
