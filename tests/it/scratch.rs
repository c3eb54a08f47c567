//! A folder for a test's files.

use std::path::{Path, PathBuf};

use mmxrt::formats::mtl::{self, ObjMaterial};
use mmxrt::formats::{obj, scene_toml};
use mmxrt::geometry::Mesh;
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::study::{self, Observation};

/// A folder that goes when the test ends.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    pub(crate) fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mmxrt-test-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Scratch(path)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Writes `name.obj` and `name.mtl`; material i of the mesh gets the i-th name and colour.
    pub(crate) fn obj(&self, name: &str, mesh: &Mesh, materials: &[(&str, Option<[f64; 3]>)]) {
        let materials: Vec<_> =
            materials.iter().map(|(name, kd)| ObjMaterial { name: (*name).to_owned(), kd: *kd }).collect();
        let file = |extension: &str| std::fs::File::create(self.0.join(format!("{name}.{extension}"))).unwrap();
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

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
