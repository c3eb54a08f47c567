//! Any bytes are an OBJ file and, behind a byte 0, its materials, or an error; what is written of it is read back.
#![no_main]

use std::path::Path;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::mesh_file::ColouredMesh;
use mmxrt::geometry::{MaterialId, Mesh};
use mmxrt::formats::{gltf, mtl, obj};
use mmxrt::report::Report;

mod files;

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let (mut text, materials) = (&bytes[..end], bytes.get(end + 1..).unwrap_or_default());
    let path = Path::new("fuzz.obj");
    let Some(file) = told(obj::parse(&mut text, path, &mut |_| mtl::parse(materials, Path::new("fuzz.mtl")))) else {
        return;
    };
    assert!(file.facets.iter().flatten().all(|v| (*v as usize) < file.vertices.len()));
    assert!(file.facet_material.iter().all(|m| usize::from(*m) < file.materials.len()));
    assert_eq!(file.facet_material.len(), file.facets.len());
    let mesh = Mesh {
        vertices_m: file.vertices,
        facets: file.facets,
        material: file.facet_material.into_iter().map(MaterialId).collect(),
        face_of_facet: file.face_of_facet,
        uv: file.uv,
    };
    let surface = ColouredMesh { mesh, materials: file.materials, origin_m: None, sun: None };
    let lost = obj::faces_lost(&surface.mesh);
    let mut written = Vec::new();
    obj::write(&mut written, &surface.mesh, &surface.materials, None).unwrap();
    let back = obj::parse(&mut written.as_slice(), path, &mut |_| Ok(Vec::new())).unwrap();
    assert_eq!(back.vertices, surface.mesh.vertices_m);
    assert!(lost > 0 || back.facets == surface.mesh.facets);
    let _ = gltf::encode(&surface).map(|encoded| encoded.glb());
    told(surface.into_scene(path, None, &mut Report::default()));
});
