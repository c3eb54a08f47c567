//! Some files of a good scene and its radiance maps are replaced by any bytes: nothing that opens the maps, or looks at the scene by
//! them, panics.
//!
//! The first two bytes choose the maps and how they are put onto the scene; the pieces that follow, of `files`, are the files.
#![no_main]

use std::sync::LazyLock;

use files::{Folder, told};
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::{dart, radiance_map, scene_toml};
use mmxrt::geometry::Texels;
use mmxrt::integrate::ViewChoice;
use mmxrt::product::FacetTable;
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::solve;
use mmxrt::study::{self, Fill, MapOptions};

mod files;

/// Those that are opened, by the bits of the first byte.
const MAPS: [&str; 8] = [
    "plane.map.toml",
    "camera.map.toml",
    "atlas.map.toml",
    "facets.csv",
    "views.map.toml",
    "budget.map.toml",
    "camera.img",
    "output",
];

static FOLDER: LazyLock<Folder> = LazyLock::new(|| Folder::holding("maps", &include!("maps.in")));

/// The good scene: what is a map of it is looked at.
static SCENE: LazyLock<(Scene, FacetTable)> = LazyLock::new(|| {
    let scene = scene_toml::read(&FOLDER.path.join("scene.toml"), &unwatched).unwrap().scene;
    let table = solve::solve(&scene, &unwatched).unwrap();
    (scene, table)
});

fuzz_target!(|data: &[u8]| {
    let [which, how, pieces @ ..] = data else { return };
    let (scene, table) = &*SCENE;
    FOLDER.with(pieces, |folder| {
        let open = |(i, name): (usize, &&str)| {
            let weight = if i == 1 && how & 64 != 0 { -0.5 } else { 1.0 };
            told(radiance_map::open(&folder.join(name), scene, weight, &unwatched))
        };
        let chosen = MAPS.iter().enumerate().filter(|(i, _)| which >> i & 1 == 1);
        let maps: Vec<_> = chosen.filter_map(open).map(|opened| opened.maps).collect();
        let options = MapOptions {
            choice: if how & 1 == 0 { ViewChoice::Nearest } else { ViewChoice::Interpolated },
            texels: if how & 2 == 0 { Texels::Nearest } else { Texels::Bilinear },
            fill: [Fill::Refuse(1e-3), Fill::Solved, Fill::Value(1.0), Fill::Nan][usize::from(how >> 2 & 3)],
            add_solved: how & 16 != 0,
            footprints: how & 64 != 0,
        };
        // Views of the same, or terms of a sum.
        let terms = if how & 32 == 0 { vec![maps.into_iter().flatten().collect()] } else { maps };
        if terms.iter().any(|views| !views.is_empty()) {
            told(study::observe_maps(scene, table, terms, &options, &unwatched));
        }
        if how & 128 != 0 {
            told(dart::output::open(folder));
        }
    });
});
