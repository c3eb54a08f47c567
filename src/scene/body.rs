//! What is looked at: a surface, and the same surface once it is checked.

use std::ops::Deref;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use glam::DVec3;

use super::{FARTHEST_M, Material, Texture};
use crate::error::{Error, Location, Problem, Result};
use crate::geometry::Mesh;
use crate::physics::reflectance::{DirectionalAlbedos, Separated};
use crate::progress::{Watch, tell};
use crate::visibility::{RayTree, Topology};

/// A facet's number and one of its edges are kept in 31 bits.
pub(crate) const MOST_FACETS: usize = 1 << 29;

/// Relative error that the albedo in an emissivity may have by being separated.
const EMISSIVITY_TOLERANCE: f64 = 1e-6;

/// A surface and what it is made of: plain, unchecked values.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Origin of all local coordinates, in the body-fixed frame, m.
    pub origin_m: DVec3,
    /// Facets, local to the origin, axes of the body-fixed frame.
    pub mesh: Mesh,
    /// What they are made of; facets refer to it by index.
    pub materials: Vec<Material>,
    /// Variation of reflectance inside facets: at most one texture for a material.
    pub textures: Vec<Texture>,
}

/// A surface that has been checked. Clones share it: one body serves any number of skies and exposures.
#[derive(Clone)]
pub struct Body(Arc<Checked>);

struct Checked {
    surface: Surface,
    bounds_m: Option<(DVec3, DVec3)>,
    topology: OnceLock<Topology>,
    ray_tree: OnceLock<RayTree>,
    // Parts of a body are made of the same.
    albedos: Arc<Albedos>,
}

/// What follows from the materials alone, found when it is first asked for.
#[derive(Default)]
struct Albedos {
    absorbing: OnceLock<Vec<Option<Absorbing>>>,
    emitting: OnceLock<Vec<Option<(Separated, DirectionalAlbedos)>>>,
    glow: Mutex<Option<Glow>>,
}

/// What materials radiate.
struct Glow {
    /// Wavelengths, um, and weights of each band.
    bands: Vec<Vec<(f64, f64)>>,
    temperatures_k: Vec<f64>,
    radiance: Arc<[f64]>,
}

/// What a material absorbs by incidence: a table, and the factor of its weights.
type Absorbing = (DirectionalAlbedos, f64);

impl Body {
    /// Checks a surface.
    ///
    /// # Errors
    /// [`Error::Invalid`] with everything that is missing or out of range.
    pub fn new(surface: Surface) -> Result<Self> {
        let problems = surface.problems();
        if problems.is_empty() { Ok(Body::checked(surface)) } else { Err(Error::Invalid(problems)) }
    }

    /// Of a surface that has no [problems](Surface::problems).
    pub(super) fn checked(surface: Surface) -> Self {
        Body::of(surface, Arc::default())
    }

    fn of(surface: Surface, albedos: Arc<Albedos>) -> Self {
        let bounds_m = surface.mesh.bounds_m();
        Body(Arc::new(Checked { surface, bounds_m, topology: OnceLock::new(), ray_tree: OnceLock::new(), albedos }))
    }

    /// Some of its facets, ascending, as a body: of the same materials, and each facet's face is that which it had.
    #[must_use]
    pub fn part(&self, facets: &[u32]) -> Self {
        let texture = |texture: &Texture| {
            let corners = facets.iter().filter_map(|facet| texture.corners.get(*facet as usize).copied()).collect();
            Texture { corners, ..texture.clone() }
        };
        let surface = Surface {
            origin_m: self.origin_m,
            mesh: self.mesh.part(facets),
            materials: self.materials.clone(),
            textures: self.textures.iter().map(texture).collect(),
        };
        Body::of(surface, self.0.albedos.clone())
    }

    /// Lowest and highest coordinates of its facets, local, m; `None` if it has none.
    pub fn bounds_m(&self) -> Option<(DVec3, DVec3)> {
        self.0.bounds_m
    }

    /// Of each material the directional albedo that its Bond albedo gives a model, as a table and the factor of its weights: found when it is first asked for.
    pub fn absorbing(&self) -> &[Option<(DirectionalAlbedos, f64)>] {
        let of = |material: &Material| material.photometry.model()?.absorbing(material.bond_albedo);
        self.0.albedos.absorbing.get_or_init(|| self.materials.iter().map(of).collect())
    }

    /// Of each material whose emissivity follows from its model: the model as products, and the directional albedo of each. Found when it is first asked for.
    pub fn emitting(&self) -> &[Option<(Separated, DirectionalAlbedos)>] {
        let of = |material: &Material| {
            let model = material.photometry.model().filter(|_| material.has_kirchhoff_emissivity())?;
            let separated = model.separated(EMISSIVITY_TOLERANCE);
            let albedos = DirectionalAlbedos::new(&separated);
            Some((separated, albedos))
        };
        self.0.albedos.emitting.get_or_init(|| self.materials.iter().map(of).collect())
    }

    /// What its materials radiate in some bands, of which each has wavelengths, um, and weights, at some temperatures, as `found` says: kept until others are asked
    /// for, as poses of an exposure and lines that follow one another ask for the same.
    pub(crate) fn glow(
        &self,
        bands: Vec<Vec<(f64, f64)>>,
        temperatures_k: &[f64],
        found: impl FnOnce(&[Vec<(f64, f64)>]) -> Vec<f64>,
    ) -> Arc<[f64]> {
        // It is whole whenever the lock is free, whatever became of who held it.
        let mut kept = self.0.albedos.glow.lock().unwrap_or_else(PoisonError::into_inner);
        match &*kept {
            Some(glow) if glow.temperatures_k == temperatures_k && glow.bands == bands => glow.radiance.clone(),
            _ => {
                let radiance: Arc<[f64]> = found(&bands).into();
                *kept = Some(Glow { bands, temperatures_k: temperatures_k.to_vec(), radiance: radiance.clone() });
                radiance
            }
        }
    }

    /// What hangs together with what: found when it is first asked for.
    pub fn topology(&self) -> &Topology {
        self.0.topology.get_or_init(|| Topology::new(&self.mesh))
    }

    /// The same, as a stage of its own if it has yet to be found.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if `watch` asks to stop.
    pub fn topology_watched(&self, watch: Watch<'_>) -> Result<&Topology> {
        if self.0.topology.get().is_none() {
            tell(watch, "topology", 0, 1)?;
        }
        Ok(self.topology())
    }

    /// What was found before of a mesh that is equal.
    pub(crate) fn take_topology(&self, found: Topology) {
        if found.neighbour.len() == self.mesh.facets.len() {
            let _ = self.0.topology.set(found);
        }
    }

    /// Where rays meet it: made when it is first asked for.
    pub fn ray_tree(&self) -> &RayTree {
        self.0.ray_tree.get_or_init(|| RayTree::new(&self.mesh))
    }

    /// One of a mesh that is equal.
    pub(crate) fn take_ray_tree(&self, tree: RayTree) {
        let _ = self.0.ray_tree.set(tree);
    }

    /// The surface, to be changed and checked again: copied only if others share it.
    pub fn into_surface(self) -> Surface {
        Arc::try_unwrap(self.0).map_or_else(|shared| shared.surface.clone(), |checked| checked.surface)
    }
}

impl Deref for Body {
    type Target = Surface;

    fn deref(&self) -> &Surface {
        &self.0.surface
    }
}

impl std::fmt::Debug for Body {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Body").field(&self.0.surface).finish()
    }
}

impl Surface {
    /// What is wrong with it, whatever the sky and exposure.
    pub(super) fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem = |item: &str, message: String| {
            problems.push(Problem::new(Location::item(item), message));
        };
        let mesh = &self.mesh;
        if mesh.facets.is_empty() {
            problem("mesh", "has no facets".into());
        }
        if mesh.facets.len() > MOST_FACETS {
            problem("mesh", format!("{} facets are more than the {MOST_FACETS} there may be", mesh.facets.len()));
        }
        if mesh.material.len() != mesh.facets.len() {
            problem("mesh", format!("{} facets, but {} materials of facets", mesh.facets.len(), mesh.material.len()));
        }
        if let Some(i) = mesh.vertices_m.iter().position(|v| !v.is_finite()) {
            problem("mesh", format!("vertex {i} (counted from 0) is not finite"));
        }
        let far = |v: &DVec3| v.is_finite() && v.abs().max_element() > FARTHEST_M;
        if let Some(i) = mesh.vertices_m.iter().position(far) {
            problem("mesh", format!("vertex {i} (counted from 0) is more than {FARTHEST_M:e} m from the origin"));
        }
        super::near_enough("origin_m", self.origin_m, &mut problem);
        let vertices = mesh.vertices_m.len();
        if let Some(i) = mesh.facets.iter().position(|f| f.iter().any(|v| *v as usize >= vertices)) {
            problem("mesh", format!("facet {i} (counted from 0) refers to a vertex beyond the {vertices} there are"));
        }
        if let Some(i) = mesh.material.iter().position(|m| m.0 as usize >= self.materials.len()) {
            problem("mesh", format!("facet {i} (counted from 0) has no material"));
        }
        for material in &self.materials {
            material.check(&mut problem);
        }
        for (i, texture) in self.textures.iter().enumerate() {
            let item = self.item_of(texture);
            texture.check(mesh, &self.materials, |message| problem(&item, message));
            if self.textures[..i].iter().any(|t| t.material == texture.material) {
                problem(&item, "a material has at most one texture".into());
            }
        }
        problems
    }

    /// What a texture is called in messages.
    pub(super) fn item_of(&self, texture: &Texture) -> String {
        let name = self.materials.get(texture.material.0 as usize).map_or("", |m| m.name.as_str());
        format!("materials.{name:?}.texture")
    }
}
