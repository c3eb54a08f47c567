//! Maps of longitudes and latitudes: an image whose columns go once around a body, and whose rows go from pole to pole.
//!
//! Over a facet longitude and latitude are no affine functions of the place. A part of it is divided until they are, as good as exact; at a pole,
//! where no longitude is, until next to nothing is left. Nothing depends on how large a facet is, or on whether a pole is in it.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::polygon::{Point, Rect, area, clip_to_rect, split};
use super::{Chart, latitude_longitude_deg};

/// What an affine map may be off by, texels: as much of a texel's border at most goes to its neighbour.
const FLAT: f64 = 2e-3;
/// And rad: of a coarse map that is less.
const FLAT_RAD: f64 = 1e-4;
/// A part that is not flat, and a smaller share of all than this, is taken for its middle.
const LEAST: f64 = 1e-6;
/// Parts are quartered no more often.
const DEEPEST: u32 = 30;

/// Where the texels of such a map lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LonLat {
    /// The body's centre, in the axes of the body and the coordinates of its mesh, m.
    pub centre_m: DVec3,
    /// East longitude of the outer border of the first column, deg.
    pub west_deg: f64,
    /// Columns once around. The image that is held has one more on each side, that of the other end.
    pub columns: usize,
    /// Rows from the North pole to the South pole, equal steps of planetocentric latitude.
    pub rows: usize,
}

/// From coordinates (x, y, 1) of a plane to places in space: place = (linear forms) / w.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceChart {
    /// Coordinates times w, m.
    pub place_m: [[f64; 3]; 3],
    /// Positive where the facet is.
    pub w: [f64; 3],
}

impl SpaceChart {
    /// From (u, v) of a facet with these corners.
    pub fn of_facet([a, b, c]: [DVec3; 3]) -> Self {
        SpaceChart { place_m: [0, 1, 2].map(|k| [b[k] - a[k], c[k] - a[k], a[k]]), w: [0.0, 0.0, 1.0] }
    }

    fn at(&self, p: Point) -> DVec3 {
        let form = |f: &[f64; 3]| f[0] * p[0] + f[1] * p[1] + f[2];
        DVec3::from_array(self.place_m.each_ref().map(form)) / form(&self.w)
    }
}

impl LonLat {
    /// Columns and rows of the image that is held.
    pub fn size(&self) -> [usize; 2] {
        [self.columns + 2, self.rows]
    }

    /// Texel coordinates of a place, m from the body's centre: columns from 1 to `columns` + 1.
    pub fn texel(&self, place_m: DVec3) -> Point {
        let [latitude_deg, longitude_deg] = latitude_longitude_deg(place_m);
        let around = ((longitude_deg - self.west_deg) / 360.0).rem_euclid(1.0);
        [1.0 + around * self.columns as f64, (0.5 - latitude_deg / 180.0) * self.rows as f64]
    }

    /// Divides a convex part of a plane, counter-clockwise, into convex parts, each with a chart to texels. `space` leads to places from the
    /// body's centre.
    pub fn flat_parts(&self, space: &SpaceChart, part: &[Point]) -> Vec<(Chart, Vec<Point>)> {
        let mut parts = Vec::new();
        self.divide(space, part, LEAST * area(part), 0, &mut parts);
        parts
    }

    fn divide(&self, space: &SpaceChart, part: &[Point], least: f64, depth: u32, parts: &mut Vec<(Chart, Vec<Point>)>) {
        if part.len() < 3 {
            return;
        }
        if let Some(chart) = self.flattened(space, part) {
            return self.at_the_seam(chart, part, parts);
        }
        // No area, or one that is no number, ends here too.
        let is_worth_dividing = area(part) > least;
        if depth == DEEPEST || !is_worth_dividing {
            let [column, row] = self.texel(space.at(middle(part)));
            let times = |texel: f64| space.w.map(|w| texel * w);
            return parts.push((Chart { s: times(column), t: times(row), w: space.w }, part.to_vec()));
        }
        // Nor is there more to find where all is one place.
        let first = space.at(part[0]);
        if part.iter().map(|p| space.at(*p)).all(|place| place == first || place.is_nan()) {
            return parts.push((Chart { s: [0.0; 3], t: [0.0; 3], w: [0.0, 0.0, 1.0] }, part.to_vec()));
        }
        let mut spare = Vec::new();
        for quarter in Rect::of(part).quarters() {
            let mut clipped = Vec::new();
            clip_to_rect(part, &quarter, &mut clipped, &mut spare);
            self.divide(space, &clipped, least, depth + 1, parts);
        }
    }

    /// The chart that is right in the middle of a part, and to its first derivatives; `None` where it is not flat at the corners.
    fn flattened(&self, space: &SpaceChart, part: &[Point]) -> Option<Chart> {
        let place = space.at(middle(part));
        let (from_axis, from_centre) = (place.x.hypot(place.y), place.length());
        let texel = self.texel(place);
        // Of longitude and latitude, rad, by the place.
        let east = DVec3::new(-place.y, place.x, 0.0) / (from_axis * from_axis);
        let north = DVec3::new(-place.x * place.z, -place.y * place.z, from_axis * from_axis)
            / (from_axis * from_centre * from_centre);
        let columns = self.columns as f64 / TAU * east;
        let rows = -(self.rows as f64) / PI * north;
        // texel + slope . (p - place), times w.
        let affine = |at: f64, slope: DVec3| {
            let constant = at - slope.dot(place);
            [0, 1, 2].map(|i| (0..3).map(|k| slope[k] * space.place_m[k][i]).sum::<f64>() + constant * space.w[i])
        };
        let chart = Chart { s: affine(texel[0], columns), t: affine(texel[1], rows), w: space.w };
        let most = [self.columns as f64 / TAU, self.rows as f64 / PI].map(|per_rad| FLAT.min(FLAT_RAD * per_rad));
        let is_near = |p: &Point| {
            let ([column, row], Some(near)) = (self.texel(space.at(*p)), chart.at(*p)) else { return false };
            // Once around more or less is the same longitude.
            let off = column - near[0];
            let off = off - self.columns as f64 * (off / self.columns as f64).round();
            off.abs() <= most[0] && (row - near[1]).abs() <= most[1]
        };
        // Not so far that it could be around the axis.
        let is_narrow =
            |p: &Point| chart.at(*p).is_some_and(|at| (at[0] - texel[0]).abs() < 0.25 * self.columns as f64);
        part.iter().all(|p| is_narrow(p) && is_near(p)).then_some(chart)
    }

    /// What reaches beyond the first or the last column begins again at the other end.
    fn at_the_seam(&self, chart: Chart, part: &[Point], parts: &mut Vec<(Chart, Vec<Point>)>) {
        let columns = self.columns as f64;
        let shifted = |chart: &Chart, by: f64| Chart { s: [0, 1, 2].map(|i| chart.s[i] + by * chart.w[i]), ..*chart };
        let mut rest = part.to_vec();
        for (seam, sign, by) in [(1.0, 1.0, columns), (1.0 + columns, -1.0, -columns)] {
            let value = |p: &Point| {
                let form = |f: &[f64; 3]| f[0] * p[0] + f[1] * p[1] + f[2];
                sign * (form(&chart.s) - seam * form(&chart.w))
            };
            let values: Vec<f64> = rest.iter().map(value).collect();
            if values.iter().all(|v| *v >= 0.0) {
                continue;
            }
            let (mut within, mut beyond) = (vec![], vec![]);
            split(&rest, &values, &mut within, &mut beyond);
            if beyond.len() > 2 {
                parts.push((shifted(&chart, by), beyond));
            }
            rest = within;
        }
        if rest.len() > 2 {
            parts.push((chart, rest));
        }
    }
}

fn middle(part: &[Point]) -> Point {
    let share = 1.0 / part.len() as f64;
    [0, 1].map(|k| share * part.iter().map(|p| p[k]).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Overlay;

    const TRIANGLE: [Point; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

    /// The area of each texel in a facet, in shares of the facet: [row, column], the ends of columns put together.
    fn shares(map: &LonLat, corners: [DVec3; 3]) -> Vec<f64> {
        let mut all = vec![0.0; map.rows * map.columns];
        let space = SpaceChart::of_facet(corners);
        for (chart, part) in map.flat_parts(&space, &TRIANGLE) {
            Overlay::default().texels(&chart, &part, map.size(), |column, row, area| {
                all[row * map.columns + (column + map.columns - 1) % map.columns] += 2.0 * area;
            });
        }
        all
    }

    fn map(west_deg: f64, columns: usize, rows: usize) -> LonLat {
        LonLat { centre_m: DVec3::ZERO, west_deg, columns, rows }
    }

    /// An equilateral triangle in z = 1 about the pole, its first corner at longitude 0: by symmetry each sextant has a sixth, and by the
    /// law of the triangle, whose inner radius is 1/2 of its outer, the part within latitude atan(1 / r) is pi r^2.
    #[test]
    fn a_pole_within_a_facet() {
        let corner = |deg: f64| DVec3::new(deg.to_radians().cos(), deg.to_radians().sin(), 1.0);
        let corners = [corner(0.0), corner(120.0), corner(240.0)];
        let whole = 0.75 * 3.0_f64.sqrt();
        for (west_deg, columns) in [(0.0, 6), (-180.0, 12), (-180.0, 360)] {
            // A row of 22.5 deg: r = tan(22.5 deg) is below 1/2, and the second row ends at 45 deg, r = 1: all.
            let found = shares(&map(west_deg, columns, 8), corners);
            let row = |row: usize| found[row * columns..][..columns].iter().sum::<f64>();
            let r = (std::f64::consts::FRAC_PI_8).tan();
            assert!((row(0) - std::f64::consts::PI * r * r / whole).abs() < 3e-4, "{} {columns}", row(0));
            // The corners are at 45 deg: what is off by FLAT_RAD there is next to nothing.
            assert!((row(0) + row(1) - 1.0).abs() < 1e-6 && (found.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let per_sextant = columns / 6;
            for sextant in 0..6 {
                let columns_of = sextant * per_sextant..(sextant + 1) * per_sextant;
                let sum: f64 =
                    (0..8).flat_map(|row| columns_of.clone().map(move |c| row * columns + c)).map(|i| found[i]).sum();
                assert!((sum - 1.0 / 6.0).abs() < 2e-4, "{sextant} of {columns}: {sum}");
            }
        }
    }

    /// Meridians that are borders of facets are borders of texels, wherever the seam is; and half of what lies across a meridian is on each side.
    #[test]
    fn the_seam_is_like_any_meridian() {
        // A rectangle in x = -1 from 10 deg to the West to 10 deg to the East of the date line, about the equator.
        let half = 10.0_f64.to_radians().tan();
        let at = |y: f64, z: f64| DVec3::new(-1.0, -y * half, z * half);
        let facets = [[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0)], [at(-1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]];
        for west_deg in [-180.0, 0.0, 180.0, -170.0, 33.0] {
            let map = map(west_deg, 36, 2);
            let mut sums = [0.0; 36];
            for corners in facets {
                let found = shares(&map, corners);
                assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-9);
                (0..72).for_each(|i| sums[i % 36] += 0.5 * found[i]);
            }
            let column = |deg: f64| (((deg - west_deg) / 10.0).rem_euclid(36.0)).floor() as usize;
            if west_deg != 33.0 {
                let [west, east] = [sums[column(175.0)], sums[column(-175.0)]];
                assert!((west - 0.5).abs() < 1e-4 && (east - 0.5).abs() < 1e-4, "{west_deg}: {west} {east}");
            } else {
                // Borders at 173, 183: tan(7 deg) and tan(3 deg) of the half.
                let [left, middle, right] = [sums[column(172.0)], sums[column(178.0)], sums[column(184.0)]];
                let of = |deg: f64| deg.to_radians().tan() / half;
                let expected = [0.5 - 0.5 * of(7.0), 0.5 * of(7.0) + 0.5 * of(3.0), 0.5 - 0.5 * of(3.0)];
                assert!((left - expected[0]).abs() < 1e-4, "{left} {expected:?}");
                assert!((middle - expected[1]).abs() < 1e-4 && (right - expected[2]).abs() < 1e-4, "{middle} {right}");
            }
        }
    }

    #[test]
    fn what_has_no_place_in_a_map_ends_all_the_same() {
        let map = map(0.0, 360, 180);
        for corners in
            [[DVec3::ZERO; 3], [DVec3::ZERO, DVec3::X, DVec3::Y], [DVec3::NAN; 3], [DVec3::Z, DVec3::NEG_Z, DVec3::X]]
        {
            let parts = map.flat_parts(&SpaceChart::of_facet(corners), &TRIANGLE);
            let all: f64 = parts.iter().map(|(_, part)| area(part)).sum();
            assert!((all - 0.5).abs() < 1e-9, "{corners:?}: {all}");
        }
    }
}
