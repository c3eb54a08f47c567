//! Where shadows of a disc may be that a point's are not: how far they are thrown, and which facets a penumbra may reach.

use rayon::prelude::*;

use super::bins::Bins;
use super::coverage::open_edge_crosses;
use super::{Drawing, Side, Topology, View};
use crate::geometry::polygon::{Point, Rect};
use crate::geometry::{Direction, Mesh, whole};

/// Mean number of facets in a cell, and the least number of cells: large facets are long along the rays.
const FACETS_PER_CELL: f64 = 4.0;
const LEAST_CELLS: f64 = 4096.0;

/// Where half-shadows may be in light from a disc.
#[derive(Debug, Clone, PartialEq)]
pub struct Penumbra {
    /// No edge throws its shadow farther than this, m, onto a facet that faces the disc's middle: for each cell of the light's view that an edge crosses, from
    /// the nearest such edge to the farthest such facet. Too long by no more than what cells and edges extend along the rays; no ray is followed.
    pub throw_m: f64,
    /// Of each facet whether an edge may hide a part of the disc, and not all of it, from some of its points: its view is that near to an edge, or the facet is that
    /// near to edge-on.
    pub reached: Vec<bool>,
}

impl Penumbra {
    /// Of a disc in this direction, with the sine of its angular radius.
    pub fn of(mesh: &Mesh, topology: &Topology, towards: Direction, sin_radius: f64) -> Self {
        let cells = (mesh.facets.len() as f64 / FACETS_PER_CELL).max(LEAST_CELLS);
        let drawing = Drawing::from_afar(mesh, topology, towards, cells);
        let bins = Bins::new(&drawing);
        let (columns, rows) = (drawing.grid.columns, drawing.grid.rows);
        let is_grazed: Vec<bool> = (0..mesh.facets.len())
            .into_par_iter()
            .map(|facet| {
                let cross_m2 = mesh.facet(facet).cross_m2();
                cross_m2.dot(towards.vec()).abs() <= sin_radius * cross_m2.length()
            })
            .collect();
        let of_row = |row: u32| {
            let of_cell = |column: u32| throw_m(&drawing, &bins, &is_grazed, column, row);
            (0..columns).map(of_cell).collect::<Vec<_>>()
        };
        let throws_m: Vec<f64> = (0..rows).into_par_iter().flat_map_iter(of_row).collect();
        let throw_m = throws_m.iter().copied().fold(0.0, f64::max);
        // Cells that an edge crosses, and those as near to them as a penumbra is wide.
        let edges: Vec<bool> = throws_m.iter().map(|throw_m| *throw_m >= 0.0).collect();
        let View::Parallel { scale, .. } = drawing.view else { unreachable!("light from afar is parallel") };
        let pad = scale.map(|scale| whole(throw_m * sin_radius * scale) + 1);
        let near = spread(&spread(&edges, columns as usize, 1, pad[0]), columns as usize, columns as usize, pad[1]);
        let mut reached = is_grazed;
        for cell in (0..near.len()).filter(|cell| near[*cell]) {
            bins.triangles(cell).for_each(|triangle| reached[drawing.facet(triangle) as usize] = true);
        }
        Penumbra { throw_m, reached }
    }
}

/// How far edges throw shadows in a cell, m; negative if no edge crosses it. Facets that are grazed may have their edges elsewhere within them.
fn throw_m(drawing: &Drawing, bins: &Bins, is_grazed: &[bool], column: u32, row: u32) -> f64 {
    let rect = drawing.grid.cell(column, row);
    let cell = row as usize * drawing.grid.columns as usize + column as usize;
    let (mut nearest, mut farthest) = (f64::NEG_INFINITY, f64::INFINITY);
    for triangle in bins.triangles(cell) {
        let corners = drawing.corners(triangle);
        if is_grazed[drawing.facet(triangle) as usize] || open_edge_crosses(drawing, triangle, &rect) {
            nearest = corners.iter().map(|corner| corner[2]).fold(nearest, f64::max);
        }
        if drawing.side(drawing.facet(triangle)) == Side::Front {
            farthest = farthest.min(lowest_within(&corners, &rect));
        }
    }
    if nearest > f64::NEG_INFINITY { (nearest - farthest).max(0.0) } else { -1.0 }
}

/// Cells with one that is set within `pad` of them, along a line of cells that are `step` apart, in an image of rows of `columns`.
fn spread(set: &[bool], columns: usize, step: usize, pad: usize) -> Vec<bool> {
    let (length, lines) =
        if step == 1 { (columns, set.len() / columns.max(1)) } else { (set.len() / columns.max(1), columns) };
    let mut spread = vec![false; set.len()];
    for line in 0..lines {
        let at = |place: usize| if step == 1 { line * columns + place } else { place * step + line };
        // From either side, the last one that was set.
        for is_forward in [true, false] {
            let mut last: Option<usize> = None;
            for i in 0..length {
                let place = if is_forward { i } else { length - 1 - i };
                if set[at(place)] {
                    last = Some(i);
                }
                spread[at(place)] |= last.is_some_and(|last| i - last <= pad);
            }
        }
    }
    spread
}

/// A triangle's lowest nearness over a rectangle that it touches, or somewhat less.
fn lowest_within([a, b, c]: &[[f64; 3]; 3], rect: &Rect) -> f64 {
    let of_corners = a[2].min(b[2]).min(c[2]);
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let det = u[0] * v[1] - u[1] * v[0];
    let slope = [(u[2] * v[1] - v[2] * u[1]) / det, (v[2] * u[0] - u[2] * v[0]) / det];
    let at = |p: &Point| a[2] + slope[0] * (p[0] - a[0]) + slope[1] * (p[1] - a[1]);
    let of_plane = rect.corners().iter().map(at).fold(f64::INFINITY, f64::min);
    // Of a triangle seen edge-on it is not a number: `max` takes the other.
    of_corners.max(of_plane)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::{MaterialId, index_u32};

    /// Ground from -40 to 40 in squares of 2 m, and a wall of this height along x = 0, in squares of 2 m.
    fn walled(height: u32) -> Mesh {
        let mut mesh = Mesh::default();
        let mut square = |corners: [[i32; 3]; 4]| {
            let first = index_u32(mesh.vertices_m.len());
            mesh.vertices_m.extend(corners.map(|p| DVec3::from_array(p.map(f64::from))));
            mesh.facets.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            mesh.material.extend([MaterialId(0); 2]);
        };
        for x in (-40..40).step_by(2) {
            for y in (-40..40).step_by(2) {
                square([[x, y, 0], [x + 2, y, 0], [x + 2, y + 2, 0], [x, y + 2, 0]]);
            }
        }
        let height = i32::try_from(height).unwrap();
        for y in (-40..40).step_by(2) {
            for z in (0..height).step_by(2) {
                square([[0, y, z], [0, y + 2, z], [0, y + 2, z + 2], [0, y, z + 2]]);
            }
        }
        mesh
    }

    #[test]
    fn a_wall_throws_its_shadow_as_far_as_it_is_high_over_the_cosine() {
        for (height, incidence_deg) in [(4, 30.0_f64), (10, 60.0), (6, 80.0)] {
            let mesh = walled(height);
            let (sin, cos) = incidence_deg.to_radians().sin_cos();
            let towards = Direction::new(DVec3::new(sin, 0.1 * sin, cos)).unwrap();
            let throw_m = Penumbra::of(&mesh, &Topology::new(&mesh), towards, 0.0).throw_m;
            let exact_m = f64::from(height) / towards.vec().z;
            assert!(throw_m >= exact_m && throw_m < exact_m + 12.0, "{height} {incidence_deg}: {throw_m} {exact_m}");
        }
    }

    #[test]
    fn what_is_edge_on_or_nothing_throws_none() {
        let nothing = Mesh::default();
        let penumbra = Penumbra::of(&nothing, &Topology::new(&nothing), Direction::new(DVec3::Z).unwrap(), 0.003);
        assert_eq!(penumbra, Penumbra { throw_m: 0.0, reached: vec![] });
        let flat = walled(0);
        assert_eq!(Penumbra::of(&flat, &Topology::new(&flat), Direction::new(DVec3::X).unwrap(), 0.003).throw_m, 0.0);
    }

    #[test]
    fn a_penumbra_is_along_the_shadows_edge() {
        // Behind a wall of 10 m the shadow of a Sun 45 deg high ends at 10 m; its disc's edges do so within 1 %.
        let mesh = walled(10);
        let towards = Direction::new(DVec3::new(-1.0, 0.0, 1.0)).unwrap();
        let sin_radius = 0.005;
        let Penumbra { throw_m, reached } = Penumbra::of(&mesh, &Topology::new(&mesh), towards, sin_radius);
        let width_m = 2.0 * throw_m * sin_radius;
        let mut clear = 0;
        for (facet, reached) in reached.into_iter().enumerate() {
            let x_m = mesh.facet(facet).corners_m.map(|p| p.x);
            let (low_m, high_m) = (x_m[0].min(x_m[1]).min(x_m[2]), x_m[0].max(x_m[1]).max(x_m[2]));
            // Where the Sun's lower edge, and its upper one, come over the wall.
            if low_m <= 10.0 + width_m && high_m >= 10.0 - width_m {
                assert!(reached, "{low_m} {high_m}");
            }
            clear += usize::from(low_m > 14.0 && high_m < 36.0 && !reached);
        }
        // The rest of the ground, but for its rim.
        assert!(clear > 500, "{clear}");
    }
}
