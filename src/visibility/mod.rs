//! What is seen from where, exactly: geometry only, no wavelength.
//!
//! One engine serves the Sun (parallel rays: what it sees is lit) and cameras (rays through a point).
//! A mesh is [drawn](Drawing) once, its triangles are sorted into the cells of a grid, and each cell
//! is settled or resolved by [`Coverage`].

mod bins;
mod blocks;
mod bundles;
mod candidate;
mod coincident;
mod convex;
mod coverage;
mod covered;
mod detail;
mod drawing;
mod horizon;
mod in_view;
mod layers;
mod meetings;
mod on_facet;
mod partition;
mod penumbra;
mod ray_tree;
mod seen;
mod seen_through_lens;
mod seen_together;
mod topology;
mod visit;

pub use bins::for_each_cell_of as cells_of;
pub use bundles::Bundles;
pub use coverage::{Coverage, Scratch};
pub use covered::covered;
pub use drawing::{Drawing, Grid, Side, View};
pub use horizon::highest_horizons;
pub use in_view::FacetGroups;
pub use meetings::{Frame, Meeting, Scratch as LineScratch};
pub use on_facet::OnFacet;
pub use penumbra::Penumbra;
pub(crate) use ray_tree::TreeOrder;
pub use ray_tree::{Hit, RayTree};
pub use seen::{Seen, Shown};
pub(crate) use topology::TopologyParts;
pub use topology::{Enclosure, NONE, Topology};
pub use visit::Visit;
