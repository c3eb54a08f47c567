//! Products: in folders, as the command writes them, or in memory.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use clap::ValueEnum;
use mmxrt::formats::envi::{Interleave, Precision};
use mmxrt::formats::folder;
use mmxrt::formats::product_cubes::{CubeFormat, CubeFormats};
use mmxrt::formats::product_folder::{Product, ProductFolder, ProductOptions};
use mmxrt::formats::radiance_map;
use mmxrt::geometry::Texels;
use mmxrt::integrate::ViewChoice;
use mmxrt::job::{self, Held, Radiance};
use mmxrt::product::{Cube, CubeAxes, FacetTable, Plane, Quantity};
use mmxrt::progress::{Progress, Watch, tell as told};
use mmxrt::{Error, Location, Problem, Result};
use numpy::{Element, IntoPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use super::cli::console::Console;
use super::cli::integrate::{Between, Views, fill};
use super::cli::product::{FormatName, InterleaveName, PrecisionName, QuantityName};
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

/// The choice that the command has under a name.
fn chosen<N: ValueEnum + Into<T>, T>(what: &str, name: &str) -> Result<T> {
    N::from_str(name, false).map(Into::into).map_err(|_| {
        let all = N::value_variants().iter().filter_map(N::to_possible_value);
        let names: Vec<String> = all.map(|value| value.get_name().to_owned()).collect();
        argument(what, format!("{name:?} is none of {}", names.join(", ")))
    })
}

impl Options {
    /// As the library has them; all that cannot be used at once.
    fn checked(&self) -> Result<ProductOptions> {
        let interleave = chosen::<InterleaveName, Interleave>("interleave", &self.interleave);
        let precision = chosen::<PrecisionName, Precision>("dtype", &self.dtype);
        let quantity = chosen::<QuantityName, Quantity>("quantity", &self.quantity);
        let planes_of: Result<Vec<usize>> = (self.planes_of.iter())
            .map(|band| band.checked_sub(1).ok_or_else(|| argument("planes_of", "bands are counted from 1")))
            .collect();
        let asked: Result<Vec<CubeFormat>> =
            self.format.iter().map(|name| chosen::<FormatName, CubeFormat>("format", name)).collect();
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
    let reading = source.reading(py)?;
    work(py, tell, |watch| {
        let console = Console::new(true, false, false);
        let watch = |progress: Progress| console.watch(progress) && watch(progress);
        let (request, options) = (request(model, tolerance)?, options.checked()?);
        folder::settle(&out, true)?;
        let staged = ProductFolder::stage(&out, force, options)?;
        let subject = source.subject(&reading, ideal, &watch)?;
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
    let reading = source.reading(py)?;
    work(py, tell, |watch| {
        let console = Console::new(true, false, false);
        let watch = |progress: Progress| console.watch(progress) && watch(progress);
        let (views, texels, unknown) = how;
        let radiance = Radiance {
            table,
            maps: radiance.iter().map(|text| radiance_map::summands(text)).collect::<Result<_>>()?,
            choice: chosen::<Views, ViewChoice>("views", &views)?,
            texels: chosen::<Between, Texels>("texels", &texels)?,
            fill: fill(&unknown).map_err(|message| argument("unknown", message))?,
        };
        let options = options.checked()?;
        folder::settle(&out, true)?;
        let staged = ProductFolder::stage(&out, force, options)?;
        let subject = source.subject(&reading, false, &watch)?;
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
///
/// # Errors
/// [`Error::Invalid`] if the system does not provide the memory; [`Error::Interrupted`].
fn numbers<T: Number>(cube: &Cube, watch: Watch<'_>) -> Result<Vec<T>> {
    let CubeAxes { samples, lines, bands, .. } = &cube.axes;
    let pixels = samples * lines;
    let mut all: Vec<T> = Vec::new();
    let count = pixels.saturating_mul(bands.len());
    if all.try_reserve_exact(count).is_err() {
        let message = format!("the system does not give memory for {count} numbers: is there a limit (`ulimit -v`)?");
        let problem = Problem::new(Location::item("sensor"), message);
        return Err(Error::Invalid(vec![problem.with_help("give `out`: a folder is written a few lines at a time")]));
    }
    all.resize(count, T::default());
    let (total, done) = (bands.len() as u64, AtomicU64::new(0));
    all.par_chunks_mut((pixels * BANDS).max(1)).enumerate().try_for_each(|(chunk, values)| {
        let bands = chunk * BANDS..((chunk + 1) * BANDS).min(bands.len());
        cube.expand(0..pixels, bands.clone(), |pixel, band, some| {
            for (i, value) in some.iter().enumerate() {
                values[(band - bands.start + i) * pixels + pixel] = T::of(*value);
            }
        });
        let more = bands.len() as u64;
        told(watch, "arrays", done.fetch_add(more, Relaxed) + more, total)
    })?;
    Ok(all)
}

/// The numbers of a cube in the precision that was asked for.
enum Numbers {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl Numbers {
    fn of(cube: &Cube, precision: Precision, watch: Watch<'_>) -> Result<Self> {
        match precision {
            Precision::F64 => numbers(cube, watch).map(Numbers::Double),
            _ => numbers(cube, watch).map(Numbers::Single),
        }
    }

    fn into_array(self, py: Python<'_>) -> Bound<'_, PyAny> {
        match self {
            Numbers::Single(all) => all.into_pyarray(py).into_any(),
            Numbers::Double(all) => all.into_pyarray(py).into_any(),
        }
    }
}

/// A product in memory, number by number.
struct Dense {
    axes: CubeAxes,
    cube: Numbers,
    thermal: Option<Numbers>,
    dn: Option<Vec<u32>>,
    planes: Vec<Plane>,
    table: Option<FacetTable>,
    report: String,
}

impl Dense {
    /// Of weights, which are dropped.
    fn of(held: Held, options: &ProductOptions, watch: Watch<'_>) -> Result<Self> {
        let Held { product: Product { table, observation, .. }, cube, numbers: sent, report } = held;
        let numbers_of = |cube: &Cube| Numbers::of(cube, options.precision, watch);
        Ok(Dense {
            cube: numbers_of(&cube)?,
            thermal: options.split.then(|| numbers_of(&cube.thermal())).transpose()?,
            dn: sent.map(|sent| numbers(&sent, watch)).transpose()?,
            axes: cube.axes,
            planes: observation.backplanes.planes,
            table: options.table.then_some(table),
            report: serde_json::to_string(&report)
                .map_err(|e| Error::invalid(Location::item("report"), e.to_string()))?,
        })
    }

    /// Bytes of what it makes of each pixel in each band.
    fn number_bytes(options: &ProductOptions, has_detector: bool) -> u64 {
        let of_cube = if options.precision == Precision::F64 { 8 } else { 4 };
        of_cube * if options.split { 2 } else { 1 } + if has_detector { 4 } else { 0 }
    }
}

/// Simulates a scene in memory: a dictionary of flat arrays, with their shape.
#[pyfunction]
pub(crate) fn hold<'py>(
    py: Python<'py>,
    source: Source,
    model: &str,
    tolerance: f64,
    ideal: bool,
    options: Options,
    tell: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let reading = source.reading(py)?;
    let Dense { axes, cube, thermal, dn, planes, table: facets, report } = work(py, tell, |watch| {
        let (request, options) = (request(model, tolerance)?, options.checked()?);
        let subject = source.subject(&reading, ideal, watch)?;
        let has_detector = subject.chain.as_ref().is_some_and(|chain| chain.detector.is_some());
        let bytes = Dense::number_bytes(&options, has_detector);
        Dense::of(job::hold(subject, &request, options.quantity, bytes, watch)?, &options, watch)
    })?;
    let made = PyDict::new(py);
    let CubeAxes { samples, lines, bands, .. } = &axes;
    made.set_item("shape", (bands.len(), *lines, *samples))?;
    let centres: Vec<f64> = bands.iter().map(|band| band.centre_um).collect();
    let widths: Vec<f64> = bands.iter().map(|band| band.fwhm_um.unwrap_or(f64::NAN)).collect();
    made.set_item("wavelength_um", centres.into_pyarray(py))?;
    made.set_item("fwhm_um", widths.into_pyarray(py))?;
    made.set_item("cube", cube.into_array(py))?;
    if let Some(thermal) = thermal {
        made.set_item("thermal", thermal.into_array(py))?;
    }
    if let Some(dn) = dn {
        made.set_item("dn", dn.into_pyarray(py))?;
    }
    if let Some(facets) = facets {
        made.set_item("table", table::columns(py, facets)?)?;
    }
    let planes: Vec<_> =
        (planes.into_iter()).map(|Plane { name, unit, values }| (name, unit, values.into_pyarray(py))).collect();
    made.set_item("planes", planes)?;
    made.set_item("report", report)?;
    Ok(made)
}
