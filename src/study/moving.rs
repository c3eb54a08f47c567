//! A moving scene at an epoch: its sky, and its exposure.

use crate::error::Result;
use crate::flight::Epoch;
use crate::instrument::Optics;
use crate::scene::{Body, Exposure, Motion, Scene, Setup, Take, Timing};

/// A scene at its reference exposure, and its motion.
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
    /// The scene at the epoch of a part of the cube, with its exposure, of a body or a part of it; under a moving or
    /// fixed sky.
    pub(super) fn at(&self, body: &Body, take: &Take, is_still: bool) -> Result<Scene> {
        let Moving { scene, motion, .. } = *self;
        let sky = if is_still { scene.sky.clone() } else { motion.sky(&scene.sky, self.epoch(take))? };
        Scene::new(Setup { body: body.clone(), sky, exposure: self.exposure(take)?, models: scene.models })
    }

    /// The exposure of a part of the cube, at the camera's pose then.
    pub(super) fn exposure(&self, take: &Take) -> Result<Exposure> {
        self.exposure_at(take, take.middle_s)
    }

    pub(super) fn exposure_at(&self, take: &Take, s: f64) -> Result<Exposure> {
        let mut exposure = take.exposure(&self.scene.exposure);
        exposure.camera.world_from_sensor = take.pose(self.motion.pose(self.motion.start.after_s(s))?, s);
        Ok(exposure)
    }

    /// The middle of its exposure.
    pub(super) fn epoch(&self, take: &Take) -> Epoch {
        self.motion.start.after_s(take.middle_s)
    }
}
