//! Studies: what spans several layers. Takes values and callbacks, touches no disk.

mod closed_forms;
pub mod validate;
