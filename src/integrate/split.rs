//! An entry of a pixel in parts, where its radiance varies too much over it for one pair of angles.

use super::parts::Window;
use super::pixel::Pixel;
use crate::geometry::polygon::{Rect, area_and_moment, clip_to_rect};
use crate::solve::ImagePart;
use crate::visibility::Shown;

/// Size of what is seen of an entry, image coordinates, pixels; its pieces have been sorted.
pub(super) fn bounds(pixel: &Pixel, index: usize) -> Rect {
    let mut bounds = Rect { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
    for k in pixel.pieces.of(index) {
        let (_, sign, outline) = pixel.pieces.get(k);
        // What is taken away lies within the rest.
        if sign > 0.0 {
            let of = Rect::of(outline);
            for k in 0..2 {
                bounds.min[k] = bounds.min[k].min(of.min[k]);
                bounds.max[k] = bounds.max[k].max(of.max[k]);
            }
        }
    }
    bounds
}

/// Hands out an entry in `parts` x `parts` parts: what is seen in each, and what each source lights of that.
pub(super) fn each(pixel: &mut Pixel, index: usize, parts: u32, mut put: impl FnMut(&ImagePart, &[ImagePart])) {
    let (facet, lights, whole) = (pixel.entries[index].facet, pixel.lights(), bounds(pixel, index));
    let (mut clipped, mut spare) = (vec![], vec![]);
    let mut lit = vec![ImagePart::default(); lights];
    let per_cell = pixel.site.per_cell;
    let side = |k: usize, i: u32| whole.min[k] + (whole.max[k] - whole.min[k]) * f64::from(i) / f64::from(parts);
    for row in 0..parts {
        for column in 0..parts {
            let rect = Rect { min: [side(0, column), side(1, row)], max: [side(0, column + 1), side(1, row + 1)] };
            let mut shown = ImagePart::default();
            lit.fill(ImagePart::default());
            for k in pixel.pieces.of(index) {
                let (_, sign, outline) = pixel.pieces.get(k);
                let times = sign * per_cell;
                clip_to_rect(outline, &rect, &mut clipped, &mut spare);
                let (area, moment) = area_and_moment(&clipped);
                if area <= 0.0 {
                    continue;
                }
                let part = ImagePart { area, moment };
                shown.add(&part.signed(times));
                for (light, lit) in lit.iter_mut().enumerate() {
                    match pixel.lit_of(light, facet) {
                        Shown::Nothing => {}
                        Shown::Whole => lit.add(&part.signed(times)),
                        Shown::Part => pixel.lit_parts(light, facet, &Window::Piece(&clipped), |share, common| {
                            let (area, moment) = area_and_moment(common);
                            lit.add(&ImagePart { area: area.max(0.0), moment }.signed(times * share));
                        }),
                    }
                }
            }
            if shown.area > 0.0 {
                lit.iter_mut().for_each(|lit| lit.area = lit.area.clamp(0.0, shown.area));
                put(&shown, &lit);
            }
        }
    }
}
