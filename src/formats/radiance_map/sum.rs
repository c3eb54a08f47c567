//! Maps that add up: `A+B*0.5`, once for each view.

use std::path::{Path, PathBuf};

use super::open;
use crate::error::{Error, Location, Problem, Result};
use crate::formats::npz;
use crate::formats::subject::Subject;
use crate::product::{FacetTable, RadianceMap};
use crate::progress::Watch;

/// A map, or a facet table, and its factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Summand {
    /// Where it is.
    pub path: PathBuf,
    /// What its radiance is multiplied by.
    pub weight: f64,
}

/// Reads `A+B*0.5`: paths and factors. A text that is an existing path is taken literally.
///
/// # Errors
/// [`Error::Invalid`] at the first map without a name, or with a weight that is not a number.
pub fn summands(text: &str) -> Result<Vec<Summand>> {
    if Path::new(text).exists() {
        return Ok(vec![Summand { path: text.into(), weight: 1.0 }]);
    }
    let summand = |part: &str| {
        let (mut path, mut weight) = (part.trim(), Ok(1.0));
        while let Some((before, factor)) = path.rsplit_once('*').filter(|_| !Path::new(path).exists()) {
            path = before.trim();
            let factor = factor.trim().parse::<f64>().map_err(|_| format!("{:?} is not a weight", factor.trim()));
            weight = weight.and_then(|weight| Ok(weight * factor?));
        }
        let weight = if path.is_empty() { Err("a map has no name".to_owned()) } else { weight };
        weight.map(|weight| Summand { path: path.into(), weight }).map_err(|message| {
            let at = Location::item(format!("--radiance {text:?}"));
            let help = "maps are joined as A.img+B.img*0.5; those with + or * in their names are named in map files, as `raster`";
            Error::Invalid(vec![Problem::new(at, message).with_help(help)])
        })
    };
    text.split('+').map(summand).collect()
}

/// The maps of a sum, opened.
#[derive(Debug, Default)]
pub struct Sum {
    /// Term by term, the maps of all views.
    pub terms: Vec<Vec<RadianceMap>>,
    /// The facet table among the summands, and its file.
    pub table: Option<(PathBuf, FacetTable)>,
}

/// Opens the maps of a sum, which is given once for each view; the subject learns what to report about them.
///
/// # Errors
/// Those of [`open`] and [`Subject::read_table`]; [`Error::Invalid`] if views have sums of different lengths, or if a facet table has
/// a weight or is named twice.
pub fn open_sum(views: &[Vec<Summand>], subject: &mut Subject, watch: Watch<'_>) -> Result<Sum> {
    let mut sum = Sum::default();
    // How many terms each view has.
    let mut counts: Vec<usize> = Vec::new();
    for view in views {
        let mut term = 0;
        for Summand { path, weight } in view {
            if is_table(path) {
                if *weight != 1.0 || sum.table.is_some() {
                    return Err(counts_once(path));
                }
                sum.table = Some((path.clone(), subject.read_table(path)?));
                continue;
            }
            let found = open(path, &subject.scene, *weight, watch)?;
            subject.inputs.extend(found.inputs);
            subject.warnings.extend(found.notes);
            if sum.terms.len() <= term {
                sum.terms.push(Vec::new());
            }
            sum.terms[term].extend(found.maps);
            term += 1;
        }
        counts.extend((term > 0).then_some(term));
    }
    if counts.iter().any(|count| *count != counts[0]) {
        let problem = Problem::new(Location::item("--radiance"), format!("names {counts:?} maps: each time as many"))
            .with_help("given several times, it names views of the same sum, its terms in the same order");
        return Err(Error::Invalid(vec![problem]));
    }
    sum.terms.retain(|term| !term.is_empty());
    Ok(sum)
}

/// That a facet table among maps is weighted, or not the only one.
pub(crate) fn counts_once(path: &Path) -> Error {
    let problem = Problem::new(Location::file(path), "a facet table counts once, and whole")
        .with_help("its light and heat are of this scene: other maps may have weights");
    Error::Invalid(vec![problem])
}

/// Whether a file is one of our facet tables.
fn is_table(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "npz")
        && npz::list(path).is_ok_and(|(header, _)| header.is_some_and(|h| h.format == npz::TABLE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_add_up_with_weights() {
        let of = |text: &str| {
            summands(text).unwrap().into_iter().map(|s| (s.path.display().to_string(), s.weight)).collect::<Vec<_>>()
        };
        assert_eq!(of("a.img"), [("a.img".into(), 1.0)]);
        assert_eq!(of("a.img + b/c.img*0.5"), [("a.img".into(), 1.0), ("b/c.img".into(), 0.5)]);
        let wrong = |text: &str| summands(text).unwrap_err().to_string();
        for (text, message) in [
            ("", "--radiance \"\": a map has no name"),
            ("a.img+", "a map has no name"),
            ("*2", "a map has no name"),
            ("a*b.img", "\"b.img\" is not a weight"),
            ("a.img*", "\"\" is not a weight"),
        ] {
            assert!(wrong(text).contains(message), "{}", wrong(text));
        }
    }
}
