//! The ground as a mesh: heights at the layout's places, two triangles to a cell, and strips between rings.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::STAGE;
use super::area::Lie;
use super::base::{Base, rounded_m};
use super::cratering::Ground;
use super::division::Division;
use super::layout::{Grading, Layout, StripFacet};
use crate::error::Result;
use crate::geometry::cell::{self, cell_at};
use crate::geometry::{Facet, index_u32};
use crate::progress::{Watch, tell};

/// Vertices between two progress reports.
const BLOCK: usize = 1 << 15;

/// The ground.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    grading: Grading,
    layout: Layout,
    base: Base,
    /// The vertices on the map, m, and their heights over the base, m.
    places_m: Vec<[f64; 2]>,
    heights_m: Vec<f64>,
    /// The vertices as the mesh has them, m.
    pub(super) vertices_m: Vec<DVec3>,
    /// Counter-clockwise seen from above: the grid's cells, two each, row by row; then strip after strip.
    pub(super) facets: Vec<[u32; 3]>,
    /// The first facet of each strip, and its facets; four strips for each ring: south, east, north, west.
    strips: Vec<(usize, Vec<StripFacet>)>,
}

impl Sheet {
    /// Finds the height of each vertex.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub(super) fn new(division: &Division, ground: &Ground, base: Base, watch: Watch<'_>) -> Result<Self> {
        let (grading, layout) = (division.grading.clone(), division.layout.clone());
        let mut places_m: Vec<[f64; 2]> = Vec::with_capacity(layout.vertices());
        places_m.extend(layout.places_m());
        let mut heights_m = vec![0.0; places_m.len()];
        for (b, (block_m, at_m)) in heights_m.chunks_mut(BLOCK).zip(places_m.chunks(BLOCK)).enumerate() {
            tell(watch, STAGE, (b * BLOCK) as u64, places_m.len() as u64)?;
            block_m.par_iter_mut().zip(at_m).with_min_len(256).for_each(|(height_m, &[x_m, y_m])| {
                let relief = base.relief(x_m, y_m);
                let exact_m =
                    if relief > 0.0 { relief * ground.height_m(x_m, y_m, grading.step_at_m(x_m, y_m)) } else { 0.0 };
                *height_m = rounded_m(DVec3::splat(exact_m), base.per_m()).x;
            });
        }
        let vertices_m = (places_m.par_iter().zip(&heights_m))
            .map(|(&[x_m, y_m], &z_m)| rounded_m(base.point_m(DVec3::new(x_m, y_m, z_m)), base.per_m()))
            .collect();

        let [columns, rows] = layout.grid();
        let mut facets = Vec::with_capacity(layout.facets());
        for j in 0..rows {
            for i in 0..columns {
                let corners = corners(i, j, columns);
                facets.extend(cell::cut(corners, corners.map(|v| heights_m[v as usize])));
            }
        }
        let mut strips = Vec::new();
        for ring in 0..layout.rings.len() - 1 {
            for side in 0..4 {
                let strip = layout.strip(ring, side);
                let first = facets.len();
                facets.extend(strip.iter().map(|f| f.facet));
                strips.push((first, strip));
            }
        }
        Ok(Sheet { grading, layout, base, places_m, heights_m, vertices_m, facets, strips })
    }

    /// The facet below a place, m; beyond the border the nearest.
    fn facet_at(&self, x_m: f64, y_m: f64) -> usize {
        let half_m = self.grading.half_m(x_m, y_m);
        let rings = &self.layout.rings;
        if half_m <= self.grading.core_m || rings.len() == 1 {
            let [columns, rows] = self.layout.grid();
            let place = |axis: usize, p_m: f64, cells: usize| {
                let share = 0.5 + 0.5 * (p_m - rings[0].middle_m[axis]) / self.grading.core_m;
                cell_at((share * cells as f64).clamp(0.0, cells as f64), cells)
            };
            let ((i, u), (j, v)) = (place(0, x_m, columns), place(1, y_m, rows));
            let first = 2 * (j * columns + i);
            let [_, _, north_east, _] = corners(i, j, columns);
            let in_first = if self.facets[first][2] == north_east { u >= v } else { u + v <= 1.0 };
            return first + usize::from(!in_first);
        }
        let outer = rings.partition_point(|ring| ring.half_m < half_m).clamp(1, rings.len() - 1);
        let side = self.grading.side(x_m, y_m);
        let (first, strip) = &self.strips[4 * (outer - 1) + side];
        let place = |v: u32| DVec2::from_array(self.places_m[v as usize]);
        let at = DVec2::new(x_m, y_m);
        // Facets whose last edge, from the outer ring to the inner, has the place on its right come before it.
        let before = |f: &StripFacet| (place(f.inner) - place(f.outer)).perp_dot(at - place(f.outer)) <= 0.0;
        first + strip.partition_point(before).min(strip.len() - 1)
    }

    /// Height over the base at a place, m, as the facets have it on the map.
    pub(super) fn height_m(&self, x_m: f64, y_m: f64) -> f64 {
        let corners = self.on_map_m(self.facet_at(x_m, y_m));
        above_m(DVec3::new(x_m, y_m, 0.0), corners, DVec3::Z).map_or(corners[0].z, |above_m| -above_m)
    }

    /// From the lowest to the highest vertex of a square site with this half side, over the base, m.
    pub(super) fn relief_m(&self, half_m: f64) -> f64 {
        let is_within = |place: &[f64; 2]| place.iter().all(|p_m| p_m.abs() <= half_m);
        let of_site = self.places_m.iter().zip(&self.heights_m).filter(|(place, _)| is_within(place));
        let [lowest_m, highest_m] = of_site
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[lowest, highest], (_, h)| [lowest.min(*h), highest.max(*h)]);
        (highest_m - lowest_m).max(0.0)
    }

    /// Where the vertices lie on the map, m.
    pub(super) fn places_m(&self) -> &[[f64; 2]] {
        &self.places_m
    }

    /// Corners of a facet on the map, and their heights over the base, m.
    fn on_map_m(&self, facet: usize) -> [DVec3; 3] {
        self.facets[facet].map(|v| {
            let ([x_m, y_m], z_m) = (self.places_m[v as usize], self.heights_m[v as usize]);
            DVec3::new(x_m, y_m, z_m)
        })
    }

    /// Where the middle of a facet is on the map, m, and what the ground is like there.
    pub(super) fn lie(&self, facet: usize) -> ([f64; 2], Lie) {
        let facet = Facet { corners_m: self.on_map_m(facet) };
        let middle_m = facet.centroid_m();
        let slope_deg = facet.normal().z.clamp(-1.0, 1.0).acos().to_degrees();
        ([middle_m.x, middle_m.y], Lie { height_m: middle_m.z, slope_deg })
    }

    /// Normal of the ground over so many metres around a place, in the site's axes: unit vector.
    pub(super) fn normal(&self, x_m: f64, y_m: f64, radius_m: f64) -> DVec3 {
        let east_m = self.height_m(x_m + radius_m, y_m) - self.height_m(x_m - radius_m, y_m);
        let north_m = self.height_m(x_m, y_m + radius_m) - self.height_m(x_m, y_m - radius_m);
        DVec3::new(-east_m, -north_m, 2.0 * radius_m).normalize()
    }

    /// How far a place of the site lies above the mesh, along what is up there, m.
    pub(super) fn above_m(&self, site_m: DVec3) -> f64 {
        let corners = self.facets[self.facet_at(site_m.x, site_m.y)].map(|v| self.vertices_m[v as usize]);
        let (p_m, up) = self.base.stand_m(site_m);
        above_m(p_m, corners, up).unwrap_or(0.0)
    }

    /// How many facets face the body that they lie on: relief is so high there that it folds. On a plane none does.
    pub(super) fn folded(&self) -> usize {
        let Base::Body(wrap) = &self.base else { return 0 };
        let corners_m = |facet: &[u32; 3]| facet.map(|v| self.vertices_m[v as usize]);
        self.facets.iter().filter(|facet| !wrap.faces_outward(corners_m(facet))).count()
    }

    /// How far the mesh's end lies off the base, at its vertices or half way between them, m, at most.
    pub(super) fn seam_m(&self) -> f64 {
        let end = self.layout.end();
        let next = end.iter().cycle().skip(1);
        let off_m = |x_m: f64, y_m: f64, p_m: DVec3| (p_m - self.base.point_m(DVec3::new(x_m, y_m, 0.0))).length();
        let seams_m = end.iter().zip(next).map(|(&a, &b)| {
            let [[ax_m, ay_m], [bx_m, by_m]] = [a, b].map(|v| self.places_m[v as usize]);
            let [p_m, q_m] = [a, b].map(|v| self.vertices_m[v as usize]);
            off_m(ax_m, ay_m, p_m).max(off_m(0.5 * (ax_m + bx_m), 0.5 * (ay_m + by_m), 0.5 * (p_m + q_m)))
        });
        seams_m.fold(0.0, f64::max)
    }

    /// A place of the site in the axes of the mesh, m.
    pub(super) fn placed_m(&self, site_m: DVec3) -> DVec3 {
        rounded_m(self.base.point_m(site_m), self.base.per_m())
    }
}

/// How far a point lies above the plane of a facet, along `up`, m; none if the plane holds `up`.
fn above_m(p_m: DVec3, [a_m, b_m, c_m]: [DVec3; 3], up: DVec3) -> Option<f64> {
    let normal = (b_m - a_m).cross(c_m - a_m);
    let above_m = (p_m - a_m).dot(normal) / up.dot(normal);
    above_m.is_finite().then_some(above_m)
}

/// Vertices at the corners of a cell, counter-clockwise from the south-west.
fn corners(column: usize, row: usize, columns: usize) -> [u32; 4] {
    let south = index_u32(row * (columns + 1) + column);
    let north = south + index_u32(columns + 1);
    [south, south + 1, north + 1, north]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::division::divide;
    use crate::landscape::recipe::{Detail, Recipe, Surroundings};
    use crate::landscape::relief::layers;
    use crate::landscape::sources::Sources;

    fn sheet(detail: bool, around: bool) -> Sheet {
        let recipe = Recipe {
            facets: 4000,
            size_m: 300.0,
            detail: detail.then_some(Detail { x_m: 37.0, y_m: -21.0, size_m: 90.0, growth: 0.1 }),
            surroundings: around.then_some(Surroundings { reach_m: 500.0, growth: 0.2 }),
            ..Recipe::new(1)
        };
        let layers = layers(&recipe, "relief", &Sources::default()).unwrap();
        let ground = Ground::new(layers, Vec::new(), Vec::new(), 150.0, 650.0);
        Sheet::new(&divide(&recipe, &[]).unwrap(), &ground, Base::Plane, &|_| true).unwrap()
    }

    /// Inside of facets, and where they are easily missed: on their corners, edges, and next to these, in the grid, in strips, and on the rings between.
    #[test]
    fn heights_are_those_of_the_facets_everywhere() {
        let mut seen = 0;
        for (detail, around) in [(false, false), (true, false), (false, true), (true, true)] {
            let sheet = sheet(detail, around);
            for facet in 0..sheet.facets.len() {
                let corners = Facet { corners_m: sheet.on_map_m(facet) };
                for (u, v) in
                    [(0.3, 0.3), (0.0, 0.0), (1.0, 0.0), (0.5, 0.0), (0.5, 0.5), (0.0, 0.5), (1e-9, 0.4), (0.4, 1e-9)]
                {
                    let p = corners.point_m(u, v);
                    // Slopes are below 2, and a place on an edge may be taken by the neighbour, off by rounding.
                    let off_m = (sheet.height_m(p.x, p.y) - p.z).abs();
                    assert!(off_m < 1e-8, "{detail} {around}: facet {facet} at {u}, {v}: {off_m}");
                    assert!(sheet.above_m(p).abs() < 1e-4, "{}", sheet.above_m(p));
                    seen += 1;
                }
            }
        }
        assert!(seen > 100_000, "{seen}");
    }

    #[test]
    fn each_cell_is_cut_by_its_shorter_diagonal() {
        let sheet = sheet(false, false);
        let (mut seen, mut first) = (0, 0);
        for pair in sheet.facets.chunks(2) {
            let shared: Vec<u32> = pair[0].into_iter().filter(|v| pair[1].contains(v)).collect();
            let apart: Vec<u32> = pair.iter().filter_map(|f| f.iter().find(|v| !shared.contains(v)).copied()).collect();
            let length_m =
                |ends: &[u32]| sheet.vertices_m[ends[0] as usize].distance(sheet.vertices_m[ends[1] as usize]);
            assert!(length_m(&shared) <= length_m(&apart) + 1e-5);
            first += usize::from(shared.contains(&pair[0][0]) && pair[0][2] == pair[1][1]);
            seen += 1;
        }
        // Both diagonals are in use.
        assert!((1980..=2020).contains(&seen) && first > seen / 10 && first < seen - seen / 10, "{first} of {seen}");
    }
}
