//! Boulders: closed bodies with flats and edges, cut from a ball.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec3};

use super::random::{Purpose, key};
use super::recipe::Boulders;
use crate::geometry::index_u32;
use crate::random::Draws;

/// Planes that cut a boulder from its ball.
const CUTS: usize = 12;

/// A ball of 20 `frequency`^2 facets: an icosahedron with each edge cut into `frequency` parts, blown up to radius 1.
#[derive(Debug, Clone)]
pub(super) struct Ball {
    pub(super) vertices: Vec<DVec3>,
    pub(super) facets: Vec<[u32; 3]>,
}

impl Ball {
    pub(super) fn new(frequency: u32) -> Self {
        // (0, +-1, +-golden ratio) and its cyclic turns; counter-clockwise seen from outside.
        let g = 0.5 * (1.0 + 5f64.sqrt());
        let corners: [DVec3; 12] = [
            [-1.0, g, 0.0],
            [1.0, g, 0.0],
            [-1.0, -g, 0.0],
            [1.0, -g, 0.0],
            [0.0, -1.0, g],
            [0.0, 1.0, g],
            [0.0, -1.0, -g],
            [0.0, 1.0, -g],
            [g, 0.0, -1.0],
            [g, 0.0, 1.0],
            [-g, 0.0, -1.0],
            [-g, 0.0, 1.0],
        ]
        .map(DVec3::from_array);
        #[rustfmt::skip]
        let faces: [[usize; 3]; 20] = [
            [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
            [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
            [8, 6, 7], [9, 8, 1],
        ];
        let mut ball = Ball { vertices: Vec::new(), facets: Vec::new() };
        // A point is known by its weights at the corners, so that faces share the points on their edges.
        let mut known = BTreeMap::new();
        for face in faces {
            let mut vertex = |i: u32, j: u32| {
                let mut weights = [(face[0], frequency - i - j), (face[1], i), (face[2], j)];
                weights.sort_unstable();
                let place = weights.into_iter().filter(|w| w.1 > 0).collect::<Vec<_>>();
                *known.entry(place).or_insert_with_key(|place| {
                    let sum: DVec3 = place.iter().map(|&(corner, weight)| corners[corner] * f64::from(weight)).sum();
                    ball.vertices.push(sum.normalize());
                    index_u32(ball.vertices.len()) - 1
                })
            };
            let mut facets = Vec::new();
            for i in 0..frequency {
                for j in 0..frequency - i {
                    facets.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                    if i + j + 2 <= frequency {
                        facets.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                    }
                }
            }
            ball.facets.extend(facets);
        }
        ball
    }
}

/// One boulder of the site, still without a height.
#[derive(Debug, Clone)]
pub(super) struct Boulder {
    /// Where it lies, m.
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    /// Longest axis, m.
    pub(super) diameter_m: f64,
    key: u64,
}

/// All boulders of a recipe; boulder i does not depend on how many there are.
pub(super) fn boulders(boulders: &Boulders, seed: u64, size_m: f64) -> impl Iterator<Item = Boulder> {
    (0..boulders.count).map(move |i| {
        let key = key(seed, Purpose::Boulder, i.into());
        let mut draws = Draws::new(key);
        let diameter_m = draws.power_law(boulders.min_diameter_m, boulders.max_diameter_m, boulders.exponent);
        // None sticks out over the border.
        let half_m = 0.5 * (size_m - diameter_m);
        let (x_m, y_m) = (draws.between(-half_m, half_m), draws.between(-half_m, half_m));
        Boulder { x_m, y_m, diameter_m, key }
    })
}

impl Boulder {
    /// The boulder's vertices in m, one for each of the ball's, about (0, 0) in x and y and from z = 0 up.
    ///
    /// The ball is cut by planes, stretched so that its axes measure 1 : 0.6-0.9 : 0.4-0.7 of the diameter, and turned
    /// at random. Moving vertices along rays from the ball's centre keeps it closed and its facets outward; so do
    /// stretch and turn. The cuts depend on direction alone: a finer ball is the same boulder, finer.
    pub(super) fn vertices_m(&self, ball: &Ball) -> Vec<DVec3> {
        let mut draws = Draws::new(self.key ^ u64::MAX);
        let cuts: [(DVec3, f64); CUTS] =
            std::array::from_fn(|_| (DVec3::from_array(unit_vector(&mut draws)), draws.between(0.6, 0.95)));
        let axes_m = self.diameter_m * DVec3::new(1.0, draws.between(0.6, 0.9), draws.between(0.4, 0.7));
        let turn = DMat3::from_quat(DQuat::from_array(unit_vector(&mut draws)));

        let radius = |v: DVec3| {
            let cut = cuts.iter().map(|(normal, height)| height / normal.dot(v)).filter(|r| *r > 0.0);
            cut.fold(1.0, f64::min)
        };
        let mut vertices: Vec<DVec3> = ball.vertices.iter().map(|&v| radius(v) * v).collect();
        let (lo, hi) = bounds(&vertices);
        for v in &mut vertices {
            *v = turn * ((*v - 0.5 * (lo + hi)) / (hi - lo) * axes_m);
        }
        let (lo, hi) = bounds(&vertices);
        let foot = DVec3::new(0.5 * (lo.x + hi.x), 0.5 * (lo.y + hi.y), lo.z);
        for v in &mut vertices {
            *v -= foot;
        }
        vertices
    }
}

/// A unit vector, all directions alike: drawn from the cube until it falls into the ball.
fn unit_vector<const N: usize>(draws: &mut Draws) -> [f64; N] {
    loop {
        let v: [f64; N] = std::array::from_fn(|_| draws.between(-1.0, 1.0));
        let square = v.iter().map(|x| x * x).sum::<f64>();
        if square > 0.01 && square <= 1.0 {
            return v.map(|x| x / square.sqrt());
        }
    }
}

fn bounds(vertices: &[DVec3]) -> (DVec3, DVec3) {
    let first = vertices.first().copied().unwrap_or_default();
    vertices.iter().fold((first, first), |(lo, hi), v| (lo.min(*v), hi.max(*v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume by the divergence theorem, m3.
    fn volume_m3(vertices: &[DVec3], facets: &[[u32; 3]]) -> f64 {
        let corner = |i: u32| vertices[i as usize];
        facets.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
    }

    #[test]
    fn balls_are_closed_and_fill_the_sphere() {
        // An icosahedron of circumradius 1: edge 4 / sqrt(10 + 2 sqrt 5), volume 5 (3 + sqrt 5) / 12 edge^3.
        let edge = 4.0 / (10.0 + 2.0 * 5f64.sqrt()).sqrt();
        let icosahedron = 5.0 / 12.0 * (3.0 + 5f64.sqrt()) * edge.powi(3);
        let mut last = 0.0;
        for frequency in 1..=4 {
            let ball = Ball::new(frequency);
            // 20 f^2 facets, and by Euler V = F / 2 + 2.
            assert_eq!(ball.facets.len() as u32, 20 * frequency * frequency);
            assert_eq!(ball.vertices.len(), ball.facets.len() / 2 + 2);
            let volume = volume_m3(&ball.vertices, &ball.facets);
            if frequency == 1 {
                assert!((volume - icosahedron).abs() < 1e-12);
            }
            assert!(volume > last && volume < 4.0 / 3.0 * std::f64::consts::PI);
            last = volume;
        }
    }

    #[test]
    fn boulders_keep_their_size_place_and_shape_when_finer() {
        let recipe = Boulders { count: 50, ..Boulders::default() };
        let (coarse, fine) = (Ball::new(3), Ball::new(4));
        let mut seen = 0;
        for boulder in boulders(&recipe, 9, 2000.0) {
            assert!((2.0..=12.0).contains(&boulder.diameter_m));
            assert!(boulder.x_m.abs() + 0.5 * boulder.diameter_m <= 1000.0);
            let [a, b] = [&coarse, &fine].map(|ball| boulder.vertices_m(ball));
            let longest = |v: &[DVec3]| {
                v.iter().flat_map(|p| v.iter().map(|q| p.distance(*q))).fold(0.0, f64::max) / boulder.diameter_m
            };
            assert!((0.9..1.25).contains(&longest(&a)), "{}", longest(&a));
            assert!((longest(&a) - longest(&b)).abs() < 0.1);
            let volumes = [volume_m3(&a, &coarse.facets), volume_m3(&b, &fine.facets)];
            assert!((volumes[0] / volumes[1] - 1.0).abs() < 0.15, "{volumes:?}");
            // Boxes of 1 x 0.6 x 0.4 to 1 x 0.9 x 0.7, of which a ball fills pi / 6 = 0.52 and a cut ball 0.4 to 0.65.
            assert!((0.24 * 0.4..0.63 * 0.65).contains(&(volumes[1] / boulder.diameter_m.powi(3))), "{volumes:?}");
            seen += 1;
        }
        assert_eq!(seen, 50);
    }
}
