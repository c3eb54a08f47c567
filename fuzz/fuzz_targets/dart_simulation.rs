//! One input of a good simulation is replaced by any bytes: reading, checking and expanding it never panics.
#![no_main]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::dart;

/// What may be replaced: where it lies, and its good text.
const FILES: [(&str, &[u8]); 10] = [
    ("input/maket.xml", include_bytes!("../../tests/data/dart/boulder_574/input/maket.xml")),
    ("input/coeff_diff.xml", include_bytes!("../../tests/data/dart/boulder_574/input/coeff_diff.xml")),
    ("input/object_3d.xml", include_bytes!("../../tests/data/dart/boulder_574/input/object_3d.xml")),
    ("input/phase.xml", include_bytes!("../../tests/data/dart/boulder_574/input/phase.xml")),
    ("input/directions.xml", include_bytes!("../../tests/data/dart/boulder_574/input/directions.xml")),
    ("input/pebbles.txt", include_bytes!("../../tests/data/dart/boulder_574/input/pebbles.txt")),
    ("input/obj/boulder.obj", include_bytes!("../../tests/data/dart/boulder_574/input/obj/boulder.obj")),
    ("input/DEM.mpr", include_bytes!("../../tests/data/dart/boulder_574/input/DEM.mpr")),
    ("input/DEM.mp#", include_bytes!("../../tests/data/dart/boulder_574/input/DEM.mp#")),
    ("flyby.xml", include_bytes!("../../tests/data/dart/boulder_574/flyby.xml")),
];

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("mmxrt-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("input/obj")).unwrap();
    for (path, good) in FILES {
        std::fs::write(folder.join(path), good).unwrap();
    }
    folder
});

fuzz_target!(|data: &[u8]| {
    let Some((which, bytes)) = data.split_first() else { return };
    let folder: &Path = &FOLDER;
    let (path, good) = FILES[*which as usize % FILES.len()];
    std::fs::write(folder.join(path), bytes).unwrap();
    let options = dart::ReadOptions::default();
    if let Ok((simulation, _, _)) = dart::read(folder, &options) {
        for field in &simulation.fields {
            field.objects().for_each(drop);
        }
        for sequence in &simulation.sequences {
            // A long one takes its time; what it holds is no other than in a short one.
            if dart::rows(sequence).is_ok_and(|rows| rows.len() < 20) {
                let _ = dart::flight(folder, sequence, &options);
            }
        }
    }
    dart::check(folder, &options, &dart::no_coverage);
    std::fs::write(folder.join(path), good).unwrap();
});
