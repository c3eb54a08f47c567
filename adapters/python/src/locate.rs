//! Where on the ground pixels look, and in which pixels points of the ground lie.

use mmxrt::formats::Subject;
use mmxrt::formats::points_csv::{Asked, Found, Question};
use mmxrt::job;
use mmxrt::study::check_band;
use mmxrt::study::locate::{Ground, Place, Seen};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::errors::argument;
use super::source::Source;
use super::work::work;

/// What is found, in the order of what is asked; of the band, from 1, or of the reference.
fn found(
    py: Python<'_>,
    source: &Source,
    asked: impl Iterator<Item = Asked>,
    band: Option<usize>,
    tell: &Bound<'_, PyAny>,
) -> PyResult<Vec<Found>> {
    let reading = source.reading(py)?;
    let asked: Vec<Asked> = asked.collect();
    work(py, tell, |watch| {
        let from_1 = |band: usize| band.checked_sub(1).ok_or_else(|| argument("band", "bands are counted from 1"));
        let band = band.map(from_1).transpose()?;
        let subject = Subject::from(source.file(&reading, watch)?);
        band.map_or(Ok(()), |band| check_band(&subject.scene, band, "band"))?;
        let questions: Vec<Question> = asked.iter().map(|asked| Question { asked: *asked, band }).collect();
        let answers = job::answers(&subject, &reading, &questions, watch)?;
        Ok(answers.into_iter().map(|(_, found)| found).collect())
    })
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
    let asked = pixels.iter().map(|(sample, line)| Asked::Pixel(Place { sample: *sample, line: *line }));
    let all = found(py, &source, asked, band, tell)?;
    let found: Vec<Option<Ground>> =
        all.into_iter().map(|found| if let Found::Ground(ground) = found { ground } else { None }).collect();
    let of = |value: &dyn Fn(&Ground) -> f64| -> Vec<f64> {
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
    let asked = points_m.iter().map(|point_m| Asked::Ground((*point_m).into()));
    let all = found(py, &source, asked, band, tell)?;
    let found: Vec<Option<Seen>> =
        all.into_iter().map(|found| if let Found::Place(seen) = found { seen } else { None }).collect();
    let of = |value: &dyn Fn(&Seen) -> f64| -> Vec<f64> {
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
