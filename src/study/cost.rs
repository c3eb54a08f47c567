//! What a simulation takes: memory, disk space, time, estimated before anything is computed.

use super::extremes::Extremes;
use super::summary::summary;
use crate::error::{Error, Location, Problem, Result};
use crate::instrument::Optics;
use crate::integrate::plane_count;
use crate::scene::{Readout, Scene, Setup, SunModel, Texture, Thermal, Timing};
use crate::solve::Emission;

/// A process without facets and pixels holds this, bytes.
const PROCESS_BYTES: u64 = 16_000_000;
/// A facet and its share of vertices, neighbours, light and drawing. Measured: 124 at 60 deg of incidence, 147 at 85 deg, where shadows
/// have more polygons.
const FACET_BYTES: u64 = 140;
/// Weights of a pixel, if there are few bands or no heat, and otherwise: temperatures share rows then.
const WEIGHTS: [u64; 2] = [5, 16];
/// A weight and its row, once in the lines and once in the image.
const WEIGHT_BYTES: u64 = 2 * 12;

/// A further point of the Sun's disc adds this much to a facet at most, bytes: polygons of what it sees. Measured: 94 and 160, at 60 and 85 deg.
const POINT_BYTES: u64 = 140;
/// Light between facets adds this much to one: what it has at each wavelength, what it sends, and what is on its way. Measured.
const EXCHANGE_BYTES: u64 = 260;

/// Estimates of CPU time are within this factor of the truth, up or down, on a machine of 2022.
pub const WITHIN: f64 = 3.0;
/// CPU seconds (user + system) of whole processes of `simulate`, release build, on 2 cores of an AMD EPYC (family 25, model 17: 2022),
/// 2026-11-28, median of 3. Fitted to 42 scenes: the landscape of `benches/` with 1e3 to 2e6 facets as OBJ, 64 x 64 to 1024 x 1024 pixels, 1 to
/// 300 bands, the Sun at 0 to 85 deg of incidence, with and without Mars, heat and textures: all between 0.65 and 1.4 of the truth.
/// Mars and heat take less than a fifth, and have no term.
mod seconds {
    pub(super) const PROCESS: f64 = 0.006;
    /// To read it, to join it to its neighbours, and to find what the Sun sees of it.
    pub(super) const FACET: f64 = 1.0e-6;
    /// More of that for each unit of the tangent of the Sun's incidence on the mean surface, up to [`MOST_TANGENT`]: facets hide one another.
    pub(super) const FACET_TANGENT: f64 = 1.2e-7;
    pub(super) const MOST_TANGENT: f64 = 12.0;
    /// To find what a further point of the Sun's or of Mars' disc sees of it, and to look for that in the image; more of it by the tangent as above.
    /// Measured with the landscape of `benches/`, 2e5 facets, 2026-11-29, on a busy machine: 0.18 s a point at 60 deg, 0.37 s at 85 deg.
    pub(super) const PASS: f64 = 7.0e-7;
    pub(super) const PASS_TANGENT: f64 = 1.0e-7;
    /// To look through it, and to find its planes and write them.
    pub(super) const PIXEL: f64 = 1.6e-6;
    /// Pieces that pixels and facets cut each other into along their edges: proportional to the root of facets x pixels.
    pub(super) const CROSSING: f64 = 2.9e-6;
    /// A pixel in a band.
    pub(super) const NUMBER: f64 = 1.1e-8;
    /// What a pixel shows of a facet whose surface has a model, from one direction of a source: on the shipped sites, 2026-11-29.
    pub(super) const DIRECTION: f64 = 2.5e-7;
    /// A material with a model: its albedos in all directions, for what it absorbs and emits, and its bounds.
    pub(super) const MODEL: f64 = 0.2;
    /// To draw a facet once more.
    pub(super) const DRAWN: f64 = 1.5e-7;
    /// A part of a pixel in a band, to blur it.
    pub(super) const BLURRED: f64 = 4.0e-8;
    /// A texel in a layer.
    pub(super) const TEXEL: f64 = 2.3e-7;
}

/// What of a scene's work is not plain from its sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Workload {
    /// Facets that the image's frame might hold.
    pub(super) facets_in_frame: u64,
    /// Share of the image that the surface fills.
    pub(super) filled: f64,
    /// Of sunlight on the mean surface; `None` for a body.
    pub(super) mean_incidence_deg: Option<f64>,
}

impl Workload {
    /// From a look at the scene.
    pub(super) fn of(scene: &Scene, extremes: &Extremes) -> Self {
        Workload {
            facets_in_frame: extremes.glimpse.facets_in_frame,
            filled: extremes.glimpse.filled(),
            mean_incidence_deg: summary(scene, &extremes.site).mean_incidence_deg,
        }
    }
}

/// About the CPU time, s, that an image takes by a point Sun without what effects take; within a factor of [`WITHIN`] on such a machine.
pub(super) fn cpu_s(scene: &Scene, workload: &Workload) -> f64 {
    cpu_s_with(scene, workload, scene.body.mesh.facets.len() as f64)
}

/// The same with another number of facets.
pub(super) fn cpu_s_with(scene: &Scene, workload: &Workload, facets: f64) -> f64 {
    let pixels = pixels(scene) as f64;
    let facets_in_frame = workload.facets_in_frame as f64 * facets / scene.body.mesh.facets.len().max(1) as f64;
    // A Sun below the mean surface grazes as well. A body has all incidences.
    let tangent = workload.mean_incidence_deg.map_or(1.0, |deg| deg.to_radians().tan().abs());
    let facet_s = seconds::FACET + seconds::FACET_TANGENT * tangent.min(seconds::MOST_TANGENT);
    let texels: usize = scene.body.textures.iter().map(|t| t.values.len()).sum();
    let models = scene.body.materials.iter().filter(|material| material.photometry.key().is_some()).count();
    seconds::PROCESS
        + seconds::MODEL * models as f64
        + facet_s * facets
        + seconds::PIXEL * pixels
        + seconds::CROSSING * (facets_in_frame * workload.filled * pixels).sqrt()
        + seconds::NUMBER * pixels * scene.exposure.bands.len() as f64
        + seconds::TEXEL * texels as f64
}

/// CPU time, s, to find the shadows of one more Sun.
pub(super) fn shadows_s(scene: &Setup) -> f64 {
    let towards = scene.sky.sun.direction.vec();
    let sum_m2: glam::DVec3 = scene.body.mesh.spread(1024).map(|f| scene.body.mesh.facet(f).cross_m2()).sum();
    let cos = sum_m2.normalize_or_zero().dot(towards).abs();
    let tangent = if cos > 0.0 { (1.0 / (cos * cos) - 1.0).max(0.0).sqrt() } else { 1.0 };
    pass_s(scene.body.mesh.facets.len(), tangent)
}

/// About the CPU time, s, that finding what one more point of a disc sees takes: the tangent is that of its incidence on the mean surface.
pub(super) fn pass_s(facets: usize, tangent: f64) -> f64 {
    facets as f64 * (seconds::PASS + seconds::PASS_TANGENT * tangent.min(seconds::MOST_TANGENT))
}

/// About the CPU time, s, that light from so many more directions takes where surfaces have models.
pub(super) fn directions_s(scene: &Setup, extremes: &Extremes, directions: usize) -> f64 {
    let glimpse = &extremes.glimpse;
    let fragments = (pixels(scene) + glimpse.facets_in_frame) as f64 * glimpse.filled();
    seconds::DIRECTION * fragments * directions as f64
}

/// What is looked at besides one plain image: exposures, or finer images that are blurred.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Looks {
    /// How many.
    pub count: f64,
    /// Pixels of one, over those of the image.
    pub pixels: f64,
    /// The share of the image's facets that one has in its frame; the same share of the mesh is drawn.
    pub facets: f64,
    /// Whether each is blurred.
    pub is_blurred: bool,
    /// Over how many looks the bands are spread.
    pub of_bands: usize,
}

impl Looks {
    /// Those that a scene's exposures and optics ask for.
    pub fn of(scene: &Setup, timing: Option<Timing>, optics: Option<&Optics>) -> Self {
        let camera = &scene.exposure.camera;
        let [samples, lines] = [camera.samples, camera.lines].map(f64::from);
        let count = timing.map_or(1, |timing| timing.count(&scene.exposure));
        let is_one = count <= 1 && timing.is_none_or(|timing| timing.poses <= 1);
        if is_one && optics.is_none() {
            return Looks { count: 0.0, pixels: 0.0, facets: 0.0, is_blurred: false, of_bands: 1 };
        }
        let [columns, rows] = match timing.map(|timing| timing.readout) {
            Some(Readout::Line) => [samples, 1.0],
            Some(Readout::Sample(mirror)) => [1.0, f64::from(mirror.elements)],
            _ => [samples, lines],
        };
        let (around, parts) =
            optics.map_or((0.0, 1.0), |optics| (2.0 * f64::from(optics.reach_px), f64::from(optics.subpixels)));
        let seen = (columns + around) * (rows + around) / (samples * lines);
        // Blocks of lines carry along what their neighbours see.
        let beside = if rows < lines { 10.0 } else { 0.0 };
        Looks {
            count: count as f64 * f64::from(timing.map_or(1, |timing| timing.poses.max(1))),
            pixels: seen * parts * parts,
            facets: ((rows + around + beside) / lines).min(1.0),
            is_blurred: optics.is_some(),
            of_bands: if timing.is_some_and(|timing| timing.readout == Readout::Band) { count.max(1) } else { 1 },
        }
    }
}

/// About the CPU time, s, that looks take.
pub(super) fn looks_s(scene: &Setup, workload: &Workload, looks: Looks, directions: usize) -> f64 {
    // Each band of a filter is looked at by itself.
    let bands = scene.exposure.bands.len().div_ceil(looks.of_bands);
    let Looks { count, pixels, facets, is_blurred, .. } = looks;
    let pixels = pixels * self::pixels(scene) as f64;
    let in_frame = facets * workload.facets_in_frame as f64 * workload.filled;
    let fragments = pixels * workload.filled + in_frame;
    let blurred_s = if is_blurred { seconds::BLURRED * pixels * bands as f64 } else { 0.0 };
    count
        * (seconds::DRAWN * facets * scene.body.mesh.facets.len() as f64
            + seconds::PIXEL * pixels
            + seconds::CROSSING * (in_frame * pixels).sqrt()
            + seconds::DIRECTION * fragments * directions as f64
            + blurred_s)
}

fn pixels(scene: &Setup) -> u64 {
    u64::from(scene.exposure.camera.samples) * u64::from(scene.exposure.camera.lines)
}

/// About what an image takes in memory, bytes.
fn image_bytes(scene: &Scene, has_maps: bool) -> u64 {
    let (planes, bands) = (plane_count(scene) as u64, scene.exposure.bands.len() as u64);
    let weights = WEIGHTS
        [usize::from(scene.models.thermal != Thermal::Off && !Emission::has_row_per_band(&scene.exposure.bands))];
    // Maps may reach every pixel, and what they add is kept as it is; planes of their own and weights of texels are about as much as the others.
    let of_maps = if has_maps { 8 * (planes + bands) } else { 0 };
    pixels(scene).saturating_mul(8 * planes + WEIGHT_BYTES * weights + of_maps)
}

/// About what a process that makes an image holds at most, bytes.
pub fn memory_bytes(scene: &Scene, has_maps: bool) -> u64 {
    let of_texture = |t: &Texture| 8 * (t.values.len() + 6 * t.corners.len()) as u64;
    let of_sun = match scene.models.sun {
        SunModel::Point => 0,
        SunModel::Disc(rule) => POINT_BYTES * (rule.count() as u64 - 1),
    };
    let of_models = of_sun + scene.models.exchange.map_or(0, |_| EXCHANGE_BYTES);
    let held = PROCESS_BYTES
        + (FACET_BYTES + of_models) * scene.body.mesh.facets.len() as u64
        + scene.body.textures.iter().map(of_texture).sum::<u64>();
    image_bytes(scene, has_maps).saturating_add(held)
}

/// Refuses if the machine cannot hold the image: running out of memory later would abort the program.
///
/// # Errors
/// [`Error::Invalid`] if it all takes more than `memory_bytes`, or the system does not provide what the image takes.
pub fn has_room(scene: &Scene, has_maps: bool, memory_bytes: Option<u64>) -> Result<()> {
    has_room_for(scene, has_maps, 0, memory_bytes)
}

/// The same with so many bytes more for each pixel in each band: of cubes that are held number by number.
///
/// # Errors
/// As [`has_room`].
pub fn has_room_for(scene: &Scene, has_maps: bool, number_bytes: u64, memory_bytes: Option<u64>) -> Result<()> {
    let of_numbers = pixels(scene).saturating_mul(scene.exposure.bands.len() as u64).saturating_mul(number_bytes);
    let of_image = image_bytes(scene, has_maps).saturating_add(of_numbers);
    let bytes = self::memory_bytes(scene, has_maps).saturating_add(of_numbers);
    let mut room: Vec<u8> = Vec::new();
    let asked = memory_bytes.is_none_or(|memory| bytes <= memory)
        && usize::try_from(of_image).is_ok_and(|bytes| room.try_reserve_exact(bytes).is_ok());
    // Without this the compiler may drop an allocation that is never used.
    std::hint::black_box(&room);
    if asked {
        return Ok(());
    }
    let (samples, lines) = (scene.exposure.camera.samples, scene.exposure.camera.lines);
    let size = |bytes: u64| match bytes as f64 / 1e6 {
        megabytes if megabytes < 100.0 => format!("{megabytes:.1} MB"),
        megabytes => format!("{:.1} GB", megabytes / 1e3),
    };
    let there = match memory_bytes {
        Some(memory) if memory < bytes => format!("the machine has {}", size(memory)),
        _ => "which the system does not give: is there a limit (`ulimit -v`)?".to_owned(),
    };
    let (image, rest) = (size(of_image), size(bytes - of_image));
    let (in_bands, help) = match (number_bytes, scene.exposure.bands.len()) {
        (0, _) => (
            String::new(),
            "fewer samples and lines; a large image can be made of several, each with an observer that looks at its part",
        ),
        (_, bands) => (
            format!(" in {bands} bands"),
            "simulate into a folder, which is written a few lines at a time; or fewer samples, lines or bands, or single precision",
        ),
    };
    let message =
        format!("{samples} x {lines} pixels{in_bands} take some {image} of memory and the scene {rest}, {there}");
    Err(Error::Invalid(vec![Problem::new(Location::item("sensor"), message).with_help(help)]))
}

/// About what a product takes on the disk, bytes: `number_bytes` for each pixel and band, the planes, and no more.
pub fn product_bytes(scene: &Scene, number_bytes: u64) -> u64 {
    let pixel_bytes =
        number_bytes.saturating_mul(scene.exposure.bands.len() as u64).saturating_add(8 * plane_count(scene) as u64);
    pixels(scene).saturating_mul(pixel_bytes)
}
