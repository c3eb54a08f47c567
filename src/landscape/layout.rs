//! Where the vertices of the ground lie on the map, and how facets join them: a fine grid, and around it rings of facets that grow outward.
//!
//! Each ring is a square of points, evenly spaced along its sides; between two of them a strip of facets, whatever their numbers of points are, so that
//! the mesh has no open edge but its border.

use super::recipe::{Detail, Recipe};
use crate::geometry::{index_u32, whole};

/// How facets grow from the fine grid outward.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grading {
    /// Middle of the grid, m; rings move from it to the site's middle.
    pub(super) centre_m: [f64; 2],
    /// Half of the grid's side, of the site's, and of the whole mesh's, m.
    pub(super) core_m: f64,
    pub(super) site_m: f64,
    pub(super) end_m: f64,
    /// By how much a row of facets is wider than the one within it, on the site and around it.
    growth: [f64; 2],
    /// Width of the grid's cells, m.
    pub(super) step_m: f64,
}

impl Grading {
    /// That of a recipe, with cells so wide.
    pub(super) fn new(recipe: &Recipe, step_m: f64) -> Self {
        let site_m = 0.5 * recipe.size_m;
        let (reach_m, outer) = recipe.surroundings.as_ref().map_or((0.0, 0.0), |s| (s.reach_m, s.growth));
        let (centre_m, core_m, inner) = match &recipe.detail {
            Some(Detail { x_m, y_m, size_m, growth }) => ([*x_m, *y_m], 0.5 * size_m, *growth),
            None => ([0.0; 2], site_m, 0.0),
        };
        Grading { centre_m, core_m, site_m, end_m: site_m + reach_m, growth: [inner, outer], step_m }
    }

    /// The same with cells so wide.
    pub(super) fn with_step_m(&self, step_m: f64) -> Self {
        Grading { step_m, ..*self }
    }

    /// Width of facets on the ring with this half side, m.
    fn step_of_m(&self, half_m: f64) -> f64 {
        let inner_m = (half_m.min(self.site_m) - self.core_m).max(0.0);
        let outer_m = (half_m - self.site_m).max(0.0);
        self.step_m + self.growth[0] * inner_m + self.growth[1] * outer_m
    }

    /// Middle of the ring with this half side, m.
    fn middle_m(&self, half_m: f64) -> [f64; 2] {
        let out = if self.end_m > self.core_m { (half_m - self.core_m) / (self.end_m - self.core_m) } else { 0.0 };
        self.centre_m.map(|c| c * (1.0 - out))
    }

    /// Half sides, m, of the rings whose south, east, north and west sides go through a place; the largest is that of the ring there.
    fn halves_m(&self, x_m: f64, y_m: f64) -> [f64; 4] {
        let reach_m = self.end_m - self.core_m;
        // On its east side x = c (1 - (L - core) / reach) + L.
        let half = |x_m: f64, c_m: f64| match reach_m > 0.0 {
            true => (x_m - c_m - c_m * self.core_m / reach_m) / (1.0 - c_m / reach_m),
            false => x_m - c_m,
        };
        let [cx_m, cy_m] = self.centre_m;
        [half(-y_m, -cy_m), half(x_m, cx_m), half(y_m, cy_m), half(-x_m, -cx_m)]
    }

    /// Half side, m, of the ring through a place.
    pub(super) fn half_m(&self, x_m: f64, y_m: f64) -> f64 {
        self.halves_m(x_m, y_m).into_iter().fold(0.0, f64::max)
    }

    /// The side of that ring: 0 south, 1 east, 2 north, 3 west.
    pub(super) fn side(&self, x_m: f64, y_m: f64) -> usize {
        let halves_m = self.halves_m(x_m, y_m);
        (0..4).max_by(|&a, &b| halves_m[a].total_cmp(&halves_m[b])).unwrap_or(0)
    }

    /// Width of facets at a place, m.
    pub(super) fn step_at_m(&self, x_m: f64, y_m: f64) -> f64 {
        self.step_of_m(self.half_m(x_m, y_m).max(self.core_m))
    }

    /// Half sides of the rings around the grid, m, the last at the end.
    fn rings_m(&self) -> Vec<f64> {
        let mut rings_m = Vec::new();
        let mut half_m = self.core_m;
        while half_m < self.end_m {
            half_m += self.step_of_m(half_m);
            rings_m.push(half_m);
        }
        // What the last is too far out is shared by all.
        let stretch = (self.end_m - self.core_m) / (half_m - self.core_m);
        for ring_m in &mut rings_m {
            *ring_m = self.core_m + (*ring_m - self.core_m) * stretch;
        }
        if let Some(last_m) = rings_m.last_mut() {
            *last_m = self.end_m;
        }
        rings_m
    }

    /// The layout with so many cells in the grid.
    pub(super) fn layout(&self, columns: usize, rows: usize) -> Layout {
        let rings = self.rings_m().into_iter().map(|half_m| {
            let cells = whole((2.0 * half_m / self.step_of_m(half_m)).round().max(4.0));
            Ring { middle_m: self.middle_m(half_m), half_m, cells: [cells, cells] }
        });
        let core = Ring { middle_m: self.centre_m, half_m: self.core_m, cells: [columns, rows] };
        Layout { rings: std::iter::once(core).chain(rings).collect() }
    }
}

/// A square of points: those of a side are evenly spaced.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ring {
    pub(super) middle_m: [f64; 2],
    pub(super) half_m: f64,
    /// Intervals between points along the sides to the east, and along those to the north.
    pub(super) cells: [usize; 2],
}

impl Ring {
    fn points(&self) -> usize {
        2 * (self.cells[0] + self.cells[1])
    }

    /// Coordinate number `i` along an axis, m.
    fn coordinate_m(&self, axis: usize, i: usize) -> f64 {
        let cells = self.cells[axis];
        // The last is exactly opposite to the first.
        self.middle_m[axis] + self.half_m * ((2 * i) as f64 - cells as f64) / cells as f64
    }

    /// Point number `i`, m, counter-clockwise from the south-west.
    fn point_m(&self, i: usize) -> [f64; 2] {
        let [columns, rows] = self.cells;
        let (column, row) = match i {
            i if i < columns => (i, 0),
            i if i < columns + rows => (columns, i - columns),
            i if i < 2 * columns + rows => (2 * columns + rows - i, rows),
            i => (0, 2 * (columns + rows) - i),
        };
        [self.coordinate_m(0, column), self.coordinate_m(1, row)]
    }
}

/// The grid and the rings around it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// The first is the border of the grid.
    pub(super) rings: Vec<Ring>,
}

/// A facet of a strip and the place of its last edge: the point that the inner ring's and the outer ring's have in common with the next facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StripFacet {
    pub(super) facet: [u32; 3],
    pub(super) inner: u32,
    pub(super) outer: u32,
}

impl Layout {
    /// Cells of the grid.
    pub(super) fn grid(&self) -> [usize; 2] {
        self.rings[0].cells
    }

    /// Vertices.
    pub(super) fn vertices(&self) -> usize {
        let [columns, rows] = self.grid();
        (columns + 1) * (rows + 1) + self.rings[1..].iter().map(Ring::points).sum::<usize>()
    }

    /// Facets.
    pub(super) fn facets(&self) -> usize {
        let [columns, rows] = self.grid();
        2 * columns * rows + self.strip_facets()
    }

    /// Facets between rings: each interval of a ring is the side of one in the strip within it, and of one in the strip around it.
    pub(super) fn strip_facets(&self) -> usize {
        self.rings.windows(2).map(|pair| pair[0].points() + pair[1].points()).sum()
    }

    /// Where the vertices lie, m: the grid's row by row from the south-west, then ring by ring.
    pub(super) fn places_m(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let core = &self.rings[0];
        let [columns, rows] = self.grid();
        let grid = (0..=rows)
            .flat_map(move |j| (0..=columns).map(move |i| [core.coordinate_m(0, i), core.coordinate_m(1, j)]));
        grid.chain(self.rings[1..].iter().flat_map(|ring| (0..ring.points()).map(|i| ring.point_m(i))))
    }

    /// Index of a ring's first vertex; of the grid it is the south-west corner.
    fn first(&self, ring: usize) -> usize {
        match ring {
            0 => 0,
            _ => {
                let [columns, rows] = self.grid();
                (columns + 1) * (rows + 1) + self.rings[1..ring].iter().map(Ring::points).sum::<usize>()
            }
        }
    }

    /// Index of the vertex that is point `i` of a ring, counter-clockwise from the south-west.
    fn vertex(&self, ring: usize, first: usize, i: usize) -> u32 {
        let i = i % self.rings[ring].points();
        if ring > 0 {
            return index_u32(first + i);
        }
        let [columns, rows] = self.grid();
        let (column, row) = match i {
            i if i < columns => (i, 0),
            i if i < columns + rows => (columns, i - columns),
            i if i < 2 * columns + rows => (2 * columns + rows - i, rows),
            i => (0, 2 * (columns + rows) - i),
        };
        index_u32(row * (columns + 1) + column)
    }

    /// Vertices of the mesh's border, counter-clockwise from the south-west.
    pub(super) fn end(&self) -> Vec<u32> {
        let last = self.rings.len() - 1;
        let first = self.first(last);
        (0..self.rings[last].points()).map(|i| self.vertex(last, first, i)).collect()
    }

    /// Facets of one side (0 south, 1 east, 2 north, 3 west) between ring `inner` and the next, counter-clockwise seen from above, one after the other.
    pub(super) fn strip(&self, inner: usize, side: usize) -> Vec<StripFacet> {
        let outer = inner + 1;
        let firsts = [self.first(inner), self.first(outer)];
        let counts = [inner, outer].map(|ring| self.rings[ring].cells[side % 2]);
        let begins = [inner, outer].map(|ring| {
            let [columns, rows] = self.rings[ring].cells;
            [0, columns, columns + rows, 2 * columns + rows][side]
        });
        let point = |which: usize, i: usize| self.vertex(inner + which, firsts[which], begins[which] + i);
        let (mut i, mut j) = (0, 0);
        let mut facets = Vec::with_capacity(counts[0] + counts[1]);
        while i < counts[0] || j < counts[1] {
            // Whichever interval's middle comes first along the side.
            let inner_next = i < counts[0] && (j == counts[1] || (2 * i + 1) * counts[1] <= (2 * j + 1) * counts[0]);
            let facet = match inner_next {
                true => [point(1, j), point(0, i + 1), point(0, i)],
                false => [point(1, j), point(1, j + 1), point(0, i)],
            };
            if inner_next {
                i += 1
            } else {
                j += 1
            }
            facets.push(StripFacet { facet, inner: point(0, i), outer: point(1, j) });
        }
        facets
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::landscape::recipe::Surroundings;

    fn recipe(detail: Option<[f64; 3]>, reach_m: f64) -> Recipe {
        Recipe {
            size_m: 1000.0,
            detail: detail.map(|[x_m, y_m, size_m]| Detail { x_m, y_m, size_m, growth: 0.1 }),
            surroundings: (reach_m > 0.0).then_some(Surroundings { reach_m, growth: 0.2 }),
            ..Recipe::plane(1)
        }
    }

    /// All facets, and the directed edges that no facet turns the other way.
    fn facets_and_border(layout: &Layout) -> (Vec<[u32; 3]>, Vec<[u32; 2]>) {
        let [columns, rows] = layout.grid();
        let width = index_u32(columns + 1);
        let mut facets = Vec::new();
        for j in 0..index_u32(rows) {
            for i in 0..index_u32(columns) {
                let sw = j * width + i;
                facets.extend([[sw, sw + 1, sw + width + 1], [sw, sw + width + 1, sw + width]]);
            }
        }
        for ring in 0..layout.rings.len() - 1 {
            for side in 0..4 {
                facets.extend(layout.strip(ring, side).iter().map(|f| f.facet));
            }
        }
        let mut edges = BTreeMap::new();
        for &[a, b, c] in &facets {
            for edge in [[a, b], [b, c], [c, a]] {
                assert!(edges.insert(edge, ()).is_none(), "edge {edge:?} twice in one direction");
            }
        }
        let border = edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a])).copied().collect();
        (facets, border)
    }

    #[test]
    fn the_mesh_is_whole_fills_its_square_and_has_the_facets_it_says() {
        let mut seen = 0;
        for (detail, reach_m, half_m) in [
            (None, 0.0, 500.0),
            (None, 3000.0, 3500.0),
            (Some([0.0, 0.0, 300.0]), 0.0, 500.0),
            (Some([120.0, -200.0, 200.0]), 0.0, 500.0),
            (Some([-390.0, 10.0, 200.0]), 1700.0, 2200.0),
        ] {
            for (columns, rows) in [(40, 40), (37, 42), (4, 5), (1, 1)] {
                let grading = Grading::new(&recipe(detail, reach_m), 1000.0 / 40.0);
                let layout = grading.layout(columns, rows);
                let places_m: Vec<[f64; 2]> = layout.places_m().collect();
                let (facets, border) = facets_and_border(&layout);
                assert_eq!((layout.vertices(), layout.facets()), (places_m.len(), facets.len()));
                // No facet is turned over or has no area, and they fill the square: none lies over another.
                let area_m2 = |&[a, b, c]: &[u32; 3]| {
                    let [a, b, c] = [a, b, c].map(|v| places_m[v as usize]);
                    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
                };
                assert!(facets.iter().all(|f| area_m2(f) > 1e-3), "{detail:?} {reach_m} {columns}");
                let sum_m2: f64 = facets.iter().map(area_m2).sum();
                assert!((sum_m2 / (4.0 * half_m * half_m) - 1.0).abs() < 1e-12, "{sum_m2}");
                // Open edges are on the border, and nowhere else.
                let on_border = |v: u32| places_m[v as usize].iter().any(|x| x.abs() == half_m);
                assert!(!border.is_empty() && border.iter().flatten().all(|&v| on_border(v)));
                assert_eq!(border.len(), layout.rings.last().unwrap().points());
                seen += 1;
            }
        }
        assert_eq!(seen, 20);
    }

    #[test]
    fn facets_grow_as_asked() {
        let grading = Grading::new(&recipe(Some([100.0, 0.0, 200.0]), 1000.0), 2.0);
        assert_eq!((grading.step_at_m(100.0, 50.0), grading.step_at_m(0.0, 0.0)), (2.0, 2.0));
        // At the end, 400 m of growth by 0.1 and 1000 m by 0.2.
        assert!((grading.step_at_m(1500.0, 0.0) - 242.0).abs() < 1e-9);
        let layout = grading.layout(100, 100);
        for pair in layout.rings[1..].windows(2) {
            let between_m = pair[1].half_m - pair[0].half_m;
            let along_m = 2.0 * pair[1].half_m / pair[1].cells[0] as f64;
            assert!((0.5..2.0).contains(&(along_m / between_m)), "{pair:?}");
        }
        // The ring through a point of a ring is that ring.
        for ring in &layout.rings {
            for i in [0, 7, ring.points() / 3, ring.points() - 1] {
                let [x_m, y_m] = ring.point_m(i);
                assert!((grading.half_m(x_m, y_m) / ring.half_m - 1.0).abs() < 1e-9, "{ring:?} {i}");
            }
        }
    }
}
