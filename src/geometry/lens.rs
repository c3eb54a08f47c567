//! Lenses: where the image of a direction lies, other than where an ideal pinhole has it, and back.
//!
//! Both sides are tangents: x right, y down, for 1 along the boresight. The ideal ones are a direction's; the imaged ones are a place of the image, from the boresight,
//! in units of the focal length. A lens is checked when it is made: over its image it can be inverted, and each pixel is a convex quadrilateral.

use super::polygon::{Point, area, side};

/// Directions farther from the boresight than this have no place in the plane of the drawing, deg.
const WIDEST_DEG: f64 = 89.0;
/// Steps of Newton's method, and halvings of one, at most.
const STEPS: usize = 60;
const HALVINGS: usize = 40;
/// An inverse is one if it is as near as this, relative to the place.
const INVERTED: f64 = 1e-11;
/// Pixels along each side whose curvature is looked at, about.
const LOOKS: u32 = 32;
/// Cells of the drawing for each pixel, at most, and those that any image may have.
const MOST_CELLS: f64 = 64.0;
const ANY_CELLS: f64 = 1e6;

/// The distortion of a lens, by the coefficients of Brown (1966) and Conrady (1919), with the signs of OpenCV: with r2 = x2 + y2 of the ideal tangents,
/// x' = x (1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 x y + p2 (r2 + 2 x2), y' = y (1 + ...) + p1 (r2 + 2 y2) + 2 p2 x y.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BrownConrady {
    /// k1, k2, k3.
    pub radial: [f64; 3],
    /// p1, p2.
    pub tangential: [f64; 2],
}

/// Ideal tangents of the centre of each pixel of an image, line by line.
#[derive(Debug, Clone, PartialEq)]
struct Directions {
    centres: Vec<Point>,
    /// Samples and lines.
    size: [usize; 2],
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// And the radius up to which radii grow with it.
    Formula(BrownConrady, f64),
    Table(Directions),
}

/// What a lens does to the image of an ideal pinhole.
#[derive(Debug, Clone, PartialEq)]
pub struct Lens {
    kind: Kind,
    /// Of the camera it was made for: size of a pixel over the focal length, where the boresight is, pixels, and samples and lines.
    pitch: [f64; 2],
    boresight_px: [f64; 2],
    size: [u32; 2],
}

/// Two rows: how two tangents change with two others, or with pixels.
type Jacobian = [[f64; 2]; 2];

fn determinant([[a, b], [c, d]]: Jacobian) -> f64 {
    a * d - b * c
}

/// What step makes this difference.
fn solved(jacobian: Jacobian, [x, y]: Point) -> Point {
    let [[a, b], [c, d]] = jacobian;
    let determinant = determinant(jacobian);
    [(d * x - b * y) / determinant, (a * y - c * x) / determinant]
}

/// Where `map`, which gives a place and its Jacobian, has the value `to`: Newton's method with halved steps from `at` on. `None` if it does not get there,
/// or the map is mirrored there.
fn inverse(map: impl Fn(Point) -> (Point, Jacobian), to: Point, mut at: Point, scale: f64) -> Option<Point> {
    let off = |value: Point| [to[0] - value[0], to[1] - value[1]];
    let size = |d: Point| d[0].hypot(d[1]);
    let (value, mut jacobian) = map(at);
    let mut rest = off(value);
    for _ in 0..STEPS {
        if rest == [0.0; 2] {
            break;
        }
        let step = solved(jacobian, rest);
        let mut share = 1.0;
        let nearer = (0..HALVINGS).find_map(|_| {
            let next = [0, 1].map(|k| at[k] + share * step[k]);
            share *= 0.5;
            let (value, jacobian) = map(next);
            (size(off(value)) < size(rest)).then_some((next, off(value), jacobian))
        });
        // No nearer: as near as rounding lets it be, or nowhere.
        let Some(nearer) = nearer else { break };
        (at, rest, jacobian) = nearer;
    }
    (size(rest) <= INVERTED * scale && determinant(jacobian) > 0.0).then_some(at)
}

impl BrownConrady {
    fn map(&self, [x, y]: Point) -> (Point, Jacobian) {
        let ([k1, k2, k3], [p1, p2]) = (self.radial, self.tangential);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        // Half of its derivative by x is this times x.
        let slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
        let across = 2.0 * (x * y * slope + p1 * x + p2 * y);
        let place = [
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ];
        let along = [
            radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        ];
        (place, [[along[0], across], [across, along[1]]])
    }

    /// Radius in the image of a radius, without the tangential part, and its derivative.
    fn radius(&self, r: f64) -> (f64, f64) {
        let ([k1, k2, k3], r2) = (self.radial, r * r);
        (r * (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))), 1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3)))
    }

    /// The radius up to which that derivative is positive, no farther than the widest direction.
    fn fold(&self) -> f64 {
        let [k1, k2, k3] = self.radial;
        let most = widest();
        // Between the turns of a cubic of r2 it has no more than one zero.
        let (a, b, c) = (21.0 * k3, 10.0 * k2, 3.0 * k1);
        let root = (b * b - 4.0 * a * c).sqrt();
        let q = -0.5 * (b + root.copysign(b));
        let mut turns: Vec<f64> = [q / a, c / q].into_iter().filter(|u| *u > 0.0 && u.sqrt() < most).collect();
        turns.sort_by(f64::total_cmp);
        let mut low = 0.0;
        for high in turns.into_iter().map(f64::sqrt).chain([most]) {
            if self.radius(high).1 <= 0.0 {
                return bisected(low, high, |r| self.radius(r).1 > 0.0);
            }
            low = high;
        }
        most
    }

    fn inverse(&self, to: Point, fold: f64) -> Option<Point> {
        let far = to[0].hypot(to[1]);
        if far == 0.0 {
            return Some(to);
        }
        // Exact without the tangential part, which is small; the last digits are Newton's.
        let r = if self.radius(fold).0 <= far { fold } else { bisected(0.0, fold, |r| self.radius(r).0 < far) };
        let start = to.map(|x| x * (r / far));
        inverse(|at| self.map(at), to, start, far).filter(|at| at[0].hypot(at[1]) < fold)
    }
}

/// Tangent of the widest direction.
fn widest() -> f64 {
    WIDEST_DEG.to_radians().tan()
}

/// Between two numbers, the last at which something is still true: by halves, to about 1e-7 of the larger.
fn bisected(mut low: f64, mut high: f64, is_before: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if is_before(middle) { low = middle } else { high = middle }
    }
    low
}

impl Directions {
    /// Tangents at a place of the image, pixels from the first pixel's outer corner, and how they change with it: bilinear between centres, on at the rim as within.
    /// Of one line or column pixels are as high as they are wide, at right angles.
    fn map(&self, px: Point) -> (Point, Jacobian) {
        let mut cell = [0; 2];
        let mut share = [0.0; 2];
        for k in 0..2 {
            let last = self.size[k].saturating_sub(2);
            cell[k] = super::whole((px[k] - 0.5).floor().max(0.0)).min(last);
            share[k] = px[k] - 0.5 - cell[k] as f64;
        }
        let of = |column: usize, row: usize| self.centres[(cell[1] + row) * self.size[0] + cell[0] + column];
        let [u, v] = share;
        let less = |a: Point, b: Point| [a[0] - b[0], a[1] - b[1]];
        let first = of(0, 0);
        let (right, down, both) = match self.size {
            [1, _] => {
                let down = less(of(0, 1), first);
                ([down[1], -down[0]], down, [0.0; 2])
            }
            [_, 1] => {
                let right = less(of(1, 0), first);
                (right, [-right[1], right[0]], [0.0; 2])
            }
            _ => {
                let (right, down) = (less(of(1, 0), first), less(of(0, 1), first));
                (right, down, less(less(of(1, 1), of(0, 1)), right))
            }
        };
        let at = [0, 1].map(|k| first[k] + u * right[k] + v * down[k] + u * v * both[k]);
        (at, [0, 1].map(|k| [right[k] + v * both[k], down[k] + u * both[k]]))
    }

    /// The place of these tangents; `guess` where it is about.
    fn inverse(&self, to: Point, guess: Point) -> Option<Point> {
        let found = |start: Point| {
            let (near, jacobian) = self.map(start);
            // By pixels of this size it is near enough or not, wherever the boresight is.
            let scale = determinant(jacobian).abs().sqrt() + near[0].hypot(near[1]);
            inverse(|at| self.map(at), to, start, scale)
        };
        found(guess).or_else(|| {
            // A table as rough as to lead astray: from the nearest centre.
            let off = |at: &Point| (at[0] - to[0]).powi(2) + (at[1] - to[1]).powi(2);
            let nearest =
                (0..self.centres.len()).min_by(|a, b| off(&self.centres[*a]).total_cmp(&off(&self.centres[*b])))?;
            found([nearest % self.size[0], nearest / self.size[0]].map(|i| i as f64 + 0.5))
        })
    }
}

impl Lens {
    /// The lens of a camera with such pixels; `None` if its coefficients are all 0: then there is nothing to it.
    ///
    /// # Errors
    /// What is wrong with it, as a sentence.
    pub fn brown_conrady(
        of: BrownConrady,
        pitch: [f64; 2],
        boresight_px: [f64; 2],
        size: [u32; 2],
    ) -> Result<Option<Self>, String> {
        if of == BrownConrady::default() {
            return Ok(None);
        }
        if let Some(odd) = of.radial.iter().chain(&of.tangential).find(|k| !k.is_finite()) {
            return Err(format!("a coefficient is {odd}"));
        }
        let lens = Lens { kind: Kind::Formula(of, of.fold()), pitch, boresight_px, size };
        lens.check()?;
        Ok(Some(lens))
    }

    /// The lens of a camera of which the directions of pixel centres are known, as tangents, line by line.
    ///
    /// # Errors
    /// What is wrong with it, as a sentence.
    pub fn table(centres: Vec<Point>, size: [u32; 2]) -> Result<Self, String> {
        let sides = size.map(|n| n as usize);
        if centres.len() != sides[0] * sides[1] {
            return Err(format!("{} directions for {} x {} pixels", centres.len(), size[0], size[1]));
        }
        if centres.len() < 2 {
            return Err("one direction does not tell how large its pixel is".into());
        }
        if let Some(odd) = centres.iter().position(|at| at.iter().any(|x| !x.is_finite())) {
            return Err(format!("{} is not a direction ahead", pixel(odd % sides[0], odd / sides[0])));
        }
        let table = Directions { centres, size: sides };
        // Where directions are close to a pinhole's, that one's pixels are its own: as in the middle.
        let middle = size.map(|n| 0.5 * f64::from(n));
        let (at, jacobian) = table.map(middle);
        let pitch = determinant(jacobian).sqrt();
        if !(pitch > 0.0 && pitch.is_finite()) {
            let help = "samples go to the right, lines down";
            return Err(format!("in the middle of the image its directions do not spread, or are mirrored: {help}"));
        }
        let boresight_px = [0, 1].map(|k| middle[k] - at[k] / pitch);
        let lens = Lens { kind: Kind::Table(table), pitch: [pitch; 2], boresight_px, size };
        lens.check()?;
        Ok(lens)
    }

    /// Size of a pixel over the focal length of the pinhole that it is a lens of.
    pub fn pitch(&self) -> [f64; 2] {
        self.pitch
    }

    /// Where the boresight of that pinhole meets the image, pixels.
    pub fn boresight_px(&self) -> [f64; 2] {
        self.boresight_px
    }

    /// Samples and lines of the image that it was made for.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Its coefficients, if it is a formula.
    pub fn coefficients(&self) -> Option<BrownConrady> {
        match &self.kind {
            Kind::Formula(of, _) => Some(*of),
            Kind::Table(_) => None,
        }
    }

    /// Tangents of pixel centres, line by line, if it is a table.
    pub fn centres(&self) -> Option<&[Point]> {
        match &self.kind {
            Kind::Formula(..) => None,
            Kind::Table(table) => Some(&table.centres),
        }
    }

    /// The direction that is seen at a place of the image, tangents both; `None` where none is.
    pub fn ideal(&self, imaged: Point) -> Option<Point> {
        match &self.kind {
            Kind::Formula(of, fold) => of.inverse(imaged, *fold),
            Kind::Table(table) => {
                let (at, jacobian) = table.map(self.px(imaged));
                (determinant(jacobian) > 0.0).then_some(at)
            }
        }
    }

    /// Where a direction is seen, tangents both; `None` if nowhere.
    pub fn imaged(&self, ideal: Point) -> Option<Point> {
        self.imaged_with(ideal).map(|(imaged, _)| imaged)
    }

    /// The same, and how that changes with the direction.
    pub fn imaged_with(&self, ideal: Point) -> Option<(Point, Jacobian)> {
        match &self.kind {
            Kind::Formula(of, fold) => {
                let (at, jacobian) = of.map(ideal);
                let is_seen = ideal[0].hypot(ideal[1]) < *fold && determinant(jacobian) > 0.0;
                is_seen.then_some((at, jacobian))
            }
            Kind::Table(table) => {
                let px = table.inverse(ideal, self.px(ideal))?;
                let jacobian = table.map(px).1;
                let imaged = [0, 1].map(|k| (px[k] - self.boresight_px[k]) * self.pitch[k]);
                let columns = [[1.0, 0.0], [0.0, 1.0]].map(|axis| solved(jacobian, axis));
                Some((imaged, [0, 1].map(|k| [0, 1].map(|j| self.pitch[k] * columns[j][k]))))
            }
        }
    }

    /// By how much the sides of pixels, which are drawn straight, are curved, in pixels: the most of those of some pixels, with the outermost.
    pub fn sagitta_px(&self) -> f64 {
        let steps = self.size.map(|n| n.div_ceil(LOOKS).max(1) as usize);
        let some = |k: usize| (0..self.size[k]).step_by(steps[k]).chain([self.size[k] - 1]);
        let ideal = |px: Point| self.ideal([0, 1].map(|k| (px[k] - self.boresight_px[k]) * self.pitch[k]));
        let of_pixel = |pixel: Point| {
            let [corner, right, down] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|d| [0, 1].map(|k| pixel[k] + d[k]));
            let off = |from: Point, to: Point| {
                let (a, b, middle) = (ideal(from)?, ideal(to)?, ideal([0, 1].map(|k| 0.5 * (from[k] + to[k])))?);
                let [x, y] = [0, 1].map(|k| middle[k] - 0.5 * (a[k] + b[k]));
                Some(x.hypot(y) / (b[0] - a[0]).hypot(b[1] - a[1]))
            };
            Some(off(corner, right)?.max(off(corner, down)?))
        };
        some(1)
            .flat_map(|line| some(0).map(move |sample| [sample, line].map(f64::from)))
            .filter_map(of_pixel)
            .fold(0.0, f64::max)
    }

    /// Pixels of imaged tangents.
    fn px(&self, imaged: Point) -> Point {
        [0, 1].map(|k| imaged[k] / self.pitch[k] + self.boresight_px[k])
    }

    /// Whether pixels are what they must be to be drawn.
    fn check(&self) -> Result<(), String> {
        let [samples, lines] = self.size;
        let corner = |sample: u32, line: u32| {
            let at = [f64::from(sample), f64::from(line)];
            let imaged = [0, 1].map(|k| (at[k] - self.boresight_px[k]) * self.pitch[k]);
            let of = || pixel(sample.min(samples - 1) as usize, line.min(lines - 1) as usize);
            match self.ideal(imaged) {
                Some(ideal) if ideal[0].hypot(ideal[1]) < widest() => Ok(ideal),
                None if !matches!(self.kind, Kind::Formula(_, fold) if fold >= widest()) => {
                    Err(format!("at {} the image is folded: it cannot be inverted there", of()))
                }
                _ => Err(format!("{} looks farther than {WIDEST_DEG} deg from the boresight", of())),
            }
        };
        let row = |line: u32| (0..=samples).map(|sample| corner(sample, line)).collect::<Result<Vec<Point>, String>>();
        let mut above = row(0)?;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for line in 0..lines {
            let below = row(line + 1)?;
            for sample in 0..samples as usize {
                let outline = [above[sample], above[sample + 1], below[sample + 1], below[sample]];
                let turns_left = (0..4).all(|k| side(outline[k], outline[(k + 1) % 4], outline[(k + 2) % 4]) > 0.0);
                if !(turns_left && area(&outline) > 0.0) {
                    let of = pixel(sample, line as usize);
                    return Err(format!(
                        "the outline of {of} is not a convex quadrilateral: directions fold or jump there"
                    ));
                }
            }
            for at in above.iter().chain(&below) {
                (low, high) = ([0, 1].map(|k| at[k].min(low[k])), [0, 1].map(|k| at[k].max(high[k])));
            }
            above = below;
        }
        let cells = (high[0] - low[0]) / self.pitch[0] * ((high[1] - low[1]) / self.pitch[1]);
        if cells > MOST_CELLS * f64::from(samples) * f64::from(lines) + ANY_CELLS {
            return Err(format!(
                "its pixels take {cells:.1e} of those in the middle of the image, too many to be drawn"
            ));
        }
        Ok(())
    }
}

/// What a pixel is called.
fn pixel(sample: usize, line: usize) -> String {
    format!("pixel {sample} of line {line}, counted from 0,")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// OpenCV's formula at x = 0.3, y = -0.2, worked by hand: r2 = 0.13.
    #[test]
    fn coefficients_mean_what_they_mean_to_opencv() {
        let of = BrownConrady { radial: [-0.1, 0.05, 0.02], tangential: [0.01, -0.02] };
        // 1 - 0.013 + 0.05 * 0.0169 + 0.02 * 0.002197 = 0.98788894
        // x' = 0.3 * 0.98788894 + 0.02 * -0.06 - 0.02 * (0.13 + 0.18) = 0.296366682 - 0.0012 - 0.0062
        // y' = -0.2 * 0.98788894 + 0.01 * (0.13 + 0.08) - 0.04 * -0.06 = -0.197577788 + 0.0021 + 0.0024
        let [x, y] = of.map([0.3, -0.2]).0;
        assert!((x - 0.288966682).abs() < 1e-15 && (y + 0.193077788).abs() < 1e-15, "{x} {y}");
    }

    #[test]
    fn a_derivative_is_what_differences_say() {
        let of = BrownConrady { radial: [-0.1, 0.05, 0.02], tangential: [0.01, -0.02] };
        let (at, step) = ([0.3, -0.2], 1e-6);
        let jacobian = of.map(at).1;
        for axis in 0..2 {
            let moved = |by: f64| of.map([0, 1].map(|i| at[i] + if i == axis { by } else { 0.0 })).0;
            let (ahead, behind) = (moved(step), moved(-step));
            for (row, by) in jacobian.iter().enumerate() {
                let rate = (ahead[row] - behind[row]) / (2.0 * step);
                assert!((rate - by[axis]).abs() < 1e-9, "{row} {axis}");
            }
        }
    }

    /// r - r3 / 3 grows up to r = 1, where it is 2/3.
    #[test]
    fn a_formula_ends_where_it_folds() {
        let of = BrownConrady { radial: [-1.0 / 3.0, 0.0, 0.0], tangential: [0.0; 2] };
        assert!((of.fold() - 1.0).abs() < 1e-5, "{}", of.fold());
        // 100 pixels of 0.01: the corners, 0.707 away, are beyond 2/3; of 0.0094, at 0.6647, they are not.
        let lens = |pitch: f64| Lens::brown_conrady(of, [pitch; 2], [50.0; 2], [100, 100]);
        assert!(lens(0.01).unwrap_err().contains("folded"));
        let lens = lens(0.0094).unwrap().unwrap();
        assert_eq!(lens.imaged([1.1, 0.0]), None);
        assert_eq!(lens.ideal([0.67, 0.0]), None);
        // No folds: 1 + 3 u - 5 u^2 / 2 + 7 u^3 is above 0 for u > 0; the widest direction ends it.
        assert_eq!(BrownConrady { radial: [1.0, -0.5, 1.0], ..of }.fold(), widest());
    }

    #[test]
    fn inverses_hold_over_the_whole_image() {
        let strong = BrownConrady { radial: [-0.28, 0.07, -0.005], tangential: [1e-3, -2e-3] };
        let pincushion = BrownConrady { radial: [0.4, 0.3, 0.1], tangential: [-2e-3, 1e-3] };
        for of in [strong, pincushion] {
            let (pitch, size) = ([1.0 / 400.0, 1.0 / 380.0], [640, 480]);
            let lens = Lens::brown_conrady(of, pitch, [320.0, 240.0], size).unwrap().unwrap();
            let n = 40;
            let place = |i: i32, j: i32| {
                [f64::from(i) / f64::from(n) * 640.0 - 320.0, f64::from(j) / f64::from(n) * 480.0 - 240.0]
            };
            for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                let imaged = [0, 1].map(|k| place(i, j)[k] * pitch[k]);
                let ideal = lens.ideal(imaged).unwrap();
                let back = lens.imaged(ideal).unwrap();
                assert!((0..2).all(|k| (back[k] - imaged[k]).abs() < 1e-9 * pitch[k]), "{i} {j}");
            }
        }
    }

    /// A curve of the second derivative c is c / 8 off its chord: of x = x' / (1 + k1 x'^2) or so, c is about 6 k1 x' of a pixel over the focal length.
    #[test]
    fn sides_are_curved_by_the_square_of_a_pixel() {
        let of = BrownConrady { radial: [-0.1, 0.0, 0.0], tangential: [0.0; 2] };
        let curved = |n: u32| {
            let pitch = 0.4 / f64::from(n);
            Lens::brown_conrady(of, [pitch; 2], [0.5 * f64::from(n); 2], [n, n]).unwrap().unwrap().sagitta_px()
        };
        let (coarse, fine) = (curved(50), curved(100));
        assert!(
            (coarse / fine - 2.0).abs() < 0.1 && coarse < 0.125 * 6.0 * 0.1 * 0.4 * 0.008 && coarse > 1e-5,
            "{coarse}"
        );
    }

    /// A pinhole's own centres.
    fn pinhole(size: [u32; 2], pitch: f64) -> Vec<Point> {
        let at = |i: u32, n: u32| (f64::from(i) + 0.5 - 0.5 * f64::from(n)) * pitch;
        (0..size[1]).flat_map(|line| (0..size[0]).map(move |sample| [at(sample, size[0]), at(line, size[1])])).collect()
    }

    #[test]
    fn a_table_of_a_pinhole_is_the_pinhole() {
        for size in [[5, 4], [7, 1], [1, 6]] {
            let lens = Lens::table(pinhole(size, 0.02), size).unwrap();
            assert!((lens.pitch()[0] / 0.02 - 1.0).abs() < 1e-13);
            for at in [[-0.06, -0.05], [0.013, 0.04], [0.0, 0.0]] {
                let (ideal, imaged) = (lens.ideal(at).unwrap(), lens.imaged(at).unwrap());
                assert!((0..2).all(|k| (ideal[k] - at[k]).abs() < 1e-15 && (imaged[k] - at[k]).abs() < 1e-15));
            }
        }
    }

    #[test]
    fn a_table_that_folds_or_looks_sideways_is_refused() {
        let size = [5, 4];
        let with = |change: &dyn Fn(&mut Vec<Point>)| {
            let mut centres = pinhole(size, 0.02);
            change(&mut centres);
            Lens::table(centres, size).unwrap_err()
        };
        // The last column goes back: between the last two the corners do, too.
        assert!(with(&|of| (0..4).for_each(|line| of[5 * line + 4][0] = of[5 * line + 3][0] - 0.03)).contains("fold"));
        assert!(with(&|of| of.iter_mut().for_each(|at| at[0] = -at[0])).contains("mirrored"));
        assert!(with(&|of| of[3][1] = f64::NAN).contains("pixel 3 of line 0"));
        assert!(with(&|of| of.iter_mut().for_each(|at| *at = at.map(|x| 2000.0 * x))).contains("89 deg"));
        assert!(with(&|of| of.truncate(19)).contains("19 directions"));
        assert!(Lens::table(vec![[0.0; 2]], [1, 1]).unwrap_err().contains("one direction"));
        assert!(Lens::table(vec![[0.1; 2]; 20], size).unwrap_err().contains("spread"));
    }
}
