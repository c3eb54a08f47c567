//! How a cell of a grid of heights is cut into two facets: along the diagonal that is shorter in space, the first if both are as long.

use super::whole;

/// The cell, of `count` in a row, that a place from 0 to `count` lies in, and how far behind its beginning. The last one's end is its own.
pub fn cell_at(place: f64, count: usize) -> (usize, f64) {
    let cell = whole(place).min(count - 1);
    (cell, place - cell as f64)
}

/// Whether a cell is cut from its first corner to the third; heights, m, of its corners in order around it. On the map both diagonals are
/// as long.
pub fn is_cut_from_first([a, b, c, d]: [f64; 4]) -> bool {
    (c - a).abs() <= (d - b).abs()
}

/// The two facets of a cell with these corners, in order around it, and their heights, m. They turn as the corners do.
pub fn cut([a, b, c, d]: [u32; 4], heights_m: [f64; 4]) -> [[u32; 3]; 2] {
    match is_cut_from_first(heights_m) {
        true => [[a, b, c], [a, c, d]],
        false => [[a, b, d], [b, c, d]],
    }
}
