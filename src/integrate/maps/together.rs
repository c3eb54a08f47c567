//! What several maps know together of a facet in a pixel: each point of it by the maps that know that very point.

use super::choice::{ViewChoice, views_shares};
use super::lookup::Lookup;
use crate::geometry::polygon::{Point, area};
use crate::integrate::parts::Window;
use crate::integrate::pixel::Pixel;
use crate::visibility::Shown;

/// Of a facet that a map knows all over, rounding leaves less than this share unknown; one that it does not know at all it knows
/// to less than this share.
const ROUNDING: f64 = 1e-9;

/// Whether maps know different parts of a facet, so that those have to be told apart.
pub(super) fn differ(views: &[Lookup], angles: &[f64], choice: ViewChoice, facet_area: f64) -> bool {
    let knows = |i: &usize| views[*i].seen.area > ROUNDING * facet_area;
    let all = |i: usize| views[i].seen.area >= (1.0 - ROUNDING) * facet_area;
    let mut knowing = (0..views.len()).filter(knows);
    let Some(first) = knowing.next() else { return false };
    if knowing.clone().next().is_none() {
        return false;
    }
    let nearest = knowing.clone().fold(first, |n, i| if angles[i].total_cmp(&angles[n]).is_lt() { i } else { n });
    let is_alone = choice == ViewChoice::Nearest || angles[nearest].is_nan() || angles[nearest] == 0.0;
    if is_alone { !all(nearest) } else { !(all(first) && knowing.all(all)) }
}

/// What is known of a facet in a pixel, and by which texels.
#[derive(Debug, Default)]
pub(super) struct Together {
    /// Map, texel and area, pixels.
    pub(super) texels: Vec<(usize, u32, f64)>,
    /// For each map the area that it serves, pixels.
    pub(super) area: Vec<f64>,
    /// For each source known by parts the lit area that no map knows, pixels.
    pub(super) lit_rest: Vec<f64>,
    cells: Vec<Cell>,
    next: Vec<Cell>,
}

/// A convex part of a facet's image and the maps that know it, by their angle.
#[derive(Debug)]
struct Cell {
    outline: Vec<Point>,
    knowing: Vec<usize>,
}

impl Together {
    /// Divides what a pixel sees of a facet, its entry `index`, among maps; pieces have been sorted.
    pub(super) fn look(
        &mut self,
        pixel: &mut Pixel,
        index: usize,
        views: &mut [Lookup],
        angles: &[f64],
        choice: ViewChoice,
        wants_lit: bool,
    ) {
        self.texels.clear();
        self.area.clear();
        self.area.resize(views.len(), 0.0);
        self.lit_rest.clear();
        self.lit_rest.resize(if wants_lit { pixel.lights() } else { 0 }, 0.0);
        let facet = pixel.entries[index].facet;
        let mut order: Vec<usize> = (0..views.len()).filter(|i| views[*i].seen.area > 0.0).collect();
        order.sort_by(|a, b| angles[*a].total_cmp(&angles[*b]));
        for k in pixel.pieces.of(index) {
            let (of, sign, outline) = pixel.pieces.get(k);
            if of != facet {
                continue;
            }
            self.cells.clear();
            self.cells.push(Cell { outline: outline.to_vec(), knowing: vec![] });
            for &view in &order {
                self.next.clear();
                for cell in self.cells.drain(..) {
                    let is_served = match choice {
                        ViewChoice::Nearest => !cell.knowing.is_empty(),
                        // One without a direction serves what no other knows.
                        ViewChoice::Interpolated => angles[view].is_nan() && !cell.knowing.is_empty(),
                    };
                    if is_served {
                        self.next.push(cell);
                        continue;
                    }
                    let next = &mut self.next;
                    views[view].divide(facet, &cell.outline, |is_known, outline| {
                        let mut knowing = cell.knowing.clone();
                        knowing.extend(is_known.then_some(view));
                        next.push(Cell { outline, knowing });
                    });
                }
                std::mem::swap(&mut self.cells, &mut self.next);
            }
            for cell in &self.cells {
                if cell.knowing.is_empty() {
                    for (light, rest) in self.lit_rest.iter_mut().enumerate() {
                        *rest += sign * pixel.site.per_cell * lit_area(pixel, light, facet, &cell.outline);
                    }
                    continue;
                }
                let shares = views_shares(&cell.knowing, angles, choice);
                let all: f64 = shares.iter().sum();
                for (&view, share) in cell.knowing.iter().zip(shares).filter(|(_, share)| *share > 0.0) {
                    let share = share / all;
                    let lookup = &mut views[view];
                    lookup.seen.clear();
                    lookup.lay(facet, &cell.outline, sign, None);
                    self.area[view] += share * lookup.seen.area;
                    self.texels.extend(lookup.seen.texels.iter().map(|(texel, weight)| (view, *texel, share * weight)));
                }
            }
        }
    }
}

/// Area of a part of a facet that a source lights.
fn lit_area(pixel: &mut Pixel, light: usize, facet: u32, part: &[Point]) -> f64 {
    match pixel.lit_of(light, facet) {
        Shown::Nothing => 0.0,
        Shown::Whole => area(part),
        Shown::Part => {
            let mut lit = 0.0;
            pixel.lit_parts(light, facet, &Window::Piece(part), |share, part| lit += share * area(part));
            lit
        }
    }
}
