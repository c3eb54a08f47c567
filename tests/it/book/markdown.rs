//! As much of Markdown as the book is made of: fenced blocks with the comment before them, headings and links.

use std::path::{Path, PathBuf};

/// A fenced block of a page.
pub(crate) struct Block {
    /// What follows the opening fence: `sh`, `toml`, ...
    pub(crate) tag: String,
    /// What HTML comments right before it say, one after another.
    pub(crate) notes: Vec<String>,
    /// The line of its opening fence, from 1.
    pub(crate) line: usize,
    pub(crate) text: String,
}

impl Block {
    /// What a note says after its name and a colon.
    pub(crate) fn said(&self, name: &str) -> Option<&str> {
        self.notes.iter().find_map(|note| note.strip_prefix(name)?.strip_prefix(':')).map(str::trim)
    }

    pub(crate) fn says(&self, note: &str) -> bool {
        self.notes.iter().any(|said| said == note)
    }
}

/// A page apart: its fenced blocks, and the other lines with their numbers from 1.
pub(crate) struct Page {
    pub(crate) blocks: Vec<Block>,
    pub(crate) prose: Vec<(usize, String)>,
}

impl Page {
    pub(crate) fn of(text: &str) -> Page {
        let mut page = Page { blocks: Vec::new(), prose: Vec::new() };
        let mut notes = Vec::new();
        let mut open = false;
        for (at, line) in text.lines().enumerate() {
            let fence = line.trim_start().strip_prefix("```");
            match (fence, open) {
                (Some(tag), false) => {
                    let block = Block {
                        tag: tag.trim().to_owned(),
                        notes: std::mem::take(&mut notes),
                        line: at + 1,
                        text: String::new(),
                    };
                    page.blocks.push(block);
                    open = true;
                }
                (Some(_), true) => open = false,
                (None, true) => {
                    let text = &mut page.blocks.last_mut().unwrap().text;
                    text.push_str(line);
                    text.push('\n');
                }
                (None, false) => {
                    let note = line.trim().strip_prefix("<!--").and_then(|rest| rest.strip_suffix("-->"));
                    match note {
                        Some(note) => notes.push(note.trim().to_owned()),
                        None if line.trim().is_empty() => {}
                        None => notes.clear(),
                    }
                    page.prose.push((at + 1, line.to_owned()));
                }
            }
        }
        assert!(!open, "a block has no end");
        page
    }

    /// The anchors of the headings, as GitHub and mdBook make them of their text.
    pub(crate) fn anchors(&self) -> Vec<String> {
        let mut anchors: Vec<String> = Vec::new();
        for (_, line) in &self.prose {
            if !line.starts_with('#') {
                continue;
            }
            let slug = anchor(line.trim_start_matches('#'));
            let before = anchors.iter().filter(|a| **a == slug).count();
            anchors.push(if before == 0 { slug } else { format!("{slug}-{before}") });
        }
        anchors
    }

    /// Where links and pictures lead, with their lines.
    pub(crate) fn links(&self) -> Vec<(usize, String)> {
        let mut links = Vec::new();
        for (at, line) in &self.prose {
            let line = without_code(line);
            for (start, _) in line.match_indices("](") {
                let rest = &line[start + 2..];
                if let Some(end) = rest.find(')') {
                    links.push((*at, rest[..end].to_owned()));
                }
            }
        }
        links
    }
}

/// The anchor of a heading's text.
pub(crate) fn anchor(text: &str) -> String {
    let kept = text.trim().to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// A line without what stands between backticks: a bracket there is no link.
fn without_code(line: &str) -> String {
    line.split('`').enumerate().filter(|(i, _)| i % 2 == 0).map(|(_, part)| part).collect()
}

/// The pages below a folder, sorted.
pub(crate) fn pages_below(folder: &Path) -> Vec<PathBuf> {
    let mut pages = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages.extend(pages_below(&path));
        } else if path.extension().is_some_and(|e| e == "md") {
            pages.push(path);
        }
    }
    pages.sort();
    pages
}

#[test]
fn a_page_comes_apart() {
    let page = Page::of(
        "# A `b`: c\n\n<!-- of: site -->\n<!-- heavy -->\n```toml\nx = 1\n```\n[l](to.md#there) `[no](link)`\n```sh\n```\n",
    );
    assert_eq!(page.anchors(), ["a-b-c"]);
    assert_eq!(page.links(), [(8, "to.md#there".to_owned())]);
    let [toml, sh] = &page.blocks[..] else { panic!("two blocks") };
    assert!(toml.tag == "toml" && toml.text == "x = 1\n" && toml.line == 5);
    assert!(toml.said("of") == Some("site") && toml.says("heavy") && sh.notes.is_empty());
}
