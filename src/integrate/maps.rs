//! Radiance maps from elsewhere: how much of each pixel each texel fills. Free of wavelength, like footprints: bands are
//! multiplied in afterwards.

use glam::DVec3;

use super::parts::{Parts, Polygons, Window, on_facet};
use super::pixel::{Entry, Pixel};
use super::texels::{of_corners, of_projection};
use super::together::{Together, differ, without};
use crate::error::Result;
use crate::geometry::polygon::{Point, Rect, area, split};
use crate::geometry::{Chart, Direction, Overlay, Texels, angle_rad};
use crate::product::{Eye, Patches, Placement, Plane, TexelLine, TexelWeights, ViewImage};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::solve::Part;
use crate::visibility::Drawing;
use crate::visibility::{Seen, Shown};

/// Which of several maps of one scene serve a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Choice {
    /// Of those that know the facet the one seen from the nearest direction.
    #[default]
    Nearest,
    /// All that know the facet, weighted by one over the squared angle to the direction of view.
    Interpolated,
}

/// What is shown where a map knows nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unknown {
    /// What is known of the facet, else of the pixel, stands for the rest.
    #[default]
    Mean,
    /// Nothing: the caller has something for it.
    Left,
    /// What the scene's own sources and heat send there.
    Solved,
}

/// A map in a scene.
#[derive(Debug, Clone, Copy)]
pub struct MapView<'a> {
    /// Where its texels lie.
    pub placement: &'a Placement,
    /// For each texel whether it holds a value.
    pub known: &'a [bool],
    /// For each texel whether its eye sees nothing of the scene there; empty if that is not asked for.
    pub sky: &'a [bool],
}

/// How maps are put onto a scene.
#[derive(Debug, Clone)]
pub struct Maps<'a> {
    /// Terms of a sum; each is one of several maps of the scene, seen from different directions.
    pub terms: Vec<Vec<MapView<'a>>>,
    /// Which of the maps of a term.
    pub choice: Choice,
    /// What holds between texel centres.
    pub texels: Texels,
    /// What is shown where nothing is known.
    pub unknown: Unknown,
    /// The scene's own light and heat are added, everywhere.
    pub adds_solved: bool,
}

/// How much of the pixels the texels of maps fill.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MapImage {
    /// For each map of each term.
    pub weights: Vec<Vec<TexelWeights>>,
    /// For each term and pixel the area that it knows nothing of, of what is seen of outer sides, pixels.
    pub unknown: Vec<Vec<f64>>,
    /// As much of that as the weights do not stand for either: with [`Unknown::Mean`] that of facets of which nothing is known.
    pub unfilled: Vec<Vec<f64>>,
    /// For each pixel the area that shows outer sides, pixels.
    pub area: Vec<f64>,
    /// Largest angle between a direction of view and that of the map that serves it, deg; 0 if no map has a direction.
    pub largest_angle_deg: f64,
    /// Largest error by quadrature between texel centres, relative to the largest value of the texels around.
    pub quadrature_error: f64,
}

/// Images of geometry that maps add: name and unit.
const PLANES: [(&str, &str); 2] = [("MAP_COVERAGE", "1"), ("MAP_ANGLE", "deg")];

/// All lines together, and the planes that they add.
pub(super) fn join(maps: &Maps, lines: impl Iterator<Item = MapLine>) -> (MapImage, Vec<Plane>) {
    let mut image = MapImage::new(maps);
    let mut values: [Vec<f64>; 2] = Default::default();
    for line in lines {
        values[0].extend(&line.coverage);
        values[1].extend(&line.angle_deg);
        image.append(line);
    }
    let named = PLANES.iter().zip(values);
    let plane = |((name, unit), values): (&(&str, &str), Vec<f64>)| Plane {
        name: (*name).to_owned(),
        unit: (*unit).to_owned(),
        values,
    };
    (image, named.map(plane).collect())
}

impl MapImage {
    fn new(maps: &Maps) -> Self {
        MapImage {
            weights: maps.terms.iter().map(|views| vec![TexelWeights::default(); views.len()]).collect(),
            unknown: vec![vec![]; maps.terms.len()],
            unfilled: vec![vec![]; maps.terms.len()],
            ..MapImage::default()
        }
    }

    fn append(&mut self, line: MapLine) {
        let ours = self.weights.iter_mut().flatten();
        ours.zip(line.weights.into_iter().flatten()).for_each(|(ours, line)| ours.lines.push(line));
        self.unknown.iter_mut().zip(&line.unknown).for_each(|(ours, line)| ours.extend(line));
        self.unfilled.iter_mut().zip(&line.unfilled).for_each(|(ours, line)| ours.extend(line));
        self.area.extend(&line.area);
        self.largest_angle_deg = line.angle_deg.iter().copied().fold(self.largest_angle_deg, f64::max);
        self.quadrature_error = self.quadrature_error.max(line.quadrature_error);
    }
}

/// A map, ready to be looked up.
pub(super) struct Prepared<'a> {
    view: MapView<'a>,
    seen: Option<Seen>,
}

/// Finds what each map's eye sees of the scene.
pub(super) fn prepare<'a>(maps: &Maps<'a>, scene: &Scene, watch: Watch<'_>) -> Result<Vec<Vec<Prepared<'a>>>> {
    let prepare = |view: &MapView<'a>| {
        let seen = match view.placement {
            Placement::View(image) if image.occlusion => Some(seen_by(image, scene, watch)?),
            _ => None,
        };
        Ok(Prepared { view: *view, seen })
    };
    maps.terms.iter().map(|views| views.iter().map(prepare).collect()).collect()
}

/// What an image's eye sees of each facet.
fn seen_by(image: &ViewImage, scene: &Scene, watch: Watch<'_>) -> Result<Seen> {
    const STAGE: &str = "what the map sees";
    let (mesh, topology) = (&scene.body.mesh, scene.body.topology());
    match image.eye {
        Eye::Towards(direction) => Seen::from_afar(mesh, topology, direction, STAGE, watch),
        Eye::At(centre_m) => {
            // The last row of a central projection is its axis; the corners of the image are rays.
            let axis = Direction::new(image.projection.linear.row(2))
                .unwrap_or_else(|| Direction::new(-centre_m).unwrap_or(scene.sky.sun.direction));
            let from_texel = image.projection.linear.inverse();
            let (columns, rows) = (image.columns as f64, image.rows as f64);
            let rays = [[0.0, 0.0], [columns, 0.0], [columns, rows], [0.0, rows]]
                .map(|[s, t]| from_texel * DVec3::new(s, t, 1.0));
            Seen::from_point(mesh, topology, centre_m, (axis, &rays), STAGE, watch)
        }
    }
}

impl Prepared<'_> {
    /// The polygons on facets that the map is made of, or that it sees.
    pub(super) fn polygons(&self, facets: usize) -> Option<Polygons<'_>> {
        match (self.view.placement, &self.seen) {
            (Placement::Patches(patches), _) => Some(Polygons::of_patches(facets, patches)),
            (_, Some(seen)) => Some(Polygons::of_seen(seen)),
            _ => None,
        }
    }
}

/// Texels and their areas in a facet, pixels.
#[derive(Debug, Default)]
pub(super) struct Share {
    pub(super) texels: Vec<(u32, f64)>,
    /// Of all of them.
    pub(super) area: f64,
}

impl Share {
    pub(super) fn clear(&mut self) {
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
pub(super) struct Lookup<'a> {
    scene: &'a Scene,
    drawing: &'a Drawing<'a>,
    kind: Kind<'a>,
    /// For each texel whether it holds a value; `None`: all do.
    known: Option<&'a [bool]>,
    /// For each texel whether nothing of the scene is in it: between texel centres, such a texel does not count.
    sky: &'a [bool],
    parts: Option<Parts<'a>>,
    texels: Texels,
    overlay: Overlay,
    piece: Vec<Point>,
    chart: Option<(u32, Chart)>,
    /// What is seen of the facet, and what of that each source lights that is known by parts.
    pub(super) seen: Share,
    pub(super) lit: Vec<Share>,
    sums: TexelSums,
    quadrature_error: f64,
}

/// Where the texels of a lookup lie.
pub(super) enum Kind<'a> {
    Facets,
    Patches(&'a Patches),
    View(&'a ViewImage, Option<&'a Seen>),
    /// By the texel coordinates of facets' corners; columns and rows.
    Texture(&'a [[[f64; 2]; 3]], [usize; 2]),
}

impl<'a> Lookup<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        drawing: &'a Drawing<'a>,
        prepared: &'a Prepared<'a>,
        polygons: Option<&'a Polygons<'a>>,
        texels: Texels,
    ) -> Self {
        let kind = match prepared.view.placement {
            Placement::Facets(_) => Kind::Facets,
            Placement::Patches(patches) => Kind::Patches(patches),
            Placement::View(image) => Kind::View(image, prepared.seen.as_ref()),
            Placement::Atlas(atlas) => Kind::Texture(&atlas.corners, [atlas.columns, atlas.rows]),
        };
        let lookup = Lookup::of(scene, drawing, kind, Some(prepared.view.known), polygons, texels);
        Lookup { sky: prepared.view.sky, ..lookup }
    }

    pub(super) fn of(
        scene: &'a Scene,
        drawing: &'a Drawing<'a>,
        kind: Kind<'a>,
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
            texels,
            overlay: Overlay::default(),
            piece: vec![],
            chart: None,
            seen: Share::default(),
            lit: vec![],
            sums: TexelSums::default(),
            quadrature_error: 0.0,
        }
    }

    pub(super) fn new_line(&mut self, row: u32) {
        self.quadrature_error = 0.0;
        if let Some(parts) = &mut self.parts {
            parts.new_line(row);
        }
    }

    /// Finds the texels of what a pixel sees of a facet, its entry `index`, and if that is wanted those of its lit parts.
    pub(super) fn look(&mut self, pixel: &mut Pixel, index: usize, wants_lit: bool) {
        self.seen.clear();
        self.lit.resize_with(if wants_lit { pixel.lights() } else { 0 }, Share::default);
        self.lit.iter_mut().for_each(Share::clear);
        let entry = pixel.entries[index];
        if let Kind::Facets = self.kind {
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
                    Shown::Part => pixel.lit_parts(light, entry.facet, &Window::Piece(&piece), |part| {
                        self.lay(entry.facet, part, sign, Some(light));
                    }),
                }
            }
            self.piece = piece;
        }
    }

    /// Divides a convex part of a facet's image into convex parts that the map knows and others that it does not: `put(is_known, part)`.
    pub(super) fn divide(&mut self, facet: u32, part: &[Point], mut put: impl FnMut(bool, Vec<Point>)) {
        let (mut inside, mut outside) = (vec![part.to_vec()], Vec::new());
        match &self.kind {
            Kind::Facets => {
                let is_known = self.known.is_none_or(|known| known[facet as usize]);
                return put(is_known, part.to_vec());
            }
            Kind::Patches(patches) => {
                let (texels, known) = (&patches.polygon_texel, self.known);
                self.keep_parts(facet, &mut inside, &mut outside, |i| {
                    known.is_none_or(|known| known[texels[i] as usize])
                });
            }
            Kind::View(..) | Kind::Texture(..) => {
                let Some(chart) = self.chart(facet) else { return put(false, part.to_vec()) };
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
                    Kind::View(_, Some(seen)) if seen.shown[facet as usize] == Shown::Nothing => {
                        outside.append(&mut inside)
                    }
                    Kind::View(_, Some(seen)) if seen.shown[facet as usize] == Shown::Part => {
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
            Kind::View(image, _) => [image.columns, image.rows],
            Kind::Texture(_, size) => *size,
            Kind::Facets | Kind::Patches(_) => [0, 0],
        }
    }

    /// Lays the map's texels over a convex part of a facet's image: of all that is seen, or of what a source lights.
    pub(super) fn lay(&mut self, facet: u32, part: &[Point], sign: f64, light: Option<usize>) {
        if part.len() < 3 {
            return;
        }
        match &self.kind {
            Kind::Facets => {
                if self.known.is_none_or(|known| known[facet as usize]) {
                    share(light, &mut self.seen, &mut self.lit).take(facet, sign * area(part));
                }
                return;
            }
            Kind::Patches(patches) => {
                let Some(parts) = &mut self.parts else { return };
                let share = share(light, &mut self.seen, &mut self.lit);
                let known = self.known;
                parts.each(facet, &Window::Piece(part), |i, common| {
                    let (texel, common) = (patches.polygon_texel[i], area(common));
                    if common > 0.0 && known.is_none_or(|known| known[texel as usize]) {
                        share.take(texel, sign * common);
                    }
                });
                return;
            }
            Kind::View(..) | Kind::Texture(..) => {}
        }
        let size = self.size();
        let Some(chart) = self.chart(facet) else { return };
        let seen = match &self.kind {
            Kind::View(_, Some(seen)) => seen.shown[facet as usize],
            _ => Shown::Whole,
        };
        let Lookup { known, sky, parts, texels, overlay, seen: all, lit, quadrature_error, .. } = self;
        let share = share(light, all, lit);
        let known = |column: usize, row: usize| known.is_none_or(|known| known[row * size[0] + column]);
        let number = |column: usize, row: usize| (row * size[0] + column) as u32;
        let shows = |column: usize, row: usize| !is_sky(sky, row * size[0] + column);
        let mut lay = |part: &[Point]| match texels {
            Texels::Nearest => overlay.texels(&chart, part, size, |column, row, area| {
                if known(column, row) && shows(column, row) {
                    share.take(number(column, row), sign * area);
                }
            }),
            Texels::Bilinear => overlay.centres(&chart, part, size, |around, area, error| {
                let counts = |(column, row, _): &(usize, usize, f64)| shows(*column, *row);
                if !around.iter().all(counts) {
                    // Those that show the scene share what is between them all.
                    let shown: f64 = around.iter().filter(|c| counts(c)).map(|c| c.2).sum();
                    if shown > 0.0 && around.iter().filter(|c| counts(c)).all(|(column, row, _)| known(*column, *row)) {
                        let scale = sign * area / shown;
                        let counting = around.iter().filter(|c| counts(c));
                        share
                            .texels
                            .extend(counting.map(|(column, row, weight)| (number(*column, *row), scale * weight)));
                        share.area += sign * area;
                    }
                } else if around.iter().all(|(column, row, _)| known(*column, *row)) {
                    *quadrature_error = quadrature_error.max(error);
                    share.texels.extend(around.map(|(column, row, weight)| (number(column, row), sign * weight)));
                    share.area += sign * area;
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
            Kind::View(image, _) => of_projection(&image.projection, view, &mesh.facet(facet as usize)),
            Kind::Texture(corners, _) => of_corners(&corners[facet as usize], &on_facet(mesh, view, facet)),
            Kind::Facets | Kind::Patches(_) => None,
        };
        self.chart = chart.map(|chart| (facet, chart));
        chart
    }
}

/// Whether nothing of the scene is in a texel.
fn is_sky(sky: &[bool], texel: usize) -> bool {
    sky.get(texel).copied().unwrap_or(false)
}

/// Sums over texels, handed out in the order in which the texels came.
#[derive(Debug, Default)]
struct TexelSums {
    /// Open addressing; a power of two, at most half full.
    slots: Vec<(u32, f64)>,
    used: Vec<u32>,
}

/// What is known of a facet stands for the rest of it if it is at least this share; less is no better than what its pixel knows,
/// and rounding would be multiplied.
const LEAST_KNOWN: f64 = 0.01;

/// Of a texel that is hidden all over, subtraction leaves less than this, pixels.
const REMAINDER: f64 = 1e-15;

const EMPTY: u32 = u32::MAX;

impl TexelSums {
    fn add(&mut self, texel: u32, weight: f64) {
        if 2 * (self.used.len() + 1) > self.slots.len() {
            self.grow();
        }
        let slot = self.slot(texel);
        if self.slots[slot].0 == EMPTY {
            self.slots[slot].0 = texel;
            self.used.push(texel);
        }
        self.slots[slot].1 += weight;
    }

    fn slot(&self, texel: u32) -> usize {
        let mask = self.slots.len() - 1;
        // Fibonacci hashing: neighbours in a line or column spread.
        let mut slot = ((u64::from(texel) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize & mask;
        while self.slots[slot].0 != EMPTY && self.slots[slot].0 != texel {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let old = std::mem::take(&mut self.slots);
        self.slots = vec![(EMPTY, 0.0); (2 * old.len()).max(64)];
        for (texel, weight) in old.into_iter().filter(|s| s.0 != EMPTY) {
            let slot = self.slot(texel);
            self.slots[slot] = (texel, weight);
        }
    }

    fn drain(&mut self, mut put: impl FnMut(u32, f64)) {
        for i in 0..self.used.len() {
            let texel = self.used[i];
            let slot = self.slot(texel);
            put(texel, self.slots[slot].1);
        }
        if self.used.len() * 8 < self.slots.len() {
            // All slots first: an emptied one would hide what was pushed past it.
            let slots: Vec<usize> = self.used.iter().map(|t| self.slot(*t)).collect();
            slots.into_iter().for_each(|s| self.slots[s] = (EMPTY, 0.0));
        } else {
            self.slots.fill((EMPTY, 0.0));
        }
        self.used.clear();
    }
}

/// What a line of the image says of maps.
#[derive(Debug, Default)]
pub(super) struct MapLine {
    /// For each term and map.
    pub(super) weights: Vec<Vec<TexelLine>>,
    /// For each term.
    pub(super) unknown: Vec<Vec<f64>>,
    pub(super) unfilled: Vec<Vec<f64>>,
    pub(super) area: Vec<f64>,
    /// Angle between the directions of map and camera, deg; NaN if no map has one, or nothing is seen.
    pub(super) angle_deg: Vec<f64>,
    /// Share of what is seen that all terms know.
    pub(super) coverage: Vec<f64>,
    pub(super) quadrature_error: f64,
}

/// Looks maps up, pixel by pixel.
pub(super) struct Looker<'a> {
    scene: &'a Scene,
    terms: Vec<Vec<Lookup<'a>>>,
    together: Together,
    choice: Choice,
    unknown: Unknown,
    /// Of the entry at hand: see [`Looker::measure_angles`] and [`measure_shares`].
    angles: Vec<Vec<f64>>,
    shares: Vec<f64>,
    /// Lit area of the entry at hand that no map knows, for each source known by parts.
    lit_rest: Vec<f64>,
    parts: Vec<Part>,
}

impl<'a> Looker<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        drawing: &'a Drawing<'a>,
        maps: &Maps,
        prepared: &'a [Vec<Prepared<'a>>],
        polygons: &'a [Vec<Option<Polygons<'a>>>],
    ) -> Self {
        let lookups = |(views, polygons): (&'a Vec<Prepared<'a>>, &'a Vec<Option<Polygons<'a>>>)| {
            let one = |(p, polygons): (&'a Prepared<'a>, &'a Option<Polygons<'a>>)| {
                Lookup::new(scene, drawing, p, polygons.as_ref(), maps.texels)
            };
            views.iter().zip(polygons).map(one).collect()
        };
        let terms: Vec<Vec<Lookup>> = prepared.iter().zip(polygons).map(lookups).collect();
        let angles = terms.iter().map(|views| vec![f64::NAN; views.len()]).collect();
        let (together, choice, unknown) = (Together::default(), maps.choice, maps.unknown);
        Looker { scene, terms, together, choice, unknown, angles, shares: vec![], lit_rest: vec![], parts: vec![] }
    }

    pub(super) fn new_line(&mut self, row: u32) -> MapLine {
        for lookup in self.terms.iter_mut().flatten() {
            lookup.new_line(row);
        }
        MapLine {
            weights: self.terms.iter().map(|t| vec![TexelLine::default(); t.len()]).collect(),
            unknown: vec![vec![]; self.terms.len()],
            unfilled: vec![vec![]; self.terms.len()],
            ..MapLine::default()
        }
    }

    /// Adds what a pixel sees, whose pieces have been sorted. `solved(entry, area, lit)` is called with what is left for the scene's own
    /// sources: of the entry, and of what each lights that is known by parts.
    pub(super) fn gather(
        &mut self,
        pixel: &mut Pixel,
        line: &mut MapLine,
        mut solved: impl FnMut(&Entry, f64, &[Part]),
    ) {
        let mut front = 0.0;
        let (mut angle_sum, mut angle_area) = (0.0, 0.0);
        let (mut unknown, mut unfilled) = (vec![0.0; self.terms.len()], vec![0.0; self.terms.len()]);
        for index in 0..pixel.entries.len() {
            let entry = pixel.entries[index];
            if !entry.front {
                continue;
            }
            front += entry.shown.area;
            self.measure_angles(pixel, &entry);
            let angles = &self.angles;
            let wants_lit = self.unknown == Unknown::Solved;
            for (t, views) in self.terms.iter_mut().enumerate() {
                views.iter_mut().for_each(|lookup| lookup.look(pixel, index, wants_lit));
                let is_divided = differ(views, &angles[t], self.choice, entry.shown.area);
                let most = if is_divided {
                    let together = &mut self.together;
                    together.look(pixel, index, views, &angles[t], self.choice, wants_lit);
                    self.lit_rest.clone_from(&together.lit_rest);
                    together.area.iter().sum::<f64>().min(entry.shown.area)
                } else {
                    let knows_most = views.iter().max_by(|a, b| a.seen.area.total_cmp(&b.seen.area));
                    let Some(Lookup { seen, lit, .. }) = knows_most else { continue };
                    let most = seen.area.min(entry.shown.area);
                    let known = |light: usize| if most > 0.0 { lit[light].area } else { 0.0 };
                    let rest = |light: usize| pixel.lit_part(&entry, light).area - known(light);
                    self.lit_rest.clear();
                    self.lit_rest.extend((0..lit.len()).map(rest));
                    most
                };
                let rest = entry.shown.area - most.max(0.0);
                unknown[t] += rest;
                let target = match self.unknown {
                    Unknown::Mean if most >= LEAST_KNOWN * entry.shown.area => entry.shown.area,
                    Unknown::Mean => 0.0,
                    Unknown::Left | Unknown::Solved => most.max(0.0),
                };
                unfilled[t] += entry.shown.area - target;
                if rest > 0.0 && self.unknown == Unknown::Solved {
                    let parts = self.lit_rest.iter().map(|lit| Part { area: lit.clamp(0.0, rest), ..Part::default() });
                    self.parts.clear();
                    self.parts.extend(parts);
                    solved(&entry, rest, &self.parts);
                }
                if target <= 0.0 {
                    continue;
                }
                if is_divided {
                    let scale = target / self.together.area.iter().sum::<f64>();
                    for (view, texel, weight) in &self.together.texels {
                        views[*view].sums.add(*texel, scale * weight);
                    }
                    for (area, angle) in self.together.area.iter().zip(&angles[t]).filter(|(_, a)| a.is_finite()) {
                        angle_sum += scale * area * angle;
                        angle_area += scale * area;
                    }
                    continue;
                }
                measure_shares(views, &angles[t], self.choice, &mut self.shares);
                let known: f64 = self.shares.iter().zip(views.iter()).map(|(g, v)| g * v.seen.area).sum();
                for ((lookup, share), angle) in views.iter_mut().zip(&self.shares).zip(&angles[t]) {
                    if *share == 0.0 {
                        continue;
                    }
                    let scale = share * target / known;
                    let Lookup { seen, sums, .. } = lookup;
                    seen.texels.iter().for_each(|(texel, weight)| sums.add(*texel, scale * weight));
                    if angle.is_finite() {
                        angle_sum += scale * lookup.seen.area * angle;
                        angle_area += scale * lookup.seen.area;
                    }
                }
            }
        }
        for (views, weights) in self.terms.iter_mut().zip(&mut line.weights) {
            for (lookup, weights) in views.iter_mut().zip(weights) {
                weights.row_start.push(weights.texel.len());
                lookup.sums.drain(|texel, weight| {
                    if weight > REMAINDER {
                        weights.texel.push(texel);
                        weights.weight.push(weight);
                    }
                });
                line.quadrature_error = line.quadrature_error.max(lookup.quadrature_error);
            }
        }
        let most_unknown = unknown.iter().copied().fold(0.0, f64::max);
        line.coverage.push(if front > 0.0 { ((front - most_unknown) / front).clamp(0.0, 1.0) } else { f64::NAN });
        line.angle_deg.push(if angle_area > 0.0 { (angle_sum / angle_area).to_degrees() } else { f64::NAN });
        line.area.push(front);
        line.unknown.iter_mut().zip(unknown).for_each(|(line, u)| line.push(u));
        line.unfilled.iter_mut().zip(unfilled).for_each(|(line, u)| line.push(u));
    }

    /// For each term and map the angle between its direction and that to the camera, rad, where what is seen of a facet lies.
    fn measure_angles(&mut self, pixel: &Pixel, entry: &Entry) {
        let [x, y] = entry.centroid(&pixel.rect);
        let camera = &self.scene.exposure.camera;
        let ray = camera.ray(x, y);
        let facet = self.scene.body.mesh.facet(entry.facet as usize);
        let point_m = camera.centre_m() + facet.met_by(camera.centre_m(), ray) * ray;
        let of = |lookup: &Lookup| match lookup.kind {
            Kind::View(image, _) => match image.eye {
                Eye::At(eye_m) => angle_rad(eye_m - point_m, -ray),
                Eye::Towards(direction) => angle_rad(direction.vec(), -ray),
            },
            _ => f64::NAN,
        };
        for (angles, views) in self.angles.iter_mut().zip(&self.terms) {
            angles.iter_mut().zip(views).for_each(|(angle, lookup)| *angle = of(lookup));
        }
    }
}

/// How much each map counts for a facet, relative to each other. One that knows less than [`LEAST_KNOWN`] of what the best one
/// knows does not count; one without a direction only if no other does.
fn measure_shares(views: &[Lookup], angles: &[f64], choice: Choice, shares: &mut Vec<f64>) {
    shares.clear();
    shares.resize(views.len(), 0.0);
    if let ([view], [share]) = (views, &mut shares[..]) {
        *share = if view.seen.area > 0.0 { 1.0 } else { 0.0 };
        return;
    }
    let most = views.iter().map(|view| view.seen.area).fold(0.0, f64::max);
    let known = |i: &usize| views[*i].seen.area > 0.0 && views[*i].seen.area >= LEAST_KNOWN * most;
    let knowing: Vec<usize> = (0..views.len()).filter(known).collect();
    knowing.iter().zip(views_shares(&knowing, angles, choice)).for_each(|(i, share)| shares[*i] = share);
}

/// How much each of some maps counts that all know the same, relative to each other.
pub(super) fn views_shares(knowing: &[usize], angles: &[f64], choice: Choice) -> Vec<f64> {
    let Some(nearest) = knowing.iter().copied().min_by(|a, b| angles[*a].total_cmp(&angles[*b])) else { return vec![] };
    if choice == Choice::Nearest || angles[nearest].is_nan() || angles[nearest] == 0.0 {
        return knowing.iter().map(|i| if *i == nearest { 1.0 } else { 0.0 }).collect();
    }
    // Relative to the nearest, so that small angles do not overflow.
    knowing.iter().map(|i| if angles[*i].is_finite() { (angles[nearest] / angles[*i]).powi(2) } else { 0.0 }).collect()
}

/// Whether some facet of a scene lies, in part, within an image of it: its bounds do.
pub fn meets(image: &ViewImage, scene: &Scene) -> bool {
    let frame = Rect { min: [0.0; 2], max: [image.columns as f64, image.rows as f64] };
    (0..scene.body.mesh.facets.len()).any(|f| {
        let corners = scene.body.mesh.facet(f).corners_m.map(|p| image.projection.homogeneous(p));
        let in_front = corners.iter().filter(|c| c.z > 0.0).count();
        // What reaches behind the eye may be anywhere.
        in_front > 0 && (in_front < 3 || Rect::of(&corners.map(|c| [c.x / c.z, c.y / c.z])).overlaps(&frame))
    })
}
