//! A drawing as PNG.

use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

use super::font::{outlines, text_width};
use super::{Anchor, Colour, Drawing, Shape};
use crate::geometry::whole_u32;

impl Drawing {
    /// As RGB, line by line, with this many pixels for a px; with its width and height. `None` for a drawing without an area.
    pub fn rgb(&self, scale: f64) -> Option<(Vec<u8>, [usize; 2])> {
        let [width, height] = self.size.map(|x| whole_u32((x * scale).ceil()));
        let mut pixels = Pixmap::new(width, height)?;
        for shape in &self.shapes {
            paint(&mut pixels, shape, single(scale));
        }
        let rgb = pixels.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
        Some((rgb, [width as usize, height as usize]))
    }
}

#[expect(clippy::cast_possible_truncation, reason = "places on a picture, to a millionth")]
fn single(x: f64) -> f32 {
    x as f32
}

fn brush([r, g, b]: Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, whole_u32(255.0 * opacity.clamp(0.0, 1.0)).try_into().unwrap_or(255));
    paint
}

fn paint(pixels: &mut Pixmap, shape: &Shape, scale: f32) {
    let to_pixels = Transform::from_scale(scale, scale);
    let stroke = |pixels: &mut Pixmap, path: &Path, colour, opacity, width, dashes: bool| {
        let dash = if dashes { StrokeDash::new(vec![5.0, 4.0], 0.0) } else { None };
        let stroke = Stroke {
            width: single(width),
            line_cap: LineCap::Butt,
            line_join: LineJoin::Round,
            dash,
            ..Stroke::default()
        };
        pixels.stroke_path(path, &brush(colour, opacity), &stroke, to_pixels, None);
    };
    match shape {
        Shape::Line { points, colour, width, opacity, dashes } => {
            if let Some(path) = path(points, false) {
                stroke(pixels, &path, *colour, *opacity, *width, *dashes);
            }
        }
        Shape::Area { points, fill, opacity, edge } => {
            if let Some(path) = path(points, true) {
                pixels.fill_path(&path, &brush(*fill, *opacity), FillRule::Winding, to_pixels, None);
                if let Some((colour, width)) = edge {
                    stroke(pixels, &path, *colour, 1.0, *width, false);
                }
            }
        }
        Shape::Text { at, anchor, size, bold, upwards, colour, said } => {
            let mut builder = Outline(PathBuilder::new());
            outlines(said, *size, *bold, &mut builder);
            let Some(path) = builder.0.finish() else { return };
            let width = text_width(said, *size, *bold);
            let before = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => 0.5 * width,
                Anchor::End => width,
            };
            let turn = if *upwards { Transform::from_rotate(-90.0) } else { Transform::identity() };
            let placed = Transform::from_translate(single(-before), 0.0)
                .post_concat(turn)
                .post_translate(single(at[0]), single(at[1]))
                .post_concat(to_pixels);
            pixels.fill_path(&path, &brush(*colour, 1.0), FillRule::Winding, placed, None);
        }
    }
}

fn path(points: &[[f64; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        match i {
            0 => builder.move_to(single(*x), single(*y)),
            _ => builder.line_to(single(*x), single(*y)),
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

/// Outlines of characters, turned so that y is down.
struct Outline(PathBuilder);

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, -y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, -y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, -y1, x, -y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, -y1, x2, -y2, x, -y);
    }
    fn close(&mut self) {
        self.0.close();
    }
}
