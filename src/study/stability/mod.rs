//! Where methods fail: each is driven along a hazard until its error shows.
//!
//! What is true is a closed form, or the same scene where the hazard is absent.

mod conduction;
mod coplanar;
mod facet_size;
mod incidence;
mod map_placement;
mod offset;
mod overlaps;
mod painter;
mod photometry;
mod scenes;
mod slivers;
mod sun_distance;
mod t_junctions;
mod thesis_scene;

use crate::error::Result;
use crate::progress::{Watch, tell};

pub use painter::{painted_image, painted_sunlight};
pub use sun_distance::scaled_sun_errors;

/// Errors from which on a method counts as failing: what nobody would see, what spoils a measurement, and what anybody sees.
pub const LEVELS: [f64; 3] = [1e-6, 1e-3, 1e-1];

/// What a method is exposed to.
#[derive(Debug, Clone, PartialEq)]
pub struct Hazard {
    /// What it is called.
    pub name: &'static str,
    /// What is varied, with its unit.
    pub parameter: &'static str,
    /// What is computed, what is true of it, and how the error is defined.
    pub truth: &'static str,
    /// The methods that are exposed to it.
    pub sweeps: Vec<Sweep>,
}

/// A method along a hazard.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The method.
    pub method: &'static str,
    /// Whether it is what this program does.
    pub is_ours: bool,
    /// What it does where it fails, or why it does not.
    pub then: &'static str,
    /// From harmless to harsh.
    pub points: Vec<Point>,
}

/// A value of the parameter, and the error there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The value.
    pub at: f64,
    /// The error; infinite if there is no result.
    pub error: f64,
}

impl Sweep {
    /// The first value at which the error exceeds a level.
    pub fn fails_from(&self, level: f64) -> Option<f64> {
        // What is not a number is not a result.
        self.points.iter().find(|point| point.error.is_nan() || point.error > level).map(|point| point.at)
    }

    /// The largest error.
    pub fn worst(&self) -> f64 {
        self.points
            .iter()
            .map(|point| if point.error.is_nan() { f64::INFINITY } else { point.error })
            .fold(0.0, f64::max)
    }
}

type Stage = fn() -> Result<Hazard>;

/// All hazards, in the order of the table.
const ALL: [Stage; 14] = [
    sun_distance::hazard,
    offset::hazard,
    incidence::hazard,
    slivers::hazard,
    coplanar::gap,
    coplanar::crossing,
    overlaps::hazard,
    thesis_scene::hazard,
    t_junctions::hazard,
    facet_size::hazard,
    photometry::opposition,
    photometry::grazing,
    conduction::hazard,
    map_placement::hazard,
];

/// Drives all methods along all hazards.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn stability(watch: Watch<'_>) -> Result<Vec<Hazard>> {
    let mut hazards = Vec::new();
    for (done, stage) in (0..).zip(ALL) {
        tell(watch, "hazards", done, ALL.len() as u64)?;
        hazards.push(stage()?);
    }
    tell(watch, "hazards", ALL.len() as u64, ALL.len() as u64)?;
    Ok(hazards)
}
