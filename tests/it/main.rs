//! The integration tests: one binary, one module for each kind of promise.

mod hazards;
mod oracles;
mod sampler;
mod shapes;
