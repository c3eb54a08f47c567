//! PLY, the Stanford polygon format: as text, and binary in either order of bytes.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;

use super::{LIMIT, plain};
use crate::error::{Error, Location, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::input::{self, InputFile};
use crate::formats::mesh_file::{MOST, MeshFile};
use crate::formats::mtl::ObjMaterial;
use crate::formats::obj::triangulate;
use crate::geometry::{MaterialId, index_u32};
use crate::physics::srgb;
use crate::report::{Fate, Report};

/// The Stanford polygon format.
pub(in crate::formats) static PLY: Format = Format {
    name: "ply",
    extensions: &["ply"],
    reads: "mesh, colours of vertices or faces as materials",
    writes: "",
    mark: b"ply",
    told: Some(|path, beginning| {
        let next = beginning.get(3).is_some_and(|byte| [b'\n', b'\r'].contains(byte));
        next.then(|| path.to_owned())
    }),
    holds: Holds::Mesh { read: |path, _| read(path) },
};

/// Longer headers are refused, bytes.
const MOST_HEADER: usize = 1 << 20;
/// A face of more corners is refused.
const MOST_CORNERS: usize = 1 << 16;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Text,
    Little,
    Big,
}

/// A type of numbers: their size, bytes, and how they are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Type {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Type {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Type::Signed(1),
            "short" | "int16" => Type::Signed(2),
            "int" | "int32" => Type::Signed(4),
            "uchar" | "uint8" => Type::Unsigned(1),
            "ushort" | "uint16" => Type::Unsigned(2),
            "uint" | "uint32" => Type::Unsigned(4),
            "float" | "float32" => Type::Float(4),
            "double" | "float64" => Type::Float(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Type::Signed(size) | Type::Unsigned(size) | Type::Float(size) => size,
        }
    }

    /// A number from its bytes, the lowest first.
    fn number(self, low_first: [u8; 8]) -> f64 {
        let bits = u64::from_le_bytes(low_first);
        #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "the other bytes are 0")]
        match self {
            Type::Signed(1) => f64::from(bits as i8),
            Type::Signed(2) => f64::from(bits as i16),
            Type::Signed(_) => f64::from(bits as i32),
            Type::Unsigned(_) => f64::from(bits as u32),
            Type::Float(4) => f64::from(f32::from_bits(bits as u32)),
            Type::Float(_) => f64::from_bits(bits),
        }
    }
}

#[derive(Debug)]
struct Property {
    name: String,
    of: Type,
    /// The type of the number of entries, if it is a list.
    list: Option<Type>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

impl Element {
    fn place(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name)
    }
}

#[derive(Debug)]
struct Header {
    kind: Kind,
    elements: Vec<Element>,
    /// Where the numbers begin.
    end: usize,
}

/// Reads the header.
fn header(bytes: &[u8], path: &Path) -> Result<Header> {
    let mut lines = Vec::new();
    let mut start = 0;
    // Lines end in \n, \r\n or \r; numbers of a binary file follow at once.
    let end = loop {
        let rest = bytes.get(start..MOST_HEADER.min(bytes.len())).unwrap_or_default();
        let Some(length) = rest.iter().position(|byte| [b'\n', b'\r'].contains(byte)) else {
            return Err(Error::invalid(Location::file(path), "its header has no end (`end_header`)"));
        };
        let line = String::from_utf8_lossy(&rest[..length]).trim().to_owned();
        start += length + if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        if line == "end_header" {
            break start;
        }
        lines.push(line);
    };
    let (mut kind, mut elements) = (None, Vec::<Element>::new());
    for (i, line) in lines.iter().enumerate() {
        let wrong = |message: String| Err(Error::invalid(Location::line(path, i + 1), message));
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [] | ["ply"] | ["comment" | "obj_info", ..] => {}
            ["format", name, _] => {
                kind = Some(match name {
                    "ascii" => Kind::Text,
                    "binary_little_endian" => Kind::Little,
                    "binary_big_endian" => Kind::Big,
                    other => return wrong(format!("`{other}` is not a format of PLY")),
                });
            }
            ["element", name, count] => match count.parse().ok().filter(|count| *count <= MOST) {
                Some(count) => elements.push(Element { name: name.to_owned(), count, properties: vec![] }),
                None => return wrong(format!("`{count}` must be a number of elements, {MOST} at most")),
            },
            ["property", ref rest @ ..] => {
                let Some(element) = elements.last_mut() else { return wrong("belongs to no element".to_owned()) };
                let (list, of, name) = match *rest {
                    ["list", count, of, name] => (Some(count), of, name),
                    [of, name] => (None, of, name),
                    _ => return wrong("must be `property TYPE NAME` or `property list TYPE TYPE NAME`".to_owned()),
                };
                let types = [Some(of), list].map(|name| name.map(Type::named));
                match types {
                    [Some(Some(of)), list] if list != Some(None) => {
                        element.properties.push(Property { name: name.to_owned(), of, list: list.flatten() });
                    }
                    _ => {
                        return wrong(
                            "has a type that is not known: char, uchar, short, ushort, int, uint, float, double"
                                .to_owned(),
                        );
                    }
                }
            }
            _ => return wrong(format!("`{}` is not a line of a header", line.chars().take(40).collect::<String>())),
        }
    }
    match kind {
        Some(kind) => Ok(Header { kind, elements, end }),
        None => Err(Error::invalid(Location::file(path), "its header says no `format`")),
    }
}

/// Numbers, one after the other.
struct Numbers<'a> {
    kind: Kind,
    rest: &'a [u8],
}

impl Numbers<'_> {
    /// The next one; `None` where the file ends, or has something else.
    fn next(&mut self, of: Type) -> Option<f64> {
        if self.kind == Kind::Text {
            let begin = self.rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
            let word = &self.rest[begin..];
            let length = word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len());
            self.rest = &word[length..];
            return std::str::from_utf8(&word[..length]).ok()?.parse().ok();
        }
        let (number, rest) = self.rest.split_at_checked(of.size())?;
        self.rest = rest;
        let mut bytes = [0; 8];
        bytes[..number.len()].copy_from_slice(number);
        if self.kind == Kind::Big {
            bytes[..number.len()].reverse();
        }
        Some(of.number(bytes))
    }

    /// The numbers of an element: each property's first, or its list.
    fn element(&mut self, of: &Element, single: &mut [f64], lists: &mut [Vec<f64>]) -> Option<()> {
        for (i, property) in of.properties.iter().enumerate() {
            let Some(count) = property.list else {
                single[i] = self.next(property.of)?;
                continue;
            };
            let count = self.next(count).filter(|n| (0.0..=MOST_CORNERS as f64).contains(n))?;
            lists[i].clear();
            for _ in 0..crate::geometry::whole(count) {
                lists[i].push(self.next(property.of)?);
            }
        }
        Some(())
    }

    /// Whether so many elements can be there: each takes a byte at least.
    fn has_room(&self, of: &Element) -> bool {
        let least: usize = match self.kind {
            Kind::Text => 2 * of.properties.len(),
            _ => of.properties.iter().map(|property| property.list.unwrap_or(property.of).size()).sum(),
        };
        // The last number of a text needs nothing behind it.
        least.saturating_mul(of.count) <= self.rest.len().saturating_add(1)
    }
}

/// Colours of an element that has red, green and blue: where they are among its properties.
fn colours(element: &Element) -> Option<[(usize, Type); 3]> {
    let place = |names: [&str; 2]| {
        let place = names.iter().find_map(|name| element.place(name))?;
        Some((place, element.properties[place].of))
    };
    Some([place(["red", "diffuse_red"])?, place(["green", "diffuse_green"])?, place(["blue", "diffuse_blue"])?])
}

/// A colour, linear: whole numbers are sRGB, 0 to 255, others are linear already.
fn linear(at: [(usize, Type); 3], numbers: &[f64]) -> [f64; 3] {
    at.map(|(place, of)| match of {
        Type::Float(_) => numbers[place].clamp(0.0, 1.0),
        _ => srgb::linear(numbers[place].clamp(0.0, 255.0) / 255.0),
    })
}

/// Reads a file, in its own unit and axes. Faces of more than three corners are cut into triangles. Where faces or vertices have colours, each colour is a material; facets whose
/// corners differ in colour are of a material without one, which the report says.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for a file without faces, one that is cut off, vertices that are not finite, and faces of vertices that there are none of.
pub(crate) fn read(path: &Path) -> Result<MeshFile> {
    let bytes = input::bytes(path, LIMIT)?;
    let input = InputFile::of(path, &bytes);
    let Header { kind, elements, end } = header(&bytes, path)?;
    let mut numbers = Numbers { kind, rest: &bytes[end..] };
    let (mut vertices, mut tints): (Vec<DVec3>, Vec<[f64; 3]>) = Default::default();
    let (mut facets, mut face_of_facet, mut colour_of_facet) = (Vec::new(), Vec::new(), Vec::new());
    let mut ignored = BTreeMap::new();
    let mut blended = 0;
    for element in &elements {
        let (mut single, mut lists) = (vec![0.0; element.properties.len()], vec![vec![]; element.properties.len()]);
        let at = |i: usize| Location::file(path).with_item(format!("{} {i}", element.name));
        let cut_off = |i: usize| Error::invalid(at(i), "is not there, or no number: the file may be cut off");
        if !numbers.has_room(element) {
            return Err(cut_off(element.count));
        }
        let tint_at = colours(element);
        match element.name.as_str() {
            "vertex" => {
                let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(|name| element.place(name)) else {
                    return Err(Error::invalid(Location::file(path), "its vertices have no x, y and z"));
                };
                let known = [x, y, z].into_iter().chain(tint_at.iter().flatten().map(|(place, _)| *place));
                let known: Vec<usize> = known.collect();
                let others = element.properties.iter().enumerate().filter(|(i, _)| !known.contains(i));
                others.for_each(|(_, property)| _ = ignored.insert(format!("vertex {}", property.name), element.count));
                for i in 0..element.count {
                    numbers.element(element, &mut single, &mut lists).ok_or_else(|| cut_off(i))?;
                    let vertex = DVec3::new(single[x], single[y], single[z]);
                    if !vertex.is_finite() {
                        return Err(Error::invalid(at(i), "is not finite"));
                    }
                    vertices.push(vertex);
                    tints.extend(tint_at.map(|at| linear(at, &single)));
                }
            }
            "face" => {
                let place = ["vertex_indices", "vertex_index"].iter().find_map(|name| element.place(name));
                let Some(place) = place.filter(|place| element.properties[*place].list.is_some()) else {
                    return Err(Error::invalid(Location::file(path), "its faces have no list `vertex_indices`"));
                };
                for i in 0..element.count {
                    numbers.element(element, &mut single, &mut lists).ok_or_else(|| cut_off(i))?;
                    let corner = |n: &f64| {
                        let is_there = *n >= 0.0 && *n < vertices.len() as f64 && n.fract() == 0.0;
                        is_there.then(|| index_u32(crate::geometry::whole(*n)))
                    };
                    let corners: Option<Vec<u32>> = lists[place].iter().map(corner).collect();
                    let Some(corners) = corners.filter(|corners| corners.len() >= 3) else {
                        let message =
                            format!("must have three or more of {} vertices, which count from 0", vertices.len());
                        return Err(Error::invalid(at(i), message));
                    };
                    let first = facets.len();
                    match corners[..] {
                        [a, b, c] => facets.push([a, b, c]),
                        _ => triangulate(&corners, &vertices, &mut facets),
                    }
                    let own = tint_at.map(|at| linear(at, &single));
                    for facet in &facets[first..] {
                        let of_corner = |k: usize| tints.get(facet[k] as usize);
                        let shared =
                            of_corner(0).filter(|tint| of_corner(1) == Some(*tint) && of_corner(2) == Some(*tint));
                        blended += usize::from(own.is_none() && !tints.is_empty() && shared.is_none());
                        colour_of_facet.push(own.or(shared.copied()));
                        face_of_facet.push(index_u32(i));
                    }
                }
            }
            "tristrips" => {
                let feature = "strips of triangles: save it with faces".to_owned();
                return Err(Error::Unsupported { at: Location::file(path), feature });
            }
            other => {
                for i in 0..element.count {
                    numbers.element(element, &mut single, &mut lists).ok_or_else(|| cut_off(i))?;
                }
                ignored.insert(other.to_owned(), element.count);
            }
        }
    }
    if facets.is_empty() {
        return Err(Error::invalid(Location::file(path), "has no faces: a cloud of points is not a mesh"));
    }
    let has_polygons = face_of_facet.last().is_some_and(|face| *face as usize + 1 != facets.len());
    let mut file = plain(vertices, facets, 1.0, input, vec![]);
    file.ignored = ignored;
    if has_polygons {
        file.surface.mesh.face_of_facet = face_of_facet;
    }
    let mut report = Report::default();
    if blended > 0 {
        let message = format!("colours that differ between the corners of {blended} facets: a facet has one material");
        report.note(Fate::Dropped, Location::file(path), message);
    }
    file.report = report;
    // Each colour is a material, and what has none another one.
    let mut known: BTreeMap<Option<[u64; 3]>, u16> = BTreeMap::new();
    file.surface.materials.clear();
    for (material, colour) in file.surface.mesh.material.iter_mut().zip(colour_of_facet) {
        let key = colour.map(|colour| colour.map(f64::to_bits));
        let next = file.surface.materials.len();
        let number = match (known.get(&key), u16::try_from(next)) {
            (Some(number), _) => *number,
            (None, Ok(number)) => {
                known.insert(key, number);
                file.surface.materials.push(ObjMaterial { name: String::new(), kd: colour });
                number
            }
            (None, Err(_)) => {
                let message = format!("has more than {} colours: as materials they are too many", u16::MAX);
                return Err(Error::invalid(Location::file(path), message));
            }
        };
        *material = MaterialId(number);
    }
    Ok(file)
}
