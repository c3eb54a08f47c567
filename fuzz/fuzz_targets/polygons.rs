//! Two convex polygons whose corners are whole numbers, nearly: what they share, and what one has without the other, have areas that go
//! together.
//!
//! Two bytes for each corner: whole numbers and, by their last bits, a few units in the last place beside them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mmxrt::geometry::polygon::{Line, Point, Rect, area, clip_to_rect, clip_to_sides, intersect, split};
use robust::{Coord, orient2d};

/// Areas are known to this share of (extent)^2, and to the rounding of corners.
const TOLERANCE: f64 = 1e-12;

fuzz_target!(|data: &[u8]| {
    let [far, middle, corners @ ..] = data else { return };
    let offset = if far & 1 == 0 { 0.0 } else { 1e6 };
    let points: Vec<Point> =
        corners.as_chunks::<2>().0.iter().take(24).map(|c| c.map(|b| coordinate(b, offset))).collect();
    if points.is_empty() {
        return;
    }
    let (a, b) = points.split_at(points.len() * usize::from(*middle) / 256);
    let (mut a, b) = (hull(a), hull(b));
    if let (2, [corner, ..], [other, ..]) = (far & 2, a.as_slice(), b.as_slice()) {
        // What has been cut is convex up to rounding.
        let line = Line::through(*corner, *other);
        let value: Vec<f64> = a.iter().map(|p| line.side(*p)).collect();
        let mut inside = vec![];
        split(&a, &value, &mut inside, &mut vec![]);
        a = inside;
    }
    let all = Rect::of(&points);
    let extent = (all.max[0] - all.min[0]).max(all.max[1] - all.min[1]);
    let farthest = points.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Of sums, and of corners that are rounded, times the outline.
    let least = TOLERANCE * extent * extent + 16.0 * f64::EPSILON * farthest * extent;
    let (mut common, mut spare) = (vec![], vec![]);
    intersect(&a, &b, &mut common, &mut spare);
    let (of_a, of_b, shared) = (area(&a), area(&b), area(&common));
    assert!(shared >= -least && shared <= of_a.min(of_b) + least, "{of_a} {of_b} {shared} {common:?}");
    let mut back = vec![];
    intersect(&b, &a, &mut back, &mut spare);
    assert!((area(&back) - shared).abs() <= least, "{shared} {} {common:?} {back:?}", area(&back));
    // What lies beyond each side of b, one after the other, is the rest of a.
    let (mut rest, mut beyond) = (a.clone(), 0.0);
    for i in 0..b.len() {
        let line = Line::through(b[i], b[(i + 1) % b.len()]);
        let value: Vec<f64> = rest.iter().map(|p| line.side(*p)).collect();
        let (mut inside, mut outside) = (vec![], vec![]);
        split(&rest, &value, &mut inside, &mut outside);
        assert!((area(&inside) + area(&outside) - area(&rest)).abs() <= least, "{rest:?} {line:?}");
        beyond += area(&outside);
        rest = inside;
    }
    if !b.is_empty() {
        assert!((shared + beyond - of_a).abs() <= 4.0 * least, "{of_a} {shared} {beyond}");
        let sides: Vec<Line> = (0..b.len()).map(|i| Line::through(b[i], b[(i + 1) % b.len()])).collect();
        clip_to_sides(&a, &sides, &mut back, &mut spare);
        assert!((area(&back) - shared).abs() <= least, "{shared} {back:?}");
    }
    // A rectangle and its quarters.
    let rect = Rect::of(&b);
    if !b.is_empty() {
        clip_to_rect(&a, &rect, &mut back, &mut spare);
        let whole = area(&back);
        intersect(&a, &rect.corners(), &mut common, &mut spare);
        assert!((whole - area(&common)).abs() <= least, "{whole} {common:?}");
        let mut sum = 0.0;
        for quarter in rect.quarters() {
            clip_to_rect(&a, &quarter, &mut back, &mut spare);
            sum += area(&back);
        }
        assert!((sum - whole).abs() <= 4.0 * least, "{whole} {sum}");
    }
});

fn coordinate(byte: u8, offset: f64) -> f64 {
    let whole = f64::from(byte >> 3) - 16.0 + offset;
    let steps = f64::from(byte & 7) - 3.0;
    // Every other number is whole.
    if byte & 1 == 1 { whole } else { whole + steps * f64::EPSILON * whole.abs().max(1.0) }
}

fn coord([x, y]: Point) -> Coord<f64> {
    Coord { x, y }
}

/// The convex hull, counter-clockwise, strictly convex.
fn hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    sorted.dedup();
    let mut hull: Vec<Point> = vec![];
    for half in [sorted.clone(), sorted.into_iter().rev().collect()] {
        let base = hull.len();
        for p in half {
            while let [.., a, b] = hull[base..]
                && orient2d(coord(a), coord(b), coord(p)) <= 0.0
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
    }
    if hull.len() < 3 { vec![] } else { hull }
}
