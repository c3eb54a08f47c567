//! Drawings of a few kinds of shapes, as SVG and as PNG.
//!
//! Both are made of the same list of shapes, and widths of text are known beforehand: so labels can be placed where they do not overlap.

mod font;
mod labels;
mod log_axis;
mod raster;
mod svg;

pub use font::text_width;
pub use labels::Labels;
pub use log_axis::LogAxis;
pub(crate) use svg::escaped;

/// Red, green and blue.
pub type Colour = [u8; 3];

/// Where a text's given point is in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

/// The shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A disc.
    Disc,
    /// A square.
    Square,
    /// A triangle that stands on its base.
    Triangle,
    /// A square that stands on a corner.
    Diamond,
    /// A star of five points.
    Star,
    /// A plus.
    Plus,
}

/// A shape. Lengths are in px; y is down.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Line { points: Vec<[f64; 2]>, colour: Colour, width: f64, opacity: f64, dashes: bool },
    Area { points: Vec<[f64; 2]>, fill: Colour, opacity: f64, edge: Option<(Colour, f64)> },
    Text { at: [f64; 2], anchor: Anchor, size: f64, bold: bool, upwards: bool, colour: Colour, said: String },
}

/// A drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    size: [f64; 2],
    shapes: Vec<Shape>,
}

impl Drawing {
    /// An empty, white one.
    pub fn new(width: f64, height: f64) -> Self {
        let mut drawing = Drawing { size: [width, height], shapes: vec![] };
        drawing.rectangle([0.0, 0.0], [width, height], [255; 3], 1.0);
        drawing
    }

    /// Width and height, px.
    pub fn size(&self) -> [f64; 2] {
        self.size
    }

    /// A line through some points.
    pub fn line(&mut self, points: &[[f64; 2]], colour: Colour, width: f64, opacity: f64) {
        self.shapes.push(Shape::Line { points: points.to_vec(), colour, width, opacity, dashes: false });
    }

    /// A dashed line through some points.
    pub fn dashed(&mut self, points: &[[f64; 2]], colour: Colour, width: f64, opacity: f64) {
        self.shapes.push(Shape::Line { points: points.to_vec(), colour, width, opacity, dashes: true });
    }

    /// A filled rectangle between two corners.
    pub fn rectangle(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], fill: Colour, opacity: f64) {
        let points = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        self.shapes.push(Shape::Area { points, fill, opacity, edge: None });
    }

    /// A mark about a point, of this radius.
    pub fn mark(&mut self, [x, y]: [f64; 2], mark: Mark, radius: f64, fill: Colour) {
        let around = |n: u32, turn: f64, radius: &dyn Fn(u32) -> f64| -> Vec<[f64; 2]> {
            let at = |i: u32| {
                let angle = std::f64::consts::TAU * (f64::from(i) / f64::from(n) + turn);
                [x + radius(i) * angle.cos(), y + radius(i) * angle.sin()]
            };
            (0..n).map(at).collect()
        };
        let points = match mark {
            Mark::Disc => around(24, 0.0, &|_| radius),
            Mark::Square => around(4, 0.125, &|_| 1.2 * radius),
            Mark::Triangle => around(3, -0.25, &|_| 1.25 * radius),
            Mark::Diamond => around(4, 0.0, &|_| 1.25 * radius),
            Mark::Star => around(10, -0.25, &|i| if i % 2 == 0 { 1.5 * radius } else { 0.65 * radius }),
            Mark::Plus => {
                let (r, w) = (1.2 * radius, 0.4 * radius);
                let quarter = [[-w, -r], [w, -r], [w, -w]];
                let turned = |k: u32, [dx, dy]: [f64; 2]| match k {
                    0 => [x + dx, y + dy],
                    1 => [x - dy, y + dx],
                    2 => [x - dx, y - dy],
                    _ => [x + dy, y - dx],
                };
                (0..4).flat_map(|k| quarter.map(|p| turned(k, p))).collect()
            }
        };
        self.shapes.push(Shape::Area { points, fill, opacity: 1.0, edge: Some(([255; 3], 1.0)) });
    }

    /// A line of text.
    pub fn text(&mut self, at: [f64; 2], anchor: Anchor, size: f64, colour: Colour, said: &str) {
        self.shapes.push(Shape::Text { at, anchor, size, bold: false, upwards: false, colour, said: said.to_owned() });
    }

    /// A line of bold text.
    pub fn bold(&mut self, at: [f64; 2], anchor: Anchor, size: f64, colour: Colour, said: &str) {
        self.shapes.push(Shape::Text { at, anchor, size, bold: true, upwards: false, colour, said: said.to_owned() });
    }

    /// A line of text that is read from below.
    pub fn text_upwards(&mut self, at: [f64; 2], size: f64, colour: Colour, said: &str) {
        let anchor = Anchor::Middle;
        self.shapes.push(Shape::Text { at, anchor, size, bold: false, upwards: true, colour, said: said.to_owned() });
    }
}
