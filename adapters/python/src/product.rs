//! Products: in folders, as the command writes them, or in memory.

use std::path::PathBuf;

use mmxrt::formats::envi::{Interleave, Precision};
use mmxrt::formats::folder;
use mmxrt::formats::product_cubes::{CubeFormat, CubeFormats};
use mmxrt::formats::product_folder::{Product, ProductFolder, ProductOptions};
use mmxrt::formats::radiance_map;
use mmxrt::geometry::Texels;
use mmxrt::integrate::ViewChoice;
use mmxrt::job::{self, Held, Radiance};
use mmxrt::product::{Cube, CubeAxes, Plane, Quantity};
use mmxrt::progress::Progress;
use mmxrt::study::Fill;
use mmxrt::{Error, Result};
use numpy::{Element, IntoPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use super::cli::console::Console;
use super::errors::argument;
use super::source::{Source, request};
use super::table;
use super::work::work;

/// Bands that are expanded together.
const BANDS: usize = 8;

/// What is to be written, and how.
#[derive(FromPyObject)]
pub(crate) struct Options {
    #[pyo3(item)]
    format: Vec<String>,
    #[pyo3(item)]
    interleave: String,
    #[pyo3(item)]
    dtype: String,
    #[pyo3(item)]
    quantity: String,
    #[pyo3(item)]
    table: bool,
    #[pyo3(item)]
    split: bool,
    #[pyo3(item)]
    footprints: bool,
    #[pyo3(item)]
    planes_of: Vec<usize>,
}

/// The choice of a name.
fn chosen<T: Copy>(what: &str, name: &str, choices: &[(&str, T)]) -> Result<T> {
    choices.iter().find(|(known, _)| *known == name).map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<&str> = choices.iter().map(|(known, _)| *known).collect();
        argument(what, format!("{name:?} is none of {}", names.join(", ")))
    })
}

fn quantity(name: &str) -> Result<Quantity> {
    use Quantity::{BandRadiance, BrightnessTemperature, Radiance, RadianceFactor, ReflectanceFactor};
    let all = [Radiance, BandRadiance, RadianceFactor, ReflectanceFactor, BrightnessTemperature];
    chosen("quantity", name, &all.map(|quantity| (quantity.name(), quantity)))
}

impl Options {
    /// As the library has them; all that cannot be used at once.
    fn checked(&self) -> Result<ProductOptions> {
        let interleaves = [("bsq", Interleave::Bsq), ("bil", Interleave::Bil), ("bip", Interleave::Bip)];
        let interleave = chosen("interleave", &self.interleave, &interleaves);
        let precision = chosen("dtype", &self.dtype, &[("f32", Precision::F32), ("f64", Precision::F64)]);
        let quantity = quantity(&self.quantity);
        let planes_of: Result<Vec<usize>> = (self.planes_of.iter())
            .map(|band| band.checked_sub(1).ok_or_else(|| argument("planes_of", "bands are counted from 1")))
            .collect();
        let formats = [
            ("envi", CubeFormat::Envi),
            ("pds4", CubeFormat::Pds4),
            ("netcdf", CubeFormat::Netcdf),
            ("zarr", CubeFormat::Zarr),
            ("fits", CubeFormat::Fits),
            ("exr", CubeFormat::Exr),
        ];
        let asked: Result<Vec<CubeFormat>> = self.format.iter().map(|name| chosen("format", name, &formats)).collect();
        match (interleave, precision, quantity, planes_of, asked) {
            (Ok(interleave), Ok(precision), Ok(quantity), Ok(planes_of), Ok(asked)) => Ok(ProductOptions {
                interleave,
                precision,
                formats: CubeFormats::from(asked.as_slice()),
                exr: asked.contains(&CubeFormat::Exr),
                footprints: self.footprints,
                planes_of,
                table: self.table,
                split: self.split,
                quantity,
            }),
            (a, b, c, d, e) => {
                let errors = [a.err(), b.err(), c.err(), d.err(), e.err()];
                Err(Error::Invalid(errors.iter().flatten().flat_map(Error::problems).collect()))
            }
        }
    }
}

/// Simulates a scene into a product folder, as `mmxrt simulate`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn simulate(
    py: Python<'_>,
    source: Source,
    out: PathBuf,
    force: bool,
    model: &str,
    tolerance: f64,
    ideal: bool,
    options: Options,
    tell: &Bound<'_, PyAny>,
) -> PyResult<()> {
    work(py, tell, |watch| {
        let console = Console::new(true, false, false);
        let watch = |progress: Progress| console.watch(progress) && watch(progress);
        let (request, options) = (request(model, tolerance)?, options.checked()?);
        folder::settle(&out, true)?;
        let staged = ProductFolder::stage(&out, force, options)?;
        let subject = source.subject(ideal, &watch)?;
        job::simulate(subject, &request, staged, || console.run("simulate"), &watch)?;
        Ok(())
    })
}

/// Makes a product folder of a scene and the radiance of its facets, as `mmxrt integrate`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn integrate(
    py: Python<'_>,
    source: Source,
    table: Option<PathBuf>,
    radiance: Vec<String>,
    out: PathBuf,
    force: bool,
    how: (String, String, String),
    options: Options,
    tell: &Bound<'_, PyAny>,
) -> PyResult<()> {
    work(py, tell, |watch| {
        let console = Console::new(true, false, false);
        let watch = |progress: Progress| console.watch(progress) && watch(progress);
        let (views, texels, unknown) = how;
        let fill = match (unknown.as_str(), unknown.parse::<f64>()) {
            ("error", _) => Fill::default(),
            ("solve", _) => Fill::Solved,
            ("nan", _) => Fill::Nan,
            (_, Ok(value)) if value >= 0.0 && value.is_finite() => Fill::Value(value),
            _ => return Err(argument("unknown", "give error, solve, nan, or a radiance of at least 0")),
        };
        let radiance = Radiance {
            table,
            maps: radiance.iter().map(|text| radiance_map::summands(text)).collect::<Result<_>>()?,
            choice: chosen(
                "views",
                &views,
                &[("nearest", ViewChoice::Nearest), ("interpolated", ViewChoice::Interpolated)],
            )?,
            texels: chosen("texels", &texels, &[("nearest", Texels::Nearest), ("bilinear", Texels::Bilinear)])?,
            fill,
        };
        let options = options.checked()?;
        folder::settle(&out, true)?;
        let staged = ProductFolder::stage(&out, force, options)?;
        let subject = source.subject(false, &watch)?;
        job::integrate(subject, &radiance, staged, || console.run("integrate"), &watch)?;
        Ok(())
    })
}

/// A number of an array, from the double precision of sums.
trait Number: Element + Copy + Send + Sync + Default {
    fn of(value: f64) -> Self;
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
}

impl Number for f32 {
    fn of(value: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "single precision is asked for")]
        let single = value as f32;
        single
    }
}

impl Number for u32 {
    fn of(value: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "a detector's whole numbers have at most 32 bits")]
        #[expect(clippy::cast_sign_loss, reason = "and are not negative")]
        let whole = value as u32;
        whole
    }
}

/// The numbers of a cube, [band, line, sample].
fn numbers<T: Number>(cube: &Cube) -> Vec<T> {
    let CubeAxes { samples, lines, bands, .. } = &cube.axes;
    let pixels = samples * lines;
    let mut all = vec![T::default(); pixels * bands.len()];
    all.par_chunks_mut((pixels * BANDS).max(1)).enumerate().for_each(|(chunk, values)| {
        let first = chunk * BANDS;
        cube.expand(0..pixels, first..(first + BANDS).min(bands.len()), |pixel, band, some| {
            for (i, value) in some.iter().enumerate() {
                values[(band - first + i) * pixels + pixel] = T::of(*value);
            }
        });
    });
    all
}

fn array<'py>(py: Python<'py>, cube: &Cube, is_double: bool) -> Bound<'py, PyAny> {
    match is_double {
        true => py.detach(|| numbers::<f64>(cube)).into_pyarray(py).into_any(),
        false => py.detach(|| numbers::<f32>(cube)).into_pyarray(py).into_any(),
    }
}

/// Simulates a scene in memory: a dictionary of flat arrays, with their shape.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn hold<'py>(
    py: Python<'py>,
    source: Source,
    model: &str,
    tolerance: f64,
    ideal: bool,
    options: Options,
    tell: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let held = work(py, tell, |watch| {
        let (request, quantity) = (request(model, tolerance)?, options.checked()?.quantity);
        job::hold(source.subject(ideal, watch)?, &request, quantity, watch)
    })?;
    let Held { product: Product { table: facets, observation, .. }, cube, numbers: sent, report } = held;
    let is_double = options.dtype == "f64";
    let made = PyDict::new(py);
    let CubeAxes { samples, lines, bands, .. } = &cube.axes;
    made.set_item("shape", (bands.len(), *lines, *samples))?;
    let centres: Vec<f64> = bands.iter().map(|band| band.centre_um).collect();
    let widths: Vec<f64> = bands.iter().map(|band| band.fwhm_um.unwrap_or(f64::NAN)).collect();
    made.set_item("wavelength_um", centres.into_pyarray(py))?;
    made.set_item("fwhm_um", widths.into_pyarray(py))?;
    made.set_item("cube", array(py, &cube, is_double))?;
    if options.split {
        made.set_item("thermal", array(py, &cube.thermal(), is_double))?;
    }
    if let Some(sent) = &sent {
        made.set_item("dn", py.detach(|| numbers::<u32>(sent)).into_pyarray(py))?;
    }
    if options.table {
        made.set_item("table", table::columns(py, facets)?)?;
    }
    let planes: Vec<_> = (observation.backplanes.planes.into_iter())
        .map(|Plane { name, unit, values }| (name, unit, values.into_pyarray(py)))
        .collect();
    made.set_item("planes", planes)?;
    let report = serde_json::to_string(&report).map_err(|e| pyo3::exceptions::PyValueError::new_err(e.to_string()))?;
    made.set_item("report", report)?;
    Ok(made)
}
