//! Radiance that was computed elsewhere: where a map's texels lie in a scene, and what they hold.

use crate::error::Result;
use crate::geometry::{Camera, LonLat};
use crate::spectral::{Band, KnownLight};

/// An image of the scene whose texels are put back onto what they saw.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewImage {
    /// What took it: texels are its pixels.
    pub camera: Camera,
    /// Whether surface hidden from the eye is unknown; if not, the image is projected through everything.
    pub occlusion: bool,
}

impl ViewImage {
    /// Texels in a line, and lines.
    pub fn size(&self) -> [usize; 2] {
        self.camera.size().map(|n| n as usize)
    }
}

/// Convex parts of facets, each a texel's.
///
/// Vertices are (u, v) on the facet, as in [`Seen`](crate::visibility::Seen).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Patches {
    /// Number of texels.
    pub texels: usize,
    /// The facet of each polygon, ascending.
    pub polygon_facet: Vec<u32>,
    /// The texel of each polygon.
    pub polygon_texel: Vec<u32>,
    /// First vertex of each polygon, and the number of vertices as the last element.
    pub polygon_start: Vec<usize>,
    /// Vertices of the polygons.
    pub uv: Vec<[f64; 2]>,
}

/// Texture coordinates of a mesh's facets, for an image of `rows` x `columns` texels.
#[derive(Debug, Clone)]
pub struct Atlas {
    /// Texel coordinates (column, row) of each facet's corners; NaN where the mesh has none.
    pub corners: Vec<[[f64; 2]; 3]>,
    /// Lines of texels.
    pub rows: usize,
    /// Texels in a line.
    pub columns: usize,
}

impl PartialEq for Atlas {
    /// Corners without coordinates are alike.
    fn eq(&self, other: &Self) -> bool {
        let [ours, theirs] = [self, other].map(|atlas| atlas.corners.as_flattened().as_flattened());
        (self.rows, self.columns, ours.len()) == (other.rows, other.columns, theirs.len())
            && ours.iter().zip(theirs).all(|(a, b)| a.to_bits() == b.to_bits())
    }
}

impl Atlas {
    /// Of texture coordinates: u to the right, v up from the last row, both 0 to 1 over the whole image.
    pub fn of_uv(uv: &[[[f64; 2]; 3]], rows: usize, columns: usize) -> Self {
        let texel = |[u, v]: [f64; 2]| [u * columns as f64, (1.0 - v) * rows as f64];
        Atlas { corners: uv.iter().map(|corners| corners.map(texel)).collect(), rows, columns }
    }
}

/// Where a map's texels lie in a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Placement {
    /// Texel i is facet i; the number of facets.
    Facets(usize),
    /// Texels are parts of facets.
    Patches(Patches),
    /// Texels are pixels of an image of the scene.
    View(Box<ViewImage>),
    /// Texels are pixels of an image that the mesh's texture coordinates address.
    Atlas(Atlas),
    /// Texels are pixels of a map of all longitudes and latitudes.
    LonLat(LonLat),
}

impl Placement {
    /// Number of texels.
    pub fn texels(&self) -> usize {
        match self {
            Placement::Facets(facets) => *facets,
            Placement::Patches(patches) => patches.texels,
            Placement::View(view) => view.size().iter().product(),
            Placement::Atlas(atlas) => atlas.rows * atlas.columns,
            Placement::LonLat(map) => map.size().iter().product(),
        }
    }
}

/// Spectral radiance of texels, read a band at a time: all bands of a large map need not fit into memory.
pub trait TexelSource: Send {
    /// The map's bands.
    fn bands(&self) -> &[Band];

    /// Reads a band, W m-2 sr-1 um-1: a value for each texel, line by line; NaN where there is none. `values` is cleared first.
    ///
    /// Bands are asked for in ascending order, each at most twice.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io), or [`Error::Invalid`](crate::Error::Invalid) for a value that is not a radiance.
    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()>;

    /// The share of each texel that shows the surface rather than sky, line by line, where the source knows it: a coverage plane, or
    /// alpha. What [`read`](Self::read) gives is then the mean over that share; NaN where it is 0.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    fn coverage(&mut self) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }
}

/// A radiance map: texels, and where they lie.
pub struct RadianceMap {
    /// What it is called in reports.
    pub name: String,
    /// Where its texels lie.
    pub placement: Placement,
    /// What they hold.
    pub source: Box<dyn TexelSource>,
    /// What the map's radiance is multiplied by.
    pub weight: f64,
    /// What light its bands hold, as far as it is known: one for each band; unknown for bands beyond the list.
    pub light: Vec<KnownLight>,
    /// What texels that show surface in part hold.
    pub sky: SkyShare,
    /// How its place was found by its outline, if it was.
    pub registration: Option<Registration>,
}

impl RadianceMap {
    /// Whether any of its bands holds thermal emission, if that is known.
    pub fn heat(&self) -> Option<bool> {
        if self.light.iter().any(|light| light.heat == Some(true)) {
            return Some(true);
        }
        let all = self.light.len() == self.source.bands().len() && self.light.iter().all(|l| l.heat == Some(false));
        all.then_some(false)
    }
}

/// What an image's texel holds if it shows the scene only in part, and sky besides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SkyShare {
    /// For a camera's image the mean over the whole texel, with a dark sky, unless its surroundings are as bright as the scene. Of
    /// other images the mean over what shows the scene, unless texels beside the scene are dark.
    #[default]
    Guessed,
    /// The mean over all of the texel, of which the sky is dark.
    Included,
    /// The mean over what shows the scene.
    LeftOut,
}

/// Where an image was found to lie, by its outline against the scene's.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    /// Columns and rows by which the content is shifted from its stated position.
    pub shift_texels: [f64; 2],
    /// The same along its lines and across, m.
    pub shift_m: [f64; 2],
    /// Share of the outline's area that image and scene have in common, at the stated position and after the shift.
    pub overlap: [f64; 2],
    /// How far from there its content may lie, along its lines and across, m: 0 where outlines decide.
    pub unverified_m: [f64; 2],
}

impl std::fmt::Debug for RadianceMap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RadianceMap").field("name", &self.name).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_texture_coordinates_are_the_same_also_where_there_are_none() {
        let uv = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[f64::NAN; 2]; 3]];
        let atlas = || Atlas::of_uv(&uv, 2, 3);
        assert_eq!(atlas(), atlas());
        assert_eq!(atlas().corners[0], [[0.0, 2.0], [3.0, 2.0], [0.0, 0.0]]);
        assert_ne!(atlas(), Atlas::of_uv(&uv, 3, 2));
        assert_ne!(atlas(), Atlas::of_uv(&uv[..1], 2, 3));
    }
}
