//! What OBJ files say of themselves.

use std::path::Path;

use crate::error::{Location, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::mesh_file::{ColouredMesh, MeshFile, Up};
use crate::geometry::{MaterialId, Mesh};
use crate::report::{Fate, Report};

/// Wavefront OBJ with its MTL.
pub(in crate::formats) static OBJ: Format = Format {
    name: "obj",
    extensions: &["obj"],
    reads: "mesh, names and colours of materials",
    writes: "the same",
    mark: &[],
    told: Some(|path, beginning| is_begun(beginning).then(|| path.to_owned())),
    holds: Holds::Mesh { read },
};

/// Statements that may come before the first vertex.
const BEFORE: [&str; 7] = ["mtllib", "o", "g", "usemtl", "s", "vn", "vt"];

/// Whether a text is one by its first statements, which lead to a vertex.
fn is_begun(beginning: &[u8]) -> bool {
    let text = String::from_utf8_lossy(beginning);
    let statements = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let mut words = statements.map(str::split_whitespace).filter_map(|mut words| Some((words.next()?, words)));
    let vertex = words.find(|(word, _)| !BEFORE.contains(word));
    vertex
        .is_some_and(|(word, numbers)| word == "v" && numbers.take(3).filter(|n| n.parse::<f64>().is_ok()).count() == 3)
}

/// A file's mesh, in its own unit and axes.
fn read(path: &Path, outside: bool) -> Result<MeshFile> {
    let obj = super::read_where(path, outside)?;
    let mut report = Report::default();
    let mut dropped = |what: String| report.note(Fate::Dropped, Location::file(path), what);
    if obj.texture_vertices > 0 && obj.uv.is_empty() {
        dropped(format!("{} texture coordinates that no face uses", obj.texture_vertices));
    }
    let parts = obj.groups.len().max(obj.objects);
    if parts > 1 {
        dropped(format!("which of {parts} objects or groups a face belongs to"));
    }
    report.notes.extend(obj.report.notes);
    let mesh = Mesh {
        vertices_m: obj.vertices,
        facets: obj.facets,
        material: obj.facet_material.into_iter().map(MaterialId).collect(),
        face_of_facet: obj.face_of_facet,
        uv: obj.uv,
    };
    Ok(MeshFile {
        surface: ColouredMesh { mesh, materials: obj.materials, origin_m: None, sun: None },
        up: Up::Z,
        unit_m: 1.0,
        ignored: obj.ignored,
        report,
        doubts: obj.doubts,
        material_doubts: obj.material_doubts,
        may_change: obj.may_change,
        inputs: obj.inputs,
    })
}
