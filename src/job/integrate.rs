//! A scene, and the radiance that its facets send, become a product folder.

use std::path::PathBuf;

use crate::error::{Error, Location, Result};
use crate::formats::Subject;
use crate::formats::product_folder::{Product, ProductFolder, ProductOptions, Written};
use crate::formats::radiance_map::{self, Summand};
use crate::formats::report_json::Run;
use crate::geometry::Texels;
use crate::instrument::Chain;
use crate::integrate::{ViewChoice, Wanted};
use crate::progress::Watch;
use crate::study::{Extremes, Fill, MapOptions, Moving};
use crate::{solve, study};

/// Where the radiance of facets comes from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Radiance {
    /// A facet table.
    pub table: Option<PathBuf>,
    /// Maps that add up, once for each view; a facet table may be among them.
    pub maps: Vec<Vec<Summand>>,
    /// Which of maps of several views serve a facet.
    pub choice: ViewChoice,
    /// What a map is between the centres of its texels.
    pub texels: Texels,
    /// What is shown where no map knows the radiance.
    pub fill: Fill,
}

/// Looks at a scene by a facet table or maps, and writes the product; `run` is asked at the end what `run.json` is to say.
///
/// # Errors
/// [`Error::Invalid`] without any radiance, and those of [`simulate`](super::simulate), of [`open_sum`](radiance_map::open_sum) and of
/// [`observe_maps`](study::observe_maps).
pub fn integrate(
    mut subject: Subject,
    radiance: &Radiance,
    folder: ProductFolder,
    run: impl FnOnce() -> Run,
    watch: Watch<'_>,
) -> Result<Written> {
    let in_parts = subject.motion.clone().filter(|(_, timing)| timing.is_in_parts());
    let Radiance { table, maps, choice, texels, fill } = radiance;
    let ProductOptions { footprints, planes_of, .. } = folder.options().clone();
    let given = table.as_ref().map(|path| Ok((path.clone(), subject.read_table(path)?))).transpose()?;
    if maps.is_empty() {
        let (path, table) =
            given.ok_or_else(|| Error::invalid(Location::item("--table"), "give `--table`, `--radiance`, or both"))?;
        folder.admit(&subject, [&path], false)?;
        let wanted = Wanted { footprints, planes_of: &planes_of, ..Wanted::default() };
        let extremes = Extremes::with_shadows(&subject.scene, watch)?;
        let mut product = folder.open(&subject)?;
        let mut put = |slab| product.put(slab, watch);
        let optics = subject.chain.as_ref().and_then(|chain| chain.optics.as_ref());
        let scene = &subject.scene;
        let mut observation = match &in_parts {
            Some((motion, timing)) => {
                let moving = Moving { scene, motion, timing: *timing, optics };
                study::acquire_by_table(moving, &table, (&extremes, study::TOLERANCE), wanted, &mut put, watch)?
            }
            None => study::observe_through(scene, (&table, &extremes), optics, wanted, &mut put, watch)?,
        };
        observation.warnings.extend(study::left_out_of_table(&observation.effects));
        return product.finish(
            Product { subject, table, table_from: Some(path), observation, plan: None, maps: None },
            run,
            watch,
        );
    }
    let sum = radiance_map::open_sum(maps, &mut subject, watch)?;
    if let (Some((path, _)), Some(_)) = (&sum.table, &given) {
        return Err(radiance_map::counts_once(path));
    }
    if *choice == ViewChoice::Interpolated && sum.terms.iter().all(|views| views.len() < 2) {
        subject.warnings.push("--views interpolated: there is one view, and nothing to interpolate between".to_owned());
    }
    let add_solved = sum.table.is_some();
    let (table_from, table) = given.or(sum.table).unzip();
    if subject.chain.as_ref().is_some_and(|chain| chain.optics.is_some()) {
        let message = "the sensor's optics do not blur maps in this version: `mmxrt instrument` does that to the cube, about as well as its pixels allow";
        subject.warnings.push(message.to_owned());
        subject.chain = subject.chain.map(|chain| Chain { optics: None, ..chain });
    }
    folder.admit(&subject, &table_from, true)?;
    let table = match table {
        Some(table) => table,
        None if *fill == Fill::Solved => solve::solve(&subject.scene, watch)?,
        None => solve::lit(&subject.scene, watch)?,
    };
    let options = MapOptions { choice: *choice, texels: *texels, fill: *fill, add_solved, footprints };
    let mut product = folder.open(&subject)?;
    let mut put = |slab| product.put(slab, watch);
    let scene = &subject.scene;
    let (observation, maps) = match &in_parts {
        Some((motion, timing)) => {
            let moving = Moving { scene, motion, timing: *timing, optics: None };
            let wanted = Wanted { planes_of: &planes_of, ..Wanted::default() };
            let of = (&options, study::TOLERANCE);
            study::acquire_by_maps(moving, (&table, sum.terms), of, wanted, &mut put, watch)?
        }
        None => study::observe_maps_by_slabs(scene, &table, sum.terms, &options, &mut put, watch)?,
    };
    product.finish(Product { subject, table, table_from, observation, plan: None, maps: Some(maps) }, run, watch)
}
