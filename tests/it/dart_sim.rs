//! A DART simulation in a folder, whose files are edited as somebody else's would differ.

use std::path::PathBuf;

use mmxrt::formats::dart::{self, ReadOptions, SceneOptions, TargetVersion};
use mmxrt::progress::unwatched;
use mmxrt::report::Report;
use mmxrt::scene::Scene;

use crate::cli::run;
use crate::dart_write::{options, read, written};
use crate::scratch::{Scratch, edit};

/// A folder of a scene, whose inputs can be edited.
pub(crate) struct Sim {
    pub(crate) scratch: Scratch,
    pub(crate) folder: PathBuf,
}

impl Sim {
    pub(crate) fn of(scene: &Scene) -> Self {
        let scratch = Scratch::new();
        let folder = scratch.join("sim");
        written(scene, &options(TargetVersion::V5_7_4), &folder);
        Sim { scratch, folder }
    }

    /// Without what was written beside it: as a folder of somebody else's.
    pub(crate) fn bare(scene: &Scene) -> Self {
        let sim = Sim::of(scene);
        std::fs::remove_file(sim.folder.join("mmxrt.toml")).unwrap();
        sim
    }

    pub(crate) fn edit(&self, file: &str, from: &str, to: &str) -> &Self {
        edit(&self.folder.join(file), from, to);
        self
    }

    /// Takes away the element of this beginning, to its end.
    pub(crate) fn without(&self, file: &str, beginning: &str, end: &str) -> &Self {
        let path = self.folder.join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        let start = text.find(beginning).unwrap_or_else(|| panic!("{beginning} in {text}"));
        let length = text[start..].find(end).unwrap() + end.len();
        std::fs::write(path, format!("{}{}", &text[..start], &text[start + length..])).unwrap();
        self
    }

    pub(crate) fn read(&self) -> (Scene, Report) {
        read(&self.folder, &SceneOptions::default())
    }

    /// What is told if it cannot be read.
    pub(crate) fn error(&self) -> String {
        let options = ReadOptions::default();
        let read = dart::read(&self.folder, &options).and_then(|(simulation, ..)| {
            dart::to_scene(&simulation, &options.folder(&self.folder), &SceneOptions::default(), &unwatched)
        });
        read.unwrap_err().to_string()
    }

    /// Findings, and whether there are errors.
    pub(crate) fn check(&self) -> (i32, String) {
        let (code, out, err) = run(&["convert", "--check", self.folder.to_str().unwrap()]);
        assert_eq!(err, "");
        (code, out)
    }
}

/// Whether a note has these words.
pub(crate) fn told(report: &Report, part: &str) -> bool {
    report.notes.iter().any(|note| note.message.contains(part))
}
