//! DART: simulation folders and optical databases of the field's reference radiative transfer model.
//!
//! [`Simulation`] is what mmxrt understands of a simulation, in DART's own terms: everything meets there.
//! [`from_scene`] and [`write()`] lead to DART, [`read()`] and [`to_scene`] back.

mod check;
pub mod database;
mod diff;
mod folder;
pub(super) mod format;
mod frame;
mod from_scene;
mod ground;
pub mod groups;
mod inputs;
pub(crate) mod kind;
mod mandatory;
mod object;
pub mod output;
mod place;
mod read;
mod sequencer;
mod sidecar;
mod simulation;
#[cfg_attr(feature = "sqlite", path = "sqlite.rs")]
#[cfg_attr(not(feature = "sqlite"), path = "no_sqlite.rs")]
mod store;
pub mod text_spectra;
mod to_scene;
mod write;

pub use check::{Finding, Severity, SummaryOf, TableSummary, check, no_summary};
pub use diff::{diff, differences};
pub use folder::Folder;
pub use from_scene::{ObjectGroup, ObjectMesh, Package, SimulationOptions, Size, add_flight, from_scene, group_names};
pub use inputs::{TargetVersion, inputs};
pub use place::{placed, scene_from_dart};
pub use read::sequence::{Step, flight, rows};
pub use read::{ReadOptions, read, terrain};
pub use sidecar::Sidecar;
pub use simulation::{
    CellTemperatures, Directions, FieldInstance, Group, Links, Maket, Object, ObjectField, OpticalKind,
    OpticalProperty, Phase, Pinhole, Sequence, SequenceEntry, SequenceGroup, SequenceValues, Simulation,
    SpectralInterval, ThermalFunction, Topography, Version,
};
pub use to_scene::{Converted, SceneOptions, to_scene};
pub(super) use to_scene::{MARS, has_mars};
pub use write::write;
