//! What is computed: facet tables, footprints, cubes, backplanes.

mod backplanes;
mod cube;
mod facet_table;
mod footprints;

pub use backplanes::{Backplanes, Plane};
pub use cube::Cube;
pub use facet_table::{FacetTable, Lit, Sunlit};
pub use footprints::Footprints;
