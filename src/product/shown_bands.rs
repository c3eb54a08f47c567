//! The few bands of a cube that pictures and statistics show.

use std::collections::BTreeMap;

use super::{CubeAxes, Filling, Slab};
use crate::error::Result;

/// Some bands of a cube whose slabs come and go.
#[derive(Debug, Clone)]
pub struct ShownBands {
    /// The axes of the cube.
    pub axes: CubeAxes,
    filling: Filling,
    radiance: BTreeMap<usize, Vec<f64>>,
}

impl ShownBands {
    /// These bands of a cube, 0 until slabs come; those that it does not have are left out.
    pub fn new(axes: CubeAxes, bands: impl IntoIterator<Item = usize>) -> Self {
        let bands = bands.into_iter().filter(|band| *band < axes.bands.len());
        let radiance = bands.map(|band| (band, vec![0.0; axes.samples * axes.lines])).collect();
        ShownBands { filling: Filling::new(&axes), axes, radiance }
    }

    /// Keeps what a slab has of them.
    ///
    /// # Errors
    /// Those of [`Filling::admits`].
    pub fn take(&mut self, slab: &Slab) -> Result<()> {
        self.filling.admits(slab)?;
        self.filling.add(slab);
        let samples = self.axes.samples;
        for (band, radiance) in self.radiance.range_mut(slab.bands.clone()) {
            let of_slab = &mut radiance[slab.lines.start * samples..slab.lines.end * samples];
            let band = band - slab.bands.start;
            slab.expand(0..of_slab.len(), band..band + 1, |pixel, _, values| of_slab[pixel] = values[0]);
        }
        Ok(())
    }

    /// Radiance of every pixel in a band, line by line, W m-2 sr-1 um-1; empty if it is not kept.
    pub fn band(&self, band: usize) -> &[f64] {
        self.radiance.get(&band).map_or(&[], Vec::as_slice)
    }
}
