//! Pure shapes in f64: they know no light, file or sensor.

pub mod cell;
pub mod coplanar;
mod camera;
mod cluster;
mod copies;
mod defects;
mod direction;
mod groups;
mod hull;
mod index;
mod lens;
mod mesh;
mod overlay;
mod planetocentric;
mod polynomial;
pub mod polygon;
mod pose;
mod solid_angle;
mod sphere_image;
mod vectors;

pub use camera::{Camera, Drawn, Eye, FrameCamera, ParallelCamera, Projection};
pub use copies::Copies;
pub use defects::Defects;
pub use direction::{Direction, angle_rad, turn_rad};
pub(crate) use groups::{GroupSizes, Groups};
pub use hull::hull;
pub(crate) use index::{index_u32, whole, whole_u32};
pub use lens::{BrownConrady, Lens};
pub use mesh::{Facet, MaterialId, Mesh, NO_UV};
pub use overlay::{Chart, Overlay, Texels};
pub use planetocentric::{latitude_longitude_deg, planetocentric_deg};
pub(crate) use polynomial::polynomial;
pub use pose::{Pose, body_from_site};
pub use solid_angle::{signed_solid_angle_sr, solid_angle_off_surface_sr};
pub use sphere_image::{OUTLINE, QUADRATURE, SphereImage, SphereShown, nearest_on_triangle};
pub use vectors::Vectors;
