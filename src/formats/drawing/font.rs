//! The embedded font: widths and outlines of its characters.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

static PLAIN: LazyLock<Option<Face<'static>>> = LazyLock::new(|| Face::parse(include_bytes!("DejaVuSans.ttf"), 0).ok());
static BOLD: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("DejaVuSans-Bold.ttf"), 0).ok());

/// The names that an SVG asks for: those with the same widths first.
pub(super) const FAMILY: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, Geneva, sans-serif";

fn face(bold: bool) -> Option<&'static Face<'static>> {
    if bold { BOLD.as_ref() } else { PLAIN.as_ref() }
}

/// Its glyph; of a character that the font lacks, that of a question mark.
fn glyph(face: &Face, c: char) -> GlyphId {
    face.glyph_index(c).or_else(|| face.glyph_index('?')).unwrap_or(GlyphId(0))
}

/// Width of a line of text, px.
pub fn text_width(said: &str, size: f64, bold: bool) -> f64 {
    let Some(face) = face(bold) else { return 0.6 * size * said.chars().count() as f64 };
    let units: f64 = said.chars().map(|c| f64::from(face.glyph_hor_advance(glyph(face, c)).unwrap_or(0))).sum();
    units * size / f64::from(face.units_per_em())
}

/// Calls `outline` with what receives each character's outline and where it begins, px from the text's left end; lengths are in px, y is up.
pub(super) fn outlines(said: &str, size: f64, bold: bool, to: &mut impl OutlineBuilder) {
    let Some(face) = face(bold) else { return };
    let scale = size / f64::from(face.units_per_em());
    let mut x = 0.0;
    for c in said.chars() {
        let glyph = glyph(face, c);
        let mut placed = Placed { to, x, scale };
        face.outline_glyph(glyph, &mut placed);
        x += scale * f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
    }
}

/// Scales and moves outlines.
struct Placed<'a, T> {
    to: &'a mut T,
    x: f64,
    scale: f64,
}

impl<T> Placed<'_, T> {
    #[expect(clippy::cast_possible_truncation, reason = "px, to a millionth")]
    fn at(&self, x: f32, y: f32) -> [f32; 2] {
        [(self.x + self.scale * f64::from(x)) as f32, (self.scale * f64::from(y)) as f32]
    }
}

impl<T: OutlineBuilder> OutlineBuilder for Placed<'_, T> {
    fn move_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.at(x, y);
        self.to.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.at(x, y);
        self.to.line_to(x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ([x1, y1], [x, y]) = (self.at(x1, y1), self.at(x, y));
        self.to.quad_to(x1, y1, x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ([x1, y1], [x2, y2], [x, y]) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.to.curve_to(x1, y1, x2, y2, x, y);
    }
    fn close(&mut self) {
        self.to.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_that_is_drawn_has_a_glyph() {
        let written =
            "0123456789 abcdefghijklmnopqrstuvwxyz ABCDEFGHIJKLMNOPQRSTUVWXYZ .,:;!?()[]+-*/=%<>\"'_|° × – … ≤ ≥ − µ";
        for bold in [false, true] {
            let face = face(bold).unwrap();
            assert!(written.chars().all(|c| face.glyph_index(c).is_some()), "{bold}");
        }
        // DejaVu Sans: i is 569 of 2048 units wide, m 1995.
        assert_eq!(text_width("im", 2048.0, false), 569.0 + 1995.0);
    }
}
