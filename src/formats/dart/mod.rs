//! DART: simulation folders and optical databases of the field's reference radiative transfer model.
//!
//! [`Simulation`] is what mmxrt understands of a simulation, in DART's own terms: everything meets there.

mod check;
mod folder;
pub mod groups;
mod read;
mod simulation;

pub use check::{Coverage, CoverageOf, Finding, Severity, check, no_coverage};
pub use folder::Folder;
pub use read::sequence::{Step, flight, rows};
pub use read::{Options as ReadOptions, read, terrain};
pub use simulation::{
    Camera, Directions, Group, Links, Maket, Object, ObjectField, OpticalKind, OpticalProperty, Phase, Placement,
    Sequence, SequenceEntry, SequenceGroup, SequenceValues, Simulation, SpectralInterval, ThermalFunction, Version,
};
