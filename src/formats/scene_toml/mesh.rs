//! Meshes: read or made, and placed.

use std::path::Path;

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::error::{Location, number};
use crate::formats::instances_csv;
use crate::formats::mesh_file::{MOST, NamedPose};
use crate::formats::mtl::{self, ObjMaterial};
use crate::formats::recipe_toml::{self, OpenedRecipe};
use crate::formats::{coloured_mesh::Placing, registry};
use crate::geometry::{Copies, FrameCamera, MaterialId, Mesh, Pose, body_from_site, index_u32};
use crate::landscape::{self, LandscapeMaterial};
use crate::report::{Fate, Note};

use super::grain::OfRecipe;
use super::materials::Dictionary;
use super::types::{Coordinates, GivenPose, MeshToml, PoseToml, RecipeToml};
use super::{ROUNDED, TomlReader, UNIT_TOLERANCE};

/// A mesh in its own axes, and where its instances stand.
type Placed = (Mesh, Vec<DAffine3>);

/// What is said of materials that a recipe mixes and a scene does not know.
fn unknown_mixtures(materials: &[LandscapeMaterial], known: &[String]) -> Vec<Note> {
    let mixed = materials.iter().filter(|material| !known.contains(&material.name));
    let of = |material: &LandscapeMaterial| {
        let parts: Vec<String> =
            material.mixture.as_ref()?.iter().map(|(name, share)| format!("{name:?} = {share:?}")).collect();
        let name = &material.name;
        let message = format!("the recipe mixes it: `{name:?} = {{ mixture = {{ {} }} }}`", parts.join(", "));
        Some(Note { at: Location::item(name), fate: Fate::Defaulted, message })
    };
    mixed.filter_map(of).collect()
}

/// A camera that is more sizes of the scene away looks at next to nothing.
const FAR: f64 = 1000.0;

impl MeshToml {
    /// The key that says where it comes from.
    fn source(&self) -> &'static str {
        match (&self.file, &self.obj) {
            (Some(_), _) => "file",
            (None, Some(_)) => "obj",
            (None, None) => "recipe",
        }
    }
}

impl TomlReader<'_> {
    /// All meshes in one, local to the origin, with the dictionary's materials.
    pub(super) fn meshes(&mut self, meshes: &[MeshToml], dictionary: &mut Dictionary) -> Option<Mesh> {
        let mut all = Some(Mesh::default());
        // Where each begins among the vertices of all.
        let mut begins = Vec::new();
        for (i, toml) in meshes.iter().enumerate() {
            if self.interrupted {
                return None;
            }
            let item = format!("mesh[{i}]");
            let mesh = self.mesh(&item, toml, dictionary).map(|(mesh, copies)| {
                if let (Some((model, places)), Some(all)) = (copies, &all) {
                    let first = all.facets.len();
                    self.copies.push(Copies { facets: first..first + mesh.facets.len(), model, places });
                }
                mesh
            });
            if let (Some(mesh), Some(all)) = (&mesh, &all) {
                let is_here = |begin: &usize| all.vertices_m[*begin..].starts_with(&mesh.vertices_m);
                if let Some(other) = begins.iter().position(is_here) {
                    self.note(
                        &item,
                        format!("has the vertices of mesh[{other}], at the same positions: is it given twice?"),
                    );
                }
                begins.push(all.vertices_m.len());
                let first = all.facets.len();
                if let Some(own) = self.grains.last_mut().filter(|own| own.item == format!("{item}.recipe")) {
                    own.facets = first..first + mesh.facets.len();
                }
            }
            match (mesh, &mut all) {
                (Some(mesh), Some(all)) if all.facets.is_empty() => {
                    self.around.append(&mut self.beyond);
                    *all = mesh;
                }
                (Some(mesh), Some(all)) => {
                    let begin = index_u32(all.vertices_m.len());
                    self.around.extend(self.beyond.drain(..).map(|v| v + begin));
                    all.append(mesh);
                }
                (None, _) => all = None,
                (Some(_), None) => {}
            }
        }
        if all.is_some() {
            self.note_unused(dictionary);
        }
        all
    }

    /// A mesh where it stands, or all of its instances where they do; then also one of them in its own axes, and their places.
    fn mesh(&mut self, item: &str, toml: &MeshToml, dictionary: &mut Dictionary) -> Option<(Mesh, Option<Placed>)> {
        let mut pose = toml.recipe.is_none().then(|| self.pose(item, toml));
        let key = |key: &str| format!("{item}.{key}");
        let source = key(toml.source());
        let (mut mesh, materials, doubts) = match (&toml.file, &toml.obj, &toml.recipe) {
            (Some(name), None, None) | (None, Some(name), None) => self.mesh_file(&source, name, toml)?,
            (None, None, Some(recipe)) => {
                let for_files = [
                    (toml.unit_m.is_some(), "unit_m"),
                    (toml.up.is_some(), "up"),
                    (toml.coordinates.is_some(), "coordinates"),
                    (toml.flip.is_some(), "flip"),
                ];
                for (_, name) in for_files.into_iter().filter(|(given, _)| *given) {
                    self.problem(&key(name), "a recipe makes metres, z up, local: this is for meshes of files");
                }
                let made = self.recipe(&source, recipe);
                pose = Some(match made.as_ref().and_then(|made| made.origin_m) {
                    Some(on_body_m) => self.pose_on_body(item, toml, on_body_m),
                    None => self.pose(item, toml),
                });
                let made = made?;
                let doubts = made.doubts();
                self.beyond = made.beyond;
                self.notes.extend(doubts.into_iter().map(|doubt| format!("{source}: {doubt}")));
                if let Some(grain) = made.grain {
                    // Where among all facets is known when the mesh is among all.
                    let facets = 0..made.mesh.facets.len();
                    self.grains.push(OfRecipe { item: source.clone(), grain, facets });
                }
                let mixed = unknown_mixtures(&made.materials, &dictionary.names);
                (made.mesh, mtl::of_landscape(&made.materials), mixed)
            }
            _ => {
                self.problem(item, "give either `file` (or `obj`, which is the same) or `recipe`");
                return None;
            }
        };
        let pose = pose.flatten();
        let mapped = match (&toml.material_map, &pose) {
            (None, _) => Some(None),
            (Some(_), _) if toml.instances.is_some() => {
                self.problem(&key("material_map"), "does not go with `instances`, which are of the same materials");
                None
            }
            (Some(map), Some(pose)) => {
                self.material_map(&key("material_map"), map, (&mesh, pose), dictionary).map(Some)
            }
            (Some(_), None) => None,
        }?;
        // Materials whose every facet the map has another one for need not be known.
        let mut is_needed = vec![mapped.is_none(); materials.len()];
        for (material, of_map) in mesh.material.iter().zip(mapped.iter().flatten()) {
            is_needed[material.0 as usize] |= of_map.is_none();
        }
        let entries: Vec<_> = match &toml.material {
            Some(name) => vec![self.entry_named(&key("material"), name, dictionary); materials.len()],
            None => {
                let needed = materials.iter().zip(&is_needed);
                needed
                    .map(
                        |(m, needed)| if *needed { self.entry_of(&source, m, dictionary) } else { Some(MaterialId(0)) },
                    )
                    .collect()
            }
        };
        let Some(entries) = entries.into_iter().collect::<Option<Vec<_>>>() else {
            // Why a name or colour is not what the dictionary has, if the file is to blame.
            for note in doubts {
                if let Some(problem) = self.problems.last_mut() {
                    let help = problem.help.take().map_or(String::new(), |help| help + "; ");
                    problem.help = Some(format!("{help}{}: {}", note.at, note.message));
                }
            }
            return None;
        };
        if toml.material.is_none() {
            let told = |note: &Note| format!("{source}, {}: {}", note.at, note.message);
            self.notes.extend(doubts.iter().map(told));
        }
        for (facet, material) in mesh.material.iter_mut().enumerate() {
            let of_map = mapped.as_ref().and_then(|mapped| mapped[facet]);
            *material = of_map.unwrap_or(entries[material.0 as usize]);
        }
        let places = match &toml.instances {
            None => None,
            Some(name) => Some(self.instances(&key("instances"), name, &mesh)?),
        };
        let pose = pose?;
        let posed = DAffine3 { matrix3: pose.rotation, translation: pose.translation_m };
        let copies = places.map(|places| {
            let places: Vec<DAffine3> = places.into_iter().map(|place| posed * place).collect();
            let all = mesh.copied(&places);
            (std::mem::replace(&mut mesh, all), places)
        });
        if copies.is_none() {
            mesh.vertices_m.iter_mut().for_each(|vertex| *vertex = pose.point(*vertex));
        }
        if toml.recipe.is_none() {
            self.suspect_unit(item, toml, &mesh);
        }
        if toml.recipe.is_none()
            && let Some(volume_m3) = mesh.enclosed_m3().filter(|volume_m3| *volume_m3 < 0.0)
        {
            let now = toml.flip.unwrap_or(false);
            self.notes.push(format!(
                "{source}: the mesh is inside out (its volume is {volume_m3:.3e} m3): from outside it is black, unless `flip = {}`",
                !now
            ));
        }
        Some((mesh, copies))
    }

    /// Where a table has the instances of a mesh.
    fn instances(&mut self, item: &str, name: &str, mesh: &Mesh) -> Option<Vec<DAffine3>> {
        let read = instances_csv::read(&self.path(name));
        let (places, input) = self.taken(item, read)?;
        self.inputs.push(input);
        let (vertices, facets) = (mesh.vertices_m.len(), mesh.facets.len());
        if places.len().saturating_mul(vertices.max(facets)) > MOST {
            let message = format!(
                "{} instances of a mesh of {facets} facets and {vertices} vertices are more than {MOST} in all",
                places.len()
            );
            self.problem(item, message);
            return None;
        }
        Some(places)
    }

    /// A file's mesh, m, z up, its materials, and doubts about them.
    fn mesh_file(&mut self, item: &str, name: &str, toml: &MeshToml) -> Option<(Mesh, Vec<ObjMaterial>, Vec<Note>)> {
        self.tell("reading meshes", 0, 1);
        let path = self.path(name);
        let read = self.cache.map_or_else(|| registry::mesh(&path, true), |cache| cache.mesh_file(&path));
        self.tell("reading meshes", 1, 1);
        let file = self.taken(item, read)?;
        self.inputs.extend(file.inputs);
        if !file.ignored.is_empty() {
            let list: Vec<String> = file.ignored.iter().map(|(word, n)| format!("{n} x `{word}`")).collect();
            self.notes.push(format!("{item}: statements ignored: {}", list.join(", ")));
        }
        self.notes.extend(file.doubts.iter().map(|note| format!("{item}, {}: {}", note.at, note.message)));
        if let Some(own_m) = file.surface.origin_m.filter(|own_m| *own_m != self.origin_m) {
            self.notes.push(format!("{item}: the file's own origin is {own_m}, m: that of this scene is taken"));
        }
        let placing = Placing { unit_m: toml.unit_m, up: toml.up, flip: toml.flip == Some(true), ..Placing::default() };
        let surface = file.surface.placed(&placing, (file.up, file.unit_m));
        Some((surface.mesh, surface.materials, file.material_doubts))
    }

    /// A scene smaller than a pixel, or tiny compared with its distance from the camera, is probably not in the stated unit.
    pub(super) fn suspect_scale(&mut self, meshes: &[MeshToml], mesh: &Mesh, camera: &FrameCamera) {
        let Some((low, high)) = mesh.bounds_m() else { return };
        let Some(i) = meshes.iter().position(|toml| toml.recipe.is_none()) else { return };
        let item = format!("mesh[{i}].{}", if meshes[i].unit_m.is_some() { "unit_m" } else { meshes[i].source() });
        let size_m = (high - low).length();
        let away_m = (camera.centre_m() - 0.5 * (low + high)).length();
        let pixel_m = camera.mean_pitch() * away_m;
        let (times_away, pixels) = (away_m / size_m, size_m / pixel_m);
        if !(size_m > 0.0 && (times_away > FAR || pixels < 1.0)) {
            return;
        }
        // A thousand times as large, would it be something to look at?
        let is_km = 1e3 * pixels >= 1.0 && times_away <= 1e3 * FAR;
        let unit_m = meshes[i].unit_m.unwrap_or(1.0);
        let likely = if is_km { format!("; in km it would be {}", number(1e3 * unit_m)) } else { String::new() };
        self.notes.push(format!(
            "{item}: all meshes together are {size_m:.3} m across, {pixels:.2e} pixels, and the camera is {times_away:.0} times that away: check `unit_m` ({}{likely})",
            number(unit_m)
        ));
    }

    /// A body whose coordinates end up far from the origin is probably not in the stated unit or frame.
    fn suspect_unit(&mut self, item: &str, toml: &MeshToml, mesh: &Mesh) {
        let Some((lo, hi)) = mesh.bounds_m() else { return };
        let (size_m, away_m) = ((hi - lo).length(), lo.max(DVec3::ZERO).max(-hi).length());
        let item = format!("{item}.{}", if toml.unit_m.is_some() { "unit_m" } else { toml.source() });
        if away_m > 100.0 * size_m.max(1.0) {
            self.notes.push(format!(
                "{item}: the mesh is {size_m:.1} m across and {away_m:.1} m away from the origin: check `unit_m` and `coordinates`"
            ));
        }
    }

    /// Of a recipe that puts its site on a body: axes of the body, from where the site is.
    fn pose_on_body(&mut self, item: &str, toml: &MeshToml, on_body_m: DVec3) -> Option<Pose> {
        if toml.pose.is_some() {
            self.problem(&format!("{item}.pose"), "the recipe puts its site on a body: leave this out");
            return None;
        }
        Some(Pose { rotation: DMat3::IDENTITY, translation_m: on_body_m - self.origin_m })
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
                Some(Pose { rotation: self.body_from_site(&at, "a radial pose")?, translation_m: DVec3::ZERO })
            }
            PoseToml::Given(GivenPose { world_from_mesh_xyzw, translation_m }) => {
                let rotation = self.rotation(&format!("{at}.world_from_mesh_xyzw"), *world_from_mesh_xyzw)?;
                Some(Pose { rotation, translation_m: translation_m.map_or(DVec3::ZERO, DVec3::from_array) })
            }
        }
    }

    /// The axes of the site at the origin, which `what` needs.
    pub(super) fn body_from_site(&mut self, item: &str, what: &str) -> Option<DMat3> {
        let axes = body_from_site(self.origin_m);
        if axes.is_none() {
            let message = format!(
                "{what} needs an origin that is away from the body's centre, at which `origin_m` is: there the zenith is undefined"
            );
            self.helped(
                item,
                message,
                "move `origin_m` to the site, or give rotations and directions in the body's axes",
            );
        } else if self.origin_m.x == 0.0 && self.origin_m.y == 0.0 {
            let note = format!(
                "{item}: the origin is at a pole: east is taken as on the meridian of longitude 0, +y of the body"
            );
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
        axes
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
        let opened = match toml {
            RecipeToml::Given(any) => OpenedRecipe::new(any, self.document.clone(), item, &self.path(""), Vec::new()),
            RecipeToml::File(name) => {
                let path = self.path(name);
                recipe_toml::read(if path.is_file() { &path } else { recipe_toml::preset_or(Path::new(name), &path) })
            }
        };
        let opened = self.taken(item, opened)?;
        self.inputs.extend(opened.inputs.iter().cloned());
        self.notes.extend(opened.notes.iter().map(|note| format!("{item}: {note}")));
        let made = self.cache.map_or_else(|| opened.generate(self.watch), |cache| cache.landscape(&opened, self.watch));
        self.taken(item, made)
    }
}
