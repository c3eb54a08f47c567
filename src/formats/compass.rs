//! Two small arrows in the corner of a picture: north, with an N, and the way to the Sun, with its sign, a circle around a dot.

use std::f64::consts::TAU;

use crate::study::Orientation;

/// Smaller pictures have no room for arrows, pixels.
const LEAST: usize = 128;
/// Half the width of a stroke, and of the dark one behind it, pixels.
const HALF: f64 = 0.8;
const BEHIND: f64 = 2.2;
/// Corners of a circle.
const CORNERS: u32 = 16;

/// Lines from point to point, pixels.
type Strokes = Vec<Vec<[f64; 2]>>;

/// Draws them into pixels of one byte or three, where the picture is large enough.
pub(super) fn draw(pixels: &mut [u8], [columns, rows]: [usize; 2], channels: usize, orientation: &Orientation) {
    if columns.min(rows) < LEAST {
        return;
    }
    let radius = (columns.min(rows) as f64 / 16.0).clamp(9.0, 40.0);
    let arrows = [(1.7, orientation.north_deg, letter_n as fn(f64) -> Strokes), (5.4, orientation.sun_deg, sun)];
    for (at, azimuth_deg, sign) in arrows {
        let Some(azimuth_deg) = azimuth_deg else { continue };
        let middle = [at * radius, rows as f64 - 1.7 * radius];
        let strokes = arrow(middle, radius, azimuth_deg, sign);
        // All of the dark behind all of the bright.
        for (half, grey) in [(BEHIND, 0), (HALF, 255)] {
            stroke(pixels, [columns, rows], channels, &strokes, (half, grey));
        }
    }
}

/// An arrow around a middle, with a sign beyond its tip that stands upright.
fn arrow(middle: [f64; 2], radius: f64, azimuth_deg: f64, sign: fn(f64) -> Strokes) -> Strokes {
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    // Along the arrow, and to the right of it.
    let at = |along: f64, right: f64| {
        [middle[0] + radius * (along * sin + right * cos), middle[1] - radius * (along * cos - right * sin)]
    };
    let tip = at(0.8, 0.0);
    let mut strokes = vec![vec![at(-0.8, 0.0), tip], vec![at(0.4, -0.25), tip, at(0.4, 0.25)]];
    let beyond = at(1.4, 0.0);
    let placed = |stroke: Vec<[f64; 2]>| stroke.into_iter().map(|[x, y]| [beyond[0] + x, beyond[1] + y]).collect();
    strokes.extend(sign(0.28 * radius).into_iter().map(placed));
    strokes
}

fn letter_n(size: f64) -> Strokes {
    let (x, y) = (0.7 * size, size);
    vec![vec![[-x, y], [-x, -y], [x, y], [x, -y]]]
}

fn sun(size: f64) -> Strokes {
    let corner = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(CORNERS)).sin_cos();
        [size * cos, size * sin]
    };
    vec![(0..=CORNERS).map(corner).collect(), vec![[0.0, 0.0], [0.0, 0.0]]]
}

/// Lays strokes of a grey over pixels.
fn stroke(pixels: &mut [u8], [columns, rows]: [usize; 2], channels: usize, strokes: &Strokes, (half, grey): (f64, u8)) {
    for ends in strokes.iter().flat_map(|stroke| stroke.windows(2)) {
        let (a, b) = (ends[0], ends[1]);
        let range = |k: usize, most: usize| {
            let whole = |x: f64| crate::geometry::whole(x.max(0.0)).min(most);
            whole(a[k].min(b[k]) - half - 1.0)..whole(a[k].max(b[k]) + half + 2.0)
        };
        for row in range(1, rows) {
            for column in range(0, columns) {
                let share = (half + 0.5 - distance([column as f64 + 0.5, row as f64 + 0.5], a, b)).clamp(0.0, 1.0);
                for byte in &mut pixels[(row * columns + column) * channels..][..channels] {
                    *byte = blended(*byte, grey, share);
                }
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "between two bytes")]
fn blended(under: u8, over: u8, share: f64) -> u8 {
    (f64::from(under) + share * (f64::from(over) - f64::from(under))).round() as u8
}

/// Of a point from a line between two others.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (way, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length2 = way[0] * way[0] + way[1] * way[1];
    let share = if length2 > 0.0 { ((way[0] * to[0] + way[1] * to[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - share * way[0]).hypot(to[1] - share * way[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orientation(north_deg: Option<f64>, sun_deg: Option<f64>) -> Orientation {
        Orientation {
            plus_sample: [1.0, 0.0, 0.0],
            plus_line: [0.0, 1.0, 0.0],
            view: [0.0, 0.0, 1.0],
            north_deg,
            sun_deg,
            mars_deg: None,
        }
    }

    /// Where white is in a black picture of 160 x 160 pixels: the mean of where the tip of the arrow is.
    fn white(of: &Orientation, channels: usize) -> Vec<[usize; 2]> {
        let mut pixels = vec![0; 160 * 160 * channels];
        draw(&mut pixels, [160, 160], channels, of);
        (0..160 * 160).filter(|i| pixels[i * channels] > 250).map(|i| [i % 160, i / 160]).collect()
    }

    #[test]
    fn arrows_point_where_they_should() {
        // Radius 10, middle of the first arrow at (17, 143): its tip is 8 pixels from there, between two pixels.
        let up = white(&orientation(Some(0.0), None), 1);
        assert!(up.contains(&[16, 135]) && up.iter().all(|[x, _]| *x < 34), "{up:?}");
        let right = white(&orientation(Some(90.0), None), 3);
        assert!(right.contains(&[24, 142]));
        // Towards the Sun, to the left: around (54, 143).
        let left = white(&orientation(None, Some(270.0)), 1);
        assert!(left.contains(&[46, 142]) && left.iter().all(|[x, _]| *x > 34), "{left:?}");
        assert!(white(&orientation(None, None), 1).is_empty());
    }

    #[test]
    fn small_pictures_stay_as_they_are() {
        let mut pixels = vec![7; 127 * 500];
        draw(&mut pixels, [500, 127], 1, &orientation(Some(10.0), Some(20.0)));
        assert!(pixels.iter().all(|byte| *byte == 7));
        draw(&mut [], [0, 0], 1, &orientation(Some(10.0), None));
    }
}
