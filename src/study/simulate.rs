//! From a scene to what a camera sees of it, with an account of how good it is.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::effects::{Account, Effect};
use super::site::Site;
use super::warnings::warnings;
use crate::error::{Error, Location, Problem, Result};
use crate::geometry::polygon::area;
use crate::integrate::{self, Image};
use crate::physics::bounds;
use crate::product::{Backplanes, Cube, FacetTable, Lit, Sunlit};
use crate::progress::{Watch, tell};
use crate::scene::{MarsModel, Scene};
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
    fits(scene, table)?;
    let image = integrate::integrate(scene, topology, table, watch)?;
    tell(watch, "report", 0, 1)?;
    let site = Site::new(&scene.mesh, topology);
    let account = Account::new(scene, table, &site, &image.backplanes);
    let lit = |kind| table.sunlit.lit.iter().filter(|l| **l == kind).count() as u64;
    let counts = Counts {
        facets: scene.mesh.facets.len() as u64,
        zero_area_facets: site.zero_area_facets,
        flipped_facets: topology.flipped_facets as u64,
        open_edges: topology.open_edges as u64,
        lit_facets: lit(Lit::Full),
        partly_lit_facets: lit(Lit::Part),
        visible_facets: image.seen.iter().filter(|s| **s).count() as u64,
    };
    tracing::info!(?counts, "observed");
    let observation = Observation {
        effects: account.effects(),
        warnings: warnings(&account, &counts, &image),
        checks: checks(&account, &image),
        counts,
        cube: image.cube,
        backplanes: image.backplanes,
    };
    tell(watch, "report", 1, 1)?;
    Ok(observation)
}

/// Says if a table cannot be of a scene.
fn fits(scene: &Scene, table: &FacetTable) -> Result<()> {
    let facets = scene.mesh.facets.len();
    let columns = [
        ("sun_irradiance", table.sun_irradiance.len(), false),
        ("sunlit", table.sunlit.lit.len(), false),
        ("mars_irradiance", table.mars_irradiance.len(), true),
        ("temperature_lit_k", table.temperature_lit_k.len(), true),
        ("temperature_shaded_k", table.temperature_shaded_k.len(), true),
    ];
    let wrong = columns.into_iter().filter(|(_, n, may_be_empty)| *n != facets && !(*may_be_empty && *n == 0));
    let problem = |(name, n, _)| {
        Problem::new(Location::item(name), format!("has {n} values, but the scene has {facets} facets"))
            .with_help("the table is of another mesh: solve the scene again")
    };
    let problems: Vec<Problem> = wrong.map(problem).collect();
    if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
}

/// What must hold whatever the scene.
fn checks(account: &Account, image: &Image) -> Vec<Check> {
    let Account { scene, table, .. } = account;
    let check = |name: &str, value: f64, limit: f64| Check { name: name.to_owned(), value, limit };
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let bad = image.cube.weight.iter().chain(&image.cube.spectra).filter(|v| !v.is_finite()).count();
    let mut checks = vec![
        check("areas in a pixel exceed the pixel by, pixels", image.excess_px, 1e-12),
        check(
            "lit part of a facet exceeds the facet by, facets",
            (largest_lit_share(&table.sunlit) - 1.0).max(0.0),
            1e-9,
        ),
        check(
            "largest irradiance by the Sun, over that normal to its beam",
            largest(&table.sun_irradiance),
            1.0 + 1e-12,
        ),
        check("weights and spectra that are no finite number", bad as f64, 0.0),
    ];
    if scene.mars.as_ref().is_some_and(|m| m.model == MarsModel::NearField) {
        let bound = bounds::mars_light(1.0, account.mars_seen().0, 1.0);
        let name = "largest irradiance by Mars, over that of sunlight at its zenith on all of Mars";
        checks.push(check(name, account.largest_mars_irradiance / bound, 1.0));
    }
    checks
}

/// The largest share of a facet's area that its sunlit polygons fill, overlaps counted twice.
fn largest_lit_share(sunlit: &Sunlit) -> f64 {
    // Polygons are in the order of their facets.
    let (mut facet, mut sum, mut most) = (None, 0.0, 0.0_f64);
    for (of, bounds) in sunlit.polygon_facet.iter().zip(sunlit.polygon_start.windows(2)) {
        if facet != Some(of) {
            (facet, sum) = (Some(of), 0.0);
        }
        sum += 2.0 * area(&sunlit.uv[bounds[0] as usize..bounds[1] as usize]).abs();
        most = most.max(sum);
    }
    most
}
