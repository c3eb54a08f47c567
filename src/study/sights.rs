//! Facet coverage of an acquisition: the exact visible part of each facet, by the visibility code of images and
//! shadows, without an image.

use std::collections::BTreeMap;

use super::block::BLOCK;
use super::moving::Moving;
use super::warnings::{self, Sight as Shot};
use crate::error::Result;
use crate::geometry::polygon::{Point, Rect, area, area_and_moment, intersect, side, split};
use crate::geometry::{Facet, FrameCamera};
use crate::product::{Sight, Sights};
use crate::progress::{Watch, tell};
use crate::scene::{Scene, Take};
use crate::solve;
use crate::visibility::{FacetGroups, Seen, Shown};

/// What a stage of progress is called here.
const STAGE: &str = "sights";
/// All of a facet, (u, v).
const WHOLE: [Point; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
/// Smallest fraction of a facet that is not rounding of polygon differences.
const SLIVER: f64 = 1e-14;

/// Warnings about an acquisition's sightings: those of its image, as far as they follow from facets.
pub fn warnings_of_sights(sights: &Sights) -> Vec<String> {
    let dark = "nothing that is seen is in sunlight".to_owned();
    let is_dark = !sights.facet.is_empty() && sights.sunlit.iter().all(|share| *share == 0.0);
    let sight = Shot { sees_mesh: !sights.facet.is_empty(), back_share: 0.0, about: "" };
    warnings::of_sight(&sight, is_dark.then_some(dark))
}

/// What an acquisition sees: for a push-broom or whisk-broom what its parts see together, for others what the camera sees at the reference exposure. The Sun is
/// where it is at the reference exposure, and is a point; bodies of the sky hide it.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if where something is, is not known; [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks
/// to stop.
pub fn sights(moving: Moving<'_>, watch: Watch<'_>) -> Result<Sights> {
    let Moving { scene, timing, .. } = moving;
    let topology = scene.body.topology_watched(watch)?;
    let mut facets: BTreeMap<u32, Looks> = BTreeMap::new();
    if timing.readout.is_along_the_way() {
        let groups = FacetGroups::new(&scene.body.mesh);
        let takes: Vec<Take> = timing.takes(&scene.exposure).collect();
        for takes in takes.chunks(BLOCK) {
            let block = moving.block(takes, Some(&groups))?;
            for take in takes {
                let camera = moving.exposure(take)?.camera;
                let body = &block.body;
                let seen = Seen::from_camera(&body.mesh, body.topology(), &camera, STAGE, watch)?;
                add(&mut facets, scene, &seen, &camera, |facet| block.facet_of_body(facet));
            }
        }
    } else {
        let camera = &scene.exposure.camera;
        let seen = Seen::from_camera(&scene.body.mesh, topology, camera, STAGE, watch)?;
        add(&mut facets, scene, &seen, camera, |facet| facet);
    }
    let to_sun = scene.sky.sun.direction;
    let sunlit = Seen::from_afar(&scene.body.mesh, topology, to_sun, "sunlight", watch)?;
    let mut sights = Sights::default();
    for (facet, looks) in facets {
        let plane = scene.body.mesh.facet(facet as usize);
        let lit = match sunlit.shown[facet as usize] {
            Shown::Nothing => 0.0,
            _ if solve::is_eclipsed(&scene.sky, plane.centroid_m()) => 0.0,
            Shown::Whole => looks.seen(),
            Shown::Part => looks.seen_of(&sunlit, facet),
        };
        let seen = looks.seen();
        sights.push(Sight {
            facet,
            seen,
            sunlit: lit.min(seen),
            sampling_m: looks.sampling_m,
            incidence_deg: angle_deg(plane.normal().dot(to_sun.vec())),
            emission_deg: angle_deg(looks.cos_emission),
        });
    }
    tell(watch, STAGE, 1, 1)?;
    Ok(sights)
}

fn angle_deg(cosine: f64) -> f64 {
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Seen part of a facet: non-overlapping polygons (u, v), counter-clockwise; and the finest sampling.
struct Looks {
    polygons: Vec<Vec<Point>>,
    sampling_m: f64,
    cos_emission: f64,
}

/// Adds what a camera sees of each facet; `name` is the facet's number in the body.
fn add(facets: &mut BTreeMap<u32, Looks>, scene: &Scene, seen: &Seen, camera: &FrameCamera, name: impl Fn(u32) -> u32) {
    let pinhole = FrameCamera { lens: None, ..camera.clone() };
    for (i, shown) in (0_u32..).zip(&seen.shown).filter(|(_, shown)| **shown != Shown::Nothing) {
        let polygons: Vec<Vec<Point>> = match shown {
            Shown::Part => seen.polygons(i).map(counter_clockwise).collect(),
            _ => vec![WHOLE.to_vec()],
        };
        let facet = name(i);
        let (sampling_m, cos_emission) =
            sampling(&scene.body.mesh.facet(facet as usize), &polygons, (camera, &pinhole));
        match facets.get_mut(&facet) {
            None => _ = facets.insert(facet, Looks { polygons, sampling_m, cos_emission }),
            Some(looks) => {
                // Parts from one camera do not overlap; parts from two may.
                let before = looks.polygons.len();
                for polygon in polygons {
                    looks.add(polygon, before);
                }
                if sampling_m < looks.sampling_m {
                    (looks.sampling_m, looks.cos_emission) = (sampling_m, cos_emission);
                }
            }
        }
    }
}

fn counter_clockwise(polygon: &[Point]) -> Vec<Point> {
    let mut polygon = polygon.to_vec();
    if area(&polygon) < 0.0 {
        polygon.reverse();
    }
    polygon
}

/// Pixel size on a facet's plane, m, and the cosine of emission, in the middle of the visible part.
///
/// A pixel of pitch p, an angle a off the boresight, subtends p^2 cos^3 a, and at range r shows r^2 p^2 cos^3 a / cos e of the plane; a lens that
/// enlarges an area there makes that so much less. Of the camera, and of the same without its lens.
fn sampling(facet: &Facet, polygons: &[Vec<Point>], (camera, pinhole): (&FrameCamera, &FrameCamera)) -> (f64, f64) {
    let (mut sum, mut moment) = (0.0, [0.0; 2]);
    for polygon in polygons {
        let (area, of) = area_and_moment(polygon);
        (sum, moment) = (sum + area, [moment[0] + of[0], moment[1] + of[1]]);
    }
    let middle_m = facet.point_m(moment[0] / sum, moment[1] / sum);
    let to_camera = camera.centre_m() - middle_m;
    let range_m = to_camera.length();
    let cos_off = -to_camera.dot(camera.world_from_sensor.rotation.z_axis) / range_m;
    let cos_emission = facet.normal().dot(to_camera) / range_m;
    let lensed = pinhole.place(middle_m).and_then(|at| camera.lensed(at));
    let enlarged = lensed.map_or(1.0, |(_, by)| (by[0][0] * by[1][1] - by[0][1] * by[1][0]).abs());
    let sampling_m = range_m * camera.mean_pitch() * (cos_off.powi(3) / cos_emission / enlarged).sqrt();
    // Edge-on within rounding: undefined.
    (if sampling_m > 0.0 { sampling_m } else { f64::INFINITY }, cos_emission)
}

impl Looks {
    /// Fraction of the facet's area; (u, v) coordinates span a half.
    fn seen(&self) -> f64 {
        (2.0 * self.polygons.iter().map(|polygon| area(polygon)).sum::<f64>()).min(1.0)
    }

    /// Share of the facet's area that another eye sees too.
    fn seen_of(&self, other: &Seen, facet: u32) -> f64 {
        let (mut common, mut spare, mut sum) = (vec![], vec![], 0.0);
        for theirs in other.polygons(facet).map(counter_clockwise) {
            for ours in &self.polygons {
                intersect(ours, &theirs, &mut common, &mut spare);
                sum += 2.0 * area(&common).max(0.0);
            }
        }
        sum
    }

    /// Adds the part of a polygon that is not covered yet.
    fn add(&mut self, polygon: Vec<Point>, first: usize) {
        let mut rest = vec![polygon];
        for known in &self.polygons[..first] {
            let bounds = Rect::of(known);
            rest = rest.into_iter().flat_map(|piece| without(piece, known, &bounds)).collect();
            if rest.is_empty() {
                return;
            }
        }
        self.polygons.extend(rest);
    }
}

/// A convex polygon minus another, within `bounds`: the part beyond its first side, then of the rest that beyond the
/// second ...
fn without(polygon: Vec<Point>, other: &[Point], bounds: &Rect) -> Vec<Vec<Point>> {
    if !Rect::of(&polygon).overlaps(bounds) {
        return vec![polygon];
    }
    let (mut left, mut rest) = (Vec::new(), polygon.clone());
    for (i, a) in other.iter().enumerate() {
        let b = other[(i + 1) % other.len()];
        let sides: Vec<f64> = rest.iter().map(|p| side(*a, b, *p)).collect();
        let (mut inside, mut outside) = (vec![], vec![]);
        split(&rest, &sides, &mut inside, &mut outside);
        if 2.0 * area(&outside) > SLIVER {
            left.push(outside);
        }
        rest = inside;
        if rest.is_empty() {
            // They do not meet: one piece is better than several.
            return vec![polygon];
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(x: [f64; 2], y: [f64; 2]) -> Vec<Point> {
        vec![[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
    }

    /// Overlapping squares fill what both of them fill together, whichever comes first.
    #[test]
    fn polygons_of_several_looks_fill_their_union() {
        let unit = rectangle([0.0, 0.5], [0.0, 0.5]);
        let cases = [
            (rectangle([0.25, 0.75], [0.25, 0.75]), 0.25 + 0.25 - 0.0625),
            (rectangle([0.0, 0.5], [0.0, 0.5]), 0.25),
            (rectangle([0.1, 0.2], [0.1, 0.2]), 0.25),
            (rectangle([0.5, 0.7], [0.0, 0.5]), 0.35),
            (rectangle([0.8, 0.9], [0.8, 0.9]), 0.26),
            (vec![[0.25, -0.1], [0.6, 0.25], [0.25, 0.6], [-0.1, 0.25]], 0.25 + 4.0 * 0.01),
        ];
        for (other, expected) in cases {
            for [first, second] in [[&unit, &other], [&other, &unit]] {
                let mut looks = Looks { polygons: vec![first.clone()], sampling_m: 1.0, cos_emission: 1.0 };
                looks.add(second.clone(), 1);
                assert!((0.5 * looks.seen() - expected).abs() < 1e-15, "{other:?}: {} {expected}", 0.5 * looks.seen());
            }
        }
    }
}
