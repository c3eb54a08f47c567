//! The lit part of what a pixel sees of a facet: sunlit polygons carried from the Sun's view into the image.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::geometry::Mesh;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect, holds, intersect};
use crate::product::{Lit, Sunlit};
use crate::scene::FrameCamera;

/// Facets with more lit polygons than this keep them sorted for the image line at hand.
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
    /// Area that a part of the facet's image (counter-clockwise) has in the window.
    fn common_area(&self, part: &[Point], common: &mut Vec<Point>, spare: &mut Vec<Point>) -> f64 {
        match self {
            Window::Facet => return area(part),
            Window::Rect { rect, .. } => clip_to_rect(part, rect, common, spare),
            Window::Piece(piece) => intersect(part, piece, common, spare),
        }
        area(common).max(0.0)
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

/// Computes lit areas in the image.
pub(super) struct LitArea<'a> {
    mesh: &'a Mesh,
    camera: &'a FrameCamera,
    sunlit: &'a Sunlit,
    /// First lit polygon of each facet; one more element than facets.
    first: &'a [u32],
    is_cut: Box<dyn Fn(u32) -> bool + Send + 'a>,
    row: u32,
    /// Of facets with many lit polygons: those that reach the line at hand, by their left border.
    line: BTreeMap<u32, Vec<(Rect, Vec<Point>)>>,
    /// Of the facet looked at last: its lit polygons in the image, each with its bounds and where it ends in `mapped`.
    last: Option<u32>,
    reach: Vec<(Rect, usize)>,
    mapped: Vec<Point>,
    common: Vec<Point>,
    spare: Vec<Point>,
}

/// First lit polygon of each facet, and the number of polygons as the last element.
pub(super) fn first_polygons(sunlit: &Sunlit) -> Vec<u32> {
    let mut first = vec![0u32; sunlit.lit.len() + 1];
    for f in &sunlit.polygon_facet {
        first[*f as usize + 1] += 1;
    }
    for i in 1..first.len() {
        first[i] += first[i - 1];
    }
    first
}

impl<'a> LitArea<'a> {
    pub(super) fn new(
        mesh: &'a Mesh,
        camera: &'a FrameCamera,
        sunlit: &'a Sunlit,
        first: &'a [u32],
        is_cut: impl Fn(u32) -> bool + Send + 'a,
    ) -> Self {
        LitArea {
            mesh,
            camera,
            sunlit,
            first,
            is_cut: Box::new(is_cut),
            row: 0,
            line: BTreeMap::new(),
            last: None,
            reach: vec![],
            mapped: vec![],
            common: vec![],
            spare: vec![],
        }
    }

    pub(super) fn new_line(&mut self, row: u32) {
        self.row = row;
        self.line.clear();
    }

    /// Lit area, pixels, of what `window` shows of a facet's image; `seen` is the area of all that it shows.
    pub(super) fn of(&mut self, facet: u32, window: &Window, seen: f64) -> f64 {
        match self.sunlit.lit[facet as usize] {
            Lit::Dark => return 0.0,
            Lit::Full => return seen,
            Lit::Part => {}
        }
        let polygons = self.first[facet as usize] as usize..self.first[facet as usize + 1] as usize;
        let mut lit = 0.0;
        if (self.is_cut)(facet) {
            self.last = None;
            let view = FacetView::new(self.mesh, self.camera, facet);
            // Corners of the facet have no place in the image: meet on the facet instead, and come back.
            let mut on_facet: Vec<Point> = window.outline().iter().map(|p| view.uv(*p)).collect();
            counter_clockwise(&mut on_facet);
            for i in polygons {
                self.mapped.clear();
                self.mapped.extend_from_slice(polygon(self.sunlit, i));
                counter_clockwise(&mut self.mapped);
                intersect(&self.mapped, &on_facet, &mut self.common, &mut self.spare);
                let back: Vec<Point> = self.common.iter().map(|p| view.image(*p)).collect();
                lit += area(&back).abs();
            }
        } else if polygons.len() > MANY {
            let view = FacetView::new(self.mesh, self.camera, facet);
            let bounds = window.bounds();
            let (mut common, mut spare) = (std::mem::take(&mut self.common), std::mem::take(&mut self.spare));
            for (reach, mapped) in self.line_polygons(facet, &view, polygons) {
                if reach.min[0] >= bounds.max[0] {
                    break;
                }
                if reach.overlaps(&bounds) {
                    lit += window.common_area(mapped, &mut common, &mut spare);
                }
            }
            (self.common, self.spare) = (common, spare);
        } else {
            if self.last != Some(facet) {
                self.map(&FacetView::new(self.mesh, self.camera, facet), polygons);
                self.last = Some(facet);
            }
            let bounds = window.bounds();
            let mut start = 0;
            for (reach, end) in &self.reach {
                if reach.overlaps(&bounds) {
                    lit += window.common_area(&self.mapped[start..*end], &mut self.common, &mut self.spare);
                }
                start = *end;
            }
        }
        lit.min(seen)
    }

    /// Maps lit polygons into the image.
    fn map(&mut self, view: &FacetView, polygons: std::ops::Range<usize>) {
        self.mapped.clear();
        self.reach.clear();
        for i in polygons {
            let start = self.mapped.len();
            self.mapped.extend(polygon(self.sunlit, i).iter().map(|p| view.image(*p)));
            counter_clockwise(&mut self.mapped[start..]);
            self.reach.push((Rect::of(&self.mapped[start..]), self.mapped.len()));
        }
    }

    /// Whether a facet is lit at an image point that sees it.
    pub(super) fn is_lit_at(&self, facet: u32, at: Point) -> bool {
        match self.sunlit.lit[facet as usize] {
            Lit::Dark => false,
            Lit::Full => true,
            Lit::Part => {
                let uv = FacetView::new(self.mesh, self.camera, facet).uv(at);
                let polygons = self.first[facet as usize] as usize..self.first[facet as usize + 1] as usize;
                polygons.into_iter().any(|i| {
                    let mut p = polygon(self.sunlit, i).to_vec();
                    counter_clockwise(&mut p);
                    holds(&p, uv)
                })
            }
        }
    }

    fn line_polygons(
        &mut self,
        facet: u32,
        view: &FacetView,
        polygons: std::ops::Range<usize>,
    ) -> &[(Rect, Vec<Point>)] {
        let (sunlit, low, high) = (self.sunlit, f64::from(self.row), f64::from(self.row) + 1.0);
        self.line.entry(facet).or_insert_with(|| {
            let mut reaching: Vec<(Rect, Vec<Point>)> = polygons
                .filter_map(|i| {
                    let mut mapped: Vec<Point> = polygon(sunlit, i).iter().map(|p| view.image(*p)).collect();
                    counter_clockwise(&mut mapped);
                    let reach = Rect::of(&mapped);
                    (reach.min[1] < high && reach.max[1] > low).then_some((reach, mapped))
                })
                .collect();
            reaching.sort_by(|a, b| a.0.min[0].total_cmp(&b.0.min[0]));
            reaching
        })
    }
}

fn polygon(sunlit: &Sunlit, i: usize) -> &[Point] {
    &sunlit.uv[sunlit.polygon_start[i] as usize..sunlit.polygon_start[i + 1] as usize]
}

fn counter_clockwise(polygon: &mut [Point]) {
    if area(polygon) < 0.0 {
        polygon.reverse();
    }
}

/// A facet as the camera sees it: sensor axes, lengths in pixels of the image plane.
struct FacetView {
    /// Corner a and the edges to b and c: (x, y) times pixels per tangent, depth m.
    a: DVec3,
    to_b: DVec3,
    to_c: DVec3,
    centre: Point,
}

impl FacetView {
    fn new(mesh: &Mesh, camera: &FrameCamera, facet: u32) -> Self {
        let sensor_from_world = camera.world_from_sensor.rotation.transpose();
        let stretch = DVec3::new(1.0 / camera.pitch, 1.0 / camera.pitch, 1.0);
        let [a, b, c] =
            mesh.facet(facet as usize).corners_m.map(|p| sensor_from_world * (p - camera.centre_m()) * stretch);
        FacetView { a, to_b: b - a, to_c: c - a, centre: camera.boresight_px() }
    }

    /// Image of the point (u, v) of the facet.
    fn image(&self, [u, v]: Point) -> Point {
        let p = self.a + u * self.to_b + v * self.to_c;
        [p.x / p.z + self.centre[0], p.y / p.z + self.centre[1]]
    }

    /// The point (u, v) of the facet's plane that an image point sees.
    fn uv(&self, [x, y]: Point) -> Point {
        let ray = DVec3::new(x - self.centre[0], y - self.centre[1], 1.0);
        let p = ray.cross(self.to_c);
        let q = -self.a.cross(self.to_b);
        let det = p.dot(self.to_b);
        [-p.dot(self.a) / det, ray.dot(q) / det]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{MaterialId, Pose};

    #[test]
    fn image_and_facet_coordinates_are_inverse() {
        let mesh = Mesh {
            vertices_m: vec![DVec3::new(-3.0, 1.0, 20.0), DVec3::new(5.0, 2.0, 30.0), DVec3::new(0.5, -4.0, 25.0)],
            facets: vec![[0, 1, 2]],
            material: vec![MaterialId(0)],
            face_of_facet: vec![],
        };
        let camera = FrameCamera { world_from_sensor: Pose::IDENTITY, samples: 8, lines: 6, pitch: 0.1 };
        let view = FacetView::new(&mesh, &camera, 0);
        // Corner a: x = -3/20/0.1 + 4, y = 1/20/0.1 + 3.
        let corner = view.image([0.0, 0.0]);
        assert!((corner[0] - 2.5).abs() < 1e-14 && (corner[1] - 3.5).abs() < 1e-14);
        for uv in [[0.0, 0.0], [0.25, 0.5], [1.0, 0.0], [-1.0, 0.3]] {
            let back = view.uv(view.image(uv));
            assert!((back[0] - uv[0]).abs() < 1e-13 && (back[1] - uv[1]).abs() < 1e-13, "{uv:?} {back:?}");
        }
    }
}
