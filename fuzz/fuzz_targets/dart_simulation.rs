//! Some files of a good simulation are replaced by any bytes: nothing that reads, checks, converts or writes it panics.
//!
//! The first byte chooses between two simulations; the pieces that follow, of `files`, are their files.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use files::{Folder, told};
use glam::DVec3;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::{convert, dart, registry, xml};
use mmxrt::progress::unwatched;

mod files;

/// One that DART's user made, and one that was made here, with databases and `mmxrt.toml`.
static FOLDERS: LazyLock<[Folder; 2]> = LazyLock::new(|| {
    let theirs = Folder::holding("theirs", &include!("boulder_574.in"));
    let scene = Folder::holding("scene", &include!("scene.in"));
    let ours = files::scratch("ours").join("simulation");
    let _ = std::fs::remove_dir_all(&ours);
    convert::convert(&scene.path.join("scene.toml"), &ours, &convert::Options::default(), &unwatched).unwrap();
    // Simulations of their own, which the first one does not need.
    for other in ["check", "mars"] {
        let _ = std::fs::remove_dir_all(ours.join(other));
    }
    [theirs, Folder::of(ours)]
});

fuzz_target!(|data: &[u8]| {
    let Some((which, pieces)) = data.split_first() else { return };
    FOLDERS[usize::from(*which) % FOLDERS.len()].with(pieces, |folder| {
        let options = dart::ReadOptions { sun_deg: Some([30.0, 100.0]), ..Default::default() };
        if let Some((simulation, _, _)) = told(dart::read(folder, &options)) {
            taken(folder, &simulation, &options);
        }
        let options = convert::Options { from: registry::named("dart"), ..Default::default() };
        told(convert::check(folder, &options));
    });
});

fn taken(folder: &Path, simulation: &dart::Simulation, options: &dart::ReadOptions) {
    assert!(dart::diff(simulation, simulation).is_empty());
    for field in &simulation.fields {
        field.objects().for_each(drop);
    }
    for sequence in &simulation.sequences {
        // A long one takes its time; what it holds is no other than in a short one.
        if dart::rows(sequence).is_ok_and(|rows| rows.len() < 20) {
            told(dart::flight(folder, sequence, options));
        }
    }
    let boxes_m = vec![(DVec3::ZERO, DVec3::ONE); simulation.objects.len()];
    for (name, root) in told(dart::inputs(simulation, &boxes_m)).unwrap_or_default() {
        xml::parse(&root.write(), Path::new(name)).unwrap();
    }
    let folder = options.folder(folder);
    told(dart::terrain(simulation, &folder));
    let options = dart::SceneOptions::default();
    if let Some(converted) = told(dart::to_scene(simulation, &folder, &options, &unwatched)) {
        for target in [dart::TargetVersion::V5_7_4, dart::TargetVersion::V5_11_0] {
            told(dart::from_scene(&converted.scene, &dart::SimulationOptions { target, ..Default::default() }));
        }
    }
}
