//! The formats in which cubes are, and cubes of ENVI in others.

use std::path::Path;

use schemars::JsonSchema;
use serde::Deserialize;

use super::container::Container;
use super::dataset::{Text, Value};
use super::raster::{self, CubeNotes};
use super::registry;
use crate::error::{Error, Result};
use crate::product::{Backplanes, Quantity};
use crate::progress::Watch;

/// A format of cubes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CubeFormat {
    /// cube.img and cube.hdr.
    Envi,
    /// cube.xml, a label of PDS4 for the numbers in cube.img.
    Pds4,
    /// cube.nc, with backplanes and report.
    Netcdf,
    /// cube.zarr, with backplanes and report.
    Zarr,
    /// cube.fits, with backplanes and report.
    Fits,
    /// cube.exr, spectral OpenEXR.
    Exr,
}

/// The formats in which cubes are, besides OpenEXR, which holds nothing but the numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CubeFormats {
    /// Whether cubes are left as ENVI; backplanes are, in any case.
    pub envi: bool,
    /// Whether the cubes of ENVI have labels of PDS4, too: then they are left.
    pub pds4: bool,
    /// In what else they are, with their backplanes and the report.
    pub containers: Vec<Container>,
}

impl From<&[CubeFormat]> for CubeFormats {
    fn from(formats: &[CubeFormat]) -> Self {
        let asks = |format| formats.contains(&format);
        let containers = [
            (CubeFormat::Netcdf, Container::NetCdf),
            (CubeFormat::Zarr, Container::Zarr),
            (CubeFormat::Fits, Container::Fits),
        ];
        let containers = containers.into_iter().filter(|(format, _)| asks(*format)).map(|(_, container)| container);
        CubeFormats { envi: asks(CubeFormat::Envi), pds4: asks(CubeFormat::Pds4), containers: containers.collect() }
    }
}

impl Default for CubeFormats {
    /// ENVI alone.
    fn default() -> Self {
        CubeFormats { envi: true, pds4: false, containers: vec![] }
    }
}

/// A cube that is there as ENVI.
pub(crate) struct CubeFile<'a> {
    /// Its name without the ending.
    pub(crate) stem: &'a str,
    /// What its numbers are.
    pub(crate) quantity: Quantity,
    /// That in words.
    pub(crate) words: String,
    /// What belongs to its pixels.
    pub(crate) planes: Option<&'a Backplanes>,
}

/// What is said of all cubes of a folder.
pub(crate) struct CubeSource<'a> {
    /// By what, and of what, they are, as the end of a title.
    pub(crate) by: &'a str,
    /// The scene's name, if there is one.
    pub(crate) scene: Option<&'a str>,
    /// The report.
    pub(crate) report: String,
}

impl CubeFormats {
    /// How many files hold the same numbers, while they are written.
    pub fn copies(&self) -> u64 {
        1 + self.containers.len() as u64
    }

    /// Whether the numbers of ENVI are left when the others are written.
    pub(crate) fn keeps_envi(&self) -> bool {
        self.envi || self.pds4 || self.containers.is_empty()
    }

    /// What the files are called that a cube is in at the end, but for headers.
    pub(crate) fn files(&self, stem: &str) -> Vec<String> {
        let endings = self.containers.iter().map(|container| container.ending());
        let endings = endings.chain(self.keeps_envi().then_some("img")).chain(self.pds4.then_some("xml"));
        endings.map(|ending| format!("{stem}.{ending}")).collect()
    }

    /// Writes cubes of a folder in the other formats, and removes what was only on the way.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Interrupted`] if `watch` asks to stop.
    pub(crate) fn write(
        &self,
        folder: &Path,
        cubes: &[CubeFile<'_>],
        source: &CubeSource<'_>,
        watch: Watch<'_>,
    ) -> Result<()> {
        for CubeFile { stem, quantity, words, planes } in cubes {
            let image = folder.join(format!("{stem}.img"));
            if self.pds4 {
                raster::write_pds4_label(&image, &format!("{words}{}", source.by), source.scene)?;
            }
            for container in &self.containers {
                let mut attributes = vec![
                    ("Conventions", Value::from("CF-1.11")),
                    ("title", Value::Text(format!("{words}{}", source.by))),
                    ("source", Value::Text(format!("mmxrt {}", env!("CARGO_PKG_VERSION")))),
                ];
                attributes.extend(source.scene.map(|scene| ("scene", Value::from(scene))));
                let notes = CubeNotes {
                    quantity: (quantity.name(), words),
                    unit: Some(quantity.unit()),
                    no_data: None,
                    attributes,
                    texts: vec![Text {
                        name: "report",
                        about: "how it was made: inputs and their hashes, effects modelled and left out, checks, warnings (JSON)",
                        text: source.report.clone(),
                    }],
                };
                let path = folder.join(format!("{stem}.{}", container.ending()));
                raster::write_cube(&mut registry::image(&image)?, &path, *container, *planes, notes, watch)?;
            }
            if !self.keeps_envi() {
                for ending in ["img", "hdr"] {
                    let path = folder.join(format!("{stem}.{ending}"));
                    std::fs::remove_file(&path).map_err(|e| Error::io(&path, "removing", e))?;
                }
            }
        }
        Ok(())
    }
}
