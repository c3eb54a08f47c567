//! Light and heat that facets send to each other.
//!
//! All of it by the same lines ([`Bundles`]): light at a few wavelengths ([`Palette`]), all light together, W m-2, of which a facet absorbs its share, and the heat of
//! neighbours. Each bounce carries what the one before has brought.

mod lit;
mod palette;
mod pass;
mod sampling;

use rayon::prelude::*;

use self::lit::{Lit, LitParts};
pub use self::palette::spectra_error;
use self::palette::{Node, Palette};
use self::pass::pass;
use self::sampling::sampling;
use super::irradiance::share;
use crate::error::Result;
use crate::geometry::{MaterialId, Mesh, index_u32};
use crate::physics::heat;
use crate::product::{FacetTable, Lighting, Reflected, Sampling, Sees, warmest_k};
use crate::progress::Watch;
use crate::scene::{DirectionField, Exchange, Scene, SourceKind, Thermal};
use crate::visibility::{Bundles, Frame, Meeting};

/// What would send less than this share of what the first bounce did is left out.
const FAINT: f64 = 1e-6;

/// Adds to a table what facets send each other, and warms them by it.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub(super) fn add(scene: &Scene, table: &mut FacetTable, exchange: Exchange, watch: Watch<'_>) -> Result<()> {
    let mesh = &scene.body.mesh;
    let areas_m2: Vec<f64> = (0..mesh.facets.len()).into_par_iter().map(|f| mesh.facet(f).area_m2()).collect();
    let is_warm = scene.models.thermal == Thermal::Equilibrium;
    let carried = Carried::new(scene, exchange.bounces, is_warm);
    let columns = carried.columns();

    // What reaches each facet at each wavelength, by all bounces; and W m-2 of heat and light that warm it.
    let wavelengths = carried.palette.nodes.len();
    let mut light = vec![0.0; mesh.facets.len() * wavelengths];
    let mut absorbed_w_m2 = vec![0.0; if is_warm { mesh.facets.len() } else { 0 }];
    let direct = Direct::new(scene, table, &carried);
    let first = direct.totals(&areas_m2);
    let levels = Bundles::levels(mesh, exchange.directions, exchange.lines_per_facet);
    let mut before = Received { carried: &carried, rows: vec![] };
    let mut sampled = None;
    for n in 1..=exchange.bounces {
        let rows = if n == 1 {
            let parts = LitParts::new(mesh, &areas_m2, &table.sources);
            let lit = |frame: &Frame, meeting: &Meeting, which: usize| {
                let facet = meeting.facets[which];
                parts.at(facet, || frame.uv(&mesh.facet(facet as usize), meeting.at))
            };
            let give = |row: &mut [f64], from: u32, lit: Lit, lines: f64| direct.give(row, from, lit, lines);
            let arrived = pass(&levels, &areas_m2, columns, lit, give, watch)?;
            let light = |f: usize| arrived.rows[f * columns + wavelengths];
            let sunlight = |f: usize| table.sources.first().map_or(0.0, |sun| sun.irradiance[f] * share(&sun.sees, f));
            let is_shown = |f: usize| levels[0].is_of(index_u32(f));
            let [lit, shadow] = sampling(mesh, &areas_m2, is_shown, |f| [sunlight(f), light(f), arrived.difference[f]]);
            sampled = Some(Sampling { lit, shadow, spectra: carried.palette.error });
            arrived.rows
        } else {
            let sent = before.to_be_sent(mesh);
            // At the wavelength, or of the energy, of which most is left: of some light no total is known.
            let left = sent.totals(&areas_m2, mesh).into_iter().zip(&first).filter(|(_, first)| **first > 0.0);
            let share = left.map(|(sent, first)| sent / first).fold(0.0, f64::max);
            if share <= FAINT {
                break;
            }
            let Exchange { directions, lines_per_facet, .. } = exchange.for_share(share);
            let give = |row: &mut [f64], from: u32, _: Lit, lines: f64| {
                sent.give(mesh, row, from, lines);
                0.0
            };
            let fewer: Vec<Bundles> = levels.iter().map(|bundles| bundles.with(directions, lines_per_facet)).collect();
            pass(&fewer, &areas_m2, columns, |_, _, _| Lit::default(), give, watch)?.rows
        };
        before = Received { carried: &carried, rows };
        before.add_to(&mut light);
        before.warm(&mut absorbed_w_m2, mesh);
    }
    drop(before);
    table.sampling = sampled;
    table.reflected = reflected(carried.palette, &light);
    if is_warm {
        warm(scene, table, &absorbed_w_m2);
    }
    Ok(())
}

/// What lines carry, a number each: light at some wavelengths, W m-2 um-1; all light, W m-2; and heat, W m-2, if there is any.
struct Carried {
    palette: Palette,
    /// [material, source, column but heat]: what is sent of an irradiance of 1.
    of_sources: Vec<f64>,
    /// [material, column but heat]: what is sent of what has been received.
    of_received: Vec<f64>,
    /// Whether all light is known, and not only that at some wavelengths: else each source counts as 1, to tell how much is left after a bounce.
    is_known: bool,
    is_warm: bool,
    sources: usize,
    /// Of each material.
    albedo: Vec<f64>,
    emissivity: Vec<f64>,
    /// Whether what it absorbs does not warm it.
    is_held: Vec<bool>,
}

impl Carried {
    fn new(scene: &Scene, bounces: u32, is_warm: bool) -> Self {
        let sun_w_m2 = scene.sky.sun.total_irradiance_w_m2();
        let of = |kind| match kind {
            SourceKind::Beam(total_w_m2) => total_w_m2,
            // Sunlight that a globe reflects is taken to be of the Sun's colour.
            SourceKind::Sphere(globe) => globe.bond_albedo * (sun_w_m2 * scene.sky.sun_on(globe).strength),
            // What a facet absorbs of that is known already.
            SourceKind::Glow(_) => 0.0,
        };
        let mut sources_w_m2: Vec<f64> = scene.sources().iter().map(|source| of(source.kind)).collect();
        let is_known = sources_w_m2.iter().any(|w_m2| *w_m2 > 0.0);
        if !is_known {
            sources_w_m2.fill(1.0);
        }
        let materials = &scene.body.materials;
        let albedo: Vec<f64> = materials.iter().map(|material| material.bond_albedo).collect();
        let palette = Palette::of(scene, bounces);
        let (mut of_sources, mut of_received) = (vec![], vec![]);
        for (m, albedo) in albedo.iter().enumerate() {
            for (s, w_m2) in sources_w_m2.iter().enumerate() {
                of_sources.extend(palette.nodes.iter().map(|node| node.sources[s] * node.reflectance[m]));
                of_sources.push(w_m2 * albedo);
            }
            of_received.extend(palette.nodes.iter().map(|node| node.reflectance[m]));
            of_received.push(*albedo);
        }
        Carried {
            palette,
            of_sources,
            of_received,
            is_known,
            is_warm,
            sources: sources_w_m2.len(),
            albedo,
            emissivity: materials.iter().map(|material| material.emissivity_bolometric).collect(),
            is_held: materials.iter().map(|material| material.temperature_k.is_some()).collect(),
        }
    }

    /// The column of all light; those before it are of wavelengths.
    fn light(&self) -> usize {
        self.palette.nodes.len()
    }

    fn columns(&self) -> usize {
        self.light() + 1 + usize::from(self.is_warm)
    }

    /// What a material sends of a source's light.
    fn of_source(&self, material: usize, source: usize) -> &[f64] {
        let columns = self.light() + 1;
        let first = (material * self.sources + source) * columns;
        &self.of_sources[first..first + columns]
    }

    /// What it sends of what it has received.
    fn of_received(&self, material: usize) -> &[f64] {
        let columns = self.light() + 1;
        &self.of_received[material * columns..(material + 1) * columns]
    }

    /// What it absorbs of light, W m-2.
    fn absorbed_w_m2(&self, material: usize, row: &[f64]) -> f64 {
        if self.is_known { (1.0 - self.albedo[material]) * row[self.light()] } else { 0.0 }
    }
}

/// What facets send of what sources send them, and of their own heat.
struct Direct<'a> {
    scene: &'a Scene,
    carried: &'a Carried,
    sources: Vec<&'a Lighting>,
    /// [facet, source]: irradiance where it is lit, over what of light from everywhere is reflected alike.
    irradiance: Vec<f64>,
    /// W m-2 of heat where the Sun sees each facet, and in its shadow; none without heat.
    heat_w_m2: Vec<[f64; 2]>,
}

impl<'a> Direct<'a> {
    fn new(scene: &'a Scene, table: &'a FacetTable, carried: &'a Carried) -> Self {
        let albedos = scene.body.absorbing();
        let of_mean_albedo = |material: MaterialId, lighting: &Lighting, facet: usize| {
            let (mut of_mean, bond_albedo) = (1.0, scene.body.materials[material.0 as usize].bond_albedo);
            if let (Some((albedos, factor)), DirectionField::Afar(towards)) =
                (&albedos[material.0 as usize], lighting.field)
                && bond_albedo > 0.0
            {
                // Not the irradiance, of which an eclipse may have taken its part.
                let normal = scene.body.mesh.facet(facet).cross_m2().normalize_or_zero();
                let cos_incidence = normal.dot(towards.vec()).max(0.0);
                albedos.weights(cos_incidence, |_, weight| of_mean = factor / bond_albedo * weight);
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
            carried,
            sources: table.sources.iter().collect(),
            irradiance: (0..materials.len()).flat_map(of_facet).collect(),
            heat_w_m2: if carried.is_warm { (0..materials.len()).map(heat).collect() } else { vec![] },
        }
    }

    /// Gives how much light that is, W m-2.
    fn give(&self, row: &mut [f64], from: u32, lit: Lit, lines: f64) -> f64 {
        let facet = from as usize;
        let material = self.scene.body.mesh.material[facet].0 as usize;
        let of_sources = &self.irradiance[facet * self.sources.len()..(facet + 1) * self.sources.len()];
        let before = row[self.carried.light()];
        for (s, irradiance) in of_sources.iter().enumerate() {
            let amount = lines * irradiance * lit.by(s).unwrap_or_else(|| share(&self.sources[s].sees, facet));
            if amount != 0.0 {
                row.iter_mut().zip(self.carried.of_source(material, s)).for_each(|(sum, sent)| *sum += amount * sent);
            }
        }
        let light = row[self.carried.light()] - before;
        if let Some([lit_w_m2, shaded_w_m2]) = self.heat_w_m2.get(facet) {
            let sunlit = lit.by(0).unwrap_or(0.0);
            row[self.carried.light() + 1] += lines * (sunlit * lit_w_m2 + (1.0 - sunlit) * shaded_w_m2);
        }
        light
    }

    /// All of it: light at each wavelength, W um-1; and, last, light and heat together, W.
    fn totals(&self, areas_m2: &[f64]) -> Vec<f64> {
        let mut totals = vec![0.0; self.carried.light() + 1];
        for (f, area_m2) in areas_m2.iter().enumerate() {
            let material = self.scene.body.mesh.material[f].0 as usize;
            for (s, source) in self.sources.iter().enumerate() {
                let amount = area_m2 * share(&source.sees, f) * source.irradiance[f];
                totals
                    .iter_mut()
                    .zip(self.carried.of_source(material, s))
                    .for_each(|(sum, sent)| *sum += amount * sent);
            }
            if let Some([lit_w_m2, shaded_w_m2]) = self.heat_w_m2.get(f) {
                let lit = self.sources.first().map_or(0.0, |sun| share(&sun.sees, f));
                totals[self.carried.light()] += area_m2 * (lit * lit_w_m2 + (1.0 - lit) * shaded_w_m2);
            }
        }
        totals
    }
}

/// What a bounce has brought.
struct Received<'a> {
    carried: &'a Carried,
    /// [facet, column].
    rows: Vec<f64>,
}

/// The same, to be sent on.
struct Sent<'a> {
    received: &'a Received<'a>,
    /// W m-2 of heat that each facet sends on, if there is any: what it receives, and what it absorbs of light; of what is held at a
    /// temperature, what it reflects.
    heat_w_m2: Vec<f64>,
}

impl Received<'_> {
    fn of(&self, facet: usize) -> &[f64] {
        let columns = self.carried.columns();
        &self.rows[facet * columns..(facet + 1) * columns]
    }

    /// What the facets send on.
    fn to_be_sent(&self, mesh: &Mesh) -> Sent<'_> {
        let heat = |(row, material): (&[f64], &MaterialId)| {
            let (m, received_w_m2) = (material.0 as usize, row[self.carried.light() + 1]);
            match self.carried.is_held[m] {
                true => (1.0 - self.carried.emissivity[m]) * received_w_m2,
                false => self.carried.absorbed_w_m2(m, row) + received_w_m2,
            }
        };
        let rows = || self.rows.par_chunks(self.carried.columns()).zip(&mesh.material);
        Sent { received: self, heat_w_m2: if self.carried.is_warm { rows().map(heat).collect() } else { vec![] } }
    }

    /// Adds the light at each wavelength to that of earlier bounces.
    fn add_to(&self, light: &mut [f64]) {
        let wavelengths = self.carried.light();
        if wavelengths > 0 {
            let rows = self.rows.chunks_exact(self.carried.columns());
            for (sums, row) in light.chunks_exact_mut(wavelengths).zip(rows) {
                sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
            }
        }
    }

    /// Adds what each facet absorbs, W m-2, if there is heat.
    fn warm(&self, absorbed_w_m2: &mut [f64], mesh: &Mesh) {
        let rows = self.rows.par_chunks(self.carried.columns()).zip(&mesh.material);
        absorbed_w_m2.par_iter_mut().zip(rows).for_each(|(sum, (row, material))| {
            let m = material.0 as usize;
            *sum += self.carried.absorbed_w_m2(m, row) + self.carried.emissivity[m] * row[self.carried.light() + 1];
        });
    }
}

impl Sent<'_> {
    /// All of it, as [`Direct::totals`].
    fn totals(&self, areas_m2: &[f64], mesh: &Mesh) -> Vec<f64> {
        let carried = self.received.carried;
        let mut totals = vec![0.0; carried.light() + 1];
        for (f, area_m2) in areas_m2.iter().enumerate() {
            let sent = carried.of_received(mesh.material[f].0 as usize).iter().zip(self.received.of(f));
            totals.iter_mut().zip(sent).for_each(|(sum, (factor, x))| *sum += area_m2 * factor * x);
            totals[carried.light()] += area_m2 * self.heat_w_m2.get(f).unwrap_or(&0.0);
        }
        totals
    }

    fn give(&self, mesh: &Mesh, row: &mut [f64], from: u32, lines: f64) {
        let (facet, carried) = (from as usize, self.received.carried);
        let sent = carried.of_received(mesh.material[facet].0 as usize).iter().zip(self.received.of(facet));
        row.iter_mut().zip(sent).for_each(|(sum, (factor, x))| *sum += lines * factor * x);
        if let Some(heat_w_m2) = self.heat_w_m2.get(facet) {
            row[carried.light() + 1] += lines * heat_w_m2;
        }
    }
}

/// Columns of the table: light of all bounces, at each wavelength at which there is any.
fn reflected(palette: Palette, light: &[f64]) -> Vec<Reflected> {
    let wavelengths = palette.nodes.len();
    let column = |(k, node): (usize, Node)| Reflected {
        um: node.um,
        light: node.light,
        sources: node.sources,
        reflectance: node.reflectance,
        parts: node.spectrum,
        irradiance: light.iter().skip(k).step_by(wavelengths).copied().collect(),
    };
    let all = palette.nodes.into_iter().enumerate().map(column);
    all.filter(|reflected| reflected.irradiance.iter().any(|x| *x > 0.0)).collect()
}

/// The temperatures of facets that absorb so much more, W m-2.
fn warm(scene: &Scene, table: &mut FacetTable, absorbed_w_m2: &[f64]) {
    // Of the smallest facets few lines decide.
    let most_k = warmest_k(scene);
    let facets = scene.body.mesh.material.par_iter().zip(absorbed_w_m2);
    let states = table.temperature_lit_k.par_iter_mut().zip(&mut table.temperature_shaded_k);
    states.zip(facets).for_each(|((lit_k, shaded_k), (material, more_w_m2))| {
        let material = &scene.body.materials[material.0 as usize];
        if material.temperature_k.is_some() {
            return;
        }
        let emissivity = material.emissivity_bolometric;
        for t_k in [lit_k, shaded_k] {
            let all_w_m2 = heat::emitted_w_m2(*t_k, emissivity) + more_w_m2;
            *t_k = heat::equilibrium_temperature_k(all_w_m2, emissivity).min(most_k);
        }
    });
}
