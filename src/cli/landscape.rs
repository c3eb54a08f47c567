//! `mmxrt landscape`: a recipe becomes an OBJ file and its MTL.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::error::{Error, Location};
use mmxrt::formats::recipe_toml;
use mmxrt::job::LandscapeFiles;
use mmxrt::landscape::{FACETS, PRESETS, WrapReport};

use super::Outcome;
use super::console::Console;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The recipe: a file, or the name of a preset (see --list)
    #[arg(required_unless_present = "list")]
    recipe: Option<PathBuf>,
    /// The mesh to write: a name ending in .obj, or a folder for landscape.obj
    #[arg(long, short, value_name = "OUT", required_unless_present_any = ["list", "show"])]
    output: Option<PathBuf>,
    /// Number of facets, overriding the recipe
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(i64::from(*FACETS.start())..=i64::from(*FACETS.end())))]
    facets: Option<u32>,
    /// Seed, overriding the recipe
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX.unsigned_abs()))]
    seed: Option<u64>,
    /// Say which presets there are
    #[arg(long)]
    list: bool,
    /// Print the preset's recipe, to be saved and changed
    #[arg(long)]
    show: bool,
    /// Say what the wrap onto the body did: the target's height, curvature, distortion, seam
    #[arg(long)]
    report: bool,
    /// Replace existing files
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let name = arguments.recipe.as_deref();
    if arguments.list {
        for preset in PRESETS {
            let json = serde_json::json!({ "preset": preset.name, "about": preset.about });
            console.done(&format!("{:14}{}", preset.name, preset.about), &json);
        }
        return Ok(Outcome::Done);
    }
    if arguments.show {
        let found = PRESETS.iter().find(|preset| name.is_some_and(|name| name.as_os_str() == preset.name));
        let Some(preset) = found else {
            let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
            let message = format!("is not a preset; presets are {}", names.join(", "));
            return Err(Error::invalid(Location::file(name.unwrap_or(std::path::Path::new(""))), message));
        };
        console.done(preset.text.trim_end(), &serde_json::json!({ "preset": preset.name, "recipe": preset.text }));
        return Ok(Outcome::Done);
    }
    let (Some(name), Some(output)) = (name, &arguments.output) else { return Ok(Outcome::Done) };
    let files = LandscapeFiles::of(output)?;
    super::settle(&files.obj, console)?;
    let mut opened = recipe_toml::read(name)?;
    let recipe = &mut opened.recipe;
    recipe.facets = arguments.facets.unwrap_or(recipe.facets);
    recipe.seed = arguments.seed.unwrap_or(recipe.seed);
    let landscape = files.write(&opened, arguments.force, &|progress| console.watch(progress))?;
    let (path, facets) = (files.obj.display().to_string(), landscape.mesh.facets.len());
    let boulders = landscape.boulders.iter().filter(|b| b.facets.is_some()).count();
    let craters = landscape.craters.iter().filter(|c| c.shown).count();
    for doubt in opened.notes.iter().cloned().chain(landscape.doubts()) {
        console.note(&format!("warning: {doubt}"));
    }
    let mut json = serde_json::json!({
        "mesh": path,
        "materials": files.mtl.display().to_string(),
        "facets": facets,
        "craters": { "asked": landscape.craters.len(), "shown": craters },
        "boulders": { "asked": landscape.boulders.len(), "shown": boulders },
    });
    let of = |shown: usize, asked: usize, what: &str| match asked {
        0 => String::new(),
        _ if shown == asked => format!(", {asked} {what}"),
        _ => format!(", {shown} of {asked} {what} (the others are too small for it)"),
    };
    let things = of(craters, landscape.craters.len(), "craters") + &of(boulders, landscape.boulders.len(), "boulders");
    let mut text = format!("{path}: {facets} facets{things}");
    if let Some(wrap) = landscape.wrap.filter(|_| arguments.report || console.is_json()) {
        let (words, facts) = of_wrap(&wrap);
        text += &words;
        json["wrap"] = facts;
    }
    console.done(&text, &json);
    Ok(Outcome::Done)
}

/// What a wrap did, in words and as JSON.
fn of_wrap(wrap: &WrapReport) -> (String, serde_json::Value) {
    let [least, mean, most] = wrap.area;
    let [x_m, y_m] = wrap.curvature_m;
    let [lowest_m, highest_m] = wrap.below_m;
    let up = wrap.up.to_array();
    let words = format!(
        "
target: {:.4} m above the body's surface, {:.4} m above the smooth surface that the site lies on
upright: {:.9} {:.9} {:.9}
radius of curvature: {x_m:.1} m along x, {y_m:.1} m along y
area on the body over area on the map: {least:.6} to {most:.6}, mean {mean:.6}
tilt of the base: up to {:.3} deg; it lies {lowest_m:.3} to {highest_m:.3} m below the plane that touches it at the target
seam: the mesh's end is up to {:.3} m off the body; {:.0} % of the relief is left there",
        wrap.target_above_m, wrap.target_above_smooth_m, up[0], up[1], up[2], wrap.tilt_deg, wrap.seam_m, 100.0 * wrap.relief_at_end
    );
    let facts = serde_json::json!({
        "target_above_m": wrap.target_above_m,
        "target_above_smooth_m": wrap.target_above_smooth_m,
        "up": up,
        "curvature_m": wrap.curvature_m,
        "area": { "least": least, "mean": mean, "most": most },
        "tilt_deg": wrap.tilt_deg,
        "below_m": wrap.below_m,
        "seam_m": wrap.seam_m,
        "relief_at_end": wrap.relief_at_end,
    });
    (words, facts)
}
