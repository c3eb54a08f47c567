//! What a camera sees of a scene, and the account that is given of it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::effects::Effect;
use super::surfaces::SurfaceEntry;
use crate::error::Result;
use crate::product::{Backplanes, Cube, CubeAxes, Exposures, Footprints, Slab};
use crate::scene::Scene;

/// What a camera sees of a scene.
#[derive(Debug, Clone)]
pub struct Observation<C = Cube> {
    /// Radiance; `()` if its slabs were handed on as they were made.
    pub cube: C,
    /// Images of geometry.
    pub backplanes: Backplanes,
    /// Which facets each pixel sees, if that was wanted.
    pub footprints: Option<Footprints>,
    /// What was taken when, of a scene that moves meanwhile.
    pub exposures: Option<Exposures>,
    /// What was modelled, and what was not.
    pub effects: Vec<Effect>,
    /// What was verified of this very result.
    pub checks: Vec<Check>,
    /// What the mesh is like.
    pub counts: Counts,
    /// How its materials reflect.
    pub surfaces: Vec<SurfaceEntry>,
    /// What a reader of the result should know, as sentences.
    pub warnings: Vec<String>,
}

/// Takes slabs of an observation's cube as they are made.
pub type Put<'a> = &'a mut dyn FnMut(Slab) -> Result<()>;

impl Observation<()> {
    /// With all slabs of its cube held together.
    pub(super) fn held<T>(
        scene: &Scene,
        make: impl FnOnce(Put<'_>) -> Result<(Observation<()>, T)>,
    ) -> Result<(Observation, T)> {
        let mut slabs = Vec::new();
        let mut put = |slab| {
            slabs.push(slab);
            Ok(())
        };
        let (made, more) = make(&mut put)?;
        let Observation { cube: (), backplanes, footprints, exposures, effects, checks, counts, surfaces, warnings } =
            made;
        let cube = Cube::new(CubeAxes::of(&scene.exposure), slabs)?;
        Ok((Observation { cube, backplanes, footprints, exposures, effects, checks, counts, surfaces, warnings }, more))
    }
}

/// Something that must hold for a result to be right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// What must hold.
    pub name: String,
    /// What was found.
    pub value: f64,
    /// The largest value that is good.
    pub limit: f64,
}

impl Check {
    /// Whether it holds.
    pub fn passed(&self) -> bool {
        self.value <= self.limit
    }
}

/// What the mesh is like, and how it is lit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Counts {
    /// Facets.
    pub facets: u64,
    /// Facets without area: they neither shine nor block.
    pub zero_area_facets: u64,
    /// Facets whose neighbours have the other side out.
    pub flipped_facets: u64,
    /// Edges with a facet on one side only.
    pub open_edges: u64,
    /// Facets lit all over.
    pub lit_facets: u64,
    /// Facets lit in part.
    pub partly_lit_facets: u64,
    /// Facets that some pixel sees.
    pub visible_facets: u64,
}
