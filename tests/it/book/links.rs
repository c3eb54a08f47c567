//! Links lead somewhere: to a file of the repository, and to a heading of it where they name one.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use super::markdown::{Page, pages_below};
use super::root;

/// A path without `..` and `.` in it.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => assert!(plain.pop(), "{} leaves the repository", path.display()),
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

/// What is wrong with the links of a page.
fn broken(page: &Path) -> Vec<String> {
    let mut broken = Vec::new();
    for (line, link) in Page::of(&std::fs::read_to_string(page).unwrap()).links() {
        if link.contains("://") || link.starts_with("mailto:") {
            continue;
        }
        let (file, anchor) = link.split_once('#').map_or((link.as_str(), None), |(file, anchor)| (file, Some(anchor)));
        let target = if file.is_empty() { page.to_owned() } else { plain(&page.parent().unwrap().join(file)) };
        let there = target.exists()
            && anchor.is_none_or(|anchor| {
                let text = std::fs::read_to_string(&target).unwrap_or_default();
                Page::of(&text).anchors().iter().any(|a| a == anchor)
            });
        if !there {
            broken.push(format!("{}:{line}: {link}", page.strip_prefix(root()).unwrap().display()));
        }
    }
    broken
}

#[test]
fn every_link_leads_somewhere() {
    let mut pages = pages_below(&root().join("docs"));
    for folder in ["scenes", "adapters"] {
        pages.extend(pages_below(&root().join(folder)));
    }
    pages.extend(["README.md", "CONVENTIONS.md", "ARCHITECTURE.md", "CHANGELOG.md"].map(|name| root().join(name)));
    let broken: Vec<String> = pages.iter().flat_map(|page| broken(page)).collect();
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

#[test]
fn the_summary_lists_every_page() {
    let docs = root().join("docs");
    let summary = docs.join("SUMMARY.md");
    let listed: BTreeSet<PathBuf> = Page::of(&std::fs::read_to_string(&summary).unwrap())
        .links()
        .into_iter()
        .map(|(_, link)| plain(&docs.join(link)))
        .collect();
    let missing: Vec<PathBuf> =
        pages_below(&docs).into_iter().filter(|page| *page != summary && !listed.contains(page)).collect();
    assert!(missing.is_empty() && listed.len() > 10, "docs/SUMMARY.md does not list {missing:?}");
}
