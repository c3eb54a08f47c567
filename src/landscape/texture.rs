//! A panchromatic texture over a site: what is too fine for facets.

use rayon::prelude::*;

use super::noise::{Form, Octaves};
use super::random::{Purpose, key};
use super::recipe::Texture;

/// Longest wavelength of a texture that says none, texels.
const LONGEST_TEXELS: f64 = 16.0;

/// Factors on the reflectance, by lines from north to south.
#[derive(Debug, Clone, PartialEq)]
pub struct Grain {
    /// Texels along a side.
    pub texels: usize,
    /// Line by line; mean 1, none below 0 or above 2.
    pub factors: Vec<f64>,
}

impl Grain {
    pub(super) fn new(texture: &Texture, seed: u64, size_m: f64) -> Self {
        let texels = texture.texels as usize;
        let step_m = size_m / texels as f64;
        let longest_m = texture.longest_m.unwrap_or(LONGEST_TEXELS * step_m);
        // Waves of less than two texels are none.
        let octaves = Octaves::new(|k| key(seed, Purpose::Texture, k), 1.0, longest_m, texture.hurst, 2.0 * step_m);
        let place_m = |i: usize| step_m * (i as f64 + 0.5) - 0.5 * size_m;
        let mut factors: Vec<f64> = (0..texels * texels)
            .into_par_iter()
            .map(|i| octaves.height_m(Form::Rolling, place_m(i % texels), -place_m(i / texels), 0.0))
            .collect();
        let count = factors.len() as f64;
        let mean = factors.iter().sum::<f64>() / count;
        let rms = (factors.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / count).sqrt();
        let scale = if rms > 0.0 { texture.rms / rms } else { 0.0 };
        for factor in &mut factors {
            *factor = (1.0 + scale * (*factor - mean)).clamp(0.0, 2.0);
        }
        Grain { texels, factors }
    }
}

/// Texture coordinates of facets by where their corners lie on the map, m: the site is the image, north up. Facets that reach beyond it have none.
pub(super) fn coordinates(facets: &[[u32; 3]], places_m: &[[f64; 2]], size_m: f64) -> Vec<[[f64; 2]; 3]> {
    let coordinates = |facet: &[u32; 3]| {
        let uv = facet.map(|v| places_m[v as usize].map(|p_m| p_m / size_m + 0.5));
        match uv.as_flattened().iter().all(|c| (0.0..=1.0).contains(c)) {
            true => uv,
            false => [[f64::NAN; 2]; 3],
        }
    };
    facets.iter().map(coordinates).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texture_has_the_mean_1_and_the_spread_asked_for() {
        let texture = Texture { texels: 256, rms: 0.1, longest_m: None, hurst: 0.3 };
        let grain = Grain::new(&texture, 1, 100.0);
        assert_eq!(grain.factors.len(), 256 * 256);
        let mean = grain.factors.iter().sum::<f64>() / 65536.0;
        let rms = (grain.factors.iter().map(|f| (f - 1.0).powi(2)).sum::<f64>() / 65536.0).sqrt();
        assert!((mean - 1.0).abs() < 1e-4 && (rms - 0.1).abs() < 1e-3, "{mean} {rms}");
        assert!(grain.factors.iter().all(|f| (0.0..=2.0).contains(f)));
    }

    #[test]
    fn texture_coordinates_are_places_of_the_site() {
        let places_m = [[-50.0, -50.0], [50.0, -50.0], [0.0, 25.0], [60.0, 0.0]];
        let uv = coordinates(&[[0, 1, 2], [1, 3, 2]], &places_m, 100.0);
        assert_eq!(uv[0], [[0.0, 0.0], [1.0, 0.0], [0.5, 0.75]]);
        assert!(uv[1].as_flattened().iter().all(|c| c.is_nan()));
    }
}
