//! The contents of a flight-dynamics file, in any format.

use crate::flight::{Epoch, LeapSeconds, Orientation, Scale, Trajectory};
use crate::report::Report;

use super::input::InputFile;

/// Largest deviation of a quaternion's length from 1 that is rounding, not a mistake.
pub(super) const MOST_OFF: f64 = 1e-3;

/// What a file calls its subject.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object {
    /// Its name, as the file spells it.
    pub name: String,
    /// Its designator: a SPICE number, or e.g. 1996-062A; its name if it has no other.
    pub id: String,
}

/// Trajectories and orientations of a file.
#[derive(Debug, Clone)]
pub struct FlightFile {
    /// Trajectories of objects.
    pub trajectories: Vec<(Object, Trajectory)>,
    /// Orientations of frames, with their objects.
    pub orientations: Vec<(Object, Orientation)>,
    /// The time scale of its epochs.
    pub scale: Scale,
    /// When it was made, and by whom, if it says so.
    pub made: Option<(String, String)>,
    /// What else it says.
    pub comments: Vec<String>,
    /// What was approximated, defaulted or dropped.
    pub report: Report,
    /// The file.
    pub input: InputFile,
}

/// The shortest text that reads back as this epoch; else with 9 digits of a second.
pub(super) fn time_text(epoch: Epoch, scale: Scale, leap: &LeapSeconds) -> String {
    let same = |text: &String| Epoch::parse(text, Some(scale), leap).is_ok_and(|read| read == epoch);
    let exact = (0..=9).map(|digits| epoch.to_text(scale, digits, leap)).find(same);
    exact.unwrap_or_else(|| {
        // Scales other than TDB round on the way there and back: search a little further.
        let nearest = epoch.to_text(scale, 9, leap);
        let back = Epoch::parse(&nearest, Some(scale), leap).map_or(0.0, |read| epoch.since_s(read));
        Some(epoch.after_s(back).to_text(scale, 9, leap)).filter(same).unwrap_or(nearest)
    })
}

impl FlightFile {
    /// Its amount, in words.
    pub fn size(&self) -> String {
        let of = |count: usize, one: &str, more: &str| format!("{count} {}", if count == 1 { one } else { more });
        let (trajectories, orientations) = (self.trajectories.len(), self.orientations.len());
        match (trajectories, orientations) {
            (_, 0) => of(trajectories, "trajectory", "trajectories"),
            (0, _) => of(orientations, "orientation", "orientations"),
            _ => format!(
                "{}, {}",
                of(trajectories, "trajectory", "trajectories"),
                of(orientations, "orientation", "orientations")
            ),
        }
    }
}
