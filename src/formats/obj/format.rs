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
    told: None,
    holds: Holds::Mesh { read },
};

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
        ignored: obj.ignored,
        report,
        doubts: obj.doubts,
        material_doubts: obj.material_doubts,
        inputs: obj.inputs,
    })
}
