//! The texels of an image that lie under a convex polygon of another plane: exact areas.
//!
//! Where a homography leads from the plane to the image, texel edges are straight lines in the plane: with s, t, w (linear in the
//! plane's coordinates) a point's homogeneous texel coordinates, the border between columns i and i + 1 is the line
//! s - (i + 1) w = 0. Polygons are split along these lines, in the plane, where areas are wanted.

use super::polygon::{Point, area};
use super::whole;

/// From a plane's coordinates (x, y, 1) to homogeneous texel coordinates: column = s / w, row = t / w, each of s, t, w a linear
/// form in (x, y, 1). Points with a w that is not positive have no place in the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chart {
    /// Column times w.
    pub s: [f64; 3],
    /// Row times w.
    pub t: [f64; 3],
    /// Positive where the image is.
    pub w: [f64; 3],
}

impl Chart {
    /// From (u, v) of a facet to a texture with these texel coordinates at its corners.
    pub fn affine([a, b, c]: &[Point; 3]) -> Self {
        let row = |k: usize| [b[k] - a[k], c[k] - a[k], a[k]];
        Chart { s: row(0), t: row(1), w: [0.0, 0.0, 1.0] }
    }

    /// Texel coordinates of a point; `None` where it has no place in the image.
    pub fn at(&self, p: Point) -> Option<Point> {
        let Vertex { s, t, w, .. } = self.vertex(p);
        (w > 0.0).then(|| [s / w, t / w])
    }

    /// With texel coordinates half a texel larger: borders of its cells are centres of texels.
    fn shifted_by_half(&self) -> Self {
        let plus_half = |f: [f64; 3]| [0, 1, 2].map(|k| f[k] + 0.5 * self.w[k]);
        Chart { s: plus_half(self.s), t: plus_half(self.t), w: self.w }
    }

    #[inline]
    fn vertex(&self, p: Point) -> Vertex {
        let form = |f: &[f64; 3]| f[0] * p[0] + f[1] * p[1] + f[2];
        Vertex { at: p, s: form(&self.s), t: form(&self.t), w: form(&self.w) }
    }
}

/// A corner of a piece, in the image and in the map.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Vertex {
    at: Point,
    s: f64,
    t: f64,
    w: f64,
}

impl Vertex {
    #[inline]
    fn between(a: &Vertex, da: f64, b: &Vertex, db: f64) -> Vertex {
        // In the order of coordinates, so that both sides of an edge get the same bits.
        let (a, da, b, db) = if (a.at[0], a.at[1]) <= (b.at[0], b.at[1]) { (a, da, b, db) } else { (b, db, a, da) };
        let k = da / (da - db);
        let mix = |x: f64, y: f64| x + k * (y - x);
        Vertex {
            at: [mix(a.at[0], b.at[0]), mix(a.at[1], b.at[1])],
            s: mix(a.s, b.s),
            t: mix(a.t, b.t),
            w: mix(a.w, b.w),
        }
    }
}

/// How values between texel centres are had.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Texels {
    /// A texel has one value all over.
    #[default]
    Nearest,
    /// Values vary bilinearly between the centres of texels, and are constant outside the outermost centres.
    Bilinear,
}

/// Splits convex polygons along texel edges; holds working memory.
#[derive(Debug, Default)]
pub struct Overlay {
    rest: Vec<Vertex>,
    row: Vec<Vertex>,
    cell: Vec<Vertex>,
    spare: Vec<Vertex>,
    outline: Vec<Point>,
}

impl Overlay {
    /// Calls `put(column, row, area)` for each texel of a map of `columns` x `rows` that some of a convex `piece`,
    /// counter-clockwise in the image, lies in.
    pub fn texels(&mut self, chart: &Chart, piece: &[Point], size: [usize; 2], mut put: impl FnMut(usize, usize, f64)) {
        self.cells(chart, piece, 0.0, size, |column, row, area, _| put(column, row, area));
    }

    /// Calls `put(around, area, error)` for each square between the centres of four texels that some of a convex `piece`,
    /// counter-clockwise in the image, lies in: the four (column, row, weight), their weights being the integrals of the
    /// bilinear shares over the area. `error` bounds that of the weights' sum of values, over the largest value and the area.
    ///
    /// A share is P / w^2, P quadratic in the image and w = w0 (1 + e), |e| <= d. In 1 / (1 + e)^2 = 1 - 2 e + 3 e^2 - 4 e^3 + ..
    /// the rule of degree 5 takes all terms to e^3 exactly; the rest is at most 5 d^4 / (1 - d)^2 of (1 + d)^2, for the
    /// integral and for the rule, whose weights are positive. Pieces are divided until that is below `QUADRATURE`, at most `DIVIDED`
    /// times. No error is above 1: integral and rule are both means of what lies between 0 and the largest value.
    pub fn centres(
        &mut self,
        chart: &Chart,
        piece: &[Point],
        [columns, rows]: [usize; 2],
        mut put: impl FnMut(&[(usize, usize, f64); 4], f64, f64),
    ) {
        let shifted = chart.shifted_by_half();
        self.cells(&shifted, piece, 0.5, [columns + 1, rows + 1], |column, row, area, corners| {
            let mut weights = [0.0; 4];
            let mut error: f64 = 0.0;
            for k in 2..corners.len() {
                let triangle = [corners[0], corners[k - 1], corners[k]];
                error = error.max(bilinear(&triangle, [column as f64, row as f64], DIVIDED, &mut weights));
            }
            let (left, right) = (column.saturating_sub(1), column.min(columns - 1));
            let (above, below) = (row.saturating_sub(1), row.min(rows - 1));
            let [a, b, c, d] = weights;
            put(&[(left, above, a), (right, above, b), (left, below, c), (right, below, d)], area, error);
        });
    }

    /// Calls `put(around, outline)` for each part of a convex `piece`, counter-clockwise in the image, in which the same texels count:
    /// those texels, (column, row), and the part's outline.
    pub fn outlines(
        &mut self,
        chart: &Chart,
        piece: &[Point],
        [columns, rows]: [usize; 2],
        texels: Texels,
        mut put: impl FnMut(&[(usize, usize)], Vec<Point>),
    ) {
        let outline = |corners: &[Vertex]| corners.iter().map(|v| v.at).collect();
        match texels {
            Texels::Nearest => {
                self.cells(chart, piece, 0.0, [columns, rows], |column, row, _, corners| {
                    put(&[(column, row)], outline(corners))
                });
            }
            Texels::Bilinear => {
                let shifted = chart.shifted_by_half();
                self.cells(&shifted, piece, 0.5, [columns + 1, rows + 1], |column, row, _, corners| {
                    let (left, right) = (column.saturating_sub(1), column.min(columns - 1));
                    let (above, below) = (row.saturating_sub(1), row.min(rows - 1));
                    put(&[(left, above), (right, above), (left, below), (right, below)], outline(corners));
                });
            }
        }
    }

    /// The cells of a grid that a piece touches, but for what lies within `margin` of the grid's outer borders.
    fn cells(
        &mut self,
        chart: &Chart,
        piece: &[Point],
        margin: f64,
        [columns, rows]: [usize; 2],
        mut put: impl FnMut(usize, usize, f64, &[Vertex]),
    ) {
        let (width, height) = (columns as f64 - margin, rows as f64 - margin);
        self.rest.clear();
        self.rest.extend(piece.iter().map(|p| chart.vertex(*p)));
        // What lies outside the map, or behind its eye, where w is not positive.
        keep(&mut self.rest, &mut self.spare, |v| v.s - margin * v.w);
        keep(&mut self.rest, &mut self.spare, |v| width * v.w - v.s);
        keep(&mut self.rest, &mut self.spare, |v| v.t - margin * v.w);
        keep(&mut self.rest, &mut self.spare, |v| height * v.w - v.t);
        if self.rest.len() < 3 {
            return;
        }
        let (first, last) = touched(self.rest.iter().map(|v| v.t / v.w), rows);
        for row in first..=last {
            if row < last {
                let border = (row + 1) as f64;
                split(&mut self.rest, &mut self.row, &mut self.spare, |v| v.t - border * v.w);
            } else {
                std::mem::swap(&mut self.rest, &mut self.row);
            }
            if self.row.len() < 3 {
                continue;
            }
            let (left, right) = touched(self.row.iter().map(|v| v.s / v.w), columns);
            for column in left..=right {
                if column < right {
                    let border = (column + 1) as f64;
                    split(&mut self.row, &mut self.cell, &mut self.spare, |v| v.s - border * v.w);
                } else {
                    std::mem::swap(&mut self.row, &mut self.cell);
                }
                if self.cell.len() < 3 {
                    continue;
                }
                self.outline.clear();
                self.outline.extend(self.cell.iter().map(|v| v.at));
                let inside = area(&self.outline);
                if inside > 0.0 {
                    put(column, row, inside, &self.cell);
                }
            }
        }
    }
}

/// Largest error of a bilinear texture by quadrature, relative to the largest value around; unless pieces would have to be
/// divided more than ...
const QUADRATURE: f64 = 1e-11;
/// ... at most this many times.
const DIVIDED: u32 = 6;

/// Radon's rule of degree 5 on a triangle (Stroud 1971, T2 5-1): barycentric coordinates and weights (sum 1).
const RADON: [([f64; 3], f64); 7] = {
    const THIRD: f64 = 1.0 / 3.0;
    // (6 -+ sqrt 15) / 21 and (155 -+ sqrt 15) / 1200.
    const A: f64 = 0.101_286_507_323_456_34;
    const B: f64 = 0.470_142_064_105_115_1;
    const WA: f64 = 0.125_939_180_544_827_15;
    const WB: f64 = 0.132_394_152_788_506_2;
    [
        ([THIRD, THIRD, THIRD], 0.225),
        ([1.0 - 2.0 * A, A, A], WA),
        ([A, 1.0 - 2.0 * A, A], WA),
        ([A, A, 1.0 - 2.0 * A], WA),
        ([1.0 - 2.0 * B, B, B], WB),
        ([B, 1.0 - 2.0 * B, B], WB),
        ([B, B, 1.0 - 2.0 * B], WB),
    ]
};

/// Adds the integrals of the four bilinear shares over a triangle that lies in the cell whose least corner is `corner`; returns a
/// bound of the error, relative to the largest value around.
fn bilinear(triangle: &[Vertex; 3], corner: Point, divide: u32, weights: &mut [f64; 4]) -> f64 {
    let w = triangle.map(|v| v.w);
    let (least, most) = (w[0].min(w[1]).min(w[2]), w[0].max(w[1]).max(w[2]));
    let d = (most - least) / (most + least);
    // NaN, of a w that is 0 all over, becomes 1.
    let error = (2.0 * 5.0 * d.powi(4) * ((1.0 + d) / (1.0 - d)).powi(2)).min(1.0);
    if error > QUADRATURE && divide > 0 {
        let [a, b, c] = triangle;
        let middle = |p: &Vertex, q: &Vertex| Vertex::between(p, 1.0, q, -1.0);
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        let quarters = [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]];
        return quarters.iter().map(|t| bilinear(t, corner, divide - 1, weights)).fold(0.0, f64::max);
    }
    let whole = area(&triangle.map(|v| v.at));
    for (at, weight) in RADON {
        let of = |f: fn(&Vertex) -> f64| (0..3).map(|k| at[k] * f(&triangle[k])).sum::<f64>();
        let w = of(|v| v.w);
        let x = of(|v| v.s) / w - corner[0];
        let y = of(|v| v.t) / w - corner[1];
        let weight = weight * whole;
        weights[0] += weight * (1.0 - x) * (1.0 - y);
        weights[1] += weight * x * (1.0 - y);
        weights[2] += weight * (1.0 - x) * y;
        weights[3] += weight * x * y;
    }
    error
}

/// First and last of `count` texels that some coordinates, within 0 to `count` up to rounding, lie in.
#[inline]
fn touched(coordinates: impl Iterator<Item = f64>, count: usize) -> (usize, usize) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for x in coordinates {
        low = low.min(x);
        high = high.max(x);
    }
    let first = whole(low).min(count - 1);
    let below = whole(high);
    let last = if below as f64 == high && below > first { below - 1 } else { below };
    (first, last.clamp(first, count - 1))
}

/// Leaves of a polygon what lies where `form`, linear in the image, is not negative.
#[inline]
fn keep(polygon: &mut Vec<Vertex>, spare: &mut Vec<Vertex>, form: impl Fn(&Vertex) -> f64) {
    if polygon.iter().all(|v| form(v) >= 0.0) {
        return;
    }
    spare.clear();
    let Some(mut before) = polygon.last().copied() else { return };
    let mut d_before = form(&before);
    for v in polygon.iter() {
        let d = form(v);
        if (d > 0.0 && d_before < 0.0) || (d < 0.0 && d_before > 0.0) {
            spare.push(Vertex::between(&before, d_before, v, d));
        }
        if d >= 0.0 {
            spare.push(*v);
        }
        (before, d_before) = (*v, d);
    }
    std::mem::swap(polygon, spare);
}

/// Moves to `below` what of a polygon lies where `form`, linear in the image, is not positive; `polygon` keeps the rest.
#[inline]
fn split(polygon: &mut Vec<Vertex>, below: &mut Vec<Vertex>, above: &mut Vec<Vertex>, form: impl Fn(&Vertex) -> f64) {
    below.clear();
    above.clear();
    let Some(mut before) = polygon.last().copied() else { return };
    let mut d_before = form(&before);
    for v in polygon.iter() {
        let d = form(v);
        if (d > 0.0 && d_before < 0.0) || (d < 0.0 && d_before > 0.0) {
            let x = Vertex::between(&before, d_before, v, d);
            below.push(x);
            above.push(x);
        }
        if d <= 0.0 {
            below.push(*v);
        }
        if d >= 0.0 {
            above.push(*v);
        }
        (before, d_before) = (*v, d);
    }
    std::mem::swap(polygon, above);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Texel coordinates are image coordinates, times `scale`, seen through a tilt of `w`.
    fn chart(scale: f64, tilt: f64) -> Chart {
        Chart { s: [scale, 0.0, 0.0], t: [0.0, scale, 0.0], w: [tilt, 0.0, 1.0] }
    }

    fn areas(chart: &Chart, piece: &[Point], size: [usize; 2]) -> Vec<(usize, usize, f64)> {
        let mut areas = vec![];
        Overlay::default().texels(chart, piece, size, |c, r, a| areas.push((c, r, a)));
        areas
    }

    #[test]
    fn a_triangle_over_four_texels() {
        // Legs of 2 on a grid of 1: a whole texel, and two halves; the hypotenuse passes through a corner.
        let found = areas(&chart(1.0, 0.0), &[[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]], [4, 4]);
        assert_eq!(found, [(0, 0, 1.0), (1, 0, 0.5), (0, 1, 0.5)]);
    }

    #[test]
    fn what_lies_beyond_the_map_is_left_out() {
        let square = [[-1.0, -1.0], [1.5, -1.0], [1.5, 3.0], [-1.0, 3.0]];
        assert_eq!(areas(&chart(1.0, 0.0), &square, [1, 2]), [(0, 0, 1.0), (0, 1, 1.0)]);
        // s = x, w = 1 - x: behind the map's eye from x = 1 on, and beyond two columns from x = 2/3 on (s / w = 2).
        let found = areas(&chart(1.0, -1.0), &[[0.0, 0.0], [3.0, 0.0], [3.0, 0.1], [0.0, 0.1]], [2, 9]);
        let area: f64 = found.iter().map(|f| f.2).sum();
        assert!((area - 0.1 * 2.0 / 3.0).abs() < 1e-16, "{found:?}");
        // Column 0 ends at x = 1/2.
        assert!((found[0].2 - 0.05).abs() < 1e-16 && found[0].0 == 0);
    }

    #[test]
    fn a_bilinear_ramp_has_its_analytic_mean() {
        // Texel values are the columns of their centres, so that the texture is s / w itself: here x / (1 + x / 2), whose
        // integral is 2 x - 4 ln(1 + x / 2).
        let (x0, x1) = (1.0, 3.0);
        let piece = [[x0, 1.0], [x1, 1.0], [x1, 1.25], [x0, 1.25]];
        let (mut integral, mut areas, mut worst) = (0.0, 0.0, 0.0_f64);
        Overlay::default().centres(&chart(1.0, 0.5), &piece, [4, 4], |around, area, error| {
            integral += around.iter().map(|(c, _, w)| (*c as f64 + 0.5) * w).sum::<f64>();
            areas += area;
            worst = worst.max(error);
        });
        let of = |x: f64| 2.0 * x - 4.0 * (1.0 + x / 2.0).ln();
        assert!((areas - 0.5).abs() < 1e-15 && worst <= 1e-6);
        assert!((integral - 0.25 * (of(x1) - of(x0))).abs() < 1e-12, "{integral} {worst}");
    }

    #[test]
    fn the_bound_of_the_error_holds_under_extreme_perspective() {
        // s / w = 1/2 + x / (e + x), all of it between the first two centres: w grows 1/e-fold within one cell. With the values
        // 1/2 and 3/2 that is the texture; its integral over 0 to 1 is 3/2 - e ln((1 + e) / e).
        for (e, divided) in [(100.0_f64, 1e-11), (0.5, 1e-5), (1e-2, 1.0), (1e-6, 1.0), (1e-12, 1.0)] {
            let chart = Chart { s: [1.5, 0.0, 0.5 * e], t: [1.0, 0.0, e], w: [1.0, 0.0, e] };
            let (mut integral, mut worst) = (0.0, 0.0_f64);
            let piece = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            Overlay::default().centres(&chart, &piece, [2, 2], |around, _, error| {
                integral += around.iter().map(|(c, _, w)| (*c as f64 + 0.5) * w).sum::<f64>();
                worst = worst.max(error);
            });
            let exact = 1.5 - e * ((1.0 + e) / e).ln();
            let error = (integral - exact).abs();
            assert!(error <= 1.5 * worst + 1e-15 && worst <= divided, "{e}: {error} {worst}");
        }
        // Where the eye's own plane cuts the piece, nothing is known but that shares are shares.
        let chart = Chart { s: [1.0, 0.0, 0.0], t: [1.0, 0.0, 0.0], w: [1.0, 0.0, 0.0] };
        let piece = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        Overlay::default()
            .centres(&chart, &piece, [2, 2], |_, _, error| assert!((0.0..=1.0).contains(&error) && error > 0.0));
    }

    #[test]
    fn texels_under_perspective_have_analytic_areas() {
        // s = 7 x, w = 1 + x / 2: column borders at x = i / (7 - i / 2).
        let found = areas(&chart(7.0, 0.5), &[[0.0, 0.0], [1.0, 0.0], [1.0, 0.05], [0.0, 0.05]], [7, 7]);
        let border = |i: f64| (i / (7.0 - i / 2.0)).min(1.0);
        assert_eq!(found.len(), 5);
        for (column, _, area) in found {
            let i = column as f64;
            assert!((area - 0.05 * (border(i + 1.0) - border(i))).abs() < 1e-16);
        }
    }
}
