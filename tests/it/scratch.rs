//! A folder for a test's files.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use mmxrt::formats::mtl::{self, ObjMaterial};
use mmxrt::formats::{obj, scene_toml};
use mmxrt::geometry::Mesh;
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::study::{self, Observation};

/// A folder that goes when the test ends.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    pub(crate) fn new() -> Self {
        static MADE: AtomicU32 = AtomicU32::new(0);
        let number = MADE.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("mmxrt-test-{}-{number}", std::process::id()));
        // One that was left by a process of the same number.
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Scratch(path)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    pub(crate) fn join(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// The path of a file as an argument of a command.
    pub(crate) fn argument(&self, name: &str) -> String {
        self.join(name).into_os_string().into_string().unwrap()
    }

    /// The names of all that is in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = self.0.read_dir().unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.join(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Replaces text that a file has by another.
    pub(crate) fn edit(&self, name: &str, from: &str, to: &str) {
        edit(&self.join(name), from, to);
    }

    /// Writes `name.obj` and `name.mtl`; material i of the mesh gets the i-th name and colour.
    pub(crate) fn obj(&self, name: &str, mesh: &Mesh, materials: &[(&str, Option<[f64; 3]>)]) {
        let materials: Vec<_> =
            materials.iter().map(|(name, kd)| ObjMaterial { name: (*name).to_owned(), kd: *kd }).collect();
        let file = |extension: &str| std::fs::File::create(self.join(&format!("{name}.{extension}"))).unwrap();
        obj::write(&mut file("obj"), mesh, &materials, Some(&format!("{name}.mtl"))).unwrap();
        mtl::write(&mut file("mtl"), &materials).unwrap();
    }

    /// Reads a scene from its text.
    pub(crate) fn scene(&self, text: &str) -> Scene {
        let path = self.write("scene.toml", text);
        scene_toml::read(&path, &unwatched).unwrap_or_else(|e| panic!("{e}\n{text}")).scene
    }

    /// Reads a scene from its text, and looks at it.
    pub(crate) fn look(&self, text: &str) -> Observation {
        study::simulate(&self.scene(text), &unwatched).unwrap().1
    }
}

/// Replaces text that a file has by another.
pub(crate) fn edit(file: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "no {from} in {}", file.display());
    std::fs::write(file, text.replace(from, to)).unwrap();
}

/// Whether tests take as many cases as they can: `MMXRT_HEAVY=1`.
pub(crate) fn is_heavy() -> bool {
    std::env::var("MMXRT_HEAVY").is_ok_and(|v| v == "1")
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
