//! glTF 2.0, as text (`.gltf`) and binary (`.glb`): meshes with texture coordinates, and the names and colours of their materials.
//!
//! **Axes.** glTF has y up and metres; here z is up: (x, y, z) = (x, -z, y) of glTF, as `up = "y"` does in a scene file. So the
//! body's north, or a site's zenith, is up in every viewer.
//!
//! **Digits.** glTF stores positions as f32: 0.5 mm at 10 km. A mesh that is farther from its origin than it is large is written around its
//! middle, which is the node's `translation`, and so keeps its shape in every reader. Beside positions stands an attribute of our own,
//! `_POSITION_RESIDUAL` (VEC3 of f32): the position minus its f32. Their sum is good to 1e-14 of the position; a reader that does not know
//! the attribute ignores it. Node transforms are read in f64.
//!
//! **Extensions.** Read are `KHR_mesh_quantization`, `EXT_mesh_gpu_instancing`, `KHR_node_visibility`, the colours of
//! `KHR_materials_pbrSpecularGlossiness`, and of `KHR_lights_punctual` the direction of the brightest directional light, which is the Sun. What
//! moves or adds no geometry is ignored and reported; an extension that is not known is refused, also where the file calls it optional.
//!
//! **Colours.** A material without a colour is white, as glTF specifies.
//!
//! **Names.** `extras.origin_m` of a scene (or of `asset`) is the scene's origin in the body-fixed frame, m, in our axes;
//! `extras.spectral_material` of a material is its entry in the dictionary, where that is not its `name`.

mod accessor;
mod container;
mod extensions;
pub(super) mod format;
mod instances;
mod json;
mod read;
mod write;

pub use read::{parse, read};
pub use write::{Encoded, encode};

/// Position minus its f32.
const RESIDUAL: &str = "_POSITION_RESIDUAL";
