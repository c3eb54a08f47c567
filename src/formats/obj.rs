//! Wavefront OBJ: meshes, in the file's own units, axes and order.
//!
//! Read are `v` (further numbers on the line are passed over), `f` (`a`, `a/b`, `a//c`, `a/b/c`, negative indices),
//! `g`, `usemtl` and `mtllib`; `vt` is counted. `vn`, `o`, `s` and comments say nothing here. Anything else is
//! counted by its keyword in [`ObjFile::ignored`]. Vertices and faces keep the order of the file.
//!
//! # How a face becomes facets
//!
//! A quad is cut along the shorter of its two diagonals (in space; equal: the one from its first corner), unless that
//! diagonal is outside because the quad is concave: then along the other. A face with more corners loses ears: seen
//! along its Newell normal, the first corner (in the order of the face) whose triangle is counter-clockwise and holds
//! no other corner is cut off, and so on. Where there is no such corner (a face that crosses itself, or has no area),
//! the first is cut off. A face of n corners always gives n - 2 facets, which turn the way the face turns.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result};
use crate::geometry::Mesh;

use super::input::{self, BYTE_ORDER_MARK, InputFile, Problems};
use super::mtl::{self, ObjMaterial};

/// Text in memory at a time, bytes; no line is longer.
const BUFFER: usize = 1 << 20;
/// Faces with more corners are refused: cutting ears off takes a time that grows with their square.
const CORNERS: usize = 1000;

/// What an OBJ file and its material files hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ObjFile {
    /// Vertices, in the file's unit and axes.
    pub vertices: Vec<DVec3>,
    /// Three vertex indices (from 0) for each facet.
    pub facets: Vec<[u32; 3]>,
    /// The face (from 0) that each facet was cut from; empty if all faces are triangles.
    pub face_of_facet: Vec<u32>,
    /// The material of each facet: index into `materials`.
    pub facet_material: Vec<u16>,
    /// Materials that faces use, in the order of their first `usemtl`.
    pub materials: Vec<ObjMaterial>,
    /// The group of each facet: index into `groups`; empty if no `g` names one.
    pub facet_group: Vec<u16>,
    /// Groups that own faces, in the order of their first one: all that follows `g` on its line. A name that comes again
    /// is the same group; faces before the first `g` are in a group without a name.
    pub groups: Vec<String>,
    /// Number of texture coordinates (`vt`).
    pub texture_vertices: usize,
    /// Statements that were passed over, and how many of each.
    pub ignored: BTreeMap<String, usize>,
    /// The files that were read: the OBJ, then its material files.
    pub inputs: Vec<InputFile>,
}

/// Reads an OBJ file and the material files it names, which lie beside it.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with what cannot be used, line by line: coordinates that are not finite numbers,
/// faces with fewer than three corners or with vertices that do not exist, a material file that is missing (its
/// materials would silently become one), a file without faces. The first 20 are told, and the number of the rest.
pub fn read(path: &Path) -> Result<ObjFile> {
    let file = File::open(path).map_err(|e| Error::io(path, "reading", e))?;
    let mut source = input::Hashing::new(file);
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut material_files = Vec::new();
    let mut load = |name: &str| {
        let (materials, input) = mtl::read(&folder.join(name))?;
        material_files.push(input);
        Ok(materials)
    };
    let mut obj = parse(&mut source, path, &mut load)?;
    obj.inputs.push(source.finish(path));
    obj.inputs.append(&mut material_files);
    Ok(obj)
}

/// Reads the text of an OBJ file. `path` is for messages; `load_mtl` gives the materials of a `mtllib` name.
///
/// # Errors
/// As [`read`].
pub fn parse(
    source: &mut dyn Read,
    path: &Path,
    load_mtl: &mut dyn FnMut(&str) -> Result<Vec<ObjMaterial>>,
) -> Result<ObjFile> {
    let mut parser = Parser {
        path: path.to_owned(),
        load_mtl,
        obj: ObjFile::default(),
        line: 0,
        continued: None,
        faces: 0,
        corners: Vec::new(),
        polygons: Vec::new(),
        polygon_corners: Vec::new(),
        forward: Vec::new(),
        material: None,
        index_of_name: HashMap::new(),
        group_name: None,
        group: None,
        index_of_group: HashMap::new(),
        library: HashMap::new(),
        problems: Problems::default(),
    };
    // Whole lines, a buffer at a time: the text is parsed while it is in the cache, and never all in memory.
    let mut buffer = vec![0; BUFFER];
    let (mut filled, mut offset) = (0, 0);
    loop {
        let read = match source.read(&mut buffer[filled..]) {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            read => read.map_err(|e| Error::io(path, "reading", e))?,
        };
        filled += read;
        if offset == 0 && buffer[..filled].starts_with(BYTE_ORDER_MARK) {
            buffer.copy_within(BYTE_ORDER_MARK.len()..filled, 0);
            filled -= BYTE_ORDER_MARK.len();
        }
        let whole = match read {
            0 => filled,
            _ => memchr::memrchr(b'\n', &buffer[..filled]).map_or(0, |i| i + 1),
        };
        parser.lines(&buffer[..whole], offset);
        buffer.copy_within(whole..filled, 0);
        filled -= whole;
        offset += whole;
        if read == 0 {
            return parser.finish();
        }
        if filled == buffer.len() {
            let message = format!("a line of more than {BUFFER} bytes: is it an OBJ file?");
            return Err(Error::syntax(Location::line(path, parser.line + 1), message));
        }
    }
}

/// Where a statement is: byte range and line number (from 1).
#[derive(Debug, Clone, Copy)]
struct Place {
    start: usize,
    end: usize,
    line: usize,
}

struct Parser<'a> {
    path: PathBuf,
    load_mtl: &'a mut dyn FnMut(&str) -> Result<Vec<ObjMaterial>>,
    obj: ObjFile,
    /// Lines so far.
    line: usize,
    /// The statement so far that goes on in the next line, and where it began.
    continued: Option<(Vec<u8>, Place)>,
    faces: u32,
    /// Corners of the face at hand.
    corners: Vec<u32>,
    /// Faces of more than three corners: first facet, first corner, number of corners. Cut when all vertices are known.
    polygons: Vec<(usize, usize, usize)>,
    polygon_corners: Vec<u32>,
    /// Indices that were beyond the vertices known so far, and where.
    forward: Vec<(u32, Place)>,
    material: Option<u16>,
    index_of_name: HashMap<String, u16>,
    /// What the last `g` said, and where, until a face follows.
    group_name: Option<(String, Place)>,
    group: Option<u16>,
    index_of_group: HashMap<String, u16>,
    /// What the material files define.
    library: HashMap<String, Option<[f64; 3]>>,
    problems: Problems,
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

/// A whole number of up to 18 digits, and the bytes after it.
fn integer(bytes: &[u8]) -> Option<(i64, &[u8])> {
    let (negative, digits) = match bytes {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, bytes),
    };
    let (value, n) = digits_of(digits);
    (n > 0).then(|| (if negative { -value } else { value }, &digits[n..]))
}

/// Powers of ten that are exact in f64, as far as 15 digits need them.
const TEN: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The same as integers.
const TEN_I64: [i64; 16] = {
    let mut ten = [1; 16];
    let mut i = 1;
    while i < 16 {
        ten[i] = ten[i - 1] * 10;
        i += 1;
    }
    ten
};

/// The number that up to 18 decimal digits at the start make, and how many they are.
#[inline(always)]
fn digits_of(bytes: &[u8]) -> (i64, usize) {
    // Eight bytes at once: a loop over digits mispredicts its end at nearly every number, and half a file is numbers.
    if let Some(eight) = bytes.first_chunk::<8>() {
        let digits = u64::from_le_bytes(*eight) ^ 0x3030_3030_3030_3030;
        // The lowest high bit marks the first byte that is no digit; what a carry does beyond it does not matter.
        let others = (digits.wrapping_add(0x7676_7676_7676_7676) | digits) & 0x8080_8080_8080_8080;
        let n = others.trailing_zeros() as usize / 8;
        if n == 0 {
            return (0, 0);
        }
        if n < 8 {
            let pairs = digits << (64 - 8 * n);
            let pairs = (pairs.wrapping_mul(10)).wrapping_add(pairs >> 8);
            let high = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(0x000f_4240_0000_0064);
            let low = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(0x0000_2710_0000_0001);
            return ((high.wrapping_add(low) >> 32) as i64, n);
        }
    }
    let (mut value, mut n) = (0, 0);
    for byte in bytes.iter().take(18) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        value = value * 10 + i64::from(digit);
        n += 1;
    }
    (value, n)
}

/// The f64 nearest to the decimal number at the start, and its length in bytes.
fn decimal(bytes: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let (whole, n) = digits_of(&bytes[sign..]);
    let mut end = sign + n;
    let (mut mantissa, mut decimals) = (whole, 0);
    if n > 0 && bytes.get(end) == Some(&b'.') {
        let fraction = &bytes[end + 1..];
        (mantissa, decimals) = match digits_of(fraction) {
            (part, k) if n + k <= 15 => (whole * TEN_I64[k] + part, k),
            (_, k) => (0, k),
        };
        end += 1 + decimals;
    }
    // Up to 15 digits and a power of ten up to 1e15 are exact in f64, so that their quotient is rounded once (Clinger 1990).
    if n > 0 && n + decimals <= 15 && bytes.get(end).is_none_or(|b| b.is_ascii_whitespace()) {
        let value = mantissa as f64 / TEN[decimals];
        return Some((if sign == 1 { -value } else { value }, end));
    }
    fast_float2::parse_partial(bytes).ok()
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

fn shown(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into_owned(),
    }
}

impl Parser<'_> {
    /// Takes whole lines; `offset` is where they are in the file.
    fn lines(&mut self, text: &[u8], offset: usize) {
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
                self.obj.vertices.push(DVec3::from_array(xyz));
                length
            }
            Some(b'f') => {
                let material = self.material.filter(|_| self.group_name.is_none())?;
                let known = self.obj.vertices.len() as i64;
                let vertex = |text: &[u8]| {
                    let (index, n) = digits_of(text);
                    (n > 0 && 0 < index && index <= known).then_some(((index - 1) as u32, n))
                };
                let (corners, length) = three(text, vertex)?;
                self.push_facet(corners, material);
                self.faces += 1;
                length
            }
            _ => return None,
        };
        self.line += 1;
        Some(length)
    }

    #[inline]
    fn push_facet(&mut self, corners: [u32; 3], material: u16) {
        self.obj.facets.push(corners);
        self.obj.facet_material.push(material);
        if !self.polygons.is_empty() {
            self.obj.face_of_facet.push(self.faces);
        }
        if let Some(group) = self.group {
            self.obj.facet_group.push(group);
        }
    }

    fn problem(&mut self, place: Place, message: impl FnOnce() -> String) {
        let path = &self.path;
        self.problems.push(|| {
            let at = Location { span: Some((place.start, place.end)), ..Location::line(path, place.line) };
            Problem::new(at, message())
        });
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
            b"vt" => self.obj.texture_vertices += 1,
            b"usemtl" => self.use_material(rest, place),
            b"mtllib" => self.libraries(rest, place),
            b"g" => self.group_name = Some((String::from_utf8_lossy(rest).trim().to_owned(), place)),
            b"" | b"vn" | b"o" | b"s" => {}
            _ if keyword[0] == b'#' => {}
            _ => {
                // A file that is no OBJ at all must not fill the memory with its words.
                let key = if self.obj.ignored.len() < 20 { shown(keyword) } else { "...".into() };
                *self.obj.ignored.entry(key).or_default() += 1;
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
        self.obj.vertices.push(DVec3::from_array(xyz));
    }

    fn face(&mut self, mut rest: &[u8], place: Place) {
        self.corners.clear();
        let known = self.obj.vertices.len() as i64;
        loop {
            rest = skip_blanks(rest);
            if rest.first().is_none_or(|b| *b == b'#') {
                break;
            }
            let Some((index, mut after)) = integer(rest) else { return self.bad_corner(rest, place) };
            for _ in 0..2 {
                if let [b'/', more @ ..] = after {
                    after = integer(more).map_or(more, |(_, after)| after);
                }
            }
            if after.first().is_some_and(|b| !is_blank(*b)) {
                return self.bad_corner(rest, place);
            }
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
        }
        let n = self.corners.len();
        if !(3..=CORNERS).contains(&n) {
            return self.problem(place, || match n {
                0..3 => format!("a face of {n} corners has no area: a face needs at least 3"),
                _ => format!("a face of {n} corners: cut it into faces of at most {CORNERS}"),
            });
        }
        let material = match self.material {
            Some(material) => material,
            None => {
                let unnamed = self.name_material("", place);
                *self.material.insert(unnamed)
            }
        };
        if let Some((name, place)) = self.group_name.take() {
            self.name_group(&name, place);
        }
        let first = self.obj.facets.len();
        if n > 3 {
            if self.obj.face_of_facet.is_empty() {
                self.obj.face_of_facet.extend(0..first as u32);
            }
            self.polygons.push((first, self.polygon_corners.len(), n));
            self.polygon_corners.extend_from_slice(&self.corners);
        }
        // Polygons get their place now, and their cut when all vertices are known.
        for i in 2..n {
            self.push_facet([self.corners[0], self.corners[i - 1], self.corners[i]], material);
        }
        self.faces += 1;
    }

    fn bad_corner(&mut self, rest: &[u8], place: Place) {
        let found = shown(word(rest).0);
        self.problem(place, || format!("`{found}` is not a corner of a face (a, a/b, a//c or a/b/c)"));
    }

    fn name_material(&mut self, name: &str, place: Place) -> u16 {
        if let Some(&index) = self.index_of_name.get(name) {
            return index;
        }
        let Ok(index) = u16::try_from(self.obj.materials.len()) else {
            self.problem(place, || format!("more than {} materials", u16::MAX));
            return 0;
        };
        self.obj.materials.push(ObjMaterial { name: name.to_owned(), kd: None });
        self.index_of_name.insert(name.to_owned(), index);
        index
    }

    fn name_group(&mut self, name: &str, place: Place) {
        let earlier = self.obj.facets.len();
        if self.obj.groups.is_empty() && earlier > 0 {
            self.obj.groups.push(String::new());
            self.obj.facet_group.resize(earlier, 0);
            self.index_of_group.insert(String::new(), 0);
        }
        let known = self.index_of_group.get(name).copied();
        let Ok(index) = known.map_or_else(|| u16::try_from(self.obj.groups.len()), Ok) else {
            return self.problem(place, || format!("more than {} groups", u16::MAX));
        };
        if known.is_none() {
            self.obj.groups.push(name.to_owned());
            self.index_of_group.insert(name.to_owned(), index);
        }
        self.group = Some(index);
    }

    fn use_material(&mut self, rest: &[u8], place: Place) {
        let name = String::from_utf8_lossy(rest).trim().to_owned();
        self.material = Some(self.name_material(&name, place));
    }

    fn libraries(&mut self, rest: &[u8], place: Place) {
        let names = String::from_utf8_lossy(rest).trim().to_owned();
        // Blanks part names, and also occur in them.
        let whole = (self.load_mtl)(&names);
        let libraries = match whole {
            Err(Error::Io { .. }) if names.contains(char::is_whitespace) => {
                names.split_whitespace().map(|name| (name.to_owned(), (self.load_mtl)(name))).collect()
            }
            whole => vec![(names, whole)],
        };
        for (name, library) in libraries {
            match library {
                Ok(materials) => {
                    for ObjMaterial { name, kd } in materials {
                        let known = *self.library.entry(name.clone()).or_insert(kd);
                        if known != kd {
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

    fn finish(mut self) -> Result<ObjFile> {
        if let Some((joined, place)) = self.continued.take() {
            self.statement(&joined, place);
        }
        let vertices = self.obj.vertices.len();
        for (vertex, place) in std::mem::take(&mut self.forward) {
            if vertex as usize >= vertices {
                self.problem(place, || {
                    format!("vertex index {}: the file has {vertices} vertices", u64::from(vertex) + 1)
                });
            }
        }
        if self.obj.facets.is_empty() && self.problems.is_empty() {
            let at = Location::file(&self.path);
            self.problems.push(|| Problem::new(at, "holds no faces (lines that begin with `f`): is it an OBJ file?"));
        }
        if vertices > u32::MAX as usize || self.obj.facets.len() > u32::MAX as usize {
            let at = Location::file(&self.path);
            self.problems.push(|| Problem::new(at, "more vertices or facets than 32 bits count"));
        }
        self.problems.finish(&self.path)?;
        for material in &mut self.obj.materials {
            material.kd = self.library.get(&material.name).copied().flatten();
        }
        let mut cut = Vec::new();
        for &(first, corner, n) in &self.polygons {
            cut.clear();
            triangulate(&self.polygon_corners[corner..corner + n], &self.obj.vertices, &mut cut);
            self.obj.facets[first..first + n - 2].copy_from_slice(&cut);
        }
        Ok(self.obj)
    }
}

/// Cuts a face of four or more corners into facets, by the rule at the top of this file.
fn triangulate(corners: &[u32], vertices: &[DVec3], facets: &mut Vec<[u32; 3]>) {
    let n = corners.len();
    let at = |i: usize| vertices[corners[i] as usize];
    // Newell: the sum over the edges, about the first corner so that far-off coordinates keep their digits.
    let normal: DVec3 = (1..n - 1).map(|i| (at(i) - at(0)).cross(at(i + 1) - at(0))).sum();
    let flat: Vec<[f64; 2]> = {
        let size = normal.abs();
        // Leaving out the largest component of the normal keeps the turn and the shape's convexity.
        let (u, v, sign) = if size.x >= size.y && size.x >= size.z {
            (1, 2, normal.x)
        } else if size.y >= size.z {
            (2, 0, normal.y)
        } else {
            (0, 1, normal.z)
        };
        let (u, v) = if sign < 0.0 { (v, u) } else { (u, v) };
        (0..n).map(|i| [at(i)[u], at(i)[v]]).collect()
    };
    let turn = |a: usize, b: usize, c: usize| {
        let point = |i: usize| robust::Coord { x: flat[i][0], y: flat[i][1] };
        robust::orient2d(point(a), point(b), point(c))
    };
    let mut push = |a: usize, b: usize, c: usize| facets.push([corners[a], corners[b], corners[c]]);
    if n == 4 {
        let first = turn(0, 1, 2) > 0.0 && turn(0, 2, 3) > 0.0;
        let second = turn(1, 2, 3) > 0.0 && turn(1, 3, 0) > 0.0;
        let shorter = (at(3) - at(1)).length_squared() < (at(2) - at(0)).length_squared();
        if second && (!first || shorter) {
            push(0, 1, 3);
            push(1, 2, 3);
        } else {
            push(0, 1, 2);
            push(0, 2, 3);
        }
        return;
    }
    let mut left: Vec<usize> = (0..n).collect();
    while left.len() > 3 {
        let m = left.len();
        let is_ear = |&k: &usize| {
            let (a, b, c) = (left[(k + m - 1) % m], left[k], left[(k + 1) % m]);
            let holds = |&p: &usize| {
                // A corner that coincides with one of the triangle's is where the face touches itself.
                ![a, b, c].iter().any(|&q| flat[p] == flat[q])
                    && turn(a, b, p) >= 0.0
                    && turn(b, c, p) >= 0.0
                    && turn(c, a, p) >= 0.0
            };
            turn(a, b, c) > 0.0 && !left.iter().any(holds)
        };
        let k = (0..m).find(|k| is_ear(k)).unwrap_or(0);
        push(left[(k + m - 1) % m], left[k], left[(k + 1) % m]);
        left.remove(k);
    }
    push(left[0], left[1], left[2]);
}

/// Writes a mesh as OBJ: vertices, then triangles grouped by `usemtl` where the material changes, in the mesh's order.
///
/// Coordinates are the shortest decimals that read back as the same f64. `materials` is indexed by the mesh's material
/// ids; `mtllib`, if given, is the name of the file that [`mtl::write`] makes of them.
///
/// # Errors
/// What the writer says.
pub fn write(out: &mut impl Write, mesh: &Mesh, materials: &[ObjMaterial], mtllib: Option<&str>) -> io::Result<()> {
    if let Some(name) = mtllib {
        writeln!(out, "mtllib {name}")?;
    }
    let name = |material: usize| materials.get(material).map_or("", |m| m.name.as_str());
    write_by(out, mesh, "usemtl", name, |v| v)
}

/// As [`write`], in other axes, the triangles grouped by statements `statement name(material)`.
///
/// # Errors
/// What the writer says.
pub(crate) fn write_by<'a>(
    out: &mut impl Write,
    mesh: &Mesh,
    statement: &str,
    name: impl Fn(usize) -> &'a str,
    axes: impl Fn(DVec3) -> DVec3,
) -> io::Result<()> {
    const CHUNK: usize = 1 << 16;
    let mut text = Vec::with_capacity(CHUNK + 256);
    for v in &mesh.vertices_m {
        let v = axes(*v);
        // Beyond these sizes the plain form is a row of zeros.
        if v.to_array().iter().all(|c| *c == 0.0 || (1e-5..1e16).contains(&c.abs())) {
            writeln!(text, "v {} {} {}", v.x, v.y, v.z)?;
        } else {
            writeln!(text, "v {:e} {:e} {:e}", v.x, v.y, v.z)?;
        }
        if text.len() >= CHUNK {
            out.write_all(&text)?;
            text.clear();
        }
    }
    let mut current = None;
    for (facet, material) in mesh.facets.iter().zip(&mesh.material) {
        if current != Some(material) {
            current = Some(material);
            writeln!(text, "{statement} {}", name(material.0 as usize))?;
        }
        text.push(b'f');
        for &vertex in facet {
            text.push(b' ');
            push_integer(&mut text, u64::from(vertex) + 1);
        }
        text.push(b'\n');
        if text.len() >= CHUNK {
            out.write_all(&text)?;
            text.clear();
        }
    }
    out.write_all(&text)
}

fn push_integer(text: &mut Vec<u8>, mut value: u64) {
    let mut digits = [0_u8; 20];
    let mut first = digits.len();
    loop {
        first -= 1;
        digits[first] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    text.extend_from_slice(&digits[first..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::MaterialId;

    fn parsed(text: &str) -> Result<ObjFile> {
        parse(&mut text.as_bytes(), Path::new("a.obj"), &mut |name| {
            Err(Error::io(name, "reading", io::ErrorKind::NotFound.into()))
        })
    }

    #[test]
    fn decimals_are_the_nearest_f64() {
        let mut seen = 0;
        for text in [
            "0",
            "-0",
            "1",
            "-1.5",
            "0.1",
            "-0.3",
            "123456.7891",
            "999999999999999",
            "9999999999999.99",
            "9007199254740993",
            "123456789012345.6",
            "0.30000000000000004",
            "1e-7",
            "-1.25E+3",
            "1.",
            ".5",
            "2.2250738585072014e-308",
            "0.000000000000001",
            "0.0000000000000001",
            "99999999999999999999",
            "1234567890123456789.5",
        ] {
            let expected: f64 = text.parse().unwrap();
            let (value, n) = decimal(text.as_bytes()).unwrap();
            assert_eq!((value.to_bits(), n), (expected.to_bits(), text.len()), "{text}");
            assert_eq!(decimal(format!("{text} 7").as_bytes()).unwrap().0.to_bits(), expected.to_bits());
            seen += 1;
        }
        assert_eq!(seen, 21);
        assert_eq!(decimal(b""), None);
        assert_eq!(decimal(b"-"), None);
        assert_eq!(decimal(b"x1"), None);
    }

    #[test]
    fn every_form_of_a_face_means_the_same() {
        let text = "v 0 0 0 1.0 0.5 0.5 0.5\r\nv 1 0 0 # comment\r\nv 1e0 \\\n1 0\nvt 0 0\nvn 0 0 1\ng x\n\
                    f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1 # comment\nf 1/1/1 2/1/1 \\\r\n  3/1/1\nf\t-3 -2 -1\ncurv 1 2";
        let obj = parsed(text).unwrap();
        assert_eq!(obj.vertices, [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)]);
        assert_eq!(obj.facets, [[0, 1, 2]; 5]);
        assert_eq!(obj.face_of_facet, [0_u32; 0]);
        assert_eq!((obj.texture_vertices, obj.ignored.get("curv")), (1, Some(&1)));
        assert_eq!(obj.materials, [ObjMaterial { name: String::new(), kd: None }]);
    }

    #[test]
    fn faces_may_come_before_their_vertices() {
        assert_eq!(parsed("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap().facets, [[0, 1, 2]]);
    }

    #[test]
    fn materials_come_in_order_of_use_with_their_colours() {
        let text = "mtllib my file.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl blue unit\nf 1 2 3\nusemtl red\nf 1 2 3\n";
        let mut asked = Vec::new();
        let mut load = |name: &str| {
            asked.push(name.to_owned());
            mtl::parse(b"newmtl blue unit\nKd 0 0 1\nnewmtl red\nKd 1 0 0\n", Path::new("m.mtl"))
        };
        let obj = parse(&mut text.as_bytes(), Path::new("a.obj"), &mut load).unwrap();
        assert_eq!(asked, ["my file.mtl"]);
        assert_eq!(obj.facet_material, [0, 1, 2, 1]);
        let named: Vec<_> = obj.materials.iter().map(|m| (m.name.as_str(), m.kd)).collect();
        assert_eq!(named, [("", None), ("red", Some([1.0, 0.0, 0.0])), ("blue unit", Some([0.0, 0.0, 1.0]))]);
    }

    #[test]
    fn all_problems_are_told_with_their_lines() {
        let text = "v 0 0 nan\nv 1 x 0\nv 1\nv 1 1 inf\nf 1 2\nf 0 1 2\nf 1 2 9\nf 1 2 -9\nf 1 2 x\nf 1 2 3/x\nmtllib no.mtl\n";
        let told = parsed(text).unwrap_err().to_string();
        let expected = [
            "a.obj:1: z of the vertex is `nan`",
            "a.obj:2: y of the vertex is `x`",
            "a.obj:3: the vertex has no y",
            "a.obj:4: z of the vertex is `inf`",
            "a.obj:5: a face of 2 corners",
            "a.obj:6: vertex index 0: indices count from 1",
            "a.obj:8: vertex index -9: 4 vertices come before",
            "a.obj:9: `x` is not a corner",
            "a.obj:10: `3/x` is not a corner",
            "a.obj:11: material file `no.mtl` cannot be read",
            "a.obj:7: vertex index 9: the file has 4 vertices",
        ];
        assert_eq!(told.lines().count(), expected.len(), "{told}");
        for (line, expected) in told.lines().zip(expected) {
            assert!(line.starts_with(expected), "{line}");
        }
    }

    #[test]
    fn twenty_problems_and_the_number_of_the_rest() {
        let told = parsed(&"v 1 2 nan\n".repeat(50)).unwrap_err().to_string();
        assert_eq!(told.lines().count(), 21);
        assert!(told.ends_with("a.obj: and 30 more problems"), "{told}");
    }

    #[test]
    fn a_file_without_faces_is_refused() {
        for text in ["", "v 0 0 0\n", "\u{89}PNG\r\n\0\0"] {
            assert!(parsed(text).unwrap_err().to_string().contains("a.obj: holds no faces"));
        }
    }

    fn facets(polygon: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let vertices: Vec<DVec3> = polygon.iter().map(|p| DVec3::from_array(*p)).collect();
        let corners: Vec<u32> = (0..vertices.len() as u32).collect();
        let mut facets = Vec::new();
        triangulate(&corners, &vertices, &mut facets);
        facets
    }

    #[test]
    fn a_quad_is_cut_along_the_shorter_diagonal_inside() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(facets(&square), [[0, 1, 2], [0, 2, 3]]);
        let kite = [[0.0, 0.0, 0.0], [1.0, -0.1, 0.0], [4.0, 0.0, 0.0], [1.0, 0.1, 0.0]];
        assert_eq!(facets(&kite), [[0, 1, 3], [1, 2, 3]]);
        // An arrow head: the shorter diagonal, from 1 to 3, is outside.
        let arrow = [[0.0, 0.0, 0.0], [-0.9, -1.0, 0.0], [3.0, 0.0, 0.0], [-0.9, 1.0, 0.0]];
        assert_eq!(facets(&arrow), [[0, 1, 2], [0, 2, 3]]);
        // Seen from below, and standing upright: the same cuts.
        for map in
            [|p: [f64; 3]| [p[1], p[0], p[2]], |p: [f64; 3]| [p[2], p[0], p[1]], |p: [f64; 3]| [p[0], p[2], p[1]]]
        {
            assert_eq!(facets(&kite.map(map)), [[0, 1, 3], [1, 2, 3]]);
            assert_eq!(facets(&arrow.map(map)), [[0, 1, 2], [0, 2, 3]]);
        }
    }

    #[test]
    fn ears_cover_a_concave_face_exactly() {
        // A comb of 2 teeth: area by the shoelace formula 3*3 - 1*2 = 7.
        let comb = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let comb = comb.map(|[x, y]| [5.0, x, y]);
        let cut = facets(&comb);
        assert_eq!(cut.len(), 6);
        let mut sum = 0.0;
        for [a, b, c] in cut {
            let [a, b, c] = [a, b, c].map(|i| DVec3::from_array(comb[i as usize]));
            let twice = (b - a).cross(c - a).x;
            assert!(twice >= 0.0);
            sum += 0.5 * twice;
        }
        assert_eq!(sum, 7.0);
    }

    #[test]
    fn faces_without_area_still_give_their_facets() {
        assert_eq!(facets(&[[1.0; 3]; 5]).len(), 3);
        assert_eq!(facets(&[[1.0; 3]; 4]).len(), 2);
        let text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 1 2\nf 1 3 4 5\nf 1 2 3 4 5\n";
        let obj = parsed(text).unwrap();
        assert_eq!(obj.facets[0], [0, 0, 1]);
        assert_eq!(obj.face_of_facet, [0, 1, 1, 2, 2, 2]);
    }

    /// A bumpy sheet of n x n quads cut in two, as text with coordinates of a few decimals.
    fn sheet(n: usize) -> Mesh {
        let height = |i: usize| ((i * 7919) % 1000) as f64 * 1e-3;
        let vertices_m = (0..(n + 1) * (n + 1))
            .map(|i| DVec3::new((i % (n + 1)) as f64 * 1.25 - 6e4, (i / (n + 1)) as f64 * 1.25 + 1e-7, height(i)))
            .collect();
        let quad = |i: usize| (i / n * (n + 1) + i % n) as u32;
        let w = n as u32 + 1;
        let facets: Vec<[u32; 3]> = (0..n * n)
            .flat_map(|i| [[quad(i), quad(i) + 1, quad(i) + w + 1], [quad(i), quad(i) + w + 1, quad(i) + w]])
            .collect();
        let material = (0..facets.len()).map(|i| MaterialId(u16::from(i % 10 > 6))).collect();
        Mesh { vertices_m, facets, material, face_of_facet: vec![] }
    }

    fn two_materials() -> Vec<ObjMaterial> {
        ["blue unit", "red"].map(|name| ObjMaterial { name: name.into(), kd: Some([0.25, 0.5, 0.125]) }).into()
    }

    #[test]
    fn what_is_written_reads_back_the_same_bits() {
        let mesh = sheet(20);
        let mut text = Vec::new();
        write(&mut text, &mesh, &two_materials(), Some("a.mtl")).unwrap();
        let obj = parse(&mut text.as_slice(), Path::new("a.obj"), &mut |_| Ok(two_materials())).unwrap();
        assert_eq!(obj.vertices, mesh.vertices_m);
        assert_eq!(obj.facets, mesh.facets);
        assert_eq!(obj.materials, two_materials());
        assert!(obj.facet_material.iter().zip(&mesh.material).all(|(a, b)| *a == b.0));
    }

    #[test]
    fn tobj_reads_the_same_mesh() {
        let mesh = sheet(20);
        let mut text = Vec::new();
        write(&mut text, &mesh, &two_materials(), Some("a.mtl")).unwrap();
        let mut mtl_text = Vec::new();
        mtl::write(&mut mtl_text, &two_materials()).unwrap();
        let load = |_: &Path| tobj::load_mtl_buf(&mut mtl_text.as_slice());
        let (models, materials) =
            tobj::load_obj_buf(&mut text.as_slice(), &tobj::LoadOptions::default(), load).unwrap();
        let materials = materials.unwrap();
        let ours = parse(&mut text.as_slice(), Path::new("a.obj"), &mut |_| Ok(two_materials())).unwrap();
        // tobj makes a model of each run of a material and numbers vertices anew: compare corner by corner.
        let mut facet = 0;
        for model in &models {
            let name = &materials[model.mesh.material_id.unwrap()].name;
            for corners in model.mesh.indices.chunks_exact(3) {
                assert_eq!(*name, ours.materials[ours.facet_material[facet] as usize].name);
                for (corner, vertex) in corners.iter().zip(ours.facets[facet]) {
                    let at = 3 * *corner as usize;
                    assert_eq!(model.mesh.positions[at..at + 3], ours.vertices[vertex as usize].to_array());
                }
                facet += 1;
            }
        }
        assert_eq!(facet, 800);
    }
}
