//! The subject of a product: a scene, and what to report about its source.

use std::path::Path;

use super::scene_toml::{self, SceneFile, Stated};
use super::{InputFile, Reading, npz};
use crate::error::{Error, Location, Problem, Result};
use crate::instrument::Chain;
use crate::product::FacetTable;
use crate::progress::Watch;
use crate::scene::{Motion, Readout, Scene, Thermal, Timing};
use crate::study;

/// A scene, and what its products report about its source.
///
/// One of a file follows from [`open`](Subject::open); code that makes or changes a scene states what there is to report.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The scene.
    pub scene: Scene,
    /// How it moves, and when what of its image is taken; none if it does not.
    pub motion: Option<(Motion, Timing)>,
    /// What the instrument makes of the radiance before it; none: the cube is that radiance.
    pub chain: Option<Chain>,
    /// Its name in products: of what was read, a hash of all of it.
    pub id: String,
    /// Every file that it depends on: the scene file first.
    pub inputs: Vec<InputFile>,
    /// What of the scene file was replaced, as it was said.
    pub settings: Vec<String>,
    /// What the input left to this program, and what was taken.
    pub defaults: Vec<Stated>,
    /// What a reader of its products should know.
    pub warnings: Vec<String>,
}

impl From<SceneFile> for Subject {
    fn from(file: SceneFile) -> Self {
        let id = scene_toml::id(&file.inputs, &file.settings);
        let (motion, chain) = (file.motion, file.chain);
        Subject {
            scene: file.scene,
            motion,
            chain,
            id,
            inputs: file.inputs,
            settings: file.settings,
            defaults: file.defaults,
            warnings: file.notes,
        }
    }
}

impl Subject {
    /// What of an image is taken at once.
    pub fn readout(&self) -> Readout {
        self.motion.as_ref().map_or(Readout::Frame, |(_, timing)| timing.readout)
    }

    /// Reads a scene file and all that it names, to simulate it.
    ///
    /// # Errors
    /// Those of [`scene_toml::read`] and of [`SceneFile::simulable`].
    pub fn open(path: &Path, watch: Watch<'_>) -> Result<Self> {
        Self::open_with(path, &Reading::default(), watch)
    }

    /// The same, with items of the file replaced, or from a cache.
    ///
    /// # Errors
    /// As [`open`](Subject::open), and those of [`scene_toml::read_with`].
    pub fn open_with(path: &Path, reading: &Reading, watch: Watch<'_>) -> Result<Self> {
        let file = scene_toml::read_with(path, reading, watch)?;
        file.simulable()?;
        Ok(file.into())
    }

    /// When it is taken, as a number that tells occasions apart; 0 of a scene without time.
    pub fn occasion(&self) -> u64 {
        self.motion.as_ref().map_or(0, |(motion, _)| motion.start.tdb_s().to_bits())
    }

    /// Of a scene that is taken in parts, of which of them something that knows one moment alone is.
    pub fn one_moment(&self) -> Option<String> {
        let (_, timing) = self.motion.as_ref()?;
        let (count, reference) = (timing.count(&self.scene.exposure), timing.reference(&self.scene.exposure));
        (count > 1).then(|| {
            let middle_s = timing.middle_s(reference);
            format!("the scene moves, and is taken in {count} parts: this is of the middle of part {}, {middle_s} s after the start", reference + 1)
        })
    }

    /// Reads a table of the facets of this scene, which from then on is by the models that the table was solved by.
    ///
    /// # Errors
    /// Those of [`npz::read_table`]; [`Error::Invalid`] for a table of another scene.
    pub fn read_table(&mut self, path: &Path) -> Result<FacetTable> {
        let (mut table, header) = npz::read_table(path)?;
        let file = self.inputs.first().map_or("SCENE".into(), |input| input.path.display().to_string());
        let help = format!("solve it again: mmxrt solve {file} -o TABLE.npz");
        match header.models {
            Some(models) => {
                let stated = self.scene.models;
                // Which effects there are is a choice; how cold the ground gets is not.
                if models.thermal == Thermal::Equilibrium && models.floor_k != stated.floor_k {
                    let floor =
                        |floor_k: f64| if floor_k > 0.0 { format!("{floor_k} K") } else { "no floor".to_owned() };
                    let message = format!(
                        "was solved with another `thermal.floor_k`: {}, and the scene has {}",
                        floor(models.floor_k),
                        floor(stated.floor_k)
                    );
                    return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
                }
                let others = models.against(&stated);
                if !others.is_empty() {
                    let keys: Vec<String> = others.iter().map(|key| format!("`{key}`")).collect();
                    self.warnings.push(format!(
                        "{} was solved otherwise than the scene states by {}: what the table says counts; {help}",
                        path.display(),
                        keys.join(", ")
                    ));
                }
                self.scene = self.scene.by(models)?;
            }
            None => table.models = self.scene.models,
        }
        if header.scene == study::table_id(&self.scene) {
            return Ok(table);
        }
        let problem = Problem::new(
            Location::file(path),
            "was solved for another scene: another mesh, origin, Sun, Mars or heat (camera, bands and spectra may differ, but not what follows \
             from them: a total of the Sun, and Bond albedos)",
        );
        let follow: Vec<&str> = self.left_open(&[".bond_albedo"]).take(8).map(|stated| stated.item.as_str()).collect();
        let follow = match follow.is_empty() {
            true => String::new(),
            false => format!(
                "; not given, and so of the reflectance: {} (a table outlives its change if they are)",
                follow.join(", ")
            ),
        };
        Err(Error::Invalid(vec![problem.with_help(help + &follow)]))
    }

    /// Values of the heat balance that the input leaves open, if temperatures depend on them.
    pub fn defaults_of_heat(&self) -> Vec<&Stated> {
        if self.scene.models.thermal != Thermal::Equilibrium {
            return vec![];
        }
        self.left_open(&[".bond_albedo", ".emissivity_bolometric"]).collect()
    }

    fn left_open(&self, endings: &'static [&'static str]) -> impl Iterator<Item = &Stated> {
        self.defaults.iter().filter(|stated| endings.iter().any(|ending| stated.item.ends_with(ending)))
    }
}
