//! What is computed, here or elsewhere: facet tables, radiance maps, footprints, cubes, backplanes.

mod added;
mod planes;
mod coverage;
mod cube;
mod exposures;
mod facet_table;
mod filling;
mod footprints;
mod map_grid;
mod quantity;
mod radiance_map;
mod reflected;
mod shown_bands;
mod sights;
mod texel_weights;

pub use added::Added;
pub use coverage::{Coverage, CoverageRule, SurfaceShare};
pub use cube::{Cube, CubeAxes, Slab};
pub use exposures::{Exposed, Exposures};
pub(crate) use facet_table::warmest_k;
pub use facet_table::{FacetTable, Lighting, Sampling, SamplingError, Sees};
pub use filling::Filling;
pub use footprints::Footprints;
pub use map_grid::{CellPart, MapGrid, Projection};
pub use planes::{Backplanes, Plane};
pub use quantity::{Conversion, Quantity};
pub use radiance_map::{Atlas, Patches, Placement, RadianceMap, Registration, SkyShare, TexelSource, ViewImage};
pub use reflected::{Reflected, ReflectedPart};
pub use shown_bands::ShownBands;
pub use sights::{Sight, Sights};
pub use texel_weights::{TexelLine, TexelWeights};
