//! Looks maps up, pixel by pixel, and says what they leave to others.

use super::choice::{ViewChoice, views_shares};
use super::lookup::{Lookup, TexelLayout};
use super::together::{Together, differ};
use super::{MapView, Maps, Unknown};
use crate::geometry::{Eye, FrameCamera, angle_rad};
use crate::integrate::parts::Polygons;
use crate::integrate::pixel::{Entry, Pixel};
use crate::product::TexelLine;
use crate::scene::Scene;
use crate::solve::ImagePart;
use crate::visibility::Drawing;

/// What is known of a facet stands for the rest of it if it is at least this share; less is no better than what its pixel knows,
/// and rounding would be multiplied.
const LEAST_KNOWN: f64 = 0.01;
/// Of a texel that is hidden all over, subtraction leaves less than this, pixels.
const REMAINDER: f64 = 1e-15;
/// What a line of the image says of maps.
#[derive(Debug, Default)]
pub(in crate::integrate) struct MapLine {
    /// For each term and map.
    pub(in crate::integrate) weights: Vec<Vec<TexelLine>>,
    /// For each term.
    pub(in crate::integrate) unknown: Vec<Vec<f64>>,
    pub(in crate::integrate) unfilled: Vec<Vec<f64>>,
    pub(in crate::integrate) area: Vec<f64>,
    /// Angle between the directions of map and camera, deg; NaN if no map has one, or nothing is seen.
    pub(in crate::integrate) angle_deg: Vec<f64>,
    /// Share of what is seen that all terms know.
    pub(in crate::integrate) coverage: Vec<f64>,
    pub(in crate::integrate) quadrature_error: f64,
}

/// Looks maps up, pixel by pixel.
pub(in crate::integrate) struct PixelTexels<'a> {
    scene: &'a Scene,
    /// The pinhole of the drawing.
    camera: FrameCamera,
    terms: Vec<Vec<Lookup<'a>>>,
    together: Together,
    choice: ViewChoice,
    unknown: Unknown,
    /// Of the entry at hand: see [`PixelTexels::measure_angles`] and [`measure_shares`].
    angles: Vec<Vec<f64>>,
    shares: Vec<f64>,
    /// Lit area of the entry at hand that no map knows, for each source known by parts.
    lit_rest: Vec<f64>,
    parts: Vec<ImagePart>,
}

impl<'a> PixelTexels<'a> {
    pub(in crate::integrate) fn new(
        scene: &'a Scene,
        drawing: &'a Drawing<'a>,
        maps: &'a Maps<'a>,
        polygons: &'a [Vec<Option<Polygons<'a>>>],
    ) -> Self {
        let lookups = |(views, polygons): (&'a Vec<MapView<'a>>, &'a Vec<Option<Polygons<'a>>>)| {
            let one = |(view, polygons): (&'a MapView<'a>, &'a Option<Polygons<'a>>)| {
                Lookup::new(scene, drawing, view, polygons.as_ref(), maps.texels)
            };
            views.iter().zip(polygons).map(one).collect()
        };
        let terms: Vec<Vec<Lookup>> = maps.terms.iter().zip(polygons).map(lookups).collect();
        let angles = terms.iter().map(|views| vec![f64::NAN; views.len()]).collect();
        let (together, choice, unknown) = (Together::default(), maps.choice, maps.unknown);
        let camera = scene.exposure.camera.drawn().pinhole;
        PixelTexels {
            scene,
            camera,
            terms,
            together,
            choice,
            unknown,
            angles,
            shares: vec![],
            lit_rest: vec![],
            parts: vec![],
        }
    }

    pub(in crate::integrate) fn new_line(&mut self, rows: [u32; 2]) -> MapLine {
        for lookup in self.terms.iter_mut().flatten() {
            lookup.new_line(rows);
        }
        MapLine {
            weights: self.terms.iter().map(|t| vec![TexelLine::default(); t.len()]).collect(),
            unknown: vec![vec![]; self.terms.len()],
            unfilled: vec![vec![]; self.terms.len()],
            ..MapLine::default()
        }
    }

    /// Adds what a pixel sees, whose pieces have been sorted. `solved(entry, area, lit)` is called with what is left for the scene's own
    /// sources: of the entry, and of what each lights that is known by parts.
    pub(in crate::integrate) fn gather(
        &mut self,
        pixel: &mut Pixel,
        line: &mut MapLine,
        mut solved: impl FnMut(&Entry, f64, &[ImagePart]),
    ) {
        let mut front = 0.0;
        let (mut angle_sum, mut angle_area) = (0.0, 0.0);
        let (mut unknown, mut unfilled) = (vec![0.0; self.terms.len()], vec![0.0; self.terms.len()]);
        for index in 0..pixel.entries.len() {
            let entry = pixel.entries[index];
            if !entry.front {
                continue;
            }
            front += entry.shown.area;
            self.measure_angles(pixel, &entry);
            let angles = &self.angles;
            let wants_lit = self.unknown == Unknown::Solved;
            for (t, views) in self.terms.iter_mut().enumerate() {
                views.iter_mut().for_each(|lookup| lookup.look(pixel, index, wants_lit));
                let is_divided = differ(views, &angles[t], self.choice, entry.shown.area);
                let most = if is_divided {
                    let together = &mut self.together;
                    together.look(pixel, index, views, &angles[t], self.choice, wants_lit);
                    self.lit_rest.clone_from(&together.lit_rest);
                    together.area.iter().sum::<f64>().min(entry.shown.area)
                } else {
                    let knows_most = views.iter().max_by(|a, b| a.seen.area.total_cmp(&b.seen.area));
                    let Some(Lookup { seen, lit, .. }) = knows_most else { continue };
                    let most = seen.area.min(entry.shown.area);
                    let known = |light: usize| if most > 0.0 { lit[light].area } else { 0.0 };
                    let rest = |light: usize| pixel.lit_part(&entry, light).area - known(light);
                    self.lit_rest.clear();
                    self.lit_rest.extend((0..lit.len()).map(rest));
                    most
                };
                let rest = entry.shown.area - most.max(0.0);
                unknown[t] += rest;
                let target = match self.unknown {
                    Unknown::Mean if most >= LEAST_KNOWN * entry.shown.area => entry.shown.area,
                    Unknown::Mean => 0.0,
                    Unknown::Left | Unknown::Solved => most.max(0.0),
                };
                unfilled[t] += entry.shown.area - target;
                if rest > 0.0 && self.unknown == Unknown::Solved {
                    let parts = self
                        .lit_rest
                        .iter()
                        .map(|lit| ImagePart { area: lit.clamp(0.0, rest), ..ImagePart::default() });
                    self.parts.clear();
                    self.parts.extend(parts);
                    solved(&entry, rest, &self.parts);
                }
                if target <= 0.0 {
                    continue;
                }
                if is_divided {
                    let scale = target / self.together.area.iter().sum::<f64>();
                    for (view, texel, weight) in &self.together.texels {
                        views[*view].sums.add(*texel, scale * weight);
                    }
                    for (area, angle) in self.together.area.iter().zip(&angles[t]).filter(|(_, a)| a.is_finite()) {
                        angle_sum += scale * area * angle;
                        angle_area += scale * area;
                    }
                    continue;
                }
                measure_shares(views, &angles[t], self.choice, &mut self.shares);
                let known: f64 = self.shares.iter().zip(views.iter()).map(|(g, v)| g * v.seen.area).sum();
                for ((lookup, share), angle) in views.iter_mut().zip(&self.shares).zip(&angles[t]) {
                    if *share == 0.0 {
                        continue;
                    }
                    let scale = share * target / known;
                    let Lookup { seen, sums, .. } = lookup;
                    seen.texels.iter().for_each(|(texel, weight)| sums.add(*texel, scale * weight));
                    if angle.is_finite() {
                        angle_sum += scale * lookup.seen.area * angle;
                        angle_area += scale * lookup.seen.area;
                    }
                }
            }
        }
        for (views, weights) in self.terms.iter_mut().zip(&mut line.weights) {
            for (lookup, weights) in views.iter_mut().zip(weights) {
                weights.row_start.push(weights.texel.len());
                lookup.sums.drain(|texel, weight| {
                    if weight > REMAINDER {
                        weights.texel.push(texel);
                        weights.weight.push(weight);
                    }
                });
                line.quadrature_error = line.quadrature_error.max(lookup.quadrature_error);
            }
        }
        let most_unknown = unknown.iter().copied().fold(0.0, f64::max);
        line.coverage.push(if front > 0.0 { ((front - most_unknown) / front).clamp(0.0, 1.0) } else { f64::NAN });
        line.angle_deg.push(if angle_area > 0.0 { (angle_sum / angle_area).to_degrees() } else { f64::NAN });
        line.area.push(front);
        line.unknown.iter_mut().zip(unknown).for_each(|(line, u)| line.push(u));
        line.unfilled.iter_mut().zip(unfilled).for_each(|(line, u)| line.push(u));
    }

    /// For each term and map the angle between its direction and that to the camera, rad, where what is seen of a facet lies.
    fn measure_angles(&mut self, pixel: &Pixel, entry: &Entry) {
        let [x, y] = entry.centroid(&pixel.site.rect);
        let camera = &self.camera;
        let ray = camera.ray(x, y);
        let facet = self.scene.body.mesh.facet(entry.facet as usize);
        let point_m = camera.centre_m() + facet.met_by(camera.centre_m(), ray) * ray;
        let of = |lookup: &Lookup| match lookup.kind {
            TexelLayout::View(image, ..) => match image.camera.eye() {
                Eye::At(eye_m) => angle_rad(eye_m - point_m, -ray),
                Eye::Towards(direction) => angle_rad(direction.vec(), -ray),
            },
            _ => f64::NAN,
        };
        for (angles, views) in self.angles.iter_mut().zip(&self.terms) {
            angles.iter_mut().zip(views).for_each(|(angle, lookup)| *angle = of(lookup));
        }
    }
}

/// How much each map counts for a facet, relative to each other. One that knows less than [`LEAST_KNOWN`] of what the best one
/// knows does not count; one without a direction only if no other does.
fn measure_shares(views: &[Lookup], angles: &[f64], choice: ViewChoice, shares: &mut Vec<f64>) {
    shares.clear();
    shares.resize(views.len(), 0.0);
    if let ([view], [share]) = (views, &mut shares[..]) {
        *share = if view.seen.area > 0.0 { 1.0 } else { 0.0 };
        return;
    }
    let most = views.iter().map(|view| view.seen.area).fold(0.0, f64::max);
    let known = |i: &usize| views[*i].seen.area > 0.0 && views[*i].seen.area >= LEAST_KNOWN * most;
    let knowing: Vec<usize> = (0..views.len()).filter(known).collect();
    knowing.iter().zip(views_shares(&knowing, angles, choice)).for_each(|(i, share)| shares[*i] = share);
}
