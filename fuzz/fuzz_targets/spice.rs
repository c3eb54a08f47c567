//! Any bytes are a kernel of SPICE, text or binary, or an error; what is read can be asked. Pieces replace good kernels, as `files.rs` says.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use files::{Folder, told};
use libfuzzer_sys::fuzz_target;
use mmxrt::flight::{Almanac, Epoch};
use mmxrt::formats::spice;

mod files;

/// Of `tests/data/spice`, in the order of their names, as the numbers of pieces count them.
macro_rules! kernels {
    ($($name:literal),*) => { [$(($name, include_bytes!(concat!("../../tests/data/spice/", $name)).as_slice())),*] };
}
static GOOD: [(&str, &[u8]); 7] =
    kernels!("mars.tpc", "probe.bc", "probe.bsp", "probe.tf", "probe.tls", "probe.tsc", "rock.bpc");
static FOLDER: LazyLock<Folder> = LazyLock::new(|| Folder::holding("spice", &GOOD));

fuzz_target!(|data: &[u8]| FOLDER.with(data, |folder| {
    let paths: Vec<PathBuf> = GOOD.iter().map(|(name, _)| folder.join(name)).collect();
    for path in &paths {
        told(spice::contents(path));
    }
    let mut almanac = Almanac::default();
    if told(spice::furnish(&paths, &mut almanac)).is_some() {
        for tdb_s in [0.0, 8.4e8, 8.4e8 + 30_010.0] {
            let Some(at) = Epoch::from_tdb_s(tdb_s) else { continue };
            for of in &almanac.trajectories {
                told(almanac.state(&of.target, &of.centre, "J2000", at));
            }
            for of in &almanac.orientations {
                told(almanac.rotation(&of.frame, "J2000", at));
            }
        }
    }
}));
