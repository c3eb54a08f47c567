//! A scene becomes a product folder.

use crate::error::Result;
use crate::formats::Subject;
use crate::formats::product_folder::{Product, ProductFolder, Written};
use crate::formats::report_json::Run;
use crate::integrate::Wanted;
use crate::progress::Watch;
use crate::solve;
use crate::study::{self, Request};

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
    let wanted = Wanted { footprints: folder.options().footprints, ..Wanted::default() };
    let (extremes, plan) = super::plan::decide(&mut subject, request, watch)?;
    let table = solve::solve(&subject.scene, watch)?;
    let mut product = folder.open(&subject.scene)?;
    let mut put = |slab| product.put(slab, watch);
    let observation = study::observe_by_slabs(&subject.scene, (&table, &extremes), wanted, &mut put, watch)?;
    product.finish(Product { subject, table, table_from: None, observation, plan: Some(plan), maps: None }, run, watch)
}
