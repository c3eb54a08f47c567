//! What `mmxrt inspect` reports about a scene: a dry run of `mmxrt simulate`.

use std::path::Path;

use mmxrt::flight::Scale;
use mmxrt::formats::{Reading, machine};
use mmxrt::job::{self, Outlook};
use mmxrt::scene::{Material, Motion, Readout, Scene, Timing};
use mmxrt::spectral::Band;
use mmxrt::{Result, study};
use serde_json::{Value, json};

use super::Outcome;
use super::console::Console;

pub(super) fn run(path: &Path, reading: &Reading, console: &Console) -> Result<Outcome> {
    let outlook = job::dry_run_with(path, reading, &|progress| console.watch(progress))?;
    console.result(&text(&outlook), &json_of(&outlook))?;
    outlook.error.map_or(Ok(Outcome::Done), Err)
}

/// The most wanted facts in a few lines; `--json` has everything, to full precision.
fn text(outlook: &Outlook) -> String {
    let Outlook { subject, dry_run, warnings, .. } = outlook;
    let about = &dry_run.summary;
    let sensor = &subject.scene.exposure;
    let degrees = |name: &str, value: Option<f64>| value.map(|deg| format!("{name} {deg:.2} deg"));
    let above = |value: Option<f64>| value.map(|deg| format!("{deg:.2} deg above level ground"));
    let joined = |parts: &[Option<String>]| parts.iter().flatten().cloned().collect::<Vec<_>>().join(", ");
    let metres = |sizes: &[f64]| sizes.iter().map(|m| short(*m)).collect::<Vec<_>>().join(" x ") + " m";
    let sun = [
        Some(format!("{:.4} au away", about.sun_distance_au)),
        above(about.sun_elevation_deg),
        degrees("incidence on the mean surface", about.mean_incidence_deg),
    ];
    let mars = joined(&[degrees("radius", about.mars_radius_deg), above(about.mars_elevation_deg)]);
    let angles = [
        degrees("incidence", about.sun_elevation_deg.map(|deg| 90.0 - deg)),
        degrees("emission", about.emission_deg),
        degrees("phase", Some(about.phase_deg)),
    ];
    let has =
        |bytes: Option<u64>, place: &str| bytes.map_or(String::new(), |b| format!("; {} are free{place}", size(b)));
    let lines = [
        "kind: scene".to_owned(),
        "dry run: nothing is computed or written".to_owned(),
        format!("facets: {}; {} vertices, {} open edges", about.facets, about.vertices, about.open_edges),
        format!("size: {}", metres(&about.size_m)),
        list("materials", subject.scene.body.materials.iter().map(|m| material(&subject.scene, m))),
        format!("sun: {}", joined(&sun)),
        format!("mars: {}", if mars.is_empty() { "none" } else { &mars }),
        format!("at the origin: {}", joined(&angles)),
        format!("camera: {}, {} from the origin", sensor.instrument, metres(&[about.range_m])),
        format!(
            "flight: {}",
            subject.motion.as_ref().map_or("none".to_owned(), |moving| flight(&subject.scene, moving))
        ),
        format!(
            "image: {} x {} pixels of {} there ({} mrad); {}, about {:.0} % filled",
            sensor.camera.samples,
            sensor.camera.lines,
            metres(&[about.pixel_m]),
            short(about.ifov_mrad),
            metres(&about.image_m),
            100.0 * dry_run.filled,
        ),
        format!("bands: {}", bands(&sensor.bands)),
        format!("table_id: {}", study::table_id(&subject.scene)),
        format!("defaults: {}, see --json", subject.defaults.len()),
        list("warnings", warnings.iter().cloned()),
        "expects:".to_owned(),
        format!("  memory: about {}{}", size(dry_run.memory_bytes), has(outlook.free_memory_bytes, "")),
        format!(
            "  disk: about {} for the product's folder{}",
            size(dry_run.product_bytes),
            has(outlook.free_disk_bytes, " here")
        ),
        format!(
            "  time: about {} CPU s (on a machine of 2022, within a factor of {})",
            rounded(dry_run.cpu_s, 2),
            study::WITHIN
        ),
        format!("begins: {}", if outlook.error.is_none() { "yes" } else { "no" }),
    ];
    lines.join("\n")
}

/// What flies, when, and how the image is taken on the way.
fn flight(scene: &Scene, (motion, timing): &(Motion, Timing)) -> String {
    let each = match timing.readout {
        Readout::Frame => "all at once",
        Readout::Band => "a band at a time",
        Readout::Line => "a line at a time",
        Readout::Sample(_) => "a sample at a time",
    };
    let start = motion.start.to_text(Scale::Utc, 3, &motion.almanac.leap);
    let duration_s = short(timing.duration_s(&scene.exposure));
    format!(
        "{} about {}, from {start} UTC; {each}: {} exposures over {duration_s} s",
        motion.spacecraft,
        motion.body,
        timing.count(&scene.exposure)
    )
}

/// A list under its name.
fn list(name: &str, items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.map(|item| format!("\n  {item}")).collect();
    format!("{name}:{}", if items.is_empty() { " none".to_owned() } else { items.concat() })
}

/// Where materials are compared, um.
fn middle_um(scene: &Scene) -> Option<f64> {
    scene.exposure.bands.get(scene.exposure.bands.len() / 2).map(|band| band.centre_um)
}

fn material(scene: &Scene, material: &Material) -> String {
    let at = |um: f64| Some(format!(", reflectance {} at {} um", short(material.reflectance.at(um)?), short(um)));
    let reflectance = middle_um(scene).and_then(at).unwrap_or_default();
    let photometry = material.photometry.key().unwrap_or("lambert");
    format!("{}: {photometry}{reflectance}, Bond albedo {}", material.name, short(material.bond_albedo))
}

fn bands(bands: &[Band]) -> String {
    let (Some(first), Some(last)) = (bands.first(), bands.last()) else { return "none".to_owned() };
    let widths_um = || bands.iter().filter_map(|band| band.fwhm_um);
    let (least_um, most_um) = (widths_um().fold(f64::INFINITY, f64::min), widths_um().fold(0.0, f64::max));
    let widths = match widths_um().count() {
        0 => "monochromatic".to_owned(),
        _ if least_um == most_um => format!("{} um wide", short(least_um)),
        _ => format!("{} to {} um wide", short(least_um), short(most_um)),
    };
    let places = match bands.len() {
        1 => format!("at {} um", first.centre_um),
        _ => format!("from {} to {} um", first.centre_um, last.centre_um),
    };
    format!("{} {places}, {widths}", bands.len())
}

pub(super) fn size(bytes: u64) -> String {
    machine::size(bytes, 1)
}

pub(super) fn short(value: f64) -> String {
    rounded(value, 4)
}

/// This many digits, or all before the decimal point.
pub(super) fn rounded(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    #[expect(clippy::cast_possible_truncation, reason = "powers of ten of numbers are within 400")]
    let power = value.abs().log10().floor() as i32;
    let decimals = (digits - 1 - power).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

pub(crate) fn json_of(outlook: &Outlook) -> Value {
    let Outlook { subject, dry_run, warnings, .. } = outlook;
    let scene = &subject.scene;
    let defaults: Vec<String> = subject.defaults.iter().map(ToString::to_string).collect();
    let about = &dry_run.summary;
    let bands = &scene.exposure.bands;
    let [x, y, z] = about.size_m;
    let at_um = middle_um(scene);
    let materials = scene.body.materials.iter().map(|m| {
        json!({
            "name": m.name, "bond_albedo": m.bond_albedo, "photometry": m.photometry.key().unwrap_or("lambert"),
            "reflectance": at_um.and_then(|um| m.reflectance.at(um)), "at_um": at_um,
        })
    });
    json!({
        "kind": "scene",
        "dry_run": true,
        "facets": about.facets,
        "vertices": about.vertices,
        "open_edges": about.open_edges,
        "flipped_facets": about.flipped_facets,
        "zero_area_facets": about.zero_area_facets,
        "size_m": { "x": x, "y": y, "z": z },
        "materials": materials.collect::<Value>(),
        "sun_distance_au": about.sun_distance_au,
        "sun_elevation_deg": about.sun_elevation_deg,
        "mean_incidence_deg": about.mean_incidence_deg,
        "phase_deg": about.phase_deg,
        "emission_deg": about.emission_deg,
        "range_m": about.range_m,
        "mars_elevation_deg": about.mars_elevation_deg,
        "mars_radius_deg": about.mars_radius_deg,
        "sensor": scene.exposure.instrument,
        "samples": scene.exposure.camera.samples,
        "lines": scene.exposure.camera.lines,
        "ifov_mrad": about.ifov_mrad,
        "pixel_m": about.pixel_m,
        "image_m": { "across": about.image_m[0], "down": about.image_m[1] },
        "filled": dry_run.filled,
        "bands": bands.len(),
        "first_band_um": bands.first().map(|b| b.centre_um),
        "last_band_um": bands.last().map(|b| b.centre_um),
        "fwhm_um": bands.first().and_then(|b| b.fwhm_um),
        "table_id": study::table_id(scene),
        "defaults": defaults,
        "warnings": warnings,
        "expects": {
            "memory_bytes": dry_run.memory_bytes, "disk_bytes": dry_run.product_bytes,
            "cpu_s": dry_run.cpu_s, "cpu_s_within_factor": study::WITHIN,
        },
        "free": { "memory_bytes": outlook.free_memory_bytes, "disk_bytes": outlook.free_disk_bytes },
        "begins": outlook.error.is_none(),
    })
}
