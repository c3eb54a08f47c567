//! Applies an instrument to a cube of radiance.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::envi::{EnviCube, Interleave, Precision};
use crate::formats::exr_cube::ExrCube;
use crate::formats::folder::Staged;
use crate::formats::instrument_toml::InstrumentFile;
use crate::formats::product_cubes::{CubeFile, CubeFormats, CubeSource};
use crate::formats::radiance_map;
use crate::formats::registry;
use crate::formats::report_json::{self, InstrumentReport, Run, SignalEntry};
use crate::instrument::Chain;
use crate::product::{CubeAxes, Quantity, Slab};
use crate::progress::{Watch, tell};
use crate::scene::Readout;
use crate::spectral::Band;
use crate::study::{Reader, Reading, over_cube};

/// Options.
#[derive(Debug, Clone)]
pub struct Asked {
    /// The cube: radiance, W m-2 sr-1 um-1, with wavelengths.
    pub cube: PathBuf,
    /// What is made of it.
    pub instrument: InstrumentFile,
    /// Whether optics may blur pixel means, which is an approximation.
    pub approximate: bool,
    /// Whether all lines share detector elements, as for a push-broom.
    pub by_line: bool,
    /// In which formats cubes are written.
    pub formats: CubeFormats,
    /// The cube of radiance as spectral OpenEXR as well.
    pub exr: bool,
}

/// Applies an instrument to a cube and writes a folder: `cube.img`, `dn.img` for a detector, and reports; `run`
/// supplies `run.json`.
///
/// # Errors
/// [`Error::Invalid`] if the cube has no wavelengths, or is not radiance; if optics blur and no approximation is wanted; [`Error::Io`]; [`Error::Interrupted`].
pub fn instrument(
    asked: &Asked,
    (folder, replace): (&Path, bool),
    run: impl FnOnce() -> Run,
    watch: Watch<'_>,
) -> Result<InstrumentReport> {
    let Chain { optics, detector } = &asked.instrument.chain;
    let mut remarks: Vec<String> = over_cube::remark(&asked.instrument.chain).into_iter().collect();
    if !remarks.is_empty() && !asked.approximate {
        let problem = Problem::new(
            Location::file(&asked.cube),
            "optics need sub-pixel detail, which a cube of pixel means lacks",
        )
        .with_help("put the optics into the scene and run `simulate`; or pass --approximate to blur the pixel means");
        return Err(Error::Invalid(vec![problem]));
    }
    let staged = Staged::folder(folder, replace)?;
    let mut raster = registry::image(&asked.cube)?;
    remarks.extend(raster.report.notes.iter().map(|note| format!("{}: {}", note.at, note.message)));
    if raster.unit.is_none() {
        remarks.push(format!(
            "{} does not state its unit (`data units`): its values are taken as radiance in {}",
            asked.cube.display(),
            Quantity::Radiance.unit()
        ));
    }
    if detector.is_some() && raster.bands.iter().any(|band| band.fwhm_um.is_some()) {
        let message = "bands of a cube have widths and no shapes: electrons are those of Gaussian responses, 1.064 times those of boxes as wide";
        remarks.push(message.to_owned());
    }
    let scale = raster.unit.as_deref().map_or(Some(1.0), radiance_map::radiance_scale);
    let centres: Option<Vec<Band>> = raster
        .bands
        .iter()
        .map(|band| Some(Band { name: band.name.clone(), ..Band::new(band.centre_um?, band.fwhm_um) }))
        .collect();
    let problem = |message: String| Err(Error::invalid(Location::file(&asked.cube), message));
    let Some(bands) = centres else { return problem("has bands without a wavelength".to_owned()) };
    let Some(scale) = scale else {
        let unit = raster.unit.clone().unwrap_or_default();
        return problem(format!("is in {unit}: radiance in {} is needed", Quantity::Radiance.unit()));
    };
    let inputs = raster.inputs()?;
    let all = inputs.iter().chain(&asked.instrument.inputs).map(|input| input.path.as_path());
    staged.spares(all)?;
    let axes = CubeAxes { samples: raster.columns, lines: raster.rows, bands, quantity: Quantity::Radiance };
    let readout = if asked.by_line { Readout::Line } else { Readout::Frame };
    let mut reader = detector.as_ref().map(|detector| Reader::new(detector, axes.clone(), (readout, 0))).transpose()?;
    let by = format!(" by mmxrt {}", env!("CARGO_PKG_VERSION"));
    let create = |name: &str, axes: CubeAxes, precision| {
        let title = format!("{}{by}", axes.quantity.title());
        EnviCube::create(&staged.path().join(name), axes, Interleave::Bsq, precision, &title)
    };
    let write = || -> Result<InstrumentReport> {
        let mut cube = create("cube.img", axes.clone(), Precision::F32)?;
        let sent = CubeAxes { quantity: Quantity::Counts, ..axes.clone() };
        let wide = detector.as_ref().is_some_and(|detector| detector.bits > 16);
        let precision = if wide { Precision::U32 } else { Precision::U16 };
        let mut numbers = detector.as_ref().map(|_| create("dn.img", sent, precision)).transpose()?;
        let title = format!("{}{by}", axes.quantity.title());
        let exr = asked.exr.then(|| ExrCube::create(&staged.path().join("cube.exr"), &axes, &title));
        let mut exr = exr.transpose()?;
        let (mut values, quiet) = (Vec::new(), crate::progress::unwatched);
        for (i, band) in axes.bands.iter().enumerate() {
            tell(watch, "bands", i as u64, axes.bands.len() as u64)?;
            raster.read(i, &mut values)?;
            values.iter_mut().for_each(|value| *value *= scale);
            let through = match optics {
                Some(optics) => over_cube::blurred(optics, band.centre_um, &values, [axes.samples, axes.lines]),
                None => values.clone(),
            };
            let slab = Slab::dense(0..axes.lines, i..i + 1, through);
            let mut put = |slab: &Slab| {
                exr.as_mut().map_or(Ok(()), |file| file.put(slab, &quiet))?;
                cube.put(slab, &quiet)
            };
            match (&mut reader, &mut numbers) {
                (Some(reader), Some(file)) => reader.read(&slab, |Reading { radiance, numbers }| {
                    file.put(&numbers, &quiet)?;
                    put(&radiance)
                })?,
                _ => put(&slab)?,
            }
        }
        cube.end()?;
        exr.map_or(Ok(()), ExrCube::end)?;
        numbers.map_or(Ok(()), EnviCube::end)?;
        let said = reader.as_ref().map(Reader::remarks).unwrap_or_default();
        let signal = reader.as_ref().map(SignalEntry::of);
        let inputs = inputs.iter().chain(&asked.instrument.inputs).map(report_json::Input::from).collect();
        let report = InstrumentReport {
            format_version: report_json::FORMAT_VERSION,
            mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
            inputs,
            signal,
            warnings: asked.instrument.notes.iter().cloned().chain(remarks.clone()).chain(said).collect(),
        };
        let path = staged.path().join("report.json");
        report_json::write(&path, &report)?;
        let quantities =
            [("cube", Quantity::Radiance)].into_iter().chain(detector.is_some().then_some(("dn", Quantity::Counts)));
        let cubes: Vec<CubeFile> = quantities
            .map(|(stem, quantity)| CubeFile { stem, quantity, words: quantity.title().to_owned(), planes: None })
            .collect();
        let source = CubeSource { by: &by, scene: None, report: report_json::text(&path, &report)? };
        asked.formats.write(staged.path(), &cubes, &source, watch)?;
        report_json::write(&staged.path().join("run.json"), &run())?;
        Ok(report)
    };
    let report = write().map_err(|e| staged.named(e))?;
    staged.commit()?;
    Ok(report)
}
