//! `mmxrt inspect`: what a file holds.

use std::path::{Path, PathBuf};

use mmxrt::flight::{Epoch, LeapSeconds, Scale, Span};
use mmxrt::formats::Format;
use mmxrt::formats::campaign_toml::{Acquisition, Campaign};
use mmxrt::formats::convert::{self, Content};
use mmxrt::formats::dart::output;
use mmxrt::formats::located::Document;
use mmxrt::formats::manifest_json::{self, Manifest};
use mmxrt::formats::mesh_file::{MeshFile, Up};
use mmxrt::formats::mtl::{self, ObjMaterial};
use mmxrt::formats::product_image;
use mmxrt::formats::report_json::{self, FORMAT_VERSION, InstrumentReport, ProductReport, Run};
use mmxrt::formats::spectrum_csv::{self, Quantity};
use mmxrt::formats::{
    envi, ephemeris, exposures_csv, exr_cube, flight_doubts, npz, pixel, product_folder, radiance_map, recipe_toml,
    registry, spectra, spice,
};
use mmxrt::geometry::Defects;
use mmxrt::job::{self, CurveSheet, FlightFacts, PartFacts, SurfaceFacts, Survey};
use mmxrt::physics::reflectance::Preset;
use mmxrt::spectral::{Extend, SunTotal, solar_e490};
use mmxrt::{Error, Location, Problem, Result};
use serde_json::{Value, json};

use super::Outcome;
use super::console::Console;
use super::scene::ReadingArguments;
use super::surface::Written;

#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("written").args(["csv", "picture"]).multiple(true)))]
pub(crate) struct Arguments {
    /// A product folder, image or elevation model (ENVI, ILWIS, OpenEXR, NumPy, PNG, JPEG, PGM, TIFF, PDS3, PDS4, ISIS, ESRI ASCII grid, CSV), .npz, .json report, scene, recipe, spectrum (.csv), mesh (.obj, .ply, .stl, .tab, .icq, .bds), .mtl, .gltf, .glb, DART simulation, output or optical database, .sli, .txt, .oem or .aem, a kernel of SPICE; or `e490`, the built-in spectrum of the Sun, or the name of a surface: phobos_assumed, deimos_assumed, moon, mars, thesis
    file: PathBuf,
    /// Show the spectrum and planes of this pixel of a product folder, counted from 0
    #[arg(long, value_name = "SAMPLE,LINE", value_parser = pixel)]
    pixel: Option<(usize, usize)>,
    #[command(flatten)]
    reading: ReadingArguments,
    /// How this material of a scene reflects; a preset is named in place of a file
    #[arg(long, value_name = "NAME", conflicts_with = "pixel")]
    material: Option<String>,
    /// A wavelength, um, of the material; may be repeated. Default: first, middle and last band
    #[arg(long, value_name = "UM", requires = "material")]
    um: Vec<f64>,
    /// Write spectra (of a file, of the pixel, of the Sun) or the phase curve of the material, as a table
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    /// Write a picture of an image (.png: grey, or three bands in colour), or of spectra (of a file, of a pixel, of the Sun) or the phase curve of a material (.svg), or of an orbit or attitude (.svg or .png), or of a mesh from four sides (.png; inner sides are red)
    #[arg(long, value_name = "OUT")]
    picture: Option<PathBuf>,
    /// The band to show, counted from 1; given three times, those for red, green and blue
    #[arg(long, value_name = "N", requires = "picture", value_parser = clap::value_parser!(u32).range(1..))]
    band: Vec<u32>,
    /// Replace an existing picture or table
    #[arg(long, requires = "written")]
    force: bool,
}

/// The name of the built-in spectrum of the Sun, unless a file has that name.
const BUILT_IN_SUN: &str = "e490";

fn pixel(text: &str) -> std::result::Result<(usize, usize), String> {
    let number = |text: &str| text.trim().parse().map_err(|_| "two whole numbers, e.g. 128,64".to_owned());
    let (sample, line) = text.split_once(',').ok_or("two whole numbers, e.g. 128,64")?;
    Ok((number(sample)?, number(line)?))
}

/// What a file holds: names and values, in the order they are printed.
type Facts = Vec<(&'static str, Value)>;

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let path = &arguments.file;
    super::settle_input(path, console)?;
    let preset = path.to_str().filter(|_| !path.exists()).and_then(Preset::of_name);
    let written =
        Written { csv: arguments.csv.as_deref(), svg: arguments.picture.as_deref(), replace: arguments.force };
    match (&arguments.material, preset) {
        (Some(name), _) => {
            let facts = SurfaceFacts::of_material(path, name, &arguments.um, &|progress| console.watch(progress))?;
            return super::surface::run(&facts, written, console);
        }
        (None, Some(preset)) => return super::surface::run(&SurfaceFacts::of_preset(preset), written, console),
        (None, None) => {}
    }
    if arguments.pixel.is_some() || (path == Path::new(BUILT_IN_SUN) && !path.exists()) {
        return spectrum_of(arguments, console);
    }
    path.metadata().map_err(|e| Error::io(path, "reading", e))?;
    if let Some(first) = arguments.reading.set.first()
        && !is_scene(path)?
    {
        return Err(Error::invalid(
            Location::file(path),
            format!("is not a scene file, of which --set {first} could replace an item"),
        ));
    }
    let is_spectral = || registry::of_input(path).is_ok_and(|(format, _)| format.is_spectral());
    if arguments.csv.is_some() && !is_spectral() {
        let message = "has no spectra to write: use --csv with --pixel, with a file of spectra, or with `e490`";
        return Err(Error::invalid(Location::file(path), message));
    }
    // A kernel of shapes is a mesh.
    let is_mesh = || registry::of_input(path).is_ok_and(|(format, _)| format.is_mesh());
    if path.is_file() && ephemeris::is_kernel(path)? && !is_mesh() {
        if let Some(target) = &arguments.picture {
            super::settle(target, console)?;
            job::draw_flight(path, target, arguments.force)?;
        }
        return tell(kernel(path)?, arguments, console);
    }
    // For a product, the cube is the image.
    let cube = product_image(path, "cube");
    let path = if arguments.picture.is_some() && path.is_dir() && cube.exists() { &cube } else { path };
    let found = match path.is_file().then(|| registry::of_input(path)) {
        Some(Err(e @ Error::Unsupported { .. })) => return Err(e),
        found => found.and_then(|found| Some(found.ok()?.0)),
    };
    let facts = match found {
        _ if arguments.picture.is_none() && path.is_file() && exposures_csv::is_one(path)? => exposures(path)?,
        Some(format) if format.is_image() => image(path, format, arguments, console)?,
        Some(format) if format.is_flight() => {
            if let Some(target) = &arguments.picture {
                super::settle(target, console)?;
                job::draw_flight(path, target, arguments.force)?;
            }
            flight(path, format.name)?
        }
        Some(format) if format.is_mesh() && arguments.picture.is_some() => {
            let facts = inspect(path, found, console)?;
            if let Some(target) = &arguments.picture {
                super::settle(target, console)?;
                job::draw_mesh(path, target, arguments.force)?;
            }
            facts
        }
        Some(format) if format.is_spectral() && (arguments.picture.is_some() || arguments.csv.is_some()) => {
            let facts = inspect(path, found, console)?;
            for target in arguments.csv.iter().chain(&arguments.picture) {
                super::settle(target, console)?;
            }
            let sheet = CurveSheet::of_spectra(path, &spectra::read(path)?.0);
            sheet.write(arguments.csv.as_deref(), arguments.picture.as_deref(), arguments.force)?;
            facts
        }
        _ if arguments.picture.is_some() => {
            let problem = Problem::new(Location::file(path), "is not an image, so no picture can be made of it");
            let help = "pictures are made of images, meshes, spectra, orbits and attitudes (also kernels); of a product folder its cube";
            return Err(Error::Invalid(vec![problem.with_help(help)]));
        }
        _ if is_campaign(path)? => campaign(path, console)?,
        _ if is_scene(path)? => return super::dry_run::run(path, &arguments.reading.reading(console)?, console),
        _ => inspect(path, found, console)?,
    };
    tell(facts, arguments, console)
}

/// Prints facts, on request as JSON.
fn tell(facts: Facts, arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let text = facts.iter().map(|(name, value)| line(name, value)).collect::<String>();
    let json: serde_json::Map<String, Value> =
        facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    match arguments.picture.as_ref().or(arguments.csv.as_ref()) {
        Some(_) => console.done(&text, &Value::Object(json)),
        None => console.result(&text, &Value::Object(json))?,
    }
    Ok(Outcome::Done)
}

/// The spectrum of a pixel, or of the Sun: printed, and on request written and drawn.
fn spectrum_of(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let path = &arguments.file;
    let (json, sheet) = match arguments.pixel {
        Some((sample, line)) => {
            let found = pixel::read(path, sample, line)?;
            let columns = found.columns();
            let planes: serde_json::Map<String, Value> =
                found.planes.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
            let mut json = json!({ "sample": sample, "line": line, "planes": planes });
            json["wavelength_um"] = json!(found.wavelength_um);
            for (name, values) in &columns {
                json[*name] = json!(values);
            }
            if found.has_names() {
                json["band"] = json!(found.names);
            }
            let sheet = CurveSheet::of_pixel(path, &found)?;
            (json, sheet)
        }
        None => {
            let sun = solar_e490();
            let (um, irradiance) = (sun.wavelength_um(), sun.value());
            let total = SunTotal::of(sun).table_w_m2;
            let json = json!({
                "kind": "the Sun, ASTM E490-00a (2000), at 1 au", "points": um.len(), "total_w_m2": total,
                "wavelength_um": um, "irradiance_w_m2_um": irradiance,
            });
            (json, CurveSheet::of_sun())
        }
    };
    for target in arguments.csv.iter().chain(&arguments.picture) {
        super::settle(target, console)?;
    }
    sheet.write(arguments.csv.as_deref(), arguments.picture.as_deref(), arguments.force)?;
    let text = &sheet.csv;
    match arguments.csv.is_some() || arguments.picture.is_some() {
        true => console.done(text, &json),
        false => console.result(text, &json)?,
    }
    Ok(Outcome::Done)
}

/// A fact as text; a long list shows only its ends.
fn line(name: &str, value: &Value) -> String {
    const ENDS: usize = 6;
    const NAMING: [&str; 5] = ["name", "file", "path", "array", "band"];
    let short = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Object(object) => {
            // An empty name is shown as "".
            let of = |v: &Value| match v {
                Value::String(text) if !text.is_empty() => text.clone(),
                // What is inside is not read in a line.
                Value::Array(items) if items.len() > ENDS || items.iter().any(Value::is_object) => {
                    format!("{} (see --json)", items.len())
                }
                Value::Object(inside) if inside.len() > ENDS => format!("{} items (see --json)", inside.len()),
                other => other.to_string(),
            };
            // The name comes first; the order of the rest means nothing.
            let (mut named, rest): (Vec<_>, Vec<_>) = object.iter().partition(|(k, _)| NAMING.contains(&k.as_str()));
            named.extend(rest);
            named.iter().map(|(k, v)| format!("{k} {}", of(v))).collect::<Vec<_>>().join(", ")
        }
        other => other.to_string(),
    };
    // What is said of each band is long: what of it is asked for first.
    let in_short = |band: &Value| {
        let of = |key: &str| Some((key.to_owned(), band.get(key)?.clone()));
        Value::Object(["centre_um", "snr_mean", "snr_lowest", "saturated"].into_iter().filter_map(of).collect())
    };
    match value {
        Value::Object(items) if name == "signal" && items.get("bands").is_some_and(Value::is_array) => {
            let bands = items["bands"].as_array().into_iter().flatten().map(in_short).collect();
            let rest: serde_json::Map<_, _> =
                items.iter().filter(|(key, _)| *key != "bands").map(|(k, v)| (k.clone(), v.clone())).collect();
            line(name, &Value::Object(rest)) + &line("signal of bands", &Value::Array(bands))
        }
        Value::Array(items) if items.is_empty() => format!("{name}: none\n"),
        Value::Object(items) if items.is_empty() => format!("{name}: none\n"),
        Value::Array(items) => {
            let mut rows: Vec<String> = items.iter().map(|item| format!("  {}\n", short(item))).collect();
            if rows.len() > 2 * ENDS + 1 {
                let left_out = rows.len() - 2 * ENDS;
                rows.splice(ENDS..ENDS + left_out, [format!("  ... {left_out} more, see --json\n")]);
            }
            format!("{name}:\n{}", rows.concat())
        }
        value => format!("{name}: {}\n", short(value)),
    }
}

fn inspect(path: &Path, format: Option<&Format>, console: &Console) -> Result<Facts> {
    if path.is_dir() {
        let is_convertible = !path.join("report.json").is_file() && registry::of_input(path).is_ok();
        return if is_convertible { converted(path, console) } else { folder(path) };
    }
    let extension = extension(path);
    match (extension.as_str(), format.map(|format| format.name)) {
        ("json", _) => report(path),
        ("mtl", _) => {
            Ok(vec![("kind", json!("MTL materials")), ("materials", materials(&mtl::read(path)?.0.materials))])
        }
        ("toml", _) => toml(path),
        (_, Some(name)) if format.is_some_and(Format::is_mesh) => mesh(path, name),
        (_, Some("csv")) => spectrum(path, console),
        (_, Some(_)) => converted(path, console),
        _ if path.is_file() => {
            if path.metadata().is_ok_and(|about| about.len() == 0) {
                return Err(Error::invalid(Location::file(path), "is empty"));
            }
            let message = format!("no known format ends in {extension:?}");
            let endings = registry::endings(|_| true).join(", ");
            let help = format!("these do: {endings}, json, mtl; or name a folder of a product or a DART simulation");
            Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
        }
        _ => Err(match path.metadata() {
            Ok(_) => {
                let problem = Problem::new(Location::file(path), "is a pipe or a device, not a file or folder");
                Error::Invalid(vec![problem.with_help("save its output to a file first")])
            }
            Err(e) => Error::io(path, "reading", e),
        }),
    }
}

/// What a kernel of SPICE holds.
fn kernel(path: &Path) -> Result<Facts> {
    let found = spice::contents(path)?;
    let segment = |of: &spice::SegmentFacts| {
        let (number, is_read) = of.data_type;
        json!({
            "name": of.of, "segment": of.name, "frame": of.frame, "type": number, "read": is_read, "from": of.span[0], "to": of.span[1],
        })
    };
    let mut facts = vec![("kind", json!(format!("SPICE {}", found.kind)))];
    let segments: Vec<Value> = found.segments.iter().map(segment).collect();
    let gaps = found.gaps.iter().map(|[of, from, to]| json!({ "name": of, "from": from, "to": to })).collect();
    for (name, values) in [("segments", segments), ("gaps", gaps)] {
        if !found.segments.is_empty() {
            facts.push((name, Value::Array(values)));
        }
    }
    let lists = [
        ("kernels", &found.kernels),
        ("rotations", &found.rotations),
        ("radii", &found.radii),
        ("names", &found.names),
        ("frames", &found.frames),
        ("clocks", &found.clocks),
    ];
    facts.extend(lists.into_iter().filter(|(_, list)| !list.is_empty()).map(|(name, list)| (name, json!(list))));
    if let Some((count, last_s)) = found.leap_seconds {
        facts.push(("leap_seconds", json!({ "steps": count, "tai_minus_utc_s": last_s })));
    }
    Ok(facts)
}

fn mesh(path: &Path, kind: &str) -> Result<Facts> {
    let MeshFile { surface, up, unit_m, ignored, report, doubts, material_doubts, .. } = registry::mesh(path, true)?;
    let mesh = &surface.mesh;
    let (low, high) = mesh.bounds_m().unwrap_or_default();
    let size = high - low;
    let defects = Defects::of(mesh);
    let area: f64 = (0..mesh.facets.len()).map(|facet| mesh.facet(facet).area_m2()).sum();
    // Of what has no edge to the outside. Facets that face inwards have a volume below 0.
    let volume = mesh.enclosed_m3().filter(|_| defects.open_edges == 0);
    let told = [&report.notes, &material_doubts, &doubts];
    let defects_told = json!({
        "open_edges": defects.open_edges,
        "edges_of_more_than_two_facets": defects.crowded_edges,
        "edges_where_facets_turn_over": defects.turned_edges,
        "duplicate_facets": defects.duplicate_facets,
        "facets_without_area": defects.flat_facets,
        "slivers": defects.slivers,
        "pairs_of_facets_that_cross": defects.crossings.pairs,
        "more_cross": defects.crossings.at_least,
        "coincident_vertices": defects.coincident_vertices,
        "unused_vertices": defects.unused_vertices,
    });
    let kind = if ["gltf", "glb"].contains(&kind) { "glTF".to_owned() } else { kind.to_uppercase() };
    Ok(vec![
        ("kind", json!(format!("{kind} mesh"))),
        ("vertices", json!(mesh.vertices_m.len())),
        ("facets", json!(mesh.facets.len())),
        ("size_in_its_unit", json!({ "x": size.x, "y": size.y, "z": size.z })),
        ("unit_m_of_its_format", json!(unit_m)),
        ("up", json!(if up == Up::Z { "z" } else { "y" })),
        ("origin_m", json!(surface.origin_m.map(|origin| origin.to_array()))),
        ("area_in_its_unit", json!(area)),
        ("volume_in_its_unit", json!(volume)),
        ("parts", json!(defects.parts)),
        ("defects", defects_told),
        ("materials", materials(&surface.materials)),
        ("passed_over", json!(ignored)),
        ("told", told.into_iter().flatten().map(|note| json!(note.to_string())).collect()),
    ])
}

fn materials(materials: &[ObjMaterial]) -> Value {
    materials.iter().map(|m| json!({ "name": m.name, "kd": m.kd })).collect()
}

/// What `convert` makes of a file or folder.
fn converted(path: &Path, console: &Console) -> Result<Facts> {
    let options = convert::Options { scratch: Some(std::env::temp_dir()), ..convert::Options::default() };
    let (format, content, report) = convert::read(path, &options, &|progress| console.watch(progress))?;
    let names: Vec<Value> = match &content {
        Content::Scene(scene, _) => scene.body.materials.iter().map(|m| json!({ "name": m.name })).collect(),
        Content::Moving(moving) => moving.0.body.materials.iter().map(|m| json!({ "name": m.name })).collect(),
        Content::Mesh(surface) => surface.materials.iter().map(|m| json!({ "name": m.name })).collect(),
        Content::Spectra(libraries) => {
            let columns = |l: &mmxrt::spectral::SpectralLibrary| -> Vec<String> {
                l.columns.iter().map(|column| column.name.clone()).collect()
            };
            let points = |l: &mmxrt::spectral::SpectralLibrary| l.wavelength_um.len();
            libraries.iter().map(|l| json!({ "name": l.name, "points": points(l), "columns": columns(l) })).collect()
        }
        Content::Raster(_) | Content::Flight(_) => vec![],
    };
    Ok(vec![
        ("kind", json!(format.name)),
        ("size", json!(content.size())),
        ("materials", names.into()),
        ("passed_over", report.notes.iter().map(|note| json!(note.to_string())).collect()),
    ])
}

/// Trajectories and orientations: of what, when, in which steps.
fn flight(path: &Path, kind: &str) -> Result<Facts> {
    let (file, all) = job::flight_facts(path)?;
    let time =
        |epoch: Epoch| format!("{} {}", epoch.to_text(file.scale, 3, &LeapSeconds::default()), file.scale.name());
    let from_to = |span: &Span| json!({ "from": time(span.start), "to": time(span.end) });
    let part = |of: &FlightFacts, part: &PartFacts| {
        let span = part.span.as_ref().map_or(json!("at all times"), from_to);
        let step_s = part.steps.map(|steps| {
            // Moments of 2026 are told apart by 1.2e-7 s.
            [steps.min_s, steps.median_s, steps.max_s].map(|s| (s * 1e6).round() / 1e6)
        });
        let mut fact = json!({ "name": of.of, "about": of.about, "from": span["from"], "to": span["to"] });
        for (name, value) in [("frame", json!(of.frame)), ("step_s_min_median_max", json!(step_s))] {
            if !value.is_null() {
                fact[name] = value;
            }
        }
        fact["rows"] = json!(part.rows);
        fact["interpolation"] = json!(part.interpolation);
        fact
    };
    let parts = |is_trajectory: bool| -> Value {
        let of = all.iter().filter(|facts| facts.frame.is_some() == is_trajectory);
        of.flat_map(|facts| facts.parts.iter().map(|each| part(facts, each))).collect()
    };
    let gaps = all.iter().flat_map(|facts| {
        facts.gaps.iter().map(|gap| json!({ "name": facts.of, "from": time(gap.start), "to": time(gap.end) }))
    });
    let altitudes = all.iter().filter_map(|facts| {
        let [least, most] = facts.altitude_m?.map(|metres| metres / 1000.0);
        Some(json!({ "name": facts.of, "above": facts.about, "min": least, "max": most }))
    });
    Ok(vec![
        ("kind", json!(kind)),
        ("scale_of_time", json!(file.scale.name())),
        ("trajectories", parts(true)),
        ("orientations", parts(false)),
        ("gaps", gaps.collect()),
        ("altitude_km", altitudes.collect()),
        ("told", file.report.notes.iter().map(|note| json!(note.to_string())).collect()),
        ("doubts", json!(flight_doubts::doubts(&file))),
    ])
}

/// When the parts of a product were taken, and how fast its image drifted.
fn exposures(path: &Path) -> Result<Facts> {
    let found = job::exposure_facts(path)?;
    // Moments are told apart by 1.2e-7 s.
    let rounded = |s: f64| (s * 1e6).round() / 1e6;
    let steps = |of: Option<job::Steps>| json!(of.map(|steps| [steps.min_s, steps.median_s, steps.max_s].map(rounded)));
    let [first, last] = found.ends.map(|moment| format!("{moment} TDB"));
    let gap = |(after, s): &(usize, f64)| json!({ "after_exposure": after + 1, "s": rounded(*s) });
    let mut facts = vec![
        ("kind", json!("exposures of a product")),
        ("exposures", json!(found.exposures)),
        ("each_takes", json!(found.takes.name())),
        ("first", json!(first)),
        ("last", json!(last)),
        ("span_s", json!(rounded(found.span_s))),
        ("step_s_min_median_max", steps(found.steps)),
        ("between_sweeps_s_min_median_max", steps(found.between_sweeps)),
        ("gaps", found.gaps.iter().map(gap).collect()),
    ];
    let [speed, turn] = found.moves.map_or([None; 2], |moves| moves.map(Some));
    let drift = found.drift_px_s;
    facts.extend([
        ("speed_m_s", json!(speed)),
        ("turn_mrad_s", json!(turn.map(|rad_s| 1e3 * rad_s))),
        ("drift_px_s", json!(drift.map(|of| json!({ "samples": of.mean[0], "lines": of.mean[1], "most": of.most })))),
    ]);
    facts.retain(|(_, value)| !value.is_null());
    Ok(facts)
}

/// Whether a file is a scene: other TOML files are maps, or recipes, which have a seed.
fn is_scene(path: &Path) -> Result<bool> {
    if !path.is_file() || extension(path) != "toml" {
        return Ok(false);
    }
    let (document, _) = Document::open(path)?;
    Ok(!document.has("seed") && !radiance_map::is_map(&document))
}

fn is_campaign(path: &Path) -> Result<bool> {
    Ok(path.is_file() && extension(path) == "toml" && Document::open(path)?.0.has("mmxrt_campaign"))
}

fn campaign(path: &Path, console: &Console) -> Result<Facts> {
    let campaign = Campaign::open(path, &|progress| console.watch(progress))?;
    let leap = campaign.leap();
    let acquisition = |of: &Acquisition| json!({ "name": of.name, "epoch": format!("{} UTC", of.epoch.to_text(Scale::Utc, 3, &leap)) });
    let all = &campaign.acquisitions;
    Ok(vec![
        ("kind", json!("campaign")),
        ("acquisitions", json!(all.len())),
        ("first", json!(all.first().map(acquisition))),
        ("last", json!(all.last().map(acquisition))),
        ("inputs", campaign.inputs().iter().map(|input| json!(input.path.display().to_string())).collect()),
        ("facets", json!(campaign.body().mesh.facets.len())),
    ])
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

fn toml(path: &Path) -> Result<Facts> {
    let (document, _) = Document::open(path)?;
    if radiance_map::is_map(&document) { map_file(path) } else { recipe(path) }
}

fn map_file(path: &Path) -> Result<Facts> {
    let keys: serde_json::Map<String, Value> =
        radiance_map::describe(path)?.into_iter().map(|(key, text)| (key, json!(text))).collect();
    Ok(vec![("kind", json!("radiance map file")), ("says", Value::Object(keys))])
}

fn recipe(path: &Path) -> Result<Facts> {
    let recipe = recipe_toml::read(path)?.recipe;
    Ok(vec![
        ("kind", json!("landscape recipe")),
        ("seed", json!(recipe.seed)),
        ("size_m", json!(recipe.size_m)),
        ("facets", json!(recipe.facets)),
        ("relief", json!(recipe.relief)),
        ("craters", json!(recipe.craters)),
        ("cover", json!(recipe.cover)),
        ("boulders", json!(recipe.boulders)),
        ("paint", json!(recipe.paint)),
        ("detail", json!(recipe.detail)),
        ("surroundings", json!(recipe.surroundings)),
        ("body", json!(recipe.body)),
    ])
}

/// A spectrum of a surface or of the Sun, or a table that is not a spectrum but is read the same way.
fn spectrum(path: &Path, console: &Console) -> Result<Facts> {
    if let Some((facets, bands)) = radiance_map::facets_of(path)? {
        let bands = bands.iter().map(|band| json!({ "um": band.centre_um, "fwhm_um": band.fwhm_um }));
        return Ok(vec![
            ("kind", json!("radiance of facets, W m-2 sr-1 um-1, for `integrate --radiance`")),
            ("facets", json!(facets)),
            ("bands", bands.collect()),
        ]);
    }
    let (quantity, spectrum, report) =
        match (spectrum_csv::read_any(path, Extend::Error), spectrum_csv::read_all(path, None)) {
            (Ok(read), _) => read,
            // A table of several.
            (Err(_), Ok((spectra, _))) => {
                let mut facts = converted(path, console)?;
                if spectrum_csv::are_responses(&spectra) {
                    facts.insert(1, ("likely", json!("responses of bands, for `response` in `[sensor.bands]`")));
                }
                return Ok(facts);
            }
            (Err(error), Err(_)) => return Err(error),
        };
    let (first, last) = spectrum.coverage_um();
    let (min, max) = spectrum.range();
    Ok(vec![
        ("kind", json!("spectrum")),
        ("quantity", json!(quantity.name())),
        ("points", json!(spectrum.value().len())),
        ("first_um", json!(first)),
        ("last_um", json!(last)),
        ("unit", json!(if quantity == Quantity::Irradiance { "W m-2 um-1" } else { "1" })),
        ("min", json!(min)),
        ("max", json!(max)),
        ("notes", report.notes.iter().map(|note| json!(note.to_string())).collect()),
    ])
}

fn folder(path: &Path) -> Result<Facts> {
    if path.join("simulation.properties.txt").is_file() || path.join("output/simulation.properties.txt").is_file() {
        return dart_output(path);
    }
    if path.join("manifest.json").is_file() {
        return report(&path.join("manifest.json"));
    }
    let files = || -> Result<Value> {
        let files = product_folder::files(path)?;
        Ok(files.iter().map(|(name, bytes)| json!({ "file": name, "bytes": bytes })).collect())
    };
    for (summary, kind) in [("ortho.json", "orthorectified image"), ("errors.json", "geolocation errors")] {
        let summary = path.join(summary);
        if summary.is_file() {
            let said: Value = report_json::read(&summary)?;
            return Ok(vec![("kind", json!(kind)), ("files", files()?), ("says", said)]);
        }
    }
    if !path.join("report.json").is_file() {
        if output::is_within(path) {
            return dart_output(path);
        }
        let message =
            "is neither a product folder (no report.json) nor an output of DART (no simulation.properties.txt)";
        let problem = Problem::new(Location::file(path), message);
        let is_begun = ["products", "sights"].iter().any(|part| path.join(part).is_dir());
        return Err(Error::Invalid(vec![match is_begun {
            true => problem.with_help("of a campaign that is not finished: inspect a folder in products/"),
            false => problem.with_help("inspect a file in it"),
        }]));
    }
    let mut facts = vec![("kind", json!("product folder")), ("files", files()?)];
    facts.extend(report(&path.join("report.json"))?.into_iter().filter(|(name, _)| *name != "kind"));
    Ok(facts)
}

/// What a DART simulation computed.
fn dart_output(path: &Path) -> Result<Facts> {
    let output = output::open(path)?;
    let band = |b: &output::OutputBand| json!({ "band": b.number, "um": b.band.centre_um, "fwhm_um": b.band.fwhm_um });
    let views = output.views().iter().enumerate().map(|(i, view)| {
        let [zenith_deg, azimuth_deg] = view.towards_deg;
        json!({
            "view": i, "name": view.name, "quantity": view.quantity.name(), "iteration": view.iteration,
            "zenith_deg": zenith_deg, "azimuth_deg": azimuth_deg,
            "bands": view.bands.iter().map(|b| b.number).collect::<Vec<_>>(),
        })
    });
    let mut facts = vec![("kind", json!("DART output"))];
    facts.extend(output.of_type().map(|name| ("type_of_objects", json!(name))));
    facts.extend([
        ("views", views.collect()),
        ("bands", output.bands().into_iter().map(band).collect()),
        ("budget_of_triangles_bands", output.budget().iter().map(|b| json!(b.number)).collect()),
        ("passed_over", json!(output.passed_over())),
    ]);
    Ok(facts)
}

fn report(path: &Path) -> Result<Facts> {
    let value: Value = report_json::read(path)?;
    if value.get("wall_s").is_some() {
        let run: Run = report_json::read(path)?;
        return Ok(vec![
            ("kind", json!("run report")),
            ("mmxrt", json!(run.mmxrt)),
            ("command", json!(run.command)),
            ("date", json!(run.date)),
            ("threads", json!(run.threads)),
            ("host_cores", json!(run.host_cores)),
            ("wall_s", json!(run.wall_s)),
            ("stages", value["stages"].clone()),
        ]);
    }
    if let Some(Value::Array(oracles)) = value.get("oracles") {
        let mut groups: Vec<&str> = oracles.iter().filter_map(|o| o.get("group")?.as_str()).collect();
        groups.sort_unstable();
        groups.dedup();
        return Ok(vec![("kind", json!("oracles")), ("count", json!(oracles.len())), ("groups", json!(groups))]);
    }
    if value["format"] == manifest_json::FORMAT {
        let manifest: Manifest = report_json::read(path)?;
        return Ok(vec![
            ("kind", json!("campaign manifest")),
            ("mmxrt", json!(manifest.mmxrt)),
            ("acquisitions", json!(manifest.acquisitions.len())),
            ("failed", json!(manifest.failed())),
            ("coverage", value["coverage"].clone()),
        ]);
    }
    // Older versions have effects of another form.
    if value["format_version"].as_u64().is_none_or(|version| version >= u64::from(FORMAT_VERSION)) {
        // Of a cube that an instrument was put over there is no scene to tell of.
        match value.get("scene").or(value.get("image")) {
            Some(_) => _ = report_json::read::<ProductReport>(path)?,
            None => _ = report_json::read::<InstrumentReport>(path)?,
        }
    }
    let all = [
        "mmxrt",
        "scene",
        "inputs",
        "image",
        "plan",
        "counts",
        "effects",
        "surfaces",
        "checks",
        "signal",
        "defaults",
        "warnings",
        "statistics",
    ];
    let there = all.into_iter().filter(|name| value.get(name).is_some());
    Ok([("kind", json!("report"))].into_iter().chain(there.map(|name| (name, value[name].clone()))).collect())
}

fn arrays(path: &Path) -> Result<Facts> {
    let (header, arrays) = npz::list(path)?;
    let mut facts = vec![("kind", json!(header.as_ref().map_or("NumPy arrays", |h| h.format.as_str())))];
    if let Some(header) = &header {
        facts.push(("mmxrt", json!(header.mmxrt)));
        facts.push(("scene", json!(header.scene)));
    }
    let list = arrays.iter().map(|a| {
        let field = header.as_ref().and_then(|h| h.fields.get(&a.name));
        json!({
            "array": a.name, "type": a.descr, "shape": a.shape,
            "unit": field.map(|f| &f.unit), "meaning": field.map(|f| &f.meaning),
        })
    });
    facts.push(("arrays", list.collect()));
    Ok(facts)
}

/// What an image holds, band by band, and on request a picture of it.
fn image(path: &Path, format: &Format, arguments: &Arguments, console: &Console) -> Result<Facts> {
    let mut facts = match format.name {
        "envi" => {
            let header = envi::read_header(&envi::pair(path)?.0)?;
            vec![
                ("kind", json!(format.kind())),
                ("description", json!(header.field("description").unwrap_or(""))),
                ("interleave", json!(header.interleave.name())),
            ]
        }
        "exr" => {
            let attributes = exr_cube::read_info(path)?.attributes;
            let attributes = attributes.iter().map(|(name, text)| json!({ "name": name, "text": text }));
            vec![("kind", json!(format.kind())), ("attributes", attributes.collect())]
        }
        "npz" => {
            let facts = arrays(path)?;
            let is_ours = facts.iter().any(|(name, _)| *name == "scene");
            // Tables and footprints are not images, and other archives do not say which of their arrays is one.
            if arguments.picture.is_none() && (is_ours || registry::image(path).is_err()) {
                return Ok(facts);
            }
            facts
        }
        _ => vec![("kind", json!(format.kind()))],
    };
    let picture = arguments.picture.as_ref().map(|target| job::Picture {
        target: target.clone(),
        bands: arguments.band.iter().map(|band| *band as usize - 1).collect(),
        replace: arguments.force,
    });
    if let Some(picture) = &picture {
        super::settle(&picture.target, console)?;
    }
    let Survey { raster, bands } = job::survey(path, picture.as_ref(), &|progress| console.watch(progress))?;
    let pixels = raster.pixels() as u64;
    let statistics = bands.iter().zip(&raster.bands).map(|((label, about), band)| {
        json!({
            "band": label, "centre_um": band.centre_um, "fwhm_um": band.fwhm_um,
            "count": about.count, "no_data": pixels - about.count,
            "min": about.min, "max": about.max, "mean": about.mean,
        })
    });
    facts.extend([
        ("samples", json!(raster.columns)),
        ("lines", json!(raster.rows)),
        ("bands", json!(bands.len())),
        ("data_type", json!(raster.data_type.name())),
        ("data_units", json!(raster.unit)),
        ("no_data_value", json!(raster.ignore)),
        ("spacing_m", json!(raster.spacing_m())),
        ("extent_deg", json!(raster.extent_deg())),
        ("notes", raster.report.notes.iter().map(|note| json!(note.to_string())).collect()),
        ("statistics", statistics.collect()),
    ]);
    if let Some(picture) = &arguments.picture {
        facts.push(("picture", json!(picture)));
    }
    Ok(facts)
}
