//! A scene file of which many acquisitions are made: its surface and materials are read once, and what is flown, pointed and looked with may change.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::types::{FlightToml, PointingToml, SceneToml, SensorToml};
use super::{Moments, SceneFile, Stated, TomlReader, at_reference, read_for};
use crate::error::{Error, Location, Problem, Result};
use crate::flight::{Aim, Pointing};
use crate::formats::located::Document;
use crate::formats::{InputFile, Reading};
use crate::instrument::Chain;
use crate::progress::{Watch, unwatched};
use crate::scene::{Exposure, Motion, Readout, STEPS_OF_A_DAY, Scene, Timing};

/// A scene file with a table `flight`.
#[derive(Debug)]
pub(in crate::formats) struct Template {
    /// What it says as it stands.
    pub(in crate::formats) file: SceneFile,
    toml: SceneToml,
    path: PathBuf,
}

/// What an entry of a campaign says otherwise than the scene.
#[derive(Debug, Clone, Copy)]
pub(in crate::formats) struct Changes<'a> {
    pub(in crate::formats) files: Option<&'a [String]>,
    pub(in crate::formats) spacecraft: Option<&'a str>,
    pub(in crate::formats) orbit: Option<&'a str>,
    pub(in crate::formats) orbit_epoch: Option<&'a str>,
    pub(in crate::formats) pointing: Option<&'a PointingToml>,
    pub(in crate::formats) sensor: Option<&'a SensorToml>,
}

/// How a scene is flown and looked at.
#[derive(Debug, Clone)]
pub(in crate::formats) struct Variant {
    pub(in crate::formats) motion: Motion,
    pub(in crate::formats) timing: Timing,
    pub(in crate::formats) chain: Option<Chain>,
    /// With the camera anywhere.
    pub(in crate::formats) exposure: Exposure,
    pub(in crate::formats) inputs: Vec<InputFile>,
    pub(in crate::formats) defaults: Vec<Stated>,
    pub(in crate::formats) notes: Vec<String>,
}

impl Template {
    /// Reads a scene that is looked at at other moments too.
    ///
    /// # Errors
    /// Those of [`read`](super::read) and of [`SceneFile::simulable`]; [`Error::Invalid`] for a scene that does not move.
    pub(in crate::formats) fn open(
        path: &Path,
        reading: &Reading,
        moments: Option<Moments<'_>>,
        watch: Watch<'_>,
    ) -> Result<Self> {
        let (file, toml) = read_for(path, reading, moments, watch)?;
        file.simulable()?;
        if file.motion.is_none() {
            let message = "has no table `flight`: nothing says where things are at other moments";
            let help = "give it one, with `epoch`, and `orbit` or `files`";
            return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
        }
        Ok(Template { file, toml, path: path.to_owned() })
    }

    /// The scene as it stands, as an entry without changes has it.
    pub(in crate::formats) fn unchanged(&self) -> Option<Variant> {
        let SceneFile { scene, motion, chain, inputs, defaults, notes, .. } = &self.file;
        let (motion, timing) = motion.clone()?;
        let (inputs, defaults, notes) = (inputs.clone(), defaults.clone(), notes.clone());
        let (chain, exposure) = (chain.clone(), scene.exposure.clone());
        Some(Variant { motion, timing, chain, exposure, inputs, defaults, notes })
    }

    /// The scene at the reference exposure of an acquisition that begins at `variant.motion.start`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if where something is, is not known then; [`Error::Unsupported`] for what this version cannot simulate.
    pub(in crate::formats) fn scene(&self, variant: &Variant) -> Result<Scene> {
        let scene = at_reference(&self.file.scene, &variant.exposure, &variant.motion, &variant.timing)?;
        scene.simulable()?;
        scene.sky.reaches_back(scene.models.conduction.unwrap_or(STEPS_OF_A_DAY))?;
        Ok(scene)
    }

    /// The scene as an entry of another file changes it: `entry` is the item there whose keys the changes are.
    ///
    /// # Errors
    /// [`Error::Invalid`] with all that is wrong with the changes; [`Error::Io`] for files that cannot be read.
    pub(in crate::formats) fn changed(
        &self,
        changes: Changes<'_>,
        (document, input): (&Document, &InputFile),
        entry: &str,
        moments: Option<Moments<'_>>,
    ) -> Result<Variant> {
        let flight = self.toml.flight.as_ref();
        let (Some(flight), Some(mut variant)) = (flight, self.unchanged()) else {
            return Err(Error::invalid(Location::file(&self.path), "has no table `flight`"));
        };
        let origin_m = self.file.scene.body.origin_m;
        let mut reader = TomlReader::new(&input.path, document.clone(), origin_m, input.clone(), &unwatched);
        reader.is_beside_scene = false;
        reader.moments = moments;
        reader.entry = Some(entry.to_owned());
        if let Some(sensor) = changes.sensor {
            let timing = reader.timing(sensor, true);
            variant.chain = reader.sensor_chain(sensor, timing);
            if sensor.fit.is_some() {
                let help = "give `ifov_mrad` or `fov_deg`";
                reader.helped("sensor.fit", "`fit` would change the field of view between acquisitions", help);
            }
            let is_slit = timing.is_some_and(|timing| timing.readout == Readout::Line);
            let pose = variant.exposure.camera.world_from_sensor;
            if let (Some(exposure), Some(timing)) = (reader.exposure(sensor, Some(pose), is_slit, None), timing) {
                (variant.exposure, variant.timing) = (exposure, timing);
            }
        }
        let pointing = changes.pointing.map(|pointing| reader.pointing(pointing));
        let flown = [changes.spacecraft, changes.orbit, changes.orbit_epoch];
        if changes.files.is_some() || flown.iter().any(Option::is_some) {
            if changes.files.is_none() {
                // The scene's files lie where the scene says.
                reader.folder = self.path.parent().unwrap_or(Path::new("")).to_owned();
            }
            if let Some(motion) = reader.motion(&merged(flight, changes)) {
                variant.motion = Motion { pointing: variant.motion.pointing, start: variant.motion.start, ..motion };
            }
        }
        if let Some(Some(pointing)) = pointing {
            variant.motion.pointing = pointing;
        }
        variant.add(reader)
    }
}

/// A scene's flight with an entry's changes.
fn merged(flight: &FlightToml, changes: Changes<'_>) -> FlightToml {
    let owned = |text: Option<&str>| text.map(str::to_owned);
    // Who flies by files does not fly by the scene's orbit, and the other way round.
    let (orbit, spacecraft) = match (changes.orbit, changes.spacecraft) {
        (None, None) => (flight.orbit.clone(), flight.spacecraft.clone()),
        (orbit, spacecraft) => (owned(orbit), owned(spacecraft)),
    };
    let of_scene = || flight.orbit_epoch.clone().unwrap_or_else(|| flight.epoch.clone());
    let orbit_epoch = match (owned(changes.orbit_epoch), &orbit) {
        (None, Some(_)) => Some(of_scene()),
        (stated, _) => stated,
    };
    FlightToml {
        epoch: flight.epoch.clone(),
        files: changes.files.map_or_else(|| flight.files.clone(), <[String]>::to_vec),
        body: flight.body.clone(),
        frame: flight.frame.clone(),
        spacecraft,
        orbit,
        orbit_epoch,
        correction: flight.correction,
        pointing: None,
    }
}

impl Variant {
    /// Adds what a reader of its changes has to tell.
    fn add(mut self, reader: TomlReader<'_>) -> Result<Self> {
        let stated = reader.defaults.clone();
        // The first is the file that changes the scene, which is not an input of what it asks for.
        let (inputs, notes) = reader.finish()?;
        for input in inputs.into_iter().skip(1) {
            if !self.inputs.contains(&input) {
                self.inputs.push(input);
            }
        }
        self.notes.extend(notes);
        self.defaults.retain(|of| !stated.iter().any(|new| new.item == of.item));
        self.defaults.extend(stated);
        Ok(self)
    }

    /// With the boresight on a point of the body, from its centre along its axes, m.
    pub(in crate::formats) fn aimed_at(mut self, target_m: DVec3) -> Self {
        let aim = Aim::Target(target_m);
        self.motion.pointing = Pointing { aim, ..self.motion.pointing };
        self
    }
}
