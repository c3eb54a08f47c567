//! What DART's tables of optical properties hold: names, order, units and ranges of their columns.
//!
//! Databases and text spectra have the same columns. DART reads them by place.

use std::collections::BTreeMap;

use crate::error::{Error, Location, Problem, Result, number};
use crate::report::{Fate, Report};
use crate::spectral::SpectralLibrary;
use crate::units::percent_from_fraction;

/// What a table describes, judging by its columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableKind {
    /// Reflectance and transmittances of a Lambertian facet.
    Lambertian,
    /// Hapke's parameters in the form of SOILSPECT.
    Hapke,
    /// The parameters of Rahman, Pinty and Verstraete.
    Rpv,
    /// A fluid that scatters as two Henyey-Greenstein functions.
    FluidHenyeyGreenstein,
    /// A fluid with Rayleigh scattering.
    FluidRayleigh,
    /// Specular reflection, in the form of older versions.
    Specular,
    /// A leaf's roughness.
    Roughness,
    /// A complex refractive index.
    RefractiveIndex,
    /// Irradiance of the Sun, W m-2 um-1.
    SolarIrradiance,
    /// Columns that are none of these.
    Other,
}

/// Kinds, what they call wavelength, and their other columns, in DART's order. The first whose columns are all there counts.
const KINDS: [(TableKind, &str, &[&str]); 9] = [
    (TableKind::Lambertian, "wavelength", LAMBERTIAN),
    (TableKind::Hapke, "wavelength", &["w", "c1", "c2", "c3", "c4", "h1", "h2"]),
    (TableKind::Rpv, "wavelength", &["reflectance", "k", "g", "h"]),
    (TableKind::FluidHenyeyGreenstein, "wavelength", &["sigma", "albedo", "a", "g1", "g2"]),
    (TableKind::FluidRayleigh, "wavelength", &["sigma", "albedo", "a", "c"]),
    (
        TableKind::Specular,
        "lambda",
        &[
            "n_down",
            "intensity_factor_up_to_down",
            "angular_divergence_up_to_down",
            "k_power_up_to_down",
            "n_up",
            "intensity_factor_down_to_up",
            "angular_divergence_down_to_up",
            "k_power_down_to_up",
        ],
    ),
    (
        TableKind::Roughness,
        "lambda",
        &["bottom", "top", "bottom_index", "top_index", "bottom_refraction_index", "top_refraction_index"],
    ),
    (TableKind::RefractiveIndex, "lambda", &["n", "k"]),
    (TableKind::SolarIrradiance, "wavelength", &["irradiance"]),
];
const LAMBERTIAN: &[&str] = &["reflectance", "direct_transmittance", "diffuse_transmittance"];

impl TableKind {
    /// What columns, wavelength and the row's number left out, describe.
    pub fn of<'a>(columns: impl Iterator<Item = &'a str> + Clone) -> TableKind {
        let has = |name: &&str| columns.clone().any(|c| same(c, name));
        KINDS.iter().find(|(_, _, names)| names.iter().all(has)).map_or(TableKind::Other, |kind| kind.0)
    }

    /// The columns in DART's order, without wavelength; none for [`TableKind::Other`].
    pub fn columns(self) -> &'static [&'static str] {
        KINDS.iter().find(|kind| kind.0 == self).map_or(&[], |kind| kind.2)
    }

    fn wavelength(self) -> &'static str {
        KINDS.iter().find(|kind| kind.0 == self).map_or("wavelength", |kind| kind.1)
    }
}

/// Whether two names of tables or columns are the same to DART.
pub(crate) fn same(a: &str, b: &str) -> bool {
    a.eq_ignore_ascii_case(b)
}

pub(super) fn is_wavelength(column: &str) -> bool {
    same(column, "wavelength") || same(column, "lambda")
}

/// Whether a column is one of DART's.
pub(crate) fn is_known(column: &str) -> bool {
    KINDS.iter().any(|kind| kind.2.iter().any(|name| same(column, name)))
}

/// Whether DART holds a column in percent: in every kind of table these mean the same.
pub(crate) fn is_percent(column: &str) -> bool {
    LAMBERTIAN.iter().any(|name| same(column, name))
}

/// The values that a column may have, percent as fractions.
pub(crate) fn range(column: &str) -> (f64, f64) {
    const FRACTIONS: [&str; 3] = ["w", "albedo", "emissivity"];
    const SIGNED: [&str; 10] = ["c1", "c2", "c3", "c4", "a", "c", "g", "g1", "g2", "h"];
    match column.to_lowercase().as_str() {
        name if is_percent(name) || FRACTIONS.contains(&name) => (0.0, 1.0),
        name if is_known(name) && !SIGNED.contains(&name) => (0.0, f64::INFINITY),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    }
}

/// What to say of a number outside its [`range`], shown in a unit that is `unit` for 1.
pub(crate) fn outside((least, most): (f64, f64), unit: f64) -> String {
    if most.is_finite() { format!("is outside {} to {}", least * unit, most * unit) } else { "is negative".into() }
}

/// Checks the order of a table's columns: DART reads them by place.
///
/// # Errors
/// [`Error::Invalid`] if there are no wavelengths, or if DART would take one column for another.
pub(super) fn check_order(names: &[&str], at: &Location) -> Result<()> {
    let invalid =
        |message: String, help: String| Err(Error::Invalid(vec![Problem::new(at.clone(), message).with_help(help)]));
    let Some(wavelength) = names.iter().find(|name| is_wavelength(name)) else {
        let help = "it is um, ascending".into();
        return invalid(format!("no column `wavelength` among {}", names.join(", ")), help);
    };
    let expected: Vec<&str> =
        [wavelength].into_iter().chain(TableKind::of(names.iter().copied()).columns()).copied().collect();
    if expected.iter().zip(names).all(|(a, b)| same(a, b)) {
        return Ok(());
    }
    let found = names.join(", ");
    let message =
        format!("the columns are {found}: DART reads them by their place, and would take one for another in silence");
    invalid(message, format!("put them in the order {}", expected.join(", ")))
}

/// Percentages that never exceed 1 are reported: the manual itself uses both.
pub(super) fn suspect_fractions(library: &SpectralLibrary, at: Location, report: &mut Report) {
    let most = library.column("reflectance").unwrap_or_default().iter().copied().fold(0.0, f64::max);
    if most > 0.0 && most <= 0.01 {
        let message = "no reflectance is above 1: probably fractions where percent is meant; taken as percent";
        report.note(Fate::Defaulted, at, message);
    }
}

/// The name of a model's table: characters other than letters, digits and `_` become `_`, and one is put before a leading digit.
pub fn model_name(name: &str) -> String {
    let plain = name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' });
    let gap = name.chars().next().filter(|c| c.is_numeric()).map(|_| '_');
    gap.into_iter().chain(plain).collect()
}

/// The tables' names of models: they must differ, also from those that are `taken`. `at` is the place of a name.
///
/// # Errors
/// [`Error::Invalid`] with all names that are there twice, or empty.
pub(crate) fn distinct_names<'a>(
    models: &'a [SpectralLibrary],
    taken: impl Iterator<Item = &'a str>,
    at: impl Fn(&str) -> Location,
    report: &mut Report,
) -> Result<Vec<String>> {
    let mut problems = Vec::new();
    let mut taken: BTreeMap<String, Option<&str>> = taken.map(|name| (name.to_ascii_lowercase(), None)).collect();
    let mut names = Vec::new();
    for model in models {
        let name = model_name(&model.name);
        if name != model.name {
            report.note(Fate::Approximated, at(&name), format!("the name {:?} is written as {name}", model.name));
        }
        let mut told = |message: String, help: &str| problems.push(Problem::new(at(&name), message).with_help(help));
        match taken.insert(name.to_ascii_lowercase(), Some(&model.name)) {
            None if name.is_empty() => told("a model has no name".into(), "give it one"),
            None => {}
            Some(None) => told("is there already".into(), "choose another name"),
            Some(Some(other)) if other == model.name => told("appears twice".into(), "rename one of them"),
            Some(Some(other)) => {
                told(format!("{other:?} and {:?} become the same name", model.name), "rename one of them")
            }
        }
        names.push(name);
    }
    if problems.is_empty() { Ok(names) } else { Err(Error::Invalid(problems)) }
}

/// A table in DART's form: columns in its order, wavelength first, and in its units.
pub(super) struct DartTable {
    pub(super) kind: TableKind,
    pub(super) names: Vec<String>,
    pub(super) values: Vec<Vec<f64>>,
}

impl DartTable {
    /// Makes a table of spectra. The report lists transmittances that were taken to be 0, and columns that no kind of table has.
    ///
    /// # Errors
    /// [`Error::Invalid`] for what [`SpectralLibrary::check`] refuses, and for values outside their range.
    pub(super) fn of(library: &SpectralLibrary, at: &Location, report: &mut Report) -> Result<Self> {
        library.check()?;
        let given = || library.columns.iter().map(|c| c.name.as_str());
        let mut kind = TableKind::of(given());
        // Columns beside a reflectance would stand where DART looks for transmittances; with those of RPV it is not a Lambert surface.
        let is_of_rpv = |name: &str| TableKind::Rpv.columns()[1..].iter().any(|column| same(column, name));
        let is_lambertian = library.column("reflectance").is_some() && !given().any(is_of_rpv);
        let foreign = |name: &&str| kind == TableKind::Other && is_lambertian && !is_percent(name);
        let left_out: Vec<&str> = given().filter(foreign).collect();
        if kind == TableKind::Other && is_lambertian {
            kind = TableKind::Lambertian;
            let lacking: Vec<&str> = LAMBERTIAN.iter().copied().filter(|n| library.column(n).is_none()).collect();
            let message = format!("no {} given: 0, as of an opaque surface", lacking.join(" or "));
            report.note(Fate::Defaulted, at.clone(), message);
        }
        if !left_out.is_empty() {
            let message = format!("{}: a table of a Lambert surface has no such column", left_out.join(", "));
            report.note(Fate::Dropped, at.clone(), message);
        }
        if kind == TableKind::Other {
            let message = format!("DART is not known to have tables of {}", given().collect::<Vec<_>>().join(", "));
            report.note(Fate::Approximated, at.clone(), message);
        }
        let zeros = vec![0.0; library.wavelength_um.len()];
        let rest = given().filter(|name| !kind.columns().iter().any(|k| same(k, name)) && !left_out.contains(name));
        let mut table =
            DartTable { kind, names: vec![kind.wavelength().to_owned()], values: vec![library.wavelength_um.clone()] };
        let mut problems = Vec::new();
        for name in kind.columns().iter().copied().chain(rest) {
            let values = library.column(name).unwrap_or(&zeros);
            let (least, most) = range(name);
            if let Some(bad) = values.iter().find(|v| !(least..=most).contains(*v)) {
                let message = format!("{name}: {} {}", number(*bad), outside((least, most), 1.0));
                problems.push(Problem::new(at.clone(), message));
            }
            table.names.push(model_name(name));
            table.values.push(match is_percent(name) {
                true => values.iter().map(|v| percent_from_fraction(*v)).collect(),
                false => values.to_vec(),
            });
        }
        if problems.is_empty() { Ok(table) } else { Err(Error::Invalid(problems)) }
    }
}
