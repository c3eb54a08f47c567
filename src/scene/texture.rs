//! Variation of reflectance inside facets.

use crate::error::number;
use crate::geometry::{Chart, LonLat, MaterialId, Mesh, Overlay, SpaceChart, Texels};
use crate::physics::reflectance::ALL_LIGHT;
use crate::spectral::{Band, between};

use super::Material;

/// What a texture's values are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureKind {
    /// Factors of the material's reflectance.
    Factor,
    /// Reflectances in the material's stead.
    Reflectance,
}

/// An image on the facets of a material: its values stand for the light that is reflected; heat is the material's.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The material.
    pub material: MaterialId,
    /// What its values are.
    pub kind: TextureKind,
    /// Where texels lie if it is a map of longitudes and latitudes: `columns` and `rows` are those that it [holds](LonLat::size).
    pub lon_lat: Option<LonLat>,
    /// If not, texel coordinates (column, row; 0 to `columns`, 0 to `rows`) of the corners of every facet; of no meaning for other materials.
    pub corners: Vec<[[f64; 2]; 3]>,
    /// Lines of texels.
    pub rows: usize,
    /// Texels in a line.
    pub columns: usize,
    /// Wavelengths of its layers, um, strictly ascending; values are linear between them, and held beyond. One layer may do
    /// without: it is for all wavelengths.
    pub wavelength_um: Vec<f64>,
    /// [row, column, layer].
    pub values: Vec<f64>,
    /// What holds between texel centres.
    pub texels: Texels,
}

impl Texture {
    /// Number of layers.
    pub fn layers(&self) -> usize {
        self.wavelength_um.len().max(1)
    }

    /// How much of a value at a wavelength, um, is each layer's: they sum to 1.
    pub fn shares(&self, um: f64) -> Vec<f64> {
        let mut shares = vec![0.0; self.layers()];
        let (before, share) = between(&self.wavelength_um, um);
        shares[before] = 1.0 - share;
        if share > 0.0 {
            shares[before + 1] = share;
        }
        shares
    }

    /// Mean of each layer over the area of all of its material's facets that it covers; NaN if it covers none.
    pub fn means(&self, mesh: &Mesh) -> Vec<f64> {
        let layers = self.layers();
        let (mut sums, mut total) = (vec![0.0; layers], 0.0);
        let mut overlay = Overlay::default();
        let size = [self.columns, self.rows];
        // In (u, v) a facet is this triangle, of area 1 / 2.
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        for facet in (0..mesh.facets.len()).filter(|f| mesh.material[*f] == self.material) {
            let area_m2 = mesh.facet(facet).area_m2();
            let parts = match &self.lon_lat {
                Some(map) => {
                    let corners = mesh.facet(facet).corners_m.map(|corner| corner - map.centre_m);
                    map.flat_parts(&SpaceChart::of_facet(corners), &triangle)
                }
                None => vec![(Chart::affine(&self.corners[facet]), triangle.to_vec())],
            };
            let mut add = |column: usize, row: usize, share: f64| {
                let weight = 2.0 * share * area_m2;
                total += weight;
                let values = &self.values[(row * size[0] + column) * layers..][..layers];
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            };
            for (chart, part) in &parts {
                match self.texels {
                    Texels::Nearest => overlay.texels(chart, part, size, &mut add),
                    Texels::Bilinear => overlay.centres(chart, part, size, |around, _, _| {
                        around.iter().for_each(|(column, row, share)| add(*column, *row, *share));
                    }),
                }
            }
        }
        sums.iter_mut().for_each(|sum| *sum /= total);
        sums
    }

    /// Where its first value is that no texel may have.
    fn odd_texel(&self) -> Option<usize> {
        self.values.iter().position(|value| Self::is_odd(*value))
    }

    /// Whether a value is one that no texel may have.
    pub(crate) fn is_odd(value: f64) -> bool {
        !(value >= 0.0 && value.is_finite())
    }

    /// Says if a band is far from all of its layers.
    pub(super) fn covers(&self, bands: &[Band], mut problem: impl FnMut(String)) {
        let reach = |b: &Band| b.support_um();
        if let (Some(first), Some(last)) = (self.wavelength_um.first(), self.wavelength_um.last())
            && let Some(band) = bands.iter().find(|b| self.layers() > 1 && (reach(b).1 < *first || reach(b).0 > *last))
        {
            problem(format!(
                "its layers reach from {first} to {last} um, and none is near the band at {} um",
                band.centre_um
            ));
        }
    }

    /// What is wrong with it, whatever the bands: a sentence for each.
    pub(super) fn check(&self, mesh: &Mesh, materials: &[Material], mut problem: impl FnMut(String)) {
        if self.rows == 0 || self.columns == 0 || self.values.len() != self.rows * self.columns * self.layers() {
            return problem(format!(
                "{} values are not {} x {} texels of {} layers",
                self.values.len(),
                self.columns,
                self.rows,
                self.layers()
            ));
        }
        match &self.lon_lat {
            Some(map) if map.size() != [self.columns, self.rows] => {
                return problem(format!("{} x {} texels are not {:?}", self.columns, self.rows, map.size()));
            }
            None if self.corners.len() != mesh.facets.len() => {
                return problem(format!("places {} facets of {}", self.corners.len(), mesh.facets.len()));
            }
            _ => {}
        }
        if let Some(i) = self.odd_texel() {
            let texel = i / self.layers();
            // Of a map of longitudes a column more is held on each side.
            let column = |held: usize| self.lon_lat.as_ref().map_or(held, |map| (held + map.columns - 1) % map.columns);
            let (row, column) = (texel / self.columns, column(texel % self.columns));
            return problem(format!(
                "texel (row {row}, column {column}) is {}: expected a number of at least 0",
                number(self.values[i])
            ));
        }
        let ascends = self.wavelength_um.windows(2).all(|w| w[0] < w[1]);
        if !(ascends && self.wavelength_um.iter().all(|w| *w > 0.0 && w.is_finite())) {
            problem("its wavelengths do not ascend".into());
        }
        let Some(material) = materials.get(self.material.0 as usize) else {
            return problem("is of no material".into());
        };
        let most = self.values.iter().copied().fold(0.0, f64::max);
        let base = match self.kind {
            TextureKind::Factor => material.reflectance.value().iter().copied().fold(0.0, f64::max),
            TextureKind::Reflectance => 1.0,
        };
        if most * base > ALL_LIGHT {
            problem(format!("makes a reflectance of {}, which is above 1", number(most * base)));
        }
        let places = if self.lon_lat.is_some() { 0 } else { mesh.facets.len() };
        let absent = (0..places)
            .find(|f| mesh.material[*f] == self.material && self.corners[*f].iter().flatten().any(|x| !x.is_finite()));
        if let Some(facet) = absent {
            problem(format!("facet {facet} (counted from 0) has no texture coordinates"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_share_what_lies_between_them() {
        let texture = |wavelength_um: Vec<f64>| Texture {
            material: MaterialId(0),
            kind: TextureKind::Factor,
            lon_lat: None,
            corners: vec![],
            rows: 1,
            columns: 1,
            values: vec![1.0; wavelength_um.len().max(1)],
            wavelength_um,
            texels: Texels::Nearest,
        };
        let three = texture(vec![1.0, 2.0, 4.0]);
        assert_eq!(three.shares(2.5), [0.0, 0.75, 0.25]);
        assert_eq!((three.shares(0.5), three.shares(9.0)), (vec![1.0, 0.0, 0.0], vec![0.0, 0.0, 1.0]));
        assert_eq!(texture(vec![]).shares(3.0), [1.0]);
    }
}
