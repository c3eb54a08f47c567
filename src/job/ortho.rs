//! Orthorectifies an image.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::folder::Staged;
use crate::formats::report_json::{self, ProductReport};
use crate::formats::{ortho_folder, registry, scene_toml};
use crate::product::{MapGrid, Plane};
use crate::progress::Watch;
use crate::scene::Readout;
use crate::study::{self, MapWish};

/// Result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mapped {
    /// The grid.
    pub grid: MapGrid,
    /// Entries of the look-up table.
    pub entries: usize,
    /// Bands of the image.
    pub bands: usize,
}

/// The scene of a product, and its cube; a scene file is a scene alone.
fn scene_and_cube(of: &Path) -> Result<(PathBuf, Option<PathBuf>)> {
    let report = of.join("report.json");
    if !report.is_file() {
        return Ok((of.to_owned(), None));
    }
    let report: ProductReport = report_json::read(&report)?;
    match report.inputs.first() {
        Some(scene) => Ok((PathBuf::from(&scene.path), Some(of.join("cube.img")))),
        None => Err(Error::invalid(Location::file(of), "report.json names no scene; pass the scene file")),
    }
}

/// Orthorectifies the image of a scene or product, and fills a folder (whether it may be replaced) with the map and its
/// look-up table. For a tunable filter one band is mapped, counted from 0; by default the reference.
///
/// # Errors
/// Those of [`scene_toml::read`], [`study::ortho`] and [`Staged::folder_of`]; [`Error::Invalid`] if the cube is not that scene's image; [`Error::Io`].
pub fn ortho(
    of: &Path,
    (wish, band): (MapWish, Option<usize>),
    (target, replace): (&Path, bool),
    watch: Watch<'_>,
) -> Result<Mapped> {
    let staged = Staged::folder_of(&ortho_folder::FOLDER, target, replace)?;
    let (scene_path, cube) = scene_and_cube(of)?;
    let file = scene_toml::read(&scene_path, watch)?;
    staged.spares(file.inputs.iter().map(|input| input.path.as_path()).chain(cube.as_deref()))?;
    let motion = file.motion.as_ref().map(|(motion, timing)| (motion, *timing));
    let scene = &file.scene;
    let is_filter = motion.is_some_and(|(_, timing)| timing.readout == Readout::Band);
    let count = scene.exposure.bands.len();
    let wanted = band.unwrap_or_else(|| study::reference_band(scene, motion));
    if wanted >= count {
        let message = format!("band {} is not one of {count}", wanted.saturating_add(1));
        return Err(Error::Invalid(vec![Problem::new(Location::item("--band"), message)]));
    }
    let (grid, parts) = study::ortho(scene, motion, wanted, wish, watch)?;
    let mut bands = Vec::new();
    if let Some(cube) = &cube {
        let mut raster = registry::image(cube)?;
        let camera = &scene.exposure.camera;
        let size = [camera.samples as usize, camera.lines as usize, count];
        if [raster.columns, raster.rows, raster.bands.len()] != size {
            let message = format!(
                "does not match the scene: {} x {}, {} bands against {} x {}, {count}",
                raster.columns,
                raster.rows,
                raster.bands.len(),
                size[0],
                size[1]
            );
            return Err(Error::invalid(Location::file(cube), message));
        }
        let mut values = Vec::new();
        let mapped = if is_filter || band.is_some() { wanted..wanted + 1 } else { 0..count };
        for band in mapped {
            raster.read(band, &mut values)?;
            let name = match raster.bands[band].name.trim() {
                "" => format!("band {}", band + 1),
                name => name.to_owned(),
            };
            bands.push(Plane { name, unit: String::new(), values: grid.means(&parts, &values, size[0]) });
        }
    }
    let mapped = Mapped { grid, entries: parts.len(), bands: bands.len() };
    let id = scene_toml::id(&file.inputs);
    ortho_folder::write(staged.path(), &grid, &parts, bands, &id).map_err(|error| staged.named(error))?;
    staged.commit()?;
    Ok(mapped)
}
