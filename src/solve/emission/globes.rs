//! Bodies of the sky in view: a row for the sunlight that each reflects, and, with heat, one for its day and one for its night side.

use crate::geometry::SphereShown;
use crate::physics::blackbody;
use crate::scene::{Globe, Scene, Thermal};

/// Bodies that may be in view, as [`Setup::globes_in_view`](crate::scene::Setup::globes_in_view) has them.
#[derive(Debug)]
pub(super) struct Globes<'a> {
    pub(super) globes: Vec<&'a Globe>,
    /// Whether they are warm.
    is_warm: bool,
}

impl<'a> Globes<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let globes = scene.globes_in_view().into_iter().map(|(globe, _)| globe).collect();
        Globes { globes, is_warm: scene.models.thermal != Thermal::Off }
    }

    /// Rows of their reflected light.
    pub(super) fn light_rows(&self) -> usize {
        self.globes.len()
    }

    /// Rows of their heat: day, and night.
    pub(super) fn heat_rows(&self) -> usize {
        if self.is_warm { 2 * self.globes.len() } else { 0 }
    }

    /// Adds thermal radiance at a wavelength, times a weight, to each row of heat, W m-2 sr-1 um-1.
    pub(super) fn heat(&self, um: f64, weight: f64, mut add: impl FnMut(usize, f64)) {
        let sides = self.globes.iter().filter(|_| self.is_warm).flat_map(|globe| globe.day_night_k);
        sides.enumerate().for_each(|(row, t_k)| add(row, weight * blackbody::radiance_w_m2_sr_um(um, t_k)));
    }

    /// Weights of what a pixel shows of one of them: of its row of light, and of its two of heat.
    pub(super) fn weights(&self, shown: &SphereShown) -> (f64, Option<[f64; 2]>) {
        (
            shown.cosine.max(0.0),
            self.is_warm.then(|| [shown.facing, shown.area - shown.facing].map(|area| area.max(0.0))),
        )
    }
}
