//! A sphere in the image of a pinhole camera: its outline, and integrals over parts of its image.
//!
//! Its outline is a conic, and so is the image of the circle that bounds the half of it that faces a direction. Along a line of the image, rays lie
//! in a plane, which cuts the sphere in a circle: in its angle u, the angle of emission in that plane, everything is smooth up to the limb.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat3, DVec3};

use super::polygon::{Point, Rect, area};
use super::{Direction, FrameCamera};

/// What an integral over a pixel's part of the image may be off by, in areas of the pixel, or of the sphere's image if that is smaller.
pub const QUADRATURE: f64 = 1e-9;
/// Parts are halved no more often than this.
const DEEPEST: u32 = 16;
/// A polygon stands for the outline if its sides are no farther from it than this, in pixels, or in diameters of the image if that is smaller.
pub const OUTLINE: f64 = 2e-6;

/// A sphere, seen by a camera outside it, and a direction in which one half of it faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereImage {
    /// From the camera to its centre, m, and its radius, m.
    to_centre_m: DVec3,
    radius_m: f64,
    /// The same direction as a unit vector, and the sine and cosine of the angular radius.
    centre: DVec3,
    sin_radius: f64,
    cos_radius: f64,
    /// Unit vector.
    towards: DVec3,
    /// Rays are `ray` + x `right` + y `down`.
    right: DVec3,
    down: DVec3,
    ray: DVec3,
    /// The inverse: from a direction to (x, y, 1) times a number.
    pixel_from_ray: DMat3,
    camera_m: DVec3,
    /// Area of its image, pixels, about.
    size: f64,
}

/// What a part of an image shows of a sphere, areas in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SphereShown {
    /// All of it.
    pub area: f64,
    /// What of that faces the direction.
    pub facing: f64,
    /// Integral of the cosine between the sphere's normal and the direction, where that is above 0.
    pub cosine: f64,
}

impl SphereShown {
    /// Adds so many times another.
    pub fn add(&mut self, times: f64, other: &SphereShown) {
        self.area += times * other.area;
        self.facing += times * other.facing;
        self.cosine += times * other.cosine;
    }

    fn plus(mut self, other: &SphereShown) -> Self {
        self.add(1.0, other);
        self
    }

    fn off(&self, other: &SphereShown) -> f64 {
        let off = [self.area - other.area, self.facing - other.facing, self.cosine - other.cosine];
        off.into_iter().map(f64::abs).fold(0.0, f64::max)
    }
}

impl SphereImage {
    /// `None` if the camera is not outside.
    pub fn new(camera: &FrameCamera, centre_m: DVec3, radius_m: f64, towards: Direction) -> Option<Self> {
        let to_centre_m = centre_m - camera.centre_m();
        let distance_m = to_centre_m.length();
        let sin_radius = radius_m / distance_m;
        if !(sin_radius > 0.0 && sin_radius < 1.0) {
            return None;
        }
        let ray = camera.ray(0.0, 0.0);
        let (right, down) = (camera.world_from_sensor.vector(DVec3::X * camera.pitch[0]), {
            camera.world_from_sensor.vector(DVec3::Y * camera.pitch[1])
        });
        let tan2 = sin_radius * sin_radius / ((1.0 - sin_radius) * (1.0 + sin_radius));
        Some(SphereImage {
            to_centre_m,
            radius_m,
            centre: to_centre_m / distance_m,
            sin_radius,
            cos_radius: ((1.0 - sin_radius) * (1.0 + sin_radius)).sqrt(),
            towards: towards.vec(),
            right,
            down,
            ray,
            pixel_from_ray: DMat3::from_cols(right, down, ray).inverse(),
            camera_m: camera.centre_m(),
            size: PI * tan2 / (camera.pitch[0] * camera.pitch[1]),
        })
    }

    /// Length of a tangent from the camera, squared, m2: of two spheres that do not touch, the one with the shorter ones hides the other, if any does.
    pub fn tangent_m2(&self) -> f64 {
        let distance_m = self.to_centre_m.length();
        (distance_m - self.radius_m) * (distance_m + self.radius_m)
    }

    /// Whether it hides a triangle, which does not touch it, wherever both are on one ray; else the triangle hides it.
    ///
    /// The plane through the triangle's point nearest to the sphere's centre, square to the way there, has all of the triangle beyond it.
    pub fn hides(&self, corners_m: [DVec3; 3]) -> bool {
        let centre_m = self.camera_m + self.to_centre_m;
        let nearest_m = nearest_on_triangle(centre_m, corners_m) - centre_m;
        -self.to_centre_m.dot(nearest_m) < nearest_m.length_squared()
    }

    fn ray(&self, [x, y]: Point) -> DVec3 {
        self.ray + x * self.right + y * self.down
    }

    /// Area of its image, pixels, about.
    pub fn area_px(&self) -> f64 {
        self.size
    }

    /// Whether it is seen at a point of the image.
    pub fn holds(&self, at: Point) -> bool {
        let ray = self.ray(at);
        let along = ray.dot(self.centre);
        along > 0.0 && along * along >= self.cos_radius * self.cos_radius * ray.length_squared()
    }

    /// Where the ray through a point of the image meets it, in lengths of that ray ([`FrameCamera::ray`]), and the cosine between its normal there and the
    /// direction.
    pub fn met(&self, at: Point) -> Option<(f64, f64)> {
        let ray = self.ray(at);
        let (length2, along) = (ray.length_squared(), ray.dot(self.centre));
        // Lengths in distances to the centre.
        let half2 = along * along - self.cos_radius * self.cos_radius * length2;
        if along <= 0.0 || half2 < 0.0 {
            return None;
        }
        let near = (along - half2.sqrt()) / length2;
        let normal = (near * ray - self.centre) / self.sin_radius;
        Some((near * self.to_centre_m.length(), normal.dot(self.towards)))
    }

    /// Where a direction is in the image; `None` behind the camera.
    fn point(&self, direction: DVec3) -> Option<Point> {
        let at = self.pixel_from_ray * direction;
        (at.z > 0.0).then(|| [at.x / at.z, at.y / at.z])
    }

    /// Whether some of it may be in a rectangle of the image.
    pub fn may_touch(&self, rect: &Rect) -> bool {
        let corners = rect.corners();
        // Beyond a side: on the outer side of the plane through the camera and that side by more than its radius.
        let inside = self.ray(rect.centre());
        let is_beyond = |k: usize| {
            let side = self.ray(corners[k]).cross(self.ray(corners[(k + 1) % 4])).normalize_or_zero();
            let side = if side.dot(inside) < 0.0 { -side } else { side };
            side.dot(self.centre) < -self.sin_radius
        };
        !(0..4).any(is_beyond) && self.right.cross(self.down).normalize().dot(self.centre) > -self.sin_radius
    }

    /// The part of its image within a rectangle as a convex polygon, counter-clockwise, within [`OUTLINE`]. Empty if it is not there.
    pub fn outline_within(&self, rect: &Rect, out: &mut Vec<Point>) {
        out.clear();
        let (h, u) = (self.centre.any_orthonormal_vector(), self.centre);
        let v = u.cross(h);
        let limb = |azimuth: f64| {
            let (sin, cos) = azimuth.sin_cos();
            self.point(self.cos_radius * u + self.sin_radius * (cos * h + sin * v))
        };
        let corners = rect.corners();
        let mut azimuths = Vec::new();
        for k in 0..4 {
            let (from, to) = (self.ray(corners[k]), self.ray(corners[(k + 1) % 4]));
            for along in self.crossings(&|p, q| self.limb_form(p, q), from, to - from) {
                let at = from + along * (to - from);
                // The form is 0 on the other side of the camera, too.
                if at.dot(u) > 0.0 {
                    azimuths.push(at.dot(v).atan2(at.dot(h)));
                }
            }
        }
        if azimuths.is_empty() && limb(0.0).is_some_and(|at| rect.holds(at)) {
            azimuths = [0.0, 0.5 * PI, PI, 1.5 * PI].to_vec();
        }
        azimuths.sort_by(f64::total_cmp);
        let off = OUTLINE * self.size.sqrt().min(1.0);
        let ends = azimuths.iter().skip(1).copied().chain(azimuths.first().map(|first| first + 2.0 * PI));
        for (from, to) in azimuths.iter().copied().zip(ends) {
            let middle = limb(0.5 * (from + to)).filter(|at| rect.holds(*at));
            if let (Some(a), Some(_), Some(b)) = (limb(from), middle, limb(to)) {
                out.push(a);
                arc(&limb, (from, a), (to, b), (off, DEEPEST), out);
                out.push(b);
            }
        }
        out.extend(corners.into_iter().filter(|corner| self.holds(*corner)));
        if out.len() < 3 {
            out.clear();
            return;
        }
        let middle = [0, 1].map(|k| out.iter().map(|p| p[k]).sum::<f64>() / out.len() as f64);
        let angle = |p: &Point| (p[1] - middle[1]).atan2(p[0] - middle[0]);
        out.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        out.dedup();
    }

    /// Bilinear form that is 0 for rays along the limb.
    fn limb_form(&self, p: DVec3, q: DVec3) -> f64 {
        self.centre.dot(p) * self.centre.dot(q) - self.cos_radius * self.cos_radius * p.dot(q)
    }

    /// The same of the circle in which the sphere is cut by the plane through its centre, square to the direction.
    fn terminator_form(&self, p: DVec3, q: DVec3) -> f64 {
        let (c, s) = (self.centre, self.towards);
        let c_s = c.dot(s);
        c_s * c_s * p.dot(q) - c_s * (p.dot(s) * c.dot(q) + q.dot(s) * c.dot(p))
            + self.cos_radius * self.cos_radius * p.dot(s) * q.dot(s)
    }

    /// Where a form is 0 on rays `from` + w `step`, 0 < w < 1.
    fn crossings(&self, form: &dyn Fn(DVec3, DVec3) -> f64, from: DVec3, step: DVec3) -> impl Iterator<Item = f64> {
        roots(form(step, step), form(from, step), form(from, from)).filter(|w| 0.0 < *w && *w < 1.0)
    }

    /// Lines of the image, y, at which what is seen of the sphere in a convex polygon changes its kind.
    fn breaks(&self, polygon: &[Point], (low, high): (f64, f64)) -> Vec<f64> {
        let mut breaks: Vec<f64> = Vec::new();
        let limb = |p: DVec3, q: DVec3| self.limb_form(p, q);
        let terminator = |p: DVec3, q: DVec3| self.terminator_form(p, q);
        let forms: [&dyn Fn(DVec3, DVec3) -> f64; 2] = [&limb, &terminator];
        let from = self.ray([polygon[0][0], low]);
        for form in forms {
            for (i, a) in polygon.iter().enumerate() {
                let b = polygon[(i + 1) % polygon.len()];
                let (p, q) = (self.ray(*a), self.ray(b));
                breaks.extend(self.crossings(form, p, q - p).map(|w| a[1] + w * (b[1] - a[1])));
            }
            // Along a line of the image a form is a quadratic: where both of its roots are the same, the line touches the curve.
            let (right, down) = (self.right, self.down);
            let a = form(right, right);
            let (b0, b1) = (form(from, right), form(down, right));
            let (c0, c1, c2) = (form(from, from), form(from, down), form(down, down));
            breaks.extend(roots(b1 * b1 - a * c2, b0 * b1 - a * c1, b0 * b0 - a * c0).map(|y| low + y));
        }
        // Where the terminator meets the limb: normals across both directions.
        let (c, s) = (self.centre, self.towards);
        let across = c - c.dot(s) * s;
        let (along, length2) = (-self.sin_radius / across.length_squared(), across.length_squared());
        let rest = 1.0 - self.sin_radius * self.sin_radius / length2;
        if rest > 0.0 {
            let aside = s.cross(across).normalize_or_zero() * rest.sqrt();
            let horns = [1.0, -1.0].map(|sign| c + self.sin_radius * (along * across + sign * aside));
            breaks.extend(horns.into_iter().filter_map(|horn| self.point(horn)).map(|at| at[1]));
        }
        breaks.retain(|y| low < *y && *y < high);
        breaks
    }

    /// What a convex polygon of the image shows of it; within [`QUADRATURE`] for one no larger than a pixel.
    pub fn shown(&self, polygon: &[Point]) -> SphereShown {
        if polygon.len() < 3 {
            return SphereShown::default();
        }
        let bounds = Rect::of(polygon);
        let (low, high) = (bounds.min[1], bounds.max[1]);
        if high <= low || !self.may_touch(&bounds) {
            return SphereShown::default();
        }
        let curves = self.breaks(polygon, (low, high));
        let is_smooth = curves.is_empty();
        let mut ends = curves;
        ends.extend(polygon.iter().map(|p| p[1]));
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        // Rounding of directions counts for more in a small disc: what cannot be reached is not asked for.
        let within = QUADRATURE.max(64.0 * f64::EPSILON / self.sin_radius);
        // Of many small pieces each may be off by more of itself.
        let tolerance = within * self.size.min(area(polygon).abs().max(0.01));
        let mut sum = SphereShown::default();
        for pair in ends.windows(2) {
            let (from, length) = (pair[0], pair[1] - pair[0]);
            let row = |t: f64| {
                // Where a curve begins, what it bounds grows like a root: t^2 makes it smooth.
                let (y, slope) = match is_smooth {
                    true => (from + length * t, length),
                    false => (from + length * t * t * (3.0 - 2.0 * t), 6.0 * length * t * (1.0 - t)),
                };
                let mut shown = SphereShown::default();
                if let Some((left, right)) = chord(polygon, y) {
                    shown.add(slope, &self.row(y, (left, right), tolerance / (high - low)));
                }
                shown
            };
            sum.add(1.0, &adaptive(&row, (0.0, 1.0), tolerance * (length / (high - low)).max(0.01), DEEPEST));
        }
        sum
    }

    /// Integrals along a line of the image from one x to another.
    fn row(&self, y: f64, (left, right): (f64, f64), tolerance: f64) -> SphereShown {
        let ray = self.ray([0.0, y]);
        let per_x = self.right.length();
        // In the plane of rays: along the line, ahead, and across.
        let e1 = self.right / per_x;
        let ray1 = ray.dot(e1);
        let ahead = ray - ray1 * e1;
        let ahead_length = ahead.length();
        let e2 = ahead / ahead_length;
        let n = e1.cross(e2);
        // Lengths in distances to the centre.
        let (c1, c2, cn) = (self.centre.dot(e1), self.centre.dot(e2), self.centre.dot(n));
        let r2 = (self.sin_radius - cn) * (self.sin_radius + cn);
        if r2 <= 0.0 {
            return SphereShown::default();
        }
        let (r, d) = (r2.sqrt(), c1.hypot(c2));
        let sin_alpha = (r / d).min(1.0);
        let (sin0, cos0) = (c1 / d, c2 / d);
        // u of the ray at x: the angle of emission in the plane.
        let u_at = |x: f64| {
            let (d1, d2) = (x * per_x + ray1, ahead_length);
            let length = d1.hypot(d2);
            let (sin, cos) = ((d1 * cos0 - d2 * sin0) / length, (d1 * sin0 + d2 * cos0) / length);
            if cos <= 0.0 { FRAC_PI_2.copysign(sin) } else { (sin / sin_alpha).clamp(-1.0, 1.0).asin() }
        };
        let (from, to) = (u_at(left), u_at(right));
        if to <= from {
            return SphereShown::default();
        }
        // The cosine with the direction is -a cos(gamma) + b sin(gamma) + k, gamma the angle at the circle's centre.
        let s = self.towards;
        let (s1, s2) = (s.dot(e1), s.dot(e2));
        let (a, b) = (r * (s1 * sin0 + s2 * cos0), r * (s1 * cos0 - s2 * sin0));
        let (a, b, k) = (a / self.sin_radius, b / self.sin_radius, -cn * s.dot(n) / self.sin_radius);
        let cosine = |gamma: f64| {
            let (sin, cos) = gamma.sin_cos();
            b * sin - a * cos + k
        };
        let amplitude = a.hypot(b);
        let mut ends = [from, to, to, to];
        if k.abs() < amplitude {
            let (turn, off) = (a.atan2(b), (-k / amplitude).asin());
            for (slot, gamma) in [turn + off, turn + PI - off].into_iter().enumerate() {
                let gamma = (gamma + PI).rem_euclid(2.0 * PI) - PI;
                let u = gamma + (r * gamma.sin()).atan2(d - r * gamma.cos());
                ends[slot + 1] = if from < u && u < to { u } else { to };
            }
            ends.sort_by(f64::total_cmp);
        }
        let at = |u: f64| {
            let (sin_u, cos_u) = u.sin_cos();
            let sin = sin_alpha * sin_u;
            let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
            // dx / du: the ray's tangent, by its angle, by u.
            let cos_ray = cos0 * cos - sin0 * sin;
            let slope = ahead_length / per_x / (cos_ray * cos_ray) * sin_alpha * cos_u / cos;
            (slope, cosine(u - sin.asin()))
        };
        let mut sum = SphereShown::default();
        for pair in ends.windows(2).filter(|pair| pair[1] > pair[0]) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let faces = cosine(middle - (sin_alpha * middle.sin()).asin()) > 0.0;
            let of = |u: f64| {
                let (slope, cosine) = at(u);
                match faces {
                    true => SphereShown { area: slope, facing: slope, cosine: slope * cosine.max(0.0) },
                    false => SphereShown { area: slope, ..SphereShown::default() },
                }
            };
            sum.add(1.0, &adaptive(&of, (pair[0], pair[1]), tolerance, DEEPEST));
        }
        sum
    }
}

/// Gauss and Legendre's nodes and weights on (0, 1), of 3 and 5 points.
const THREE: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
const FIVE: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// An integral, halved until two rules agree to within a tolerance.
fn adaptive(f: &dyn Fn(f64) -> SphereShown, (from, to): (f64, f64), tolerance: f64, depth: u32) -> SphereShown {
    let rule = |nodes: &[(f64, f64)]| {
        let mut sum = SphereShown::default();
        nodes.iter().for_each(|(t, weight)| sum.add(weight * (to - from), &f(from + t * (to - from))));
        sum
    };
    let (coarse, fine) = (rule(&THREE), rule(&FIVE));
    if coarse.off(&fine) <= tolerance || depth == 0 {
        return fine;
    }
    let middle = 0.5 * (from + to);
    let half = |from, to| adaptive(f, (from, to), tolerance, depth - 1);
    half(from, middle).plus(&half(middle, to))
}

/// Points between two of a curve, so many that no side is farther from it than `off`.
fn arc(
    curve: &dyn Fn(f64) -> Option<Point>,
    (from, a): (f64, Point),
    (to, b): (f64, Point),
    (off, depth): (f64, u32),
    out: &mut Vec<Point>,
) {
    let at = 0.5 * (from + to);
    let Some(middle) = curve(at).filter(|_| depth > 0) else { return };
    let (side, to_middle) = ([b[0] - a[0], b[1] - a[1]], [middle[0] - a[0], middle[1] - a[1]]);
    let beside = (side[0] * to_middle[1] - side[1] * to_middle[0]).abs();
    if beside <= off * side[0].hypot(side[1]) {
        return;
    }
    arc(curve, (from, a), (at, middle), (off, depth - 1), out);
    out.push(middle);
    arc(curve, (at, middle), (to, b), (off, depth - 1), out);
}

/// Real roots of a x^2 + 2 b x + c.
fn roots(a: f64, b: f64, c: f64) -> impl Iterator<Item = f64> {
    let root = (b * b - a * c).sqrt();
    // The one that adds up, and the other by their product.
    let sum = -(b + root.copysign(b));
    [sum / a, c / sum].into_iter().filter(|x| x.is_finite())
}

/// From where to where a line y runs in a convex polygon.
fn chord(polygon: &[Point], y: f64) -> Option<(f64, f64)> {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if (a[1] <= y) != (b[1] <= y) {
            let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            (left, right) = (left.min(x), right.max(x));
        }
    }
    (right > left).then_some((left, right))
}

/// The point of a triangle that is nearest to another point.
pub fn nearest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let on_edge = |a: DVec3, b: DVec3| {
        let along = (p - a).dot(b - a) / (b - a).length_squared();
        if along.is_nan() { a } else { a + along.clamp(0.0, 1.0) * (b - a) }
    };
    let normal = (b - a).cross(c - a);
    let is_beside = |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && is_beside(a, b) && is_beside(b, c) && is_beside(c, a) {
        return p - (p - a).dot(normal) / normal.length_squared() * normal;
    }
    let edges = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    edges.into_iter().min_by(|q, r| (p - *q).length_squared().total_cmp(&(p - *r).length_squared())).unwrap_or(a)
}
