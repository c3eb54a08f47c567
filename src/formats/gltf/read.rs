//! Reading glTF: node hierarchy, primitives, materials, the Sun.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::rc::Rc;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::Value;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::input::{self, InputFile};
use crate::formats::mesh_file::{ColouredMesh, FLAT, MOST};
use crate::formats::mtl::{self, ObjMaterial};
use crate::geometry::{Direction, MaterialId, Mesh, NO_UV, index_u32, whole_u32};
use crate::report::{Fate, Report};

use super::RESIDUAL;
use super::accessor::Data;
use super::container::{LIMIT, buffers, chunks};
use super::extensions::{self, INSTANCING, LIGHTS, SPECULAR, VISIBILITY};
use super::instances::instances;
use super::json::{Light, LightOfNode, Lights, Node, Primitive, Root, SpecularGlossiness, Visibility, extension};
use crate::formats::marks::GLB;

/// Reads the default scene of a `.gltf` or `.glb` file as one mesh, in metres, z up, with what of the file has no place in it.
///
/// `outside`: buffers may lie outside the file's folder.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] where it is not JSON or not a GLB; [`Error::Invalid`] with the item that cannot be used: an
/// index, offset or count beyond what there is, a position that is not finite, a node that is reached twice, a buffer outside the
/// folder; [`Error::Unsupported`] for a version that is not known, compressed geometry, or an extension that may move or add geometry.
pub fn read(path: &Path, outside: bool) -> Result<(ColouredMesh, Report, Vec<InputFile>)> {
    parse(&input::bytes(path, LIMIT)?, path, outside)
}

/// Reads the bytes of such a file; `path` is for messages, and for the buffers that lie beside it.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], path: &Path, outside: bool) -> Result<(ColouredMesh, Report, Vec<InputFile>)> {
    let mut inputs = vec![InputFile::of(path, bytes)];
    let (json, binary) = if bytes.starts_with(GLB) { chunks(bytes, path)? } else { (bytes, None) };
    let root: Root = serde_json::from_slice(json).map_err(|e| {
        let place = Location { column: Some(e.column()), ..Location::line(path, e.line()) };
        let place = if binary.is_some() { place.with_item("JSON chunk") } else { place };
        let message = e.to_string();
        // Serde says the place once more.
        Error::syntax(place, message.split(" at line ").next().unwrap_or(&message))
    })?;
    let mut data = Data { path, root, buffers: Vec::new() };
    known(&data)?;
    data.buffers = buffers(&data, binary, outside, &mut inputs)?;
    let mut uses = vec![0; data.root.meshes.len()];
    for mesh in data.root.nodes.iter().filter_map(|node| node.mesh) {
        uses.get_mut(mesh).into_iter().for_each(|uses| *uses += 1);
    }
    let mut reader = Reader {
        data: &data,
        mesh: Mesh::default(),
        objects: 0,
        uses,
        known: BTreeMap::new(),
        materials: Vec::new(),
        index_of_material: BTreeMap::new(),
        lights: None,
        sun: None,
        report: Report::default(),
        told: BTreeSet::new(),
    };
    reader.scene()?;
    let origin_m = reader.origin_m()?;
    let Reader { mesh, materials, sun, report, .. } = reader;
    if mesh.facets.is_empty() {
        return data.wrong("meshes", "the scene has no triangles");
    }
    let sun = sun.map(|sun| sun.direction);
    Ok((ColouredMesh { mesh, materials, origin_m, sun }, report, inputs))
}

/// Refuses versions and extensions that are not known.
fn known(data: &Data<'_>) -> Result<()> {
    let unsupported = |item: String, feature: String| Err(Error::Unsupported { at: data.at(item), feature });
    let version = &data.root.asset.version;
    if version.is_empty() {
        return data.wrong("asset.version", "is missing: is this a glTF file?");
    }
    if version.split('.').next() != Some("2") {
        return unsupported("asset.version".into(), format!("version {version} of glTF"));
    }
    extensions::known(data)
}

struct Reader<'a> {
    data: &'a Data<'a>,
    mesh: Mesh,
    /// Meshes that were taken, instance by instance.
    objects: usize,
    /// Of each mesh, the nodes that have it.
    uses: Vec<usize>,
    /// Meshes that several nodes have, with the nodes' own weights of morph targets.
    known: BTreeMap<(usize, Vec<u64>), Rc<UnplacedMesh>>,
    materials: Vec<ObjMaterial>,
    index_of_material: BTreeMap<MaterialKey, usize>,
    /// The file's lights, once a node has one.
    lights: Option<Vec<Light>>,
    sun: Option<SunLight>,
    report: Report,
    /// Items and messages already reported.
    told: BTreeSet<(String, String)>,
}

/// A directional light.
struct SunLight {
    direction: Direction,
    intensity_lx: f64,
    item: String,
}

/// A material's name, and the bits of its colour.
type MaterialKey = (String, Option<[u64; 3]>);

/// A mesh as it is before it is placed.
struct UnplacedMesh {
    blocks: Vec<Block>,
    triangles: Vec<Triangles>,
}

/// What the positions of a primitive are made of: accessors of positions and of their residuals, and of morph targets, with the bits of
/// their weights.
type Positions = (usize, Option<usize>, Vec<(usize, u64)>);

/// Positions that primitives share, in glTF's axes.
struct Block {
    item: String,
    vertices: Vec<DVec3>,
}

/// The triangles of a primitive.
struct Triangles {
    block: usize,
    corners: Vec<[u32; 3]>,
    material: MaterialId,
    /// Texture coordinates of the primitive's vertices, v up; empty if it has none.
    uv: Vec<[f64; 2]>,
}

impl Reader<'_> {
    fn dropped(&mut self, item: impl Into<String>, message: impl Into<String>) {
        self.tell(Fate::Dropped, item, message);
    }

    fn tell(&mut self, fate: Fate, item: impl Into<String>, message: impl Into<String>) {
        // An instance of a mesh loses what the mesh loses: reported once.
        let (item, message) = (item.into(), message.into());
        if self.told.insert((item.clone(), message.clone())) {
            self.report.note(fate, self.data.at(item), message);
        }
    }

    /// Tells properties of one's own that have no place in a mesh, but for the one that is read.
    fn extras(&mut self, item: &str, extras: &Value, read: &str) {
        const TOLD: usize = 12;
        let names: Vec<&str> = extras.as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect();
        let names: Vec<&str> = names.into_iter().filter(|name| *name != read).take(TOLD).collect();
        if !names.is_empty() {
            self.dropped(format!("{item}.extras"), format!("custom properties: {}", names.join(", ")));
        }
    }

    /// Takes all that the default scene shows.
    fn scene(&mut self) -> Result<()> {
        let data = self.data;
        let root = &data.root;
        let shown = root.scene.unwrap_or(0);
        let roots = match (root.scenes.is_empty(), root.scene) {
            (false, _) => data.element(&root.scenes, "scenes", shown, "scene")?.nodes.clone(),
            (true, Some(_)) => return data.wrong("scene", "the file has no scenes"),
            (true, None) => {
                let message = "the file has no scene: all nodes without a parent are taken";
                self.report.note(Fate::Defaulted, data.at("scenes"), message);
                let children: BTreeSet<usize> = root.nodes.iter().flat_map(|n| n.children.iter().copied()).collect();
                (0..root.nodes.len()).filter(|i| !children.contains(i)).collect()
            }
        };
        if let Some(scene) = root.scenes.get(shown) {
            self.extras(&format!("scenes[{shown}]"), &scene.extras, "origin_m");
        }
        for other in (0..root.scenes.len()).filter(|i| *i != shown) {
            self.dropped(format!("scenes[{other}]"), "another scene than the default one");
        }
        if !root.animations.is_empty() {
            self.dropped("animations", "all is taken at rest");
        }
        for (i, name) in extensions::dropped(data) {
            self.dropped(format!("extensionsUsed[{i}]"), format!("what {name} adds"));
        }
        // Own stack: the hierarchy may be as deep as the file is long.
        let mut reached = vec![false; root.nodes.len()];
        let mut open: Vec<(usize, DAffine3, String)> = Vec::new();
        let named = |list: &[usize], item: String, world: DAffine3, open: &mut Vec<_>| {
            open.extend(list.iter().rev().map(|&node| (node, world, item.clone())));
        };
        named(&roots, format!("scenes[{shown}].nodes"), DAffine3::IDENTITY, &mut open);
        while let Some((i, parent, from)) = open.pop() {
            let node = data.element(&root.nodes, "nodes", i, &from)?;
            let item = format!("nodes[{i}]");
            if std::mem::replace(&mut reached[i], true) {
                return data.wrong(item, "is reached twice: nodes form trees");
            }
            self.extras(&item, &node.extras, "");
            let world = parent * local(data, node, &item)?;
            if !world.is_finite() {
                return data.wrong(item, "its place in the scene is not finite");
            }
            if is_hidden(data, node, &item)? {
                self.dropped(&*item, "is hidden, with all that is below it");
                continue;
            }
            self.mesh_of(node, &world, &item)?;
            self.light(node, &world, &item)?;
            if node.camera.is_some() {
                self.dropped(&*item, "a camera");
            }
            named(&node.children, format!("{item}.children"), world, &mut open);
        }
        if self.objects > 1 {
            self.dropped("nodes", format!("which of {} objects a triangle belongs to, and their names", self.objects));
        }
        if let Some(sun) = &self.sun {
            let (item, lx) = (sun.item.clone(), sun.intensity_lx);
            self.dropped(
                item,
                format!("{lx} lx, and the colour of the light: only its direction is read, as that of the Sun"),
            );
        }
        Ok(())
    }

    /// Takes the mesh of a node, once or as often as it is instanced.
    fn mesh_of(&mut self, node: &Node, world: &DAffine3, item: &str) -> Result<()> {
        let Some(mesh) = node.mesh else {
            if node.extensions.contains_key(INSTANCING) {
                self.dropped(item, "instances of nothing: the node has no mesh");
            }
            return Ok(());
        };
        if node.skin.is_some() {
            let feature = "a skin, whose joints say where the mesh is (apply it in the program that made the file, in Blender the modifier Armature)";
            return Err(Error::Unsupported { at: self.data.at(format!("{item}.skin")), feature: feature.into() });
        }
        let known = (mesh, node.weights.iter().map(|weight| weight.to_bits()).collect::<Vec<u64>>());
        let parts = match self.known.get(&known) {
            Some(parts) => Rc::clone(parts),
            None => {
                let parts = Rc::new(self.parts(mesh, &node.weights, item)?);
                if self.uses[mesh] > 1 {
                    self.known.insert(known, Rc::clone(&parts));
                }
                parts
            }
        };
        if parts.blocks.iter().all(|block| block.vertices.is_empty()) {
            return Ok(());
        }
        let Some((places, others)) = instances(self.data, node, item)? else { return self.place(&parts, world) };
        if !others.is_empty() {
            self.dropped(item, format!("of its instances: {}", others.join(", ")));
        }
        for place in places {
            let world = *world * place;
            if !world.is_finite() {
                return self.data.wrong(item, "the place of one of its instances is not finite");
            }
            self.place(&parts, &world)?;
        }
        Ok(())
    }

    /// Takes the brightest directional light as the Sun; others have no place.
    fn light(&mut self, node: &Node, world: &DAffine3, item: &str) -> Result<()> {
        let data = self.data;
        let item = format!("{item}.extensions.{LIGHTS}");
        let index = match extension::<LightOfNode>(&node.extensions, LIGHTS) {
            None => return Ok(()),
            Some(Ok(LightOfNode { light })) => light,
            Some(Err(message)) => return data.wrong(item, message),
        };
        if self.lights.is_none() {
            self.lights = match extension::<Lights>(&data.root.extensions, LIGHTS) {
                None => Some(Vec::new()),
                Some(Ok(lights)) => Some(lights.lights),
                Some(Err(message)) => return data.wrong("extensions", message),
            };
        }
        let light = data.element(self.lights.as_deref().unwrap_or_default(), "lights", index, &item)?.clone();
        let intensity_lx = light.intensity.unwrap_or(1.0);
        // Light goes along -z of the node, so that the Sun is along z.
        let direction = Direction::new(z_up(world.matrix3.z_axis));
        let (Some(direction), "directional") = (direction, light.kind.as_str()) else {
            self.dropped(item, format!("the {} light {:?}: only the Sun and Mars are sources", light.kind, light.name));
            return Ok(());
        };
        let sun = SunLight { direction, intensity_lx, item };
        let fainter = match self.sun.take() {
            Some(earlier) if earlier.intensity_lx >= sun.intensity_lx => {
                self.sun = Some(earlier);
                Some(sun)
            }
            earlier => {
                self.sun = Some(sun);
                earlier
            }
        };
        if let Some(fainter) = fainter {
            self.dropped(fainter.item, "a directional light that is not the brightest: there is one Sun");
        }
        Ok(())
    }

    /// A mesh's primitives, with morph targets by the weights of its node, or its own where the node has none.
    fn parts(&mut self, mesh: usize, weights: &[f64], item: &str) -> Result<UnplacedMesh> {
        let data = self.data;
        // Primitives that share their positions share vertices, so that edges join by index.
        let mut shared: BTreeMap<Positions, usize> = BTreeMap::new();
        let mut parts = UnplacedMesh { blocks: Vec::new(), triangles: Vec::new() };
        let taken = data.element(&data.root.meshes, "meshes", mesh, item)?;
        let weights = if weights.is_empty() { &taken.weights } else { weights };
        self.extras(&format!("meshes[{mesh}]"), &taken.extras, "");
        for (i, primitive) in taken.primitives.iter().enumerate() {
            let item = format!("meshes[{mesh}].primitives[{i}]");
            let mode = primitive.mode.unwrap_or(4);
            if mode > 6 {
                return data.wrong(format!("{item}.mode"), format!("{mode} is not a kind of primitive"));
            }
            if mode < 4 {
                self.dropped(item, "points or lines: only triangles have a surface");
                continue;
            }
            if !primitive.targets.is_empty() {
                self.dropped(&*item, "morph targets: the mesh is taken as the file's weights have it");
            }
            if weights.iter().skip(primitive.targets.len()).any(|weight| *weight != 0.0) {
                let message = format!("{} weights for {} morph targets", weights.len(), primitive.targets.len());
                return data.wrong(&*item, message);
            }
            let moved = primitive.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            let moved: Vec<(usize, f64)> =
                moved.filter_map(|(target, weight)| Some((*target.get("POSITION")?, *weight))).collect();
            let Some(&position) = primitive.attributes.get("POSITION") else {
                return data.wrong(format!("{item}.attributes"), "`POSITION` is missing");
            };
            if let Some(name) = extensions::compression(&primitive.extensions)
                && data.root.accessors.get(position).is_some_and(|a| a.buffer_view.is_none() && a.sparse.is_none())
            {
                return Err(Error::Unsupported { at: data.at(item), feature: extensions::compressed(name) });
            }
            let texture = self.texture_coordinates(primitive);
            let is_read = |name: &str| ["POSITION", "NORMAL", "COLOR_0", RESIDUAL, &texture].contains(&name);
            let others: Vec<&str> = primitive.attributes.keys().map(String::as_str).filter(|n| !is_read(n)).collect();
            if !others.is_empty() {
                self.dropped(format!("{item}.attributes"), others.join(", "));
            }
            let residual = primitive.attributes.get(RESIDUAL).copied();
            let key = (position, residual, moved.iter().map(|(target, weight)| (*target, weight.to_bits())).collect());
            let block = match shared.get(&key) {
                Some(known) => *known,
                None => {
                    let vertices = self.vertices(position, residual, &moved, &format!("{item}.attributes"))?;
                    parts.blocks.push(Block { item: item.clone(), vertices });
                    *shared.entry(key).or_insert(parts.blocks.len() - 1)
                }
            };
            let count = parts.blocks[block].vertices.len();
            let indices: Vec<u32> = match primitive.indices {
                None => (0..index_u32(count)).collect(),
                Some(accessor) => {
                    let item = format!("{item}.indices");
                    let numbers = data.numbers(accessor, &["SCALAR"], &item)?;
                    if let Some(wrong) =
                        numbers.iter().find(|n| !(n.fract() == 0.0 && (0.0..count as f64).contains(*n)))
                    {
                        return data.wrong(item, format!("vertex {wrong}: there are {count}"));
                    }
                    numbers.into_iter().map(whole_u32).collect()
                }
            };
            let uv = self.uv(primitive, &texture, count, &item)?;
            let material = self.material(primitive, &indices, count, &item)?;
            if mode == 4 && !indices.len().is_multiple_of(3) {
                return data.wrong(item, format!("{} corners do not make triangles", indices.len()));
            }
            let corners: Vec<[u32; 3]> = match mode {
                4 => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
                // In a strip every other triangle is turned, and triangles without area only lead from one part to the next.
                5 => (indices.windows(3).enumerate())
                    .map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
                    .filter(|[a, b, c]| a != b && b != c && c != a)
                    .collect(),
                _ => indices.get(1..).unwrap_or(&[]).windows(2).map(|t| [t[0], t[1], indices[0]]).collect(),
            };
            if self.is_smooth(primitive, &corners) {
                self.dropped(format!("{item}.attributes.NORMAL"), "smooth shading: facets are flat");
            }
            parts.triangles.push(Triangles { block, corners, material, uv });
        }
        Ok(parts)
    }

    /// The attribute with the texture coordinates of a primitive: those of its colours' image, or the first.
    fn texture_coordinates(&self, primitive: &Primitive) -> String {
        let material = primitive.material.and_then(|index| self.data.root.materials.get(index));
        let set =
            material.and_then(|m| m.pbr_metallic_roughness.base_color_texture.as_ref()).map_or(0, |t| t.tex_coord);
        format!("TEXCOORD_{set}")
    }

    /// Texture coordinates of a primitive's vertices, v up; empty if it has none.
    fn uv(&self, primitive: &Primitive, name: &str, count: usize, item: &str) -> Result<Vec<[f64; 2]>> {
        let Some(&accessor) = primitive.attributes.get(name) else { return Ok(Vec::new()) };
        let item = format!("{item}.attributes.{name}");
        let numbers = self.data.numbers(accessor, &["VEC2"], &item)?;
        if numbers.len() != 2 * count {
            let message = format!("{} texture coordinates for {count} positions", numbers.len() / 2);
            return self.data.wrong(item, message);
        }
        if let Some(wrong) = numbers.iter().find(|x| !x.is_finite()) {
            return self.data.wrong(item, format!("{wrong} is no texture coordinate"));
        }
        // An image's origin is its upper left corner there.
        Ok(numbers.chunks_exact(2).map(|uv| [uv[0], 1.0 - uv[1]]).collect())
    }

    /// Whether the normals of some triangle's corners differ.
    fn is_smooth(&self, primitive: &Primitive, corners: &[[u32; 3]]) -> bool {
        let Some(&accessor) = primitive.attributes.get("NORMAL") else { return false };
        // Nothing else is made of normals: those that cannot be read are none.
        let Ok(numbers) = self.data.numbers(accessor, &["VEC3"], "NORMAL") else { return false };
        let normal = |v: u32| numbers.get(3 * v as usize..).and_then(|n| Some(DVec3::from_slice(n.get(..3)?)));
        let differ = |a: u32, b: u32| match (normal(a), normal(b)) {
            (Some(a), Some(b)) => (a.normalize_or_zero() - b.normalize_or_zero()).abs().max_element() > FLAT,
            _ => false,
        };
        corners.iter().any(|&[a, b, c]| differ(a, b) || differ(a, c))
    }

    /// Adds a mesh where it stands.
    fn place(&mut self, parts: &UnplacedMesh, world: &DAffine3) -> Result<()> {
        let data = self.data;
        self.objects += 1;
        let mut bases = Vec::with_capacity(parts.blocks.len());
        for Block { item, vertices } in &parts.blocks {
            let base = self.mesh.vertices_m.len();
            if base + vertices.len() > MOST {
                return data.wrong(item, format!("more than {MOST} vertices with all instances"));
            }
            self.mesh.vertices_m.extend(vertices.iter().map(|&v| z_up(world.transform_point3(v))));
            if self.mesh.vertices_m[base..].iter().any(|v| !v.is_finite()) {
                return data.wrong(item, "its place in the scene is beyond all numbers");
            }
            bases.push(index_u32(base));
        }
        let flip = world.matrix3.determinant() < 0.0;
        for Triangles { block, corners, material, uv } in &parts.triangles {
            let base = bases[*block];
            let turned = |&[a, b, c]: &[u32; 3]| if flip { [a, c, b] } else { [a, b, c] };
            let first = self.mesh.facets.len();
            self.mesh.facets.extend(corners.iter().map(turned).map(|t| t.map(|v| v + base)));
            if !uv.is_empty() || !self.mesh.uv.is_empty() {
                // Facets before those that are the first to have any, and those without.
                self.mesh.uv.resize(first, NO_UV);
                if !uv.is_empty() {
                    self.mesh.uv.extend(corners.iter().map(turned).map(|t| t.map(|v| uv[v as usize])));
                }
                self.mesh.uv.resize(self.mesh.facets.len(), NO_UV);
            }
            self.mesh.material.resize(self.mesh.facets.len(), *material);
            if self.mesh.facets.len() > MOST {
                let item = &parts.blocks[*block].item;
                return data.wrong(item, format!("more than {MOST} triangles with all instances"));
            }
        }
        Ok(())
    }

    /// The positions of a primitive, in glTF's axes; `moved` are accessors of displacements and their weights.
    fn vertices(
        &self,
        position: usize,
        residual: Option<usize>,
        moved: &[(usize, f64)],
        item: &str,
    ) -> Result<Vec<DVec3>> {
        let points = |accessor: usize, name: &str| -> Result<Vec<DVec3>> {
            let numbers = self.data.numbers(accessor, &["VEC3"], &format!("{item}.{name}"))?;
            Ok(numbers.chunks_exact(3).map(DVec3::from_slice).collect())
        };
        let mut vertices = points(position, "POSITION")?;
        if let Some(residual) = residual {
            let residuals = points(residual, RESIDUAL)?;
            if residuals.len() != vertices.len() {
                let message = format!("{} residuals for {} positions", residuals.len(), vertices.len());
                return self.data.wrong(format!("{item}.{RESIDUAL}"), message);
            }
            vertices.iter_mut().zip(residuals).for_each(|(v, r)| *v += r);
        }
        for &(target, weight) in moved {
            let displacements = points(target, "POSITION")?;
            if displacements.len() != vertices.len() {
                let message = format!("{} displacements for {} positions", displacements.len(), vertices.len());
                return self.data.wrong(format!("accessors[{target}]"), message);
            }
            vertices.iter_mut().zip(displacements).for_each(|(v, d)| *v += weight * d);
        }
        match vertices.iter().position(|v| !v.is_finite()) {
            Some(i) => self.data.wrong(format!("accessors[{position}]"), format!("position {i} is not finite")),
            None => Ok(vertices),
        }
    }

    /// The material of a primitive: its name, or its colour where it has none.
    fn material(&mut self, primitive: &Primitive, used: &[u32], count: usize, item: &str) -> Result<MaterialId> {
        let data = self.data;
        let tint = self.tint(primitive, used, count, item)?;
        let mut entry = ObjMaterial { name: String::new(), kd: None };
        if let Some(index) = primitive.material {
            let material = data.element(&data.root.materials, "materials", index, &format!("{item}.material"))?;
            let item = format!("materials[{index}]");
            let spectral = material.extras.get("spectral_material").and_then(Value::as_str);
            self.extras(&item, &material.extras, "spectral_material");
            entry.name = mtl::plain_name(spectral.unwrap_or(&material.name));
            let pbr = &material.pbr_metallic_roughness;
            let specular = match extension::<SpecularGlossiness>(&material.extensions, SPECULAR) {
                None => SpecularGlossiness::default(),
                Some(Ok(specular)) => specular,
                Some(Err(message)) => return data.wrong(item, message),
            };
            let given = pbr.base_color_factor.or(specular.diffuse_factor);
            entry.kd = given.map(|[r, g, b, _]| [r, g, b]);
            if entry.kd.is_some_and(|kd| kd.iter().any(|c| !(0.0..=1.0).contains(c))) {
                return data.wrong(format!("{item}.pbrMetallicRoughness.baseColorFactor"), "is outside 0 to 1");
            }
            // Of an entry of a dictionary the colour is not the point: our own files leave it out where it is not known.
            if given.is_none() && spectral.is_none() {
                entry.kd = Some([1.0; 3]);
                self.tell(Fate::Defaulted, &*item, "gives no colour: it is white, as glTF has it");
            }
            if pbr.metallic_factor.is_some_and(|metallic| metallic > 0.0) {
                self.dropped(&*item, "that it is of metal: surfaces are Lambert");
            }
            let textures = [
                pbr.base_color_texture.is_some() || specular.diffuse_texture.is_some(),
                material.normal_texture.is_some(),
                material.occlusion_texture.is_some(),
                material.emissive_texture.is_some(),
            ];
            if textures.contains(&true) {
                self.dropped(&*item, "textures: a material has one spectrum");
            }
            if material.emissive_factor.iter().any(|e| *e != 0.0) {
                self.dropped(&*item, "light of its own");
            }
            if material.alpha_mode.as_deref().is_some_and(|mode| mode != "OPAQUE") {
                self.dropped(&*item, "transparency: surfaces are opaque");
            }
            if material.double_sided {
                self.dropped(&*item, "its back: a facet is seen and lit from its outer side, its inner side is black");
            }
        }
        if let Some(tint) = tint {
            let base = entry.kd.unwrap_or([1.0; 3]);
            entry.kd = Some([0, 1, 2].map(|i| base[i] * tint[i]));
        }
        // + 0.0 makes -0.0 and 0.0 one number.
        let key = (entry.name.clone(), entry.kd.map(|kd| kd.map(|c| (c + 0.0).to_bits())));
        let known = *self.index_of_material.entry(key).or_insert(self.materials.len());
        if known == self.materials.len() {
            self.materials.push(entry);
        }
        match u16::try_from(known) {
            Ok(known) => Ok(MaterialId(known)),
            Err(_) => data.wrong(item, format!("more than {} materials", u16::MAX)),
        }
    }

    /// The colour of all the vertices that a primitive uses, if they have one.
    fn tint(&mut self, primitive: &Primitive, used: &[u32], count: usize, item: &str) -> Result<Option<[f64; 3]>> {
        let Some(&accessor) = primitive.attributes.get("COLOR_0") else { return Ok(None) };
        let name = format!("{item}.attributes.COLOR_0");
        let numbers = self.data.numbers(accessor, &["VEC3", "VEC4"], &name)?;
        let width = if self.data.root.accessors[accessor].shape == "VEC4" { 4 } else { 3 };
        if numbers.len() / width != count {
            return self.data.wrong(name, format!("{} colours for {count} positions", numbers.len() / width));
        }
        let colour = |v: &u32| &numbers[width * *v as usize..][..3];
        let Some(first) = used.first().map(colour) else { return Ok(None) };
        if used.iter().any(|v| colour(v) != first) {
            self.dropped(name, "colours that differ from vertex to vertex: a facet has one material");
            return Ok(None);
        }
        if first.iter().any(|c| !(0.0..=1.0).contains(c)) {
            return self.data.wrong(name, "is outside 0 to 1");
        }
        Ok(Some([first[0], first[1], first[2]]))
    }

    fn origin_m(&self) -> Result<Option<DVec3>> {
        let root = &self.data.root;
        let shown = root.scene.unwrap_or(0);
        let of_scene = root.scenes.get(shown).and_then(|scene| scene.extras.get("origin_m"));
        let (given, item) = match (of_scene, root.asset.extras.get("origin_m")) {
            (Some(given), _) => (given, format!("scenes[{shown}].extras.origin_m")),
            (None, Some(given)) => (given, "asset.extras.origin_m".into()),
            (None, None) => return Ok(None),
        };
        let numbers: Vec<f64> = given.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        match numbers[..] {
            [x, y, z] if given.as_array().is_some_and(|list| list.len() == 3) => Ok(Some(DVec3::new(x, y, z))),
            _ => Err(Error::Invalid(vec![
                Problem::new(self.data.at(item), "is not three numbers")
                    .with_help("[x, y, z] in the body-fixed frame, m, z north"),
            ])),
        }
    }
}

/// Whether a node is hidden, and all that is below it.
fn is_hidden(data: &Data<'_>, node: &Node, item: &str) -> Result<bool> {
    match extension::<Visibility>(&node.extensions, VISIBILITY) {
        None => Ok(false),
        Some(Ok(visibility)) => Ok(visibility.visible == Some(false)),
        Some(Err(message)) => data.wrong(item, message),
    }
}

/// A node's own transform.
fn local(data: &Data<'_>, node: &Node, item: &str) -> Result<DAffine3> {
    if let Some(m) = &node.matrix {
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            return data.wrong(format!("{item}.matrix"), "its last row is not 0 0 0 1");
        }
        let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
        return Ok(DAffine3 { matrix3: DMat3::from_cols(column(0), column(4), column(8)), translation: column(12) });
    }
    let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    if !(rotation.length() > 0.0 && rotation.length().is_finite()) {
        return data.wrong(format!("{item}.rotation"), "has no length: a rotation is a unit quaternion");
    }
    // Written in f32, it is of unit length only to 1e-7; scaled by that, a mesh would grow. A turn by nothing stays exact.
    let rotation = DMat3::from_quat(rotation.normalize());
    Ok(DAffine3 {
        matrix3: rotation * DMat3::from_diagonal(DVec3::from_array(node.scale.unwrap_or([1.0; 3]))),
        translation: DVec3::from_array(node.translation.unwrap_or([0.0; 3])),
    })
}

/// Our axes from glTF's.
fn z_up(v: DVec3) -> DVec3 {
    DVec3::new(v.x, -v.z, v.y)
}
