//! STL: triangles that have nothing in common, binary (f32) or as text. Corners at one place become one vertex.

use std::path::Path;

use glam::DVec3;

use super::{LIMIT, Welded, plain};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::input::{self, InputFile, Problems};
use crate::formats::mesh_file::{MOST, MeshFile};
use crate::report::{Fate, Note};

/// Stereolithography.
pub(in crate::formats) static STL: Format = Format {
    name: "stl",
    extensions: &["stl"],
    reads: "mesh (corners at one place are one vertex)",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| {
        let length = path.metadata().map_or(0, |file| file.len());
        (is_binary(beginning, length) || is_text(beginning)).then(|| path.to_owned())
    }),
    holds: Holds::Mesh { read: |path, _| read(path) },
};

/// A header of text, and the number of triangles.
const HEAD: usize = 84;
/// A normal, three corners, and two bytes that programs use as they like.
const TRIANGLE: usize = 50;

/// Whether a file that begins so is as long as its number of triangles says. Text may begin with `solid` and binary files do, too: the length decides.
fn is_binary(beginning: &[u8], length: u64) -> bool {
    let count = beginning.get(HEAD - 4..HEAD).and_then(|bytes| Some(u32::from_le_bytes(bytes.try_into().ok()?)));
    count.is_some_and(|count| count > 0 && length == HEAD as u64 + TRIANGLE as u64 * u64::from(count))
}

fn is_text(beginning: &[u8]) -> bool {
    let text = String::from_utf8_lossy(beginning);
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let starts = |line: Option<&str>, word: &str| {
        line.and_then(|line| line.split_whitespace().next()).is_some_and(|first| first.eq_ignore_ascii_case(word))
    };
    starts(lines.next(), "solid") && starts(lines.next(), "facet")
}

/// Reads a file, in its own unit and axes.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for a file that is cut off, has no triangles, or corners that are no finite numbers.
pub(crate) fn read(path: &Path) -> Result<MeshFile> {
    let bytes = input::bytes(path, LIMIT)?;
    let input = InputFile::of(path, &bytes);
    let mut found = Found::default();
    if is_binary(&bytes, bytes.len() as u64) {
        binary(&bytes, path, &mut found)?;
    } else if is_text(&bytes) {
        text(&input::decoded(&bytes).0, path, &mut found)?;
    } else {
        let message = match bytes.get(HEAD - 4..HEAD) {
            Some(&[a, b, c, d]) => format!(
                "is neither text of STL nor as long as its {} triangles are: it may be cut off",
                u32::from_le_bytes([a, b, c, d])
            ),
            _ => "is too short for STL".to_owned(),
        };
        return Err(Error::invalid(Location::file(path), message));
    }
    let Found { welded, facets, turned, marked } = found;
    if facets.is_empty() {
        return Err(Error::invalid(Location::file(path), "has no triangles"));
    }
    let mut doubts = Vec::new();
    let mut doubt = |message: String| doubts.push(Note { fate: Fate::Defaulted, at: Location::file(path), message });
    if turned > 0 {
        let all = facets.len();
        doubt(format!(
            "the normals of {turned} of {all} triangles are on the other side of their order of corners, which is taken"
        ));
    }
    let mut file = plain(welded.vertices, facets, 1.0, input, doubts);
    if marked > 0 {
        let message = format!("the two bytes (colours, mostly) of {marked} triangles");
        file.report.note(Fate::Dropped, Location::file(path), message);
    }
    Ok(file)
}

/// What has been read.
#[derive(Default)]
struct Found {
    welded: Welded,
    facets: Vec<[u32; 3]>,
    /// Triangles whose normal says that they face the other way.
    turned: usize,
    /// Triangles with bytes of their own.
    marked: usize,
}

impl Found {
    fn add(&mut self, normal: DVec3, corners: [DVec3; 3]) {
        let [a, b, c] = corners;
        self.turned += usize::from((b - a).cross(c - a).dot(normal) < 0.0);
        self.facets.push(corners.map(|corner| self.welded.vertex(corner)));
    }
}

fn binary(bytes: &[u8], path: &Path, found: &mut Found) -> Result<()> {
    let triangles = bytes[HEAD..].chunks_exact(TRIANGLE);
    if triangles.len() > MOST {
        return Err(Error::invalid(Location::file(path), format!("has more than {MOST} triangles")));
    }
    let mut problems = Problems::default();
    for (i, triangle) in triangles.enumerate() {
        let number =
            |k: usize| f64::from(f32::from_le_bytes(triangle[4 * k..4 * k + 4].try_into().unwrap_or_default()));
        let vector = |k: usize| DVec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2));
        let corners = [vector(1), vector(2), vector(3)];
        if !corners.iter().all(|corner| corner.is_finite()) {
            let at = Location::file(path).with_item(format!("triangle {}", i + 1));
            problems.push(|| Problem::new(at, "has a corner that is not finite"));
            continue;
        }
        found.marked += usize::from(triangle[TRIANGLE - 2..] != [0, 0]);
        found.add(vector(0), corners);
    }
    problems.finish(path)
}

fn text(text: &str, path: &Path, found: &mut Found) -> Result<()> {
    let mut problems = Problems::default();
    let (mut normal, mut corners): (DVec3, Vec<DVec3>) = Default::default();
    // The line of a facet that has not ended.
    let mut begun = None;
    for (i, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let Some(first) = words.first() else { continue };
        let mut wrong = |message: String| problems.push(|| Problem::new(Location::line(path, i + 1), message));
        let vector = |words: &[&str]| -> Option<DVec3> {
            let numbers: Vec<f64> = words.iter().map(|word| word.parse().ok()).collect::<Option<_>>()?;
            Some(DVec3::from_array(numbers.try_into().ok()?)).filter(|v| v.is_finite())
        };
        match first.to_ascii_lowercase().as_str() {
            "facet" => {
                if begun.replace(i + 1).is_some() {
                    wrong("begins within another facet: `endfacet` is missing before it".to_owned());
                }
                corners.clear();
                // A normal that is not known is often `nan nan nan`: corners say it.
                normal = words.get(2..).and_then(vector).unwrap_or(DVec3::ZERO);
            }
            "vertex" => match (words.get(1..).and_then(vector), begun) {
                (Some(corner), Some(_)) => corners.push(corner),
                (None, _) => wrong("a vertex has three finite numbers".to_owned()),
                (_, None) => wrong("lies in no facet".to_owned()),
            },
            "endfacet" => match (begun.take(), &corners[..]) {
                (Some(_), [a, b, c]) => found.add(normal, [*a, *b, *c]),
                (Some(_), others) => wrong(format!("ends a facet with {} corners: it must have 3", others.len())),
                (None, _) => wrong("ends a facet that has not begun".to_owned()),
            },
            "solid" | "endsolid" | "outer" | "endloop" => {}
            other => wrong(format!("`{other}` is not a word of STL")),
        }
    }
    if let Some(line) = begun {
        problems.push(|| Problem::new(Location::line(path, line), "this facet has no end: the file may be cut off"));
    }
    problems.finish(path)
}
