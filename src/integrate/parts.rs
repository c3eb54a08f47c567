//! Convex parts of facets (what the Sun lights, what another camera sees, what a texel covers), carried into the image and cut
//! with what a pixel sees.

use std::collections::BTreeMap;

use crate::geometry::Mesh;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect, intersect};
use crate::product::Patches;
use crate::visibility::Seen;
use crate::visibility::{Drawing, OnFacet, View};

/// Facets with more parts than this keep them sorted for the image line at hand.
const MANY: usize = 16;

/// The part of a facet's image that is looked at.
pub(super) enum Window<'a> {
    /// All of it.
    Facet,
    /// What lies in a rectangle, for a facet whose image is `outline`, counter-clockwise.
    Rect { rect: &'a Rect, outline: &'a [Point] },
    /// A piece of it, counter-clockwise.
    Piece(&'a [Point]),
}

impl Window<'_> {
    /// What a part of the facet's image (counter-clockwise) has in the window.
    #[inline]
    fn common<'p>(&self, part: &'p [Point], common: &'p mut Vec<Point>, spare: &mut Vec<Point>) -> &'p [Point] {
        match self {
            Window::Facet => return part,
            Window::Rect { rect, .. } => clip_to_rect(part, rect, common, spare),
            Window::Piece(piece) => intersect(part, piece, common, spare),
        }
        common
    }

    fn outline(&self) -> Vec<Point> {
        match self {
            Window::Facet => vec![],
            Window::Rect { rect, outline } => {
                let (mut out, mut spare) = (vec![], vec![]);
                clip_to_rect(outline, rect, &mut out, &mut spare);
                out
            }
            Window::Piece(piece) => piece.to_vec(),
        }
    }

    fn bounds(&self) -> Rect {
        match self {
            Window::Facet => Rect { min: [f64::NEG_INFINITY; 2], max: [f64::INFINITY; 2] },
            Window::Rect { rect, .. } => **rect,
            Window::Piece(piece) => Rect::of(piece),
        }
    }
}

/// Convex polygons on facets, in (u, v).
#[derive(Debug)]
pub(super) struct Polygons<'a> {
    /// First polygon of each [`BLOCK`] of facets, and the number of polygons as the last element.
    first: Vec<usize>,
    /// The facet of each polygon, ascending.
    facet: &'a [u32],
    start: &'a [usize],
    uv: &'a [Point],
    /// Of each polygon, if they are of several eyes.
    share: &'a [f64],
}

/// Facets whose polygons are looked up together: most have none, so that a place for each would cost more memory than all polygons.
const BLOCK: usize = 32;

impl<'a> Polygons<'a> {
    /// What is lit, or seen.
    pub(super) fn of_seen(seen: &'a Seen) -> Self {
        let polygons = Self::new(seen.shown.len(), &seen.polygon_facet, &seen.polygon_start, &seen.uv);
        Polygons { share: &seen.polygon_share, ..polygons }
    }

    /// Texels on `facets` facets.
    pub(super) fn of_patches(facets: usize, patches: &'a Patches) -> Self {
        Self::new(facets, &patches.polygon_facet, &patches.polygon_start, &patches.uv)
    }

    fn new(facets: usize, facet: &'a [u32], start: &'a [usize], uv: &'a [Point]) -> Self {
        let mut first = Vec::with_capacity(facets.div_ceil(BLOCK) + 1);
        let mut at = 0;
        for block in 0..=facets.div_ceil(BLOCK) {
            at += facet[at..].iter().take_while(|f| (**f as usize) < block * BLOCK).count();
            first.push(at);
        }
        Polygons { first, facet, start, uv, share: &[] }
    }

    fn of(&self, facet: u32) -> std::ops::Range<usize> {
        let block = facet as usize / BLOCK;
        let (first, end) = (self.first[block], self.first[block + 1]);
        let of_block = &self.facet[first..end];
        first + of_block.partition_point(|f| *f < facet)..first + of_block.partition_point(|f| *f <= facet)
    }

    fn uv(&self, i: usize) -> &'a [Point] {
        &self.uv[self.start[i]..self.start[i + 1]]
    }

    /// The share that a polygon's eye has in what several see together; 1 of a single eye.
    #[inline]
    pub(super) fn share(&self, i: usize) -> f64 {
        self.share.get(i).copied().unwrap_or(1.0)
    }
}

/// Parts in the image, and working memory.
pub(super) struct Parts<'a> {
    drawing: &'a Drawing<'a>,
    polygons: &'a Polygons<'a>,
    /// Rows of cells of the line at hand: the first, and the one after the last.
    rows: [u32; 2],
    /// Of facets with many parts: those that reach the line at hand, by their left border.
    line: BTreeMap<u32, Vec<Reaching>>,
    /// Of the facet looked at last: its parts in the image, each with its bounds and where it ends in `mapped`.
    last: Option<u32>,
    reach: Vec<(Rect, usize)>,
    mapped: Vec<Point>,
    common: Vec<Point>,
    spare: Vec<Point>,
}

/// A part in the image: its bounds, its number, its outline.
type Reaching = (Rect, usize, Vec<Point>);

impl<'a> Parts<'a> {
    pub(super) fn new(drawing: &'a Drawing<'a>, polygons: &'a Polygons<'a>) -> Self {
        Parts {
            drawing,
            polygons,
            rows: [0; 2],
            line: BTreeMap::new(),
            last: None,
            reach: vec![],
            mapped: vec![],
            common: vec![],
            spare: vec![],
        }
    }

    pub(super) fn new_line(&mut self, rows: [u32; 2]) {
        self.rows = rows;
        self.line.clear();
    }

    fn on_facet(&self, facet: u32) -> OnFacet {
        on_facet(self.drawing.mesh(), &self.drawing.view, facet)
    }

    /// Calls `put` with the number of each part of a facet and what of it `window` shows, counter-clockwise, in the image.
    #[inline]
    pub(super) fn each(&mut self, facet: u32, window: &Window, mut put: impl FnMut(usize, &[Point])) {
        let polygons = self.polygons.of(facet);
        if self.drawing.is_cut(facet) {
            self.last = None;
            let view = self.on_facet(facet);
            // Corners of the facet have no place in the image: meet on the facet instead, and come back.
            let mut within: Vec<Point> = window.outline().iter().map(|p| view.uv(*p)).collect();
            counter_clockwise(&mut within);
            for i in polygons {
                self.mapped.clear();
                self.mapped.extend_from_slice(self.polygons.uv(i));
                counter_clockwise(&mut self.mapped);
                intersect(&self.mapped, &within, &mut self.common, &mut self.spare);
                self.mapped.clear();
                self.mapped.extend(self.common.iter().map(|p| view.drawn(*p)));
                counter_clockwise(&mut self.mapped);
                put(i, &self.mapped);
            }
        } else if polygons.len() > MANY {
            let bounds = window.bounds();
            let (mut common, mut spare) = (std::mem::take(&mut self.common), std::mem::take(&mut self.spare));
            for (reach, i, mapped) in self.line_parts(facet, polygons) {
                if reach.min[0] >= bounds.max[0] {
                    break;
                }
                if reach.overlaps(&bounds) {
                    put(*i, window.common(mapped, &mut common, &mut spare));
                }
            }
            (self.common, self.spare) = (common, spare);
        } else {
            if self.last != Some(facet) {
                self.map(facet, polygons.clone());
                self.last = Some(facet);
            }
            let bounds = window.bounds();
            let mut start = 0;
            for (i, (reach, end)) in polygons.zip(&self.reach) {
                if reach.overlaps(&bounds) {
                    put(i, window.common(&self.mapped[start..*end], &mut self.common, &mut self.spare));
                }
                start = *end;
            }
        }
    }

    /// Maps the parts of a facet into the image.
    fn map(&mut self, facet: u32, polygons: std::ops::Range<usize>) {
        let view = self.on_facet(facet);
        self.mapped.clear();
        self.reach.clear();
        for i in polygons {
            let start = self.mapped.len();
            self.mapped.extend(self.polygons.uv(i).iter().map(|p| view.drawn(*p)));
            counter_clockwise(&mut self.mapped[start..]);
            self.reach.push((Rect::of(&self.mapped[start..]), self.mapped.len()));
        }
    }

    fn line_parts(&mut self, facet: u32, polygons: std::ops::Range<usize>) -> &[Reaching] {
        let [low, high] = self.rows.map(f64::from);
        let view = self.on_facet(facet);
        let uv = self.polygons;
        self.line.entry(facet).or_insert_with(|| {
            let mut reaching: Vec<Reaching> = polygons
                .filter_map(|i| {
                    let mut mapped: Vec<Point> = uv.uv(i).iter().map(|p| view.drawn(*p)).collect();
                    counter_clockwise(&mut mapped);
                    let reach = Rect::of(&mapped);
                    (reach.min[1] < high && reach.max[1] > low).then_some((reach, i, mapped))
                })
                .collect();
            reaching.sort_by(|a, b| a.0.min[0].total_cmp(&b.0.min[0]));
            reaching
        })
    }
}

/// Where the image shows which point of a facet.
pub(super) fn on_facet(mesh: &Mesh, view: &View, facet: u32) -> OnFacet {
    OnFacet::new(view, &mesh.facet(facet as usize))
}

fn counter_clockwise(polygon: &mut [Point]) {
    if area(polygon) < 0.0 {
        polygon.reverse();
    }
}
