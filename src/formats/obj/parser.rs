//! The statements of an OBJ text.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::ObjFile;
use super::faces::{Faces, NO_TEXTURE};
use super::materials::Materials;
use super::number::{decimal, digits_of, integer};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::input::Problems;
use crate::formats::mtl::ObjMaterial;
use crate::geometry::NO_UV;

/// Faces with more corners are refused: cutting ears off takes a time that grows with their square.
const CORNERS: usize = 1000;
/// As many kinds of statements are passed over by name: a file that is no OBJ at all must not fill the memory with its words.
const IGNORED: usize = 20;

/// Where a statement is: byte range and line number (from 1).
#[derive(Debug, Clone, Copy)]
struct Place {
    start: usize,
    end: usize,
    line: usize,
}

pub(super) struct Parser<'a> {
    path: PathBuf,
    /// The materials of a `mtllib` name.
    load_mtl: &'a mut dyn FnMut(&str) -> Result<Vec<ObjMaterial>>,
    vertices: Vec<DVec3>,
    texture_vertices: Vec<[f64; 2]>,
    faces: Faces,
    materials: Materials,
    objects: usize,
    ignored: BTreeMap<String, usize>,
    problems: Problems,
    /// Lines so far.
    line: usize,
    /// The statement so far that goes on in the next line, and where it began.
    continued: Option<(Vec<u8>, Place)>,
    /// The material of the faces that come.
    material: Option<u16>,
    /// What the last `g` said, and where, until a face follows.
    group: Option<(String, Place)>,
    /// Corners of the face at hand.
    corners: Vec<u32>,
    /// Their texture coordinates.
    texture: Vec<u32>,
    /// Indices that were beyond the vertices known so far, and where.
    forward: Vec<(u32, Place)>,
    /// The same of texture coordinates.
    forward_texture: Vec<(u32, Place)>,
}

impl<'a> Parser<'a> {
    pub(super) fn new(path: &Path, load_mtl: &'a mut dyn FnMut(&str) -> Result<Vec<ObjMaterial>>) -> Self {
        Parser {
            path: path.to_owned(),
            load_mtl,
            vertices: Vec::new(),
            texture_vertices: Vec::new(),
            faces: Faces::default(),
            materials: Materials::default(),
            objects: 0,
            ignored: BTreeMap::new(),
            problems: Problems::default(),
            line: 0,
            continued: None,
            material: None,
            group: None,
            corners: Vec::new(),
            texture: Vec::new(),
            forward: Vec::new(),
            forward_texture: Vec::new(),
        }
    }

    /// The number of the line that comes, from 1.
    pub(super) fn next_line(&self) -> usize {
        self.line + 1
    }

    /// Takes whole lines; `offset` is where they are in the file.
    pub(super) fn lines(&mut self, text: &[u8], offset: usize) {
        let mut start = 0;
        while start < text.len() {
            let rest = &text[start..];
            if let Some(length) = self.common(rest) {
                start += length;
                continue;
            }
            let length = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
            let line = match &rest[..length] {
                [line @ .., b'\r'] => line,
                line => line,
            };
            self.line += 1;
            let place = Place { start: offset + start, end: offset + start + line.len(), line: self.line };
            match (line.split_last(), self.continued.take()) {
                (Some((b'\\', part)), None) => self.continued = Some(([part, b" "].concat(), place)),
                (Some((b'\\', part)), Some((mut joined, first))) => {
                    joined.extend_from_slice(part);
                    joined.push(b' ');
                    self.continued = Some((joined, first));
                }
                (_, None) => self.statement(line, place),
                (_, Some((mut joined, first))) => {
                    joined.extend_from_slice(line);
                    self.statement(&joined, first);
                }
            }
            start += length + 1;
        }
    }

    /// Takes the line at the start if it is what nearly all are: `v` or `f` with three numbers that can be used. Gives its length.
    #[inline]
    fn common(&mut self, text: &[u8]) -> Option<usize> {
        if self.continued.is_some() {
            return None;
        }
        let length = match text.first() {
            Some(b'v') => {
                let finite = |text: &[u8]| decimal(text).filter(|(value, _)| value.is_finite());
                let (xyz, length) = three(text, finite)?;
                self.vertices.push(DVec3::from_array(xyz));
                length
            }
            Some(b'f') => {
                let material = self.material.filter(|_| self.group.is_none())?;
                let known = self.vertices.len() as i64;
                let vertex = |text: &[u8]| {
                    let (index, n) = digits_of(text);
                    (n > 0 && 0 < index && index <= known).then_some(((index - 1) as u32, n))
                };
                let (corners, length) = three(text, vertex)?;
                self.faces.push_triangle(corners, material);
                length
            }
            _ => return None,
        };
        self.line += 1;
        Some(length)
    }

    fn statement(&mut self, line: &[u8], place: Place) {
        match line {
            [b'v', b' ' | b'\t', rest @ ..] => self.vertex(rest, place),
            [b'f', b' ' | b'\t', rest @ ..] => self.face(rest, place),
            _ => self.other(line, place),
        }
    }

    fn other(&mut self, line: &[u8], place: Place) {
        let (keyword, rest) = word(line);
        match keyword {
            b"v" => self.vertex(rest, place),
            b"f" => self.face(rest, place),
            b"vt" => self.texture_vertex(rest, place),
            b"usemtl" => _ = self.use_material(&text(rest), place),
            b"mtllib" => self.libraries(&text(rest), place),
            b"g" => self.group = Some((text(rest), place)),
            b"o" => self.objects += 1,
            b"" | b"vn" | b"s" => {}
            _ if keyword[0] == b'#' => {}
            _ => {
                let key = if self.ignored.len() < IGNORED { shown(keyword) } else { "...".into() };
                *self.ignored.entry(key).or_default() += 1;
            }
        }
    }

    fn vertex(&mut self, mut rest: &[u8], place: Place) {
        let mut xyz = [0.0; 3];
        for (axis, x) in xyz.iter_mut().enumerate() {
            rest = skip_blanks(rest);
            match decimal(rest) {
                Some((value, n)) if value.is_finite() && rest.get(n).is_none_or(|b| is_blank(*b)) => {
                    *x = value;
                    rest = &rest[n..];
                }
                _ => {
                    let axis = ["x", "y", "z"][axis];
                    let found = shown(word(rest).0);
                    self.problem(place, || match found.as_str() {
                        "" => format!("the vertex has no {axis}"),
                        _ => format!("{axis} of the vertex is `{found}`: not a finite number"),
                    });
                    // The vertex keeps its place, or every later index would be wrong too.
                    break;
                }
            }
        }
        self.vertices.push(DVec3::from_array(xyz));
    }

    fn texture_vertex(&mut self, mut rest: &[u8], place: Place) {
        let mut uv = [0.0; 2];
        for (axis, x) in uv.iter_mut().enumerate() {
            rest = skip_blanks(rest);
            match decimal(rest) {
                Some((value, n)) if value.is_finite() && rest.get(n).is_none_or(|b| is_blank(*b)) => {
                    *x = value;
                    rest = &rest[n..];
                }
                // v may be left out, and is 0 then.
                None if axis == 1 && rest.is_empty() => {}
                _ => {
                    let found = shown(word(rest).0);
                    let axis = ["u", "v"][axis];
                    self.problem(place, || {
                        format!("{axis} of the texture coordinates is `{found}`: not a finite number")
                    });
                    break;
                }
            }
        }
        self.texture_vertices.push(uv);
    }

    fn face(&mut self, mut rest: &[u8], place: Place) {
        self.corners.clear();
        self.texture.clear();
        let known = self.vertices.len() as i64;
        loop {
            rest = skip_blanks(rest);
            if rest.first().is_none_or(|b| *b == b'#') {
                break;
            }
            let Some((index, texture, after)) = corner(rest) else {
                let found = shown(word(rest).0);
                return self.problem(place, || format!("`{found}` is not a corner of a face (a, a/b, a//c or a/b/c)"));
            };
            rest = after;
            let vertex = if index > 0 { index - 1 } else { known + index };
            if index == 0 || !(0..i64::from(u32::MAX)).contains(&vertex) {
                return self.problem(place, || match index {
                    0 => "vertex index 0: indices count from 1".into(),
                    _ => format!("vertex index {index}: {known} vertices come before this face"),
                });
            }
            if vertex >= known {
                self.forward.push((vertex as u32, place));
            }
            self.corners.push(vertex as u32);
            let known = self.texture_vertices.len() as i64;
            let texture = match texture {
                None => NO_TEXTURE,
                Some(index) => {
                    let at = if index > 0 { index - 1 } else { known + index };
                    if index == 0 || !(0..i64::from(NO_TEXTURE)).contains(&at) {
                        return self.problem(place, || match index {
                            0 => "texture index 0: indices count from 1".into(),
                            _ => format!("texture index {index}: {known} texture coordinates come before this face"),
                        });
                    }
                    if at >= known {
                        self.forward_texture.push((at as u32, place));
                    }
                    at as u32
                }
            };
            self.texture.push(texture);
        }
        let n = self.corners.len();
        if !(3..=CORNERS).contains(&n) {
            return self.problem(place, || match n {
                0..3 => format!("a face of {n} corners has no area: a face needs at least 3"),
                _ => format!("a face of {n} corners: cut it into faces of at most {CORNERS}"),
            });
        }
        let material = self.material.unwrap_or_else(|| self.use_material("", place));
        if let Some((name, place)) = self.group.take()
            && !self.faces.use_group(&name)
        {
            self.problem(place, || "more groups than can be told apart: give several of them one name".into());
        }
        self.faces.push(&self.corners, &self.texture, material);
    }

    /// Makes this the material of the faces that come.
    fn use_material(&mut self, name: &str, place: Place) -> u16 {
        let index = self.materials.index(name).unwrap_or_else(|| {
            self.problem(place, || format!("more than {} materials: give several of them one name", Materials::MOST));
            0
        });
        self.material = Some(index);
        index
    }

    fn libraries(&mut self, names: &str, place: Place) {
        // Blanks part names, and also occur in them.
        let whole = (self.load_mtl)(names);
        let libraries = match whole {
            Err(Error::Io { .. }) if names.contains(char::is_whitespace) => {
                names.split_whitespace().map(|name| (name, (self.load_mtl)(name))).collect()
            }
            whole => vec![(names, whole)],
        };
        for (name, library) in libraries {
            match library {
                Ok(materials) => {
                    for material in materials {
                        if !self.materials.define(&material) {
                            let name = material.name;
                            self.problem(place, || format!("material `{name}` is defined twice, with two colours"));
                        }
                    }
                }
                Err(Error::Invalid(problems)) => problems.into_iter().for_each(|p| self.problems.push(|| p)),
                Err(Error::Io { path, source, .. }) => self.problem(place, || {
                    format!(
                        "material file `{name}` cannot be read ({}: {source}): put it beside the OBJ file, or delete this line",
                        path.display()
                    )
                }),
                Err(error) => self.problem(place, || error.to_string()),
            }
        }
    }

    fn problem(&mut self, place: Place, message: impl FnOnce() -> String) {
        let path = &self.path;
        self.problems.push(|| {
            let at = Location { span: Some((place.start, place.end)), ..Location::line(path, place.line) };
            Problem::new(at, message())
        });
    }

    /// The file, once all its lines were taken.
    pub(super) fn finish(mut self) -> Result<ObjFile> {
        if let Some((joined, place)) = self.continued.take() {
            self.statement(&joined, place);
        }
        let (vertices, facets) = (self.vertices.len(), self.faces.facets.len());
        for (vertex, place) in std::mem::take(&mut self.forward) {
            if vertex as usize >= vertices {
                self.problem(place, || {
                    format!("vertex index {}: the file has {vertices} vertices", u64::from(vertex) + 1)
                });
            }
        }
        let textures = self.texture_vertices.len();
        for (texture, place) in std::mem::take(&mut self.forward_texture) {
            if texture as usize >= textures {
                self.problem(place, || {
                    format!("texture index {}: the file has {textures} texture coordinates", u64::from(texture) + 1)
                });
            }
        }
        let of_file = |message| Problem::new(Location::file(&self.path), message);
        if facets == 0 && self.problems.is_empty() {
            self.problems.push(|| of_file("holds no faces (lines that begin with `f`): is it an OBJ file?"));
        }
        if vertices > u32::MAX as usize || facets > u32::MAX as usize {
            self.problems.push(|| of_file("more vertices or facets than 32 bits count: part it into several meshes"));
        }
        self.problems.finish(&self.path)?;
        self.faces.cut(&self.vertices);
        let of_corner = |t: u32| self.texture_vertices.get(t as usize).copied().unwrap_or(NO_UV[0]);
        let uv = self.faces.facet_texture.iter().map(|texture| texture.map(of_corner)).collect();
        let Faces { facets, facet_material, face_of_facet, facet_group, groups, .. } = self.faces;
        Ok(ObjFile {
            vertices: self.vertices,
            facets,
            face_of_facet,
            facet_material,
            materials: self.materials.into_list(),
            facet_group,
            groups,
            texture_vertices: textures,
            uv,
            objects: self.objects,
            ignored: self.ignored,
            inputs: Vec::new(),
        })
    }
}

fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t'
}

fn skip_blanks(mut bytes: &[u8]) -> &[u8] {
    while let Some((first, rest)) = bytes.split_first()
        && is_blank(*first)
    {
        bytes = rest;
    }
    bytes
}

/// The first word and what follows it.
fn word(bytes: &[u8]) -> (&[u8], &[u8]) {
    let bytes = skip_blanks(bytes);
    let end = bytes.iter().position(|b| is_blank(*b)).unwrap_or(bytes.len());
    bytes.split_at(end)
}

/// A text after its keyword.
fn text(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest).trim().to_owned()
}

/// The vertex index of a corner, that of its texture coordinates, and what follows the corner.
fn corner(bytes: &[u8]) -> Option<(i64, Option<i64>, &[u8])> {
    let (index, mut after) = integer(bytes)?;
    let mut texture = None;
    for k in 0..2 {
        if let [b'/', more @ ..] = after {
            let further = integer(more);
            after = further.map_or(more, |(_, after)| after);
            if k == 0 {
                texture = further.map(|(index, _)| index);
            }
        }
    }
    after.first().is_none_or(|b| is_blank(*b)).then_some((index, texture, after))
}

/// Three numbers after a letter, with one blank before each, that end the line; and the line's length with its newline.
#[inline]
fn three<T: Copy + Default>(text: &[u8], number: impl Fn(&[u8]) -> Option<(T, usize)>) -> Option<([T; 3], usize)> {
    let mut values = [T::default(); 3];
    let mut at = 1;
    for value in &mut values {
        let (b' ', rest) = text.get(at..)?.split_first()? else { return None };
        let n;
        (*value, n) = number(rest)?;
        at += 1 + n;
    }
    (text.get(at) == Some(&b'\n')).then_some((values, at + 1))
}

/// As much of a text as a message can hold.
fn shown(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into_owned(),
    }
}
