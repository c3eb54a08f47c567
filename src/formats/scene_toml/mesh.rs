//! Meshes: read or made, and placed.

use glam::{DMat3, DQuat, DVec3};

use crate::formats::mtl::{self, ObjMaterial};
use crate::formats::{obj, recipe_toml};
use crate::geometry::{Direction, MaterialId, Mesh, Pose};
use crate::landscape;
use crate::progress::Progress;

use super::Reader;
use super::materials::Dictionary;
use super::types::{Coordinates, GivenPose, MeshToml, NamedPose, PoseToml, RecipeToml, Up};

/// Unit vectors and quaternions have length 1 to within this.
pub(super) const UNIT_TOLERANCE: f64 = 1e-9;
/// What is farther off than this is no rounding: axes and quaternions of length 1, and shares that add up to 1.
pub(super) const ROUNDED: f64 = 0.01;

impl Reader<'_> {
    /// All meshes in one, local to the origin, with the dictionary's materials.
    pub(super) fn meshes(&mut self, meshes: &[MeshToml], dictionary: &mut Dictionary) -> Option<Mesh> {
        let mut all = Some(Mesh::default());
        for (i, toml) in meshes.iter().enumerate() {
            if self.interrupted {
                return None;
            }
            let item = format!("mesh[{i}]");
            match (self.mesh(&item, toml, dictionary), &mut all) {
                (Some(mesh), Some(all)) if all.facets.is_empty() => *all = mesh,
                (Some(mesh), Some(all)) => all.append(mesh),
                (None, _) => all = None,
                (Some(_), None) => {}
            }
        }
        if all.is_some() {
            self.note_unused(dictionary);
        }
        all
    }

    fn mesh(&mut self, item: &str, toml: &MeshToml, dictionary: &mut Dictionary) -> Option<Mesh> {
        let pose = self.pose(item, toml);
        let key = |key: &str| format!("{item}.{key}");
        let (mut mesh, materials) = match (&toml.obj, &toml.recipe) {
            (Some(name), None) => self.obj(&key("obj"), name)?,
            (None, Some(recipe)) => {
                let for_obj = [
                    (toml.unit_m.is_some(), "unit_m"),
                    (toml.up.is_some(), "up"),
                    (toml.coordinates.is_some(), "coordinates"),
                ];
                for (_, name) in for_obj.into_iter().filter(|(given, _)| *given) {
                    self.problem(&key(name), "a recipe makes metres, z up, local: this is for OBJ files");
                }
                (self.recipe(&key("recipe"), recipe)?.mesh, mtl::of_landscapes())
            }
            _ => {
                self.problem(item, "give either `obj` or `recipe`");
                return None;
            }
        };
        let source = if toml.obj.is_some() { key("obj") } else { key("recipe") };
        let entries: Vec<_> = match &toml.material {
            Some(name) => vec![self.entry_named(&key("material"), name, dictionary); materials.len()],
            None => materials.iter().map(|m| self.entry_of(&source, m, dictionary)).collect(),
        };
        let entries: Vec<_> = entries.into_iter().collect::<Option<_>>()?;
        for material in &mut mesh.material {
            *material = entries[material.0 as usize];
        }
        let pose = pose?;
        let unit_m = toml.unit_m.unwrap_or(1.0);
        let up = toml.up.unwrap_or(Up::Z);
        for vertex in &mut mesh.vertices_m {
            let v = match up {
                Up::Z => *vertex,
                Up::Y => DVec3::new(vertex.x, -vertex.z, vertex.y),
            };
            *vertex = pose.point(v * unit_m);
        }
        self.suspect_unit(item, toml, &mesh);
        Some(mesh)
    }

    /// A mesh in the file's own unit and axes, and its materials.
    fn obj(&mut self, item: &str, name: &str) -> Option<(Mesh, Vec<ObjMaterial>)> {
        self.tell("reading meshes", 0, 1);
        let read = obj::read(&self.path(name));
        self.tell("reading meshes", 1, 1);
        let obj = self.taken(item, read)?;
        self.inputs.extend(obj.inputs);
        if !obj.ignored.is_empty() {
            let list: Vec<String> = obj.ignored.iter().map(|(word, n)| format!("{n} x `{word}`")).collect();
            self.notes.push(format!("{item}: statements passed over: {}", list.join(", ")));
        }
        let material = obj.facet_material.into_iter().map(MaterialId).collect();
        let mesh = Mesh {
            vertices_m: obj.vertices,
            facets: obj.facets,
            material,
            face_of_facet: obj.face_of_facet,
            uv: obj.uv,
        };
        Some((mesh, obj.materials))
    }

    /// A body's coordinates that end far from the origin are probably not in the unit or the frame that was said.
    fn suspect_unit(&mut self, item: &str, toml: &MeshToml, mesh: &Mesh) {
        let Some((lo, hi)) = mesh.bounds_m() else { return };
        let (size_m, away_m) = ((hi - lo).length(), lo.max(DVec3::ZERO).max(-hi).length());
        let item = format!("{item}.{}", if toml.unit_m.is_some() { "unit_m" } else { "obj" });
        if toml.obj.is_some() && away_m > 100.0 * size_m.max(1.0) {
            self.notes.push(format!(
                "{item}: the mesh is {size_m:.1} m across and {away_m:.1} m away from the origin: check `unit_m` and `coordinates`"
            ));
        }
    }

    fn pose(&mut self, item: &str, toml: &MeshToml) -> Option<Pose> {
        let at = format!("{item}.pose");
        let given = match (&toml.pose, toml.recipe.is_some()) {
            (Some(pose), _) => pose,
            (None, true) => {
                self.stated(&at, "radial");
                &PoseToml::Named(NamedPose::Radial)
            }
            (None, false) => &PoseToml::Named(NamedPose::Body),
        };
        if toml.coordinates == Some(Coordinates::Body) {
            if !matches!(given, PoseToml::Named(NamedPose::Body)) {
                self.problem(&at, "coordinates of the body have the body's pose: leave this out");
                return None;
            }
            return Some(Pose { rotation: DMat3::IDENTITY, translation_m: -self.origin_m });
        }
        match given {
            PoseToml::Named(NamedPose::Body) => Some(Pose::IDENTITY),
            PoseToml::Named(NamedPose::Radial) => {
                let Some(up) = Direction::new(self.origin_m) else {
                    self.helped(
                        &at,
                        "a radial pose needs an origin that is away from the body's centre, where no direction is up",
                        "give `origin_m`, or the pose as `world_from_mesh_xyzw`",
                    );
                    return None;
                };
                let east = Direction::new(DVec3::Z.cross(self.origin_m)).unwrap_or_else(|| {
                    self.notes.push(format!("{at}: at a pole no direction is east: taken is x of the body"));
                    Direction::new(DVec3::X).expect("x has a direction")
                });
                let (up, east) = (up.vec(), east.vec());
                Some(Pose { rotation: DMat3::from_cols(east, up.cross(east), up), translation_m: DVec3::ZERO })
            }
            PoseToml::Given(GivenPose { world_from_mesh_xyzw, translation_m }) => {
                let rotation = self.rotation(&format!("{at}.world_from_mesh_xyzw"), *world_from_mesh_xyzw)?;
                Some(Pose { rotation, translation_m: translation_m.map_or(DVec3::ZERO, DVec3::from_array) })
            }
        }
    }

    pub(super) fn rotation(&mut self, item: &str, xyzw: [f64; 4]) -> Option<DMat3> {
        let q = DQuat::from_array(xyzw);
        let off = (q.length() - 1.0).abs();
        if !(0.0..=ROUNDED).contains(&off) {
            self.problem(item, format!("a rotation is a quaternion of length 1; this one has {}", q.length()));
            return None;
        }
        if off > UNIT_TOLERANCE {
            self.notes.push(format!("{item}: a rounded quaternion, whose length is {off:.1e} off 1: it is made 1"));
        }
        Some(DMat3::from_quat(q.normalize()))
    }

    fn recipe(&mut self, item: &str, toml: &RecipeToml) -> Option<landscape::Landscape> {
        let watch = self.watch;
        let told = |share: f64| watch(Progress::of_share("making the landscape", share));
        let made = match toml {
            RecipeToml::Given(recipe) => {
                landscape::generate(recipe, &told).map_err(|e| recipe_toml::placed(e, &self.document, item))
            }
            RecipeToml::File(name) => {
                let read = recipe_toml::read(&self.path(name));
                let (recipe, input) = self.taken(item, read)?;
                self.inputs.push(input);
                landscape::generate(&recipe, &told)
            }
        };
        self.taken(item, made)
    }
}
