//! Error against time: several ways to make the image of a scene, each compared with the truth of its question.
//!
//! Which effects are computed is compared with all of them. How geometry is computed is compared with exact areas and shadows under the same effects,
//! those of direct light and heat: so a shortcut's error is its own, and its time is not drowned by that of light between facets.

mod advice;
mod case;
mod errors;
mod method;
mod outside;
mod sampled;
mod shading;

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::error::{Error, Result};
use crate::geometry::whole;
use crate::integrate;
use crate::progress::{Progress, Watch, tell};
use crate::scene::{Models, Scene, Setup, SunModel, Thermal};
use crate::solve;
use crate::spectral::Band;

pub use advice::{Advice, TARGETS};
pub use case::{Case, Planned};
pub use errors::{BandErrors, FLOOR, Ground, Spread, pixel_error, reference_radiance};
pub use method::{Bands, Family, Method, Question, Shadows};
pub use outside::{Outside, lambert_sunlight};
pub use sampled::{by_rays, facing_the_sun, lit_at_centroid};

/// CPU time of this process so far, s, over all its threads: the library has no clock.
pub type Clock<'a> = &'a (dyn Fn() -> f64 + Sync);

/// Methods that take less than this, CPU s, are run `RUNS` times, and the fastest run counts: others on the machine only add.
const QUICK_S: f64 = 3.0;
const RUNS: u32 = 3;
/// From one number of rays to the next, ...
const RAYS_GROW: f64 = 4.0;
/// ... as long as they take no longer than this, CPU s.
const LONGEST_S: f64 = 150.0;

/// What is compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Name of the scene.
    pub scene: String,
    /// Pixels in a line, and lines.
    pub size: [usize; 2],
    /// Facets of the mesh.
    pub facets: usize,
    /// The bands of all images: one of reflected light, and one with the most heat.
    pub bands: Vec<Band>,
    /// What each pixel sees.
    pub ground: Vec<Ground>,
    /// Image and time of each method, by questions; the first of each question is its truth.
    pub entries: Vec<Entry>,
    /// Whether light between facets is among the effects: its tolerance is of its own.
    pub has_exchange: bool,
    /// What could not be compared, and why.
    pub notes: Vec<String>,
}

/// A method's image, and what it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What it varies.
    pub family: Family,
    /// A short name.
    pub name: String,
    /// What it does, in a sentence.
    pub account: String,
    /// What a simulation is asked for to compute the same effects.
    pub model: String,
    /// Facets of the mesh that it sees.
    pub facets: usize,
    /// CPU time, s: the least of the runs.
    pub cpu_s: f64,
    /// How often it was run.
    pub runs: u32,
    /// Radiance, `[band, pixel]`, W m-2 sr-1 um-1; another program's may have the first band alone.
    pub image: Bands,
    /// What it is off by, band by band.
    pub errors: Vec<BandErrors>,
    /// Whether nothing is both faster and nearer to the truth.
    pub is_best: bool,
}

impl Entry {
    /// The error by which methods are ranked: the 99th percentile over all pixels, in the worst band.
    pub fn p99(&self) -> f64 {
        self.errors.iter().map(|band| band.all.p99).fold(0.0, f64::max)
    }
}

impl Chart {
    /// What the methods of a question are compared with.
    pub fn truth(&self, question: Question) -> &Entry {
        self.entries.iter().find(|entry| entry.family == question.truth()).unwrap_or(&self.entries[0])
    }

    /// What answers a question, its truth first.
    pub fn answers(&self, question: Question) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(move |entry| entry.family.question() == question)
    }
}

/// Runs all methods on a scene; `clock` tells the CPU time of this process.
///
/// # Errors
/// Those of [`solve`](solve::solve) and [`integrate`](integrate::integrate);
/// [`Error::Interrupted`] if `watch` asks to stop.
pub fn chart(name: &str, scene: &Scene, clock: Clock<'_>, watch: Watch<'_>) -> Result<Chart> {
    // Stages of the work within are not the chart's.
    let before = |_: Progress| watch(Progress { stage: "methods", done: 0, total: 1 });
    let case = &Case::new(scene, &before)?;
    let mut methods = vec![Method::Full];
    methods.extend(case.plans(&before)?.into_iter().map(Method::Planned));
    methods.extend(Method::of_geometry());
    let weight = |method: &Method| weight(method.cpu_s(case));
    let total: u64 = methods.iter().map(weight).sum();
    let mut done = 0;
    let mut entries: Vec<Entry> = Vec::new();
    let mut notes = case.notes.clone();
    let ground = seen_ground(case, &before)?;
    for method in methods {
        tell(watch, "methods", done, total)?;
        let weight = weight(&method);
        done += weight;
        let last_s = entries.last().filter(|last| last.family == Family::Image).map_or(0.0, |last| last.cpu_s);
        if matches!(method, Method::Rays(_)) && RAYS_GROW * last_s > LONGEST_S {
            notes.push(format!(
                "{} were left out: they would take {:.0} CPU s or more.",
                method.name(),
                RAYS_GROW * last_s
            ));
            continue;
        }
        // What takes long tells how far it is; of several passes, and runs, the first counts.
        let farthest = AtomicU64::new(0);
        let inner = |progress: Progress| {
            let within = match progress.stage {
                "rays" | "light between facets" => weight * progress.done / progress.total.max(1),
                _ => 0,
            };
            let within = farthest.fetch_max(within, Relaxed).max(within);
            watch(Progress { stage: "methods", done: done - weight + within, total })
        };
        let prepared = match method.prepared(case) {
            Ok(prepared) => prepared,
            Err(Error::Invalid(problems)) if !matches!(method, Method::Full | Method::Exact) => {
                let why: Vec<String> = problems.iter().map(|problem| problem.message.clone()).collect();
                notes.push(format!("{} was not run: {}", method.name(), why.join("; ")));
                continue;
            }
            Err(other) => return Err(other),
        };
        let facets = prepared.body.mesh.facets.len();
        let (image, cpu_s, runs) = measured(&method, case, prepared, clock, &inner)?;
        let family = method.family();
        let truth = entries.iter().find(|entry| entry.family == family.question().truth());
        let errors = compared(&image, truth.map_or(&image, |truth| &truth.image), &ground);
        entries.push(Entry {
            family,
            name: method.name(),
            account: method.account(case),
            model: method.model(),
            facets,
            cpu_s,
            runs,
            errors,
            image,
            is_best: false,
        });
    }
    tell(watch, "methods", total, total)?;
    advice::mark_best(&mut entries);
    if !scene.body.textures.is_empty() {
        notes.push("Rays and sunlit shares leave textures out: part of their error is that.".into());
    }
    let camera = &scene.exposure.camera;
    Ok(Chart {
        scene: name.to_owned(),
        size: [camera.samples as usize, camera.lines as usize],
        facets: scene.body.mesh.facets.len(),
        bands: case.exposure.bands.clone(),
        ground,
        entries,
        has_exchange: case.full.exchange.is_some(),
        notes,
    })
}

/// Share of a method in the progress, from what a run of it takes: some ms.
fn weight(cpu_s: f64) -> u64 {
    let runs = if cpu_s < QUICK_S { f64::from(RUNS) } else { 1.0 };
    whole(1e3 * cpu_s * runs) as u64 + 1
}

/// Runs a method until its time is known.
fn measured(
    method: &Method,
    case: &Case,
    first: Scene,
    clock: Clock<'_>,
    watch: Watch<'_>,
) -> Result<(Bands, f64, u32)> {
    let began = clock();
    let image = method.image(case, &first, watch)?;
    let (mut least_s, mut runs) = (clock() - began, 1);
    drop(first);
    while runs < RUNS && least_s < QUICK_S {
        // What a run has found out about a body stays with it: each starts from a new one.
        let again = method.prepared(case)?;
        let began = clock();
        method.image(case, &again, watch)?;
        least_s = least_s.min(clock() - began);
        runs += 1;
    }
    Ok((image, least_s, runs))
}

fn compared(image: &Bands, truth: &Bands, ground: &[Ground]) -> Vec<BandErrors> {
    image.iter().zip(truth).map(|(image, truth)| BandErrors::new(image, truth, ground)).collect()
}

/// What each pixel sees, exactly.
fn seen_ground(case: &Case, watch: Watch<'_>) -> Result<Vec<Ground>> {
    let scene = &case.scene.by(Models { sun: SunModel::Point, ..case.direct })?;
    let table = solve::lit(scene, watch)?;
    let camera = &scene.exposure.camera;
    let pixels = camera.samples as usize * camera.lines as usize;
    let Some(sunlit) = table.sunlit() else { return Ok(vec![Ground::Sky; pixels]) };
    let footprints = integrate::footprints(&scene.body.mesh, scene.body.topology(), sunlit, camera);
    let ground = |pixel: usize| {
        let (shown, lit) =
            footprints.pixel(pixel).fold((0.0, 0.0), |(shown, lit), (_, area, of)| (shown + area, lit + of));
        match () {
            () if shown <= 0.0 => Ground::Sky,
            () if lit >= 0.5 * shown => Ground::Lit,
            () => Ground::Shadowed,
        }
    };
    Ok((0..pixels).map(ground).collect())
}

/// The bands that are compared: of those with sunlight the one nearest to 1 um, and of those with heat the one with the longest waves.
fn bands(scene: &Setup) -> Vec<Band> {
    let bands = &scene.exposure.bands;
    let off = |band: &&Band| (band.centre_um - 1.0).abs();
    let reflected = bands.iter().filter(|b| b.light.is_lit()).min_by(|a, b| off(a).total_cmp(&off(b)));
    let warm = bands.iter().filter(|b| b.light.glows() && scene.models.thermal != Thermal::Off);
    let heat = warm.max_by(|a, b| a.centre_um.total_cmp(&b.centre_um));
    let mut chosen: Vec<Band> = reflected.into_iter().chain(heat).cloned().collect();
    chosen.dedup();
    if chosen.is_empty() { bands.iter().take(1).cloned().collect() } else { chosen }
}
