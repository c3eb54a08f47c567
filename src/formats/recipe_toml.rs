//! A landscape's recipe: a file of its own, part of a scene, or one of those that come with the program.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::coloured_mesh::Placing;
use super::located::Document;
use super::raster::{DataType, metres};
use super::{InputFile, registry};
use crate::error::{Error, Location, Problem, Result};
use crate::geometry::repair::join_equal;
use crate::landscape::{self, Landscape, PRESETS, Recipe, RecipeOne, Source, Sources};
use crate::progress::Watch;
use crate::report::Fate;

/// A recipe of any version.
#[derive(Debug, Clone, JsonSchema)]
#[schemars(untagged)]
pub enum AnyRecipe {
    /// Version 2.
    Two(Box<Recipe>),
    /// Version 1.
    One(Box<RecipeOne>),
}

impl<'de> Deserialize<'de> for AnyRecipe {
    /// By its version: much of what one version says the other would take, and mean something else.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let value = serde_json::Value::deserialize(deserializer)?;
        let any = match value["version"].as_u64() {
            Some(1) => serde_json::from_value(value).map(AnyRecipe::One),
            _ => serde_json::from_value(value).map(AnyRecipe::Two),
        };
        any.map_err(D::Error::custom)
    }
}

impl AnyRecipe {
    /// The recipe, of the version that is made today.
    pub fn recipe(&self) -> Recipe {
        match self {
            AnyRecipe::Two(recipe) => (**recipe).clone(),
            AnyRecipe::One(one) => (**one).clone().into(),
        }
    }
}

/// A recipe with the rasters that it names.
#[derive(Debug, Clone)]
pub struct OpenedRecipe {
    /// The recipe; may be changed before it is made.
    pub recipe: Recipe,
    /// The files that it was read from: its own, and those of its rasters.
    pub inputs: Vec<InputFile>,
    /// What of its files was not taken as it is, or is probably not meant.
    pub notes: Vec<String>,
    sources: Sources,
    document: Document,
    item: String,
}

/// Reads and checks a recipe: a file, or the name of one of [`PRESETS`].
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`]; [`Error::Invalid`] with everything that is unknown, missing or out of range, each at
/// its place, in the recipe or in the rasters that it names.
pub fn read(path: &Path) -> Result<OpenedRecipe> {
    if let Some(preset) = preset(path) {
        let document = Document::parse(preset.text.to_owned(), Path::new(preset.name))?;
        return OpenedRecipe::new(&document.read::<AnyRecipe>()?, document, "", Path::new("."), Vec::new());
    }
    let (document, input) = Document::open(path).map_err(|e| known_presets(e, path))?;
    let recipe: AnyRecipe = document.read()?;
    let folder = path.parent().unwrap_or(Path::new(""));
    OpenedRecipe::new(&recipe, document, "", folder, vec![input])
}

/// The JSON Schema of a recipe.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(AnyRecipe)
}

/// The preset of this name, if there is no file of this name; a folder may have it.
fn preset(path: &Path) -> Option<&'static landscape::Preset> {
    let name = path.to_str()?;
    PRESETS.iter().find(|preset| preset.name == name).filter(|_| !path.is_file())
}

/// `name` if it is that of a preset, or else `path`.
pub(super) fn preset_or<'a>(name: &'a Path, path: &'a Path) -> &'a Path {
    if PRESETS.iter().any(|preset| Path::new(preset.name) == name) { name } else { path }
}

/// What is said of a name that is neither a file nor a preset.
fn known_presets(error: Error, path: &Path) -> Error {
    if path.exists() || path.extension().is_some() || path.components().count() != 1 {
        return error;
    }
    let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    let problem = Problem::new(Location::file(path), "is neither a file nor a preset");
    let help = match super::spelling::nearest(&path.to_string_lossy(), &names) {
        Some(name) => format!("did you mean {name:?}?"),
        None => format!("presets: {}", names.join(", ")),
    };
    Error::Invalid(vec![problem.with_help(help)])
}

impl OpenedRecipe {
    /// Of a recipe that is `item` of a text, or all of it (""); its rasters are found from `folder`.
    pub(super) fn new(
        any: &AnyRecipe,
        document: Document,
        item: &str,
        folder: &Path,
        mut inputs: Vec<InputFile>,
    ) -> Result<Self> {
        let mut opened = OpenedRecipe {
            recipe: any.recipe(),
            inputs: Vec::new(),
            notes: Vec::new(),
            sources: Sources::default(),
            document,
            item: item.to_owned(),
        };
        let mut problems = opened.recipe.check();
        for (key, name) in opened.recipe.files() {
            if opened.sources.rasters.contains_key(name) {
                continue;
            }
            match source(&folder.join(name)) {
                Ok((source, files, notes)) => {
                    inputs.extend(files);
                    opened.notes.extend(notes.into_iter().map(|note| format!("{key}: {name}: {note}")));
                    opened.sources.rasters.insert(name.to_owned(), source);
                }
                Err(Error::Invalid(found)) => problems.extend(found),
                Err(error) => problems.push(Problem::new(Location::item(format!("recipe.{key}")), error.to_string())),
            }
        }
        let unit_m = opened.recipe.body.as_ref().and_then(|body| body.unit_m);
        for (key, name) in opened.recipe.meshes() {
            match registry::mesh(&folder.join(name), true) {
                Ok(file) => {
                    inputs.extend(file.inputs);
                    opened.notes.extend(file.doubts.iter().map(|note| format!("{key}: {}: {}", note.at, note.message)));
                    let mut surface =
                        file.surface.placed(&Placing { unit_m, ..Placing::default() }, (file.up, file.unit_m));
                    // What flat shading and seams of textures have split would be creases of the smooth surface.
                    join_equal(&mut surface.mesh);
                    opened.sources.meshes.insert(name.to_owned(), surface.mesh);
                }
                Err(Error::Invalid(found)) => problems.extend(found),
                Err(error) => problems.push(Problem::new(Location::item(format!("recipe.{key}")), error.to_string())),
            }
        }
        if !problems.is_empty() {
            return Err(opened.placed(Error::Invalid(problems)));
        }
        opened.inputs = inputs;
        Ok(opened)
    }

    /// Makes the landscape.
    ///
    /// # Errors
    /// Those of [`landscape::generate`], each at its place in the text.
    pub fn generate(&self, watch: Watch<'_>) -> Result<Landscape> {
        landscape::generate(&self.recipe, &self.sources, watch).map_err(|error| self.placed(error))
    }

    /// The paths of its inputs.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.inputs.iter().map(|input| input.path.clone()).collect()
    }

    /// Problems of items of a recipe, with their places in the text.
    fn placed(&self, error: Error) -> Error {
        let Error::Invalid(problems) = error else { return error };
        let placed = problems.into_iter().map(|problem| {
            let Some(key) = problem.at.item.as_deref().and_then(|item| item.strip_prefix("recipe.")) else {
                return problem;
            };
            let dot = if self.item.is_empty() || key.is_empty() { "" } else { "." };
            let full = format!("{}{dot}{key}", self.item);
            // Recipes of version 1 have one table where those of version 2 have a list.
            let single = full.replacen("[0]", "", 1);
            let at = if self.document.has(&single) && !self.document.has(&full) { single } else { full };
            Problem { at: self.document.at(&at), ..problem }
        });
        Error::Invalid(placed.collect())
    }
}

/// The first band of a raster, or the mean of a picture's three colours; heights that are in another unit in m.
fn source(path: &Path) -> Result<(Source, Vec<InputFile>, Vec<String>)> {
    let mut raster = registry::image(path)?;
    raster.is_upright()?;
    let mut notes = Vec::new();
    // Bands of what is no picture may be of different quantities.
    let bands = match raster.colour_bands() {
        colours if colours.len() == 3 && raster.full_scale.is_some() => colours,
        _ => vec![0],
    };
    if bands.len() == 1 && raster.bands.len() > 1 {
        notes.push(format!("the first of its {} bands is taken", raster.bands.len()));
    }
    let unit_m = raster.unit.as_deref().filter(|unit| !unit.trim().is_empty()).map(|unit| (unit, metres(unit)));
    match unit_m {
        Some((unit, Some(unit_m))) if unit_m != 1.0 => notes.push(format!("its numbers are in {unit}: made m")),
        Some((unit, None)) => {
            notes.push(format!("its unit, {unit:?}, is not known as one of length: its numbers are taken as m"))
        }
        _ => {}
    }
    let unit_m = unit_m.and_then(|(_, unit_m)| unit_m).unwrap_or(1.0);
    let (mut values, mut band) = (vec![0.0; raster.pixels()], Vec::new());
    // Of a picture as the counts that it stores: heights are counts of something.
    let counts = raster.full_scale.unwrap_or(1.0) * unit_m / bands.len() as f64;
    for &number in &bands {
        raster.read(number, &mut band)?;
        values.iter_mut().zip(&band).for_each(|(sum, value)| *sum += value * counts);
    }
    let full_scale = raster.full_scale.or(match raster.data_type {
        DataType::U8 => Some(255.0),
        DataType::U16 => Some(65535.0),
        _ => None,
    });
    let full_scale = full_scale.map(|most| most * unit_m);
    let pixel_m = raster.spacing_m();
    let pixel_deg = raster.pixel_deg();
    let source = Source { columns: raster.columns, rows: raster.rows, values, pixel_m, pixel_deg, full_scale };
    // Some of it is known only now that the numbers have been read.
    let told = raster.report.notes.iter().filter(|note| note.fate != Fate::Carried);
    notes.extend(told.map(|note| note.message.clone()));
    Ok((source, raster.inputs()?, notes))
}
