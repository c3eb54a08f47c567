//! A scene becomes a product folder.

use crate::error::Result;
use crate::formats::Subject;
use crate::formats::product_folder::{Product, ProductFolder, ProductOptions, Written};
use crate::formats::report_json::Run;
use crate::integrate::Wanted;
use crate::product::FacetTable;
use crate::progress::Watch;
use crate::scene::Timing;
use crate::solve;
use crate::study::{self, Extremes, Moving, Observation, Put, Request};

/// Simulates a scene, by the models that are requested, and writes the product; `run` is asked at the end what `run.json` is to say.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if there is no room, if an input would be replaced, or if a check of the product does not
/// hold; [`Error::Unsupported`](crate::Error::Unsupported), as [`Setup::simulable`](crate::scene::Setup::simulable) says;
/// [`Error::Io`](crate::Error::Io); [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn simulate(
    mut subject: Subject,
    request: &Request,
    folder: ProductFolder,
    run: impl FnOnce() -> Run,
    watch: Watch<'_>,
) -> Result<Written> {
    folder.admit(&subject, [], false)?;
    let ProductOptions { footprints, planes_of, .. } = folder.options().clone();
    let wanted = Wanted { footprints, planes_of: &planes_of, ..Wanted::default() };
    let (extremes, plan) = super::plan::decide(&mut subject, request, watch)?;
    let mut product = folder.open(&subject)?;
    let mut put = |slab| product.put(slab, watch);
    let (table, observation) = look(&subject, (&extremes, request.tolerance), wanted, &mut put, watch)?;
    product.finish(Product { subject, table, table_from: None, observation, plan: Some(plan), maps: None }, run, watch)
}

/// Looks at a scene whose models are decided; `put` takes the radiance that optics let through, as it is made.
pub(super) fn look(
    subject: &Subject,
    (extremes, tolerance): (&Extremes, f64),
    wanted: Wanted<'_>,
    put: Put<'_>,
    watch: Watch<'_>,
) -> Result<(FacetTable, Observation<()>)> {
    let optics = subject.chain.as_ref().and_then(|chain| chain.optics.as_ref());
    let (scene, moves) = (&subject.scene, |(_, timing): &&(_, Timing)| timing.is_in_parts());
    Ok(match subject.motion.as_ref().filter(moves) {
        Some((motion, timing)) => {
            let moving = Moving { scene, motion, timing: *timing, optics };
            study::acquire_by_slabs(moving, (extremes, tolerance), wanted, put, watch)?
        }
        None => {
            let table = solve::solve(scene, watch)?;
            let mut observation = study::observe_through(scene, (&table, extremes), optics, wanted, put, watch)?;
            if let Some((motion, timing)) = &subject.motion {
                let moving = Moving { scene, motion, timing: *timing, optics };
                study::tell_exposure(moving, tolerance, &mut observation);
            }
            (table, observation)
        }
    })
}
