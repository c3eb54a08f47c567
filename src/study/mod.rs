//! What spans several steps. Takes values and callbacks, touches no disk.

mod simulate;

pub use simulate::{Check, Counts, Effect, Observation, simulate};
