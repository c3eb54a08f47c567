//! Every block of code of README.md and of the book is run.
//!
//! Blocks of a page are run in their order in a scratch folder that looks like the repository, with this build's `mmxrt` on the path. What an HTML comment right before a
//! block says of it:
//!
//! - `<!-- file: PATH -->`: of `toml` that the page has as a file: it is written there, and a later `sh` block must name it;
//! - `<!-- of: NAME -->`: of a fragment: which base it completes, a scene of `mmxrt new` (`site`, `body`, `campaign`, `map`) or `recipe`;
//! - `<!-- without: KEY, .. -->`: what is taken out of the base first, such as the camera that the fragment replaces;
//! - `<!-- small: COMMAND OPTIONS -->`: options that are added to each `mmxrt COMMAND` of the block, to make it fast; not with `MMXRT_HEAVY=1`;
//! - `<!-- heavy -->`: it runs with `MMXRT_HEAVY=1` alone;
//! - `<!-- needs: PROGRAM -->`: it runs where this program is on the path;
//! - `<!-- not run: REASON -->`.
//!
//! Without `MMXRT_HEAVY=1` landscapes of the shipped scenes and of `mmxrt new` have few facets.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use toml::{Table, Value};

use super::markdown::{Block, Page, pages_below};
use super::root;
use crate::cli::mmxrt;
use crate::scratch::{Scratch, is_heavy};

/// What became of the blocks of a page.
#[derive(Default)]
struct Tally {
    run: usize,
    skipped: usize,
}

/// A folder that looks like the repository to those who read its pages.
fn like_the_repository() -> Scratch {
    let scratch = Scratch::new();
    for folder in ["scenes", "examples", "benches", "adapters", "schemas", "src/job/templates", "tests/data/rasters"] {
        copy(&root().join(folder), &scratch.join(folder));
    }
    std::fs::create_dir_all(scratch.join("out")).unwrap();
    for scene in ["phobos_site", "phobos_mars_side"] {
        let recipe = scratch.join("scenes").join(scene).join("site.toml");
        let text = std::fs::read_to_string(&recipe).unwrap();
        assert!(text.contains("facets = 200_000"), "{scene}");
        if !is_heavy() {
            std::fs::write(&recipe, text.replace("facets = 200_000", "facets = 4_000")).unwrap();
        }
    }
    scratch
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::copy(&path, &target).unwrap();
        }
    }
}

/// Fewer facets for the landscape that `mmxrt new` has written to `$r`.
const COARSE: &str = "if [ -f \"$r\" ]; then sed -i.all 's/^facets = .*/facets = 3_000/' \"$r\" && rm \"$r.all\"; fi";

/// A `mmxrt` for the path, which adds options to some commands, and coarser landscapes to those that it begins. Gives the folder that it is in.
fn wrapper(scratch: &Scratch, small: &[(&str, &str)]) -> PathBuf {
    let mut text = "#!/bin/sh\nset -e\ncase \"$1\" in\n".to_owned();
    let program = env!("CARGO_BIN_EXE_mmxrt");
    for (command, options) in small {
        text.push_str(&format!("{command}) exec '{program}' \"$@\" {options} ;;\n"));
    }
    if !is_heavy() {
        text.push_str(&format!("new) '{program}' \"$@\"; for f; do for r in \"$f\"/site.toml \"$f\"/ground.toml; do {COARSE}; done; done ;;\n"));
    }
    text.push_str(&format!("*) exec '{program}' \"$@\" ;;\nesac\n"));
    let folder = scratch.join(".bin");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("mmxrt");
    std::fs::write(&path, text).unwrap();
    #[cfg(unix)]
    std::fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    folder
}

/// Puts one table's items over another's.
fn merge(base: &mut Table, more: Table) {
    for (key, value) in more {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge(below, above),
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

/// The folder and the text of a base, which is made on first use.
fn base(scratch: &Scratch, name: &str) -> (PathBuf, String) {
    if name == "recipe" {
        let text = std::fs::read_to_string(root().join("src/job/templates/site.toml")).unwrap();
        return (scratch.join("out"), text);
    }
    let folder = scratch.join(".bases").join(name);
    if !folder.exists() {
        std::fs::create_dir_all(folder.parent().unwrap()).unwrap();
        let made = mmxrt().args(["new", "--quiet", "--template", name]).arg(&folder).output().unwrap();
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        // Spectra of the shipped scenes go by the names that pages use for them, as do a mesh and a texture.
        for file in ["blue_unit.csv", "red_unit.csv", "site.toml"] {
            let target = folder.join(file);
            if !target.exists() {
                std::fs::copy(root().join("scenes/phobos_site").join(file), target).unwrap();
            }
        }
        // Only whether the scene is accepted is asked, not what its ground is like.
        for recipe in ["site.toml", "ground.toml"].map(|file| folder.join(file)).iter().filter(|path| path.exists()) {
            let text = std::fs::read_to_string(recipe).unwrap();
            let coarse = text.lines().map(|line| if line.starts_with("facets = ") { "facets = 3_000" } else { line });
            std::fs::write(recipe, coarse.collect::<Vec<_>>().join("\n")).unwrap();
        }
    }
    let text = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
    (folder, text)
}

/// Asks the program about a file of its own kinds: a scene, a recipe, a campaign, a map file.
fn accepted(file: &Path, place: &str) {
    let asked = mmxrt().arg("inspect").arg(file).output().unwrap();
    assert!(asked.status.success(), "{place}: {}", String::from_utf8_lossy(&asked.stderr));
}

fn run_toml(scratch: &Scratch, block: &Block, place: &str) {
    let parsed: Table = block.text.parse().unwrap_or_else(|e| panic!("{place}: {e}"));
    if let Some(file) = block.said("file") {
        let path = scratch.join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, &block.text).unwrap();
        return;
    }
    // A fragment completes its base; a whole scene lies where the shipped ones have their spectra.
    let (folder, text) = match block.said("of") {
        Some(name) => {
            let (folder, text) = base(scratch, name);
            let mut whole: Table = text.parse().unwrap();
            for key in block.said("without").unwrap_or_default().split(',') {
                whole.remove(key.trim());
            }
            merge(&mut whole, parsed);
            (folder, toml::to_string(&whole).unwrap())
        }
        None => (scratch.join("scenes/phobos_site"), block.text.clone()),
    };
    let path = folder.join(format!("block-{}.toml", block.line));
    std::fs::write(&path, text).unwrap();
    accepted(&path, place);
}

fn run_sh(scratch: &Scratch, block: &Block, place: &str) {
    let small: Vec<(&str, &str)> = block
        .notes
        .iter()
        .filter_map(|note| note.strip_prefix("small:")?.trim().split_once(' '))
        .filter(|_| !is_heavy())
        .collect();
    let path = format!("{}:{}", wrapper(scratch, &small).display(), std::env::var("PATH").unwrap_or_default());
    let ran = Command::new("bash")
        .args(["-euo", "pipefail", "-c", &block.text])
        .current_dir(scratch.path())
        .env("PATH", path)
        .env("MMXRT", "mmxrt")
        .output()
        .unwrap();
    let says = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(ran.status.success(), "{place}: {}\n{}\n{}", ran.status, says(&ran.stdout), says(&ran.stderr));
}

/// Runs Python where the packages that it imports are there.
fn run_python(scratch: &Scratch, block: &Block, place: &str) -> bool {
    let python = std::env::var("MMXRT_TEST_PYTHON").unwrap_or_else(|_| "python3".into());
    let imports =
        block.text.lines().filter_map(|line| line.strip_prefix("import ").or_else(|| line.strip_prefix("from ")));
    let packages: Vec<&str> = imports.filter_map(|rest| rest.split([' ', '.', ';']).next()).collect();
    let there = Command::new(&python).args(["-c", &format!("import {}", packages.join(", "))]).output();
    if packages.is_empty() || !there.is_ok_and(|output| output.status.success()) {
        println!("SKIPPED: {place}: {python} has not all of {packages:?}");
        return false;
    }
    let ran = Command::new(&python).args(["-c", &block.text]).current_dir(scratch.path()).output().unwrap();
    assert!(ran.status.success(), "{place}: {}", String::from_utf8_lossy(&ran.stderr));
    true
}

fn is_on_the_path(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Runs the blocks of a page.
fn run_page(path: &Path) -> Tally {
    let name = path.strip_prefix(root()).unwrap().display().to_string();
    let page = Page::of(&std::fs::read_to_string(path).unwrap());
    let mut tally = Tally::default();
    if page.blocks.is_empty() {
        return tally;
    }
    let scratch = like_the_repository();
    let mut runnable = 0;
    for (i, block) in page.blocks.iter().enumerate() {
        let place = format!("{name}:{}", block.line);
        assert!(
            matches!(block.tag.as_str(), "sh" | "toml" | "python" | "py" | "text"),
            "{place}: a block of `{}` is neither run (`sh`, `toml`, `python`, and `py` by the tests of the Python package) nor `text`",
            block.tag
        );
        // The module that `py` wants is built by tests of its own, which run these blocks.
        if matches!(block.tag.as_str(), "text" | "py") {
            continue;
        }
        runnable += 1;
        if let Some(reason) = block.said("not run") {
            println!("not run: {place}: {reason}");
            tally.skipped += 1;
            continue;
        }
        if let Some(program) = block.said("needs").filter(|program| !is_on_the_path(program)) {
            println!("SKIPPED: {place}: {program} is not there");
            tally.skipped += 1;
            continue;
        }
        if block.says("heavy") && !is_heavy() {
            println!("SKIPPED: {place}: without MMXRT_HEAVY=1");
            tally.skipped += 1;
            continue;
        }
        if let Some(file) = block.said("file") {
            let file_name = Path::new(file).file_name().unwrap().to_str().unwrap();
            let used = page.blocks[i..].iter().any(|later| later.tag == "sh" && later.text.contains(file_name));
            assert!(used, "{place}: no command after it uses {file}");
        }
        let began = std::time::Instant::now();
        let ran = match block.tag.as_str() {
            "toml" => {
                run_toml(&scratch, block, &place);
                true
            }
            "sh" => {
                run_sh(&scratch, block, &place);
                true
            }
            _ => run_python(&scratch, block, &place),
        };
        if ran {
            tally.run += 1;
            println!("{place}: {:.1} s", began.elapsed().as_secs_f64());
        } else {
            tally.skipped += 1;
        }
    }
    assert!(runnable == 0 || tally.run > 0, "{name}: none of its {runnable} blocks is run");
    println!("{name}: {} blocks run, {} skipped", tally.run, tally.skipped);
    tally
}

/// The parts of the book, each of which is a test of its own, so that they run side by side.
fn part_of(page: &Path) -> &'static str {
    let name = page.strip_prefix(root()).unwrap();
    if name == Path::new("README.md") || name.starts_with("docs/tutorial") {
        "tutorial"
    } else if name.starts_with("docs/howto") {
        "howto"
    } else {
        "rest"
    }
}

fn run_part(part: &str) {
    if !is_on_the_path("bash") {
        println!("SKIPPED: there is no bash");
        return;
    }
    let mut pages = pages_below(&root().join("docs"));
    pages.push(root().join("README.md"));
    let mut tallies: BTreeMap<PathBuf, Tally> = BTreeMap::new();
    for page in pages.into_iter().filter(|page| part_of(page) == part) {
        let tally = run_page(&page);
        tallies.insert(page, tally);
    }
    let run: usize = tallies.values().map(|tally| tally.run).sum();
    assert!(run > 0, "no block of {part} is run");
}

#[test]
fn blocks_of_the_readme_and_the_tutorial_run() {
    run_part("tutorial");
}

#[test]
fn blocks_of_the_how_to_pages_run() {
    run_part("howto");
}

#[test]
fn blocks_of_the_other_pages_run() {
    run_part("rest");
}
