//! The folder of a chart: error against time as a table, a drawing and a page.

mod csv;
mod mitsuba;
mod page;
mod picture;
mod pixels;
mod stability_csv;
mod stability_page;
mod stability_picture;

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use super::drawing::Drawing;
use super::folder::{FolderKind, Staged};
use super::quicklook::png_bytes;
use crate::error::{Error, Location, Result};
use crate::study::chart::Chart;
use crate::study::stability::Hazard;

/// A folder of charts.
const KIND: FolderKind = FolderKind {
    marks: &["chart.csv", "stability.csv"],
    parts: &[
        "chart.csv",
        "chart.svg",
        "chart.png",
        "chart.html",
        "stability.csv",
        "stability_points.csv",
        "stability.svg",
        "stability.png",
        "stability.html",
        "mitsuba",
    ],
    holds: None,
};

/// Pixels of a PNG for a px of the drawing.
const SCALE: f64 = 2.0;

/// A folder of charts that is being made, hidden until it is whole.
#[derive(Debug)]
pub struct ChartFolder(Staged);

impl ChartFolder {
    /// Begins a folder, before anything is computed: it may not be possible.
    ///
    /// # Errors
    /// Those of [`Staged::folder`].
    pub fn stage(target: &Path, replace: bool) -> Result<Self> {
        Ok(ChartFolder(Staged::folder_of(&KIND, target, replace)?))
    }

    /// Refuses to replace what the chart is made from.
    ///
    /// # Errors
    /// [`Error::Invalid`].
    pub fn spares<'a>(&self, inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
        self.0.spares(inputs)
    }

    /// Where it is made.
    fn path(&self) -> &Path {
        self.0.path()
    }

    fn put(&self, path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
        self.0.put(path, write)
    }

    /// Writes a chart, and gives the folder its name. `timed` says what clock and how many threads its times are of.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(self, chart: &Chart, timed: &str) -> Result<Vec<PathBuf>> {
        let drawing = picture::draw(chart);
        let page = page::page(chart, &drawing, timed);
        self.write_files("chart", &[("chart.csv", &csv::csv(chart))], &drawing, &page)
    }

    /// Writes where methods fail, and gives the folder its name.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write_stability(self, hazards: &[Hazard]) -> Result<Vec<PathBuf>> {
        let drawing = stability_picture::draw(hazards);
        let page = stability_page::page(hazards, &drawing);
        let (table, points) = (stability_csv::table(hazards), stability_csv::points(hazards));
        let tables = [("stability.csv", table.as_str()), ("stability_points.csv", &points)];
        self.write_files("stability", &tables, &drawing, &page)
    }

    fn write_files(self, name: &str, tables: &[(&str, &str)], drawing: &Drawing, page: &str) -> Result<Vec<PathBuf>> {
        let ChartFolder(staged) = self;
        let too_large = || Error::invalid(Location::file(name), "the drawing is too large");
        let (rgb, size) = drawing.rgb(SCALE).ok_or_else(too_large)?;
        let png = png_bytes(size, png::ColorType::Rgb, &rgb);
        let svg = drawing.svg();
        let tables = tables.iter().map(|(name, text)| (PathBuf::from(name), text.as_bytes()));
        let pictures = [("svg", svg.as_bytes()), ("png", &png), ("html", page.as_bytes())];
        let pictures = pictures.map(|(ending, content)| (PathBuf::from(format!("{name}.{ending}")), content));
        let mut names = Vec::new();
        for (file, content) in tables.chain(pictures) {
            staged.put(&staged.path().join(&file), |out| out.write_all(content))?;
            names.push(file);
        }
        staged.commit()?;
        Ok(names)
    }
}
