//! A page that shows what is in a file or folder.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::folder::Staged;
use crate::formats::manifest_json::{EntryState, Manifest};
use crate::formats::page::{Cells, Page, Stack, side};
use crate::formats::raster::Raster;
use crate::formats::{product_image, registry, report_json, spectra};
use crate::progress::Watch;

/// What has been written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    /// The page.
    pub page: PathBuf,
    /// What it shows, as "product".
    pub kind: &'static str,
    /// Its size.
    pub bytes: u64,
    /// Sides of the cells, pixels, whose means stand for the numbers of an image, and of those of its backplanes.
    pub sides: Vec<(String, usize)>,
}

/// What is in a folder besides an image.
const CAMPAIGN: [(&str, &str); 2] = [
    ("Best sampling of the surface", "coverage_sampling.png"),
    ("How often the surface is seen", "coverage_count.png"),
];
const CHART: [(&str, &str); 2] = [("Error against time", "chart"), ("Where methods fail", "stability")];

/// Writes the page of a product, a campaign's or chart's folder, an image or spectra. Without a target it is called as the input, with `.html`, and is beside it.
/// Images whose numbers take more than `bytes` are reduced.
///
/// # Errors
/// [`Error::Invalid`] for what has no page, and a page that is there unless `replace` is set; what is wrong with the input; [`Error::Interrupted`].
pub fn view(input: &Path, target: Option<&Path>, (bytes, replace): (u64, bool), watch: Watch<'_>) -> Result<Shown> {
    input.metadata().map_err(|e| Error::io(input, "reading", e))?;
    let target = target.map_or_else(|| beside(input), Path::to_owned);
    let staged = Staged::file(&target, replace)?;
    let mut sides = Vec::new();
    let name = input.canonicalize().unwrap_or_else(|_| input.to_owned());
    let name = name.file_name().map_or_else(|| input.display().to_string(), |name| name.to_string_lossy().into_owned());
    let cube = product_image(input, "cube");
    let there = |name: &str| input.join(name).is_file();
    let mut page;
    if cube.exists() {
        page = Page::new(name, "product");
        product(&mut page, (input, &cube), (bytes, &mut sides), &staged, watch)?;
    } else if there("manifest.json") || CAMPAIGN.iter().any(|(_, name)| there(name)) {
        page = Page::new(name, "campaign");
        let manifest = input.join("manifest.json");
        staged.spares(
            CAMPAIGN
                .iter()
                .map(|(_, name)| input.join(name))
                .chain([manifest])
                .collect::<Vec<_>>()
                .iter()
                .map(PathBuf::as_path),
        )?;
        campaign(&mut page, input)?;
    } else if CHART.iter().any(|(_, name)| there(&format!("{name}.png"))) {
        page = Page::new(name, "chart");
        let files =
            CHART.iter().flat_map(|(_, name)| ["png", "csv"].map(|ending| input.join(format!("{name}.{ending}"))));
        staged.spares(files.collect::<Vec<_>>().iter().map(PathBuf::as_path))?;
        chart(&mut page, input)?;
    } else {
        match registry::of_input(input) {
            Ok((format, _)) if format.is_spectral() && registry::image(input).is_err() => {
                page = Page::new(name, "spectra");
                staged.spares([input])?;
                curves(&mut page, input)?;
            }
            found => {
                let mut raster = registry::image(input).map_err(|e| refused(input, &found, e))?;
                page = Page::new(name, "image");
                add(&mut page, &mut raster, ("cube", "Image", Cells::Mean, bytes), &mut sides, &staged, watch)?;
            }
        }
    }
    if page.is_empty() {
        return Err(nothing(input));
    }
    let kind = page.kind();
    let bytes = page.write(&staged)?;
    staged.commit()?;
    Ok(Shown { page: target, kind, bytes, sides })
}

/// The page of an input if no other is named: as `scene` and `scene.toml` have `scene.html` and `scene.toml.html`.
fn beside(input: &Path) -> PathBuf {
    // `.` and `..` have no name of their own.
    let named = if input.file_name().is_some() { input.to_owned() } else { input.canonicalize().unwrap_or_default() };
    let mut name = named.file_name().unwrap_or("page".as_ref()).to_owned();
    name.push(".html");
    named.with_file_name(name)
}

/// Says what has a page, of what has none; what is wrong with an image that is one is said as it is.
fn refused(input: &Path, found: &Result<(&crate::formats::Format, PathBuf)>, error: Error) -> Error {
    match found {
        Ok((format, _)) if format.is_image() => error,
        // A folder cannot be read as a file, which is not what is wrong with it.
        _ if input.is_file() && matches!(error, Error::Io { .. }) => error,
        _ => nothing(input),
    }
}

fn nothing(input: &Path) -> Error {
    let problem = Problem::new(Location::file(input), "is nothing that a page can show");
    let help = "a product folder of `simulate` or `integrate`, the folder of a campaign or a chart, an image, or spectra can be viewed; `mmxrt inspect` tells of other files";
    Error::Invalid(vec![problem.with_help(help)])
}

/// Adds an image, reduced to a budget.
fn add(
    page: &mut Page,
    raster: &mut Raster,
    (key, title, cells, bytes): (&str, &str, Cells, u64),
    sides: &mut Vec<(String, usize)>,
    staged: &Staged,
    watch: Watch<'_>,
) -> Result<()> {
    staged.spares(raster.files().iter().map(PathBuf::as_path))?;
    let side = side([raster.columns, raster.rows], raster.bands.len(), bytes);
    page.stack(Stack::read(raster, (key, title), (cells, side), watch)?);
    raster.report.notes.iter().for_each(|note| page.warn(note.to_string()));
    sides.push((key.to_owned(), side));
    Ok(())
}

fn product(
    page: &mut Page,
    (folder, cube): (&Path, &Path),
    (bytes, sides): (u64, &mut Vec<(String, usize)>),
    staged: &Staged,
    watch: Watch<'_>,
) -> Result<()> {
    for (title, name) in [("Quick look", "quicklook.png"), ("Quick look, colours", "quicklook_rgb.png")] {
        let path = folder.join(name);
        if path.is_file() {
            staged.spares([path.as_path()])?;
            page.picture(title, &path)?;
        }
    }
    let report = folder.join("report.json");
    staged.spares([report.as_path()])?;
    match report_json::read::<serde_json::Value>(&report) {
        Ok(report) => page.report(report),
        Err(_) if !report.is_file() => {
            page.warn("report.json is not there: names of materials, directions and warnings are not known")
        }
        Err(e) => page.warn(format!("report.json cannot be read: {e}")),
    }
    let thermal = product_image(folder, "thermal");
    // Half for the cube and its thermal part, half for the planes.
    let half = bytes / 2;
    let each = if thermal.exists() { half / 2 } else { half };
    let mut image = registry::image(cube)?;
    let size = [image.columns, image.rows];
    add(page, &mut image, ("cube", "Cube", Cells::Mean, each), sides, staged, watch)?;
    drop(image);
    let fits = |raster: &Raster, page: &mut Page| {
        let fits = [raster.columns, raster.rows] == size;
        if !fits {
            page.warn(format!("{}: is not as large as the cube, and not shown", raster.path.display()));
        }
        fits
    };
    if thermal.exists() {
        let mut raster = registry::image(&thermal)?;
        if fits(&raster, page) {
            add(page, &mut raster, ("thermal", "Thermal part", Cells::Mean, each), sides, staged, watch)?;
        }
    }
    let backplanes = folder.join("backplanes.img");
    if backplanes.is_file() {
        let mut raster = registry::image(&backplanes)?;
        if fits(&raster, page) {
            add(page, &mut raster, ("planes", "Backplanes", Cells::Middle, half), sides, staged, watch)?;
        }
    } else {
        page.warn("backplanes.img is not there: positions, angles and what is sky are not known");
    }
    Ok(())
}

fn campaign(page: &mut Page, folder: &Path) -> Result<()> {
    for (title, name) in CAMPAIGN {
        let path = folder.join(name);
        if path.is_file() {
            page.picture(title, &path)?;
        }
    }
    let manifest = folder.join("manifest.json");
    if !manifest.is_file() {
        page.warn("manifest.json is not there: not all acquisitions have been tried yet");
        return Ok(());
    }
    let manifest: Manifest = report_json::read(&manifest)?;
    let rows = manifest.acquisitions.iter().map(|entry| {
        let state = match entry.state {
            EntryState::Done => "done".to_owned(),
            EntryState::Failed => format!("failed: {}", entry.errors.join("; ")),
        };
        let warned = entry.first_warning.clone().unwrap_or_default();
        vec![entry.name.clone(), entry.epoch_utc.clone(), state, entry.warnings.to_string(), warned]
    });
    let head = ["acquisition", "begins, UTC", "state", "warnings", "the first of them"];
    page.table("Acquisitions", &head, rows.collect());
    Ok(())
}

fn chart(page: &mut Page, folder: &Path) -> Result<()> {
    for (title, name) in CHART {
        let [png, csv] = ["png", "csv"].map(|ending| folder.join(format!("{name}.{ending}")));
        if png.is_file() {
            page.picture(title, &png)?;
        }
        if csv.is_file() {
            page.text(&format!("{name}.csv"), &csv)?;
        }
    }
    Ok(())
}

fn curves(page: &mut Page, path: &Path) -> Result<()> {
    let (libraries, report) = spectra::read(path)?;
    for library in &libraries {
        for column in &library.columns {
            let name = [library.name.as_str(), column.name.as_str()];
            let name = name.iter().filter(|name| !name.is_empty()).copied().collect::<Vec<_>>().join(": ");
            page.curve(&name, &library.wavelength_um, &column.values);
        }
    }
    report.notes.iter().for_each(|note| page.warn(note.to_string()));
    Ok(())
}
