//! A coarse preview: what a few rays of the camera hit, before the image is made.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Facet, FrameCamera, Mesh, whole_u32};
use crate::scene::Scene;

/// Rays along a side of the image: shares of the image are good to a percent or two.
const MOST_RAYS: u32 = 64;
/// Facets are processed this many at a time.
const CHUNK: usize = 65_536;

/// Rays through the middles of equal parts of the image, and the first facet that each meets.
pub(super) struct Glimpse {
    /// Line by line.
    met: Vec<Met>,
    /// Facets that the image's frame might hold, if nothing hides them.
    pub(super) facets_in_frame: u64,
    /// Whether some facet has its outer side to the Sun.
    pub(super) faces_sun: bool,
}

/// A facet on a ray's way.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Met {
    /// In lengths of the ray; infinite for the sky.
    along: f64,
    pub(super) facet: usize,
}

const SKY: Met = Met { along: f64::INFINITY, facet: usize::MAX };

impl Met {
    /// The nearer of two; of two at one place the first in the mesh, whatever the order they are found in.
    fn or(self, other: Met) -> Met {
        if (other.along, other.facet) < (self.along, self.facet) { other } else { self }
    }
}

/// The part of a glimpse that some facets make.
struct Part {
    met: Vec<Met>,
    facets_in_frame: u64,
    faces_sun: bool,
}

impl Glimpse {
    pub(super) fn new(scene: &Scene) -> Self {
        Self::through(scene, &scene.exposure.camera)
    }

    /// What another camera sees of a scene.
    pub(super) fn through(scene: &Scene, camera: &FrameCamera) -> Self {
        // Through a lens, of the cells that cover its pixels.
        let camera = &camera.drawn().pinhole;
        let counts = [camera.samples.min(MOST_RAYS), camera.lines.min(MOST_RAYS)];
        let blank = || Part { met: vec![SKY; (counts[0] * counts[1]) as usize], facets_in_frame: 0, faces_sun: false };
        let towards_sun = scene.sky.sun.direction.vec();
        let part = |chunk: usize| {
            let mut part = blank();
            for facet in chunk * CHUNK..scene.body.mesh.facets.len().min((chunk + 1) * CHUNK) {
                part.faces_sun |= scene.body.mesh.facet(facet).cross_m2().dot(towards_sun) > 0.0;
                part.look(&scene.body.mesh, facet, camera, counts);
            }
            part
        };
        let Part { met, facets_in_frame, faces_sun } =
            (0..scene.body.mesh.facets.len().div_ceil(CHUNK)).into_par_iter().map(part).reduce(blank, Part::with);
        Glimpse { met, facets_in_frame, faces_sun }
    }

    /// Share of the image that the surface fills.
    pub(super) fn filled(&self) -> f64 {
        self.met.iter().filter(|met| **met != SKY).count() as f64 / self.met.len() as f64
    }

    /// Share of what is seen that are facets from behind.
    pub(super) fn back_share(&self, scene: &Scene) -> f64 {
        let eye_m = scene.exposure.camera.centre_m();
        let is_back = |met: &&Met| {
            let facet = scene.body.mesh.facet(met.facet);
            facet.cross_m2().dot(eye_m - facet.corners_m[0]) < 0.0
        };
        let seen = self.met.iter().filter(|met| **met != SKY);
        let backs = seen.clone().filter(is_back).count();
        if backs > 0 { backs as f64 / seen.count() as f64 } else { 0.0 }
    }

    /// The facet of each ray that meets one.
    pub(super) fn facets(&self) -> impl Iterator<Item = usize> {
        self.met.iter().filter(|met| **met != SKY).map(|met| met.facet)
    }
}

/// Middle, pixels, of a part of `size` pixels in `count` parts.
fn middle(part: u32, size: u32, count: u32) -> f64 {
    (f64::from(part) + 0.5) * f64::from(size) / f64::from(count)
}

impl Part {
    fn with(mut self, other: Part) -> Part {
        self.met.iter_mut().zip(&other.met).for_each(|(met, other)| *met = met.or(*other));
        self.facets_in_frame += other.facets_in_frame;
        self.faces_sun |= other.faces_sun;
        self
    }

    /// Takes notice of a facet where rays meet it.
    fn look(&mut self, mesh: &Mesh, index: usize, camera: &FrameCamera, counts: [u32; 2]) {
        let Facet { corners_m } = mesh.facet(index);
        let axes = &camera.world_from_sensor.rotation;
        // Of the sensor: right, down, ahead.
        let [a, b, c] = corners_m.map(|p_m| axes.transpose() * (p_m - camera.centre_m()));
        let depths_m = [a.z, b.z, c.z];
        if depths_m.iter().all(|z_m| *z_m <= 0.0) {
            return;
        }
        let sizes = [camera.samples, camera.lines];
        let is_ahead = depths_m.iter().all(|z_m| *z_m > 0.0);
        let mut rays = counts.map(|count| 0..count);
        for k in 0..2 {
            // What crosses the plane of the camera may reach anywhere.
            if is_ahead {
                let at = [a, b, c].map(|p| p[k] / p.z / camera.pitch[k] + camera.boresight_px[k]);
                let (low, high) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
                if high <= 0.0 || low >= f64::from(sizes[k]) {
                    return;
                }
                let ray = |px: f64| px * f64::from(counts[k]) / f64::from(sizes[k]) - 0.5;
                rays[k] = whole_u32(ray(low).ceil())..counts[k].min(whole_u32(ray(high).floor() + 1.0));
            }
        }
        self.facets_in_frame += 1;
        let [columns, rows] = rays;
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let (edges, normal) = ([a.cross(b), b.cross(c), c.cross(a)], (b - a).cross(c - a));
        for row in rows {
            for column in columns.clone() {
                let [x, y] = [0, 1].map(|k| {
                    (middle([column, row][k], sizes[k], counts[k]) - camera.boresight_px[k]) * camera.pitch[k]
                });
                let ray = DVec3::new(x, y, 1.0);
                let sides = edges.map(|edge| edge.dot(ray));
                let along = normal.dot(a) / normal.dot(ray);
                let is_inside = sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
                if is_inside && along > 0.0 && along.is_finite() {
                    let met = &mut self.met[(row * counts[0] + column) as usize];
                    *met = met.or(Met { along, facet: index });
                }
            }
        }
    }
}
