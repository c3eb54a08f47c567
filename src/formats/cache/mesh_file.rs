//! Meshes of files, by the hash of the file.

use std::collections::BTreeMap;
use std::path::Path;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::entry::Packed;
use super::{Cache, Kept, Key, mesh};
use crate::error::Result;
use crate::formats::mesh_file::{ColouredMesh, MeshFile, Up};
use crate::formats::mtl::ObjMaterial;
use crate::formats::{InputFile, registry};
use crate::geometry::Direction;
use crate::report::{Note, Report};

/// All of a mesh file but its mesh.
#[derive(Serialize, Deserialize)]
struct Text {
    materials: Vec<ObjMaterial>,
    origin_m: Option<DVec3>,
    sun: Option<DVec3>,
    up: Up,
    unit_m: f64,
    ignored: BTreeMap<String, usize>,
    report: Report,
    doubts: Vec<Note>,
    inputs: Vec<InputFile>,
}

impl Kept for MeshFile {
    const KIND: &'static str = "mesh";

    fn packed(&self) -> Option<Packed> {
        // A file of materials that is not there may be there the next time.
        if self.may_change || !self.material_doubts.is_empty() {
            return None;
        }
        let mut packed = Packed::new(&Text {
            materials: self.surface.materials.clone(),
            origin_m: self.surface.origin_m,
            sun: self.surface.sun.map(Direction::vec),
            up: self.up,
            unit_m: self.unit_m,
            ignored: self.ignored.clone(),
            report: self.report.clone(),
            doubts: self.doubts.clone(),
            inputs: self.inputs.clone(),
        })?;
        mesh::put(&mut packed, &self.surface.mesh);
        Some(packed)
    }
}

/// An entry's mesh file, whose own file is as it is now, if all others that it names are as they were.
fn unpacked(mut packed: Packed, file: &InputFile) -> Option<MeshFile> {
    let Text { materials, origin_m, sun, up, unit_m, ignored, report, doubts, inputs } = packed.text()?;
    let mesh = mesh::take(&mut packed)?;
    let sun = match sun {
        Some(sun) => Some(Direction::from_unit(sun)?),
        None => None,
    };
    // What it names is not in the key.
    let is_unchanged = |input: &InputFile| InputFile::hashed(&input.path).is_ok_and(|now| now == *input);
    let is_whole = mesh.material.iter().all(|material| usize::from(material.0) < materials.len());
    let mut others = inputs.iter().filter(|input| *input != file);
    (is_whole && inputs.contains(file) && others.all(is_unchanged)).then(|| MeshFile {
        surface: ColouredMesh { mesh, materials, origin_m, sun },
        up,
        unit_m,
        ignored,
        report,
        doubts,
        material_doubts: vec![],
        may_change: false,
        inputs,
    })
}

impl Cache {
    /// As [`registry::mesh`], of a file that may name files outside of its folder.
    ///
    /// # Errors
    /// Those of [`registry::mesh`].
    pub(in crate::formats) fn mesh_file(&self, path: &Path) -> Result<MeshFile> {
        let read = || registry::mesh(path, true);
        // Where a link's own folder has not what the file names, that of its target may have it, and the other way round.
        if path.is_symlink() {
            return read();
        }
        let Ok(file) = InputFile::hashed(path) else { return read() };
        let key = Key::of::<MeshFile>().and(path.as_os_str().as_encoded_bytes()).and(file.blake3.as_bytes());
        self.of(&key, |packed| unpacked(packed, &file), read)
    }
}
