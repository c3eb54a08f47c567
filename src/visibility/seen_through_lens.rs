//! What a camera with a lens sees of each facet: of what its pinhole sees, that which lies in its pixels.

use super::{Drawing, OnFacet, Seen, Shown};
use crate::geometry::polygon::{Point, Rect, area, intersect};
use crate::geometry::{Drawn, index_u32};

/// All of a facet, (u, v).
const WHOLE: [Point; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
/// A facet of which clipping leaves all but this share is whole.
const ROUNDING: f64 = 1e-12;

/// A pixel, and around it.
type Pixel = (Rect, [Point; 4]);

/// The pixels of an image in a drawing: quadrilaterals that fit together, line by line, and a rectangle that lies inside all of them.
struct Pixels {
    lines: Vec<(Rect, Vec<Pixel>)>,
    inner: Rect,
}

impl Pixels {
    /// `by`: cells of the drawing for a cell of the pinhole.
    fn new(drawn: &Drawn<'_>, [samples, lines]: [u32; 2], by: [f64; 2]) -> Self {
        let corner = |sample: u32, line: u32| {
            let at = drawn.at([f64::from(sample), f64::from(line)]);
            [at[0] * by[0], at[1] * by[1]]
        };
        let mut above: Vec<Point> = (0..=samples).map(|sample| corner(sample, 0)).collect();
        let mut inner = Rect { min: [f64::NEG_INFINITY; 2], max: [f64::INFINITY; 2] };
        let mut side = |axis: usize, from: f64, to: f64| {
            inner.min[axis] = inner.min[axis].max(from);
            inner.max[axis] = inner.max[axis].min(to);
        };
        above.iter().for_each(|at| side(1, at[1], f64::INFINITY));
        let mut all = Vec::new();
        for line in 1..=lines {
            let below: Vec<Point> = (0..=samples).map(|sample| corner(sample, line)).collect();
            for row in [&above, &below] {
                side(0, row[0][0], row[row.len() - 1][0]);
            }
            let quads = (0..samples as usize).map(|i| {
                let mut quad = [above[i], above[i + 1], below[i + 1], below[i]];
                if area(&quad) < 0.0 {
                    quad.reverse();
                }
                (Rect::of(&quad), quad)
            });
            let quads: Vec<_> = quads.collect();
            let corners: Vec<Point> = above.iter().chain(&below).copied().collect();
            all.push((Rect::of(&corners), quads));
            above = below;
        }
        above.iter().for_each(|at| side(1, f64::NEG_INFINITY, at[1]));
        Pixels { lines: all, inner }
    }

    /// The parts of a counter-clockwise polygon that lie in pixels.
    fn each_part(&self, polygon: &[Point], mut put: impl FnMut(&[Point])) {
        let (bounds, mut common, mut spare) = (Rect::of(polygon), vec![], vec![]);
        for (_, quads) in self.lines.iter().filter(|(line, _)| line.overlaps(&bounds)) {
            for (_, quad) in quads.iter().filter(|(rect, _)| rect.overlaps(&bounds)) {
                intersect(polygon, quad, &mut common, &mut spare);
                if area(&common) > 0.0 {
                    put(&common);
                }
            }
        }
    }
}

/// Of what a drawing shows, what lies in the pixels of the camera that it is drawn for; `by`: cells of the drawing for a cell of the pinhole.
pub(super) fn in_pixels(seen: &Seen, drawing: &Drawing, drawn: &Drawn<'_>, size: [u32; 2], by: [f64; 2]) -> Seen {
    let pixels = Pixels::new(drawn, size, by);
    let mut all = Seen { polygon_start: vec![0], ..Seen::default() };
    for (i, shown) in seen.shown.iter().enumerate() {
        let facet = index_u32(i);
        let whole = [&WHOLE[..]];
        let polygons: Vec<&[Point]> = match shown {
            Shown::Nothing => vec![],
            Shown::Whole => whole.to_vec(),
            Shown::Part => seen.polygons(facet).collect(),
        };
        if polygons.is_empty() {
            all.shown.push(Shown::Nothing);
            continue;
        }
        let frame = OnFacet::new(&drawing.view, &drawing.mesh().facet(i));
        let (mut before, mut after) = (0.0, 0.0);
        let mut parts: Vec<Vec<Point>> = Vec::new();
        for polygon in polygons {
            let mut in_drawing: Vec<Point> = polygon.iter().map(|uv| frame.drawn(*uv)).collect();
            if area(&in_drawing) < 0.0 {
                in_drawing.reverse();
            }
            before += area(&in_drawing);
            if pixels.inner.contains(&Rect::of(&in_drawing)) {
                after += area(&in_drawing);
                parts.push(polygon.to_vec());
                continue;
            }
            pixels.each_part(&in_drawing, |part| {
                after += area(part);
                parts.push(part.iter().map(|p| frame.uv(*p)).collect());
            });
        }
        let is_whole = *shown == Shown::Whole && after >= before * (1.0 - ROUNDING);
        all.shown.push(match parts.is_empty() {
            _ if is_whole => Shown::Whole,
            true => Shown::Nothing,
            false => Shown::Part,
        });
        if !is_whole {
            for part in parts {
                all.uv.extend(part);
                all.polygon_facet.push(facet);
                all.polygon_start.push(all.uv.len());
            }
        }
    }
    all
}
