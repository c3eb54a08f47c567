//! A body's mesh as a smooth surface: its vertices, and between them no edges.
//!
//! Seen from the projection's centre the surface is a distance for each place of the map. Values at vertices are theirs, slopes those of their normals; over each
//! facet `split` goes between them, so that the surface has one tangent plane everywhere, and no facet of a coarse body is printed onto a site.

use glam::{DVec2, DVec3};

use super::projection::Projection;
use super::split::{Corner, barycentric, smooth};
use crate::geometry::{Mesh, index_u32, whole};
use crate::landscape::noise::smooth_step;

/// Cells along a side of the square in which facets are looked up.
const CELLS: usize = 512;

/// Facets with a vertex farther than this from the upright, as the cosine of the angle, are left out: maps turn inside out opposite to it.
const FARTHEST_COS: f64 = -0.94;

/// A body's meshes, the coarsest first: where a finer one is, it counts.
#[derive(Debug, Clone)]
pub(super) struct Smooth {
    parts: Vec<Part>,
}

/// What a mesh has at a place.
enum At {
    Hole,
    One([u32; 3]),
    /// Facets over one another: the shape intersects itself.
    Several,
}

/// One mesh as a map of distances.
#[derive(Debug, Clone)]
struct Part {
    /// Corners of facets: place, distance from the centre, m, and slopes.
    corners: Vec<Corner>,
    facets: Vec<[u32; 3]>,
    /// How much of this mesh counts at each vertex: 0 on its border, 1 away from it.
    shares: Vec<f64>,
    half_m: f64,
    cells: Vec<Vec<u32>>,
}

impl Smooth {
    /// The meshes as far as places are within `half_m` of the target.
    ///
    /// # Errors
    /// What cannot be mapped.
    pub(super) fn new(meshes: &[Mesh], projection: &Projection, half_m: f64) -> Result<Self, String> {
        let parts = meshes.iter().enumerate().map(|(i, mesh)| Part::new(mesh, projection, half_m, i > 0));
        Ok(Smooth { parts: parts.collect::<Result<_, _>>()? })
    }

    /// Foot, m, and unit normal at a place; none in a hole, and where facets of one mesh lie over one another.
    pub(super) fn at(&self, projection: &Projection, x_m: f64, y_m: f64) -> Option<(DVec3, DVec3)> {
        let place = DVec2::new(x_m, y_m);
        let mut found: Option<(f64, DVec2)> = None;
        for part in &self.parts {
            let facet = match part.facet_at(place) {
                At::Hole => continue,
                At::Several => return None,
                At::One(facet) => facet,
            };
            let (distance_m, slope, share, share_slope) = part.over(facet, place);
            found = Some(match found {
                Some((before_m, before_slope)) => (
                    before_m + share * (distance_m - before_m),
                    before_slope + share * (slope - before_slope) + share_slope * (distance_m - before_m),
                ),
                None => (distance_m, slope),
            });
        }
        let (distance_m, slope) = found?;
        let aim = projection.aim(x_m, y_m);
        // Tangents of centre + distance x direction.
        let by_x = slope.x * aim.direction + distance_m * aim.by_x;
        let by_y = slope.y * aim.direction + distance_m * aim.by_y;
        Some((projection.centre_m + distance_m * aim.direction, by_x.cross(by_y).normalize()))
    }
}

impl Part {
    fn new(mesh: &Mesh, projection: &Projection, half_m: f64, has_rim: bool) -> Result<Self, String> {
        let normals = vertex_normals(mesh);
        let mut corners: Vec<Option<Corner>> = Vec::with_capacity(mesh.vertices_m.len());
        for (vertex_m, normal) in mesh.vertices_m.iter().zip(&normals) {
            let is_far = (*vertex_m - projection.centre_m).normalize_or_zero().dot(projection.up) < FARTHEST_COS;
            let place = projection.place(*vertex_m).filter(|_| !is_far);
            corners.push(place.map(|(at, value)| {
                let aim = projection.aim(at.x, at.y);
                // The tangent by x, value' direction + value direction', is at right angles to the normal.
                let facing = normal.dot(aim.direction);
                let slope = -value / facing * DVec2::new(normal.dot(aim.by_x), normal.dot(aim.by_y));
                // A normal at right angles to the line of sight has no slope; facets tell whether it is folded.
                Corner { at, value, slope: if slope.is_finite() { slope } else { DVec2::ZERO } }
            }));
        }
        let mut part = Part {
            corners: Vec::new(),
            facets: Vec::new(),
            shares: Vec::new(),
            half_m,
            cells: vec![Vec::new(); CELLS * CELLS],
        };
        let mut folded = Vec::new();
        for (f, facet) in mesh.facets.iter().enumerate() {
            let [Some(a), Some(b), Some(c)] = facet.map(|v| corners[v as usize].map(|corner| corner.at)) else {
                continue;
            };
            let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
            if lo.max_element() > half_m || hi.min_element() < -half_m {
                continue;
            }
            if (b - a).perp_dot(c - a) <= 0.0 {
                folded.push(f);
                continue;
            }
            let number = index_u32(part.facets.len());
            part.facets.push(*facet);
            let range =
                |lo: f64, hi: f64| whole(part.place(lo).max(0.0))..whole(part.place(hi).max(0.0) + 1.0).min(CELLS);
            let (columns, rows) = (range(lo.x, hi.x), range(lo.y, hi.y));
            for row in rows {
                for column in columns.clone() {
                    part.cells[row * CELLS + column].push(number);
                }
            }
        }
        if let Some(first) = folded.first() {
            return Err(format!(
                "{} of its facets under the mesh, first facet {first} (counted from 0), do not face away from a point below the target: the shape is folded there, or turned inside out",
                folded.len()
            ));
        }
        part.corners = corners
            .into_iter()
            .map(|c| c.unwrap_or(Corner { at: DVec2::NAN, value: f64::NAN, slope: DVec2::NAN }))
            .collect();
        part.shares = if has_rim { part.shares_of_border(mesh) } else { vec![1.0; mesh.vertices_m.len()] };
        Ok(part)
    }

    /// Cells from a coordinate.
    fn place(&self, x_m: f64) -> f64 {
        ((x_m / self.half_m + 1.0) * (0.5 * CELLS as f64)).min(CELLS as f64)
    }

    /// Vertices of open edges have the share 0, their neighbours 1/3, those behind them 2/3, all others 1: over three rows of facets one mesh becomes the other.
    fn shares_of_border(&self, mesh: &Mesh) -> Vec<f64> {
        let mut edges: Vec<[u32; 2]> = mesh.facets.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        let open = |edge: &&[u32; 2]| edges.binary_search(&[edge[1], edge[0]]).is_err();
        let mut ranks = vec![3_u8; mesh.vertices_m.len()];
        for edge in edges.iter().filter(open) {
            edge.iter().for_each(|&v| ranks[v as usize] = 0);
        }
        for rank in 0..2 {
            let before = ranks.clone();
            for [a, b] in &edges {
                for (a, b) in [(a, b), (b, a)] {
                    if before[*a as usize] == rank && before[*b as usize] > rank + 1 {
                        ranks[*b as usize] = rank + 1;
                    }
                }
            }
        }
        ranks.into_iter().map(|rank| f64::from(rank) / 3.0).collect()
    }

    /// The facet at a place. On an edge either will do, and between two within rounding the one that it is least outside of.
    fn facet_at(&self, place: DVec2) -> At {
        if place.abs().max_element() > self.half_m {
            return At::Hole;
        }
        let cell = |x_m: f64| whole(self.place(x_m)).min(CELLS - 1);
        let (mut best, mut within) = ((-ROUNDING, None), 0);
        for &number in &self.cells[cell(place.y) * CELLS + cell(place.x)] {
            let facet = self.facets[number as usize];
            let weights = barycentric(facet.map(|v| self.corners[v as usize].at), place);
            let least = weights.into_iter().fold(f64::INFINITY, f64::min);
            within += usize::from(least > ROUNDING);
            if least > best.0 {
                best = (least, Some(facet));
            }
        }
        match best.1 {
            None => At::Hole,
            Some(_) if within > 1 => At::Several,
            Some(facet) => At::One(facet),
        }
    }

    /// Distance from the centre, m, and its slopes at a place of a facet; and the share of this mesh there and its slopes.
    fn over(&self, facet: [u32; 3], place: DVec2) -> (f64, DVec2, f64, DVec2) {
        let corners = facet.map(|v| self.corners[v as usize]);
        let (distance_m, slope) = smooth(&corners, place);
        let at = corners.map(|c| c.at);
        let shares = facet.map(|v| self.shares[v as usize]);
        if shares == [1.0; 3] {
            return (distance_m, slope, 1.0, DVec2::ZERO);
        }
        // Smoothly from 0 to 1: the share's slope vanishes at both ends, though it has steps between.
        let weights = barycentric(at, place);
        let linear: f64 = weights.iter().zip(shares).map(|(w, s)| w * s).sum();
        let by = |axis: DVec2| {
            let shifted = barycentric(at, place + axis);
            shifted.iter().zip(weights).zip(shares).map(|((a, b), s)| (a - b) * s).sum::<f64>()
        };
        let t = linear.clamp(0.0, 1.0);
        let steep = 6.0 * t * (1.0 - t);
        (distance_m, slope, smooth_step(t), steep * DVec2::new(by(DVec2::X), by(DVec2::Y)))
    }
}

/// Barycentric coordinates of a place on an edge may be below 0 by this.
const ROUNDING: f64 = 1e-9;

/// Unit normals of vertices: those of their facets, weighted so that on a sphere they are exact (N. Max 1999, "Weights for computing vertex normals from facet
/// normals", J. Graphics Tools 4).
fn vertex_normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.vertices_m.len()];
    for facet in &mesh.facets {
        let corners_m = facet.map(|v| mesh.vertices_m[v as usize]);
        for k in 0..3 {
            let (next, last) = (corners_m[(k + 1) % 3] - corners_m[k], corners_m[(k + 2) % 3] - corners_m[k]);
            let weighted = next.cross(last) / (next.length_squared() * last.length_squared());
            if weighted.is_finite() {
                normals[facet[k] as usize] += weighted;
            }
        }
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

/// Where the line from the body's centre in a direction meets the finest of its meshes that it meets, m, and the unit normal there, between those of the
/// facet's vertices. None if it meets no facet, or several of one mesh.
pub(super) fn hit(meshes: &[Mesh], direction: DVec3) -> Option<(DVec3, DVec3)> {
    meshes.iter().rev().find_map(|mesh| {
        let mut met: Option<(DVec3, [f64; 3], [u32; 3])> = None;
        for facet in &mesh.facets {
            let [a, b, c] = facet.map(|v| mesh.vertices_m[v as usize]);
            // Weights by the volumes that the direction spans with the edges: on a shared edge both facets have the same.
            let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|n| direction.dot(n));
            if weights.iter().any(|w| *w < 0.0) || weights.iter().all(|w| *w == 0.0) {
                continue;
            }
            let sum: f64 = weights.iter().sum();
            let [wa, wb, wc] = weights.map(|w| w / sum);
            let point_m = wa * a + wb * b + wc * c;
            // Facets that face the centre are met by the line's other half.
            if point_m.dot(direction) <= 0.0 {
                continue;
            }
            match met {
                // The same place, on an edge or a corner.
                Some((before_m, ..)) if (before_m - point_m).length() <= 1e-9 * point_m.length() => {}
                Some(_) => return None,
                None => met = Some((point_m, [wa, wb, wc], *facet)),
            }
        }
        let (point_m, weights, facet) = met?;
        let normals = vertex_normals(mesh);
        let normal: DVec3 = facet.iter().zip(weights).map(|(v, w)| w * normals[*v as usize]).sum();
        (normal != DVec3::ZERO).then(|| (point_m, normal.normalize()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::boulder::Ball;

    fn sphere(frequency: u32, radius_m: f64) -> Mesh {
        let ball = Ball::new(frequency);
        Mesh {
            vertices_m: ball.vertices.iter().map(|v| *v * radius_m).collect(),
            facets: ball.facets,
            ..Mesh::default()
        }
    }

    fn projection(radius_m: f64) -> Projection {
        let up = DVec3::new(0.3, -0.5, 0.8).normalize();
        let east = up.any_orthonormal_vector();
        Projection::new(up * radius_m, up, radius_m, [east, up.cross(east)])
    }

    #[test]
    fn a_coarse_sphere_is_round() {
        // 320 facets: flat, they lie up to 2 % below the sphere and their normals are 13 deg off; from another centre than the sphere's, too.
        let mesh = sphere(4, 1000.0);
        let mut projection = projection(1000.0);
        projection.centre_m += DVec3::new(60.0, 40.0, -30.0);
        let smooth = Smooth::new(std::slice::from_ref(&mesh), &projection, 1000.0).unwrap();
        let (mut worst_m, mut worst) = (0.0f64, 0.0f64);
        for i in 0..2500 {
            let (x_m, y_m) = (f64::from(i % 50) * 38.0 - 931.0, f64::from(i / 50) * 38.0 - 931.0);
            let (p, n) = smooth.at(&projection, x_m, y_m).unwrap();
            worst_m = worst_m.max((p.length() - 1000.0).abs());
            worst = worst.max((n - p.normalize()).length());
        }
        assert!(worst_m < 1.0 && worst < 0.02, "{worst_m} m, {worst} rad");
        // Twice as fine: an eighth and a quarter of it, and more.
        let fine = Smooth::new(&[sphere(8, 1000.0)], &projection, 1000.0).unwrap();
        let worst_fine_m = (0..2500).fold(0.0f64, |worst_m, i| {
            let (x_m, y_m) = (f64::from(i % 50) * 38.0 - 931.0, f64::from(i / 50) * 38.0 - 931.0);
            worst_m.max((fine.at(&projection, x_m, y_m).unwrap().0.length() - 1000.0).abs())
        });
        assert!(worst_fine_m < worst_m / 6.0, "{worst_fine_m} after {worst_m}");
    }

    #[test]
    fn facets_leave_no_edges() {
        // Heights of anything: the tangent plane is one on both sides of each edge of the map.
        let mut mesh = sphere(4, 1000.0);
        for (k, v) in mesh.vertices_m.iter_mut().enumerate() {
            *v *= 1.0 + 0.05 * (k as f64 * 2.7).sin();
        }
        let projection = projection(1000.0);
        let smooth = Smooth::new(std::slice::from_ref(&mesh), &projection, 900.0).unwrap();
        let mut seen = 0;
        for facet in &smooth.parts[0].facets {
            let [a, b, _] = facet.map(|v| smooth.parts[0].corners[v as usize].at);
            let middle = 0.5 * (a + b);
            if middle.abs().max_element() > 850.0 {
                continue;
            }
            let across = (b - a).perp().normalize() * 1e-5;
            let [(p, m), (q, n)] =
                [middle + across, middle - across].map(|at| smooth.at(&projection, at.x, at.y).unwrap());
            assert!((p - q).length() < 1e-4 && (m - n).length() < 1e-5, "{middle}: {m} {n}");
            seen += 1;
        }
        assert!(seen > 60, "{seen}");
    }

    #[test]
    fn a_finer_mesh_counts_where_it_is_and_meets_the_coarse_one_smoothly() {
        let coarse = sphere(4, 1000.0);
        // A cap of a finer sphere that is 10 m higher.
        let mut fine = sphere(16, 1010.0);
        let projection = projection(1000.0);
        fine.facets.retain(|f| f.iter().all(|v| fine.vertices_m[*v as usize].dot(projection.up) > 900.0));
        let smooth = Smooth::new(&[coarse, fine], &projection, 1000.0).unwrap();
        let height_m = |x_m: f64| smooth.at(&projection, x_m, 0.0).unwrap().0.length();
        assert!((height_m(0.0) - 1010.0).abs() < 0.01 && (height_m(800.0) - 1000.0).abs() < 1.0);
        // No step: 10 m over three facets of about 70 m.
        let steepest = (0..8000).fold(0.0f64, |most, i| {
            most.max((height_m(0.1 * f64::from(i) + 0.1) - height_m(0.1 * f64::from(i))).abs() / 0.1)
        });
        assert!((0.03..0.3).contains(&steepest), "{steepest}");
    }

    #[test]
    fn folds_and_holes_are_seen() {
        let mut mesh = sphere(4, 1000.0);
        let projection = projection(1000.0);
        let (point_m, normal) = hit(std::slice::from_ref(&mesh), projection.up).unwrap();
        assert!(point_m.length() <= 1000.0 && point_m.length() > 980.0 && normal.dot(projection.up) > 0.999);
        // The same line meets a vertex.
        let vertex = mesh.vertices_m[5];
        assert!((hit(std::slice::from_ref(&mesh), vertex.normalize()).unwrap().0 - vertex).length() < 1e-9);
        let top = (0..mesh.facets.len())
            .max_by(|&a, &b| {
                mesh.facet(a).normal().dot(projection.up).total_cmp(&mesh.facet(b).normal().dot(projection.up))
            })
            .unwrap();
        let facet = mesh.facets[top];
        mesh.facets[top] = [facet[0], facet[2], facet[1]];
        let message = Smooth::new(std::slice::from_ref(&mesh), &projection, 500.0).unwrap_err();
        assert!(message.contains(&format!("first facet {top}")), "{message}");
        // A second shell over the first.
        mesh.facets[top] = facet;
        let shell = Mesh {
            vertices_m: mesh.vertices_m.iter().map(|v| *v * 1.1).collect(),
            facets: mesh.facets.clone(),
            ..Mesh::default()
        };
        let mut two = mesh.clone();
        two.append(shell);
        assert!(hit(std::slice::from_ref(&two), projection.up).is_none());
        assert!(Smooth::new(&[two], &projection, 500.0).unwrap().at(&projection, 3.0, 5.0).is_none());
        let one = Smooth::new(std::slice::from_ref(&mesh), &projection, 500.0).unwrap();
        assert!(one.at(&projection, 3.0, 5.0).is_some());
        mesh.facets.remove(top);
        let smooth = Smooth::new(std::slice::from_ref(&mesh), &projection, 500.0).unwrap();
        assert!(smooth.at(&projection, 0.0, 0.0).is_none());
        assert!(hit(std::slice::from_ref(&mesh), projection.up).is_none());
    }
}
