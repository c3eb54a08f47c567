//! Meshes as text.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Range;

use glam::DVec3;

use crate::formats::mtl::ObjMaterial;
use crate::geometry::{Mesh, index_u32};

use super::polygon::{facets_of_face, polygon};

/// Writes a mesh as OBJ: vertices, then faces grouped by `usemtl` where the material changes, in the mesh's order.
///
/// Facets of one face are written as that face where it will be cut into them again ([`faces_lost`](super::faces_lost) counts the others).
///
/// Coordinates are the shortest decimals that read back as the same f64. `materials` is indexed by the mesh's material
/// ids; `mtllib`, if given, is the name of the file that [`mtl::write`](crate::formats::mtl::write) makes of them.
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

/// As [`write`], in other axes, the faces grouped by statements `statement name(material)`.
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
    let texture = TextureVertices::of(mesh);
    for [u, v] in &texture.list {
        writeln!(text, "vt {u} {v}")?;
        if text.len() >= CHUNK {
            out.write_all(&text)?;
            text.clear();
        }
    }
    let mut current = None;
    let mut first = 0;
    while let (Some(facet), Some(material)) = (mesh.facets.get(first), mesh.material.get(first)) {
        if current != Some(material) {
            let name = name(material.0 as usize);
            // What comes before all names has none.
            if current.is_some() || !name.is_empty() {
                writeln!(text, "{statement} {name}")?;
            }
            current = Some(material);
        }
        let facets = facets_of_face(mesh, first);
        first = facets.end;
        let of_polygon = polygon(mesh, facets.clone());
        let whole = of_polygon.and_then(|corners| Some((texture.of_polygon(mesh, facets.clone(), &corners)?, corners)));
        match whole {
            Some((textures, corners)) => push_face(&mut text, &corners, &textures),
            None if facets.len() == 1 => push_face(&mut text, facet, texture.of_facet(facets.start)),
            None => facets.for_each(|f| push_face(&mut text, &mesh.facets[f], texture.of_facet(f))),
        }
        if text.len() >= CHUNK {
            out.write_all(&text)?;
            text.clear();
        }
    }
    out.write_all(&text)
}

/// Each texture coordinate once, and for each facet which of them its corners have.
struct TextureVertices {
    list: Vec<[f64; 2]>,
    /// From 0; empty without texture coordinates.
    of_facet: Vec<[Option<u32>; 3]>,
}

impl TextureVertices {
    fn of(mesh: &Mesh) -> Self {
        let mut known = BTreeMap::new();
        let mut list = Vec::new();
        let mut number = |uv: [f64; 2]| {
            uv.iter().all(|x| x.is_finite()).then(|| {
                *known.entry(uv.map(f64::to_bits)).or_insert_with(|| {
                    list.push(uv);
                    index_u32(list.len()) - 1
                })
            })
        };
        let of_facet = mesh.uv.iter().map(|corners| corners.map(&mut number)).collect();
        TextureVertices { list, of_facet }
    }

    fn of_facet(&self, facet: usize) -> &[Option<u32>] {
        self.of_facet.get(facet).map_or(&[], |corners| corners)
    }

    /// Those of a face's corners; `None` if its facets do not agree on them.
    fn of_polygon(&self, mesh: &Mesh, facets: Range<usize>, corners: &[u32]) -> Option<Vec<Option<u32>>> {
        if self.of_facet.is_empty() {
            return Some(vec![]);
        }
        let of_corner = |corner: &u32| {
            let all = facets.clone().flat_map(|f| mesh.facets[f].into_iter().zip(self.of_facet[f]));
            let mut own = all.filter(|(v, _)| v == corner).map(|(_, texture)| texture);
            let first = own.next()?;
            own.all(|t| t == first).then_some(first)
        };
        corners.iter().map(of_corner).collect()
    }
}

fn push_face(text: &mut Vec<u8>, corners: &[u32], textures: &[Option<u32>]) {
    text.push(b'f');
    for (k, &vertex) in corners.iter().enumerate() {
        text.push(b' ');
        push_integer(text, u64::from(vertex) + 1);
        if let Some(Some(texture)) = textures.get(k) {
            text.push(b'/');
            push_integer(text, u64::from(*texture) + 1);
        }
    }
    text.push(b'\n');
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
