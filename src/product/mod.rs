//! What is computed, here or elsewhere: facet tables, radiance maps, footprints, cubes, backplanes.

mod backplanes;
mod cube;
mod facet_table;
mod footprints;
mod radiance_map;
mod texel_weights;

pub use backplanes::{Backplanes, Plane};
pub use cube::{Cube, Slab};
pub use facet_table::{FacetTable, Lighting, Sees};
pub use footprints::Footprints;
pub use radiance_map::{Atlas, Patches, Placement, RadianceMap, Registration, SkyShare, TexelSource, ViewImage};
pub use texel_weights::{TexelLine, TexelWeights};
