//! Rasters and tables of facets by any of their forms: opening them, reading a band of them, and telling what they hold never panics.
//!
//! The first byte chooses the names; a text and the bytes of the other file follow, parted by a byte 0.
#![no_main]

use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::{radiance_map, registry};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;

mod files;

/// A file and its partner.
const NAMES: [(&str, &str); 9] = [
    ("a.img", "a.hdr"),
    ("a.mpr", "a.mp#"),
    ("a.npy", "a.map.toml"),
    ("a.npz", "a.map.toml"),
    ("a.exr", "a.map.toml"),
    ("a.png", "a.map.toml"),
    ("a.csv", "a.map.toml"),
    ("a.map.toml", "a.csv"),
    ("a.jpg", "a.map.toml"),
];

static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let folder = files::Folder::holding("raster-scene", &include!("scene.in"));
    mmxrt::formats::scene_toml::read(&folder.path.join("scene.toml"), &unwatched).unwrap().scene
});

fuzz_target!(|data: &[u8]| {
    let Some((choice, rest)) = data.split_first() else { return };
    let (file, partner) = NAMES[*choice as usize % NAMES.len()];
    let at = rest.iter().position(|b| *b == 0).unwrap_or(rest.len());
    let (first, second) = (&rest[..at], rest.get(at + 1..).unwrap_or_default());
    // Text comes first, so that what parts the two is not within it.
    let (text, bytes) =
        if matches!(file, "a.mpr" | "a.map.toml" | "a.csv") { (file, partner) } else { (partner, file) };
    let folder = files::scratch("raster");
    std::fs::write(folder.join(text), first).unwrap();
    std::fs::write(folder.join(bytes), second).unwrap();
    if let Some(mut raster) = told(registry::image(&folder.join(file))) {
        if raster.pixels() < 1 << 16 {
            let (mut values, last) = (Vec::new(), raster.bands.len() - 1);
            for band in [0, last] {
                if told(raster.read(band, &mut values)).is_some() {
                    assert_eq!(values.len(), raster.pixels());
                }
            }
            if raster.take_image(None).is_ok() {
                told(raster.read(0, &mut values));
                told(raster.coverage().map(|share| share.is_none_or(|s| s.iter().all(|s| (0.0..=1.0).contains(s)))));
            }
        }
        told(raster.inputs());
    }
    let _ = radiance_map::open(&folder.join(file), &SCENE, 1.0, &unwatched);
    for name in [text, bytes] {
        let _ = std::fs::remove_file(folder.join(name));
    }
});
