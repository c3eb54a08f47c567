//! The painter's algorithm, for comparison: facets are painted over one another from far to near, each as far as its centroid is.
//!
//! It is done with exact areas: each facet is moved to a depth of its own, all over, and what then is seen is seen by the product's
//! engine. So what differs from the exact image is the order alone.

use glam::DVec3;

use crate::geometry::{Direction, Mesh, index_u32};
use crate::integrate;
use crate::progress::unwatched;
use crate::scene::Scene;
use crate::visibility::{Seen, Shown, Topology};

/// The image of a scene whose facets are lit as `sunlit` says, painted: the radiance of its first material's band is reflectance x cos i.
///
/// Facets are sorted by the distance of their centroids from the camera along its boresight; those that face away are left out.
pub fn painted_image(scene: &Scene, sunlit: &Seen, reflectances: &[f64]) -> Vec<f64> {
    let (camera, mesh) = (&scene.exposure.camera, &scene.body.mesh);
    let (eye_m, rotation) = (camera.centre_m(), camera.world_from_sensor.rotation);
    let boresight = rotation.z_axis;
    let faces = |f: usize| mesh.facet(f).cross_m2().dot(eye_m - mesh.facet(f).corners_m[0]) > 0.0;
    let order = sorted(mesh, faces, |p_m| (p_m - eye_m).dot(boresight));
    let flat = flattened(mesh, &order, |p_m, depth| {
        let away = p_m - eye_m;
        eye_m + away * (depth / away.dot(boresight))
    });
    let on_flat = |place: usize, uv: [f64; 2]| {
        let away = mesh.facet(order[place] as usize).point_m(uv[0], uv[1]) - eye_m;
        on_facet(&flat, place, eye_m + away * (depth_of(place) / away.dot(boresight)))
    };
    let lit = carried(sunlit, &order, on_flat);
    let footprints = integrate::footprints(&flat, &Topology::new(&flat), &lit, camera);
    let towards = scene.sky.sun.direction.vec();
    let radiance = |place: u32| {
        let facet = order[place as usize] as usize;
        let cos = mesh.facet(facet).normal().dot(towards).max(0.0);
        reflectances[mesh.material[facet].0 as usize] * cos
    };
    let pixels = camera.samples as usize * camera.lines as usize;
    (0..pixels).map(|pixel| footprints.pixel(pixel).map(|(place, _, lit)| lit * radiance(place)).sum()).collect()
}

/// What the Sun sees of each facet if it is painted: those that face away are dark, and hide nothing.
pub fn painted_sunlight(mesh: &Mesh, towards: Direction) -> Seen {
    let w = towards.vec();
    let faces = |f: usize| mesh.facet(f).cross_m2().dot(w) > 0.0;
    let order = sorted(mesh, faces, |p_m| -p_m.dot(w));
    let flat = flattened(mesh, &order, |p_m, depth| p_m - w * (p_m.dot(w) + depth));
    // Nothing asks to stop.
    let seen = Seen::from_afar(&flat, &Topology::new(&flat), towards, "painter", &unwatched).unwrap_or_default();
    // (u, v) of a facet are the same on its flattened copy.
    let mut of_facet = vec![usize::MAX; mesh.facets.len()];
    order.iter().enumerate().for_each(|(place, f)| of_facet[*f as usize] = place);
    let mut sunlit = Seen { polygon_start: vec![0], ..Seen::default() };
    for (f, place) in of_facet.into_iter().enumerate() {
        let shown = if place == usize::MAX { Shown::Nothing } else { seen.shown[place] };
        sunlit.shown.push(shown);
        if shown == Shown::Part {
            for polygon in seen.polygons(index_u32(place)) {
                sunlit.uv.extend_from_slice(polygon);
                sunlit.polygon_facet.push(index_u32(f));
                sunlit.polygon_start.push(sunlit.uv.len());
            }
        }
    }
    sunlit
}

/// The facets that face the eye, from near to far by their centroids; of equal ones the later is painted over the earlier.
fn sorted(mesh: &Mesh, faces: impl Fn(usize) -> bool, depth: impl Fn(DVec3) -> f64) -> Vec<u32> {
    let mut order: Vec<(f64, u32)> = (0..mesh.facets.len())
        .filter(|f| faces(*f))
        .map(|f| (depth(mesh.facet(f).centroid_m()), index_u32(f)))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    order.into_iter().map(|(_, f)| f).collect()
}

/// Depth of a facet in the order, m: 1000 for the nearest, and a metre more for each that follows.
fn depth_of(rank: usize) -> f64 {
    1000.0 + rank as f64
}

/// Where on a facet of a mesh a point of its plane lies.
fn on_facet(mesh: &Mesh, facet: usize, point_m: DVec3) -> [f64; 2] {
    let [a, b, c] = mesh.facet(facet).corners_m;
    let (ab, ac, ap) = (b - a, c - a, point_m - a);
    let normal = ab.cross(ac);
    let scale = normal.length_squared();
    [ap.cross(ac).dot(normal) / scale, ab.cross(ap).dot(normal) / scale]
}

/// What is seen of facets, as what is seen of their copies in the order.
fn carried(seen: &Seen, order: &[u32], place_uv: impl Fn(usize, [f64; 2]) -> [f64; 2]) -> Seen {
    let mut copy = Seen { polygon_start: vec![0], ..Seen::default() };
    for (place, f) in order.iter().enumerate() {
        copy.shown.push(seen.shown[*f as usize]);
        if seen.shown[*f as usize] == Shown::Part {
            for polygon in seen.polygons(*f) {
                copy.uv.extend(polygon.iter().map(|uv| place_uv(place, *uv)));
                copy.polygon_facet.push(index_u32(place));
                copy.polygon_start.push(copy.uv.len());
            }
        }
    }
    copy
}

/// These facets, each at a [depth](depth_of) of its own.
fn flattened(mesh: &Mesh, order: &[u32], at_depth: impl Fn(DVec3, f64) -> DVec3) -> Mesh {
    let mut flat = Mesh::default();
    for (rank, f) in order.iter().enumerate() {
        let first = index_u32(flat.vertices_m.len());
        let depth = depth_of(rank);
        flat.vertices_m.extend(mesh.facet(*f as usize).corners_m.map(|p_m| at_depth(p_m, depth)));
        flat.facets.push([first, first + 1, first + 2]);
        flat.material.push(mesh.material[*f as usize]);
    }
    flat
}
