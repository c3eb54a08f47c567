//! A drawing as SVG.

use std::fmt::Write as _;

use super::font::{FAMILY, text_width};
use super::{Anchor, Colour, Drawing, Shape};

impl Drawing {
    /// As an SVG file.
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n{}</svg>\n",
            self.body()
        )
    }

    /// As a part of an HTML page, as wide as there is room.
    pub fn inline_svg(&self) -> String {
        let [width, height] = self.size;
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" style=\"width:100%;max-width:{width}px\">\n{}</svg>\n",
            self.body()
        )
    }

    fn body(&self) -> String {
        let mut svg = format!("<g font-family=\"{FAMILY}\">\n");
        for shape in &self.shapes {
            add(&mut svg, shape);
        }
        svg.push_str("</g>\n");
        svg
    }
}

fn add(svg: &mut String, shape: &Shape) {
    // Writing into a string does not fail.
    let _ = match shape {
        Shape::Line { points, colour, width, opacity, dashes } => {
            let dashes = if *dashes { " stroke-dasharray=\"5 4\"" } else { "" };
            writeln!(
                svg,
                "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\"{dashes}/>",
                path(points),
                hex(*colour)
            )
        }
        Shape::Area { points, fill, opacity, edge } => {
            let edge = edge.map(|(colour, width)| format!(" stroke=\"{}\" stroke-width=\"{width}\"", hex(colour)));
            writeln!(
                svg,
                "<path d=\"{} Z\" fill=\"{}\" fill-opacity=\"{opacity}\"{}/>",
                path(points),
                hex(*fill),
                edge.unwrap_or_default()
            )
        }
        Shape::Text { at: [x, y], anchor, size, bold, upwards, colour, said } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let weight = if *bold { " font-weight=\"bold\"" } else { "" };
            let turn = if *upwards { format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"") } else { String::new() };
            // Another font is squeezed into the width that labels were placed by.
            let length = text_width(said, *size, *bold);
            writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" textLength=\"{length:.1}\" \
                 lengthAdjust=\"spacingAndGlyphs\" fill=\"{}\"{weight}{turn}>{}</text>",
                hex(*colour),
                escaped(said)
            )
        }
    };
}

fn path(points: &[[f64; 2]]) -> String {
    let mut path = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        let _ = write!(path, "{}{x:.2} {y:.2}", if i == 0 { "M" } else { " L" });
    }
    path
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A text between tags.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
