//! What boulders look like: closed bodies, cut from a ball or raised from it.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

use crate::geometry::{index_u32, whole};
use crate::landscape::recipe::Shape;
use crate::random::Draws;

/// A ball of 20 `frequency`^2 facets: an icosahedron with each edge cut into `frequency` parts, blown up to radius 1.
#[derive(Debug, Clone)]
pub(in crate::landscape) struct Ball {
    pub(in crate::landscape) vertices: Vec<DVec3>,
    pub(in crate::landscape) facets: Vec<[u32; 3]>,
}

impl Ball {
    pub(in crate::landscape) fn new(frequency: u32) -> Self {
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

/// A boulder's vertices in m, one for each of the ball's, about the origin; z is the direction that it rests on.
///
/// The ball is cut by planes, or raised into knobs, stretched so that its axes measure what its shape says, and turned: by any angle about the upright, and
/// tilted a little. Moving vertices along rays from the ball's centre keeps it closed and its facets outward; so do stretch and turn. The ball's form
/// depends on direction alone: a finer ball is the same boulder, finer.
pub(super) fn vertices_m(ball: &Ball, shape: Shape, diameter_m: f64, key: u64) -> Vec<DVec3> {
    let mut draws = Draws::new(key ^ u64::MAX);
    let form = Form::new(shape, &mut draws);
    let axes_m = diameter_m * form.axes;
    let turn = DQuat::from_rotation_z(draws.between(0.0, TAU));
    let tilt = DQuat::from_rotation_x(form.tilt * draws.normal().clamp(-2.0, 2.0))
        * DQuat::from_rotation_y(form.tilt * draws.normal().clamp(-2.0, 2.0));
    let turn = DMat3::from_quat(turn * tilt);
    let mut vertices: Vec<DVec3> = ball.vertices.iter().map(|&v| form.radius(v) * v).collect();
    let (lo, hi) = bounds(&vertices);
    for v in &mut vertices {
        *v = turn * ((*v - 0.5 * (lo + hi)) / (hi - lo) * axes_m);
    }
    vertices
}

/// What a boulder looks like before it is stretched.
struct Form {
    /// Planes that cut it: unit normals, and distances from its centre.
    cuts: Vec<(DVec3, f64)>,
    /// Directions of knobs, and how far they stand out.
    knobs: Vec<(DVec3, f64)>,
    /// Lengths of its axes; the first is 1.
    axes: DVec3,
    /// How far it is tilted: standard deviation about each axis, rad.
    tilt: f64,
}

impl Form {
    fn new(shape: Shape, draws: &mut Draws) -> Self {
        // How many cuts and knobs, how far the cuts are from the centre, the axes, and the tilt.
        let (cuts, knobs, nearest, second, third, tilt) = match shape {
            Shape::Angular => (12, 0, 0.6, (0.6, 0.9), (0.4, 0.7), 0.3),
            Shape::Rounded => (0, 6, 1.0, (0.75, 0.95), (0.6, 0.8), 0.3),
            Shape::Slab => (10, 0, 0.55, (0.6, 1.0), (0.15, 0.35), 0.1),
            Shape::Shard => (9, 0, 0.5, (0.3, 0.5), (0.2, 0.4), 0.2),
            Shape::Lumpy => (4, 14, 0.75, (0.75, 0.95), (0.65, 0.85), 0.5),
            Shape::Any => {
                let all = [Shape::Angular, Shape::Rounded, Shape::Slab, Shape::Shard, Shape::Lumpy];
                return Form::new(all[whole(draws.between(0.0, all.len() as f64))], draws);
            }
        };
        let cuts = (0..cuts).map(|_| (unit_vector(draws), draws.between(nearest, 0.95))).collect();
        let height = if knobs > 10 { 0.45 } else { 0.15 };
        let knobs = (0..knobs).map(|_| (unit_vector(draws), draws.between(0.2, 1.0) * height)).collect();
        let axes = DVec3::new(1.0, draws.between(second.0, second.1), draws.between(third.0, third.1));
        Form { cuts, knobs, axes, tilt }
    }

    /// How far its surface is from its centre in this direction.
    fn radius(&self, v: DVec3) -> f64 {
        let knobs: f64 = self.knobs.iter().map(|(at, height)| height * at.dot(v).max(0.0).powi(8)).sum();
        let cut = self.cuts.iter().map(|(normal, distance)| distance / normal.dot(v)).filter(|r| *r > 0.0);
        cut.fold(1.0 + knobs, f64::min)
    }
}

/// A unit vector, all directions alike: drawn from the cube until it falls into the ball.
fn unit_vector(draws: &mut Draws) -> DVec3 {
    loop {
        let v = DVec3::from_array(std::array::from_fn(|_| draws.between(-1.0, 1.0)));
        let square = v.length_squared();
        if square > 0.01 && square <= 1.0 {
            return v / square.sqrt();
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
    fn boulders_have_the_axes_of_their_shape_and_are_the_same_when_finer() {
        let (coarse, fine) = (Ball::new(3), Ball::new(4));
        let mut seen = 0;
        // Boxes of 1 x second x third, of which a ball fills pi / 6 = 0.52, and a ball with cuts or knobs 0.3 to 0.7.
        for (shape, least, most) in [
            (Shape::Angular, 0.6 * 0.4, 0.9 * 0.7),
            (Shape::Rounded, 0.75 * 0.6, 0.95 * 0.8),
            (Shape::Slab, 0.6 * 0.15, 0.35),
            (Shape::Shard, 0.3 * 0.2, 0.5 * 0.4),
            (Shape::Lumpy, 0.75 * 0.65, 0.95 * 0.85),
            (Shape::Any, 0.3 * 0.2, 0.95 * 0.85),
        ] {
            for key in 0..50 {
                let [a, b] = [&coarse, &fine].map(|ball| vertices_m(ball, shape, 5.0, key * 7919));
                let longest =
                    |v: &[DVec3]| v.iter().flat_map(|p| v.iter().map(|q| p.distance(*q))).fold(0.0, f64::max) / 5.0;
                assert!((0.9..1.3).contains(&longest(&a)), "{shape:?} {}", longest(&a));
                assert!((longest(&a) - longest(&b)).abs() < 0.15, "{shape:?}");
                let volumes = [volume_m3(&a, &coarse.facets), volume_m3(&b, &fine.facets)];
                assert!((volumes[0] / volumes[1] - 1.0).abs() < 0.2, "{shape:?} {volumes:?}");
                let filled = volumes[1] / 125.0;
                assert!((0.3 * least..0.7 * most).contains(&filled), "{shape:?} {filled}");
                seen += 1;
            }
        }
        assert_eq!(seen, 300);
    }
}
