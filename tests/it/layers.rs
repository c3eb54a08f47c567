//! The library's layers: a module uses only those above it in the list of src/lib.rs.

use std::path::{Path, PathBuf};

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The library's modules, lowest layer first.
fn modules() -> Vec<String> {
    let text = std::fs::read_to_string(source().join("lib.rs")).unwrap();
    text.lines().filter_map(|line| Some(line.strip_prefix("pub mod ")?.strip_suffix(';')?.to_owned())).collect()
}

/// One source file.
struct File {
    path: PathBuf,
    /// Its module: the names that lead there from the top of the library.
    place: Vec<String>,
    /// Its code, without comments and unit tests.
    code: String,
}

/// All files below `folder`, in order.
fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_below(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// The library's files: not lib.rs, which is the list, nor the binary's.
fn files() -> Vec<File> {
    let mut paths = Vec::new();
    files_below(&source(), &mut paths);
    paths
        .into_iter()
        .filter_map(|path| {
            let names = path.strip_prefix(source()).unwrap().with_extension("");
            let mut place: Vec<String> = names.iter().map(|n| n.to_str().unwrap().to_owned()).collect();
            if place.last().is_some_and(|n| n == "mod") {
                place.pop();
            }
            let of_library = !["lib", "main", "cli"].contains(&place[0].as_str());
            let text = std::fs::read_to_string(&path).unwrap();
            of_library.then(|| File { place, code: code(&text), path })
        })
        .collect()
}

/// What is compiled into the library: no comments, no unit tests (which come last in a file).
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

/// What the code of the file at `place` names by `crate::` and `super::`, each as a path from the top of the library.
fn paths(code: &str, place: &[String]) -> Vec<Vec<String>> {
    let mut paths = Vec::new();
    for start in ["crate::", "super::"].iter().flat_map(|s| code.match_indices(s)).map(|(start, _)| start) {
        // Further on in a path, or the end of another word.
        if !code[..start].ends_with(|c: char| c == ':' || c == '_' || c.is_alphanumeric()) {
            branches(&code[start..], &[], &mut paths);
        }
    }
    for path in &mut paths {
        let above = path.iter().take_while(|name| *name == "super").count();
        let rest = path.split_off(if above == 0 { 1 } else { above });
        *path = if above == 0 { rest } else { [&place[..place.len() - above], &rest].concat() };
    }
    paths
}

/// Adds the paths that a tree such as `a::{b, c::d}` holds to `paths`, each behind `before`; what follows the tree.
fn branches<'c>(tree: &'c str, before: &[String], paths: &mut Vec<Vec<String>>) -> &'c str {
    let tree = tree.trim_start();
    if let Some(mut rest) = tree.strip_prefix('{') {
        loop {
            rest = rest.trim_start_matches(|c: char| c == ',' || c.is_whitespace());
            let after = branches(rest, before, paths);
            if after.len() == rest.len() {
                return after.strip_prefix('}').unwrap_or(after);
            }
            rest = after.split_once([',', '}']).map_or("", |(renamed, _)| &after[renamed.len()..]);
        }
    }
    let (name, rest) = tree.split_at(tree.find(|c: char| c != '_' && !c.is_alphanumeric()).unwrap_or(tree.len()));
    if name.is_empty() {
        return tree;
    }
    let path = [before, &[name.to_owned()]].concat();
    match rest.strip_prefix("::") {
        Some(rest) => branches(rest, &path, paths),
        None => {
            paths.push(path);
            rest
        }
    }
}

#[test]
fn paths_are_found() {
    let code = "use crate::error::Error;\nuse crate::{a, b::{c as x, d}, e::*,};\nlet x = super::super::f::g(super::h) / supercrate::i;";
    let place = ["p".to_owned(), "q".to_owned()];
    let found: Vec<String> = paths(code, &place).iter().map(|path| path.join(" ")).collect();
    assert_eq!(found, ["error Error", "a", "b c", "b d", "f g", "p h"]);
}

#[test]
fn a_module_uses_only_those_above_it() {
    let modules = modules();
    assert!(modules.len() >= 10, "{modules:?}");
    let layer = |name: &str| modules.iter().position(|m| m == name);
    let files = files();
    let mut uses = 0;
    let mut violations = Vec::new();
    for file in &files {
        let module = &file.place[0];
        let mine = layer(module).unwrap_or_else(|| panic!("{module} is not in lib.rs"));
        for used in paths(&file.code, &file.place).into_iter().filter_map(|path| path.into_iter().next()) {
            // What is not a module is one of the names that lib.rs takes from `error`, the lowest.
            let Some(theirs) = layer(&used) else {
                assert!(["Error", "Location", "Problem", "Result"].contains(&used.as_str()), "crate::{used}");
                continue;
            };
            uses += 1;
            let strangers = module == "formats" && ["solve", "integrate"].contains(&used.as_str());
            if theirs > mine || strangers {
                violations.push(format!("{}: {module} must not use {used}", file.path.display()));
            }
        }
    }
    assert!(violations.is_empty(), "{violations:#?}");
    assert!(files.len() >= 50 && uses >= 100, "{} files, {uses} uses", files.len());
    for module in &modules {
        assert!(files.iter().any(|f| f.place[0] == *module), "no file of {module}");
    }
}

/// An image asks what facets send, and nothing else of what was solved.
#[test]
fn integrate_knows_of_solve_what_facets_send() {
    let asked = ["Emission", "Fragment", "Modulation", "ImagePart"];
    let mut seen = 0;
    for file in files().iter().filter(|file| file.place[0] == "integrate") {
        for path in paths(&file.code, &file.place).iter().filter(|path| path[0] == "solve") {
            assert!(path.get(1).is_some_and(|name| asked.contains(&name.as_str())), "{:?}: {path:?}", file.place);
            seen += 1;
        }
    }
    assert!(seen >= 4, "{seen}");
}

/// Circles that are left, as the files in them, and why.
const CIRCLES: [(&[&str], &str); 0] = [];

#[test]
fn files_do_not_use_each_other_in_circles() {
    let files = files();
    let place_of =
        |path: &[String]| (1..=path.len()).rev().find_map(|n| files.iter().position(|f| f.place == path[..n]));
    // A folder's own file gathers those below it, and these may use what stands there.
    let is_within = |a: &[String], b: &[String]| a.starts_with(b) || b.starts_with(a);
    let uses_of = |file: &File| -> Vec<usize> {
        let used = paths(&file.code, &file.place).into_iter().filter_map(|path| place_of(&path));
        used.filter(|used| !is_within(&files[*used].place, &file.place)).collect()
    };
    let uses: Vec<Vec<usize>> = files.iter().map(uses_of).collect();
    let reached_from = |start: usize| {
        let (mut is_reached, mut next) = (vec![false; files.len()], uses[start].clone());
        while let Some(file) = next.pop() {
            if !std::mem::replace(&mut is_reached[file], true) {
                next.extend(&uses[file]);
            }
        }
        is_reached
    };
    let reached: Vec<Vec<bool>> = (0..files.len()).map(reached_from).collect();
    let mut circles: Vec<Vec<String>> = (0..files.len())
        .filter(|file| reached[*file][*file])
        .map(|a| {
            (0..files.len()).filter(|b| reached[a][*b] && reached[*b][a]).map(|b| files[b].place.join("/")).collect()
        })
        .collect();
    circles.sort();
    circles.dedup();
    assert_eq!(circles, CIRCLES.map(|(circle, _)| circle.to_vec()));
    assert!(uses.iter().map(Vec::len).sum::<usize>() >= 1000);
}

#[test]
fn only_formats_touches_the_world() {
    let forbidden = [
        "std::fs",
        "std::env",
        "std::process",
        "std::io::stdout",
        "std::io::stderr",
        "print!(",
        "println!(",
        "Instant::now",
        "SystemTime",
    ];
    let (mut seen, mut in_formats) = (0, 0);
    for file in files() {
        let found: Vec<_> = forbidden.iter().filter(|f| file.code.contains(**f)).collect();
        if file.place[0] == "formats" {
            in_formats += found.len();
        } else {
            seen += 1;
            assert!(found.is_empty(), "{}: {found:?}", file.path.display());
        }
    }
    // `formats` does touch the disk: a search that finds nothing there finds nothing anywhere.
    assert!(seen >= 40 && in_formats >= 5, "{seen} files, {in_formats} in formats");
}

#[test]
fn the_command_line_writes_nothing_itself() {
    let forbidden = ["std::fs", "File::", "Staged", ".read_dir(", "solve::solve(", "study::observe", "::write("];
    let mut paths = Vec::new();
    files_below(&source().join("cli"), &mut paths);
    let mut jobs = 0;
    for path in &paths {
        let code = code(&std::fs::read_to_string(path).unwrap());
        let found: Vec<_> = forbidden.iter().filter(|f| code.contains(**f)).collect();
        assert!(found.is_empty(), "{}: {found:?}", path.display());
        jobs += code.matches("job::").count();
    }
    // What it has done instead.
    assert!(paths.len() >= 8 && jobs >= 8, "{} files, {jobs} jobs", paths.len());
}
