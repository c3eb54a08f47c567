//! A page that shows what is in a file or folder.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::folder::Staged;
use crate::formats::manifest_json::{EntryState, Manifest};
use crate::formats::page::{Cells, Layer, Page, Stack};
use crate::formats::raster::Raster;
use crate::formats::{product_image, registry, report_json, spectra};
use crate::progress::Watch;

/// What page to write.
#[derive(Debug, Clone, Copy)]
pub struct PageOrder<'a> {
    /// The page; without one it is beside its input, and named after it, with `.html`.
    pub target: Option<&'a Path>,
    /// Images whose numbers take more are reduced, bytes.
    pub bytes: u64,
    /// Whether it may replace a page that is there.
    pub replace: bool,
}

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

/// A page that is being filled.
struct Draft<'a> {
    page: Page,
    sides: Vec<(String, usize)>,
    staged: &'a Staged,
    watch: Watch<'a>,
}

/// Writes the page of a product, a campaign's or chart's folder, an image or spectra.
///
/// # Errors
/// [`Error::Invalid`] for what has no page, and a page that is there unless it may be replaced; what is wrong with the input; [`Error::Interrupted`].
pub fn view(input: &Path, order: &PageOrder<'_>, watch: Watch<'_>) -> Result<Shown> {
    input.metadata().map_err(|e| Error::io(input, "reading", e))?;
    let target = order.target.map_or_else(|| beside(input), Path::to_owned);
    // A scene that is named by mistake is not to become a page, even if what is there may be replaced.
    if !target.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm")) {
        return Err(Error::invalid(Location::file(&target), "a page has a name that ends in .html"));
    }
    let staged = Staged::file(&target, order.replace)?;
    let name = input.canonicalize().unwrap_or_else(|_| input.to_owned());
    let name = name.file_name().map_or_else(|| input.display().to_string(), |name| name.to_string_lossy().into_owned());
    let cube = product_image(input, "cube");
    let there = |name: &str| input.join(name).is_file();
    let begin = |kind| Draft { page: Page::new(name.as_str(), kind), sides: Vec::new(), staged: &staged, watch };
    let mut draft;
    if cube.exists() {
        draft = begin("product");
        draft.product(input, &cube, order.bytes)?;
    } else if there("manifest.json") || CAMPAIGN.iter().any(|(_, name)| there(name)) {
        draft = begin("campaign");
        draft.campaign(input)?;
    } else if CHART.iter().any(|(_, name)| there(&format!("{name}.png"))) {
        draft = begin("chart");
        draft.chart(input)?;
    } else {
        match registry::of_input(input) {
            Ok((format, _)) if format.is_spectral() && registry::image(input).is_err() => {
                draft = begin("spectra");
                draft.curves(input)?;
            }
            found => {
                let mut raster = registry::image(input).map_err(|e| refused(input, &found, e))?;
                draft = begin("image");
                let layer =
                    Layer { key: "cube", title: "Image", cells: Cells::Mean, bytes: order.bytes, least_side: 1 };
                draft.add(&mut raster, &layer)?;
            }
        }
    }
    let Draft { page, sides, .. } = draft;
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
    if input.join("products").is_dir() && input.join("sights").is_dir() {
        let problem = Problem::new(Location::file(input), "is a campaign that has no maps yet");
        return Error::Invalid(vec![problem.with_help("view it when all is made, or one of its products now")]);
    }
    let problem = Problem::new(Location::file(input), "is nothing that a page can show");
    let help = "a product folder of `simulate` or `integrate`, the folder of a campaign or a chart, an image, or spectra can be viewed; `mmxrt inspect` tells of other files";
    Error::Invalid(vec![problem.with_help(help)])
}

impl Draft<'_> {
    /// Adds an image, reduced to what it may take.
    fn add(&mut self, raster: &mut Raster, layer: &Layer) -> Result<()> {
        let stack = self.read(raster, layer)?;
        self.put(raster, layer, stack);
        Ok(())
    }

    fn read(&self, raster: &mut Raster, layer: &Layer) -> Result<Stack> {
        self.spares(raster.files())?;
        Stack::read(raster, layer, self.watch)
    }

    fn put(&mut self, raster: &Raster, layer: &Layer, stack: Stack) {
        self.sides.push((layer.key.to_owned(), stack.side));
        self.page.stack(stack);
        raster.report.notes.iter().for_each(|note| self.page.warn(note.to_string()));
    }

    /// Refuses to write the page over what is read.
    fn spares<P: AsRef<Path>>(&self, files: impl IntoIterator<Item = P>) -> Result<()> {
        let files: Vec<P> = files.into_iter().collect();
        self.staged.spares(files.iter().map(AsRef::as_ref))
    }

    fn product(&mut self, folder: &Path, cube: &Path, bytes: u64) -> Result<()> {
        for (title, name) in [("Quick look", "quicklook.png"), ("Quick look, colours", "quicklook_rgb.png")] {
            let path = folder.join(name);
            if path.is_file() {
                self.spares([&path])?;
                self.page.picture(title, &path)?;
            }
        }
        let report = folder.join("report.json");
        self.spares([&report])?;
        match report_json::read::<serde_json::Value>(&report) {
            Ok(report) => self.page.report(report),
            Err(_) if !report.is_file() => {
                self.page.warn("report.json is not there: names of materials, directions and warnings are not known")
            }
            Err(e) => self.page.warn(format!("report.json cannot be read: {e}")),
        }
        let thermal = product_image(folder, "thermal");
        // Half for the cube and its thermal part, half for the planes.
        let half = bytes / 2;
        let each = if thermal.exists() { half / 2 } else { half };
        let mut image = registry::image(cube)?;
        let size = [image.columns, image.rows];
        let part = self.part(&thermal, &image)?;
        let layer = |key, title| Layer { key, title, cells: Cells::Mean, bytes: each, least_side: 1 };
        let (mut of_cube, mut of_part) = (layer("cube", "Cube"), layer("thermal", "Thermal part"));
        let mut stack = self.read(&mut image, &of_cube)?;
        let mut read = None;
        if let Some(mut part) = part {
            // The difference of their cells is what is reflected: these are of one size.
            of_part.least_side = stack.side;
            let found = self.read(&mut part, &of_part)?;
            if found.side > stack.side {
                of_cube.least_side = found.side;
                stack = self.read(&mut image, &of_cube)?;
            }
            read = Some((part, found));
        }
        self.put(&image, &of_cube, stack);
        // What it holds of its file is needed no more.
        drop(image);
        if let Some((part, found)) = read {
            self.put(&part, &of_part, found);
        }
        let backplanes = folder.join("backplanes.img");
        if backplanes.is_file() {
            let mut raster = registry::image(&backplanes)?;
            if self.is_of_size(&raster, size) {
                let layer =
                    Layer { key: "planes", title: "Backplanes", cells: Cells::Middle, bytes: half, least_side: 1 };
                self.add(&mut raster, &layer)?;
            }
        } else {
            self.page.warn("backplanes.img is not there: positions, angles and what is sky are not known");
        }
        Ok(())
    }

    /// The thermal part of a cube, if it is there; says so if it is of other pixels or bands.
    fn part(&mut self, path: &Path, cube: &Raster) -> Result<Option<Raster>> {
        if !path.exists() {
            return Ok(None);
        }
        let part = registry::image(path)?;
        let [there, wanted] = [&part, cube].map(|of| of.bands.len());
        if there != wanted {
            let path = part.path.display();
            self.page.warn(format!("{path}: has {there} bands, the cube has {wanted}; it is not shown"));
        }
        Ok((there == wanted && self.is_of_size(&part, [cube.columns, cube.rows])).then_some(part))
    }

    /// Whether an image is as large as the cube; says so if not.
    fn is_of_size(&mut self, raster: &Raster, size: [usize; 2]) -> bool {
        let is = [raster.columns, raster.rows] == size;
        if !is {
            self.page.warn(format!("{}: is not as large as the cube, and not shown", raster.path.display()));
        }
        is
    }

    fn campaign(&mut self, folder: &Path) -> Result<()> {
        let manifest = folder.join("manifest.json");
        let pictures = CAMPAIGN.map(|(title, name)| (title, folder.join(name)));
        self.spares(pictures.iter().map(|(_, path)| path).chain([&manifest]))?;
        for (title, path) in &pictures {
            if path.is_file() {
                self.page.picture(title, path)?;
            }
        }
        if !manifest.is_file() {
            self.page.warn("manifest.json is not there: not all acquisitions have been tried yet");
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
        self.page.table("Acquisitions", &head, rows.collect());
        Ok(())
    }

    fn chart(&mut self, folder: &Path) -> Result<()> {
        for (title, name) in CHART {
            let [png, csv] = ["png", "csv"].map(|ending| folder.join(format!("{name}.{ending}")));
            self.spares([&png, &csv])?;
            if png.is_file() {
                self.page.picture(title, &png)?;
            }
            if csv.is_file() {
                self.page.text(&format!("{name}.csv"), &csv)?;
            }
        }
        Ok(())
    }

    fn curves(&mut self, path: &Path) -> Result<()> {
        self.spares([path])?;
        let (libraries, report) = spectra::read(path)?;
        for library in &libraries {
            for column in &library.columns {
                let name = [library.name.as_str(), column.name.as_str()];
                let name = name.iter().filter(|name| !name.is_empty()).copied().collect::<Vec<_>>().join(": ");
                self.page.curve(&name, &library.wavelength_um, &column.values);
            }
        }
        report.notes.iter().for_each(|note| self.page.warn(note.to_string()));
        Ok(())
    }
}
