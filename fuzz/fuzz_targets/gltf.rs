//! Any bytes are a glTF file, binary or text, or an error.
//!
//! What is neither is a text and, behind a byte 0, a buffer: they are put into a GLB, and beside one another.
#![no_main]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::gltf;
use mmxrt::report::Report;

mod files;

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("gltf"));

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.iter().position(|b| *b == 0);
    match end {
        Some(end) if !bytes.starts_with(b"glTF") => {
            let (json, buffer) = (&bytes[..end], &bytes[end + 1..]);
            read(&glb(json, buffer), Path::new("/nonexistent/fuzz.glb"));
            std::fs::write(FOLDER.join("fuzz.bin"), buffer).unwrap();
            read(json, &FOLDER.join("fuzz.gltf"));
        }
        _ => read(bytes, Path::new("/nonexistent/fuzz.gltf")),
    }
});

fn glb(json: &[u8], buffer: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", buffer)] {
        chunks.extend((chunk.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(chunk);
    }
    [&b"glTF"[..], &2_u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

fn read(bytes: &[u8], path: &Path) {
    if let Some((surface, _, _)) = told(gltf::parse(bytes, path, false)) {
        assert!(surface.mesh.vertices_m.iter().all(|v| v.is_finite()));
        let vertices = surface.mesh.vertices_m.len();
        assert!(surface.mesh.facets.iter().flatten().all(|v| (*v as usize) < vertices));
        let _ = gltf::encode(&surface).map(|encoded| encoded.glb());
        told(surface.into_scene(path, None, &mut Report::default()));
    }
}
