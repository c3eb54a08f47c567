//! The surface of a simulation: its objects, its ground, and copies of both.

use std::rc::Rc;

use crate::error::{Error, Location, Result};
use crate::formats::input::{self, Hashing};
use crate::formats::mesh_file::MOST;
use crate::formats::obj::{self, ObjFile};
use crate::geometry::{MaterialId, Mesh, index_u32};
use crate::progress::tell;
use crate::report::{Fate, Report};
use crate::scene::Material;

use super::super::ground::{Ground, Standing};
use super::super::groups;
use super::super::object::{is_outside, reaches_beyond, seen_facets, standing};
use super::super::simulation::{FieldInstance, Links, Object};
use super::temperatures::LinkedMaterials;
use super::{SceneBuilder, SceneFrame};

impl<'a> SceneBuilder<'a> {
    /// The OBJ file that an object names.
    fn obj(&mut self, object: &Object) -> Result<Rc<ObjFile>> {
        if let Some(known) = self.objs.get(&object.file) {
            return Ok(known.clone());
        }
        let path = self.folder.locate(&object.file, &object.at).map_err(|problem| Error::Invalid(vec![problem]))?;
        let path = path.ok_or_else(|| {
            Error::invalid(object.at.clone(), format!("the file {:?} of {:?} is not there", object.file, object.name))
        })?;
        // DART knows groups, not materials, and reads no material file.
        let file = input::open(&path).map_err(|e| Error::io(&path, "reading", e))?;
        let mut source = Hashing::new(file);
        let read = Rc::new(obj::parse(&mut source, &path, &mut |_| Ok(Vec::new()))?);
        self.inputs.push(source.finish(&path));
        self.objs.insert(object.file.clone(), read.clone());
        Ok(read)
    }

    /// All objects in one mesh, and the ground if it is something, with all copies, in the scene's frame.
    /// Facets that have temperatures of cells add materials of their own.
    pub(super) fn mesh(
        &mut self,
        place: &SceneFrame,
        materials: &mut Vec<Material>,
        linked: &LinkedMaterials,
    ) -> Result<Mesh> {
        let (simulation, maket) = (self.simulation, &self.simulation.maket);
        let (mut ground, report, files) = Ground::of(simulation, self.folder, self.options.repeat)?;
        self.report.notes.extend(report.notes);
        self.inputs.extend(files);
        let (mut standing, mut beyond) = (Standing::default(), Beyond::default());
        let stands = self.stands();
        self.fits(&stands)?;
        let mut made = Vec::new();
        for (model, places) in &stands {
            made.push(self.made(model, places, linked)?);
        }
        let placed = stands.iter().zip(&made).filter_map(|((model, places), made)| {
            let made = made.as_ref()?;
            Some(places.iter().map(move |place| (*model, made, place)))
        });
        let mut stopped = Ok(());
        let meshes = placed.flatten().map_while(|(model, made, place)| {
            stopped = tell(self.watch, "reading meshes", 0, 1);
            stopped.as_ref().ok()?;
            let mut mesh = made.at(place);
            standing.settle(model, &mut mesh, &ground, &mut self.report);
            if self.options.repeat == 0 {
                beyond.look(model, &mesh, maket.size_m);
            }
            Some(mesh)
        });
        let mut all = Mesh::default();
        all.append_all(meshes);
        stopped?;
        beyond.tell(&mut self.report);
        standing.tell(&mut self.report);
        if let Some(sidecar) = self.sidecar.as_ref().filter(|_| simulation.objects.len() == 1) {
            all.face_of_facet = match sidecar.faces(all.facets.len()) {
                faces if faces.is_empty() => all.face_of_facet,
                faces => faces,
            };
        }
        let material = self.linked(&maket.ground, linked)?.filter(|_| maket.ground_enabled);
        if let Some(cells) = &simulation.phase.cells {
            if self.options.repeat > 0 && maket.boundary == 2 {
                let message = "temperatures of cells on a slope that goes on: which layer a copy of the scene is in is not documented. Leave \
                               `--repeat` out";
                return Err(Error::invalid(cells.at.clone(), message));
            }
            ground.cut_into(cells.count);
        }
        ground.fits(&all, material.is_some(), &maket.at)?;
        let mut all = ground.copies(all);
        if material.is_some() {
            all.append(ground.mesh(material_id(material, &maket.ground.at)?));
        }
        if simulation.phase.cells.is_some() {
            let low_m = all.bounds_m().map_or(0.0, |(low_m, _)| low_m.z);
            // A plane that stands for the sky is there all the same.
            let low_m = if maket.ground_enabled && !ground.is_terrain { low_m.min(0.0) } else { low_m };
            self.warm_by_cells(&mut all, low_m, materials, linked)?;
        }
        if all.facets.is_empty() {
            let message = "the simulation has no objects and no ground that is seen";
            return Err(Error::invalid(Location::file(&self.folder.simulation), message));
        }
        all.vertices_m.iter_mut().for_each(|v| *v = place.local_m(*v));
        tell(self.watch, "reading meshes", 1, 1)?;
        Ok(all)
    }

    /// Objects and models of fields, each with all places where it stands.
    fn stands(&mut self) -> Vec<(&'a Object, Vec<FieldInstance>)> {
        let simulation = self.simulation;
        let mut stands: Vec<_> = simulation.objects.iter().map(|object| (object, vec![object.place()])).collect();
        for field in &simulation.fields {
            // DART leaves out what stands outside of the scene.
            let is_within = |place: &&FieldInstance| !is_outside(place, simulation.maket.size_m);
            let mut of_model = vec![Vec::new(); field.models.len()];
            for place in field.places.iter().filter(is_within) {
                of_model.get_mut(place.model as usize).into_iter().for_each(|places| places.push(*place));
            }
            let outside = field.places.len() - of_model.iter().map(Vec::len).sum::<usize>();
            if outside > 0 {
                let message = format!(
                    "{outside} objects of the field {:?} stand outside of the scene: DART leaves them out",
                    field.name
                );
                self.note(Fate::Dropped, &field.at, message);
            }
            stands.extend(field.models.iter().zip(of_model).filter(|(_, places)| !places.is_empty()));
        }
        stands
    }

    /// A field of a few lines can ask for more than any memory holds.
    fn fits(&mut self, stands: &[(&Object, Vec<FieldInstance>)]) -> Result<()> {
        let (mut vertices, mut facets) = (0_usize, 0_usize);
        for (object, places) in stands.iter().filter(|(object, _)| !object.hidden) {
            let read = self.obj(object)?;
            let sides = if object.has_backs() { 2 } else { 1 };
            vertices = vertices.saturating_add(places.len().saturating_mul(read.vertices.len()));
            facets = facets.saturating_add(places.len().saturating_mul(sides * read.facets.len()));
            if vertices.max(facets) > MOST {
                let message = format!("with {:?} there are more than {MOST} vertices or facets", object.name);
                return Err(Error::invalid(object.at.clone(), message));
            }
        }
        Ok(())
    }

    /// What an object is made of that stands at these places; `None` if it is hidden.
    fn made(&mut self, object: &Object, places: &[FieldInstance], linked: &LinkedMaterials) -> Result<Option<Made>> {
        if object.hidden {
            self.note(Fate::Dropped, &object.at, format!("{:?} is hidden: DART ignores it too", object.name));
            return Ok(None);
        }
        let read = self.obj(object)?;
        let numbered = groups::order(&read.groups, &self.simulation.version);
        let mut sides_of_group = vec![(object.links.as_ref(), object.back.as_ref()); read.groups.len().max(1)];
        for group in &object.groups {
            let Some(&place) = (group.number as usize).checked_sub(1).and_then(|n| numbered.get(n)) else {
                let message =
                    format!("group {} ({:?}): the OBJ has {} groups", group.number, group.name, numbered.len());
                return Err(Error::invalid(group.at.clone(), message));
            };
            if group.links.is_some() {
                sides_of_group[place] = (group.links.as_ref(), group.back.as_ref());
                self.unsaid_back(group.double_face && group.back.is_none(), &group.at, &group.name);
            }
        }
        self.unsaid_back(
            object.links.is_some() && object.double_face && object.back.is_none(),
            &object.at,
            &object.name,
        );
        let mut material_of_group = Vec::new();
        for (i, (front, back)) in sides_of_group.into_iter().enumerate() {
            let Some(front) = front else {
                let name = read.groups.get(i).map_or("", String::as_str);
                let message = format!("nothing says what group {name:?} of {:?} is made of", object.file);
                return Err(Error::invalid(object.at.clone(), message));
            };
            let of = |links: &Links| material_id(self.linked(links, linked)?, &links.at);
            material_of_group.push((of(front)?, back.map(of).transpose()?));
        }
        // Without a nutation the two others are turns about one axis.
        if places.iter().any(|place| place.rotation_deg.y != 0.0) {
            let message = "rotations about more than the vertical: their order is inferred, not documented";
            self.note(Fate::Approximated, &object.at, message);
        }
        let hidden = object.groups.iter().filter(|group| group.hidden).count();
        if hidden > 0 {
            let message = format!("{hidden} hidden groups of {:?}: DART ignores them too", object.name);
            self.note(Fate::Dropped, &object.at, message);
        }
        let seen = seen_facets(object, &read, &self.simulation.version);
        let sides = seen.iter().map(|f| match read.facet_group.get(*f) {
            Some(group) => material_of_group[*group as usize],
            None => material_of_group[0],
        });
        let (fronts, backs) = sides.unzip();
        Ok(Some(Made { obj: read, seen, fronts, backs }))
    }

    /// The material that links lead to.
    fn linked(&self, links: &Links, linked: &LinkedMaterials) -> Result<Option<usize>> {
        let property = self.property(links)?;
        Ok(linked.of(property, self.warmth(links, property)?))
    }

    fn unsaid_back(&mut self, is_unsaid: bool, at: &Location, name: &str) {
        if is_unsaid {
            let message = format!("the back of {name:?}: nothing says what it is made of, and backs are black");
            self.note(Fate::Dropped, at, message);
        }
    }
}

/// What an object is made of, wherever it stands.
struct Made {
    obj: Rc<ObjFile>,
    /// Facets of the file that are not hidden, and the materials of their sides.
    seen: Vec<usize>,
    fronts: Vec<MaterialId>,
    backs: Vec<Option<MaterialId>>,
}

impl Made {
    /// In DART's frame.
    fn at(&self, place: &FieldInstance) -> Mesh {
        with_backs(Mesh { material: self.fronts.clone(), ..standing(place, &self.obj, &self.seen) }, &self.backs)
    }
}

/// A mesh and the backs of its facets, after all of them: a facet's other side is the same triangle turned round.
fn with_backs(mut mesh: Mesh, backs: &[Option<MaterialId>]) -> Mesh {
    let sides = backs.iter().enumerate().filter_map(|(front, back)| Some((index_u32(front), (*back)?)));
    let (fronts, materials): (Vec<u32>, Vec<MaterialId>) = sides.unzip();
    if fronts.is_empty() {
        return mesh;
    }
    let before = (0..mesh.facets.len()).map(|f| mesh.face(f)).max().map_or(0, |face| face + 1);
    if !mesh.face_of_facet.is_empty() {
        let faces: Vec<u32> = fronts.iter().map(|f| before + mesh.face(*f as usize)).collect();
        mesh.face_of_facet.extend(faces);
    }
    for front in fronts {
        let [a, b, c] = mesh.facets[front as usize];
        mesh.facets.push([a, c, b]);
    }
    mesh.material.extend(materials);
    mesh
}

/// Objects that reach beyond the scene's edges, where there are no copies: those that DART lets come in at the other side, and others.
#[derive(Default)]
struct Beyond {
    repeated: Option<(Location, String, usize)>,
    alone: Option<(Location, String, usize)>,
}

impl Beyond {
    fn look(&mut self, object: &Object, mesh: &Mesh, size_m: [f64; 2]) {
        if mesh.bounds_m().is_some_and(|bounds_m| reaches_beyond(bounds_m, size_m)) {
            let list = if object.repeated_on_border { &mut self.repeated } else { &mut self.alone };
            list.get_or_insert_with(|| (object.at.clone(), object.name.clone(), 0)).2 += 1;
        }
    }

    fn tell(self, report: &mut Report) {
        let mut told = |list: Option<(Location, String, usize)>, fate, what: &str| {
            let Some((at, name, count)) = list else { return };
            let who =
                if count > 1 { format!("{name:?} and {} more reach", count - 1) } else { format!("{name:?} reaches") };
            report.note(fate, at, format!("{who} beyond the scene's edge, {what}"));
        };
        let comes_in = "where DART lets it come in at the other side: it only stands where it is";
        told(self.repeated, Fate::Dropped, comes_in);
        let kept = "where DART may leave it out (that is not documented): it stands where it is";
        told(self.alone, Fate::Approximated, kept);
    }
}

fn material_id(material: Option<usize>, at: &Location) -> Result<MaterialId> {
    let id = material.and_then(|m| u16::try_from(m).ok()).map(MaterialId);
    id.ok_or_else(|| Error::invalid(at.clone(), "more materials than can be told apart"))
}
