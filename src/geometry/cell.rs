//! A cell of a grid of heights as two facets: cut along the diagonal that is shorter in space, the first if both are equally long.

use super::whole;

/// The cell, of `count` in a row, that a coordinate from 0 to `count` lies in, and how far beyond its beginning. The last cell includes its end.
pub fn cell_at(place: f64, count: usize) -> (usize, f64) {
    let cell = whole(place).min(count - 1);
    (cell, place - cell as f64)
}

/// Whether a cell is cut from its first corner to the third; heights, m, of its corners in order around it. On the map both diagonals are
/// equally long.
fn is_cut_from_first([a, b, c, d]: [f64; 4]) -> bool {
    (c - a).abs() <= (d - b).abs()
}

/// Height of a cell's two facets, m, at (u, v) of it: u from 0 to 1 from its first corner to the second, v from the first to the fourth.
pub fn height_m(corners_m: [f64; 4], u: f64, v: f64) -> f64 {
    let [a, b, c, d] = corners_m;
    match is_cut_from_first(corners_m) {
        true if u >= v => a + u * (b - a) + v * (c - b),
        true => a + v * (d - a) + u * (c - d),
        false if u + v <= 1.0 => a + u * (b - a) + v * (d - a),
        false => c + (1.0 - u) * (d - c) + (1.0 - v) * (b - c),
    }
}

/// The two facets of a cell with these corners, in order around it, and their heights, m. They turn as the corners do.
pub fn cut([a, b, c, d]: [u32; 4], heights_m: [f64; 4]) -> [[u32; 3]; 2] {
    match is_cut_from_first(heights_m) {
        true => [[a, b, c], [a, c, d]],
        false => [[a, b, d], [b, c, d]],
    }
}
