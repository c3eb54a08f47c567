//! What an image holds, band by band, and on request a picture of it.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Result};
use crate::formats::envi::BandStatistics;
use crate::formats::folder::Staged;
use crate::formats::raster::{self, Raster};
use crate::formats::{quicklook, registry};
use crate::progress::{Watch, tell};

/// A picture of an image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// The PNG to write.
    pub target: PathBuf,
    /// The band that it shows, from 0, or those of red, green and blue; without any, those that suit the image. Small images are enlarged by whole factors.
    pub bands: Vec<usize>,
    /// Whether it may replace another.
    pub replace: bool,
}

/// What an image holds.
#[derive(Debug)]
pub struct Survey {
    /// The image.
    pub raster: Raster,
    /// For each band what it is called and what its values are like.
    pub bands: Vec<(String, BandStatistics)>,
}

/// Reads all bands of an image, and writes the picture.
///
/// # Errors
/// Those of [`registry::image`] and [`Raster::read`]; [`Error::Invalid`] for a picture that is not a PNG or shows a band that is not there;
/// those of [`Staged::file`]; [`Error::Interrupted`] if `watch` asks to stop.
pub fn survey(path: &Path, picture: Option<&Picture>, watch: Watch<'_>) -> Result<Survey> {
    let is_png = |target: &Path| target.extension().is_none_or(|e| e.eq_ignore_ascii_case("png"));
    if let Some(Picture { target, .. }) = picture.filter(|picture| !is_png(&picture.target)) {
        let message = "a picture of an image is written as PNG: give it a name that ends in .png";
        return Err(Error::invalid(Location::file(target), message));
    }
    let mut raster = registry::image(path)?;
    let shown: Vec<usize> = match picture {
        None => vec![],
        Some(picture) if picture.bands.is_empty() => raster.colour_bands(),
        Some(picture) => picture.bands.clone(),
    };
    let count = raster.bands.len();
    if let Some(band) = shown.iter().find(|band| **band >= count) {
        let message = format!("band {} is asked for: it has {count}", band + 1);
        return Err(Error::invalid(Location::file(path), message));
    }
    let mut pictured: Vec<(String, Vec<f64>)> = vec![Default::default(); shown.len()];
    let (mut bands, mut values) = (Vec::with_capacity(count), Vec::new());
    for i in 0..count {
        tell(watch, "reading the image", i as u64, count as u64)?;
        raster.read(i, &mut values)?;
        let label = match (&raster.bands[i].name, raster.bands[i].centre_um) {
            (name, _) if !name.is_empty() => name.clone(),
            (_, Some(um)) => format!("{um} um"),
            _ => format!("band {}", i + 1),
        };
        for (picture, _) in pictured.iter_mut().zip(&shown).filter(|(_, band)| **band == i) {
            *picture = (label.clone(), values.clone());
        }
        bands.push((label, raster::statistics(&values)));
    }
    if let Some(picture) = picture {
        let staged = Staged::file(&picture.target, picture.replace)?;
        staged.spares(raster.files().iter().map(PathBuf::as_path))?;
        let size = [raster.rows, raster.columns];
        let times = quicklook::enlargement(raster.rows.max(raster.columns));
        quicklook::write_bands(staged.path(), size, times, &pictured).map_err(|e| staged.named(e))?;
        staged.commit()?;
    }
    Ok(Survey { raster, bands })
}
