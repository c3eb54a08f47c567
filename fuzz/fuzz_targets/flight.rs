//! A good campaign and what goes with it, some of whose files are replaced by any bytes: campaign, scene in flight, tables of orbits and directions, a measured point spread, an
//! instrument, what is known of pointing and orbit, exposures, points. What is read is asked where things are; nothing panics. Pieces as `files.rs` says.
#![no_main]

use std::sync::LazyLock;

use files::{Folder, told};
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::campaign_toml::Campaign;
use mmxrt::formats::points_csv::{self, Asked};
use mmxrt::formats::{instrument_toml, knowledge_toml, scene_toml};
use mmxrt::job;
use mmxrt::progress::{Progress, unwatched};
use mmxrt::study::knowledge::{self, budget};
use mmxrt::study::locate::Locator;

mod files;

static FOLDER: LazyLock<Folder> = LazyLock::new(|| Folder::holding("flight", &include!("flight.in")));

/// Of larger images, and of more draws, nothing is asked.
const FEW: u32 = 100;

fuzz_target!(|data: &[u8]| FOLDER.with(data, |folder| {
    // No landscape is made of a recipe.
    let only_reading = |progress: Progress| progress.stage.starts_with("reading");
    told(instrument_toml::read(&folder.join("instrument.toml"), &only_reading));
    told(job::exposure_facts(&folder.join("exposures.csv")));
    let questions = told(points_csv::read(&folder.join("points.csv")));
    if let Some(mut campaign) = told(Campaign::open(&folder.join("campaign.toml"), &only_reading)) {
        let acquisitions: Vec<_> = campaign.acquisitions.iter().rev().take(4).cloned().collect();
        for acquisition in &acquisitions {
            let look = told(campaign.look(acquisition));
            look.and_then(|look| told(campaign.subject(acquisition, look)));
        }
    }
    let Some(file) = told(scene_toml::read(&folder.join("scene.toml"), &only_reading)) else { return };
    let scene = &file.scene;
    let locator = Locator::new(scene, file.motion.as_ref().map(|(motion, timing)| (motion, *timing)));
    for question in questions.iter().flatten().take(FEW as usize) {
        let band = question.band.unwrap_or(locator.reference_band());
        if band >= scene.exposure.bands.len() {
            continue;
        }
        match question.asked {
            Asked::Pixel(place) => _ = told(locator.ground(place, band)),
            Asked::Ground(point_m) => _ = told(locator.place(point_m - scene.body.origin_m, band)),
        }
    }
    let known = told(knowledge_toml::read(&folder.join("knowledge.toml"), scene.body.origin_m));
    let camera = &scene.exposure.camera;
    if let Some(known) = known
        && camera.samples.saturating_mul(camera.lines) <= FEW
    {
        let asked = knowledge::Asked { band: 0, every: 1, draws: known.draws.min(4), seed: known.seed };
        if let Some(found) = told(budget(&locator, &known.knowledge, asked, &unwatched).map_err(|e| known.placed(e))) {
            let _ = knowledge::summary(&found);
        }
    }
}));
