//! Any bytes are a glTF file, binary or text, or an error.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::gltf;

fuzz_target!(|bytes: &[u8]| {
    // No buffers lie beside it.
    if let Ok((surface, _, _)) = gltf::parse(bytes, Path::new("/nonexistent/fuzz.gltf"), false) {
        assert!(surface.mesh.vertices_m.iter().all(|v| v.is_finite()));
        let vertices = surface.mesh.vertices_m.len();
        assert!(surface.mesh.facets.iter().flatten().all(|v| (*v as usize) < vertices));
        let _ = gltf::encode(&surface).map(|encoded| encoded.glb());
    }
});
