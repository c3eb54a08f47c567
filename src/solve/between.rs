//! A table between two moments at which the scene has been solved: shadows and light between facets go from one to the other in
//! proportion to time; what each source sends to a facet that it sees is that of the moment.

use super::irradiance;
use crate::product::{FacetTable, Lighting, Reflected, Sees};
use crate::scene::{Scene, Thermal};
use crate::visibility::Seen;

/// The table of a scene at a moment, `share` of the way from one table to another, both of the same scene at other moments.
pub fn between(scene: &Scene, [before, after]: [&FacetTable; 2], share: f64) -> FacetTable {
    let facets = scene.body.mesh.facets.len();
    let sources =
        scene.sources().into_iter().zip(before.sources.iter().zip(&after.sources)).map(|(source, (a, b))| Lighting {
            source: source.name.into_owned(),
            field: source.field,
            irradiance: vec![0.0; facets],
            sees: seen_between(&a.sees, &b.sees, share),
        });
    let temperature = |like: &[f64]| vec![0.0; like.len()];
    let mut table = FacetTable {
        sources: sources.collect(),
        temperature_lit_k: temperature(&before.temperature_lit_k),
        temperature_shaded_k: temperature(&before.temperature_shaded_k),
        reflected: vec![],
        sampling: before.sampling,
        models: scene.models,
    };
    irradiance::fill(scene, &mut table);
    let nearest = if share < 0.5 { before } else { after };
    table.reflected = match reflected_between(&before.reflected, &after.reflected, share) {
        Some(reflected) => reflected,
        None => nearest.reflected.clone(),
    };
    for reflected in &mut table.reflected {
        // The light of the moment, which a table is checked by.
        let of = |source: crate::scene::Source| {
            let [light, on_the_way] = scene.incoming_w_m2_um(source.incoming, reflected.light, reflected.um);
            light * on_the_way
        };
        reflected.sources = scene.sources().into_iter().map(of).collect();
    }
    // What facets send each other, what the ground stores and what keeps a floor are in the temperatures of the two.
    if scene.models.thermal == Thermal::Equilibrium
        && (scene.models.exchange.is_some() || scene.models.conduction.is_some() || scene.models.floor_k > 0.0)
    {
        table.temperature_lit_k = mixed(&before.temperature_lit_k, &after.temperature_lit_k, share);
        table.temperature_shaded_k = mixed(&before.temperature_shaded_k, &after.temperature_shaded_k, share);
    }
    table
}

fn mixed(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| (1.0 - share) * a + share * b).collect()
}

fn seen_between(a: &Sees, b: &Sees, share: f64) -> Sees {
    match (a, b) {
        // Without a move there is nothing between.
        (Sees::Polygons(a), Sees::Polygons(b)) if a == b => Sees::Polygons(a.clone()),
        (Sees::Polygons(a), Sees::Polygons(b)) => {
            let shares = |_: u32, out: &mut [f64]| out.copy_from_slice(&[1.0 - share, share]);
            Sees::Polygons(Seen::together(&[a, b], shares))
        }
        (Sees::Shares(a), Sees::Shares(b)) => Sees::Shares(mixed(a, b, share)),
        (a, b) => (if share < 0.5 { a } else { b }).clone(),
    }
}

/// `None` if the two are known at different wavelengths.
fn reflected_between(before: &[Reflected], after: &[Reflected], share: f64) -> Option<Vec<Reflected>> {
    let of_pair = |(a, b): (&Reflected, &Reflected)| {
        let same_parts =
            a.parts.iter().map(|part| (part.source, &part.by)).eq(b.parts.iter().map(|part| (part.source, &part.by)));
        (a.um == b.um && a.light == b.light && same_parts)
            .then(|| Reflected { irradiance: mixed(&a.irradiance, &b.irradiance, share), ..a.clone() })
    };
    if before.len() != after.len() { None } else { before.iter().zip(after).map(of_pair).collect() }
}
