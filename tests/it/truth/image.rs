//! What a pixel sees, by half-planes in numbers of 106 bits. It shares no code with the library, and no idea but the conventions.
//!
//! With the eye as origin and rays r = (x, y, 1) every condition is linear in r: that a ray meets a facet, that it meets one
//! before another, and that where it meets one the shadow of another lies. From each facet's part of a pixel all that hides it
//! is taken away, one convex region after the other, and then all that is shaded.

use glam::DVec3;
use mmxrt::geometry::FrameCamera;
use mmxrt::geometry::Mesh;

use super::double::*;

/// Numbers that differ by less than this, relative to what they are made of, are the same: coplanar facets.
const SAME: f64 = 1e-24;
/// A facet is seen edge-on from a direction whose sine is below this.
const EDGE_ON: f64 = 1e-27;

/// A pixel's truth. Areas in pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Truth {
    pub(super) coverage: f64,
    /// What shows its outer side.
    pub(super) front: f64,
    /// What of that is lit, of facets whose cosine of incidence is more than [`GRAZING`].
    pub(super) lit: f64,
    /// Sum of reflectance x cosine of incidence x lit area: pi L / E.
    pub(super) radiance: f64,
}

/// Facets under flatter light do not count for [`Truth::lit`]: an error across the rays is longer on them.
pub(super) const GRAZING: f64 = 1e-3;

type Point = [Double; 2];
/// Where a x + b y + c > 0.
type HalfPlane = Vector;

fn value(h: &HalfPlane, p: &Point) -> Double {
    h[0] * p[0] + h[1] * p[1] + h[2]
}

/// What values are made of, for the comparison with [`SAME`].
fn magnitude(h: &HalfPlane, p: &Point) -> f64 {
    h[0].size() * p[0].size() + h[1].size() * p[1].size() + h[2].size()
}

/// The parts of a convex polygon inside and outside of a half-plane; empty without interior.
fn split(polygon: &[Point], h: &HalfPlane) -> (Vec<Point>, Vec<Point>) {
    let values: Vec<Double> = polygon.iter().map(|p| value(h, p)).collect();
    let some_inside = values.iter().any(|v| v.f64() > 0.0);
    let some_outside = values.iter().any(|v| v.f64() < 0.0);
    match (some_inside, some_outside) {
        (true, false) => return (polygon.to_vec(), vec![]),
        (false, _) => return (vec![], polygon.to_vec()),
        _ => {}
    }
    let (mut inside, mut outside) = (vec![], vec![]);
    for (i, p) in polygon.iter().enumerate() {
        let j = (i + 1) % polygon.len();
        let (d, e) = (values[i], values[j]);
        if d.f64() >= 0.0 {
            inside.push(*p);
        }
        if d.f64() <= 0.0 {
            outside.push(*p);
        }
        if d.f64() * e.f64().signum() < 0.0 && e.f64() != 0.0 {
            let t = d / (d - e);
            let x = [0, 1].map(|k| p[k] + t * (polygon[j][k] - p[k]));
            inside.push(x);
            outside.push(x);
        }
    }
    (inside, outside)
}

fn area(polygon: &[Point]) -> Double {
    let mut twice = ZERO;
    for k in 2..polygon.len() {
        let side = |i: usize| [0, 1].map(|axis| polygon[i][axis] - polygon[0][axis]);
        let (a, b) = (side(k - 1), side(k));
        twice = twice + (a[0] * b[1] - a[1] * b[0]);
    }
    (twice * Double::from(0.5)).signed(twice)
}

/// A facet about the eye, in pixels per depth, pixels per depth, depth.
struct Facet {
    /// Seen from the eye: the half-planes of its image, and 1 / depth as a function of the ray. None if edge-on.
    seen: Option<([HalfPlane; 3], Vector)>,
    front: bool,
    /// Lit from the outer side, and what of a shadow does not depend on where it falls.
    cos_incidence: f64,
    shadow: Option<[(Vector, Double); 4]>,
    /// What decides a tie, after the side.
    rank: (u16, [[f64; 3]; 3], usize),
}

/// The plane w . p = c.
fn plane(w: Vector, through: Vector) -> (Vector, Double) {
    (w, dot(w, through))
}

impl Facet {
    fn new(mesh: &Mesh, index: usize, camera: &FrameCamera, towards_sun: DVec3) -> Facet {
        let axes = camera.world_from_sensor.rotation;
        let pitch = Double::from(camera.pitch[0]);
        let in_camera = |v: Vector| {
            let [h, v, u] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| dot(v, vector(axis)));
            [h / pitch, v / pitch, u]
        };
        let world = mesh.facet(index).corners_m;
        let centre = vector(camera.world_from_sensor.translation_m);
        let from_eye = world.map(|p| minus(vector(p), centre));
        let sun = vector(towards_sun);
        // Sides are decided in the world, of whose numbers nothing is rounded.
        let [a, b, c] = world.map(vector);
        let normal = cross(minus(b, a), minus(c, a));
        let towards_eye = -dot(normal, from_eye[0]);
        let towards_light = dot(normal, sun);
        let corners = from_eye.map(in_camera);
        let [p, q, r] = corners;
        let n = cross(minus(q, p), minus(r, p));
        let depth = dot(n, p);
        let is_edge_on = towards_eye.size() <= EDGE_ON * size(normal) * size(from_eye[0]) || depth.f64() == 0.0;
        let seen = (!is_edge_on).then(|| {
            let sides = [(p, q), (q, r), (r, p)].map(|(a, b)| cross(a, minus(b, a)).map(|x| x.signed(depth)));
            (sides, n.map(|x| x / depth))
        });
        let light = in_camera(sun);
        let blocks = towards_light.size() > EDGE_ON * size(normal);
        let shadow = blocks.then(|| {
            let side = |k: usize| {
                let (a, b, c) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
                let w = cross(minus(b, a), light);
                let inward = dot(w, minus(c, a));
                plane(w.map(|x| x.signed(inward)), a)
            };
            let behind = n.map(|x| -x.signed(dot(n, light)));
            [side(0), side(1), side(2), plane(behind, p)]
        });
        let length = dot(normal, normal).f64().sqrt();
        let mut sorted = world.map(|p| p.to_array().map(|x| x + 0.0));
        sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
        Facet {
            seen,
            front: towards_eye.f64() > 0.0,
            cos_incidence: if blocks { towards_light.f64() / length } else { 0.0 },
            shadow,
            rank: (mesh.material[index].0, sorted, index),
        }
    }

    /// What of a polygon this facet's image covers.
    fn clip(&self, polygon: &[Point]) -> Vec<Point> {
        let Some((sides, _)) = &self.seen else { return vec![] };
        sides.iter().fold(polygon.to_vec(), |p, h| if p.is_empty() { p } else { split(&p, h).0 })
    }

    /// Takes from each piece of another facet's image what this one hides.
    fn hide(&self, other: &Facet, pieces: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
        let (Some((sides, near)), Some((_, near_other))) = (&self.seen, &other.seen) else { return pieces };
        let nearer = minus(*near, *near_other);
        let wins_ties = (!self.front, &self.rank) < (!other.front, &other.rank);
        let same = |p: &Point| value(&nearer, p).size() <= SAME * (magnitude(near, p) + magnitude(near_other, p));
        without(pieces, sides, &nearer, same, wins_ties)
    }

    /// Takes from each piece of another facet's image what this one shades.
    fn shade(&self, other: &Facet, pieces: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
        let (Some(planes), Some((_, near))) = (&self.shadow, &other.seen) else { return pieces };
        let on_image = |(w, c): &(Vector, Double)| minus(*w, times(*near, *c));
        let sides = [0, 1, 2].map(|k| on_image(&planes[k]));
        let (behind, c) = &planes[3];
        let below = on_image(&planes[3]);
        let same = |p: &Point| value(&below, p).size() <= SAME * (magnitude(behind, p) + c.size() * magnitude(near, p));
        without(pieces, &sides, &below, same, false)
    }
}

/// Takes from each piece what lies within three sides and where `nearer` is positive; where it is the same all over, everything or nothing.
fn without(
    pieces: Vec<Vec<Point>>,
    sides: &[HalfPlane; 3],
    nearer: &HalfPlane,
    same: impl Fn(&Point) -> bool,
    wins_ties: bool,
) -> Vec<Vec<Point>> {
    let mut left = Vec::new();
    for piece in pieces {
        let mut rest = piece.clone();
        let mut beside = Vec::new();
        for h in sides {
            let (inside, outside) = split(&rest, h);
            rest = inside;
            if rest.is_empty() {
                break;
            }
            if !outside.is_empty() {
                beside.push(outside);
            }
        }
        if rest.is_empty() {
            left.push(piece);
            continue;
        }
        let (lost, kept) = if rest.iter().all(&same) {
            if wins_ties { (rest, vec![]) } else { (vec![], rest) }
        } else {
            split(&rest, nearer)
        };
        if lost.is_empty() {
            left.push(piece);
        } else {
            left.extend(beside);
            if !kept.is_empty() {
                left.push(kept);
            }
        }
    }
    left
}

/// The truth of every pixel, row by row. `reflectance` of each material.
pub(super) fn image(mesh: &Mesh, towards_sun: DVec3, camera: &FrameCamera, reflectance: &[f64]) -> Vec<Truth> {
    let facets: Vec<Facet> = (0..mesh.facets.len()).map(|f| Facet::new(mesh, f, camera, towards_sun)).collect();
    let mut pixels = Vec::new();
    for line in 0..camera.lines {
        for sample in 0..camera.samples {
            let at = |i: u32, n: u32| Double::from(f64::from(i) - 0.5 * f64::from(n));
            let (x, y) = (at(sample, camera.samples), at(line, camera.lines));
            let square = [[x, y], [x + ONE, y], [x + ONE, y + ONE], [x, y + ONE]];
            pixels.push(pixel(&facets, &square, reflectance));
        }
    }
    pixels
}

fn pixel(facets: &[Facet], square: &[Point], reflectance: &[f64]) -> Truth {
    let mut truth = [ZERO; 4];
    let part: Vec<Vec<Point>> = facets.iter().map(|f| f.clip(square)).collect();
    let sum = |pieces: &[Vec<Point>]| pieces.iter().fold(ZERO, |sum, p| sum + area(p));
    for (f, facet) in facets.iter().enumerate() {
        if part[f].is_empty() {
            continue;
        }
        let mut pieces = vec![part[f].clone()];
        for (g, other) in facets.iter().enumerate() {
            if f != g && !part[g].is_empty() && !pieces.is_empty() {
                pieces = other.hide(facet, pieces);
            }
        }
        truth[0] = truth[0] + sum(&pieces);
        if !facet.front {
            continue;
        }
        truth[1] = truth[1] + sum(&pieces);
        if facet.cos_incidence <= 0.0 {
            continue;
        }
        for (g, other) in facets.iter().enumerate() {
            if f != g && !pieces.is_empty() {
                pieces = other.shade(facet, pieces);
            }
        }
        let lit = sum(&pieces);
        if facet.cos_incidence > GRAZING {
            truth[2] = truth[2] + lit;
        }
        truth[3] = truth[3] + lit * Double::from(facet.cos_incidence * reflectance[facet.rank.0 as usize]);
    }
    let [coverage, front, lit, radiance] = truth.map(Double::f64);
    Truth { coverage, front, lit, radiance }
}
