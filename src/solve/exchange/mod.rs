//! Light and heat that facets send to each other.
//!
//! All of it by the same lines ([`Bundles`]): what a source's light becomes on its way, colour by colour, so that spectra are multiplied in
//! afterwards; and the heat of neighbours, with what of their light a facet absorbs. Each bounce carries what the one before has brought.

mod colours;
mod lit;
mod pass;
mod sampling;

use rayon::prelude::*;

use self::colours::{Bounce, Colours};
use self::lit::{Lit, LitParts};
use self::pass::pass;
use self::sampling::sampling;
use super::irradiance::share;
use crate::error::Result;
use crate::geometry::{MaterialId, Mesh};
use crate::physics::heat;
use crate::physics::reflectance::DirectionalAlbedos;
use crate::product::{FacetTable, Lighting, Reflected, Sees, warmest_k};
use crate::progress::Watch;
use crate::scene::{DirectionField, Exchange, Material, Scene, SourceKind, Thermal};
use crate::visibility::{Bundles, Frame, Meeting};

/// So many colours of light are told apart, each a number for every facet.
const MOST_COLOURS: usize = 24;
/// What would send less than this share of what the first bounce did is left out.
const FAINT: f64 = 1e-6;

/// Adds to a table what facets send each other, and warms them by it.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub(super) fn add(scene: &Scene, table: &mut FacetTable, exchange: Exchange, watch: Watch<'_>) -> Result<()> {
    let mesh = &scene.body.mesh;
    let areas_m2: Vec<f64> = (0..mesh.facets.len()).into_par_iter().map(|f| mesh.facet(f).area_m2()).collect();
    let grey = scene.body.materials.iter().map(|material| material.bond_albedo).collect();
    let colours = Colours::new(table.sources.len(), grey, MOST_COLOURS, exchange.bounces);
    let is_warm = scene.models.thermal == Thermal::Equilibrium;
    let watts = Watts::new(scene);

    // What reaches each facet, of each colour, by bounces; and W m-2 of heat and light that warm it.
    let mut levels: Vec<Vec<f64>> = vec![vec![]; colours.told_apart() + 1];
    let mut absorbed_w_m2 = vec![0.0; if is_warm { mesh.facets.len() } else { 0 }];
    let direct = Direct::new(scene, table, is_warm);
    let first_w = direct.total_w(&watts, &areas_m2);
    let bundles = Bundles::new(mesh, exchange.directions, exchange.lines_per_facet);
    let mut before = Received { rows: vec![], columns: 0 };
    let mut sampled = None;
    for n in 1..=exchange.bounces as usize {
        let bounce = colours.bounce(n);
        let columns = bounce.after + usize::from(is_warm);
        let arrived = if n == 1 {
            let parts = LitParts::new(mesh, &areas_m2, &table.sources);
            let give = |row: &mut [f64], from: u32, lit: Lit, lines: f64| direct.give(&bounce, row, from, lit, lines);
            let lit = |frame: &Frame, meeting: &Meeting, which: usize| {
                let facet = meeting.facets[which];
                parts.at(facet, || frame.uv(&mesh.facet(facet as usize), meeting.at))
            };
            let arrived = pass(&bundles, &areas_m2, columns, lit, give, watch)?;
            let light = |f: usize| arrived.rows[f * columns..f * columns + bounce.after].iter().sum::<f64>();
            let sunlight = |f: usize| table.sources.first().map_or(0.0, |sun| sun.irradiance[f] * share(&sun.sees, f));
            sampled = Some(sampling(mesh, &areas_m2, |f| [sunlight(f), light(f), arrived.difference[f]]));
            arrived
        } else {
            let sent = before.to_be_sent(&colours, n, &watts, mesh, is_warm);
            let share = sent.total_w(&colours, n, &watts, &areas_m2, mesh) / first_w;
            if share.is_nan() || share <= FAINT {
                break;
            }
            let Exchange { directions, lines_per_facet, .. } = exchange.for_share(share);
            let give = |row: &mut [f64], from: u32, _: Lit, lines: f64| {
                sent.give(mesh, &bounce, row, from, lines);
                0.0
            };
            let fewer = bundles.with(directions, lines_per_facet);
            pass(&fewer, &areas_m2, columns, |_, _, _| Lit::default(), give, watch)?
        };
        let rows = arrived.rows;
        before = Received { rows, columns };
        before.add_to(&mut levels[n.min(colours.told_apart())], bounce.after);
        if is_warm {
            before.warm(&mut absorbed_w_m2, &colours, n, &watts, mesh);
        }
    }
    drop(before);
    table.sampling = sampled;
    table.reflected = columns(&colours, levels, mesh.facets.len());
    if is_warm {
        warm(scene, table, &absorbed_w_m2);
    }
    Ok(())
}

/// Total irradiance of the sources' light, W m-2, where its geometric one is 1; and the share of it that surfaces reflect.
struct Watts {
    sources_w_m2: Vec<f64>,
    /// The same, to tell how much of it is left after a bounce: 1 each if none is known, as of sources of which only the light in bands is.
    weights_w_m2: Vec<f64>,
    albedo: Vec<f64>,
    emissivity: Vec<f64>,
}

impl Watts {
    fn new(scene: &Scene) -> Self {
        let sun_w_m2 = scene.sky.sun.total_irradiance_w_m2();
        let of = |kind| match kind {
            SourceKind::Beam(total_w_m2) => total_w_m2,
            // Sunlight that a globe reflects is taken to be of the Sun's colour.
            SourceKind::Sphere(globe) => globe.bond_albedo * (sun_w_m2 * scene.sky.sun_on(globe).strength),
            // What a facet absorbs of that is known already.
            SourceKind::Glow(_) => 0.0,
        };
        let materials = &scene.body.materials;
        let sources_w_m2: Vec<f64> = scene.sources().iter().map(|source| of(source.kind)).collect();
        let is_known = sources_w_m2.iter().any(|w_m2| *w_m2 > 0.0);
        Watts {
            weights_w_m2: if is_known { sources_w_m2.clone() } else { vec![1.0; sources_w_m2.len()] },
            sources_w_m2,
            albedo: materials.iter().map(|m| m.bond_albedo).collect(),
            emissivity: materials.iter().map(|m| m.emissivity_bolometric).collect(),
        }
    }

    /// Of each colour after a bounce.
    fn of(&self, colours: &Colours, bounce: usize) -> Vec<f64> {
        self.by(&self.sources_w_m2, colours, bounce)
    }

    fn by(&self, sources_w_m2: &[f64], colours: &Colours, bounce: usize) -> Vec<f64> {
        let reflected = |by: &[MaterialId]| by.iter().map(|m| self.albedo[m.0 as usize]).product::<f64>();
        colours.after(bounce).iter().map(|c| sources_w_m2[c.source] * reflected(&c.by)).collect()
    }
}

/// What facets send of what sources send them, and of their own heat.
struct Direct<'a> {
    scene: &'a Scene,
    sources: Vec<&'a Lighting>,
    /// [facet, source]: irradiance where it is lit, over what of light from everywhere is reflected alike.
    irradiance: Vec<f64>,
    /// W m-2 of heat where the Sun sees each facet, and in its shadow; none without heat.
    heat_w_m2: Vec<[f64; 2]>,
}

impl<'a> Direct<'a> {
    fn new(scene: &'a Scene, table: &'a FacetTable, is_warm: bool) -> Self {
        let albedo = |material: &Material| {
            let (albedos, factor) = material.photometry.model()?.absorbing(material.bond_albedo)?;
            (material.bond_albedo > 0.0).then_some((albedos, factor / material.bond_albedo))
        };
        // Of each material with a model, its albedo by incidence, and by what that is multiplied for a mean of 1.
        let albedos: Vec<Option<(DirectionalAlbedos, f64)>> = scene.body.materials.iter().map(albedo).collect();
        let of_mean_albedo = |material: MaterialId, lighting: &Lighting, facet: usize| {
            let mut of_mean = 1.0;
            if let (Some((albedos, factor)), DirectionField::Afar(towards)) =
                (&albedos[material.0 as usize], lighting.field)
            {
                // Not the irradiance, of which an eclipse may have taken its part.
                let normal = scene.body.mesh.facet(facet).cross_m2().normalize_or_zero();
                let cos_incidence = normal.dot(towards.vec()).max(0.0);
                albedos.weights(cos_incidence, |_, weight| of_mean = factor * weight);
            }
            of_mean
        };
        let materials = &scene.body.mesh.material;
        let of_facet = |f: usize| {
            let material = materials[f];
            table.sources.iter().map(move |lighting| {
                // Of what no part is known, a share of the whole.
                let irradiance = match &lighting.sees {
                    Sees::Polygons(_) => lighting.irradiance[f],
                    sees => lighting.irradiance[f] * share(sees, f),
                };
                irradiance * of_mean_albedo(material, lighting, f)
            })
        };
        let heat = |f: usize| {
            let emissivity = scene.body.materials[materials[f].0 as usize].emissivity_bolometric;
            [&table.temperature_lit_k, &table.temperature_shaded_k].map(|t_k| heat::emitted_w_m2(t_k[f], emissivity))
        };
        Direct {
            scene,
            sources: table.sources.iter().collect(),
            irradiance: (0..materials.len()).flat_map(of_facet).collect(),
            heat_w_m2: if is_warm { (0..materials.len()).map(heat).collect() } else { vec![] },
        }
    }

    /// Gives how much light that is.
    fn give(&self, bounce: &Bounce, row: &mut [f64], from: u32, lit: Lit, lines: f64) -> f64 {
        let facet = from as usize;
        let material = self.scene.body.mesh.material[facet].0 as usize;
        let becomes = &bounce.becomes[material * bounce.before..(material + 1) * bounce.before];
        let of_sources = &self.irradiance[facet * becomes.len()..(facet + 1) * becomes.len()];
        let mut light = 0.0;
        for (s, ((colour, factor), irradiance)) in becomes.iter().zip(of_sources).enumerate() {
            let lit = lit.by(s).unwrap_or_else(|| share(&self.sources[s].sees, facet));
            let more = lines * factor * lit * irradiance;
            row[*colour] += more;
            light += more;
        }
        if let Some([lit_w_m2, shaded_w_m2]) = self.heat_w_m2.get(facet) {
            let sunlit = lit.by(0).unwrap_or(0.0);
            row[bounce.after] += lines * (sunlit * lit_w_m2 + (1.0 - sunlit) * shaded_w_m2);
        }
        light
    }

    /// All of it, W: of light and heat alike.
    fn total_w(&self, watts: &Watts, areas_m2: &[f64]) -> f64 {
        let of = |f: usize| {
            let material = self.scene.body.mesh.material[f].0 as usize;
            let lit = self.sources.iter().map(|lighting| share(&lighting.sees, f));
            let arriving: f64 = (self.sources.iter().zip(&watts.weights_w_m2))
                .zip(lit)
                .map(|((lighting, w_m2), lit)| lit * lighting.irradiance[f] * w_m2)
                .sum();
            let heat = self.heat_w_m2.get(f).map_or(0.0, |[lit_w_m2, shaded_w_m2]| {
                let lit = self.sources.first().map_or(0.0, |sun| share(&sun.sees, f));
                lit * lit_w_m2 + (1.0 - lit) * shaded_w_m2
            });
            areas_m2[f] * (watts.albedo[material] * arriving + heat)
        };
        (0..areas_m2.len()).map(of).sum()
    }
}

/// What a bounce has brought: [facet, colour], and then W m-2 of heat, if there is any.
struct Received {
    rows: Vec<f64>,
    columns: usize,
}

/// The same, to be sent on.
struct Sent<'a> {
    received: &'a Received,
    /// W m-2 of heat that each facet sends on, if there is any: what it receives, and what it absorbs of light.
    heat_w_m2: Vec<f64>,
}

impl Received {
    /// What the facets send on at bounce `n`.
    fn to_be_sent(&self, colours: &Colours, n: usize, watts: &Watts, mesh: &Mesh, is_warm: bool) -> Sent<'_> {
        let of_colour = watts.of(colours, n - 1);
        let heat = |(row, material): (&[f64], &MaterialId)| {
            (1.0 - watts.albedo[material.0 as usize]) * light_w_m2(row, &of_colour) + row[of_colour.len()]
        };
        let rows = || self.rows.par_chunks(self.columns).zip(&mesh.material);
        Sent { received: self, heat_w_m2: if is_warm { rows().map(heat).collect() } else { vec![] } }
    }

    /// Adds the light to that of earlier bounces of the same colours.
    fn add_to(&self, level: &mut Vec<f64>, colours: usize) {
        let facets = self.rows.len() / self.columns;
        level.resize(facets * colours, 0.0);
        for (sums, row) in level.chunks_exact_mut(colours).zip(self.rows.chunks_exact(self.columns)) {
            sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
        }
    }

    /// Adds what each facet absorbs, W m-2.
    fn warm(&self, absorbed_w_m2: &mut [f64], colours: &Colours, n: usize, watts: &Watts, mesh: &Mesh) {
        let of_colour = watts.of(colours, n);
        let rows = self.rows.par_chunks(self.columns).zip(&mesh.material);
        absorbed_w_m2.par_iter_mut().zip(rows).for_each(|(sum, (row, material))| {
            let m = material.0 as usize;
            *sum += (1.0 - watts.albedo[m]) * light_w_m2(row, &of_colour) + watts.emissivity[m] * row[of_colour.len()];
        });
    }
}

/// Light of all colours, W m-2.
fn light_w_m2(row: &[f64], of_colour: &[f64]) -> f64 {
    row.iter().zip(of_colour).map(|(x, w_m2)| x * w_m2).sum()
}

impl Sent<'_> {
    /// Power sent at bounce `n`, W: of light and heat alike.
    fn total_w(&self, colours: &Colours, n: usize, watts: &Watts, areas_m2: &[f64], mesh: &Mesh) -> f64 {
        let of_colour = watts.by(&watts.weights_w_m2, colours, n - 1);
        let of = |f: usize| {
            let row = &self.received.rows[f * self.received.columns..];
            let reflected = watts.albedo[mesh.material[f].0 as usize] * light_w_m2(row, &of_colour);
            areas_m2[f] * (reflected + self.heat_w_m2.get(f).unwrap_or(&0.0))
        };
        (0..areas_m2.len()).map(of).sum()
    }

    fn give(&self, mesh: &Mesh, bounce: &Bounce, row: &mut [f64], from: u32, lines: f64) {
        let (facet, columns) = (from as usize, self.received.columns);
        let received = &self.received.rows[facet * columns..(facet + 1) * columns];
        let material = mesh.material[facet].0 as usize;
        let becomes = &bounce.becomes[material * bounce.before..(material + 1) * bounce.before];
        for ((colour, factor), x) in becomes.iter().zip(received) {
            row[*colour] += lines * factor * x;
        }
        if let Some(heat_w_m2) = self.heat_w_m2.get(facet) {
            row[bounce.after] += lines * heat_w_m2;
        }
    }
}

/// The light of all bounces, a column for each colour that there is any of.
fn columns(colours: &Colours, levels: Vec<Vec<f64>>, facets: usize) -> Vec<Reflected> {
    let mut all = Vec::new();
    for (n, level) in levels.into_iter().enumerate() {
        let of_level = colours.after(n);
        if level.is_empty() {
            continue;
        }
        for (c, colour) in of_level.iter().enumerate() {
            let irradiance: Vec<f64> = (0..facets).map(|f| level[f * of_level.len() + c]).collect();
            if irradiance.iter().any(|x| *x > 0.0) {
                all.push(Reflected { source: colour.source, by: colour.by.clone(), irradiance });
            }
        }
    }
    all
}

/// The temperatures of facets that absorb so much more, W m-2.
fn warm(scene: &Scene, table: &mut FacetTable, absorbed_w_m2: &[f64]) {
    // Of the smallest facets few lines decide.
    let most_k = warmest_k(scene);
    let facets = scene.body.mesh.material.par_iter().zip(absorbed_w_m2);
    let states = table.temperature_lit_k.par_iter_mut().zip(&mut table.temperature_shaded_k);
    states.zip(facets).for_each(|((lit_k, shaded_k), (material, more_w_m2))| {
        let emissivity = scene.body.materials[material.0 as usize].emissivity_bolometric;
        for t_k in [lit_k, shaded_k] {
            let all_w_m2 = heat::emitted_w_m2(*t_k, emissivity) + more_w_m2;
            *t_k = heat::equilibrium_temperature_k(all_w_m2, emissivity).min(most_k);
        }
    });
}
