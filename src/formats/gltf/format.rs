//! What glTF files say of themselves.

use std::path::Path;

use crate::error::Result;
use crate::formats::format::{Format, Holds, ending};
use crate::formats::marks;
use crate::formats::mesh_file::{MeshFile, Up};
use crate::report::Note;

/// glTF 2.0 as text, with its buffers.
pub(in crate::formats) static TEXT: Format = Format {
    name: "gltf",
    extensions: &["gltf"],
    reads: "meshes of the default scene, texture coordinates, names and colours of materials, origin",
    writes: "the same, in f32 with residuals, and a .bin",
    mark: &[],
    // What is called .glb and is none: its reader says why.
    told: Some(|path, beginning| (is_text(beginning) && ending(path) != "glb").then(|| path.to_owned())),
    holds: Holds::Mesh { read },
};

/// glTF 2.0 in one binary file.
pub(in crate::formats) static BINARY: Format = Format {
    name: "glb",
    extensions: &["glb"],
    reads: "as gltf",
    writes: "as gltf, in one file",
    mark: marks::GLB,
    told: None,
    holds: Holds::Mesh { read },
};

/// Whether bytes are the start of a glTF file that is text.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
    bytes[start..].starts_with(b"{") && memchr::memmem::find(bytes, b"\"asset\"").is_some()
}

/// A file's mesh, in metres, z up.
fn read(path: &Path, outside: bool) -> Result<MeshFile> {
    let (surface, mut report, inputs) = super::read(path, outside)?;
    let is_of_looks = |note: &Note| {
        let item = note.at.item.as_deref().unwrap_or_default();
        item.starts_with("materials") || item.contains("attributes")
    };
    let (looks, doubts) = report.notes.into_iter().partition(is_of_looks);
    report.notes = looks;
    let (ignored, material_doubts) = Default::default();
    Ok(MeshFile {
        surface,
        up: Up::Y,
        unit_m: 1.0,
        ignored,
        report,
        doubts,
        material_doubts,
        may_change: false,
        inputs,
    })
}
