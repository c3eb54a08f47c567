//! Scene and facet table to images: what each pixel sees, exactly.

mod footprints;
mod lit;
mod pixel;

pub use footprints::footprints;
