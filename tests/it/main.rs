//! The integration tests: one binary, one module for each kind of promise.

mod cli;
mod hazards;
mod oracles;
mod products;
mod sampler;
mod schema;
mod shapes;
