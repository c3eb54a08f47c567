//! `mmxrt convert`: one format becomes another, and losses are reported.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::formats::convert::{self, Content, Conversion, Finding, Options, Repairs, Severity};
use mmxrt::formats::mesh_file::{NamedPose, Up};
use mmxrt::formats::raster::DataType;
use mmxrt::formats::{Format, registry};
use mmxrt::report::{Note, Report};
use mmxrt::spectral::Band;
use serde_json::{Value, json};

use super::console::Console;
use super::{Outcome, file_json};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// What to convert: a scene, mesh, DART simulation, spectra, image, trajectory or orientation; recognised by its content
    #[arg(required_unless_present = "list")]
    input: Option<PathBuf>,
    /// What to write; the file extension selects the format, no extension means a DART simulation. With --diff, what to compare with
    #[arg(required_unless_present_any = ["list", "check"])]
    output: Option<PathBuf>,
    /// List the formats, or the spectra in a file
    #[arg(long, conflicts_with_all = ["output", "check", "diff"])]
    list: bool,
    /// Check a DART simulation or optical database for mistakes, and write nothing; exit code 1 if there are errors
    #[arg(long, conflicts_with_all = ["output", "diff"])]
    check: bool,
    /// List how two files or folders differ in meaning, and write nothing; exit code 1 if they do
    #[arg(long)]
    diff: bool,
    /// Format of the input
    #[arg(long, value_name = "FORMAT", value_parser = format)]
    from: Option<&'static Format>,
    /// Format of the output
    #[arg(long, value_name = "FORMAT", value_parser = format)]
    to: Option<&'static Format>,
    /// Version of DART to write for
    #[arg(long, value_name = "VERSION", value_parser = ["5.7.4", "5.11.0"], default_value = "5.7.4")]
    dart_version: String,
    /// Size of DART's cells, m; by default the footprint of a camera pixel
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    cell_m: Option<f64>,
    /// Folder with DART's databases, for those that are not in the simulation's own folder
    #[arg(long, value_name = "FOLDER")]
    databases: Option<PathBuf>,
    /// Body-fixed position of the middle of a DART scene, or of the origin of a mesh, m
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    origin_m: Option<Numbers<3>>,
    /// Unit of length of a mesh, m: 1000 for km; by default 1
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    unit_m: Option<f64>,
    /// Axis of a mesh that points up; by default z for OBJ and y for glTF
    #[arg(long, value_name = "AXIS", value_parser = up)]
    up: Option<Up>,
    /// How a mesh stands on the body: "body", with its z to the north, or "radial", with x east, y north and z up at --origin-m; by default "body"
    #[arg(long, value_name = "POSE", value_parser = pose)]
    pose: Option<NamedPose>,
    /// Flip all facets of a mesh that is inside out
    #[arg(long)]
    flip: bool,
    /// Make one vertex of a mesh's vertices at one place, or that are no farther apart than this, m
    #[arg(long, value_name = "M", num_args = 0..=1, require_equals = true, value_parser = distance)]
    weld: Option<Option<f64>>,
    /// Cut facets of a mesh at corners of others that lie on their edges
    #[arg(long)]
    t_junctions: bool,
    /// Make facets of a mesh's bodies face outwards, and those of open ground as most of them do
    #[arg(long)]
    outward: bool,
    /// Leave at most so many facets of a mesh; how far that is off is measured and reported
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    decimate: Option<u32>,
    /// Take N more copies of a repeated DART scene on each side: (2 N + 1)^2 scenes
    #[arg(long, value_name = "N", default_value_t = 0)]
    repeat: u32,
    /// Direction of the Sun in DART's frame, deg, for simulations that give only a date
    #[arg(long, value_name = "ZENITH,AZIMUTH", value_parser = numbers::<2>, allow_hyphen_values = true)]
    sun_deg: Option<Numbers<2>>,
    /// Blender's program, which reads .blend files; by default `blender` on the path
    #[arg(long, value_name = "PATH")]
    blender: Option<PathBuf>,
    /// Write nothing if anything is dropped or approximated: exit code 3
    #[arg(long)]
    strict: bool,
    /// Also read files named by the input that lie outside its folder
    #[arg(long)]
    allow_outside: bool,
    /// Take only this spectrum; may be given several times
    #[arg(long, value_name = "NAME")]
    model: Vec<String>,
    /// The wavelengths for a text file of values alone, such as those of the US Geological Survey
    #[arg(long, value_name = "FILE")]
    wavelengths: Option<PathBuf>,
    /// Bands to resample spectra to, um: FIRST:LAST:COUNT or FIRST:LAST:COUNT:WIDTH
    #[arg(long, value_name = "BANDS", value_parser = bands)]
    bands: Option<Bands>,
    /// Take only this band of an image, counted from 1; may be given several times
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    band: Vec<u32>,
    /// Data type of an image in ENVI and NumPy; by default that of the input
    #[arg(long, value_name = "TYPE", value_parser = data_type)]
    dtype: Option<DataType>,
    /// Write trajectories and orientations at rows so many seconds apart; by default at those of the input
    #[arg(long, value_name = "S")]
    step_s: Option<f64>,
    /// Replace what exists
    #[arg(long)]
    force: bool,
    /// Add the spectra to an existing database
    #[arg(long, conflicts_with = "force")]
    append: bool,
}

fn format(name: &str) -> std::result::Result<&'static Format, String> {
    let names: Vec<&str> = registry::ALL.iter().map(|format| format.name).collect();
    registry::named(name).ok_or_else(|| format!("formats are {}", names.join(", ")))
}

fn up(name: &str) -> std::result::Result<Up, String> {
    match name {
        "y" => Ok(Up::Y),
        "z" => Ok(Up::Z),
        _ => Err("axes are y, z".into()),
    }
}

fn pose(name: &str) -> std::result::Result<NamedPose, String> {
    match name {
        "body" => Ok(NamedPose::Body),
        "radial" => Ok(NamedPose::Radial),
        _ => Err("poses are body, radial".into()),
    }
}

fn data_type(name: &str) -> std::result::Result<DataType, String> {
    let found = DataType::ALL.into_iter().find(|data_type| data_type.name() == name);
    found.ok_or_else(|| format!("types are {}", DataType::ALL.map(DataType::name).join(", ")))
}

/// Numbers separated by commas.
#[derive(Debug, Clone, Copy)]
struct Numbers<const N: usize>([f64; N]);

fn numbers<const N: usize>(text: &str) -> std::result::Result<Numbers<N>, String> {
    let all: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let numbers = all.and_then(|all| <[f64; N]>::try_from(all).ok()).filter(|all| all.iter().all(|x| x.is_finite()));
    numbers.map(Numbers).ok_or_else(|| format!("expected {N} numbers separated by commas"))
}

/// Evenly spaced bands.
#[derive(Debug, Clone)]
struct Bands(Vec<Band>);

fn bands(text: &str) -> std::result::Result<Bands, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let number = |text: &str| text.parse::<f64>().ok().filter(|x| *x > 0.0 && x.is_finite());
    let wanted = "FIRST:LAST:COUNT or FIRST:LAST:COUNT:WIDTH, e.g. 0.95:3.6:300:0.01";
    let (first, last, count, width) = match parts[..] {
        [first, last, count] => (first, last, count, None),
        [first, last, count, width] => (first, last, count, Some(width)),
        _ => return Err(wanted.into()),
    };
    let count = count.parse::<u32>().ok().filter(|count| (1..=100_000).contains(count));
    let (Some(first), Some(last), Some(count)) = (number(first), number(last), count) else {
        return Err(wanted.into());
    };
    if last < first || (count == 1) != (last == first) {
        return Err("one band has one centre, and several must ascend".into());
    }
    let fwhm_um = match width {
        Some(width) => Some(number(width).ok_or(wanted)?),
        None => None,
    };
    let step = (last - first) / f64::from(count.max(2) - 1);
    let centre_um = |i: u32| if i + 1 == count { last } else { first + step * f64::from(i) };
    Ok(Bands((0..count).map(|i| Band::new(centre_um(i), fwhm_um)).collect()))
}

fn distance(text: &str) -> std::result::Result<f64, String> {
    let metres = text.parse().map_err(|_| "a number of metres".to_owned())?;
    if metres > 0.0 && f64::is_finite(metres) { Ok(metres) } else { Err("a distance above 0".into()) }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let options = Options {
        from: arguments.from,
        to: arguments.to,
        dart_version: Some(arguments.dart_version.clone()),
        cell_m: arguments.cell_m,
        dart_databases: arguments.databases.clone(),
        origin_m: arguments.origin_m.map(|numbers| numbers.0.into()),
        unit_m: arguments.unit_m,
        up: arguments.up,
        pose: arguments.pose,
        flip: arguments.flip,
        repairs: Repairs {
            weld: arguments.weld,
            t_junctions: arguments.t_junctions,
            outward: arguments.outward,
            decimate: arguments.decimate.map(|facets| facets as usize),
        },
        repeat: arguments.repeat,
        blender: arguments.blender.clone(),
        scratch: Some(std::env::temp_dir()),
        sun_deg: arguments.sun_deg.map(|numbers| numbers.0),
        allow_outside: arguments.allow_outside,
        replace: arguments.force,
        append: arguments.append,
        strict: arguments.strict,
        models: arguments.model.clone(),
        wavelengths: arguments.wavelengths.clone(),
        image_bands: arguments.band.iter().map(|band| *band as usize - 1).collect(),
        step_s: arguments.step_s,
        data_type: arguments.dtype,
        bands: arguments.bands.clone().map(|bands| bands.0).unwrap_or_default(),
    };
    let watch = |progress| console.watch(progress);
    match (&arguments.input, &arguments.output) {
        (Some(input), _) if arguments.list => {
            let (_, content, report) = convert::read(input, &options, &watch)?;
            list_content(&content, &report, console)
        }
        (Some(input), _) if arguments.check => {
            let findings = convert::check(input, &options)?;
            let is_error = |finding: &Finding| finding.severity == Severity::Error;
            let errors = findings.iter().filter(|finding| is_error(finding)).count();
            let lines: String = findings.iter().map(|finding| format!("{finding}\n")).collect();
            let text = format!("{lines}{}: {errors} errors, {} warnings", input.display(), findings.len() - errors);
            let shown = |f: &Finding| {
                json!({
                    "error": is_error(f), "file": file_json(f.at.file.as_ref()), "line": f.at.line, "column": f.at.column, "item": f.at.item,
                    "what": f.what, "effect": f.effect, "fix": f.fix,
                })
            };
            let shown: Vec<Value> = findings.iter().map(shown).collect();
            console.result(&text, &json!({ "errors": errors, "findings": shown }))?;
            Ok(if errors == 0 { Outcome::Done } else { Outcome::Failed })
        }
        (Some(a), Some(b)) if arguments.diff => {
            let lines = convert::diff(a, b, &options, &watch)?;
            let text = if lines.is_empty() { "the same in meaning".to_owned() } else { lines.join("\n") };
            console.result(&text, &json!({ "differences": lines }))?;
            Ok(if lines.is_empty() { Outcome::Done } else { Outcome::Failed })
        }
        (Some(input), Some(output)) => {
            super::settle(output, console)?;
            super::settle_input(input, console)?;
            let conversion = convert::convert(input, output, &options, &watch)?;
            let path = output.display().to_string();
            console.done(&text(&conversion, &path), &json(&conversion, &path));
            Ok(if conversion.written { Outcome::Done } else { Outcome::Lost })
        }
        _ => list_formats(console),
    }
}

fn text(conversion: &Conversion, path: &str) -> String {
    let notes: String = conversion.report.notes.iter().map(|note| format!("{note}\n")).collect();
    let (from, to) = (conversion.from.name, conversion.to.name);
    let size = &conversion.size;
    if conversion.written {
        format!("{notes}{path}: {size}, {from} to {to}")
    } else {
        format!("{notes}{path}: not written, because something would be lost (--strict)")
    }
}

fn json(conversion: &Conversion, path: &str) -> Value {
    json!({
        "output": path,
        "written": conversion.written,
        "from": conversion.from.name,
        "to": conversion.to.name,
        "size": conversion.size,
        "notes": notes(&conversion.report),
    })
}

fn notes(report: &Report) -> Vec<Value> {
    let note = |note: &Note| {
        json!({
            "fate": note.fate.to_string(), "file": file_json(note.at.file.as_ref()), "line": note.at.line,
            "column": note.at.column, "item": note.at.item, "message": note.message,
        })
    };
    report.notes.iter().map(note).collect()
}

fn list_formats(console: &Console) -> Result<Outcome> {
    let row = |format: &&Format| {
        let endings: Vec<String> = format.extensions.iter().map(|e| format!(".{e}")).collect();
        let writes = if format.writes.is_empty() { "nothing" } else { format.writes };
        format!("{:10} {:6} reads {}; writes {writes}\n", format.name, endings.join(" "), format.reads)
    };
    let shown: Vec<Value> = registry::ALL
        .iter()
        .map(|a| json!({ "name": a.name, "extensions": a.extensions, "reads": a.reads, "writes": a.writes }))
        .collect();
    console.result(&registry::ALL.iter().map(row).collect::<String>(), &json!({ "formats": shown }))?;
    Ok(Outcome::Done)
}

/// The spectra of a file; of anything else, its size.
fn list_content(content: &Content, report: &Report, console: &Console) -> Result<Outcome> {
    let Content::Spectra(libraries) = content else {
        let size = content.size();
        console.result(&size, &json!({ "size": size, "notes": notes(report) }))?;
        return Ok(Outcome::Done);
    };
    let mut text = String::new();
    let mut shown = Vec::new();
    for library in libraries {
        let columns: Vec<&str> = library.columns.iter().map(|column| column.name.as_str()).collect();
        let (first, last) = library.coverage_um().unwrap_or_default();
        let (name, points) = (&library.name, library.wavelength_um.len());
        text += &format!("{name}: {} at {points} wavelengths, {first} to {last} um\n", columns.join(", "));
        shown.push(json!({
            "name": name, "comment": library.comment, "columns": columns, "points": points, "first_um": first, "last_um": last,
        }));
    }
    text.extend(report.notes.iter().map(|note| format!("{note}\n")));
    console.result(&text, &json!({ "spectra": shown, "notes": notes(report) }))?;
    Ok(Outcome::Done)
}
