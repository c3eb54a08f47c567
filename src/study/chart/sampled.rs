//! Images by point sampling: rays through each pixel, and from where they end to each source.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::DVec3;
use rayon::prelude::*;

use super::shading::{Shading, Share};
use crate::error::Result;
use crate::geometry::{FrameCamera, SphereImage, SphereShown};
use crate::product::{FacetTable, Sees};
use crate::progress::{Watch, tell};
use crate::scene::{Scene, SunModel};
use crate::solve::{self, ImagePart};
use crate::visibility::RayTree;
use crate::visibility::{Seen, Shown};

/// Radiance of every pixel, `[band, pixel]`, by this many rays in each.
///
/// They are a Hammersley set (i / n, radical inverse of i), which has one ray in each of n equal boxes of any shape: the same in all pixels.
///
/// # Errors
/// Those of [`solve_sunlit`](solve::solve_sunlit).
pub fn by_rays(scene: &Scene, rays: u32, watch: Watch<'_>) -> Result<Vec<Vec<f64>>> {
    let facing = facing_the_sun(scene);
    let table = solve::solve_sunlit(scene, facing, watch)?;
    tell(watch, "rays", 0, 1)?;
    let tree = RayTree::new(&scene.body.mesh);
    let shading = Shading::new(scene, &table);
    let sources = towards(&table);
    let suns = suns(scene, rays);
    let sunlight = table.sources.first().map_or(&[][..], |sun| &sun.irradiance);
    let globes: Vec<SphereImage> = scene.globes_in_view().into_iter().map(|(_, seen)| seen).collect();
    // Rays are even over pixels, and their places are those of the drawing.
    let drawn = scene.exposure.camera.drawn();
    let cast = |at, area, sun: &DiscPoint, shares: &mut Vec<Share>| {
        cast((scene, &drawn.pinhole), &tree, (&sources, sun, sunlight), at, area, shares);
    };
    let places = places(rays);
    let [samples, lines] = [scene.exposure.camera.samples, scene.exposure.camera.lines];
    let (done, total) = (AtomicU64::new(0), u64::from(lines));
    let of_line = |line: u32| {
        let mut radiance = Vec::with_capacity(samples as usize);
        let mut shares = Vec::new();
        let mut shown = vec![SphereShown::default(); globes.len()];
        for sample in 0..samples {
            shares.clear();
            shown.fill(SphereShown::default());
            for ([x, y], sun) in places.iter().zip(suns.iter().cycle()) {
                let (at, area) = (drawn.at([f64::from(sample) + x, f64::from(line) + y]), 1.0 / f64::from(rays));
                match globe_before(&drawn.pinhole, &tree, &globes, at) {
                    Some((globe, cosine)) => shown[globe].add(area, &point(cosine)),
                    None => cast(at, area, sun, &mut shares),
                }
            }
            radiance.push(shading.pixel(&shares, &shown));
        }
        tell(watch, "rays", done.fetch_add(1, Relaxed) + 1, total)?;
        Ok(radiance)
    };
    let pixels: Vec<Vec<Vec<f64>>> = (0..lines).into_par_iter().map(of_line).collect::<Result<_>>()?;
    let pixels: Vec<Vec<f64>> = pixels.into_iter().flatten().collect();
    Ok((0..scene.exposure.bands.len()).map(|band| pixels.iter().map(|p| p[band]).collect()).collect())
}

/// Where on the Sun's disc a shadow ray goes.
#[derive(Debug, Clone, Copy)]
struct DiscPoint {
    towards: DVec3,
    /// How bright the disc is there, over its mean.
    brightness: f64,
}

/// One for each ray through a pixel: evenly spread over the disc; of a point Sun the same for all.
fn suns(scene: &Scene, rays: u32) -> Vec<DiscPoint> {
    let sun = &scene.sky.sun;
    let (u, (h, v)) = (sun.direction.vec(), sun.direction.frame());
    if scene.models.sun == SunModel::Point {
        return vec![DiscPoint { towards: u, brightness: 1.0 }];
    }
    let mut points: Vec<DiscPoint> = (0..rays)
        .map(|i| {
            // A single ray goes to the middle.
            let share = |base: u32| (inverse(i, base) + 0.5 / f64::from(rays)).fract();
            let radius = if rays == 1 { 0.0 } else { share(3).sqrt() };
            let turn = std::f64::consts::TAU * share(5);
            let [x, y] = [turn.cos(), turn.sin()].map(|x| sun.sin_radius() * radius * x);
            let cos = (1.0 - x * x - y * y).sqrt();
            let brightness = 1.0 - sun.limb_darkening * (1.0 - (1.0 - radius * radius).sqrt());
            DiscPoint { towards: u + (x * h + y * v) / cos, brightness }
        })
        .collect();
    let mean = points.iter().map(|point| point.brightness).sum::<f64>() / f64::from(rays);
    points.iter_mut().for_each(|point| point.brightness /= mean);
    points
}

/// The digits of a number, in reverse, after the point.
fn inverse(mut i: u32, base: u32) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while i > 0 {
        digit /= f64::from(base);
        value += digit * f64::from(i % base);
        i /= base;
    }
    value
}

/// The body of the sky that a ray through a point of the drawing meets before all facets, and the cosine of the Sun's incidence there. Of those it meets the
/// first in the list is in front.
fn globe_before(camera: &FrameCamera, tree: &RayTree, globes: &[SphereImage], at: [f64; 2]) -> Option<(usize, f64)> {
    let (globe, (along, cosine)) = globes.iter().enumerate().find_map(|(i, globe)| Some((i, globe.met(at)?)))?;
    let facet = tree.nearest(camera.centre_m(), camera.ray(at[0], at[1]));
    facet.is_none_or(|hit| along < hit.t).then_some((globe, cosine))
}

/// What one point shows of a globe.
fn point(cosine: f64) -> SphereShown {
    let faces = if cosine > 0.0 { 1.0 } else { 0.0 };
    SphereShown { area: 1.0, facing: faces, cosine: cosine.max(0.0) }
}

/// What a ray through a point of the drawing adds to a pixel; `sun` is where its shadow ray goes, and `sunlight` the facets' irradiance by all of the disc.
fn cast(
    (scene, camera): (&Scene, &FrameCamera),
    tree: &RayTree,
    (sources, sun, sunlight): (&[DVec3], &DiscPoint, &[f64]),
    at: [f64; 2],
    area: f64,
    shares: &mut Vec<Share>,
) {
    let (eye_m, ray) = (camera.centre_m(), camera.ray(at[0], at[1]));
    let Some(hit) = tree.nearest(eye_m, ray).filter(|hit| hit.front) else { return };
    let part = ImagePart { area, moment: at.map(|x| x * area) };
    let place = shares.iter().position(|share| share.facet == hit.facet).unwrap_or_else(|| {
        shares.push(Share {
            facet: hit.facet,
            shown: ImagePart::default(),
            lit: vec![ImagePart::default(); sources.len()],
        });
        shares.len() - 1
    });
    let share = &mut shares[place];
    share.shown.add(&part);
    // On the facet's plane, near its corners: not where the eye's distance was rounded.
    let facet = scene.body.mesh.facet(hit.facet as usize);
    let normal = facet.cross_m2();
    let point_m = eye_m + hit.t * ray;
    let point_m = point_m - (point_m - facet.corners_m[0]).dot(normal) / normal.length_squared() * normal;
    for (k, (towards, lit)) in sources.iter().zip(&mut share.lit).enumerate() {
        let towards = if k == 0 { sun.towards } else { *towards };
        let cos = normal.dot(towards) / normal.length();
        if cos <= 0.0 || tree.is_hidden(hit.facet, point_m, towards) {
            continue;
        }
        // A facet's irradiance is that of all of the disc above its horizon: this ray's share of it.
        let weight = if k == 0 && scene.models.sun != SunModel::Point {
            sun.brightness * cos / sunlight[hit.facet as usize]
        } else {
            1.0
        };
        if weight.is_finite() {
            lit.add(&part.scaled_to(weight * area));
        }
    }
}

/// Directions to the sources that are known by parts.
fn towards(table: &FacetTable) -> Vec<DVec3> {
    let by_parts = table.sources.iter().filter(|lighting| matches!(lighting.sees, Sees::Polygons(_)));
    by_parts.map(|lighting| lighting.field.towards(DVec3::ZERO)).collect()
}

/// Where rays go through a pixel.
fn places(rays: u32) -> Vec<[f64; 2]> {
    let half = 0.5 / f64::from(rays);
    // Reversed bits are a share of 2^32.
    let inverse = |i: u32| f64::from(i.reverse_bits()) / 4_294_967_296.0;
    (0..rays).map(|i| [f64::from(i) / f64::from(rays) + half, inverse(i) + half]).collect()
}

/// As if nothing cast a shadow: facets that face the Sun, or a part of its disc, are lit all over.
pub fn facing_the_sun(scene: &Scene) -> Seen {
    sunlit_facets(scene, |_| true)
}

/// Lit by one ray: facets that face the Sun, and from whose centroid nothing hides it, are lit all over.
pub fn lit_at_centroid(scene: &Scene, tree: &RayTree) -> Seen {
    let towards = scene.sky.sun.direction.vec();
    sunlit_facets(scene, |f| !tree.is_hidden(f, scene.body.mesh.facet(f as usize).centroid_m(), towards))
}

fn sunlit_facets(scene: &Scene, is_open: impl Fn(u32) -> bool + Sync) -> Seen {
    let (mesh, towards) = (&scene.body.mesh, scene.sky.sun.direction.vec());
    let facets = crate::geometry::index_u32(mesh.facets.len());
    let least_cos = if scene.models.sun == SunModel::Point { 0.0 } else { -scene.sky.sun.sin_radius() };
    let faces = |f: u32| {
        let normal = mesh.facet(f as usize).cross_m2();
        normal.dot(towards) > least_cos * normal.length()
    };
    let shown = |f: u32| match faces(f) && is_open(f) {
        true => Shown::Whole,
        false => Shown::Nothing,
    };
    Seen { shown: (0..facets).into_par_iter().map(shown).collect(), polygon_start: vec![0], ..Seen::default() }
}
