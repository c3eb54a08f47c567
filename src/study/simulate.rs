//! From a scene to what a camera sees of it, with an account of how good it is.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::integrate;
use crate::product::{Backplanes, Cube, FacetTable, Lit};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::solve;
use crate::visibility::Topology;

/// What a camera sees of a scene.
#[derive(Debug, Clone)]
pub struct Observation {
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

/// Solves a scene and looks at it.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn simulate(scene: &Scene, watch: Watch<'_>) -> Result<(FacetTable, Observation)> {
    let topology = Topology::new(&scene.mesh);
    let table = solve::solve(scene, &topology, watch)?;
    let observation = observe(scene, &topology, &table, watch)?;
    Ok((table, observation))
}

/// Looks at a scene whose facets have been solved.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if the table is not of this scene's mesh;
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn observe(scene: &Scene, topology: &Topology, table: &FacetTable, watch: Watch<'_>) -> Result<Observation> {
    let image = integrate::integrate(scene, topology, table, watch)?;
    let lit = |kind| table.sunlit.lit.iter().filter(|l| **l == kind).count() as u64;
    let counts = Counts {
        facets: scene.mesh.facets.len() as u64,
        zero_area_facets: (0..scene.mesh.facets.len()).filter(|f| scene.mesh.facet(*f).area_m2() == 0.0).count() as u64,
        flipped_facets: topology.flipped_facets as u64,
        open_edges: topology.open_edges as u64,
        lit_facets: lit(Lit::Full),
        partly_lit_facets: lit(Lit::Part),
        visible_facets: image.seen.iter().filter(|s| **s).count() as u64,
    };
    let checks = vec![Check {
        name: "areas in a pixel exceed the pixel by, pixels".into(),
        value: image.excess_px,
        limit: 1e-12,
    }];
    Ok(Observation {
        effects: vec![],
        warnings: vec![],
        checks,
        counts,
        cube: image.cube,
        backplanes: image.backplanes,
    })
}
