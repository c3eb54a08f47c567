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
    /// The module of the library that it belongs to.
    module: String,
    /// How many `super::` lead from it to the top of the library.
    depth: usize,
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
            let place = path.strip_prefix(source()).unwrap().with_extension("");
            let mut names: Vec<String> = place.iter().map(|n| n.to_str().unwrap().to_owned()).collect();
            if names.last().is_some_and(|n| n == "mod") {
                names.pop();
            }
            let module = names[0].clone();
            let of_library = !["lib", "main", "cli"].contains(&module.as_str());
            let text = std::fs::read_to_string(&path).unwrap();
            of_library.then(|| File { module, depth: names.len(), code: code(&text), path })
        })
        .collect()
}

/// What is compiled into the library: no comments, no unit tests (which come last in a file).
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

/// The names that follow `crate::`, or as many `super::` as lead there, at the top of the library.
fn used_at_the_top(code: &str, depth: usize) -> Vec<String> {
    let code = code.replace(&"super::".repeat(depth), "crate::");
    let name =
        |text: &str| -> String { text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect() };
    let mut names = Vec::new();
    for after in code.split("crate::").skip(1) {
        let Some(list) = after.strip_prefix('{') else {
            names.push(name(after));
            continue;
        };
        let mut level = 0;
        let mut start = 0;
        for (i, c) in list.char_indices() {
            match c {
                '{' => level += 1,
                '}' if level > 0 => level -= 1,
                ',' | '}' if level == 0 => {
                    names.push(name(&list[start..i]));
                    start = i + 1;
                    if c == '}' {
                        break;
                    }
                }
                _ => {}
            }
        }
    }
    names.retain(|n| !n.is_empty());
    names
}

#[test]
fn names_at_the_top_are_found() {
    let code = "use crate::error::Error;\nuse crate::{a, b::{c, d}, e,};\nlet x = super::super::f::g(super::h);";
    assert_eq!(used_at_the_top(code, 2), ["error", "a", "b", "e", "f"]);
    assert_eq!(used_at_the_top("use super::x;", 1), ["x"]);
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
        let mine = layer(&file.module).unwrap_or_else(|| panic!("{} is not in lib.rs", file.module));
        for used in used_at_the_top(&file.code, file.depth) {
            // What is not a module is one of the names that lib.rs takes from `error`, the lowest.
            let Some(theirs) = layer(&used) else {
                assert!(["Error", "Location", "Problem", "Result"].contains(&used.as_str()), "crate::{used}");
                continue;
            };
            uses += 1;
            let strangers = file.module == "formats" && ["solve", "integrate"].contains(&used.as_str());
            if theirs > mine || strangers {
                violations.push(format!("{}: {} must not use {used}", file.path.display(), file.module));
            }
        }
    }
    assert!(violations.is_empty(), "{violations:#?}");
    assert!(files.len() >= 50 && uses >= 100, "{} files, {uses} uses", files.len());
    for module in &modules {
        assert!(files.iter().any(|f| f.module == *module), "no file of {module}");
    }
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
        if file.module == "formats" {
            in_formats += found.len();
        } else {
            seen += 1;
            assert!(found.is_empty(), "{}: {found:?}", file.path.display());
        }
    }
    // `formats` does touch the disk: a search that finds nothing there finds nothing anywhere.
    assert!(seen >= 40 && in_formats >= 5, "{seen} files, {in_formats} in formats");
}
