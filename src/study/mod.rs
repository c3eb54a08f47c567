//! Studies: work that spans several layers. Takes values and callbacks, does not access the disk.

pub mod chart;
pub mod coregister;
mod acquisition;
mod block;
mod coarser;
mod cost;
mod draft;
mod drafting;
mod dry_run;
mod effects;
mod extremes;
mod glimpse;
pub mod knowledge;
pub mod locate;
mod map_light;
mod maps;
mod moments;
mod moving;
mod observation;
pub mod over_cube;
mod partly_sky;
mod ortho;
mod orientation;
mod plan;
pub mod portrait;
mod reading;
mod resolved_slopes;
mod sights;
mod simulate;
mod site;
mod smear;
mod spectrometer;
pub mod stability;
mod summary;
mod surface_map;
mod surfaces;
mod table_id;
mod through_optics;
pub mod validate;
mod warnings;

pub use acquisition::{acquire_by_maps, acquire_by_slabs, acquire_by_table};
pub use coarser::Coarser;
pub use cost::{Looks, WITHIN, has_room, has_room_for, memory_bytes, product_bytes};
pub use dry_run::{DryRun, dry_run};
pub use effects::{Bound, Decision, Effect, OwnTolerance, StageShare, tell_correction, tell_instrument};
pub use extremes::Extremes;
pub use locate::{check_band, reference_band};
pub use maps::{Fill, MapAccount, MapEntry, MapOptions, RegistrationEntry, observe_maps, observe_maps_by_slabs};
pub use moving::Moving;
pub use observation::{Check, Counts, Observation, Put};
pub use orientation::Orientation;
pub use ortho::{MapWish, ortho};
pub use plan::{Choice, Plan, Request, TOLERANCE, decide, left_out_of_table, looks_s, plan, unheeded};
pub use reading::{BandSignal, GOOD, Reader, Reading};
pub use sights::{sights, warnings_of_sights};
pub use simulate::{observe, observe_by_slabs, observe_through, simulate};
pub use smear::{foreseen, poses, tell_exposure};
pub use summary::Summary;
pub use surface_map::SurfaceMap;
pub use surfaces::{
    FactorEntry, NumberEntry, PhaseCurve, PresetEntry, REFERENCE_DEG, SurfaceEntry, surface_of_material,
    surface_of_preset,
};
pub use table_id::{mesh_id, table_id};
