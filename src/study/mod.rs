//! Studies: what spans several layers. Takes values and callbacks, touches no disk.

mod effects;
mod maps;
mod partly_sky;
mod simulate;
mod site;
mod summary;
mod table_id;
pub mod validate;
mod warnings;

pub use effects::Effect;
pub use maps::{Fill, MapAccount, MapEntry, MapOptions, RegistrationEntry, observe_maps};
pub use simulate::{Check, Counts, Observation, has_room, memory_bytes, observe, product_bytes, simulate};
pub use summary::{Summary, summary};
pub use table_id::table_id;
