//! Labels beside marks, where they overlap nothing.

use super::{Anchor, Colour, Drawing, text_width};

/// Boxes that are taken: left, top, right, bottom.
type Rect = [f64; 4];

/// What a label's place costs: a share of it over another label or outside, a share over marks and lines, and each step away from its mark.
const OVER_LABEL: f64 = 40.0;
const ACROSS: f64 = 4.0;
const FARTHER: f64 = 0.06;
/// What it costs that a label is nearer to another mark than to its own.
const MISLEADING: f64 = 2.0;

/// Places labels in a part of a drawing.
#[derive(Debug, Clone)]
pub struct Labels {
    inside: Rect,
    /// With how much an overlap counts.
    taken: Vec<(Rect, f64)>,
    marks: Vec<[f64; 2]>,
    size: f64,
}

impl Labels {
    /// Within a box, with letters of this size, px.
    pub fn new(inside: Rect, size: f64) -> Self {
        Labels { inside, taken: vec![], marks: vec![], size }
    }

    /// Keeps a box free of labels, as far as there is room near by.
    pub fn keep_free(&mut self, rect: Rect) {
        self.taken.push((rect, ACROSS));
    }

    /// Says where a mark is, before any label is placed.
    pub fn mark(&mut self, place: [f64; 2]) {
        self.marks.push(place);
    }

    /// Writes a label beside a point; from one that is farther away a thin line leads to it.
    pub fn place(&mut self, drawing: &mut Drawing, [x, y]: [f64; 2], colour: Colour, said: &str) {
        let (width, height) = (text_width(said, self.size, false), self.size);
        let mut best: Option<(f64, Rect, Anchor)> = None;
        for ring in 0..12 {
            let gap = 8.0 + 11.0 * f64::from(ring);
            for (dx, dy, anchor) in [
                (1.0, 0.0, Anchor::Start),
                (-1.0, 0.0, Anchor::End),
                (0.8, -0.8, Anchor::Start),
                (0.8, 0.8, Anchor::Start),
                (-0.8, -0.8, Anchor::End),
                (-0.8, 0.8, Anchor::End),
                (0.0, -1.3, Anchor::Middle),
                (0.0, 1.3, Anchor::Middle),
            ] {
                let (at_x, at_y) = (x + gap * dx, y + gap * dy);
                let left = match anchor {
                    Anchor::Start => at_x,
                    Anchor::Middle => at_x - 0.5 * width,
                    Anchor::End => at_x - width,
                };
                let rect = [left, at_y - 0.5 * height, left + width, at_y + 0.5 * height];
                let own = distance(&rect, [x, y]);
                let is_misleading =
                    self.marks.iter().any(|other| *other != [x, y] && distance(&rect, *other) < 1.2 * own);
                let misleading = if is_misleading { MISLEADING } else { 0.0 };
                let cost = self.cost(&rect) + FARTHER * f64::from(ring) + misleading;
                if best.as_ref().is_none_or(|(least, ..)| cost < *least - 1e-9) {
                    best = Some((cost, rect, anchor));
                }
            }
        }
        let Some((_, rect, anchor)) = best else { return };
        let [left, top, right, bottom] = rect;
        let near = nearest(&rect, [x, y]);
        if distance(&rect, [x, y]) > 16.0 {
            drawing.line(&[[x, y], near], colour, 0.7, 0.6);
        }
        let at_x = match anchor {
            Anchor::Start => left,
            Anchor::Middle => 0.5 * (left + right),
            Anchor::End => right,
        };
        // The baseline: letters reach some 0.74 of their size above it.
        drawing.text([at_x, bottom - 0.16 * self.size], anchor, self.size, colour, said);
        self.taken.push(([left - 3.0, top - 1.0, right + 3.0, bottom + 1.0], OVER_LABEL));
    }

    /// How badly a box lies: overlaps weigh most, as shares of it.
    fn cost(&self, rect: &Rect) -> f64 {
        let area = |r: &Rect| (r[2] - r[0]).max(0.0) * (r[3] - r[1]).max(0.0);
        let common = |a: &Rect, b: &Rect| area(&[a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]);
        let outside = area(rect) - common(rect, &self.inside);
        let overlaps: f64 = self.taken.iter().map(|(taken, weight)| weight * common(rect, taken)).sum();
        (OVER_LABEL * outside + overlaps) / area(rect).max(1.0)
    }
}

/// The point of a box that is nearest to one.
fn nearest([left, top, right, bottom]: &Rect, [x, y]: [f64; 2]) -> [f64; 2] {
    [x.clamp(*left, *right), y.clamp(*top, *bottom)]
}

fn distance(rect: &Rect, [x, y]: [f64; 2]) -> f64 {
    let near = nearest(rect, [x, y]);
    (near[0] - x).hypot(near[1] - y)
}

#[cfg(test)]
mod tests {
    use super::super::Shape;
    use super::*;

    #[test]
    fn labels_of_marks_in_one_place_do_not_overlap() {
        let mut drawing = Drawing::new(400.0, 300.0);
        let mut labels = Labels::new([0.0, 0.0, 400.0, 300.0], 11.0);
        for i in 0..12 {
            labels.place(&mut drawing, [200.0, 150.0], [0; 3], &format!("method number {i}"));
        }
        let boxes: Vec<Rect> = labels.taken.iter().map(|taken| taken.0).collect();
        assert_eq!(boxes.len(), 12);
        for (i, a) in boxes.iter().enumerate() {
            assert!(a[0] >= -3.0 && a[2] <= 403.0 && a[1] >= -1.0 && a[3] <= 301.0, "{a:?}");
            for b in &boxes[..i] {
                let apart = a[2] - 3.0 <= b[0] + 3.0
                    || b[2] - 3.0 <= a[0] + 3.0
                    || a[3] - 1.0 <= b[1] + 1.0
                    || b[3] - 1.0 <= a[1] + 1.0;
                assert!(apart, "{a:?} {b:?}");
            }
        }
        assert_eq!(drawing.shapes.iter().filter(|shape| matches!(shape, Shape::Text { .. })).count(), 12);
    }

    #[test]
    fn a_label_is_nearest_to_its_own_mark() {
        // 90 px apart in a row, with labels of some 126 px.
        let mut drawing = Drawing::new(400.0, 300.0);
        let mut labels = Labels::new([0.0, 0.0, 400.0, 300.0], 11.0);
        let marks = [100.0, 190.0, 280.0].map(|x| [x, 260.0]);
        marks.iter().for_each(|mark| labels.mark(*mark));
        for mark in marks.iter().rev() {
            labels.place(&mut drawing, *mark, [0; 3], "Sun's disc by 7 points");
        }
        for (mark, (rect, _)) in marks.iter().rev().zip(&labels.taken) {
            let of = |mark: &[f64; 2]| distance(rect, *mark);
            assert!(marks.iter().all(|other| other == mark || of(other) > of(mark)), "{mark:?} {rect:?}");
        }
    }
}
