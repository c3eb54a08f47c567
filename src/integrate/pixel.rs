//! What one pixel sees: the facets, their areas in the image, and how much of that is lit.

use crate::error::Result;
use crate::geometry::polygon::{Point, Rect, area, area_and_moment, clip_to_rect, holds, intersect, may_touch};
use crate::visibility::{Drawing, Scratch, Side, Visit};

use super::detector::PixelSite;
use super::globes::Globes;
use super::lit_area::{LitArea, around};
use super::parts::Window;
use super::pieces::Pieces;
use crate::solve::ImagePart;
use crate::visibility::Shown;

/// Of a facet that is hidden all over, subtraction leaves less than this, pixels.
const REMAINDER: f64 = 1e-14;

/// A facet in a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    pub(super) facet: u32,
    /// Whether its outer side is seen; the inner one only blocks.
    pub(super) front: bool,
    /// All that is seen.
    pub(super) shown: ImagePart,
    /// What of that the Sun lights; its moment is there if it was asked for.
    pub(super) lit: ImagePart,
}

impl Entry {
    /// Image centroid of what is seen, pixels.
    pub(super) fn centroid(&self, pixel: &Rect) -> Point {
        // What little subtraction leaves has a moment of rounding.
        [0, 1].map(|k| (self.shown.moment[k] / self.shown.area).clamp(pixel.min[k], pixel.max[k]))
    }
}

/// Collects what a pixel sees.
pub(super) struct Pixel<'a> {
    drawing: &'a Drawing<'a>,
    /// For each source that is known by parts: the Sun first.
    lights: Vec<LitArea<'a>>,
    /// Whether moments of lit parts are wanted.
    pub(super) wants_moments: bool,
    /// Whether what is at the centre is wanted.
    pub(super) wants_centre: bool,
    /// What sources after the Sun light: facet, source, part; ascending, one each, once [`Pixel::look`] is done.
    further: Vec<(u32, usize, ImagePart)>,
    /// Facets, ascending, one entry each, once [`Pixel::look`] is done.
    pub(super) entries: Vec<Entry>,
    /// The facet at the pixel's centre.
    pub(super) centre: Option<u32>,
    /// Whether it is lit there.
    pub(super) centre_is_lit: bool,
    /// Whether rounding decides what is at the centre: a piece lies beside it, by no more than its corners may have moved, or holds it
    /// and is no wider than that.
    is_beside: bool,
    /// Whether some entries are the rest after a subtraction.
    subtracted: bool,
    /// What is seen of each facet, for callers who need more than areas.
    pub(super) pieces: Pieces,
    /// Bodies of the sky.
    pub(super) globes: Globes<'a>,
    /// Where it lies.
    pub(super) site: PixelSite,
    clipped: Vec<Point>,
    spare: Vec<Point>,
}

impl<'a> Pixel<'a> {
    pub(super) fn new(drawing: &'a Drawing<'a>, lights: Vec<LitArea<'a>>) -> Self {
        Pixel {
            pieces: Pieces::default(),
            globes: Globes::default(),
            drawing,
            lights,
            wants_moments: false,
            wants_centre: true,
            further: vec![],
            entries: vec![],
            centre: None,
            centre_is_lit: false,
            is_beside: false,
            subtracted: false,
            site: PixelSite::cell(0, 0, drawing.grid.cell(0, 0)),
            clipped: vec![],
            spare: vec![],
        }
    }

    /// Looks through a pixel.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if the watch of `scratch` asks to stop.
    pub(super) fn look(
        &mut self,
        coverage: &crate::visibility::Coverage,
        site: PixelSite,
        scratch: &mut Scratch,
    ) -> Result<()> {
        self.entries.clear();
        self.further.clear();
        self.pieces.clear();
        // What a pixel has of a cell beside it is less than rounding.
        self.subtracted = site.outline.is_some();
        self.centre = None;
        self.site = site;
        self.is_beside = false;
        self.globes.start(&site);
        for [column, row] in site.cells() {
            coverage.cell(column, row, scratch, self)?;
        }
        self.globes.finish(&site);
        if self.is_beside {
            self.centre = self.most_around(coverage, scratch)?;
        }
        self.centre = self.centre.filter(|facet| !self.globes.is_before(*facet, self.site.centre));
        self.centre_is_lit = match self.centre {
            // An inner side is dark, whatever reaches the outer one.
            Some(facet) if self.drawing.side(facet) == Side::Front => self.is_lit_around(facet, coverage, scratch)?,
            _ => false,
        };
        self.merge();
        Ok(())
    }

    /// The facet of which most is seen in the centre's neighbourhood; none where most is sky.
    fn most_around(&mut self, coverage: &crate::visibility::Coverage, scratch: &mut Scratch) -> Result<Option<u32>> {
        // Facets in the order in which they come, and their areas.
        let mut seen: Vec<(u32, f64)> = vec![];
        let mut near = Near::new(self.drawing, self.site.centre, |facet, part: &[Point], sign| {
            let area = sign * area(part);
            match seen.iter_mut().find(|s| s.0 == facet) {
                Some(seen) => seen.1 += area,
                None => seen.push((facet, area)),
            }
        });
        for [column, row] in self.site.cells() {
            coverage.cell(column, row, scratch, &mut near)?;
        }
        let covered: f64 = seen.iter().map(|s| s.1).sum();
        let most = seen.iter().fold((None, 0.0), |most, s| if s.1 > most.1 { (Some(s.0), s.1) } else { most });
        Ok(if 2.0 * covered > around(self.site.centre).area() { most.0 } else { None })
    }

    /// Whether a facet is lit at the centre: whether most of what is seen of it in the smallest neighbourhood that areas tell something
    /// of. No single polygon is asked, since between two of them rounding leaves gaps.
    fn is_lit_around(
        &mut self,
        facet: u32,
        coverage: &crate::visibility::Coverage,
        scratch: &mut Scratch,
    ) -> Result<bool> {
        let Some(sun) = self.lights.first_mut() else { return Ok(false) };
        match sun.state(facet) {
            Shown::Nothing => return Ok(false),
            Shown::Whole => return Ok(true),
            Shown::Part => {}
        }
        let (drawn, lit) = sun.around(facet, self.site.centre);
        // All or nothing of the facet is lit there, to rounding; else what another one hides does not count.
        if lit >= (1.0 - 1e-4) * drawn || lit <= 0.0 {
            return Ok(lit > 0.0);
        }
        let (mut seen, mut lit) = (0.0, 0.0);
        let mut near = Near::new(self.drawing, self.site.centre, |of, part: &[Point], sign| {
            if of == facet {
                let area = area(part);
                seen += sign * area;
                lit += sign * sun.of(facet, &Window::Piece(part), area);
            }
        });
        for [column, row] in self.site.cells() {
            coverage.cell(column, row, scratch, &mut near)?;
        }
        Ok(lit > 0.0 && lit >= 0.5 * seen)
    }

    /// Takes a triangle that holds the centre for what is seen there, unless it is drawn no wider than its rounding.
    fn take_centre(&mut self, triangle: u32) {
        match self.drawing.is_edge_on(triangle) {
            true => self.is_beside = true,
            false => self.centre = Some(self.drawing.facet(triangle)),
        }
    }

    /// How many sources are known by parts.
    pub(super) fn lights(&self) -> usize {
        self.lights.len()
    }

    /// What of an entry such a source lights.
    pub(super) fn lit_part(&self, entry: &Entry, light: usize) -> ImagePart {
        if light == 0 {
            return entry.lit;
        }
        let found = self.further.binary_search_by_key(&(entry.facet, light), |f| (f.0, f.1));
        let lit = found.map_or(ImagePart::default(), |i| self.further[i].2);
        ImagePart { area: lit.area.clamp(0.0, entry.shown.area.max(0.0)), ..lit }
    }

    /// How much of a facet such a source lights.
    pub(super) fn lit_of(&self, light: usize, facet: u32) -> Shown {
        self.lights[light].state(facet)
    }

    /// Calls `put` with each part that `window` shows of a facet that such a source lights in part, counter-clockwise in the image, and the
    /// share of the source's light that it has.
    pub(super) fn lit_parts(&mut self, light: usize, facet: u32, window: &Window, put: impl FnMut(f64, &[Point])) {
        self.lights[light].each(facet, window, put);
    }

    /// Puts the pieces in the order of the entries.
    pub(super) fn sort_pieces(&mut self) {
        if self.pieces.are_kept {
            self.pieces.sort(self.entries.iter().map(|e| e.facet));
        }
    }

    /// Called when a new line of the image begins.
    pub(super) fn new_line(&mut self, rows: [u32; 2]) {
        self.lights.iter_mut().for_each(|light| light.new_line(rows));
    }

    /// Pieces of a facet become one entry, and what is left of it by rounding alone none.
    fn merge(&mut self) {
        if !self.entries.windows(2).all(|w| w[0].facet < w[1].facet) {
            self.entries.sort_by_key(|e| e.facet);
            self.entries.dedup_by(|next, first| {
                let same = next.facet == first.facet;
                if same {
                    first.shown.add(&next.shown);
                    first.lit.add(&next.lit);
                }
                same
            });
        }
        if !self.further.is_empty() {
            self.further.sort_by_key(|f| (f.0, f.1));
            self.further.dedup_by(|next, first| {
                let same = (next.0, next.1) == (first.0, first.1);
                if same {
                    first.2.add(&next.2);
                }
                same
            });
        }
        if self.subtracted {
            self.entries.retain_mut(|e| {
                e.lit.area = e.lit.area.clamp(0.0, e.shown.area.max(0.0));
                e.shown.area > REMAINDER
            });
        }
    }

    /// Adds what the pixel has of a piece of a facet in a cell.
    fn add_piece_of_cell(&mut self, facet: u32, polygon: &[Point], sign: f64) {
        match self.site.outline {
            None => self.add(facet, polygon, &Window::Piece(polygon), sign),
            Some(pixel) => self.add_within(&pixel, facet, polygon, sign),
        }
    }

    /// The same of a pixel with this outline.
    fn add_within(&mut self, pixel: &[Point; 4], facet: u32, polygon: &[Point], sign: f64) {
        let mut clipped = std::mem::take(&mut self.clipped);
        intersect(polygon, pixel, &mut clipped, &mut self.spare);
        self.add(facet, &clipped, &Window::Piece(&clipped), sign);
        self.clipped = clipped;
    }

    /// Adds a convex piece of a facet, or with `sign` -1 takes it away again.
    fn add(&mut self, facet: u32, polygon: &[Point], window: &Window, sign: f64) {
        self.add_piece(facet, polygon, window, sign);
        if self.globes.are_here() {
            for (times, hidden) in self.globes.left_of(facet, polygon, sign) {
                self.subtracted = true;
                self.add_piece(facet, &hidden, &Window::Piece(&hidden), times * sign);
            }
        }
    }

    fn add_piece(&mut self, facet: u32, polygon: &[Point], window: &Window, sign: f64) {
        let (area, moment) = area_and_moment(polygon);
        if area <= 0.0 {
            return;
        }
        let shown = ImagePart { area, moment };
        // Of the pixel, which is more or less than a cell if a lens distorts it.
        let times = sign * self.site.per_cell;
        let front = self.drawing.side(facet) == Side::Front;
        let mut lit = ImagePart::default();
        if front {
            self.pieces.add(facet, sign, polygon);
            for (light, of) in self.lights.iter_mut().enumerate() {
                let part = match self.wants_moments {
                    true => of.part(facet, window, shown),
                    false => ImagePart { area: of.of(facet, window, area), ..ImagePart::default() },
                };
                match light {
                    0 => lit = part,
                    _ => self.further.push((facet, light, part.signed(times))),
                }
            }
        }
        self.entries.push(Entry { facet, front, shown: shown.signed(times), lit: lit.signed(times) });
    }
}

impl Visit for Pixel<'_> {
    fn whole(&mut self, triangle: u32, rect: &Rect) {
        let outline = self.drawing.outline(triangle);
        let facet = self.drawing.facet(triangle);
        let bounds = Rect::of(&outline);
        if let Some(pixel) = self.site.outline {
            let mut of_cell = Vec::with_capacity(8);
            clip_to_rect(&outline, rect, &mut of_cell, &mut self.spare);
            self.add_within(&pixel, facet, &of_cell, 1.0);
        } else if triangle == facet && rect.contains(&bounds) {
            self.add(facet, &outline, &Window::Facet, 1.0);
        } else {
            let mut clipped = std::mem::take(&mut self.clipped);
            clip_to_rect(&outline, rect, &mut clipped, &mut self.spare);
            self.add(facet, &clipped, &Window::Rect { rect, outline: &outline }, 1.0);
            self.clipped = clipped;
        }
        if self.wants_centre
            && self.centre.is_none()
            && bounds.holds(self.site.centre)
            && rect.holds(self.site.centre)
            && holds(&outline, self.site.centre)
        {
            self.take_centre(triangle);
        }
    }

    const SIGNED: bool = true;

    fn hidden(&mut self, triangle: u32, _: &Rect, polygon: &[Point]) {
        self.subtracted = true;
        self.add_piece_of_cell(self.drawing.facet(triangle), polygon, -1.0);
    }

    fn cut(&mut self, _: u32, _: &Rect) {}

    fn piece(&mut self, triangle: u32, _: &Rect, polygon: &[Point]) {
        let facet = self.drawing.facet(triangle);
        self.add_piece_of_cell(facet, polygon, 1.0);
        if self.wants_centre && self.centre.is_none() && may_touch(polygon, &around(self.site.centre)) {
            if holds(polygon, self.site.centre) {
                self.take_centre(triangle);
            } else {
                self.is_beside = true;
            }
        }
    }
}

/// Hands out the parts of facets that are seen in the neighbourhood of a point, with their signs.
struct Near<'a, F> {
    drawing: &'a Drawing<'a>,
    rect: Rect,
    put: F,
    clipped: Vec<Point>,
    spare: Vec<Point>,
}

impl<'a, F: FnMut(u32, &[Point], f64)> Near<'a, F> {
    fn new(drawing: &'a Drawing<'a>, at: Point, put: F) -> Self {
        Near { drawing, rect: around(at), put, clipped: vec![], spare: vec![] }
    }

    fn add(&mut self, triangle: u32, polygon: &[Point], rect: &Rect, sign: f64) {
        let rect = rect.common(&self.rect);
        if rect.overlaps(&self.rect) {
            clip_to_rect(polygon, &rect, &mut self.clipped, &mut self.spare);
            (self.put)(self.drawing.facet(triangle), &self.clipped, sign);
        }
    }
}

impl<F: FnMut(u32, &[Point], f64)> Visit for Near<'_, F> {
    const SIGNED: bool = true;

    fn whole(&mut self, triangle: u32, rect: &Rect) {
        self.add(triangle, &self.drawing.outline(triangle), rect, 1.0);
    }

    fn piece(&mut self, triangle: u32, rect: &Rect, polygon: &[Point]) {
        self.add(triangle, polygon, rect, 1.0);
    }

    fn hidden(&mut self, triangle: u32, rect: &Rect, polygon: &[Point]) {
        self.add(triangle, polygon, rect, -1.0);
    }

    fn cut(&mut self, _: u32, _: &Rect) {}
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::super::detector::draw;
    use super::super::parts::Polygons;
    use super::super::sweep::sweep;
    use super::*;
    use crate::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose};
    use crate::progress::unwatched;
    use crate::visibility::{Seen, Topology};

    /// Ground from -2 to 2 and a wall along x = 0, 1 m high, from 1 km above: 2 x 2 pixels of 2 m; sample 0 is west, line 0 north.
    fn parts(towards: DVec3) -> Vec<Vec<(Entry, ImagePart)>> {
        let points = [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0], [0, -2, 0], [0, 2, 0], [0, 2, 1], [0, -2, 1]];
        let mesh = Mesh {
            vertices_m: points.map(|p| DVec3::from_array(p.map(f64::from))).to_vec(),
            facets: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
            material: vec![MaterialId(0); 4],
            ..Mesh::default()
        };
        let topology = Topology::new(&mesh);
        let seen = |towards| {
            Seen::from_afar(&mesh, &topology, Direction::new(towards).unwrap(), "sunlight", &unwatched).unwrap()
        };
        // The Sun at the zenith, and another source.
        let lit = [DVec3::Z, towards].map(seen);
        let polygons = lit.each_ref().map(Polygons::of_seen);
        let rotation = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
        let pose = Pose { rotation, translation_m: DVec3::new(0.0, 0.0, 1000.0) };
        let camera = FrameCamera::centred(pose, 2, 2, 2e-3);
        let (drawing, detector) = draw(&mesh, &topology, mesh.bounds_m(), &camera);
        let start = || {
            let lights = lit.iter().zip(&polygons).map(|(seen, polygons)| LitArea::new(&drawing, seen, polygons));
            let mut pixel = Pixel::new(&drawing, lights.collect());
            pixel.wants_moments = true;
            pixel
        };
        let lines = sweep((&drawing, &detector), vec![(); 2], ("image", &unwatched), start, |pixel, line, ()| {
            let mut found = Vec::new();
            line.each(
                pixel,
                |_| false,
                |pixel| {
                    found.push(pixel.entries.iter().map(|e| (*e, pixel.lit_part(e, 1))).collect::<Vec<_>>());
                },
            )?;
            Ok(found)
        });
        lines.unwrap().concat()
    }

    #[test]
    fn lit_parts_have_their_own_centroids() {
        // 45 deg high in the east: of the west, x from -2 to -1 is lit.
        let pixels = parts(DVec3::new(1.0, 0.0, 1.0));
        let sums = |pixel: usize| {
            let (mut shown, mut sun, mut other) = (ImagePart::default(), ImagePart::default(), ImagePart::default());
            for (entry, lit) in &pixels[pixel] {
                shown.add(&entry.shown);
                sun.add(&entry.lit);
                other.add(lit);
            }
            [shown, sun, other].map(|part| [part.area, part.moment[0] / part.area, part.moment[1] / part.area])
        };
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
        for (pixel, [x, y]) in [(0, [0.5, 0.5]), (1, [1.5, 0.5]), (2, [0.5, 1.5]), (3, [1.5, 1.5])] {
            let [shown, sun, other] = sums(pixel);
            let is_west = pixel % 2 == 0;
            assert!(near(shown, [1.0, x, y]) && near(sun, [1.0, x, y]), "{pixel}: {shown:?} {sun:?}");
            let expected = if is_west { [0.5, 0.25, y] } else { [1.0, x, y] };
            assert!(near(other, expected), "{pixel}: {other:?}");
        }
    }
}
