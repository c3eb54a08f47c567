//! Convex polygons in the plane: areas, clipping, splitting.
//!
//! Polygons are lists of points, convex up to rounding. Orientation is kept by every function here. What is cut may have corners
//! that rounding has put anywhere within its error; what cuts may not, since the line along a side as short as that points
//! anywhere: it is cut by [`Line`]s given by exact corners, or by the sides of an exact convex hull.

use robust::{Coord, orient2d};

/// A point in the plane.
pub type Point = [f64; 2];

/// Signed area, about the first vertex: positive counter-clockwise where x points right and y up.
#[inline]
pub fn area(polygon: &[Point]) -> f64 {
    let Some(&[x0, y0]) = polygon.first() else { return 0.0 };
    let mut twice = 0.0;
    for w in polygon[1..].windows(2) {
        twice += (w[0][0] - x0) * (w[1][1] - y0) - (w[1][0] - x0) * (w[0][1] - y0);
    }
    0.5 * twice
}

/// Signed area, and signed area times centroid.
pub fn area_and_moment(polygon: &[Point]) -> (f64, Point) {
    let Some(&[x0, y0]) = polygon.first() else { return (0.0, [0.0; 2]) };
    let (mut twice, mut mx, mut my) = (0.0, 0.0, 0.0);
    for w in polygon[1..].windows(2) {
        let (ax, ay, bx, by) = (w[0][0] - x0, w[0][1] - y0, w[1][0] - x0, w[1][1] - y0);
        let cross = ax * by - bx * ay;
        twice += cross;
        mx += cross * (ax + bx);
        my += cross * (ay + by);
    }
    let area = 0.5 * twice;
    (area, [mx / 6.0 + x0 * area, my / 6.0 + y0 * area])
}

/// An axis-aligned rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Smallest x, y.
    pub min: Point,
    /// Largest x, y.
    pub max: Point,
}

impl Rect {
    /// The bounds of some points.
    #[inline]
    pub fn of(points: &[Point]) -> Rect {
        let mut rect = Rect { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        for p in points {
            let [x, y] = *p;
            rect.min = [rect.min[0].min(x), rect.min[1].min(y)];
            rect.max = [rect.max[0].max(x), rect.max[1].max(y)];
        }
        rect
    }

    /// Whether two rectangles share more than a border.
    #[inline]
    pub fn overlaps(&self, other: &Rect) -> bool {
        self.min[0] < other.max[0]
            && other.min[0] < self.max[0]
            && self.min[1] < other.max[1]
            && other.min[1] < self.max[1]
    }

    /// What two rectangles share; turned inside out if they share nothing.
    #[inline]
    pub fn common(&self, other: &Rect) -> Rect {
        Rect {
            min: [self.min[0].max(other.min[0]), self.min[1].max(other.min[1])],
            max: [self.max[0].min(other.max[0]), self.max[1].min(other.max[1])],
        }
    }

    /// Whether another rectangle lies inside or on the border.
    #[inline]
    pub fn contains(&self, other: &Rect) -> bool {
        self.min[0] <= other.min[0]
            && other.max[0] <= self.max[0]
            && self.min[1] <= other.min[1]
            && other.max[1] <= self.max[1]
    }

    /// Whether a point lies inside or on the border.
    #[inline]
    pub fn holds(&self, p: Point) -> bool {
        self.min[0] <= p[0] && p[0] <= self.max[0] && self.min[1] <= p[1] && p[1] <= self.max[1]
    }

    /// Area.
    pub fn area(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }

    /// The corners, counter-clockwise where x points right and y up.
    pub fn corners(&self) -> [Point; 4] {
        let ([x0, y0], [x1, y1]) = (self.min, self.max);
        [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    }

    /// The centre.
    pub fn centre(&self) -> Point {
        [0.5 * (self.min[0] + self.max[0]), 0.5 * (self.min[1] + self.max[1])]
    }

    /// The four quarters.
    pub fn quarters(&self) -> [Rect; 4] {
        let ([x0, y0], [x1, y1], [x, y]) = (self.min, self.max, self.centre());
        [
            Rect { min: [x0, y0], max: [x, y] },
            Rect { min: [x, y0], max: [x1, y] },
            Rect { min: [x0, y], max: [x, y1] },
            Rect { min: [x, y], max: [x1, y1] },
        ]
    }
}

/// The point where the segment between `a` and `b` meets the line where `da`, `db` (of strictly opposite signs) pass zero.
///
/// The ends are taken in the order of their coordinates, so that two polygons that share the segment get the same bits.
#[inline]
fn crossing(a: Point, da: f64, b: Point, db: f64) -> Point {
    let ((a, da), (b, db)) = if (a[0], a[1]) <= (b[0], b[1]) { ((a, da), (b, db)) } else { ((b, db), (a, da)) };
    let t = da / (da - db);
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

#[inline]
fn push(polygon: &mut Vec<Point>, p: Point) {
    if polygon.last() != Some(&p) {
        polygon.push(p);
    }
}

/// Drops coinciding neighbours and what has no area left: a zero-length edge has no direction to clip by.
fn tidy(polygon: &mut Vec<Point>) {
    while polygon.len() > 1 && polygon.first() == polygon.last() {
        polygon.pop();
    }
    if polygon.len() < 3 {
        polygon.clear();
    }
}

/// Splits a polygon where the affine function with `value` at its vertices is positive (`inside`) and negative (`outside`).
///
/// Both sides get the same bits on the cut. A side without interior is left empty. Both are cleared first.
pub fn split(polygon: &[Point], value: &[f64], inside: &mut Vec<Point>, outside: &mut Vec<Point>) {
    inside.clear();
    outside.clear();
    let (mut some_inside, mut some_outside) = (false, false);
    for i in 0..polygon.len() {
        let j = if i + 1 == polygon.len() { 0 } else { i + 1 };
        let (p, d, e) = (polygon[i], value[i], value[j]);
        if d >= 0.0 {
            push(inside, p);
        }
        if d <= 0.0 {
            push(outside, p);
        }
        some_inside |= d > 0.0;
        some_outside |= d < 0.0;
        if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
            let x = crossing(p, d, polygon[j], e);
            push(inside, x);
            push(outside, x);
        }
    }
    if !some_inside {
        inside.clear();
    }
    if !some_outside {
        outside.clear();
    }
    tidy(inside);
    tidy(outside);
}

/// The directed line through two points: which side of it others lie on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// The end with the lower coordinates, the step from there to the other, and 1, or -1 where that is backwards.
    from: Point,
    step: [f64; 2],
    sign: f64,
}

impl Line {
    /// The line from `a` to `b`.
    #[inline]
    pub fn through(a: Point, b: Point) -> Line {
        let (from, to, sign) = if (a[0], a[1]) <= (b[0], b[1]) { (a, b, 1.0) } else { (b, a, -1.0) };
        Line { from, step: [to[0] - from[0], to[1] - from[1]], sign }
    }

    /// Signed distance (times the length of a-b) of `p` from the line, positive to the left;
    /// exactly 0 where the sign is not certain in f64.
    ///
    /// Antisymmetric to the last bit in the exchange of the line's ends.
    #[inline]
    pub fn side(&self, p: Point) -> f64 {
        let left = self.step[0] * (p[1] - self.from[1]);
        let right = self.step[1] * (p[0] - self.from[0]);
        let d = left - right;
        // Forward error of the four differences, two products and one sum: Shewchuk (1997), 3 + 16 eps of |left| + |right|.
        if d.abs() <= 4.0 * f64::EPSILON * (left.abs() + right.abs()) { 0.0 } else { self.sign * d }
    }

    /// The corner of a rectangle that lies farthest to the left.
    #[inline]
    fn leftmost(&self, rect: &Rect) -> Point {
        let x = if self.sign * self.step[1] > 0.0 { rect.min[0] } else { rect.max[0] };
        let y = if self.sign * self.step[0] > 0.0 { rect.max[1] } else { rect.min[1] };
        [x, y]
    }

    /// Whether all of a rectangle certainly lies to the right.
    #[inline]
    pub fn has_on_its_right(&self, rect: &Rect) -> bool {
        self.side(self.leftmost(rect)) < 0.0
    }

    /// Whether all of a rectangle certainly lies to one side.
    #[inline]
    pub fn passes_by(&self, rect: &Rect) -> bool {
        let [x, y] = self.leftmost(rect);
        let opposite = |lo: f64, hi: f64, at: f64| if at == lo { hi } else { lo };
        let rightmost = [opposite(rect.min[0], rect.max[0], x), opposite(rect.min[1], rect.max[1], y)];
        self.side([x, y]) < 0.0 || self.side(rightmost) > 0.0
    }
}

/// Signed distance of `p` from the line from `a` to `b`: see [`Line::side`].
#[inline]
pub fn side(a: Point, b: Point, p: Point) -> f64 {
    Line::through(a, b).side(p)
}

/// Whether a counter-clockwise polygon holds a point, its border included.
pub fn holds(polygon: &[Point], p: Point) -> bool {
    Rect::of(polygon).holds(p) && lies_left_of_all_sides(polygon, |line| line.side(p) >= 0.0)
}

/// Whether a counter-clockwise polygon may have something in common with a rectangle; errs on the side of yes.
pub fn may_touch(polygon: &[Point], rect: &Rect) -> bool {
    Rect::of(polygon).overlaps(rect) && lies_left_of_all_sides(polygon, |line| !line.has_on_its_right(rect))
}

/// Whether something lies to the left of all sides of a polygon.
fn lies_left_of_all_sides(polygon: &[Point], left: impl Fn(&Line) -> bool) -> bool {
    let mut all = true;
    if each_side(polygon, |line| all &= left(line)) {
        return all;
    }
    let outline = convex_outline(polygon);
    !outline.is_empty() && sides(&outline).all(|line| left(&line))
}

/// The lines along the sides of a polygon.
fn sides(polygon: &[Point]) -> impl Iterator<Item = Line> {
    (0..polygon.len()).map(|i| Line::through(polygon[i], polygon[if i + 1 == polygon.len() { 0 } else { i + 1 }]))
}

/// Calls `put` with the line along each side of a polygon. Returns whether the polygon is certainly counter-clockwise and convex; if not,
/// nothing may be taken from these lines, since a side as short as rounding points anywhere.
///
/// Where each corner turns left, the sides turn once around if they change between up and down, in the order of coordinates, twice.
#[inline]
fn each_side(polygon: &[Point], mut put: impl FnMut(&Line)) -> bool {
    let n = polygon.len();
    let next = |i: usize| if i + 1 == n { 0 } else { i + 1 };
    let mut changes = 0;
    let mut before = if n == 0 { 0.0 } else { Line::through(polygon[n - 1], polygon[0]).sign };
    for i in 0..n {
        let j = next(i);
        let line = Line::through(polygon[i], polygon[j]);
        if line.side(polygon[next(j)]) <= 0.0 {
            return false;
        }
        changes += u32::from(line.sign != before);
        before = line.sign;
        put(&line);
    }
    changes == 2
}

/// The convex hull of a polygon that is convex up to rounding, counter-clockwise and strictly convex, in exact arithmetic; empty if
/// all corners lie on a line.
///
/// It differs from the polygon by no more than the rounding of the corners, and each of its sides, however short, has the polygon
/// on its left: Andrew (1979), by an exact predicate.
#[cold]
fn convex_outline(polygon: &[Point]) -> Vec<Point> {
    let coord = |p: Point| Coord { x: p[0], y: p[1] };
    // + 0.0 makes -0.0 and 0.0 one number.
    let mut corners: Vec<Point> = polygon.iter().map(|p| p.map(|x| x + 0.0)).collect();
    corners.sort_unstable_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    corners.dedup();
    let mut outline: Vec<Point> = Vec::with_capacity(corners.len() + 1);
    for half in [corners.clone(), corners.into_iter().rev().collect()] {
        let base = outline.len();
        for p in half {
            while let [.., a, b] = outline[base..]
                && orient2d(coord(a), coord(b), coord(p)) <= 0.0
            {
                outline.pop();
            }
            outline.push(p);
        }
        // The last of one half is the first of the other.
        outline.pop();
    }
    if outline.len() < 3 {
        outline.clear();
    }
    outline
}

/// The part of a convex polygon inside a rectangle. `out` is cleared first.
pub fn clip_to_rect(polygon: &[Point], rect: &Rect, out: &mut Vec<Point>, spare: &mut Vec<Point>) {
    let bounds = Rect::of(polygon);
    out.clear();
    // What one limit cuts off can only make another needless, so that the first bounds tell which are needed. The first takes the
    // polygon as it is.
    let mut uncut = Some(polygon);
    if bounds.min[0] < rect.min[0] {
        clip_to_limit::<0, true>(uncut.take(), rect.min[0], out, spare);
    }
    if bounds.max[0] > rect.max[0] {
        clip_to_limit::<0, false>(uncut.take(), rect.max[0], out, spare);
    }
    if bounds.min[1] < rect.min[1] {
        clip_to_limit::<1, true>(uncut.take(), rect.min[1], out, spare);
    }
    if bounds.max[1] > rect.max[1] {
        clip_to_limit::<1, false>(uncut.take(), rect.max[1], out, spare);
    }
    out.extend_from_slice(uncut.unwrap_or_default());
}

/// Leaves in `out` the part of `polygon`, or else of what `out` holds, where the coordinate `AXIS` is at least `limit`; at most, if not `ABOVE`.
#[inline]
fn clip_to_limit<const AXIS: usize, const ABOVE: bool>(
    polygon: Option<&[Point]>,
    limit: f64,
    out: &mut Vec<Point>,
    spare: &mut Vec<Point>,
) {
    spare.clear();
    let polygon = polygon.unwrap_or(out);
    let Some(&last) = polygon.last() else { return };
    let inside = |p: Point| if ABOVE { p[AXIS] - limit } else { limit - p[AXIS] };
    if let &[a, b, c] = polygon
        && let Some(part) = part_of_triangle([a, b, c], [inside(a), inside(b), inside(c)], AXIS, limit)
    {
        out.clear();
        match part {
            TrianglePart::Corner(part) => out.extend_from_slice(&part),
            TrianglePart::Side(part) => out.extend_from_slice(&part),
        }
        return;
    }
    let (mut before, mut e) = (last, inside(last));
    for &p in polygon {
        let d = inside(p);
        if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
            let mut x = crossing(before, e, p, d);
            x[AXIS] = limit;
            push(spare, x);
        }
        if d >= 0.0 {
            push(spare, p);
        }
        (before, e) = (p, d);
    }
    tidy(spare);
    std::mem::swap(out, spare);
}

/// What a line leaves of a triangle.
enum TrianglePart {
    /// One corner is inside.
    Corner([Point; 3]),
    /// Two corners are inside.
    Side([Point; 4]),
}

/// What a limit of one coordinate leaves of a triangle whose corners lie at these distances inside it: nearly everything that is cut is a
/// triangle, and cut once. `None` if corners coincide or lie on the limit, or if the limit does not cut it.
#[inline]
fn part_of_triangle([a, b, c]: [Point; 3], [da, db, dc]: [f64; 3], axis: usize, limit: f64) -> Option<TrianglePart> {
    if ![da, db, dc].iter().all(|d| d.abs() > 0.0) {
        return None;
    }
    let meet = |p: Point, d: f64, q: Point, e: f64| {
        let mut x = crossing(p, d, q, e);
        x[axis] = limit;
        x
    };
    let (ab, bc, ca) = (|| meet(a, da, b, db), || meet(b, db, c, dc), || meet(c, dc, a, da));
    let part = match (da > 0.0, db > 0.0, dc > 0.0) {
        (true, false, false) => TrianglePart::Corner([ca(), a, ab()]),
        (false, true, false) => TrianglePart::Corner([ab(), b, bc()]),
        (false, false, true) => TrianglePart::Corner([ca(), bc(), c]),
        (true, true, false) => TrianglePart::Side([ca(), a, b, bc()]),
        (false, true, true) => TrianglePart::Side([ca(), ab(), b, c]),
        (true, false, true) => TrianglePart::Side([a, ab(), bc(), c]),
        (true, true, true) | (false, false, false) => return None,
    };
    let coincide = match &part {
        TrianglePart::Corner([p, q, r]) => p == q || q == r || r == p,
        TrianglePart::Side([p, q, r, s]) => p == q || q == r || r == s || s == p,
    };
    if coincide { None } else { Some(part) }
}

/// The part of a convex polygon to the left of some lines. `out` is cleared first.
pub fn clip_to_sides(polygon: &[Point], sides: &[Line], out: &mut Vec<Point>, spare: &mut Vec<Point>) {
    out.clear();
    out.extend_from_slice(polygon);
    for line in sides {
        cut_by(|p| line.side(p), out, spare);
    }
}

/// Nearly all polygons that are cut have at most this many corners.
const FEW_CORNERS: usize = 16;

/// Leaves of a polygon what lies where `distance`, affine, is not negative.
#[inline]
fn cut_by(distance: impl Fn(Point) -> f64, polygon: &mut Vec<Point>, spare: &mut Vec<Point>) {
    let Some(&last) = polygon.last() else { return };
    let (mut few, mut many) = ([0.0; FEW_CORNERS], vec![]);
    let distances = match few.get_mut(..polygon.len()) {
        Some(few) => few,
        None => {
            many.resize(polygon.len(), 0.0);
            &mut many[..]
        }
    };
    let (mut inside, mut outside) = (false, false);
    for (d, p) in distances.iter_mut().zip(&*polygon) {
        *d = distance(*p);
        let is_inside = *d >= 0.0;
        inside |= is_inside;
        outside |= !is_inside;
    }
    // Most lines leave all of a polygon or nothing: then no corner moves.
    if !inside {
        polygon.clear();
    }
    if !(inside && outside) {
        return;
    }
    spare.clear();
    let (mut before, mut e) = (last, distances[distances.len() - 1]);
    for (&x, &d) in polygon.iter().zip(&*distances) {
        if (d > 0.0 && e < 0.0) || (d < 0.0 && e > 0.0) {
            push(spare, crossing(before, e, x, d));
        }
        if d >= 0.0 {
            push(spare, x);
        }
        (before, e) = (x, d);
    }
    tidy(spare);
    std::mem::swap(polygon, spare);
}

/// The common part of two convex polygons that are both counter-clockwise (x right, y up). `out` is cleared first.
///
/// Either may be convex up to rounding only: it is as if `b` were its convex hull. What is computed differs from the common part by no
/// more than the rounding of corners, times the outlines.
pub fn intersect(a: &[Point], b: &[Point], out: &mut Vec<Point>, spare: &mut Vec<Point>) {
    let start = |out: &mut Vec<Point>| {
        out.clear();
        out.extend_from_slice(a);
    };
    start(out);
    if each_side(b, |line| cut_by(|x| line.side(x), out, spare)) {
        return;
    }
    let outline = convex_outline(b);
    out.clear();
    if !outline.is_empty() {
        start(out);
        sides(&outline).for_each(|line| cut_by(|x| line.side(x), out, spare));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Point; 4] = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];

    #[test]
    fn a_square_has_area_and_centroid() {
        assert_eq!(area(&SQUARE), 4.0);
        assert_eq!(area_and_moment(&SQUARE), (4.0, [4.0, 4.0]));
        let far: Vec<Point> = SQUARE.iter().map(|p| [p[0] + 1e8, p[1] - 1e8]).collect();
        let (a, m) = area_and_moment(&far);
        assert_eq!((a, m[0] / a, m[1] / a), (4.0, 1e8 + 1.0, 1.0 - 1e8));
        assert_eq!(area(&[]), 0.0);
    }

    #[test]
    fn a_limit_cuts_a_triangle_as_it_cuts_any_polygon() {
        let (mut out, mut spare) = (vec![], vec![]);
        let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
        // x from 1 to 9: the corner at (4, 0) is left, the cut runs from (1, 3) to (1, 0); and so on around.
        let right = Rect { min: [1.0, -9.0], max: [9.0, 9.0] };
        let left = Rect { min: [-9.0, -9.0], max: [1.0, 9.0] };
        for turn in 0..3 {
            let triangle = [0, 1, 2].map(|k: usize| corners[(k + turn) % 3]);
            // The same outline with one corner more, on a side.
            let polygon =
                [triangle[0], triangle[1], triangle[2], [0, 1].map(|k| 0.5 * (triangle[0][k] + triangle[2][k]))];
            for (rect, area_px) in [(right, 4.5), (left, 3.5)] {
                clip_to_rect(&triangle, &rect, &mut out, &mut spare);
                let (of_triangle, moment) = area_and_moment(&out);
                assert_eq!((of_triangle, out.len()), (area_px, if rect == right { 3 } else { 4 }), "{turn}");
                clip_to_rect(&polygon, &rect, &mut out, &mut spare);
                let (of_polygon, other) = area_and_moment(&out);
                assert_eq!(
                    (of_triangle, moment.map(|m| (m * 1e9).round())),
                    (of_polygon, other.map(|m| (m * 1e9).round()))
                );
            }
        }
        // Corners on the limit: all or nothing is left.
        let beyond = Rect { min: [4.0, -9.0], max: [9.0, 9.0] };
        clip_to_rect(&corners, &beyond, &mut out, &mut spare);
        assert!(out.is_empty());
    }

    #[test]
    fn splitting_keeps_the_area_and_the_cut() {
        let value: Vec<f64> = SQUARE.iter().map(|p| p[0] + p[1] - 1.0).collect();
        let (mut inside, mut outside) = (vec![], vec![]);
        split(&SQUARE, &value, &mut inside, &mut outside);
        assert_eq!((area(&inside), area(&outside)), (3.5, 0.5));
        assert!(outside.contains(&[1.0, 0.0]) && inside.contains(&[1.0, 0.0]));
    }

    #[test]
    fn touching_is_not_overlapping() {
        let (mut inside, mut outside) = (vec![], vec![]);
        split(&SQUARE, &[0.0, 0.0, -1.0, -1.0], &mut inside, &mut outside);
        assert!(inside.is_empty());
        assert_eq!(outside.len(), 4);
    }

    #[test]
    fn a_triangle_in_a_pixel() {
        let (mut out, mut spare) = (vec![], vec![]);
        let rect = Rect { min: [1.0, 1.0], max: [2.0, 2.0] };
        clip_to_rect(&[[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]], &rect, &mut out, &mut spare);
        assert_eq!(area(&out), 0.5);
        clip_to_rect(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &rect, &mut out, &mut spare);
        assert!(out.is_empty());
    }

    #[test]
    fn two_squares_share_a_square() {
        let shifted: Vec<Point> = SQUARE.iter().map(|p| [p[0] + 1.0, p[1] + 1.0]).collect();
        let (mut out, mut spare) = (vec![], vec![]);
        intersect(&SQUARE, &shifted, &mut out, &mut spare);
        assert_eq!(area(&out), 1.0);
        let apart: Vec<Point> = SQUARE.iter().map(|p| [p[0] + 2.0, p[1]]).collect();
        intersect(&SQUARE, &apart, &mut out, &mut spare);
        assert_eq!(area(&out), 0.0);
    }

    #[test]
    fn a_short_edge_cuts_nothing_off() {
        // A triangle with a corner cut off by 2.65e-12 under whatever angle: 1 x 1 / 2 in common with a square, all the same.
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let (mut out, mut spare) = (vec![], vec![]);
        for (dx, dy) in
            [(2.65e-12, 0.0), (0.0, 2.65e-12), (1e-12, -2e-12), (-2e-12, 1e-12), (-2e-12, -2e-12), (2e-12, 2e-12)]
        {
            let cut = [[0.0, 0.0], [dx, dy], [1.0, 0.0], [0.0, 1.0]];
            intersect(&square, &cut, &mut out, &mut spare);
            assert!((area(&out) - 0.5).abs() < 1e-11, "{dx} {dy}: {}", area(&out));
            intersect(&cut, &square, &mut out, &mut spare);
            assert!((area(&out) - 0.5).abs() < 1e-11, "{dx} {dy}: {}", area(&out));
        }
        // As it once came from a cut: 0.0124 px in common, by exact rationals.
        let piece = [
            [181.7568674653801, 47.84571572992302],
            [181.7041165333865, 47.89885138931364],
            [181.65337277398217, 47.544468097197935],
            [181.66872461263745, 47.519744027001096],
            [181.66872461263816, 47.51974402700365],
        ];
        let lit = [
            [181.85699229096875, 47.74486066579507],
            [181.53514260909148, 48.06905768800664],
            [181.53516993031872, 47.97412285883492],
            [181.5879475158834, 47.67647229122913],
            [181.64031354383, 47.57769675583148],
        ];
        for (a, b) in [(&lit, &piece), (&piece, &lit)] {
            intersect(a, b, &mut out, &mut spare);
            assert!((area(&out) - 0.012402524372242776).abs() < 1e-12, "{}", area(&out));
        }
    }

    #[test]
    fn the_side_of_a_line_does_not_depend_on_its_direction() {
        let (a, b) = ([0.1, 0.2], [0.7, 0.9]);
        for p in [[0.3, 0.1], [1e9, -3.0], [0.1, 0.2], [0.4, 0.55]] {
            assert_eq!(
                side(a, b, p).to_bits(),
                (-side(b, a, p)).to_bits() & if side(a, b, p) == 0.0 { 0 } else { u64::MAX }
            );
        }
        assert!(side([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]) > 0.0);
    }
}
