//! Any bytes under any name are converted into another format, or an error: what is written is read back.
//!
//! The first byte chooses the names, the second the output; the two files follow, parted by a byte 0.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::convert::{self, Content, Options};
use mmxrt::progress::unwatched;

mod files;

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("convert"));

/// A file and its partner; of a pair the text comes first.
const NAMES: [[&str; 2]; 12] = [
    ["a.hdr", "a.img"],
    ["a.hdr", "a.sli"],
    ["a.mpr", "a.mp#"],
    ["a.obj", "a.mtl"],
    ["a.gltf", "a.bin"],
    ["a.csv", "b.csv"],
    ["b.csv", "a.npy"],
    ["b.csv", "a.npz"],
    ["b.csv", "a.exr"],
    ["b.csv", "a.png"],
    ["b.csv", "a.jpg"],
    ["b.txt", "a"],
];

const OUTPUTS: [&str; 11] =
    ["o.img", "o.bil", "o.bip", "o.mpr", "o.npy", "o.exr", "o.csv", "o.sli", "o.txt", "o.glb", "o.obj"];

fuzz_target!(|data: &[u8]| {
    let [which, output, rest @ ..] = data else { return };
    let names = NAMES[usize::from(*which) % NAMES.len()];
    let output = OUTPUTS[usize::from(*output) % OUTPUTS.len()];
    let at = rest.iter().position(|b| *b == 0).unwrap_or(rest.len());
    for (name, bytes) in names.iter().zip([&rest[..at], rest.get(at + 1..).unwrap_or_default()]) {
        std::fs::write(FOLDER.join(name), bytes).unwrap();
    }
    // The file that is not the other's.
    let name = names.iter().find(|name| name.starts_with("a.") || **name == "a").unwrap();
    let options = Options::default();
    let input = FOLDER.join(name);
    let is_small = match told(convert::read(&input, &options, &unwatched)) {
        // A file of a few bytes may hold a large image of zeros: it is written elsewhere than in memory.
        Some((_, Content::Raster(raster), _)) => raster.pixels() * raster.bands.len() < 1 << 16,
        Some(_) => true,
        None => false,
    };
    if is_small {
        let output = FOLDER.join(output);
        let options = Options { replace: true, ..options };
        if told(convert::convert(&input, &output, &options, &unwatched)).is_some() {
            convert::read(&output, &Options::default(), &unwatched).unwrap();
        }
    }
    let _ = std::fs::remove_dir_all(&*FOLDER);
    std::fs::create_dir_all(&*FOLDER).unwrap();
});
