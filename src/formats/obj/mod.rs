//! Wavefront OBJ: meshes, in the file's own units, axes and order.
//!
//! Read are `v`, `f` (`a`, `a/b`, `a//c`, `a/b/c`, negative indices), `g`, `usemtl`, `mtllib` and `vt`. Colours of vertices, weights other
//! than 1, and normals (`vn`) that make a face look round are reported in [`ObjFile::report`]; `s` and comments say nothing here. Anything else is
//! counted by its keyword in [`ObjFile::ignored`]. Vertices and faces keep the order of the file.
//!
//! Names are UTF-8, or else Windows-1252. A material file is looked for as it is named, then beside the OBJ file under the last part of its
//! name, in any case; one that is not there is reported: names alone may suffice.
//!
//! # How a face becomes facets
//!
//! A quad is cut along the shorter of its two diagonals (in space; equal: the one from its first corner), unless that
//! diagonal is outside because the quad is concave: then along the other. A face with more corners loses ears: seen
//! along its Newell normal, the first corner (in the order of the face) whose triangle is counter-clockwise and holds
//! no other corner is cut off, and so on. Where there is no such corner (a face that crosses itself, or has no area),
//! the first is cut off. A face of n corners always gives n - 2 facets, which turn the way the face turns.

mod faces;
pub(super) mod format;
mod library;
mod materials;
mod number;
mod parser;
mod polygon;
mod triangulate;
mod write;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};
use std::path::Path;

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::geometry::{MaterialId, Mesh};
use crate::report::{Fate, Note, Report};

use super::input::{self, BYTE_ORDER_MARK, InputFile};
use super::mtl::ObjMaterial;
use library::Libraries;
use parser::Parser;

pub use polygon::faces_lost;
pub(super) use triangulate::triangulate;
pub use write::write;
pub(crate) use write::write_by;

/// Text in memory at a time, bytes; no line is longer.
const BUFFER: usize = 1 << 20;

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
    /// Texture coordinates of each facet's corners, NaN where there are none; empty if no face has any.
    pub uv: Vec<[[f64; 2]; 3]>,
    /// Number of texture coordinates (`vt`).
    pub texture_vertices: usize,
    /// Number of objects (`o`).
    pub objects: usize,
    /// Statements that were passed over, and how many of each.
    pub ignored: BTreeMap<String, usize>,
    /// How the surface should look, where that has no place here: colours of vertices, textures, light, transparency, smooth shading.
    pub report: Report,
    /// What is probably not meant of the mesh, and what was taken all the same.
    pub doubts: Vec<Note>,
    /// The same of its materials.
    pub material_doubts: Vec<Note>,
    /// Whether a material file was looked for in vain that would take another one's place if it came to be.
    pub may_change: bool,
    /// The files that were read: the OBJ, then its material files.
    pub inputs: Vec<InputFile>,
}

impl ObjFile {
    /// Its vertices and facets, in its own unit and axes.
    pub fn mesh(&self) -> Mesh {
        Mesh {
            vertices_m: self.vertices.clone(),
            facets: self.facets.clone(),
            material: self.facet_material.iter().map(|of| MaterialId(*of)).collect(),
            ..Mesh::default()
        }
    }
}

/// Reads an OBJ file and the material files it names, which lie beside it.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with what cannot be used, line by line: coordinates that are not finite numbers,
/// faces with fewer than three corners or with vertices that do not exist, a file without faces. The first 20 are reported, and the
/// number of the rest.
pub fn read(path: &Path) -> Result<ObjFile> {
    read_where(path, true)
}

/// As [`read`]; only material files in the file's folder are read, unless `outside` allows others.
///
/// # Errors
/// As [`read`].
pub fn read_where(path: &Path, outside: bool) -> Result<ObjFile> {
    let file = input::open(path).map_err(|e| Error::io(path, "reading", e))?;
    let mut source = input::Hashing::new(file);
    let mut libraries =
        Libraries { path, outside, inputs: Vec::new(), losses: Vec::new(), doubts: Vec::new(), may_change: false };
    let mut obj = parse(&mut source, path, &mut |name| libraries.load(name))?;
    obj.inputs.push(source.finish(path));
    obj.inputs.append(&mut libraries.inputs);
    obj.material_doubts.append(&mut libraries.doubts);
    obj.may_change = libraries.may_change;
    let used: BTreeSet<&str> = obj.materials.iter().map(|material| material.name.as_str()).collect();
    for (name, at, what) in libraries.losses {
        if used.contains(name.as_str()) {
            obj.report.note(Fate::Dropped, at, format!("of material {name:?}: {what}"));
        }
    }
    Ok(obj)
}

/// Reads the text of an OBJ file. `path` is for messages; `load_mtl` gives the materials of a `mtllib` name.
///
/// # Errors
/// As [`read`].
pub fn parse(
    source: &mut (dyn Read + Send),
    path: &Path,
    load_mtl: &mut (dyn FnMut(&str) -> Result<Vec<ObjMaterial>> + Send),
) -> Result<ObjFile> {
    let mut parser = Parser::new(path, load_mtl);
    // Whole lines, a buffer at a time: the text is parsed while it is in the cache, and never all in memory; the next buffer is read, and
    // its bytes are hashed, meanwhile.
    let (mut text, mut next) = (vec![0; BUFFER], vec![0; BUFFER]);
    let (mut filled, mut offset) = (0, 0);
    let mut read = fill(source, &mut text);
    if [[0xff, 0xfe], [0xfe, 0xff]].iter().any(|mark| text.starts_with(mark)) {
        return Err(Error::syntax(Location::file(path), "UTF-16 text: save the file as UTF-8"));
    }
    let mut skipped = if text.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
    loop {
        let n = read.map_err(|e| Error::io(path, "reading", e))?;
        let end = filled + n;
        if n == 0 {
            parser.lines(&text[skipped..end], offset);
            return parser.finish();
        }
        let whole = memchr::memrchr(b'\n', &text[..end]).map_or(0, |i| i + 1);
        if whole == 0 && end == BUFFER {
            let message = format!("a line of more than {BUFFER} bytes: is it an OBJ file?");
            return Err(Error::syntax(Location::line(path, parser.next_line()), message));
        }
        filled = end - whole;
        next[..filled].copy_from_slice(&text[whole..end]);
        let lines = &text[skipped.min(whole)..whole];
        ((), read) = rayon::join(|| parser.lines(lines, offset), || fill(source, &mut next[filled..]));
        offset += lines.len();
        if whole > 0 {
            skipped = 0;
        }
        std::mem::swap(&mut text, &mut next);
    }
}

/// Reads until a buffer is full or nothing more comes.
fn fill(source: &mut dyn Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match source.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::mtl;
    use crate::geometry::{MaterialId, Mesh};

    fn parsed(text: &str) -> Result<ObjFile> {
        parse(&mut text.as_bytes(), Path::new("a.obj"), &mut |name| {
            Err(Error::io(name, "reading", io::ErrorKind::NotFound.into()))
        })
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
    fn corners_keep_their_texture_coordinates() {
        // A triangle without any, one with, and a concave quad, whose cut starts at its second corner.
        let text = "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt .25 .25 0\nvt 0 1\nf 1 2 3\nf 1/1 2/2 3/3\nf 1/1 2/2 3/-2 4/4\n";
        let obj = parsed(text).unwrap();
        assert_eq!(obj.facets[2..], [[0, 1, 2], [0, 2, 3]]);
        assert!(obj.uv[0].iter().flatten().all(|x| x.is_nan()));
        assert_eq!(
            obj.uv[1..],
            [
                [[0.0, 0.0], [1.0, 0.0], [0.25, 0.25]],
                [[0.0, 0.0], [1.0, 0.0], [0.25, 0.25]],
                [[0.0, 0.0], [0.25, 0.25], [0.0, 1.0]]
            ]
        );
        let mesh = Mesh {
            vertices_m: obj.vertices.clone(),
            facets: obj.facets.clone(),
            material: obj.facet_material.iter().map(|m| MaterialId(*m)).collect(),
            face_of_facet: obj.face_of_facet.clone(),
            uv: obj.uv.clone(),
        };
        let mut text = Vec::new();
        write(&mut text, &mesh, &[], None).unwrap();
        let again = parsed(&String::from_utf8(text).unwrap()).unwrap();
        assert_eq!(
            (&again.facets, &again.face_of_facet, &again.uv[1..]),
            (&obj.facets, &obj.face_of_facet, &obj.uv[1..])
        );
        let wrong =
            parsed("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt x 0\nf 1/1 2/2 3/0\nf 1/1 2/5 3/1\n").unwrap_err().to_string();
        for part in [
            "a.obj:4: u of the texture coordinates is `x`",
            "a.obj:5: texture index 0",
            "a.obj:6: texture index 5: the file has 1",
        ] {
            assert!(wrong.contains(part), "{wrong}");
        }
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
        let text = "v 0 0 nan\nv 1 x 0\nv 1\nv 1 1 inf\nf 1 2\nf 0 1 2\nf 1 2 9\nf 1 2 -9\nf 1 2 x\nf 1 2 3/x\n";
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

    #[test]
    fn facets_know_the_face_they_were_cut_from() {
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
        Mesh { vertices_m, facets, material, face_of_facet: vec![], uv: vec![] }
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
