//! Curves to look at, as a table and as a drawing: spectra of a pixel, of the Sun, or of a file, the phase curve of a surface.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Result};
use crate::formats::folder::Staged;
use crate::formats::pixel::PixelValues;
use crate::formats::product_folder;
use crate::formats::spectrum_svg::{self, Curve};
use crate::spectral::{Column, SpectralLibrary, solar_e490};
use crate::study::PhaseCurve;

/// Of the Sun's spectrum what lies beyond, um, is too dim to be seen in a drawing.
const DRAWN_TO_UM: f64 = 4.0;

/// Curves as a table and as a drawing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CurveSheet {
    /// The table, as CSV.
    pub csv: String,
    /// The drawing, as SVG.
    pub svg: String,
    /// What it is made from, which it must not replace.
    inputs: Vec<PathBuf>,
}

impl CurveSheet {
    /// Of a pixel of this product folder.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be read.
    pub fn of_pixel(folder: &Path, pixel: &PixelValues) -> Result<Self> {
        let title = format!("{}, sample {}, line {}", folder.display(), pixel.sample, pixel.line);
        let (um, curves) = pixel.curves();
        let svg = spectrum_svg::draw(&title, "um", "radiance, W m-2 sr-1 um-1", &um, &curves);
        let mut inputs: Vec<PathBuf> =
            product_folder::files(folder)?.into_iter().map(|(name, _)| folder.join(name)).collect();
        inputs.push(folder.to_owned());
        Ok(CurveSheet { csv: pixel.csv(), svg, inputs })
    }

    /// Of the built-in spectrum of the Sun.
    pub fn of_sun() -> Self {
        let (um, irradiance) = (solar_e490().wavelength_um(), solar_e490().value());
        let mut csv = String::from("# the Sun at 1 au, ASTM E490-00a (2000)\nwavelength_um,irradiance_w_m2_um\n");
        um.iter().zip(irradiance).for_each(|(um, value)| csv.push_str(&format!("{um},{value}\n")));
        let shown = um.partition_point(|um| *um <= DRAWN_TO_UM);
        let curves = [("E490", irradiance[..shown].to_vec())];
        let svg = spectrum_svg::draw("The Sun at 1 au, ASTM E490-00a", "um", "W m-2 um-1", &um[..shown], &curves);
        CurveSheet { csv, svg, inputs: vec![] }
    }

    /// Of the spectra in a file, each over its own wavelengths.
    pub fn of_spectra(file: &Path, spectra: &[SpectralLibrary]) -> Self {
        let columns = || spectra.iter().flat_map(|library| library.columns.iter().map(move |column| (library, column)));
        let name = |(library, column): (&SpectralLibrary, &Column)| match library.columns.len() {
            _ if library.name.is_empty() => column.name.clone(),
            1 => library.name.clone(),
            _ => format!("{}, {}", library.name, column.name),
        };
        let names: Vec<String> = columns().map(name).collect();
        let mut csv = String::from("spectrum,wavelength_um,value\n");
        for ((library, column), name) in columns().zip(&names) {
            // A name is one cell, whatever it has in it.
            let cell = format!("\"{}\"", name.replace('"', "\"\""));
            library.wavelength_um.iter().zip(&column.values).for_each(|(um, value)| {
                csv.push_str(&format!("{cell},{um},{value}\n"));
            });
        }
        let curves: Vec<Curve> = columns()
            .zip(&names)
            .map(|((library, column), name)| Curve { name, x: &library.wavelength_um, values: &column.values })
            .collect();
        let svg = spectrum_svg::draw_each(&file.display().to_string(), "um", "value", &curves);
        // The numbers of a header may lie beside it, and the other way round.
        let inputs = ["sli", "hdr"].map(|ending| file.with_extension(ending)).into_iter().chain([file.to_owned()]);
        CurveSheet { csv, svg, inputs: inputs.collect() }
    }

    /// Of a surface, from these files: brightness of a sphere of it over phase angles.
    pub fn of_surface(name: &str, curve: &PhaseCurve, inputs: Vec<PathBuf>) -> Self {
        let mut csv =
            format!("# disc-integrated brightness of a sphere of {name} over that of a white Lambert disc\nphase_deg");
        curve.columns.iter().for_each(|(name, _)| csv.push_str(&format!(",{}", name.replace(' ', "_"))));
        csv.push('\n');
        for (i, phase_deg) in curve.phase_deg.iter().enumerate() {
            csv.push_str(&phase_deg.to_string());
            curve.columns.iter().for_each(|(_, values)| csv.push_str(&format!(",{}", values[i])));
            csv.push('\n');
        }
        let curves: Vec<(&str, Vec<f64>)> =
            curve.columns.iter().map(|(name, values)| (name.as_str(), values.clone())).collect();
        let title = format!("A sphere of {name}");
        let svg = spectrum_svg::draw(
            &title,
            "phase angle, deg",
            "geometric albedo x phase function",
            &curve.phase_deg,
            &curves,
        );
        CurveSheet { csv, svg, inputs }
    }

    /// Writes the table, the drawing, or both.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a drawing whose name does not end in `.svg` or is the table's, and if what it is made from would be replaced; those
    /// of [`Staged::file`]; [`Error::Io`]. Then neither is written.
    pub fn write(&self, csv: Option<&Path>, svg: Option<&Path>, replace: bool) -> Result<()> {
        if let Some(svg) = svg.filter(|path| path.extension().is_none_or(|e| e != "svg")) {
            let message = "curves are drawn as SVG: give it a name that ends in .svg";
            return Err(Error::invalid(Location::file(svg), message));
        }
        if let Some(csv) = csv.filter(|csv| svg == Some(*csv)) {
            return Err(Error::invalid(Location::file(csv), "is named for the table and for the drawing"));
        }
        let mut written = Vec::new();
        for (target, content) in [(csv, &self.csv), (svg, &self.svg)] {
            let Some(target) = target else { continue };
            let staged = Staged::file(target, replace)?;
            staged.spares(self.inputs.iter().map(PathBuf::as_path))?;
            staged.put(staged.path(), |out| std::io::Write::write_all(out, content.as_bytes()))?;
            written.push(staged);
        }
        written.into_iter().try_for_each(Staged::commit)
    }
}
