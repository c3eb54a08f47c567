//! How far shadows are thrown: from the edge that casts one to where it falls, along the rays.

use rayon::prelude::*;

use super::bins::Bins;
use super::coverage::open_edge_crosses;
use super::{Drawing, Side, Topology};
use crate::geometry::polygon::{Point, Rect};
use crate::geometry::{Direction, Mesh};

/// Mean number of facets in a cell, and the least number of cells: large facets are long along the rays.
const FACETS_PER_CELL: f64 = 4.0;
const LEAST_CELLS: f64 = 4096.0;

/// No edge of a mesh throws its shadow farther than this, m, onto a facet that faces the light from this direction: for each cell of the
/// light's view that an edge crosses, from the nearest such edge to the farthest such facet.
///
/// Too long by no more than what cells and edges extend along the rays; no ray is followed.
pub fn longest_throw_m(mesh: &Mesh, topology: &Topology, towards: Direction) -> f64 {
    let drawing =
        Drawing::from_afar(mesh, topology, towards, (mesh.facets.len() as f64 / FACETS_PER_CELL).max(LEAST_CELLS));
    let bins = Bins::new(&drawing);
    let of_row =
        |row: u32| (0..drawing.grid.columns).map(|column| throw_m(&drawing, &bins, column, row)).fold(0.0, f64::max);
    (0..drawing.grid.rows).into_par_iter().map(of_row).collect::<Vec<f64>>().into_iter().fold(0.0, f64::max)
}

/// The same in a cell.
fn throw_m(drawing: &Drawing, bins: &Bins, column: u32, row: u32) -> f64 {
    let rect = drawing.grid.cell(column, row);
    let cell = row as usize * drawing.grid.columns as usize + column as usize;
    let (mut nearest, mut farthest) = (f64::NEG_INFINITY, f64::INFINITY);
    for triangle in bins.triangles(cell) {
        let corners = drawing.corners(triangle);
        if open_edge_crosses(drawing, triangle, &rect) {
            nearest = corners.iter().map(|corner| corner[2]).fold(nearest, f64::max);
        }
        if drawing.side(drawing.facet(triangle)) == Side::Front {
            farthest = farthest.min(lowest_within(&corners, &rect));
        }
    }
    (nearest - farthest).max(0.0)
}

/// A triangle's lowest nearness over a rectangle that it touches, or somewhat less.
fn lowest_within([a, b, c]: &[[f64; 3]; 3], rect: &Rect) -> f64 {
    let of_corners = a[2].min(b[2]).min(c[2]);
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let det = u[0] * v[1] - u[1] * v[0];
    let slope = [(u[2] * v[1] - v[2] * u[1]) / det, (v[2] * u[0] - u[2] * v[0]) / det];
    let at = |p: &Point| a[2] + slope[0] * (p[0] - a[0]) + slope[1] * (p[1] - a[1]);
    let of_plane = rect.corners().iter().map(at).fold(f64::INFINITY, f64::min);
    // Of a triangle seen edge-on it is no number: `max` takes the other.
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
            let throw_m = longest_throw_m(&mesh, &Topology::new(&mesh), towards);
            let exact_m = f64::from(height) / towards.vec().z;
            assert!(throw_m >= exact_m && throw_m < exact_m + 12.0, "{height} {incidence_deg}: {throw_m} {exact_m}");
        }
    }

    #[test]
    fn what_is_edge_on_or_nothing_throws_none() {
        assert_eq!(
            longest_throw_m(&Mesh::default(), &Topology::new(&Mesh::default()), Direction::new(DVec3::Z).unwrap()),
            0.0
        );
        let flat = walled(0);
        let throw_m = longest_throw_m(&flat, &Topology::new(&flat), Direction::new(DVec3::X).unwrap());
        assert_eq!(throw_m, 0.0);
    }
}
