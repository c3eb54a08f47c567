//! From a scene to what a camera sees of it, with an account of how good it is.

use super::cost::has_room;
use super::draft::Draft;
use super::effects::{Given, effects_in, mars_seen};
use super::extremes::{Extremes, sunlit_places};
use super::observation::{Check, Counts, Observation, Put};
use super::surfaces::surfaces;
use super::through_optics::{Blurs, Seen, serves};
use super::warnings;
use crate::error::Result;
use crate::instrument::Optics;
use crate::integrate::{self, Image, Wanted};
use crate::physics::bounds;
use crate::product::{Backplanes, FacetTable, Slab};
use crate::progress::{Watch, tell};
use crate::scene::{MarsModel, Scene, Sky};
use crate::solve;
use crate::visibility::Shown;

/// Solves a scene and looks at it.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn simulate(scene: &Scene, watch: Watch<'_>) -> Result<(FacetTable, Observation)> {
    let table = solve::solve(scene, watch)?;
    let observation = observe(scene, &table, Wanted::default(), watch)?;
    Ok((table, observation))
}

/// Looks at a scene whose facets have been solved.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if the table is not of this scene, or memory cannot hold the image;
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn observe(scene: &Scene, table: &FacetTable, wanted: Wanted<'_>, watch: Watch<'_>) -> Result<Observation> {
    let extremes = Extremes::new(scene);
    let make = |put: Put<'_>| Ok((observe_by_slabs(scene, (table, &extremes), wanted, put, watch)?, ()));
    Ok(Observation::held(scene, make)?.0)
}

/// As [`observe`], but `put` takes the slabs of the cube as they are made: for a frame camera one.
///
/// # Errors
/// As [`observe`], and what `put` says.
pub fn observe_by_slabs(
    scene: &Scene,
    (table, extremes): (&FacetTable, &Extremes),
    wanted: Wanted<'_>,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<Observation<()>> {
    observe_through(scene, (table, extremes), None, wanted, put, watch)
}

/// As [`observe_by_slabs`], through optics, if there are any: the radiance is what they let through, all else of the scene itself.
///
/// # Errors
/// As [`observe_by_slabs`].
pub fn observe_through(
    scene: &Scene,
    (table, extremes): (&FacetTable, &Extremes),
    optics: Option<&Optics>,
    wanted: Wanted<'_>,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<Observation<()>> {
    table.fits(scene)?;
    has_room(scene, false, None)?;
    serves(optics, &scene.exposure)?;
    let image = integrate::integrate(scene, table, wanted, watch)?;
    let (observation, slab) = account_for(scene, (table, extremes), image, None, true, watch)?;
    match optics {
        None => put(slab)?,
        Some(optics) => {
            let seen = Seen { poses: std::slice::from_ref(scene), table, optics };
            seen.by_slabs(&Blurs::new(optics, &scene.exposure), put, watch)?;
        }
    }
    Ok(observation)
}

/// An account of how good an image is, and its radiance.
pub(super) fn account_for(
    scene: &Scene,
    (table, extremes): (&FacetTable, &Extremes),
    image: Image,
    along: Option<&Backplanes>,
    uses_sun: bool,
    watch: Watch<'_>,
) -> Result<(Observation<()>, Slab)> {
    tell(watch, "report", 0, 1)?;
    let site = &extremes.site;
    let sunlit = sunlit_places(scene, &image.backplanes);
    let given = Given::new(scene, extremes, &sunlit);
    // Of maps, what is not solved is not in it yet.
    let is_whole = uses_sun && image.maps.is_none();
    let draft = is_whole.then(|| Draft::of_image(scene, &image, |um, light| given.median_at(um, light)));
    let given = given.with_draft(draft.as_ref());
    let shown = table.sunlit().map_or(&[][..], |sunlit| &sunlit.shown);
    let lit = |kind| shown.iter().filter(|l| **l == kind).count() as u64;
    let counts = Counts {
        facets: scene.body.mesh.facets.len() as u64,
        zero_area_facets: site.zero_area_facets,
        flipped_facets: scene.body.topology().flipped_facets as u64,
        open_edges: scene.body.topology().open_edges as u64,
        lit_facets: lit(Shown::Whole),
        partly_lit_facets: lit(Shown::Part),
        visible_facets: image.seen.iter().filter(|s| **s).count() as u64,
    };
    tracing::info!(?counts, "observed");
    let observation = Observation {
        effects: effects_in(&given, table),
        warnings: [
            scene.remarks(),
            warnings::of_image(table, &counts, (&image, along), uses_sun),
            warnings::of_scene(scene, site, extremes.open_to_shadow, uses_sun),
            warnings::of_light_between(scene, table),
        ]
        .concat(),
        checks: checks(scene, table, extremes, &image),
        counts,
        surfaces: if uses_sun { surfaces(scene, site) } else { vec![] },
        cube: (),
        backplanes: image.backplanes,
        footprints: image.footprints,
        exposures: None,
    };
    tell(watch, "report", 1, 1)?;
    Ok((observation, image.slab))
}

/// What must hold whatever the scene.
fn checks(scene: &Scene, table: &FacetTable, extremes: &Extremes, image: &Image) -> Vec<Check> {
    let check = |name: &str, value: f64, limit: f64| Check { name: name.to_owned(), value, limit };
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let Slab { weight, spectra, added, .. } = &image.slab;
    let bad = weight.iter().chain(spectra).chain(&added.radiance).filter(|v| !v.is_finite()).count();
    let mut checks = vec![
        check(
            "areas in a pixel exceed the pixel by, pixels",
            image.excess_px,
            1e-12_f64.max(scene.exposure.camera.rounding_px()),
        ),
        check("lit part of a facet reaches beyond it by, sizes of the scene", largest_lit_excess(scene, table), 1e-11),
        check(
            "largest irradiance by the Sun, over that normal to its beam",
            table.sources.first().map_or(0.0, |sun| largest(&sun.irradiance)),
            1.0 + 1e-12,
        ),
        check("weights and spectra that are not finite", bad as f64, 0.0),
    ];
    if scene.sky.mars.is_some() && scene.models.mars_light == MarsModel::NearField {
        let bound = bounds::mars_light(1.0, mars_seen(scene, extremes).0, 1.0);
        let mars = table.of(Sky::MARS).map_or(0.0, |mars| largest(&mars.irradiance));
        let name = "largest irradiance by Mars, over that of sunlight at its zenith on all of Mars";
        checks.push(check(name, mars / bound, 1.0));
    }
    checks
}

/// How far the sunlit polygons of a facet reach beyond it, overlaps counted twice: by so much they would have to stick out all around
/// to have as much too much area. As the Sun sees it, over the size of the scene, which is where they are rounded; so a facet seen
/// edge-on is judged like any other.
fn largest_lit_excess(scene: &Scene, table: &FacetTable) -> f64 {
    let Some(sunlit) = table.sunlit() else { return 0.0 };
    let Some((low_m, high_m)) = scene.body.mesh.bounds_m() else { return 0.0 };
    let size_m = (high_m - low_m).length();
    let excess = |facet: u32, share: f64| {
        let facet = scene.body.mesh.facet(facet as usize);
        let towards = scene.sky.sun.direction.vec();
        let [a, b, c] = facet.corners_m;
        let around_m: f64 =
            [b - a, c - b, a - c].iter().map(|edge| edge.reject_from_normalized(towards).length()).sum();
        let area_m2 = 0.5 * facet.cross_m2().dot(towards).abs();
        if around_m > 0.0 { (share - 1.0) * area_m2 / around_m / size_m } else { 0.0 }
    };
    // Polygons are in the order of their facets.
    let (mut facet, mut sum, mut most) = (None, 0.0, 0.0_f64);
    for (i, of) in sunlit.polygon_facet.iter().enumerate() {
        if facet != Some(of) {
            (facet, sum) = (Some(of), 0.0);
        }
        sum += sunlit.filled(i);
        if sum > 1.0 {
            most = most.max(excess(*of, sum));
        }
    }
    most
}
