//! A sequence's file, as DART's sequencer takes it: entries, which modules run, and what its table of results holds.

use crate::formats::xml::Element;

use super::simulation::{Sequence, SequenceValues, Version};

/// Modules that run for each simulation, and other choices: those of DART's own files, with directions made anew, as the Sun moves.
const PREFERENCES: [(&str, &str); 34] = [
    ("atmosphereMaketLaunched", "false"),
    ("dartLaunched", "true"),
    ("deleteAll", "false"),
    ("deleteAtmosphere", "false"),
    ("deleteAtmosphereMaket", "false"),
    ("deleteBandFolder", "false"),
    ("deleteDartLut", "false"),
    ("deleteDartSequenceur", "false"),
    ("deleteDartTxt", "false"),
    ("deleteDirection", "false"),
    ("deleteInputs", "false"),
    ("deleteLibPhase", "false"),
    ("deleteMaket", "false"),
    ("deleteMaketTreeResults", "false"),
    ("deletePlyFolder", "false"),
    ("deleteScnFiles", "false"),
    ("deleteTreePosition", "false"),
    ("deleteTriangles", "false"),
    ("demGeneratorLaunched", "false"),
    ("directionLaunched", "true"),
    ("displayEnabled", "true"),
    ("genMode", "XML"),
    ("hapkeLaunched", "false"),
    ("individualDisplayEnabled", "false"),
    ("maketLaunched", "true"),
    ("numberOfEnumerateValuesDisplayed", "1000"),
    ("numberParallelThreads", "1"),
    ("phaseLaunched", "true"),
    ("prospectLaunched", "false"),
    ("triangleFileProcessorLaunched", "true"),
    ("useBroadBand", "true"),
    ("useSceneSpectra", "true"),
    ("vegetationLaunched", "false"),
    ("zippedResults", "false"),
];

/// What goes into the table of results: none is made, as images are what is wanted.
const TABLE: [(&str, &str); 20] = [
    ("addedDirection", "false"),
    ("atmosToa", "false"),
    ("atmosToaOrdre", "false"),
    ("coupl", "false"),
    ("fluorescence", "false"),
    ("generateLUT", "false"),
    ("iterx", "false"),
    ("luminance", "false"),
    ("maketCoverage", "false"),
    ("ordre", "false"),
    ("otherIter", "false"),
    ("phiMax", ""),
    ("phiMin", ""),
    ("productsPerType", "false"),
    ("reflectance", "false"),
    ("sensor", "false"),
    ("storeIndirect", "false"),
    ("thetaMax", ""),
    ("thetaMin", ""),
    ("toa", "false"),
];

/// The root element of a sequence's file.
pub(super) fn file(sequence: &Sequence, Version { version, build }: &Version) -> Element {
    let with_all = |name: &str, attributes: &[(&str, &str)]| {
        attributes.iter().fold(Element::new(name), |element, (name, value)| element.with(*name, *value))
    };
    let groups = sequence.groups.iter().map(|group| {
        let entries = group.entries.iter().map(|entry| {
            let (kind, args) = match &entry.values {
                SequenceValues::Enumerated(values) => ("enumerate", values.join(";")),
                SequenceValues::Linear { start, step, count } => ("linear", format!("{start:?};{step:?};{count}")),
            };
            Element::new("DartSequencerDescriptorEntry")
                .with("args", args)
                .with("propertyName", &entry.property)
                .with("type", kind)
        });
        Element::new("DartSequencerDescriptorGroup").with("groupName", &group.name).and_all(entries)
    });
    let descriptor = Element::new("DartSequencerDescriptor")
        .with("sequenceName", format!("sequence;;{}", sequence.name))
        .and(Element::new("DartSequencerDescriptorEntries").and_all(groups))
        .and(with_all("DartSequencerPreferences", &PREFERENCES))
        .and(with_all("DartLutPreferences", &TABLE));
    Element::new("DartFile").with("version", version).with("build", build).and(descriptor)
}
