//! What a reader of a result should know, as sentences.

use super::effects::{by_globes, whose};
use super::observation::Counts;
use super::resolved_slopes;
use super::site::Site;
use crate::integrate::Image;
use crate::physics::sun::Eclipse;
use crate::product::{Backplanes, FacetTable, Plane};
use crate::scene::{Scene, Sky};
use crate::solve::spectra_error;
use crate::visibility::Enclosure;
use crate::visibility::Shown;

/// Up to this share of the image may show facets from behind without a warning: rims of open sheets do.
const BACK_SHARE: f64 = 0.01;

/// Light between facets may be so far off without a warning, in some colour over the most of it: less than by sampling.
const SPECTRA_ERROR: f64 = 0.01;

/// What is known about an image, or from a few rays before it is made.
pub(super) struct Sight {
    /// Whether anything of the mesh is in view.
    pub(super) sees_mesh: bool,
    /// Share of what is seen that are facets from behind.
    pub(super) back_share: f64,
    /// Said before numbers that are not exact.
    pub(super) about: &'static str,
}

/// Warnings that need the image. `uses_sun` says whether anything in it is sunlight of this scene: if not, where the Sun stands is of
/// no interest. `along` are the planes of an image taken line by line: the whole frame may look elsewhere.
pub(super) fn of_image(
    table: &FacetTable,
    counts: &Counts,
    (image, along): (&Image, Option<&Backplanes>),
    uses_sun: bool,
) -> Vec<String> {
    let coverage = |planes: &Backplanes| planes.plane("COVERAGE").map_or(0.0, |p| p.values.iter().sum());
    let covered_px: f64 = coverage(&image.backplanes);
    let sight = Sight {
        sees_mesh: counts.visible_facets > 0 || along.is_some_and(|along| coverage(along) > 0.0),
        back_share: if covered_px > 0.0 { image.back_area_px / covered_px } else { 0.0 },
        about: "",
    };
    let sunlit = table.sunlit();
    let is_dark = uses_sun && sunlit.is_none_or(|sunlit| sunlit.shown.iter().all(|shown| *shown == Shown::Nothing));
    let beams = table
        .sources
        .iter()
        .filter(|lighting| ![Sky::SUN, Sky::MARS, Sky::MARS_HEAT].contains(&lighting.source.as_str()));
    let is_any = |values: &[f64]| values.iter().any(|value| *value > 0.0);
    let is_globe = |plane: &Plane| plane.name.starts_with(Backplanes::GLOBE) && is_any(&plane.values);
    let others = [
        ("Mars-light", table.of(Sky::MARS).is_some_and(|mars| is_any(&mars.irradiance))),
        ("other beams", beams.map(|lighting| &lighting.irradiance).any(|irradiance| is_any(irradiance))),
        ("bodies of the sky", along.unwrap_or(&image.backplanes).planes.iter().any(is_globe)),
        ("heat", is_any(&table.temperature_lit_k) || is_any(&table.temperature_shaded_k)),
    ];
    let others: Vec<&str> = others.into_iter().filter(|other| other.1).map(|other| other.0).collect();
    let rest = match others[..] {
        [] => "the image is black".to_owned(),
        _ => format!("what the image shows is {}", others.join(" and ")),
    };
    let dark = format!("nothing is lit: the Sun is below every facet or behind the terrain; {rest}");
    of_sight(&sight, is_dark.then_some(dark))
}

/// Warnings that follow from a sight; `dark` says that nothing is lit.
pub(super) fn of_sight(sight: &Sight, dark: Option<String>) -> Vec<String> {
    let mut all = Vec::new();
    if !sight.sees_mesh {
        all.push("nothing is in view: no pixel sees a facet; check the observer's position and target, and the field of view".into());
    }
    all.extend(dark);
    if sight.back_share > BACK_SHARE {
        all.push(format!(
            "{}{:.1} % of what the camera sees is the back of facets, which is black: the camera is under the terrain, or facets are inside out",
            sight.about,
            100.0 * sight.back_share
        ));
    }
    all
}

/// Warnings that follow from the scene alone. `open_to_shadow` is the share of the site that terrain outside it might shadow; `uses_sun` is as
/// for [`of_image`].
pub(super) fn of_scene(scene: &Scene, site: &Site, open_to_shadow: f64, uses_sun: bool) -> Vec<String> {
    let mut all = Vec::new();
    let facets = |n: u64| if n == 1 { "1 facet".to_owned() } else { format!("{n} facets") };
    all.extend(enclosed(
        "the camera",
        scene.body.topology().enclosure(&scene.body.mesh, scene.exposure.camera.centre_m()),
    ));
    match by_globes(scene).filter(|_| uses_sun) {
        Some(Eclipse::Total) if scene.models.eclipses => {
            all.push(format!("the site is in eclipse: {} covers the Sun", whose(scene)))
        }
        Some(Eclipse::Partial) if scene.models.eclipses => {
            all.push(format!("the site is in partial eclipse: {} covers part of the Sun's disc", whose(scene)));
        }
        Some(Eclipse::Total) => all.push(format!(
            "the site is in eclipse: {} covers the Sun, but the image is lit as if it did not",
            whose(scene)
        )),
        Some(Eclipse::Partial) => {
            all.push(format!(
                "the site is in partial eclipse: {} covers part of the Sun, but the image is lit as if it did not",
                whose(scene)
            ));
        }
        _ => {}
    }
    if uses_sun && open_to_shadow > 0.0 {
        all.push(format!(
            "{:.1} % of what the image shows might be shadowed by terrain outside the mesh: from there, rays to the Sun leave the mesh below its highest point",
            100.0 * open_to_shadow
        ));
    }
    if uses_sun {
        all.extend(resolved_slopes::warnings(scene));
    }
    if scene.body.topology().coincident_facets > 0 {
        let lie = if scene.body.topology().coincident_facets == 1 { "lies" } else { "lie" };
        all.push(format!(
            "{} {lie} on others, with the same side out: is a mesh, or a part of one, given twice? Of each pair the one whose material comes first is seen",
            facets(scene.body.topology().coincident_facets as u64)
        ));
    }
    if scene.body.topology().flipped_facets > 0 {
        all.push(format!(
            "{} turned inside out, unlike their neighbours: seen from outside they are black",
            facets(scene.body.topology().flipped_facets as u64)
        ));
    }
    if site.zero_area_facets > 0 {
        all.push(format!("{} without area: they neither shine nor block", facets(site.zero_area_facets)));
    }
    if site.is_open && site.up.is_none() {
        let of_those = if scene.body.topology().coincident_facets > 0 {
            ", including those of facets that lie on others"
        } else {
            ""
        };
        all.push(format!("the body is not closed: {} open edges{of_those}", scene.body.topology().open_edges));
    }
    all
}

/// Warnings about light between facets, which a table knows at a few wavelengths.
pub(super) fn of_light_between(scene: &Scene, table: &FacetTable) -> Vec<String> {
    let error = spectra_error(scene, table);
    let warning = || {
        format!(
            "light between facets is known at {} wavelengths, and up to {:.1} % off in these bands: solve the scene with them",
            table.reflected.len(),
            100.0 * error
        )
    };
    if error > SPECTRA_ERROR { vec![warning()] } else { vec![] }
}

/// Says that an eye is inside closed parts of the mesh, or on them.
pub(super) fn enclosed(whose: &str, enclosure: Enclosure) -> Option<String> {
    let where_is = match (enclosure.inside, enclosure.on) {
        (0, 0) => return None,
        (0, 1) => "on the surface of a closed part of the mesh".to_owned(),
        (0, on) => format!("on the surface of {on} closed parts of the mesh"),
        (1, _) => "inside a closed part of the mesh".to_owned(),
        (inside, _) => format!("inside {inside} closed parts of the mesh"),
    };
    Some(format!("{whose} is {where_is}: it sees inner sides, which are dark and hide what is behind them"))
}
