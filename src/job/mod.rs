//! Whole commands as functions: from opened inputs to finished files, for the command line, a campaign, or another language.
//!
//! A job touches no file but through [`formats`](crate::formats), prints nothing, and reads no clock: it returns what it has to report.

mod campaign;
mod chart;
mod coregister;
mod curve_sheet;
mod dry_run;
mod exposure_facts;
mod flight_facts;
mod flight_tracks;
mod hold;
mod image_survey;
mod instrument;
mod integrate;
mod landscape;
mod locate;
mod mesh_portraits;
mod new;
mod ortho;
mod plan;
mod simulate;
mod solve;
mod surface;
mod view;

pub use campaign::{Finished, Order, Shard, State, Status, campaign};
pub use chart::{Render, chart, stability};
pub use coregister::coregister;
pub use curve_sheet::CurveSheet;
pub use dry_run::{Outlook, dry_run, dry_run_with, plan, plan_of};
pub use exposure_facts::{Drift, ExposureFacts, Takes, exposure_facts};
pub use flight_facts::{FlightFacts, PartFacts, Steps, flight_facts};
pub use flight_tracks::{draw_flight, flight_sheet};
pub use hold::{Held, hold};
pub use image_survey::{Picture, Survey, survey};
pub use instrument::{Asked, instrument};
pub use integrate::{Radiance, integrate};
pub use landscape::LandscapeFiles;
pub use locate::{SceneOf, answers, locate_errors, write_answers, write_isd};
pub use mesh_portraits::draw_mesh;
pub use new::{Template, new, write_pages};
pub use ortho::{Mapped, ortho};
pub use plan::decide;
pub use simulate::simulate;
pub use solve::{TableFiles, Towards, radiance_path, solve};
pub use surface::SurfaceFacts;
pub use view::{PageOrder, Shown, view};
