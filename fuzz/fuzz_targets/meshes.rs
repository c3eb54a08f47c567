//! Any bytes are a mesh of STL, PLY, a table, quadrilaterals or a shape kernel, or an error. Pieces replace good files, as `files.rs` says.
#![no_main]

use std::sync::LazyLock;

use files::{Folder, told};
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::registry;

mod files;

/// Of `tests/data/meshes`, in the order of their names, as the numbers of pieces count them; and two that are short.
macro_rules! meshes {
    ($($name:literal),*) => { [
        ("body.icq", b"1\n0 0 0\n".as_slice()),
        ("body.tab", b"3 1\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1 1 2 3\n".as_slice()),
        $(($name, include_bytes!(concat!("../../tests/data/meshes/", $name)).as_slice())),*
    ] };
}
static GOOD: [(&str, &[u8]); 8] = meshes!(
    "ellipsoid.bds",
    "meshio.ply",
    "meshio_text.ply",
    "plyfile_big.ply",
    "trimesh.stl",
    "trimesh_text.stl"
);
static FOLDER: LazyLock<Folder> = LazyLock::new(|| Folder::holding("meshes", &GOOD));

fuzz_target!(|data: &[u8]| FOLDER.with(data, |folder| {
    for (name, _) in GOOD {
        if let Some(file) = told(registry::mesh(&folder.join(name), true)) {
            let mesh = &file.surface.mesh;
            assert!(mesh.facets.iter().flatten().all(|vertex| (*vertex as usize) < mesh.vertices_m.len()));
            assert!(mesh.vertices_m.iter().all(|vertex| vertex.is_finite()));
        }
    }
}));
