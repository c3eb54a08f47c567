//! Some files of a good scene are replaced by any bytes: nothing that reads, converts or writes it panics.
//!
//! Pieces of `files`; recipes are read, but no landscape is made of them.
#![no_main]

use std::sync::LazyLock;

use files::{Folder, told};
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::mesh_file::ColouredMesh;
use mmxrt::formats::{dart, recipe_toml, scene_toml};
use mmxrt::progress::Progress;
use mmxrt::report::Report;
use mmxrt::study::{self, Extremes, Request};

mod files;

static FOLDER: LazyLock<Folder> = LazyLock::new(|| Folder::holding("scene", &include!("scene.in")));

fuzz_target!(|data: &[u8]| {
    FOLDER.with(data, |folder| {
        let path = folder.join("scene.toml");
        told(recipe_toml::read(&path));
        let only_reading = |progress: Progress| progress.stage.starts_with("reading");
        let Some(file) = told(scene_toml::read(&path, &only_reading)) else { return };
        told(file.simulable());
        // A camera may have any number of pixels and bands; none is looked through here.
        let extremes = Extremes::new(&file.scene);
        if let Some((_, plan)) = told(study::plan(&file.scene, &extremes, &Request::default())) {
            let _ = study::dry_run(&file.scene, None, &extremes, &plan);
        }
        ColouredMesh::of_scene(&file.scene, &path, &mut Report::default());
        if file.scene.exposure.bands.len() < 1000 {
            told(dart::from_scene(&file.scene, &dart::SimulationOptions::default()));
        }
    });
});
