//! The integration tests: one binary, one module for each kind of promise.

mod cli;
mod hazards;
mod malformed_scene;
mod oracles;
mod products;
mod report;
mod sampler;
mod scene_files;
mod schema;
mod shapes;
