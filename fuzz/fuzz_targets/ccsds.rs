//! Any text is a message of CCSDS or a table of positions, or an error; what is read can be written, and is read back.
#![no_main]

use std::hint::black_box;
use std::path::Path;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::flight::LeapSeconds;
use mmxrt::formats::flight_file::FlightFile;
use mmxrt::formats::{InputFile, ccsds, flight_table};

mod files;

fn written(file: &FlightFile, leap: &LeapSeconds) {
    for (_, of) in &file.trajectories {
        of.spans().iter().for_each(|span| _ = black_box((of.state(span.start), of.state(span.end))));
    }
    for (_, of) in &file.orientations {
        of.spans()
            .iter()
            .flatten()
            .for_each(|span| _ = black_box((of.frame_from_base(span.start), of.frame_from_base(span.end))));
    }
    let (text, _) = ccsds::ndm(file, leap, None).unwrap();
    let back = ccsds::parse(&text, InputFile::of(Path::new("back.xml"), b""), leap).unwrap();
    assert_eq!(back.size(), file.size());
}

fuzz_target!(|text: &str| {
    let leap = LeapSeconds::default();
    let input = || InputFile::of(Path::new("a.oem"), text.as_bytes());
    if let Some(file) = told(ccsds::parse(text, input(), &leap)) {
        written(&file, &leap);
    }
    if let Some(file) = told(flight_table::parse(text, input(), &leap)) {
        written(&file, &leap);
    }
});
