//! One map, or texture: which of its texels lie in what is seen of a facet.

use super::MapView;
use super::charts::{of_corners, of_places, of_projection};
use super::lens::{FlatPart, MapLens};
use super::sums::TexelSums;
use crate::geometry::polygon::{Point, area, side, split};
use crate::geometry::{Chart, LonLat, Overlay, Projection, Texels, index_u32};
use crate::integrate::parts::{Parts, Polygons, Window, on_facet};
use crate::integrate::pixel::Pixel;
use crate::product::{Patches, Placement, ViewImage};
use crate::scene::Scene;
use crate::visibility::{Drawing, Seen, Shown};

/// Texels and their areas in a facet, pixels.
#[derive(Debug, Default)]
pub(in crate::integrate) struct Share {
    pub(in crate::integrate) texels: Vec<(u32, f64)>,
    /// Of all of them.
    pub(in crate::integrate) area: f64,
}

impl Share {
    pub(in crate::integrate) fn clear(&mut self) {
        self.texels.clear();
        self.area = 0.0;
    }

    fn take(&mut self, texel: u32, area: f64) {
        self.texels.push((texel, area));
        self.area += area;
    }
}

/// That of all that is seen, or of what a source lights.
fn share<'s>(light: Option<usize>, seen: &'s mut Share, lit: &'s mut [Share]) -> &'s mut Share {
    match light {
        None => seen,
        Some(light) => &mut lit[light],
    }
}

/// One map, and what is known of the facet at hand.
pub(in crate::integrate) struct Lookup<'a> {
    scene: &'a Scene,
    drawing: &'a Drawing<'a>,
    pub(super) kind: TexelLayout<'a>,
    /// For each texel whether it holds a value; `None`: all do.
    known: Option<&'a [bool]>,
    /// For each texel whether nothing of the scene is in it: between texel centres, such a texel does not count.
    sky: &'a [bool],
    parts: Option<Parts<'a>>,
    /// What distorts it, if anything does.
    lens: Option<MapLens<'a>>,
    texels: Texels,
    overlay: Overlay,
    piece: Vec<Point>,
    /// What share of the pixel at hand the area of a cell is.
    per_cell: f64,
    chart: Option<(u32, Chart)>,
    /// What is seen of the facet, and what of that each source lights that is known by parts.
    pub(in crate::integrate) seen: Share,
    pub(in crate::integrate) lit: Vec<Share>,
    pub(super) sums: TexelSums,
    pub(super) quadrature_error: f64,
}

/// Where the texels of a lookup lie.
pub(in crate::integrate) enum TexelLayout<'a> {
    Facets,
    Patches(&'a Patches),
    View(&'a ViewImage, Box<Projection>, Option<&'a Seen>),
    /// By the texel coordinates of facets' corners; columns and rows.
    Texture(&'a [[[f64; 2]; 3]], [usize; 2]),
    /// By longitude and latitude.
    LonLat(&'a LonLat),
}

impl<'a> Lookup<'a> {
    pub(in crate::integrate) fn new(
        scene: &'a Scene,
        drawing: &'a Drawing<'a>,
        view: &'a MapView<'a>,
        polygons: Option<&'a Polygons<'a>>,
        texels: Texels,
    ) -> Self {
        let kind = match view.placement {
            Placement::Facets(_) => TexelLayout::Facets,
            Placement::Patches(patches) => TexelLayout::Patches(patches),
            Placement::View(image) => TexelLayout::View(image, Box::new(image.camera.projection()), view.eye),
            Placement::Atlas(atlas) => TexelLayout::Texture(&atlas.corners, [atlas.columns, atlas.rows]),
            Placement::LonLat(map) => TexelLayout::LonLat(map),
        };
        let lens = match view.placement {
            Placement::View(image) => MapLens::of(&image.camera),
            _ => None,
        };
        let lookup = Lookup::of(scene, drawing, kind, Some(view.known), polygons, texels);
        Lookup { sky: view.sky, lens, ..lookup }
    }

    pub(in crate::integrate) fn of(
        scene: &'a Scene,
        drawing: &'a Drawing<'a>,
        kind: TexelLayout<'a>,
        known: Option<&'a [bool]>,
        polygons: Option<&'a Polygons<'a>>,
        texels: Texels,
    ) -> Self {
        Lookup {
            scene,
            drawing,
            kind,
            known,
            sky: &[],
            parts: polygons.map(|p| Parts::new(drawing, p)),
            lens: None,
            texels,
            overlay: Overlay::default(),
            piece: vec![],
            per_cell: 1.0,
            chart: None,
            seen: Share::default(),
            lit: vec![],
            sums: TexelSums::default(),
            quadrature_error: 0.0,
        }
    }

    pub(in crate::integrate) fn new_line(&mut self, rows: [u32; 2]) {
        self.quadrature_error = 0.0;
        if let Some(parts) = &mut self.parts {
            parts.new_line(rows);
        }
    }

    /// Finds the texels of what a pixel sees of a facet, its entry `index`, and if that is wanted those of its lit parts.
    pub(in crate::integrate) fn look(&mut self, pixel: &mut Pixel, index: usize, wants_lit: bool) {
        self.seen.clear();
        self.lit.resize_with(if wants_lit { pixel.lights() } else { 0 }, Share::default);
        self.lit.iter_mut().for_each(Share::clear);
        self.per_cell = pixel.site.per_cell;
        let entry = pixel.entries[index];
        if let TexelLayout::Facets = self.kind {
            if self.known.is_none_or(|known| known[entry.facet as usize]) {
                self.seen.take(entry.facet, entry.shown.area);
                for (light, share) in self.lit.iter_mut().enumerate() {
                    share.take(entry.facet, pixel.lit_part(&entry, light).area);
                }
            }
            return;
        }
        for k in pixel.pieces.of(index) {
            let (of, sign, outline) = pixel.pieces.get(k);
            if of != entry.facet {
                // What rounding alone left of a facet has no entry.
                continue;
            }
            // Kept apart from the pixel, which is asked for lit parts.
            let mut piece = std::mem::take(&mut self.piece);
            piece.clear();
            piece.extend_from_slice(outline);
            let before = (self.seen.texels.len(), self.seen.area);
            self.lay(entry.facet, &piece, sign, None);
            for light in 0..self.lit.len() {
                match pixel.lit_of(light, entry.facet) {
                    Shown::Nothing => {}
                    Shown::Whole => {
                        self.lit[light].texels.extend_from_slice(&self.seen.texels[before.0..]);
                        self.lit[light].area += self.seen.area - before.1;
                    }
                    Shown::Part => pixel.lit_parts(light, entry.facet, &Window::Piece(&piece), |share, part| {
                        self.lay(entry.facet, part, sign * share, Some(light));
                    }),
                }
            }
            self.piece = piece;
        }
    }

    /// Divides a convex part of a facet's image into convex parts that the map knows and others that it does not: `put(is_known, part)`.
    pub(in crate::integrate) fn divide(&mut self, facet: u32, part: &[Point], mut put: impl FnMut(bool, Vec<Point>)) {
        let chart = self.chart(facet);
        match self.flat_parts(chart.as_ref(), facet, part) {
            None => self.divide_by(chart, facet, part, &mut put),
            Some(parts) => {
                parts.into_iter().for_each(|(chart, part)| self.divide_by(chart, facet, &part, &mut put));
            }
        }
    }

    /// The parts over which texels are affine, and how; `None` if they are over the whole, by its `chart`.
    fn flat_parts(&self, chart: Option<&Chart>, facet: u32, part: &[Point]) -> Option<Vec<FlatPart>> {
        match (&self.kind, &self.lens, chart) {
            (TexelLayout::LonLat(map), ..) => {
                let mesh = &self.scene.body.mesh;
                let corners = mesh.facet(facet as usize).corners_m.map(|corner| corner - map.centre_m);
                let space = of_places(corners, &on_facet(mesh, &self.drawing.view, facet));
                let parts = space.map(|space| map.flat_parts(&space, part)).unwrap_or_default();
                Some(parts.into_iter().map(|(chart, part)| (Some(chart), part)).collect())
            }
            (_, Some(lens), Some(chart)) => Some(lens.flat_parts(chart, part)),
            _ => None,
        }
    }

    /// The same by a chart of the whole part.
    fn divide_by(&mut self, chart: Option<Chart>, facet: u32, part: &[Point], put: &mut dyn FnMut(bool, Vec<Point>)) {
        let (mut inside, mut outside) = (vec![part.to_vec()], Vec::new());
        match &self.kind {
            TexelLayout::Facets => {
                let is_known = self.known.is_none_or(|known| known[facet as usize]);
                return put(is_known, part.to_vec());
            }
            TexelLayout::Patches(patches) => {
                let (texels, known) = (&patches.polygon_texel, self.known);
                self.keep_parts(facet, &mut inside, &mut outside, |i| {
                    known.is_none_or(|known| known[texels[i] as usize])
                });
            }
            TexelLayout::View(..) | TexelLayout::Texture(..) | TexelLayout::LonLat(_) => {
                let Some(chart) = chart else { return put(false, part.to_vec()) };
                let size = self.size();
                let [width, height] = size.map(|n| n as f64);
                // The borders of the image; between them w is positive.
                for (k, limit) in [(0, 0.0), (0, width), (1, 0.0), (1, height)] {
                    let Some(part) = inside.pop() else { break };
                    let value = |p: &Point| {
                        let form = |f: &[f64; 3]| f[0] * p[0] + f[1] * p[1] + f[2];
                        let along = form(if k == 0 { &chart.s } else { &chart.t });
                        if limit == 0.0 { along } else { limit * form(&chart.w) - along }
                    };
                    let values: Vec<f64> = part.iter().map(value).collect();
                    let (mut within, mut beyond) = (vec![], vec![]);
                    split(&part, &values, &mut within, &mut beyond);
                    outside.extend((beyond.len() > 2).then_some(beyond));
                    inside.extend((within.len() > 2).then_some(within));
                }
                match &self.kind {
                    TexelLayout::View(_, _, Some(seen)) if seen.shown[facet as usize] == Shown::Nothing => {
                        outside.append(&mut inside)
                    }
                    TexelLayout::View(_, _, Some(seen)) if seen.shown[facet as usize] == Shown::Part => {
                        self.keep_parts(facet, &mut inside, &mut outside, |_| true);
                    }
                    _ => {}
                }
                if let Some(known) = self.known {
                    let (sky, width) = (self.sky, size[0]);
                    let is_known = |around: &[(usize, usize)]| {
                        let shows = |i: &usize| !is_sky(sky, *i);
                        let mut counting =
                            around.iter().map(|(column, row)| row * width + column).filter(shows).peekable();
                        counting.peek().is_some() && counting.all(|i| known[i])
                    };
                    for part in std::mem::take(&mut inside) {
                        let mut cells = Vec::new();
                        self.overlay.outlines(&chart, &part, size, self.texels, |around, outline| {
                            cells.push((is_known(around), outline));
                        });
                        // As long as all are known, or none, there is nothing to divide.
                        match cells.first() {
                            Some((first, _)) if cells.iter().any(|(is_known, _)| is_known != first) => {
                                for (is_known, outline) in cells {
                                    if is_known { &mut inside } else { &mut outside }.push(outline);
                                }
                            }
                            Some((true, _)) => inside.push(part),
                            _ => outside.push(part),
                        }
                    }
                }
            }
        }
        inside.into_iter().for_each(|part| put(true, part));
        outside.into_iter().for_each(|part| put(false, part));
    }

    /// Leaves inside what the map's parts of a facet that are `wanted` cover, and moves the rest outside.
    fn keep_parts(
        &mut self,
        facet: u32,
        inside: &mut Vec<Vec<Point>>,
        outside: &mut Vec<Vec<Point>>,
        wanted: impl Fn(usize) -> bool,
    ) {
        for part in std::mem::take(inside) {
            let mut rest = vec![part.clone()];
            if let Some(parts) = &mut self.parts {
                parts.each(facet, &Window::Piece(&part), |i, common| {
                    if wanted(i) && common.len() > 2 && area(common) > 0.0 {
                        without(&mut rest, common);
                        inside.push(common.to_vec());
                    }
                });
            }
            outside.append(&mut rest);
        }
    }

    /// Columns and rows of the map's image, if it is one.
    fn size(&self) -> [usize; 2] {
        match &self.kind {
            TexelLayout::View(image, ..) => image.size(),
            TexelLayout::Texture(_, size) => *size,
            TexelLayout::LonLat(map) => map.size(),
            TexelLayout::Facets | TexelLayout::Patches(_) => [0, 0],
        }
    }

    /// Lays the map's texels over a convex part of a facet's image: of all that is seen, or of what a source lights.
    pub(in crate::integrate) fn lay(&mut self, facet: u32, part: &[Point], sign: f64, light: Option<usize>) {
        if part.len() < 3 {
            return;
        }
        let times = sign * self.per_cell;
        match &self.kind {
            TexelLayout::Facets => {
                if self.known.is_none_or(|known| known[facet as usize]) {
                    share(light, &mut self.seen, &mut self.lit).take(facet, times * area(part));
                }
                return;
            }
            TexelLayout::Patches(patches) => {
                let Some(parts) = &mut self.parts else { return };
                let share = share(light, &mut self.seen, &mut self.lit);
                let known = self.known;
                parts.each(facet, &Window::Piece(part), |i, common| {
                    let (texel, common) = (patches.polygon_texel[i], area(common));
                    if common > 0.0 && known.is_none_or(|known| known[texel as usize]) {
                        share.take(texel, times * common);
                    }
                });
                return;
            }
            TexelLayout::View(..) | TexelLayout::Texture(..) | TexelLayout::LonLat(_) => {}
        }
        let chart = self.chart(facet);
        match self.flat_parts(chart.as_ref(), facet, part) {
            None => chart.iter().for_each(|chart| self.lay_by(chart, facet, part, (times, light))),
            Some(parts) => {
                for (chart, part) in parts {
                    chart.iter().for_each(|chart| self.lay_by(chart, facet, &part, (times, light)));
                }
            }
        }
    }

    /// The same of an image, by a chart of the whole part; it counts so many times.
    fn lay_by(&mut self, chart: &Chart, facet: u32, part: &[Point], (times, light): (f64, Option<usize>)) {
        let (size, per_cell) = (self.size(), self.per_cell);
        let seen = match &self.kind {
            TexelLayout::View(_, _, Some(seen)) => seen.shown[facet as usize],
            _ => Shown::Whole,
        };
        let Lookup { known, sky, parts, texels, overlay, seen: all, lit, quadrature_error, .. } = self;
        let share = share(light, all, lit);
        let known = |column: usize, row: usize| known.is_none_or(|known| known[row * size[0] + column]);
        let number = |column: usize, row: usize| index_u32(row * size[0] + column);
        let shows = |column: usize, row: usize| !is_sky(sky, row * size[0] + column);
        let mut lay = |part: &[Point]| match texels {
            Texels::Nearest => overlay.texels(chart, part, size, |column, row, area| {
                if known(column, row) && shows(column, row) {
                    share.take(number(column, row), times * area);
                }
            }),
            Texels::Bilinear => overlay.centres(chart, part, size, |around, area, error| {
                let counts = |(column, row, _): &(usize, usize, f64)| shows(*column, *row);
                if !around.iter().all(counts) {
                    // Those that show the scene share what is between them all.
                    let shown: f64 = around.iter().filter(|c| counts(c)).map(|c| c.2).sum();
                    if shown > 0.0 && around.iter().filter(|c| counts(c)).all(|(column, row, _)| known(*column, *row)) {
                        let scale = times * area / shown;
                        let counting = around.iter().filter(|c| counts(c));
                        share
                            .texels
                            .extend(counting.map(|(column, row, weight)| (number(*column, *row), scale * weight)));
                        share.area += times * area;
                    }
                } else if around.iter().all(|(column, row, _)| known(*column, *row)) {
                    *quadrature_error = quadrature_error.max(per_cell * error);
                    share.texels.extend(around.map(|(column, row, weight)| (number(column, row), times * weight)));
                    share.area += times * area;
                }
            }),
        };
        match (seen, parts) {
            (Shown::Nothing, _) => {}
            (Shown::Part, Some(parts)) => parts.each(facet, &Window::Piece(part), |_, common| {
                if common.len() > 2 {
                    lay(common);
                }
            }),
            _ => lay(part),
        }
    }

    /// How the image of a facet leads to texels.
    fn chart(&mut self, facet: u32) -> Option<Chart> {
        if let Some((of, chart)) = self.chart
            && of == facet
        {
            return Some(chart);
        }
        let (mesh, view) = (&self.scene.body.mesh, &self.drawing.view);
        let chart = match &self.kind {
            TexelLayout::View(_, projection, _) => of_projection(projection, view, &mesh.facet(facet as usize)),
            TexelLayout::Texture(corners, _) => of_corners(&corners[facet as usize], &on_facet(mesh, view, facet)),
            TexelLayout::Facets | TexelLayout::Patches(_) | TexelLayout::LonLat(_) => None,
        };
        self.chart = chart.map(|chart| (facet, chart));
        chart
    }
}

/// Whether nothing of the scene is in a texel.
fn is_sky(sky: &[bool], texel: usize) -> bool {
    sky.get(texel).copied().unwrap_or(false)
}

/// Takes a convex hole out of convex parts, all counter-clockwise: what is left of them, in convex parts.
fn without(parts: &mut Vec<Vec<Point>>, hole: &[Point]) {
    let mut left = Vec::new();
    let mut value = Vec::new();
    for mut part in parts.drain(..) {
        for (i, a) in hole.iter().enumerate() {
            let b = hole[(i + 1) % hole.len()];
            value.clear();
            value.extend(part.iter().map(|p| side(*a, b, *p)));
            let (mut inside, mut outside) = (vec![], vec![]);
            split(&part, &value, &mut inside, &mut outside);
            if outside.len() > 2 {
                left.push(outside);
            }
            part = inside;
            if part.len() < 3 {
                break;
            }
        }
    }
    *parts = left;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_without_a_triangle() {
        let mut parts = vec![vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]];
        without(&mut parts, &[[1.0, 1.0], [3.0, 1.0], [2.0, 3.0]]);
        // 16 - 2 * 2 / 2.
        assert!((parts.iter().map(|p| area(p)).sum::<f64>() - 14.0).abs() < 1e-15);
        // A hole that lies beside takes nothing, whatever cuts it makes.
        without(&mut parts, &[[5.0, 0.0], [6.0, 0.0], [6.0, 4.0]]);
        assert!((parts.iter().map(|p| area(p)).sum::<f64>() - 14.0).abs() < 1e-14);
        without(&mut parts, &[[-1.0, -1.0], [9.0, -1.0], [9.0, 9.0], [-1.0, 9.0]]);
        assert!(parts.is_empty());
    }
}
