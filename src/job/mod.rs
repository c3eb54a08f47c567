//! Whole commands as functions: from opened inputs to finished files, for the command line, a campaign, or another language.
//!
//! A job touches no file but through [`formats`](crate::formats), prints nothing, and reads no clock: it returns what it has to report.

mod dry_run;
mod image_survey;
mod integrate;
mod landscape;
mod plan;
mod simulate;
mod solve;
mod spectrum_sheet;

pub use dry_run::{Outlook, dry_run};
pub use image_survey::{Picture, Survey, survey};
pub use integrate::{Radiance, integrate};
pub use landscape::LandscapeFiles;
pub use plan::plan;
pub use simulate::simulate;
pub use solve::{solve, stage_table};
pub use spectrum_sheet::SpectrumSheet;
