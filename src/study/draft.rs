//! How dark pixels get, and how bright what is sunlit is: of an image, or of a draft of one that has sunlight from a point and the heat that it makes. No pixel
//! that is sunlit all over in a draft has less light than there, but in half-shadow; of others, where a slit of light may be all in half-shadow, nothing is known.

use crate::integrate::Image;
use crate::scene::{Scene, SunModel};
use crate::spectral::Light;

/// Bands of an image that are looked at, at most.
const OF_IMAGE: usize = 16;
/// Sunlit pixels that stand for all of an image.
const PLACES: usize = 4096;
/// What is lit to within this is lit.
const ROUNDING: f64 = 1e-9;
/// A place that the middle of the Sun's disc lights sees this much of it at least, between edges that cross there.
const HALF_SHADOW: f64 = 0.25;

/// The least radiance of pixels, and that of what is sunlit.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    /// By wavelength, ascending.
    pub(super) bands: Vec<Shade>,
    /// Whether all that is modelled is in it, and not just the least that there is.
    pub(super) is_whole: bool,
}

/// In a band.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shade {
    /// Its ends, um.
    um: (f64, f64),
    light: Light,
    /// Median radiance of what is sunlit, over what it is by the surface's models alone.
    median: f64,
    /// The least radiance of pixels that show nothing but sunlit ground, and of all, over that median.
    least: [f64; 2],
}

/// A band that is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    /// By its place in the image.
    pub(super) band: usize,
    pub(super) um: (f64, f64),
    pub(super) light: Light,
    /// Median radiance of what is sunlit by the surface's models alone, W m-2 sr-1 um-1.
    pub(super) reference: f64,
}

/// So many of some things at most, evenly, with the first and the last.
pub(super) fn some(count: usize, most: usize) -> Vec<usize> {
    let step = count.div_ceil(most).max(1);
    (0..count).filter(|i| i % step == 0 || i + 1 == count).collect()
}

impl Draft {
    /// Of an image that is there, by the median that its surface's models give at a wavelength, um, W m-2 sr-1 um-1.
    pub(super) fn of_image(scene: &Scene, image: &Image, median: impl Fn(f64, Light) -> f64) -> Self {
        let bands = &scene.exposure.bands;
        let shown = |band: usize| {
            let (light, known_um) = (bands[band].light, scene.known_um(bands[band].light));
            let nodes = bands[band].quadrature(&[], known_um);
            let reference = nodes.iter().map(|(um, weight)| weight * median(*um, light)).sum();
            Shown { band, um: bands[band].support_within_um(known_um), light, reference }
        };
        let shown: Vec<Shown> = some(bands.len(), OF_IMAGE).into_iter().map(shown).collect();
        Draft { bands: Draft::of(image, &shown, scene.models.sun), is_whole: true }
    }

    /// Of each band that is looked at, with a Sun of this kind.
    pub(super) fn of(image: &Image, shown: &[Shown], sun: SunModel) -> Vec<Shade> {
        let plane = |name: &str| image.backplanes.plane(name).map_or(&[][..], |plane| &plane.values);
        let (coverage, lit) = (plane("COVERAGE"), plane("LIT_FRACTION"));
        let shade = |shown: &Shown| {
            let mut radiance = vec![f64::NAN; coverage.len()];
            image.slab.expand(0..coverage.len(), shown.band..shown.band + 1, |pixel, _, values| {
                if coverage[pixel] > 0.0 {
                    radiance[pixel] = values[0] / coverage[pixel];
                }
            });
            // A minimum passes over what is not a number.
            let least = |is: &dyn Fn(f64) -> bool| {
                let of = radiance.iter().zip(lit).filter(|(_, lit)| is(**lit)).map(|(radiance, _)| *radiance);
                of.fold(f64::INFINITY, f64::min)
            };
            let is_whole = |lit: f64| lit > 1.0 - ROUNDING;
            let of_lit = least(&is_whole);
            let is_any_dark = || radiance.iter().zip(lit).any(|(radiance, lit)| !radiance.is_nan() && !is_whole(*lit));
            let of_all = match sun {
                SunModel::Disc(_) => least(&|_| true),
                SunModel::Point if is_any_dark() => 0.0,
                SunModel::Point => HALF_SHADOW * of_lit,
            };
            let least = [of_lit, of_all];
            let lit_more = |least: f64| -> Vec<usize> { (0..lit.len()).filter(|i| lit[*i] > least).collect() };
            let sunlit = [0.5, 0.0].into_iter().map(lit_more).find(|found| !found.is_empty()).unwrap_or_default();
            let places = sunlit.iter().step_by(sunlit.len().div_ceil(PLACES).max(1)).map(|i| radiance[*i]);
            let median = median(places)?;
            let reference = Some(shown.reference).filter(|reference| *reference > 0.0)?;
            let shade = Shade {
                um: shown.um,
                light: shown.light,
                median: median / reference,
                least: least.map(|least| least / median),
            };
            Some(shade)
        };
        shown.iter().filter_map(shade).collect()
    }

    fn of_light(&self, light: Light) -> impl DoubleEndedIterator<Item = &Shade> {
        self.bands.iter().filter(move |shade| shade.light == light)
    }

    /// The least radiance, over the median, of pixels that show nothing but sunlit ground, and of all: that of bands that hold a wavelength, or else the
    /// lower one of the nearest on both sides. 0 where there is none.
    pub(super) fn least_at(&self, um: f64, light: Light) -> [f64; 2] {
        let holding: Vec<&Shade> = self.of_light(light).filter(|shade| shade.um.0 <= um && um <= shade.um.1).collect();
        let around = || Some([self.below(um, light)?, self.above(um, light)?]);
        let of: &[&Shade] = if holding.is_empty() { &around().map_or(vec![], Vec::from) } else { &holding };
        let least = |k: usize| of.iter().map(|shade| shade.least[k]).fold(f64::INFINITY, f64::min);
        [0, 1].map(least).map(|least| if of.is_empty() { 0.0 } else { least })
    }

    /// By what the median radiance of what is sunlit by the surface's models alone is multiplied.
    pub(super) fn median_at(&self, um: f64, light: Light) -> f64 {
        match (self.below(um, light), self.above(um, light)) {
            (Some(below), Some(above)) if below.um.1 < above.um.0 => {
                let share = ((um - below.um.1) / (above.um.0 - below.um.1)).clamp(0.0, 1.0);
                below.median + share * (above.median - below.median)
            }
            (Some(shade), _) | (None, Some(shade)) => shade.median,
            (None, None) => 1.0,
        }
    }

    fn below(&self, um: f64, light: Light) -> Option<&Shade> {
        self.of_light(light).rfind(|shade| shade.um.0 <= um)
    }

    fn above(&self, um: f64, light: Light) -> Option<&Shade> {
        self.of_light(light).find(|shade| shade.um.1 >= um)
    }
}

/// Of numbers, black ones too; `None` without any.
fn median(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let mut numbers: Vec<f64> = numbers.filter(|x| x.is_finite()).collect();
    let middle = numbers.len() / 2;
    (!numbers.is_empty())
        .then(|| *numbers.select_nth_unstable_by(middle, f64::total_cmp).1)
        .filter(|median| *median > 0.0)
}
