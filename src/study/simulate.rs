//! From a scene to what a camera sees of it, with an account of how good it is.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Location, Result};
use crate::product::{Backplanes, Cube, FacetTable, Footprints};
use crate::progress::Watch;
use crate::scene::Scene;

/// What a camera sees of a scene.
#[derive(Debug, Clone)]
pub struct Observation {
    /// What was solved; `None` if a table was given.
    pub table: Option<FacetTable>,
    /// Which facets each pixel sees.
    pub footprints: Footprints,
    /// Radiance.
    pub cube: Cube,
    /// Images of geometry.
    pub backplanes: Backplanes,
    /// What was modelled, and what was not.
    pub effects: Vec<Effect>,
    /// What was verified of this very result.
    pub checks: Vec<Check>,
    /// What the mesh is like.
    pub counts: Counts,
    /// What a reader of the result should know, as sentences.
    pub warnings: Vec<String>,
}

/// Something that shapes the light, modelled or left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// Its name.
    pub name: String,
    /// Whether it is in the result.
    pub modelled: bool,
    /// At most so much would a pixel's radiance change, relative, with it (if left out) or without its
    /// approximations (if modelled); null: not known.
    pub bound: Option<f64>,
    /// How it is modelled, or why it is left out.
    pub note: String,
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

/// Solves the scene, unless a table already says what its facets receive, and looks at it.
///
/// # Errors
/// [`Error::Invalid`] if the table is not of this scene's mesh; [`Error::Interrupted`] if `watch` asks to stop.
pub fn simulate(_scene: &Scene, _table: Option<&FacetTable>, _watch: Watch<'_>) -> Result<Observation> {
    Err(Error::Unsupported { at: Location::default(), feature: "simulation".into() })
}
