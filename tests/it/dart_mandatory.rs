//! A check of DART's inputs knows which elements must be there.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mmxrt::formats::dart::{Finding, ReadOptions, Severity, TargetVersion, check, no_summary};
use mmxrt::formats::xml::{self, Element};

use crate::cli::run;
use crate::dart_write::{options, rich, written};
use crate::scratch::{Scratch, edit};

/// Of these there may be none.
const OPTIONAL: [&str; 5] = ["Object", "HapkeSpecularMulti", "RPVMulti", "AddedDirections", "Pinhole"];

fn findings(folder: &Path) -> Vec<Finding> {
    check(folder, &ReadOptions::default(), &no_summary)
}

fn errors(findings: &[Finding]) -> Vec<String> {
    findings.iter().filter(|f| f.severity == Severity::Error).map(ToString::to_string).collect()
}

/// The paths of all elements below one, from a section on.
fn paths(element: &Element, path: &str, found: &mut Vec<String>) {
    for child in &element.children {
        let path = format!("{path}/{}", child.name);
        if !found.contains(&path) {
            found.push(path.clone());
        }
        paths(child, &path, found);
    }
}

/// Takes away what is at a path: all of it in the first element that has any.
fn without(element: &mut Element, path: &[&str]) -> bool {
    let [name, below @ ..] = path else { return false };
    if below.is_empty() {
        let before = element.children.len();
        element.children.retain(|child| child.name != *name);
        return element.children.len() < before;
    }
    element.children.iter_mut().filter(|child| child.name == *name).any(|child| without(child, below))
}

/// The paths of all attributes below an element, and its own.
fn attributes(element: &Element, path: &str, found: &mut Vec<String>) {
    for attribute in &element.attributes {
        let path = format!("{path}/@{}", attribute.name);
        if !found.contains(&path) {
            found.push(path);
        }
    }
    element.children.iter().for_each(|child| attributes(child, &format!("{path}/{}", child.name), found));
}

/// Takes an attribute away wherever it is at a path.
fn strip(element: &mut Element, path: &[&str], name: &str) {
    match path {
        [] => element.attributes.retain(|attribute| attribute.name != name),
        [first, below @ ..] => {
            element
                .children
                .iter_mut()
                .filter(|child| child.name == *first)
                .for_each(|child| strip(child, below, name));
        }
    }
}

fn inputs(folder: &Path) -> BTreeMap<PathBuf, Element> {
    let files = folder.join("input").read_dir().unwrap().map(|entry| entry.unwrap().path());
    let is_xml = |path: &PathBuf| path.extension().is_some_and(|e| e == "xml");
    files.filter(is_xml).map(|path| (path.clone(), xml::read(&path).unwrap().0)).collect()
}

#[test]
fn each_element_that_is_missing_is_named() {
    let scratch = Scratch::new();
    let folder = scratch.join("sim");
    written(&rich(), &options(TargetVersion::V5_7_4), &folder);
    assert_eq!(errors(&findings(&folder)), [""; 0]);
    let mut count = 0;
    for (file, root) in inputs(&folder) {
        let mut all = Vec::new();
        let section = &root.children[0];
        paths(section, &section.name, &mut all);
        for path in all.iter().filter(|path| !OPTIONAL.iter().any(|name| path.ends_with(&format!("/{name}")))) {
            let mut edited = root.clone();
            let names: Vec<&str> = path.split('/').skip(1).collect();
            assert!(without(&mut edited.children[0], &names), "{path}");
            std::fs::write(&file, edited.write()).unwrap();
            let told = errors(&findings(&folder));
            assert!(told.iter().any(|line| line.contains(&format!("`{path}` is"))), "{path}: {told:#?}");
            count += 1;
        }
        std::fs::write(&file, root.write()).unwrap();
    }
    assert!(count > 80, "{count}");
    // Its attributes, too.
    let (mut count, mut conversions) = (0, 0);
    for (file, root) in inputs(&folder) {
        let mut all = Vec::new();
        attributes(&root.children[0], &root.children[0].name, &mut all);
        for path in all {
            let (around, name) = path.rsplit_once("/@").unwrap();
            let mut edited = root.clone();
            strip(&mut edited.children[0], &around.split('/').skip(1).collect::<Vec<_>>(), name);
            std::fs::write(&file, edited.write()).unwrap();
            let told = errors(&findings(&folder));
            assert!(told.iter().any(|line| line.contains(&format!("`{path}` is"))), "{path}: {told:#?}");
            // Of what is carried, a conversion tells it, unless it is refused.
            let told_there =
                ["hidden", "ident", "sameOPObject", "type", "zscale", "irradiance", "spectralDartMode", "doubleFace"];
            if let Some(name) = told_there.iter().find(|told| **told == name)
                && let Ok((_, report, _)) = mmxrt::formats::dart::read(&folder, &ReadOptions::default())
            {
                let part = format!("has no attribute `{name}`");
                // Trees, which have this attribute too, are nothing that is carried.
                let is_told = report.notes.iter().any(|note| note.message.contains(&part));
                assert!(is_told || path.starts_with("Trees"), "{path}: {:#?}", report.notes);
                conversions += usize::from(is_told);
            }
            count += 1;
        }
        std::fs::write(&file, root.write()).unwrap();
    }
    assert!(count > 200 && conversions > 8, "{count} {conversions}");
    // Of a file, or its section, likewise.
    for (file, root) in inputs(&folder) {
        let name = file.file_name().unwrap().to_str().unwrap();
        std::fs::remove_file(&file).unwrap();
        let told: Vec<String> = findings(&folder).iter().map(ToString::to_string).collect();
        assert!(told.iter().any(|line| line.contains(name) && line.contains("is missing")), "{name}: {told:#?}");
        let mut empty = root.clone();
        empty.children.clear();
        std::fs::write(&file, empty.write()).unwrap();
        let told = errors(&findings(&folder));
        assert!(told.iter().any(|line| line.contains(&root.children[0].name)), "{name}: {told:#?}");
        std::fs::write(&file, root.write()).unwrap();
    }
    assert_eq!(errors(&findings(&folder)), [""; 0]);
}

#[test]
fn what_is_written_passes_in_both_versions() {
    let scratch = Scratch::new();
    for (name, target) in [("old", TargetVersion::V5_7_4), ("new", TargetVersion::V5_11_0)] {
        let mut scene = rich();
        if target == TargetVersion::V5_11_0 {
            scene = crate::dart_write::tetrahedron();
        }
        written(&scene, &options(target), &scratch.join(name));
        let (code, out, err) = run(&["convert", "--check", &scratch.argument(name)]);
        assert!(code == 0 && out.contains(" 0 errors"), "{out}{err}");
    }
}

#[test]
fn conditions_are_minded() {
    let scratch = Scratch::new();
    let folder = scratch.join("sim");
    written(&rich(), &options(TargetVersion::V5_7_4), &folder);
    let edits = [
        (
            "phase.xml",
            "TOAtoBOA=\"0\"",
            "TOAtoBOA=\"2\"",
            "Phase/AtmosphereRadiativeTransfer/AtmosphereRadiativeTransferOptions",
        ),
        ("directions.xml", "exactDate=\"2\"", "exactDate=\"0\"", "Directions/Sun"),
        ("maket.xml", "dartZone=\"0\"", "dartZone=\"1\"", "Maket/Scene/DartZoneProperties"),
        ("maket.xml", "createTopography=\"0\"", "createTopography=\"1\"", "Maket/Soil/DEM_properties/DEMGenerator"),
        ("trees.xml", "isTrees=\"0\"", "isTrees=\"1\"", "Trees/Trees_1"),
        (
            "plots.xml",
            "isVegetation=\"0\"",
            "isVegetation=\"1\"",
            "Plots/ImportationFichierRaster/VegetationProperties",
        ),
        (
            "object_3d.xml",
            "doubleFace=\"0\"",
            "doubleFace=\"1\"",
            "object_3d/ObjectList/Object/Groups/Group/GroupOpticalProperties/BackFaceOpticalProperty",
        ),
    ];
    for (file, from, to, path) in edits {
        let file = folder.join("input").join(file);
        let text = std::fs::read_to_string(&file).unwrap();
        edit(&file, from, to);
        let told = errors(&findings(&folder));
        assert!(told.iter().any(|line| line.contains(&format!("`{path}` is missing"))), "{path}: {told:#?}");
        // Of another version it is not known.
        for (file, _) in inputs(&folder) {
            let text = std::fs::read_to_string(&file).unwrap();
            std::fs::write(&file, text.replace("version=\"5.7.4\"", "version=\"5.9.0\"")).unwrap();
        }
        let told = errors(&findings(&folder));
        assert!(!told.iter().any(|line| line.contains(&format!("`{path}` is missing"))), "{path}: {told:#?}");
        for (file, _) in inputs(&folder) {
            let text = std::fs::read_to_string(&file).unwrap();
            std::fs::write(&file, text.replace("version=\"5.9.0\"", "version=\"5.7.4\"")).unwrap();
        }
        std::fs::write(&file, text).unwrap();
    }
}
