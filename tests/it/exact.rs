//! Footprints against exact rational numbers.

use std::ops::{Add, Mul, Sub};

use crate::shapes::*;
use mmxrt::geometry::Mesh;

/// A fraction in lowest terms; its denominator is positive.
#[derive(Clone, Copy, PartialEq)]
struct Exact(i128, i128);

fn exact(over: i128, under: i128) -> Exact {
    let (mut a, mut b) = (over.abs(), under.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    let divisor = if under < 0 { -a.max(1) } else { a.max(1) };
    Exact(over / divisor, under / divisor)
}

impl Add for Exact {
    type Output = Exact;
    fn add(self, o: Exact) -> Exact {
        exact(self.0 * o.1 + o.0 * self.1, self.1 * o.1)
    }
}

impl Sub for Exact {
    type Output = Exact;
    fn sub(self, o: Exact) -> Exact {
        exact(self.0 * o.1 - o.0 * self.1, self.1 * o.1)
    }
}

impl Mul for Exact {
    type Output = Exact;
    fn mul(self, o: Exact) -> Exact {
        exact(self.0 * o.0, self.1 * o.1)
    }
}

/// The part of a polygon where sign (p[axis] - at) >= 0.
fn clip(polygon: &[[Exact; 2]], axis: usize, at: i128, sign: i128) -> Vec<[Exact; 2]> {
    let distance = |p: &[Exact; 2]| exact(sign, 1) * (p[axis] - exact(at, 1));
    let mut kept = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (d, e) = (distance(a), distance(b));
        if d.0 >= 0 {
            kept.push(*a);
        }
        if (d.0 >= 0) != (e.0 >= 0) {
            let length = d - e;
            let t = d * exact(length.1, length.0);
            kept.push([0, 1].map(|k| a[k] + t * (b[k] - a[k])));
        }
    }
    kept
}

/// Units of the corners' coordinates in a pixel: halves to sixths are whole numbers of them.
const UNITS: i64 = 60;
const PIXELS: usize = 4;

/// A triangle in an image of 4 x 4 pixels; some reach beyond it.
type Triangle = [[i64; 2]; 3];

/// Share of a pixel that a triangle covers, without rounding until the end.
fn share(triangle: &Triangle, column: usize, row: usize) -> f64 {
    let mut polygon = triangle.map(|p| p.map(|x| exact(i128::from(x), i128::from(UNITS)))).to_vec();
    for (axis, at) in [(0, column as i128), (1, row as i128)] {
        polygon = clip(&polygon, axis, at, 1);
        polygon = clip(&polygon, axis, at + 1, -1);
    }
    let mut twice = exact(0, 1);
    for (i, p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        twice = twice + (p[0] * q[1] - q[0] * p[1]);
    }
    0.5 * (twice.0 as f64 / twice.1 as f64).abs()
}

fn random(random: &mut Random) -> Triangle {
    [(); 3].map(|()| [(); 2].map(|()| random.whole(-UNITS / 2, UNITS * PIXELS as i64 + UNITS / 2)))
}

/// The triangle as a facet for the unit camera, its corners at these depths.
fn facet(triangle: &Triangle, depth: [f64; 3]) -> Mesh {
    let at = |k: usize| {
        let [x, y] = triangle[k].map(|x| x as f64 / UNITS as f64 - 0.5 * PIXELS as f64);
        [x * depth[k], y * depth[k], depth[k]]
    };
    mesh(&[at(0), at(1), at(2)], &[[0, 1, 2]])
}

fn pixels() -> impl Iterator<Item = (usize, usize)> {
    (0..PIXELS).flat_map(|row| (0..PIXELS).map(move |column| (column, row)))
}

#[test]
fn a_triangle_with_known_fractions_comes_out() {
    // Half of pixel (1, 1) and an eighth of (2, 1): (1, 1) (2.5, 1) (1, 2.5) cut at x, y = 2: 1 - 1/8, 1/8, 1/8.
    let triangle = [[60, 60], [150, 60], [60, 150]];
    for (pixel, expected) in [((1, 1), 0.875), ((2, 1), 0.125), ((1, 2), 0.125), ((2, 2), 0.0), ((0, 1), 0.0)] {
        assert_eq!(share(&triangle, pixel.0, pixel.1), expected);
    }
}

#[test]
fn random_triangles_cover_what_exact_fractions_say() {
    let mut numbers = Random(1);
    let (mut partly, mut wholly) = (0, 0);
    for i in 0..200 {
        let triangle = random(&mut numbers);
        let seen = see(&facet(&triangle, [1.0; 3]), sun(0.0, 0.0), &unit_camera(PIXELS as u32, PIXELS as u32));
        for (column, row) in pixels() {
            let expected = share(&triangle, column, row);
            let got = seen.footprints.coverage(PIXELS * row + column);
            assert!((got - expected).abs() <= 1e-12, "{i} {triangle:?}, pixel {column} {row}: {got}, not {expected}");
            assert!(got >= 0.0);
            partly += usize::from(expected > 0.0 && expected < 1.0);
            wholly += usize::from(expected == 1.0);
        }
    }
    assert!(partly > 1000 && wholly >= 20, "{partly} {wholly}");
}

#[test]
fn in_a_pile_no_facet_shows_more_than_it_has_and_all_together_fill_the_image() {
    let mut numbers = Random(2);
    let triangles: Vec<Triangle> = (0..60).map(|_| random(&mut numbers)).collect();
    // Every corner at its own depth: most of them pierce each other.
    let facets: Vec<Mesh> = triangles.iter().map(|t| facet(t, [(); 3].map(|()| 1.0 + numbers.share()))).collect();
    let wall = quad([-9.0, -9.0, 3.0], [-9.0, 9.0, 3.0], [9.0, 9.0, 3.0], [9.0, -9.0, 3.0]);
    let pile = joined(&facets);
    let (mut shown, mut cut) = (0, 0);
    for (scene, walled) in [(pile.clone(), false), (joined(&[pile, wall]), true)] {
        let seen = see(&scene, direction([0.3, 0.2, -1.0]), &unit_camera(PIXELS as u32, PIXELS as u32));
        for (column, row) in pixels() {
            let mut sum = 0.0;
            for (f, fraction, lit) in seen.footprints.pixel(PIXELS * row + column) {
                sum += fraction;
                assert!(fraction >= 0.0 && lit >= 0.0 && lit <= fraction);
                if let Some(triangle) = triangles.get(f as usize) {
                    let own = share(triangle, column, row);
                    assert!(fraction <= own + 1e-12, "pixel {column} {row}, facet {f}: {fraction} of {own}");
                    shown += 1;
                    cut += usize::from(fraction < own - 1e-6);
                }
            }
            assert!(sum <= 1.0 + 1e-12, "pixel {column} {row}: {sum}");
            assert!(!walled || sum >= 1.0 - 1e-12, "pixel {column} {row} shows sky: {sum}");
        }
    }
    assert!(shown > 200 && cut > 150, "{shown} shown, {cut} of them in part");
}
