//! What a reader of a result should know, as sentences.

use glam::DVec3;

use super::effects::by_mars;
use super::observation::Counts;
use super::resolved_slopes;
use super::site::Site;
use crate::geometry::angle_rad;
use crate::integrate::Image;
use crate::physics::sun::Eclipse;
use crate::product::FacetTable;
use crate::scene::{Scene, Setup, Sky};
use crate::visibility::Enclosure;
use crate::visibility::Shown;

/// Up to this share of the image may show facets from behind without a warning: rims of open sheets do.
const BACK_SHARE: f64 = 0.01;

/// What is known about an image, or from a few rays before it is made.
pub(super) struct Sight {
    /// Whether anything of the mesh is in view.
    pub(super) sees_mesh: bool,
    /// Share of what is seen that are facets from behind.
    pub(super) back_share: f64,
    /// Mars in view.
    pub(super) mars: MarsInView,
    /// Said before numbers that are not exact.
    pub(super) about: &'static str,
}

/// Warnings that need the image. `uses_sun` says whether anything in it is sunlight of this scene: if not, where the Sun stands is of
/// no interest.
pub(super) fn of_image(
    (scene, table): (&Scene, &FacetTable),
    counts: &Counts,
    image: &Image,
    uses_sun: bool,
) -> Vec<String> {
    let covered_px: f64 = image.backplanes.plane("COVERAGE").map_or(0.0, |p| p.values.iter().sum());
    let camera = &scene.exposure.camera;
    let samples = camera.samples as usize;
    let ranges_m = image.backplanes.plane("RANGE").map_or(&[][..], |plane| &plane.values);
    let rays = ranges_m.iter().enumerate().map(|(i, range_m)| {
        // NaN: nothing but the sky is behind it.
        let range_m = if range_m.is_nan() { f64::INFINITY } else { *range_m };
        (camera.ray((i % samples) as f64 + 0.5, (i / samples) as f64 + 0.5), range_m)
    });
    let sight = Sight {
        sees_mesh: counts.visible_facets > 0,
        back_share: if covered_px > 0.0 { image.back_area_px / covered_px } else { 0.0 },
        mars: MarsInView::new(scene, rays, 1.0),
        about: "",
    };
    let sunlit = table.sunlit();
    let is_dark = uses_sun && sunlit.is_none_or(|sunlit| sunlit.shown.iter().all(|shown| *shown == Shown::Nothing));
    let beams = table
        .sources
        .iter()
        .filter(|lighting| ![Sky::SUN, Sky::MARS, Sky::MARS_HEAT].contains(&lighting.source.as_str()));
    let is_any = |values: &[f64]| values.iter().any(|value| *value > 0.0);
    let others = [
        ("Mars-light", table.of(Sky::MARS).is_some_and(|mars| is_any(&mars.irradiance))),
        ("other beams", beams.map(|lighting| &lighting.irradiance).any(|irradiance| is_any(irradiance))),
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
    all.extend(sight.mars.told(sight.about));
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
    match by_mars(scene).filter(|_| uses_sun) {
        Some(Eclipse::Total) if scene.models.eclipses => all.push("the site is in eclipse: Mars covers the Sun".into()),
        Some(Eclipse::Partial) if scene.models.eclipses => {
            all.push("the site is in partial eclipse: Mars covers part of the Sun's disc".into());
        }
        Some(Eclipse::Total) => {
            all.push("the site is in eclipse: Mars covers the Sun, but the image is lit as if it did not".into())
        }
        Some(Eclipse::Partial) => {
            all.push(
                "the site is in partial eclipse: Mars covers part of the Sun, but the image is lit as if it did not"
                    .into(),
            );
        }
        _ => {}
    }
    if uses_sun && open_to_shadow > 0.0 {
        all.push(format!(
            "{:.1} % of the site might be shadowed by terrain outside it: from there, rays to the Sun leave the site below its highest point",
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

/// Mars in view, pixels. It is neither drawn nor does it hide anything: where it is in view the image shows the sky behind it, or
/// the surface.
#[derive(Default)]
pub(super) struct MarsInView {
    /// Before the sky.
    sky_px: f64,
    /// Before the surface.
    surface_px: f64,
}

impl MarsInView {
    /// From rays of the camera, each with the range of the surface that it meets, m, or infinity; each stands for `ray_px` pixels.
    pub(super) fn new(scene: &Setup, rays: impl Iterator<Item = (DVec3, f64)>, ray_px: f64) -> Self {
        let mut found = MarsInView::default();
        let Some(mars) = &scene.sky.mars else { return found };
        let camera = &scene.exposure.camera;
        let towards_m = mars.centre_m - camera.centre_m();
        let boresight = camera.world_from_sensor.rotation.z_axis;
        let mars_rad = (mars.radius_m / towards_m.length()).min(1.0).asin();
        if angle_rad(boresight, towards_m) > camera.half_cone_rad() + mars_rad {
            return found;
        }
        for (ray, surface_m) in rays {
            let ray = ray.normalize();
            let along_m = towards_m.dot(ray);
            let aside2_m2 = (towards_m - along_m * ray).length_squared();
            let half2_m2 = mars.radius_m * mars.radius_m - aside2_m2;
            if along_m > 0.0 && half2_m2 > 0.0 {
                let near_m = along_m - half2_m2.sqrt();
                if surface_m.is_infinite() {
                    found.sky_px += ray_px;
                } else if near_m < surface_m {
                    found.surface_px += ray_px;
                }
            }
        }
        found
    }

    fn told(&self, about: &str) -> Option<String> {
        let pixels = |n: f64| if n == 1.0 { "1 pixel".to_owned() } else { format!("{about}{n:.0} pixels") };
        let sky = pixels(self.sky_px);
        match (self.sky_px > 0.0, self.surface_px > 0.0) {
            (false, false) => None,
            (_, false) => Some(format!("Mars is in view and is not drawn: {sky} of it are black, like the sky")),
            _ => Some(format!(
                "Mars is in view and is not drawn: {sky} of it are black, like the sky, and in {} it stands in front of the surface, which shows through it",
                pixels(self.surface_px)
            )),
        }
    }
}
