//! Error against time: several ways to make the image of a scene, each compared with the full exact one.

mod advice;
mod errors;
mod method;
mod models;
mod outside;
mod rays;
mod sampled;
mod shading;

use crate::error::{Error, Result};
use crate::integrate;
use crate::progress::{Progress, Watch, tell};
use crate::scene::{Exposure, Scene, Setup, Thermal};
use crate::solve;
use crate::spectral::Band;

pub use advice::{Advice, TARGETS};
pub use errors::{BandErrors, FLOOR, Ground, Spread, pixel_error, reference_radiance};
pub use method::{Bands, Family, Method, Shadows};
pub use models::Choice;
pub use outside::{Outside, lambert_sunlight};
pub use rays::{Hit, RayTree};
pub use sampled::{facing_the_sun, lit_at_centroid};

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
    /// Image and time of each method; the first is the full exact one.
    pub entries: Vec<Entry>,
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
    /// The models by which it computes.
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
    /// The full exact image.
    pub fn truth(&self) -> &Entry {
        &self.entries[0]
    }
}

/// Runs all methods on a scene; `clock` tells the CPU time of this process.
///
/// # Errors
/// Those of [`solve`](solve::solve) and [`integrate`](integrate::integrate);
/// [`Error::Interrupted`] if `watch` asks to stop.
pub fn chart(name: &str, scene: &Scene, clock: Clock<'_>, watch: Watch<'_>) -> Result<Chart> {
    let exposure = Exposure { bands: bands(scene), ..scene.exposure.clone() };
    let scene = &scene.seen_by(exposure)?;
    let methods = Method::all();
    let total: u64 = methods.iter().map(weight).sum();
    let mut done = 0;
    let mut entries: Vec<Entry> = Vec::new();
    let mut notes = Vec::new();
    let mut ground = Vec::new();
    for method in methods {
        tell(watch, "methods", done, total)?;
        let weight = weight(&method);
        let last_s = entries.last().filter(|last| last.family == Family::Image).map_or(0.0, |last| last.cpu_s);
        if matches!(method, Method::Rays(_)) && RAYS_GROW * last_s > LONGEST_S {
            notes.push(format!(
                "{} were left out: they would take {:.0} CPU s or more.",
                method.name(),
                RAYS_GROW * last_s
            ));
            done += weight;
            continue;
        }
        let inner = |progress: Progress| {
            let within = match progress.stage {
                "rays" => weight * progress.done / progress.total.max(1),
                _ => 0,
            };
            watch(Progress { stage: "methods", done: done + within, total })
        };
        let prepared = match method.prepared(scene) {
            Ok(prepared) => prepared,
            Err(Error::Invalid(problems)) if method != Method::Full => {
                let why: Vec<String> = problems.iter().map(|problem| problem.message.clone()).collect();
                notes.push(format!("{} was not run: {}", method.name(), why.join("; ")));
                continue;
            }
            Err(other) => return Err(other),
        };
        if method == Method::Full {
            ground = seen_ground(&prepared, &inner)?;
        }
        let (image, cpu_s, runs) = measured(&method, scene, prepared.clone(), clock, &inner)?;
        let truth = entries.first().map_or(&image, |full| &full.image);
        let errors = compared(&image, truth, &ground);
        entries.push(Entry {
            family: method.family(),
            name: method.name(),
            account: method.account(),
            model: method.model().to_owned(),
            facets: prepared.body.mesh.facets.len(),
            cpu_s,
            runs,
            errors,
            image,
            is_best: false,
        });
        done += weight;
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
        bands: scene.exposure.bands.clone(),
        ground,
        entries,
        notes,
    })
}

/// Share of a method in the progress.
fn weight(method: &Method) -> u64 {
    match method {
        Method::Rays(rays) => 8 + u64::from(*rays),
        // 37 views of the Sun.
        Method::Full | Method::Models(Choice::WithoutMars) => 300,
        _ => 16,
    }
}

/// Runs a method until its time is known.
fn measured(
    method: &Method,
    scene: &Scene,
    first: Scene,
    clock: Clock<'_>,
    watch: Watch<'_>,
) -> Result<(Bands, f64, u32)> {
    let began = clock();
    let image = method.image(&first, watch)?;
    let (mut least_s, mut runs) = (clock() - began, 1);
    while runs < RUNS && least_s < QUICK_S {
        // What a run has found out about a body stays with it: each starts from a new one.
        let again = method.prepared(scene)?;
        let began = clock();
        method.image(&again, watch)?;
        least_s = least_s.min(clock() - began);
        runs += 1;
    }
    Ok((image, least_s, runs))
}

fn compared(image: &Bands, truth: &Bands, ground: &[Ground]) -> Vec<BandErrors> {
    image.iter().zip(truth).map(|(image, truth)| BandErrors::new(image, truth, ground)).collect()
}

/// What each pixel sees, exactly.
fn seen_ground(scene: &Scene, watch: Watch<'_>) -> Result<Vec<Ground>> {
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
