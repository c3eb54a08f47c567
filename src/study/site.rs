//! Properties of a mesh as a site: which way is up, how steep it is, and where rays leave it.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::polygon::side;
use crate::geometry::{Direction, Facet, Mesh, hull};
use crate::physics::bounds::surroundings_form_factor;
use crate::visibility::Topology;

/// Shares of area are taken over this many facets.
const SAMPLE: usize = 8192;
/// Below this ratio of vector area to area (a hemisphere's) an open mesh is a body with holes, not a site.
const SITE_RATIO: f64 = 0.5;
/// Facets and vertices are processed this many at a time.
const CHUNK: usize = 65_536;

/// A mesh as a place.
pub(super) struct Site {
    /// The mean normal of an open sheet; `None` for a body, closed or nearly so.
    pub(super) up: Option<DVec3>,
    /// Whether some edge has a facet on one side only.
    pub(super) is_open: bool,
    /// Cosine of the steepest slope against `up`, 0 if it is overhanging; 0 for a body.
    pub(super) cos_steepest: f64,
    /// Whether it is a body that bulges everywhere.
    is_convex: bool,
    /// Lowest and highest coordinate along `up`, m; of no meaning for a body.
    height_m: (f64, f64),
    /// Corners of the box around all vertices, m.
    pub(super) box_m: (DVec3, DVec3),
    pub(super) zero_area_facets: u64,
    /// Median area of a facet, m2, of a sample: that of a site in detail, however large the facets around it are.
    pub(super) facet_m2: f64,
    /// Whether facets around a part in detail are far larger: light between facets takes lines for each.
    pub(super) is_graded: bool,
}

/// A mean area of facets this many times the median is that of a few far larger ones.
const GRADED: f64 = 4.0;

impl Site {
    /// A bound of the form factor of any facet's surroundings.
    pub(super) fn most_around(&self) -> f64 {
        if self.is_convex { 0.0 } else { surroundings_form_factor(self.cos_steepest) }
    }

    pub(super) fn new(mesh: &Mesh, topology: &Topology) -> Self {
        let (mut vector_m2, mut area_m2, mut areas_m2) = (DVec3::ZERO, 0.0, Vec::new());
        for facet in mesh.spread(SAMPLE) {
            let cross_m2 = mesh.facet(facet).cross_m2();
            vector_m2 += cross_m2;
            area_m2 += cross_m2.length();
            areas_m2.push(0.5 * cross_m2.length());
        }
        let is_open = topology.open_edges > 0;
        let up = Direction::new(vector_m2).filter(|_| is_open && vector_m2.length() >= SITE_RATIO * area_m2);
        let up = up.map(Direction::vec);
        // Extremes and counts are the same in any order.
        let (cos2_steepest, zero_area_facets) = mesh
            .facets
            .par_chunks(CHUNK)
            .map(|facets| steepest(mesh, facets, up))
            .reduce(|| (1.0, 0), |a, b| (f64::min(a.0, b.0), a.1 + b.1));
        let none =
            Extent { height_m: (f64::INFINITY, f64::NEG_INFINITY), box_m: (DVec3::INFINITY, DVec3::NEG_INFINITY) };
        let extent = mesh
            .vertices_m
            .par_chunks(CHUNK)
            .map(|vertices_m| vertices_m.iter().fold(none, |all, v| all.with(Extent::of(*v, up))))
            .reduce(|| none, Extent::with);
        let cos_steepest = if up.is_some() { cos2_steepest.sqrt() } else { 0.0 };
        let Extent { height_m, box_m } = extent;
        areas_m2.sort_unstable_by(f64::total_cmp);
        let facet_m2 = areas_m2.get(areas_m2.len() / 2).copied().unwrap_or(0.0);
        let is_graded = 0.5 * area_m2 > GRADED * facet_m2 * areas_m2.len() as f64;
        let is_convex = topology.is_convex(mesh);
        Site { up, is_open, cos_steepest, is_convex, height_m, box_m, zero_area_facets, facet_m2, is_graded }
    }

    /// Distance of a point from the box around the mesh, m: none of the surface is nearer.
    pub(super) fn distance_m(&self, point_m: DVec3) -> f64 {
        point_m.distance(point_m.clamp(self.box_m.0, self.box_m.1))
    }

    /// Longest way, m, that a ray at this cosine to `up` can go between two points of the surface.
    pub(super) fn longest_ray_m(&self, cos_to_up: f64) -> f64 {
        let across_m = (self.box_m.1 - self.box_m.0).length();
        match self.up {
            Some(_) if cos_to_up > 0.0 => ((self.height_m.1 - self.height_m.0) / cos_to_up).min(across_m),
            _ => across_m,
        }
    }

    /// Share of some facets, those of sights of the image, that face the Sun, and from which a ray towards it leaves the site's outline below its
    /// highest point: what lies outside might shadow them. 0 for a body, and of no facets.
    pub(super) fn open_to_shadow(&self, mesh: &Mesh, towards_sun: DVec3, facets: impl Iterator<Item = usize>) -> f64 {
        let Some(up) = self.up else { return 0.0 };
        let (east, north) = Direction::new(up).map_or((DVec3::X, DVec3::Y), Direction::frame);
        let level = |v: DVec3| [v.dot(east), v.dot(north)];
        let outline = hull(mesh.spread(SAMPLE).flat_map(|facet| mesh.facet(facet).corners_m).map(level).collect());
        let (rise, [x, y]) = (towards_sun.dot(up), level(towards_sun));
        // Height that a ray gains until it is over the outline: below 0 if the Sun is.
        let gain_m = |p_m: DVec3| {
            let ways_m = (0..outline.len()).filter_map(|i| {
                let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
                let outwards = (b[1] - a[1]) * x - (b[0] - a[0]) * y;
                (outwards > 0.0).then(|| side(a, b, level(p_m)).max(0.0) / outwards)
            });
            rise * ways_m.fold(f64::INFINITY, f64::min)
        };
        let (mut count, mut open) = (0.0, 0.0);
        for facet in facets {
            let facet = mesh.facet(facet);
            let p_m = facet.centroid_m();
            count += 1.0;
            if facet.cross_m2().dot(towards_sun) > 0.0 && p_m.dot(up) + gain_m(p_m) < self.height_m.1 {
                open += 1.0;
            }
        }
        if count > 0.0 { open / count } else { 0.0 }
    }
}

/// Square of the least cosine to `up`, 0 if it is negative, and the number of facets without area.
fn steepest(mesh: &Mesh, facets: &[[u32; 3]], up: Option<DVec3>) -> (f64, u64) {
    let (mut least, mut zero_area) = (1.0_f64, 0);
    for corners in facets {
        let cross_m2 = Facet { corners_m: corners.map(|v| mesh.vertices_m[v as usize]) }.cross_m2();
        let square = cross_m2.length_squared();
        if square == 0.0 {
            zero_area += 1;
        } else if let Some(up) = up {
            let along = cross_m2.dot(up).max(0.0);
            least = least.min(along * along / square);
        }
    }
    (least, zero_area)
}

/// How far points reach.
#[derive(Clone, Copy)]
struct Extent {
    height_m: (f64, f64),
    box_m: (DVec3, DVec3),
}

impl Extent {
    fn of(p_m: DVec3, up: Option<DVec3>) -> Self {
        let z_m = up.map_or(0.0, |up| p_m.dot(up));
        Extent { height_m: (z_m, z_m), box_m: (p_m, p_m) }
    }

    fn with(self, other: Self) -> Self {
        Extent {
            height_m: (self.height_m.0.min(other.height_m.0), self.height_m.1.max(other.height_m.1)),
            box_m: (self.box_m.0.min(other.box_m.0), self.box_m.1.max(other.box_m.1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::MaterialId;

    /// A square sheet of 2 n x 2 n cells of 1 m, turned in its plane by `turn_rad`, with a height.
    fn sheet(n: i32, turn_rad: f64, height_m: impl Fn(f64, f64) -> f64) -> Mesh {
        let (sin, cos) = turn_rad.sin_cos();
        let mut mesh = Mesh::default();
        for j in -n..=n {
            for i in -n..=n {
                let (x, y) = (f64::from(i), f64::from(j));
                mesh.vertices_m.push(DVec3::new(cos * x - sin * y, sin * x + cos * y, height_m(x, y)));
            }
        }
        let row = 2 * n as u32 + 1;
        for j in 0..row - 1 {
            for i in 0..row - 1 {
                let a = j * row + i;
                mesh.facets.extend([[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]);
            }
        }
        mesh.material = vec![MaterialId(0); mesh.facets.len()];
        mesh
    }

    #[test]
    fn rays_that_leave_below_the_top_are_counted() {
        // A plain of 100 x 100 m with a needle 10 m high in its middle, the Sun 45 deg high along a side: rays leave below
        // 10 m from the last 10 m of the plain, a tenth of it, however the plain is turned.
        for turn_rad in [0.0, 0.27, 0.5] {
            let mesh = sheet(50, turn_rad, |x, y| if x == 0.0 && y == 0.0 { 10.0 } else { 0.0 });
            let site = Site::new(&mesh, &Topology::new(&mesh));
            assert!((site.up.unwrap() - DVec3::Z).length() < 1e-2);
            let sun = DVec3::new(turn_rad.cos(), turn_rad.sin(), 1.0).normalize();
            let all = || 0..mesh.facets.len();
            let share = site.open_to_shadow(&mesh, sun, all());
            assert!((share - 0.1).abs() < 0.006, "{turn_rad}: {share}");
            // The mean normal is a little askew: of 20,000 facets one at the border may be counted.
            assert!(site.open_to_shadow(&mesh, DVec3::Z, all()) < 1e-3);
            // Of those that an image of the middle shows, next to none: the needle's own foot.
            let middle = all().filter(|f| mesh.facet(*f).centroid_m().length() < 30.0);
            assert!(site.open_to_shadow(&mesh, sun, middle) < 1e-3);
            // The mean normal is a little askew.
            assert!((site.longest_ray_m(0.5) - 20.0).abs() < 2.0);
        }
    }

    #[test]
    fn slopes_and_facets_without_area_are_found() {
        let mut mesh = sheet(20, 0.0, |x, _| 0.5 * x);
        mesh.facets.push([0, 0, 1]);
        let site = Site::new(&mesh, &Topology::new(&mesh));
        // Upright against its own mean plane.
        assert!((site.cos_steepest - 1.0).abs() < 1e-12);
        assert_eq!(site.zero_area_facets, 1);
        let roof = sheet(20, 0.0, |x, _| -x.abs());
        let site = Site::new(&roof, &Topology::new(&roof));
        assert!((site.cos_steepest - 0.5f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_body_is_no_site() {
        let (a, b, c, d) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
        let facets = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mesh = Mesh { vertices_m: vec![a, b, c, d], facets, material: vec![MaterialId(0); 4], ..Mesh::default() };
        let site = Site::new(&mesh, &Topology::new(&mesh));
        assert!(site.up.is_none() && !site.is_open && site.cos_steepest == 0.0);
        assert_eq!(site.open_to_shadow(&mesh, DVec3::X, 0..4), 0.0);
        assert!((site.longest_ray_m(1.0) - 3f64.sqrt()).abs() < 1e-15);
    }
}
