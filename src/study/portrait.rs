//! What a mesh looks like, to look for mistakes in it: from four sides, under one light. Inner sides are red.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::visibility::RayTree;

/// A side of a mesh, from afar.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    /// What it is called.
    pub name: &'static str,
    /// Towards the viewer, and up in the picture; in the mesh's axes.
    towards: DVec3,
    up: DVec3,
}

/// Obliquely, and along each axis.
pub const SIDES: [Side; 4] = [
    Side { name: "from x = y = z", towards: DVec3::ONE, up: DVec3::Z },
    Side { name: "from +z, y up", towards: DVec3::Z, up: DVec3::Y },
    Side { name: "from +x, z up", towards: DVec3::X, up: DVec3::Z },
    Side { name: "from +y, z up", towards: DVec3::Y, up: DVec3::Z },
];

/// Rays along a side of a pixel.
const RAYS: usize = 2;
/// What is lit from the side still shows this much of its colour.
const DARKEST: f64 = 0.2;
const OUTER: [f64; 3] = [235.0, 235.0, 235.0];
const INNER: [f64; 3] = [225.0, 70.0, 50.0];
const SKY: [f64; 3] = [255.0, 255.0, 255.0];

/// A picture of so many pixels in a square, rows from the top, red, green, blue, for each of [`SIDES`]: all at one scale, the whole mesh in
/// view, its middle in the middle. Lambert's law of a light over the viewer's left shoulder; no shadows.
pub fn portraits(mesh: &Mesh, pixels: usize) -> Vec<Vec<u8>> {
    let mesh = &centred(mesh);
    let tree = RayTree::new(mesh);
    // The far corners are in view from everywhere.
    let radius = mesh.bounds_m().map_or(0.0, |(low, high)| 0.5 * (high - low).length());
    let one = |side: &Side| {
        let ahead = -side.towards.normalize();
        let right = ahead.cross(side.up).normalize();
        let up = right.cross(ahead);
        let light = (up - right - 1.5 * ahead).normalize();
        let colour = |x: f64, y: f64| {
            let from = radius * (x * right + y * up - 2.0 * ahead);
            let Some(hit) = tree.nearest(from, ahead) else { return SKY };
            let normal = mesh.facet(hit.facet as usize).cross_m2().normalize_or_zero();
            let cosine = if hit.front { normal.dot(light) } else { -normal.dot(light) };
            let shown = DARKEST + (1.0 - DARKEST) * cosine.max(0.0);
            (if hit.front { OUTER } else { INNER }).map(|channel| shown * channel)
        };
        let row = |row: usize| {
            let at = |i: usize, k: usize| (2.0 * ((i * RAYS + k) as f64 + 0.5)) / (pixels * RAYS) as f64 - 1.0;
            let pixel = |column: usize| {
                let mut sum = [0.0; 3];
                for (k, l) in (0..RAYS).flat_map(|k| (0..RAYS).map(move |l| (k, l))) {
                    let colour = colour(at(column, k), -at(row, l));
                    (0..3).for_each(|c| sum[c] += colour[c]);
                }
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
                sum.map(|channel| (channel / (RAYS * RAYS) as f64).round() as u8)
            };
            (0..pixels).flat_map(pixel).collect::<Vec<u8>>()
        };
        (0..pixels).into_par_iter().flat_map_iter(row).collect()
    };
    SIDES.iter().map(one).collect()
}

/// About the origin, and within 1 of it along each axis, so that neither where a mesh lies nor how large it is takes digits.
fn centred(mesh: &Mesh) -> Mesh {
    let (low, high) = mesh.bounds_m().unwrap_or_default();
    let middle = 0.5 * low + 0.5 * high;
    let half = (0.5 * high - 0.5 * low).max_element();
    let scaled = |v: &DVec3| if half > 0.0 { (*v - middle) / half } else { DVec3::ZERO };
    Mesh { vertices_m: mesh.vertices_m.iter().map(scaled).collect(), ..mesh.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_grey_from_above_and_red_from_below() {
        // 2 x 2 in z = 0, facing up: its half diagonal fills the picture, so that it reaches over 1 / sqrt 2 of its width.
        let square = |facets: [[u32; 3]; 2]| Mesh {
            vertices_m: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[x, y]| DVec3::new(x, y, 0.0))
                .to_vec(),
            facets: facets.to_vec(),
            ..Mesh::default()
        };
        let up = portraits(&square([[0, 1, 2], [0, 2, 3]]), 100);
        let at = |picture: &[u8], column: usize, row: usize| {
            let i = 3 * (100 * row + column);
            [picture[i], picture[i + 1], picture[i + 2]]
        };
        // The light's cosine is 1.5 / sqrt(1 + 1 + 2.25).
        let shown = (DARKEST + (1.0 - DARKEST) * 1.5 / 4.25_f64.sqrt()) * 235.0;
        assert_eq!(at(&up[1], 50, 50), [shown.round() as u8; 3]);
        assert_eq!((at(&up[1], 13, 50), at(&up[1], 16, 50)[0] < 255), ([255; 3], true));
        assert_eq!(at(&up[1], 86, 86), [255; 3]);
        let down = portraits(&square([[0, 2, 1], [0, 3, 2]]), 100);
        let [red, green, _] = at(&down[1], 50, 50);
        assert!(red > 150 && green < 100);
        // The same wherever it lies and however large it is, with exact sums.
        for (factor, place) in [(1.0, 2.0_f64.powi(40)), (2.0_f64.powi(1000), 0.0), (2.0_f64.powi(-1000), 0.0)] {
            let mut moved = square([[0, 1, 2], [0, 2, 3]]);
            moved.vertices_m.iter_mut().for_each(|v| *v = factor * *v + place);
            assert!(portraits(&moved, 100) == up, "{factor} {place}");
        }
        // Edge on nothing is seen, and of nothing nothing.
        assert!(portraits(&Mesh::default(), 4).iter().flatten().all(|v| *v == 255));
    }
}
