//! Shape models of bodies as text: tables of vertices and plates (`.tab`, as PDS has them), and implicitly connected quadrilaterals (ICQ). In km.

use std::path::Path;

use glam::DVec3;

use super::{KM_M, LIMIT, Welded, plain};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::input::{self, Problems};
use crate::formats::mesh_file::{MOST, MeshFile};
use crate::geometry::index_u32;
use crate::report::{Fate, Note};

/// Tables of vertices and plates.
pub(in crate::formats) static TAB: Format = Format {
    name: "tab",
    // Spectra are called `.tab` too: what is in it decides.
    extensions: &[],
    reads: "shape of a body: vertices and plates, km",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| is_table(&String::from_utf8_lossy(beginning)).then(|| path.to_owned())),
    holds: Holds::Mesh { read: |path, _| read_table(path) },
};

/// Six faces of a cube with (Q + 1)^2 vertices each, as stereophotoclinometry makes them (Gaskell et al. 2008, Meteorit. Planet. Sci. 43).
pub(in crate::formats) static ICQ: Format = Format {
    name: "icq",
    extensions: &["icq"],
    reads: "shape of a body: implicitly connected quadrilaterals, km",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| is_quadrilaterals(path, &String::from_utf8_lossy(beginning)).then(|| path.to_owned())),
    holds: Holds::Mesh { read: |path, _| read_quadrilaterals(path) },
};

/// Numbers of a line; `None` if it has something else in it.
fn numbers(line: &str) -> Option<Vec<f64>> {
    // FORTRAN writes exponents as D.
    let number = |word: &str| word.parse().or_else(|_| word.replace(['D', 'd'], "e").parse()).ok();
    line.split([' ', '\t', ',']).filter(|word| !word.is_empty()).map(number).collect()
}

/// The whole number that a number is.
fn whole(x: f64) -> Option<usize> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "compared with what it came from")]
    let n = x as usize;
    (x >= 0.0 && n as f64 == x && n <= MOST).then_some(n)
}

/// The first two lines with something in them: how many there are of something, then the first vertex.
fn head(text: &str) -> Option<[Vec<f64>; 2]> {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    Some([numbers(lines.next()?)?, numbers(lines.next()?)?])
}

fn is_table(beginning: &str) -> bool {
    let Some([counts, first]) = head(beginning) else { return false };
    let counts: Option<Vec<usize>> = counts.iter().map(|n| whole(*n)).collect();
    let is_counted = counts.is_some_and(|counts| matches!(counts[..], [n] | [n, _] if n >= 3));
    is_counted && first.len() == 4 && first[0] == 1.0
}

fn is_quadrilaterals(path: &Path, beginning: &str) -> bool {
    let Some([counts, first]) = head(beginning) else { return false };
    let is_named = crate::formats::format::ending(path) == "icq";
    is_named && matches!(counts[..], [q] if whole(q).is_some_and(|q| q > 0)) && first.len() == 3
}

/// A line of the file, its number from 1, and its numbers.
struct Row {
    line: usize,
    numbers: Vec<f64>,
}

/// The rows of a text that is numbers all over.
fn rows(text: &str, path: &Path) -> Result<Vec<Row>> {
    let mut problems = Problems::default();
    let mut rows = Vec::new();
    for (i, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        match numbers(line) {
            Some(numbers) => rows.push(Row { line: i + 1, numbers }),
            None => problems.push(|| Problem::new(Location::line(path, i + 1), "is not a row of numbers")),
        }
    }
    problems.finish(path)?;
    Ok(rows)
}

/// The three numbers of a row of a list; before them its place in the list, from 1, if the list's rows have four numbers.
fn three(row: &Row, is_numbered: bool, place: usize) -> Option<[f64; 3]> {
    match (is_numbered, &row.numbers[..]) {
        (false, [x, y, z]) => Some([*x, *y, *z]),
        (true, [number, x, y, z]) if whole(*number) == Some(place) => Some([*x, *y, *z]),
        _ => None,
    }
}

/// The vertices of rows, of which all have their numbers before them, or none.
fn vertices_of(rows: &[Row], path: &Path, problems: &mut Problems) -> Vec<DVec3> {
    let is_numbered = rows.first().is_some_and(|row| row.numbers.len() == 4);
    let vertex = |(i, row): (usize, &Row)| {
        let p = three(row, is_numbered, i + 1).map_or(DVec3::NAN, DVec3::from_array);
        if !p.is_finite() {
            let number = if is_numbered { format!("{}, and ", i + 1) } else { String::new() };
            let message = format!("must be a vertex: {number}three finite coordinates");
            problems.push(|| Problem::new(Location::line(path, row.line), message));
        }
        p
    };
    rows.iter().enumerate().map(vertex).collect()
}

/// What a reader of the mesh should know.
fn unit(path: &Path) -> Note {
    Note { fate: Fate::Defaulted, at: Location::file(path), message: "unit: km, as shapes of bodies have".to_owned() }
}

/// Reads a table of vertices and plates: a line with their numbers (or one before each of the two lists), then `i x y z`, then `i a b c`, which count vertices from 1.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] line by line: for rows that are not what they should be, plates of vertices that there are none of, and a file that is cut off.
pub(crate) fn read_table(path: &Path) -> Result<MeshFile> {
    let (text, input) = input::text(path, LIMIT)?;
    let rows = rows(&text, path)?;
    let at = |row: Option<&Row>| row.map_or_else(|| Location::file(path), |row| Location::line(path, row.line));
    let count = |row: Option<&Row>, k: usize| row.and_then(|row| row.numbers.get(k)).and_then(|n| whole(*n));
    let first = rows.first();
    let Some(vertices) = count(first, 0) else {
        return Err(Error::invalid(at(first), "must be the number of vertices, and of plates"));
    };
    let after = 1 + vertices;
    // The number of plates is beside that of vertices, or behind them.
    let (plates, begin) = match first.map(|row| row.numbers.len()) {
        Some(2) => (count(first, 1), after),
        _ => (count(rows.get(after).filter(|row| row.numbers.len() == 1), 0), after + 1),
    };
    let Some(plates) = plates.filter(|plates| begin + plates <= rows.len()) else {
        let message =
            format!("{vertices} vertices, and then plates: there are {} rows; the file may be cut off", rows.len());
        return Err(Error::invalid(Location::file(path), message));
    };
    let mut problems = Problems::default();
    let points = vertices_of(&rows[1..after], path, &mut problems);
    let mut facets = Vec::with_capacity(plates);
    let is_numbered = rows.get(begin).is_some_and(|row| row.numbers.len() == 4);
    for (i, row) in rows[begin..begin + plates].iter().enumerate() {
        let corners = three(row, is_numbered, i + 1)
            .map_or([None; 3], |corners| corners.map(|n| whole(n).filter(|n| (1..=vertices).contains(n))));
        match corners {
            [Some(a), Some(b), Some(c)] => facets.push([a, b, c].map(|n| index_u32(n - 1))),
            _ => problems.push(|| {
                Problem::new(
                    Location::line(path, row.line),
                    format!("must be a plate: three vertices from 1 to {vertices}"),
                )
            }),
        }
    }
    if let Some(row) = rows.get(begin + plates) {
        problems.push(|| Problem::new(Location::line(path, row.line), format!("follows the last of {plates} plates")));
    }
    problems.finish(path)?;
    if facets.is_empty() {
        return Err(Error::invalid(Location::file(path), "has no plates"));
    }
    Ok(plain(points, facets, KM_M, input, vec![unit(path)]))
}

/// Reads implicitly connected quadrilaterals: Q, then six faces of (Q + 1) x (Q + 1) vertices. Vertices at one place on the edges of faces are one; each quadrilateral is cut by its shorter
/// diagonal, and facets are turned outwards.
///
/// # Errors
/// As [`read_table`].
pub(crate) fn read_quadrilaterals(path: &Path) -> Result<MeshFile> {
    let (text, input) = input::text(path, LIMIT)?;
    let rows = rows(&text, path)?;
    let q = rows.first().and_then(|row| matches!(row.numbers.len(), 1).then(|| whole(row.numbers[0])).flatten());
    let Some(q) = q.filter(|q| *q > 0 && 12 * q * q <= MOST) else {
        return Err(Error::invalid(
            Location::line(path, 1),
            "must be Q, the number of quadrilaterals along a face's edge",
        ));
    };
    let width = q + 1;
    let wanted = 6 * width * width;
    if rows.len() != 1 + wanted {
        let message =
            format!("Q = {q} has {wanted} vertices, and there are {}: the file may be cut off", rows.len() - 1);
        return Err(Error::invalid(Location::file(path), message));
    }
    let (mut problems, mut welded) = (Problems::default(), Welded::default());
    let points = vertices_of(&rows[1..], path, &mut problems);
    problems.finish(path)?;
    let numbers: Vec<u32> = points.iter().map(|point| welded.vertex(*point)).collect();
    let mut facets = Vec::with_capacity(12 * q * q);
    for face in 0..6 {
        for j in 0..q {
            for i in 0..q {
                let corner = |di: usize, dj: usize| numbers[face * width * width + (j + dj) * width + i + di];
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                let length = |a: u32, b: u32| welded.vertices[a as usize].distance_squared(welded.vertices[b as usize]);
                let pair = if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                // Where quadrilaterals of two faces meet in a corner, nothing is left of one.
                facets.extend(pair.into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
            }
        }
    }
    let mut doubts = vec![unit(path)];
    // A closed body's vertices are 6 Q^2 + 2.
    if welded.vertices.len() != 6 * q * q + 2 {
        let message = format!(
            "the edges of its faces do not fit together: {} vertices, where a closed body has {}",
            welded.vertices.len(),
            6 * q * q + 2
        );
        doubts.push(Note { fate: Fate::Defaulted, at: Location::file(path), message });
    }
    let mut file = plain(welded.vertices, facets, KM_M, input, doubts);
    let mesh = &mut file.surface.mesh;
    if mesh.enclosed_m3().is_some_and(|volume| volume < 0.0) {
        mesh.flip();
    }
    Ok(file)
}
