//! Mars, as it was written beside a simulation: it is the scene's only where the simulation lit by it is still what it makes.

use std::path::Path;

use crate::error::Location;
use crate::report::Fate;
use crate::scene::Setup;

use super::super::diff::diff;
use super::super::folder::Folder;
use super::super::from_scene::lit_by_mars;
use super::super::read::{self, ReadOptions};
use super::super::sidecar::{FILE, Sidecar};
use super::super::simulation::Simulation;
use super::{SceneBuilder, SceneFrame};

/// The folder, in that of a simulation, of the one that is lit by Mars.
pub(in crate::formats) const FOLDER: &str = "mars";
/// At most this many differences are reported.
const TOLD: usize = 3;

/// Whether a Mars was written beside a simulation.
pub(in crate::formats) fn has_mars(folder: &Folder) -> bool {
    Sidecar::read(&folder.simulation.join(FILE))
        .is_ok_and(|read| read.is_some_and(|(sidecar, _)| sidecar.mars().is_some()))
}

impl SceneBuilder<'_> {
    /// The scene with Mars, if there is one. A simulation in `mars/` that was edited, or is gone, wins.
    pub(super) fn with_mars(&mut self, mut scene: Setup, place: &SceneFrame) -> Setup {
        let item = Location::item("mars");
        let path = self.folder.simulation.join(FOLDER);
        let is_there = path.join("input").is_dir();
        let Some(mars) = self.sidecar.as_ref().and_then(Sidecar::mars) else {
            if is_there {
                let message = format!(
                    "no {FILE} has a Mars that can be used: the simulation in {FOLDER}/ and its light are not read"
                );
                self.note(Fate::Dropped, &item, message);
            }
            return scene;
        };
        if !place.is_kept {
            self.note(Fate::Dropped, &item, "the scene is elsewhere than where Mars was given for it");
            return scene;
        }
        scene.sky.mars = Some(mars);
        scene.models.mars_light =
            self.sidecar.as_ref().map_or(scene.models.mars_light, |sidecar| sidecar.models().mars_light);
        let expected = lit_by_mars(&scene, place.dart_from_body, self.simulation);
        let why = match (expected, is_there) {
            (None, false) => return scene,
            (None, true) => {
                let message = format!(
                    "Mars is below the site's horizon, or dark: what the simulation in {FOLDER}/ holds is not read"
                );
                self.note(Fate::Dropped, &item, message);
                return scene;
            }
            (Some(_), false) => format!("{FOLDER}/ is not there"),
            (Some(expected), true) => match self.edited(expected, &path) {
                None => return scene,
                Some(why) => format!("{FOLDER}/ is not what Mars makes of this simulation ({why})"),
            },
        };
        let message = format!(
            "{why}: the scene has no Mars. To have it, convert the scene to DART again, or write `[mars]` of {FILE} into the scene file"
        );
        self.note(Fate::Dropped, &item, message);
        scene.sky.mars = None;
        scene
    }

    /// What differs between a simulation and the one that lies at `path`, with the files that both name; `None` if nothing does.
    fn edited(&mut self, mut expected: Simulation, path: &Path) -> Option<String> {
        let Folder { database, allow_outside, .. } = self.folder;
        let options = ReadOptions { database: database.clone(), allow_outside: *allow_outside, sun_deg: None };
        let (found, _, inputs) = match read::read(path, &options) {
            Ok(read) => read,
            Err(error) => return Some(format!("it cannot be read: {error}")),
        };
        self.inputs.extend(inputs);
        // Those of the other simulation alone.
        expected.sequences.clone_from(&found.sequences);
        let mut lines = diff(&expected, &found);
        let of_mars = options.folder(path);
        let objects = expected.objects.iter().map(|object| (&object.file, &object.at));
        let databases = expected.optical.iter().map(|property| (&property.database, &property.at));
        let mut names: Vec<(&String, &Location)> =
            objects.chain(databases).filter(|(name, _)| !name.is_empty()).collect();
        names.sort_by(|a, b| a.0.cmp(b.0));
        names.dedup_by(|a, b| a.0 == b.0);
        for (name, at) in names {
            let bytes = |folder: &Folder| std::fs::read(folder.locate(name, at).ok()??).ok();
            if bytes(self.folder) != bytes(&of_mars) {
                lines.push(format!("{name} is another file there"));
            }
        }
        let more = lines.len().saturating_sub(TOLD);
        lines.truncate(TOLD);
        let told = lines.join("; ");
        match more {
            _ if told.is_empty() => None,
            0 => Some(told),
            more => Some(format!("{told}; and {more} more differences")),
        }
    }
}
