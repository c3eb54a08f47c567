//! What a raster says of where there is nothing beside its numbers: a band of coverage (alpha), or a mask.
//!
//! Sources: TIFF 6.0 (ExtraSamples, NewSubfileType, PhotometricInterpretation), PNG 1.2 (alpha is not multiplied in), OpenEXR (it is), and for
//! masks beside a file GDAL's RFC 15 (`.msk`: 0 where nothing is valid).

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::report::Fate;

use super::Raster;

/// The band that says what share of a pixel shows something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Alpha {
    /// Its number in the file.
    pub(super) band: usize,
    /// Its number where that is all of the pixel.
    pub(super) whole: f64,
    /// Whether the values have been multiplied by it.
    pub(super) is_multiplied: bool,
}

impl Alpha {
    /// The value of what is shown. 0 / 0 means no data, and so is what shines without covering anything.
    pub(super) fn value(self, stored: f64, share: f64) -> f64 {
        match share > 0.0 {
            true if self.is_multiplied => stored / share,
            true => stored,
            false => f64::NAN,
        }
    }
}

/// What makes a file of one whose mask is not taken: its pixels have no data where it says so.
pub(super) const HELP: &str = "`gdalwarp -dstnodata -9999 IN.tif OUT.tif` puts that number where the mask hides pixels (of a type that can hold it: `-ot Float32`); \
     `gdal_translate -mask none IN.tif OUT.tif` leaves the mask away";

impl Raster {
    /// Takes a mask: an image of one band and of the same size, 0 where there is no data.
    pub(super) fn take_mask(&mut self, mask: Raster, at: Location) -> Result<()> {
        let refused = |message: String| Error::Invalid(vec![Problem::new(at.clone(), message).with_help(HELP)]);
        let count = mask.bands.len() + usize::from(mask.alpha.is_some());
        if count != 1 {
            return Err(refused(format!("a mask of {count} bands: one that counts for all of the image's is read")));
        }
        if (mask.rows, mask.columns) != (self.rows, self.columns) {
            let [mask, image] = [&mask, self].map(|r| format!("{} x {}", r.columns, r.rows));
            return Err(refused(format!("the mask has {mask} pixels, and the image {image}")));
        }
        if self.mask.is_some() {
            return Err(refused("a second mask: which of them counts is not said".into()));
        }
        self.report.note(Fate::Defaulted, at, "a mask: where it is 0 there is no data");
        // Its lines are stored as the image's are.
        self.mask = Some(Box::new(Raster { mirrored: self.mirrored, ..mask }));
        Ok(())
    }

    /// Takes the mask that GDAL has put beside one of the raster's files: a TIFF, which `open` reads.
    pub(in crate::formats) fn take_mask_beside(&mut self, open: impl Fn(&Path) -> Result<Raster>) -> Result<()> {
        let named = |path: &PathBuf| {
            let mut name = path.clone().into_os_string();
            name.push(".msk");
            PathBuf::from(name)
        };
        let masks: Vec<PathBuf> = self.files.iter().map(named).filter(|path| path.is_file()).collect();
        for path in masks {
            let mask = open(&path)?;
            self.take_mask(mask, Location::file(&path))?;
            self.files.push(path);
        }
        Ok(())
    }

    /// Makes NaN of values that the mask hides.
    pub(super) fn hide(&mut self, values: &mut [f64]) -> Result<()> {
        let Some(mask) = &mut self.mask else { return Ok(()) };
        if self.hidden.is_empty() {
            let mut numbers = Vec::new();
            mask.numbers(0, &mut numbers)?;
            self.hidden = numbers.iter().map(|number| *number == 0.0).collect();
        }
        values.iter_mut().zip(&self.hidden).filter(|(_, hidden)| **hidden).for_each(|(value, _)| *value = f64::NAN);
        Ok(())
    }

    /// Whether pixels may have no data though no number stands for it.
    pub(super) fn may_have_holes(&self) -> bool {
        self.mask.is_some() || self.alpha.is_some()
    }
}
