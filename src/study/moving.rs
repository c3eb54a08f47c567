//! A scene that moves, at a moment: its sky, and what is exposed from where.

use crate::error::Result;
use crate::flight::Epoch;
use crate::instrument::Optics;
use crate::scene::{Body, Exposure, Motion, Scene, Setup, Take, Timing};

/// A scene at the moment of its reference exposure, and how it moves.
#[derive(Debug, Clone, Copy)]
pub struct Moving<'a> {
    /// The scene then.
    pub scene: &'a Scene,
    /// How it moves.
    pub motion: &'a Motion,
    /// When what is taken.
    pub timing: Timing,
    /// What blurs an image before it is taken.
    pub optics: Option<&'a Optics>,
}

impl Moving<'_> {
    /// The scene at the moment of a part of the cube, with what is exposed then, of a body or a part of it; under a sky that moves, or stands still.
    pub(super) fn at(&self, body: &Body, take: &Take, is_still: bool) -> Result<Scene> {
        let Moving { scene, motion, .. } = *self;
        let sky = if is_still { scene.sky.clone() } else { motion.sky(&scene.sky, self.epoch(take))? };
        Scene::new(Setup { body: body.clone(), sky, exposure: self.exposure(take)?, models: scene.models })
    }

    /// What is exposed of a part of the cube, with the camera where it then is.
    pub(super) fn exposure(&self, take: &Take) -> Result<Exposure> {
        self.exposure_at(take, take.middle_s)
    }

    pub(super) fn exposure_at(&self, take: &Take, s: f64) -> Result<Exposure> {
        let mut exposure = take.exposure(&self.scene.exposure);
        exposure.camera.world_from_sensor = take.pose(self.motion.pose(self.motion.start.after_s(s))?, s);
        Ok(exposure)
    }

    /// The middle of a part of the cube.
    pub(super) fn epoch(&self, take: &Take) -> Epoch {
        self.motion.start.after_s(take.middle_s)
    }
}
