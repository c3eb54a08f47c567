//! Studies: what spans several layers. Takes values and callbacks, touches no disk.

mod closed_forms;
mod simulate;
pub mod validate;

pub use simulate::{Check, Counts, Effect, Observation, observe, simulate};
