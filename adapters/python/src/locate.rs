//! Where on the ground pixels look, and in which pixels points of the ground lie.

use mmxrt::formats::Subject;
use mmxrt::progress::{Watch, tell as told};
use mmxrt::study::check_band;
use mmxrt::study::locate::{Locator, Place};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use super::errors::argument;
use super::source::Source;
use super::work::work;

/// Answers questions about a scene, in their order, by a locator and the band, from 0.
fn answers<Q: Sync, A: Send>(
    source: &Source,
    band: Option<usize>,
    questions: &[Q],
    answer: impl Fn(&Locator<'_>, &Q, usize) -> mmxrt::Result<A> + Sync,
    watch: Watch<'_>,
) -> mmxrt::Result<Vec<A>> {
    let subject = Subject::from(source.file(watch)?);
    told(watch, "tree", 0, 1)?;
    let locator = Locator::new(&subject.scene, subject.motion.as_ref().map(|(motion, timing)| (motion, *timing)));
    told(watch, "tree", 1, 1)?;
    let band = match band {
        Some(band) => band.checked_sub(1).ok_or_else(|| argument("band", "bands are counted from 1"))?,
        None => locator.reference_band(),
    };
    check_band(&subject.scene, band, "band")?;
    questions.par_iter().map(|question| answer(&locator, question, band)).collect()
}

/// Puts flat arrays under their names.
fn put(made: &Bound<'_, PyDict>, columns: Vec<(&str, Vec<f64>)>) -> PyResult<()> {
    columns.into_iter().try_for_each(|(name, values)| made.set_item(name, values.into_pyarray(made.py())))
}

/// The ground that places of the image show: NaN, and facet -1, where there is none.
#[pyfunction]
pub(crate) fn ground<'py>(
    py: Python<'py>,
    source: Source,
    pixels: Vec<(f64, f64)>,
    band: Option<usize>,
    tell: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let found = work(py, tell, |watch| {
        let answer = |locator: &Locator<'_>, (sample, line): &(f64, f64), band| {
            locator.ground(Place { sample: *sample, line: *line }, band)
        };
        answers(&source, band, &pixels, answer, watch)
    })?;
    let of = |value: &dyn Fn(&mmxrt::study::locate::Ground) -> f64| -> Vec<f64> {
        found.iter().map(|ground| ground.as_ref().map_or(f64::NAN, value)).collect()
    };
    let made = PyDict::new(py);
    put(
        &made,
        vec![
            ("x_m", of(&|ground| ground.point_m.x)),
            ("y_m", of(&|ground| ground.point_m.y)),
            ("z_m", of(&|ground| ground.point_m.z)),
            ("latitude_deg", of(&|ground| ground.latitude_longitude_deg()[0])),
            ("longitude_deg", of(&|ground| ground.latitude_longitude_deg()[1])),
            ("range_m", of(&|ground| ground.range_m)),
            ("local_emission_deg", of(&|ground| ground.local_emission_rad.to_degrees())),
        ],
    )?;
    let facets: Vec<i64> =
        found.iter().map(|ground| ground.as_ref().map_or(-1, |ground| ground.facet.into())).collect();
    made.set_item("facet", facets.into_pyarray(py))?;
    Ok(made)
}

/// The places of the image that show points of the ground: NaN where a point is never before the camera.
#[pyfunction]
pub(crate) fn place<'py>(
    py: Python<'py>,
    source: Source,
    points_m: Vec<[f64; 3]>,
    band: Option<usize>,
    tell: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let found = work(py, tell, |watch| {
        let answer = |locator: &Locator<'_>, point_m: &[f64; 3], band| locator.place((*point_m).into(), band);
        answers(&source, band, &points_m, answer, watch)
    })?;
    let of = |value: &dyn Fn(&mmxrt::study::locate::Seen) -> f64| -> Vec<f64> {
        found.iter().map(|seen| seen.as_ref().map_or(f64::NAN, value)).collect()
    };
    let made = PyDict::new(py);
    put(
        &made,
        vec![
            ("sample", of(&|seen| seen.place.sample)),
            ("line", of(&|seen| seen.place.line)),
            ("range_m", of(&|seen| seen.range_m)),
        ],
    )?;
    let inside: Vec<bool> = found.iter().map(|seen| seen.as_ref().is_some_and(|seen| seen.inside)).collect();
    let hidden: Vec<bool> =
        found.iter().map(|seen| seen.as_ref().is_some_and(|seen| seen.hidden_by.is_some())).collect();
    made.set_item("inside", inside.into_pyarray(py))?;
    made.set_item("hidden", hidden.into_pyarray(py))?;
    Ok(made)
}
