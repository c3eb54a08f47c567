//! Bodies of the sky in a pixel: what they hide of facets, and what facets leave of them.
//!
//! A facet and a globe do not touch, so one of them hides the other wherever both are on one ray. What a pixel shows of facets is known as signed
//! convex pieces. Of those behind a globe, what lies in its outline is taken away again; from the globe, what lies behind the others is.

use super::detector::PixelSite;
use crate::geometry::polygon::{Point, area, intersect};
use crate::geometry::{Mesh, SphereImage, SphereShown};

/// Facets that leave less of a pixel than this hide all that is behind them, pixels: rounding of areas.
const COVERED: f64 = 1e-12;

/// The bodies of the sky in one pixel after another.
#[derive(Debug, Default)]
pub(super) struct Globes<'a> {
    mesh: Option<&'a Mesh>,
    /// All in the field, those in front first.
    all: &'a [SphereImage],
    /// Those that reach into this pixel, and their outlines there.
    here: Vec<(usize, Vec<Point>)>,
    /// What facets show in this pixel: facet, sign, outline.
    pieces: Vec<(u32, f64, Vec<Point>)>,
    /// What is left of each globe.
    shown: Vec<(usize, SphereShown)>,
}

impl<'a> Globes<'a> {
    pub(super) fn new(mesh: &'a Mesh, all: &'a [SphereImage]) -> Self {
        Globes { mesh: Some(mesh), all, ..Globes::default() }
    }

    /// What the pixel shows of each of them: its place among all in view, and how much.
    pub(super) fn shown(&self) -> &[(usize, SphereShown)] {
        &self.shown
    }

    /// Begins a pixel.
    pub(super) fn start(&mut self, site: &PixelSite) {
        let rect = &site.rect;
        self.here.clear();
        self.pieces.clear();
        self.shown.clear();
        for (i, globe) in self.all.iter().enumerate().filter(|(_, globe)| globe.may_touch(rect)) {
            let mut outline = Vec::new();
            globe.outline_within(rect, &mut outline);
            match site.outline {
                None => self.here.push((i, outline)),
                Some(pixel) => self.here.extend(common(&outline, &pixel).map(|outline| (i, outline))),
            }
        }
    }

    /// Whether any reaches into the pixel.
    pub(super) fn are_here(&self) -> bool {
        !self.here.is_empty()
    }

    /// What of a piece of a facet globes in front of it leave: signed pieces, besides the piece itself. They are noted.
    pub(super) fn left_of(&mut self, facet: u32, polygon: &[Point], sign: f64) -> Vec<(f64, Vec<Point>)> {
        let Some(mesh) = self.mesh else { return vec![] };
        let corners_m = mesh.facet(facet as usize).corners_m;
        let mut parts = vec![(1.0, polygon.to_vec())];
        for (i, outline) in &self.here {
            if self.all[*i].hides(corners_m) {
                let hidden: Vec<_> =
                    parts.iter().filter_map(|part| Some((-part.0, common(&part.1, outline)?))).collect();
                parts.extend(hidden);
            }
        }
        self.pieces.extend(parts.iter().map(|(times, part)| (facet, sign * times, part.clone())));
        parts.split_off(1)
    }

    /// Whether a globe is seen at a point in front of a facet there, or, without one, before the sky.
    pub(super) fn is_before(&self, facet: u32, at: Point) -> bool {
        let corners_m = self.mesh.map(|mesh| mesh.facet(facet as usize).corners_m);
        self.here.iter().any(|(i, _)| {
            let globe = &self.all[*i];
            globe.holds(at) && corners_m.is_some_and(|corners_m| globe.hides(corners_m))
        })
    }

    /// Finds what is left of each globe, once all facets are known.
    pub(super) fn finish(&mut self, site: &PixelSite) {
        let Some(mesh) = self.mesh else { return };
        let corners = site.corners();
        // What globes in front show, as signed pieces.
        let mut before: Vec<(f64, Vec<Point>)> = Vec::new();
        for (n, (i, outline)) in self.here.iter().enumerate() {
            let globe = &self.all[*i];
            let is_before = |facet: u32| !globe.hides(mesh.facet(facet as usize).corners_m);
            let hiding: Vec<_> = self.pieces.iter().filter(|(facet, ..)| is_before(*facet)).collect();
            let covered: f64 = hiding.iter().map(|(_, sign, piece)| sign * area(piece)).sum();
            if covered >= area(&corners) - COVERED {
                continue;
            }
            let mut shown = globe.shown(&corners);
            for (_, sign, piece) in &hiding {
                shown.add(-sign, &globe.shown(piece));
            }
            for (sign, piece) in &before {
                shown.add(-sign, &globe.shown(piece));
            }
            if shown.area > COVERED * globe.area_px().min(1.0) {
                let mut of_pixel = SphereShown::default();
                of_pixel.add(site.per_cell, &shown);
                self.shown.push((*i, of_pixel));
            }
            if n + 1 < self.here.len() {
                let hidden = |sign: f64, piece: &[Point]| Some((-sign, common(piece, outline)?));
                let by_facets = hiding.iter().filter_map(|(_, sign, piece)| hidden(*sign, piece));
                let by_globes = before.iter().filter_map(|(sign, piece)| hidden(*sign, piece));
                let of_this: Vec<_> = [(1.0, outline.clone())].into_iter().chain(by_facets).chain(by_globes).collect();
                before.extend(of_this);
            }
        }
    }
}

/// The common part of a piece and an outline, if there is any.
fn common(piece: &[Point], outline: &[Point]) -> Option<Vec<Point>> {
    let (mut out, mut spare) = (vec![], vec![]);
    if !outline.is_empty() {
        intersect(piece, outline, &mut out, &mut spare);
    }
    (out.len() >= 3).then_some(out)
}
