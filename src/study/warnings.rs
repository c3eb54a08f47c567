//! What a reader of a result should know, as sentences.

use super::effects::Account;
use super::simulate::Counts;
use crate::geometry::angle_rad;
use crate::integrate::Image;
use crate::physics::sun::Eclipse;
use crate::product::Lit;
use crate::visibility::Enclosure;

/// Less of the image than this may show facets from behind without a word: rims of open sheets do.
const BACK_SHARE: f64 = 0.01;

/// `uses_sun` says whether anything in the image is sunlight of this scene: if not, where the Sun stands is of no interest.
pub(super) fn warnings(
    account: &Account,
    counts: &Counts,
    image: &Image,
    enclosure: Enclosure,
    uses_sun: bool,
) -> Vec<String> {
    let mut all = Vec::new();
    all.extend(mars_in_view(account, image));
    let facets = |n: u64| if n == 1 { "1 facet".to_owned() } else { format!("{n} facets") };
    if counts.visible_facets == 0 {
        all.push("nothing is in view: no pixel sees a facet; check the observer's position and target, and the field of view".into());
    }
    if uses_sun && account.table.sunlit.lit.iter().all(|l| *l == Lit::Dark) {
        let rest = match (account.largest_mars_irradiance > 0.0, account.warmest_k > 0.0) {
            (false, false) => "the image is black",
            (false, true) => "what the image shows is heat",
            (true, false) => "what the image shows is Mars-light",
            (true, true) => "what the image shows is Mars-light and heat",
        };
        all.push(format!("nothing is lit: the Sun is below every facet or behind the terrain; {rest}"));
    }
    let covered_px: f64 = image.backplanes.plane("COVERAGE").map_or(0.0, |p| p.values.iter().sum());
    if image.back_area_px > BACK_SHARE * covered_px {
        all.push(format!(
            "{:.1} % of what the camera sees are facets from behind, which are black: the camera is under the terrain, or facets are inside out",
            100.0 * image.back_area_px / covered_px
        ));
    }
    all.extend(enclosed("the camera", enclosure));
    match account.eclipse.filter(|_| uses_sun) {
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
    if uses_sun && account.open_to_shadow > 0.0 {
        all.push(format!(
            "{:.1} % of the site might be shadowed by terrain outside it: from there, rays to the Sun leave the site below its highest point",
            100.0 * account.open_to_shadow
        ));
    }
    if counts.flipped_facets > 0 {
        all.push(format!(
            "{} with the inner side out, against their neighbours: seen from outside they are black",
            facets(counts.flipped_facets)
        ));
    }
    if counts.zero_area_facets > 0 {
        all.push(format!("{} without area: they neither shine nor block", facets(counts.zero_area_facets)));
    }
    if account.site.is_open && account.site.up.is_none() {
        all.push(format!("the body is not closed: {} open edges", counts.open_edges));
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

/// Mars is neither drawn nor does it hide anything: where it is in view the image shows the sky behind it, or the surface.
fn mars_in_view(account: &Account, image: &Image) -> Option<String> {
    let mars = account.scene.mars.as_ref()?;
    let camera = &account.scene.sensor.camera;
    let towards_m = mars.centre_m - camera.centre_m();
    let boresight = camera.world_from_sensor.rotation.z_axis;
    let corner_rad = angle_rad(boresight, camera.ray(0.0, 0.0));
    let mars_rad = (mars.radius_m / towards_m.length()).min(1.0).asin();
    if angle_rad(boresight, towards_m) > corner_rad + mars_rad {
        return None;
    }
    let range_m = image.backplanes.plane("RANGE")?;
    let (mut seen, mut before) = (0_u64, 0_u64);
    for (i, surface_m) in range_m.values.iter().enumerate() {
        let (x, y) = (i % camera.samples as usize, i / camera.samples as usize);
        let ray = camera.ray(x as f64 + 0.5, y as f64 + 0.5).normalize();
        let along_m = towards_m.dot(ray);
        let aside2_m2 = (towards_m - along_m * ray).length_squared();
        let half2_m2 = mars.radius_m * mars.radius_m - aside2_m2;
        if along_m > 0.0 && half2_m2 > 0.0 {
            let near_m = along_m - half2_m2.sqrt();
            // NaN: nothing but the sky is behind it.
            if surface_m.is_nan() {
                seen += 1;
            } else if near_m < *surface_m {
                before += 1;
            }
        }
    }
    let pixels = |n: u64| if n == 1 { "1 pixel".to_owned() } else { format!("{n} pixels") };
    match (seen, before) {
        (0, 0) => None,
        (_, 0) => Some(format!("Mars is in view and is not drawn: {} of it are black, as the sky", pixels(seen))),
        _ => Some(format!(
            "Mars is in view and is not drawn: {} of it are black, as the sky, and in {} it stands before the surface, which is shown through it",
            pixels(seen),
            pixels(before)
        )),
    }
}
