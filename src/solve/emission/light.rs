//! How much of what is seen of a facet each source lights.

use crate::physics::reflectance::PhotometricAngles;
use crate::product::{Lighting, Sees};
use crate::scene::DirectionField;

/// A part of the image, or of a facet in it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ImagePart {
    /// Area, pixels.
    pub area: f64,
    /// Area times centroid, image coordinates, pixels.
    pub moment: [f64; 2],
}

impl ImagePart {
    /// Image centroid, pixels; `None` if its moment was not asked for.
    pub fn centroid_px(&self) -> Option<[f64; 2]> {
        let centroid_px = self.moment.map(|m| m / self.area);
        (self.moment != [0.0; 2] && centroid_px.iter().all(|x| x.is_finite())).then_some(centroid_px)
    }

    /// The same with another area.
    #[must_use]
    pub fn scaled_to(&self, area: f64) -> ImagePart {
        ImagePart { area, moment: self.moment.map(|m| m * (area / self.area)) }
    }

    /// Joins a part that does not overlap it.
    #[inline]
    pub fn add(&mut self, other: &ImagePart) {
        self.area += other.area;
        self.moment[0] += other.moment[0];
        self.moment[1] += other.moment[1];
    }

    /// The same taken away, if `sign` is -1.
    #[inline]
    #[must_use]
    pub fn signed(&self, sign: f64) -> ImagePart {
        ImagePart { area: sign * self.area, moment: self.moment.map(|m| sign * m) }
    }
}

/// What one pixel shows of a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment<'a> {
    /// The facet.
    pub facet: u32,
    /// All that is seen.
    pub shown: ImagePart,
    /// What of that each source sees that is known by parts: the Sun first.
    pub lit: &'a [ImagePart],
}

/// What a texture is over a fragment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Modulation<'a> {
    /// What of the fragment it covers, pixels.
    pub area: f64,
    /// Mean of each of its layers there.
    pub means: &'a [f64],
    /// What it covers of each part that a source sees, pixels; as [`Fragment::lit`].
    pub lit_area: &'a [f64],
    /// Means over each of those: [part, layer].
    pub lit_means: &'a [f64],
}

/// From where a fragment is lit and seen.
#[derive(Debug, Clone, Copy)]
pub(super) enum Angles {
    /// At these angles.
    Of(PhotometricAngles),
    /// From everywhere.
    Diffuse {
        /// Cosine of emission.
        cos_emission: f64,
    },
}

/// A source's irradiance, and what of a fragment has it.
#[derive(Debug, Clone, Copy)]
pub(super) struct SourceLight<'a> {
    /// `None`: its light comes from everywhere.
    pub(super) field: Option<DirectionField>,
    /// Its place in the list of sources, the Sun first; `None`: facets send it.
    pub(super) source: Option<usize>,
    irradiance: &'a [f64],
    reach: Reach<'a>,
}

#[derive(Debug, Clone, Copy)]
enum Reach<'a> {
    All,
    Shares(&'a [f64]),
    /// The part of this number.
    Part(usize),
}

impl<'a> SourceLight<'a> {
    /// One for each source.
    pub(super) fn list(sources: &'a [Lighting]) -> Vec<Self> {
        let mut parts = 0;
        let light = |(i, lighting): (usize, &'a Lighting)| {
            let reach = match &lighting.sees {
                Sees::All => Reach::All,
                Sees::Shares(shares) => Reach::Shares(shares),
                Sees::Polygons(_) => {
                    parts += 1;
                    Reach::Part(parts - 1)
                }
            };
            SourceLight { field: Some(lighting.field), source: Some(i), irradiance: &lighting.irradiance, reach }
        };
        sources.iter().enumerate().map(light).collect()
    }

    /// Light from everywhere, on all of each facet.
    pub(super) fn diffuse(irradiance: &'a [f64]) -> Self {
        SourceLight { field: None, source: None, irradiance, reach: Reach::All }
    }

    /// Irradiance on a facet, where it is lit.
    #[inline]
    pub(super) fn irradiance(&self, facet: u32) -> f64 {
        self.irradiance[facet as usize]
    }

    /// Lit area of a fragment, pixels.
    #[inline]
    pub(super) fn of(&self, fragment: &Fragment) -> f64 {
        match self.reach {
            Reach::All => fragment.shown.area,
            Reach::Shares(shares) => fragment.shown.area * shares[fragment.facet as usize],
            Reach::Part(part) => fragment.lit.get(part).map_or(0.0, |lit| lit.area),
        }
    }

    /// Image centroid of what is lit of a fragment, pixels; of all of it where that is not known.
    pub(super) fn centroid_px(&self, fragment: &Fragment) -> [f64; 2] {
        let lit = match self.reach {
            Reach::All | Reach::Shares(_) => None,
            Reach::Part(part) => fragment.lit.get(part).and_then(ImagePart::centroid_px),
        };
        lit.or_else(|| fragment.shown.centroid_px()).unwrap_or_default()
    }

    /// Lit area of what a texture covers, pixels.
    pub(super) fn of_texture(&self, fragment: &Fragment, texture: &Modulation) -> f64 {
        match self.reach {
            Reach::All => texture.area,
            Reach::Shares(shares) => texture.area * shares[fragment.facet as usize],
            Reach::Part(part) => texture.lit_area.get(part).copied().unwrap_or(0.0),
        }
    }

    /// Mean of a texture's layer where it is lit; 1 without a texture.
    #[inline]
    pub(super) fn mean(&self, texture: &Modulation, layer: usize) -> f64 {
        let layers = texture.means.len();
        let mean = match self.reach {
            Reach::All | Reach::Shares(_) => texture.means.get(layer),
            Reach::Part(part) => texture.lit_means.get(part * layers + layer),
        };
        mean.copied().unwrap_or(1.0)
    }
}
