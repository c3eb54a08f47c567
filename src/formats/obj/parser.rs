//! The statements of an OBJ text.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::ObjFile;
use super::faces::{Faces, NO_TEXTURE};
use super::library;
use super::materials::Materials;
use super::number::{decimal, digits_of, integer};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::input::{Problems, decoded};
use crate::formats::mesh_file::FLAT;
use crate::formats::mtl::ObjMaterial;
use crate::geometry::NO_UV;
use crate::report::{Fate, Note, Report};

/// Faces with more corners are refused: cutting ears off takes a time that grows with their square.
const CORNERS: usize = 1000;
/// As many kinds of statements are passed over by name: a file that is not an OBJ at all must not fill the memory with its words.
const IGNORED: usize = 20;

/// What occurs, how often, and where first.
#[derive(Default)]
struct Seen {
    count: usize,
    first: Option<Place>,
}

impl Seen {
    fn at(&mut self, place: Place) {
        self.count += 1;
        self.first.get_or_insert(place);
    }
}

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
    load_mtl: &'a mut (dyn FnMut(&str) -> Result<Vec<ObjMaterial>> + Send),
    vertices: Vec<DVec3>,
    texture_vertices: Vec<[f64; 2]>,
    faces: Faces,
    materials: Materials,
    /// What `mtllib` has named.
    libraries: BTreeSet<String>,
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
    /// Normals, as long as no face has different ones.
    normals: Vec<DVec3>,
    /// Faces whose corners have different normals: only the first.
    smooth: Option<Place>,
    /// Vertices with colours.
    colours: Seen,
    /// Vertices with a weight other than 1.
    weights: Seen,
    /// Names that are not UTF-8.
    not_utf8: Seen,
    /// An object that has begun, until its first face or `usemtl`.
    object: Option<(String, Place)>,
    /// Facets before the last `usemtl`.
    facets_before_material: usize,
    /// Objects with faces before a `usemtl` of their own.
    without_material: Seen,
    /// The first of them, and the material that it takes.
    first_without_material: Option<(String, u16)>,
    /// Faces before the first `usemtl`.
    before_materials: Option<Place>,
    /// Corners of the last face.
    last_corners: usize,
    /// A last line that does not end, and seems to lack something.
    unfinished: Option<Place>,
    material_doubts: Vec<Note>,
}

impl<'a> Parser<'a> {
    pub(super) fn new(path: &Path, load_mtl: &'a mut (dyn FnMut(&str) -> Result<Vec<ObjMaterial>> + Send)) -> Self {
        Parser {
            path: path.to_owned(),
            load_mtl,
            vertices: Vec::new(),
            texture_vertices: Vec::new(),
            faces: Faces::default(),
            materials: Materials::default(),
            libraries: BTreeSet::new(),
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
            normals: Vec::new(),
            smooth: None,
            colours: Seen::default(),
            weights: Seen::default(),
            not_utf8: Seen::default(),
            object: None,
            facets_before_material: 0,
            without_material: Seen::default(),
            first_without_material: None,
            before_materials: None,
            last_corners: 0,
            unfinished: None,
            material_doubts: Vec::new(),
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
            let corners_before = self.last_corners;
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
            if length == rest.len() && line.first() == Some(&b'f') {
                let slashes = |word: Option<&[u8]>| word.map_or(0, |w| w.iter().filter(|b| **b == b'/').count());
                let mut words = line.split(|b| is_blank(*b)).filter(|word| !word.is_empty()).skip(1);
                let (first, last) = (words.next(), words.last());
                if slashes(last) < slashes(first) || self.last_corners < corners_before {
                    self.unfinished = Some(place);
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
                let material = self.material.filter(|_| self.group.is_none() && self.object.is_none())?;
                let known = self.vertices.len() as i64;
                let vertex = |text: &[u8]| {
                    let (index, n) = digits_of(text);
                    let place = u32::try_from(index - 1).ok().filter(|_| n > 0 && index <= known)?;
                    Some((place, n))
                };
                let (corners, length) = three(text, vertex)?;
                self.faces.push_triangle(corners, material);
                self.last_corners = 3;
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
            b"usemtl" => {
                let name = self.text(rest, place);
                self.use_material(&name, place);
                self.object = None;
                self.facets_before_material = self.faces.facets.len();
            }
            b"mtllib" => {
                let names = self.text(rest, place);
                self.libraries(&names, place);
            }
            b"g" => self.group = Some((self.text(rest, place), place)),
            b"o" => {
                self.objects += 1;
                self.object = Some((self.text(rest, place), place));
            }
            b"vn" => self.normal(rest),
            b"" | b"s" => {}
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
        self.beyond_position(rest, place);
    }

    /// Notes what follows a vertex' coordinates: a weight, or a colour.
    fn beyond_position(&mut self, rest: &[u8], place: Place) {
        let words = rest.split(|b| is_blank(*b)).filter(|word| !word.is_empty());
        let numbers: Vec<f64> =
            words.map_while(|word| decimal(word).filter(|(_, n)| *n == word.len())).map(|(x, _)| x).take(4).collect();
        match numbers[..] {
            [] | [1.0] => {}
            [_] => self.weights.at(place),
            _ => self.colours.at(place),
        }
    }

    fn normal(&mut self, mut rest: &[u8]) {
        if self.smooth.is_some() {
            return;
        }
        let mut xyz = [f64::NAN; 3];
        for x in &mut xyz {
            rest = skip_blanks(rest);
            let Some((value, n)) = decimal(rest) else { break };
            *x = value;
            rest = &rest[n..];
        }
        self.normals.push(DVec3::from_array(xyz).normalize_or_zero());
    }

    /// A text after its keyword.
    fn text(&mut self, rest: &[u8], place: Place) -> String {
        let (text, is_utf8) = decoded(rest);
        if !is_utf8 {
            self.not_utf8.at(place);
        }
        text.trim().to_owned()
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
        let mut first_normal = None;
        loop {
            rest = skip_blanks(rest);
            if rest.first().is_none_or(|b| *b == b'#') {
                break;
            }
            let Some((Corner { vertex: index, texture, normal }, after)) = corner(rest) else {
                let found = shown(word(rest).0);
                return self.problem(place, || format!("`{found}` is not a corner of a face (a, a/b, a//c or a/b/c)"));
            };
            rest = after;
            let vertex = if index > 0 { index - 1 } else { known + index };
            let vertex = u32::try_from(vertex).ok().filter(|vertex| index != 0 && *vertex < u32::MAX);
            let Some(vertex) = vertex else {
                return self.problem(place, || match index {
                    0 => "vertex index 0: indices count from 1".into(),
                    _ => format!("vertex index {index}: {known} vertices come before this face"),
                });
            };
            if i64::from(vertex) >= known {
                self.forward.push((vertex, place));
            }
            self.corners.push(vertex);
            if self.smooth.is_none()
                && let Some(normal) = normal.and_then(|index| self.normal_at(index))
                && (normal - *first_normal.get_or_insert(normal)).abs().max_element() > FLAT
            {
                self.smooth = Some(place);
                self.normals = Vec::new();
            }
            let known = self.texture_vertices.len() as i64;
            let texture = match texture {
                None => NO_TEXTURE,
                Some(index) => {
                    let at = if index > 0 { index - 1 } else { known + index };
                    let at = u32::try_from(at).ok().filter(|at| index != 0 && *at < NO_TEXTURE);
                    let Some(at) = at else {
                        return self.problem(place, || match index {
                            0 => "texture index 0: indices count from 1".into(),
                            _ => format!("texture index {index}: {known} texture coordinates come before this face"),
                        });
                    };
                    if i64::from(at) >= known {
                        self.forward_texture.push((at, place));
                    }
                    at
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
        self.last_corners = n;
        let material = self.material.unwrap_or_else(|| {
            self.before_materials = Some(place);
            self.use_material("", place)
        });
        if let Some((name, place)) = self.object.take()
            && self.faces.facets.len() > self.facets_before_material
            && !self.materials.name(material).is_empty()
        {
            self.without_material.at(place);
            self.first_without_material.get_or_insert((name, material));
        }
        if let Some((name, place)) = self.group.take()
            && !self.faces.use_group(&name)
        {
            self.problem(place, || "more groups than can be told apart: give several of them one name".into());
        }
        self.faces.push(&self.corners, &self.texture, material);
    }

    /// The normal of an index as faces have it, if there is one so far.
    fn normal_at(&self, index: i64) -> Option<DVec3> {
        let known = self.normals.len() as i64;
        let at = if index > 0 { index - 1 } else { known + index };
        self.normals.get(usize::try_from(at).ok()?).copied()
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

    fn libraries(&mut self, text: &str, place: Place) {
        // Some exporters name it before every object.
        if !self.libraries.insert(text.to_owned()) {
            return;
        }
        let (whole, parts) = library::names(text);
        let libraries = match (self.load_mtl)(&whole) {
            Err(Error::Io { .. }) if parts.len() > 1 => {
                parts.into_iter().map(|name| ((self.load_mtl)(&name), name)).collect()
            }
            library => vec![(library, whole)],
        };
        for (library, name) in libraries {
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
                Err(Error::Io { source, .. }) => {
                    let message =
                        format!("material file `{name}` is not read ({source}): materials are names without colours");
                    let note = self.note(Fate::Defaulted, place, message);
                    self.material_doubts.push(note);
                }
                Err(error) => self.problem(place, || error.to_string()),
            }
        }
    }

    fn note(&self, fate: Fate, place: Place, message: impl Into<String>) -> Note {
        Note { fate, at: self.at(place), message: message.into() }
    }

    fn at(&self, place: Place) -> Location {
        Location { span: Some((place.start, place.end)), ..Location::line(&self.path, place.line) }
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
        std::mem::take(&mut self.problems).finish(&self.path)?;
        let (report, doubts) = self.told();
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
            report,
            doubts,
            material_doubts: self.material_doubts,
            may_change: false,
            inputs: Vec::new(),
        })
    }

    /// What has no place here, and what is probably not meant; what of that is about materials is added to what is known of it.
    fn told(&mut self) -> (Report, Vec<Note>) {
        let (mut report, mut doubts) = (Report::default(), Vec::new());
        if let Some(place) = self.colours.first {
            let message = format!("colours of {} vertices: a facet has one material", self.colours.count);
            report.notes.push(self.note(Fate::Dropped, place, message));
        }
        if let Some(place) = self.smooth {
            report.notes.push(self.note(Fate::Dropped, place, "smooth shading (`vn`): facets are flat"));
        }
        if let Some(place) = self.weights.first {
            let message = format!(
                "a fourth coordinate (weight) other than 1, of {} vertices: x, y and z are taken as they are",
                self.weights.count
            );
            doubts.push(self.note(Fate::Dropped, place, message));
        }
        if let Some(place) = self.unfinished {
            let message = "the last line has no end, and its face less than others: is the file cut short?";
            doubts.push(self.note(Fate::Defaulted, place, message));
        }
        doubts.extend(self.vertices_without_face());
        let mut of_materials = Vec::new();
        if let Some(place) = self.not_utf8.first {
            let message = format!("{} names that are not UTF-8: taken for Windows-1252", self.not_utf8.count);
            of_materials.push(self.note(Fate::Defaulted, place, message));
        }
        if let (Some(place), Some((name, material))) = (self.without_material.first, &self.first_without_material) {
            let more = match self.without_material.count - 1 {
                0 => String::new(),
                n => format!(" (and {n} more objects)"),
            };
            let taken = self.materials.name(*material);
            let message = format!(
                "object `{name}`{more} begins without `usemtl`: it takes the material before, `{taken}`; some exporters write it so where there is none"
            );
            of_materials.push(self.note(Fate::Defaulted, place, message));
        }
        if let (Some(place), true) = (self.before_materials, self.materials.count() > 1) {
            let message = "faces before the first `usemtl` have no material, where others have one";
            of_materials.push(self.note(Fate::Defaulted, place, message));
        }
        self.material_doubts.append(&mut of_materials);
        (report, doubts)
    }

    /// Vertices that no face uses: at the end of the list, faces are missing.
    fn vertices_without_face(&self) -> Option<Note> {
        let mut used = vec![false; self.vertices.len()];
        self.faces.facets.iter().flatten().for_each(|v| used[*v as usize] = true);
        let lost = used.iter().filter(|used| !**used).count();
        if lost == 0 {
            return None;
        }
        // Faces come last: of a file that is cut short, many vertices are left over, the last among them.
        let is_many = lost >= used.len().div_ceil(20);
        let is_cut = used.last() == Some(&false) && is_many && self.ignored.is_empty();
        let why = if is_cut { ": is the file cut short?" } else { "" };
        let message = format!("{lost} of {} vertices belong to no face{why}", used.len());
        Some(Note { fate: Fate::Defaulted, at: Location::file(&self.path), message })
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

/// Indices of a face's corner, as the file has them.
struct Corner {
    vertex: i64,
    texture: Option<i64>,
    normal: Option<i64>,
}

/// A corner, and what follows it.
fn corner(bytes: &[u8]) -> Option<(Corner, &[u8])> {
    let (vertex, mut after) = integer(bytes)?;
    let mut further = [None; 2];
    for index in &mut further {
        if let [b'/', more @ ..] = after {
            let found = integer(more);
            after = found.map_or(more, |(_, after)| after);
            *index = found.map(|(index, _)| index);
        }
    }
    let [texture, normal] = further;
    after.first().is_none_or(|b| is_blank(*b)).then_some((Corner { vertex, texture, normal }, after))
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
