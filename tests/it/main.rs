//! The integration tests, as one binary.

mod products;
mod schema;
