//! Orthorectifies an image.

use std::path::{Path, PathBuf};

use super::locate::acquired;
use crate::error::{Error, Location, Problem, Result};
use crate::formats::folder::Staged;
use crate::formats::report_json::{self, ProductReport};
use crate::formats::{Reading, Setting, Subject, ortho_folder, product_image, registry, scene_toml};
use crate::product::{MapGrid, Plane};
use crate::progress::Watch;
use crate::scene::{Body, Readout};
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

/// What is in a product's image, as the files that it was made of have it now, and its cube; a scene file is a scene alone. Of a product of a campaign, the campaign's file says it.
///
/// # Errors
/// [`Error::Invalid`] if the product was made of something else.
fn subject_and_cube(
    of: &Path,
    campaign: Option<&Path>,
    reading: &Reading,
    watch: Watch<'_>,
) -> Result<(Subject, Option<PathBuf>)> {
    let report = of.join("report.json");
    if !report.is_file() {
        let subject = match campaign {
            None => Subject::from(scene_toml::read_with(of, reading, watch)?),
            Some(_) => return Err(Error::invalid(Location::file(of), "is not a product of a campaign")),
        };
        return Ok((subject, None));
    }
    let report: ProductReport = report_json::read(&report)?;
    if let Some(first) = reading.settings.first() {
        let message = format!("is a product, made with settings of its own: --set {first} would be another image");
        return Err(Error::invalid(Location::file(of), message));
    }
    let settings: std::result::Result<Vec<Setting>, String> = report.settings.iter().map(|s| s.parse()).collect();
    let settings = settings.map_err(|e| Error::invalid(Location::file(of).with_item("settings"), e))?;
    let reading = Reading { settings, ..reading.clone() };
    let subject = match (campaign, report.inputs.first()) {
        (Some(campaign), _) => {
            let of = of.canonicalize().map_err(|e| Error::io(of, "reading", e))?;
            let name = of.file_name().unwrap_or_default().to_string_lossy().into_owned();
            acquired(campaign, &name, &reading, watch)?
        }
        (None, Some(scene)) if !Path::new(&scene.path).is_file() => {
            let problem = Problem::new(Location::file(of), format!("its scene is not there: {}", scene.path));
            let help = "a relative path starts where the product was made: run this from there";
            return Err(Error::Invalid(vec![problem.with_help(help)]));
        }
        (None, Some(scene)) => Subject::from(scene_toml::read_with(Path::new(&scene.path), &reading, watch)?),
        (None, None) => {
            return Err(Error::invalid(Location::file(of), "its report names no scene: name the scene file"));
        }
    };
    if subject.id != report.scene {
        let is_changed =
            |input: &&report_json::Input| subject.inputs.iter().all(|now| report_json::Input::from(now) != **input);
        let changed: Vec<&str> = report.inputs.iter().filter(is_changed).map(|input| input.path.as_str()).collect();
        let (message, help) = match changed.is_empty() {
            false => (
                format!("was made of other files than are there now: {}", changed.join(", ")),
                "simulate it again, or put back what it was made of",
            ),
            true => (
                "is not of the moment and camera of its scene file: a campaign made it".to_owned(),
                "name its campaign: --campaign CAMPAIGN.toml",
            ),
        };
        return Err(Error::Invalid(vec![Problem::new(Location::file(of), message).with_help(help)]));
    }
    Ok((subject, Some(product_image(of, "cube"))))
}

/// Lays the image of a scene or product, of a campaign with its file, on the ground, and fills a folder (whether it may be replaced) with the map and its look-up table. Of a tunable filter one band
/// is mapped, counted from 0: without one the reference.
///
/// # Errors
/// Those of [`scene_toml::read`], [`study::ortho`] and [`Staged::folder_of`]; [`Error::Invalid`] if the cube is not that scene's image; [`Error::Io`].
pub fn ortho(
    (of, campaign, reading): (&Path, Option<&Path>, &Reading),
    (wish, band): (MapWish, Option<usize>),
    (target, replace): (&Path, bool),
    watch: Watch<'_>,
) -> Result<Mapped> {
    let staged = Staged::folder_of(&ortho_folder::FOLDER, target, replace)?;
    let (file, cube) = subject_and_cube(of, campaign, reading, watch)?;
    staged.spares(file.inputs.iter().map(|input| input.path.as_path()).chain(cube.as_deref()))?;
    let motion = file.motion.as_ref().map(|(motion, timing)| (motion, *timing));
    let scene = &file.scene;
    let is_filter = motion.is_some_and(|(_, timing)| timing.readout == Readout::Band);
    let count = scene.exposure.bands.len();
    let wanted = band.unwrap_or_else(|| study::reference_band(scene, motion));
    study::check_band(scene, wanted, "--band")?;
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
            let of = &raster.bands[band];
            let spectral = of.centre_um.map(|centre_um| [Some(centre_um), of.fwhm_um]);
            let plane = Plane { name, unit: String::new(), values: grid.means(&parts, &values, size[0]) };
            bands.push((plane, spectral));
        }
    }
    let mapped = Mapped { grid, entries: parts.len(), bands: bands.len() };
    let radius_m = mean_radius_m(&scene.body);
    ortho_folder::write(staged.path(), (&grid, radius_m), &parts, bands, &file.id)
        .map_err(|error| staged.named(error))?;
    staged.commit()?;
    Ok(mapped)
}

/// Mean distance of a body's vertices from its centre, m.
fn mean_radius_m(body: &Body) -> f64 {
    let (sum_m, count) = body
        .mesh
        .used_vertices_m()
        .fold((0.0, 0.0), |(sum_m, count), vertex_m| (sum_m + (vertex_m + body.origin_m).length(), count + 1.0));
    sum_m / f64::max(count, 1.0)
}
