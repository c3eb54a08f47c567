//! A DART simulation as a scene, and what of it has no counterpart.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

use glam::{DMat3, DVec3};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::input::{self, Hashing, InputFile};
use crate::formats::obj::{self, ObjFile};
use crate::geometry::{Direction, MaterialId, Mesh, Pose};
use crate::progress::{Watch, tell};
use crate::report::{Fate, Report};
use crate::scene::{FrameCamera, Hapke, Material, Photometry, Rpv, Scene, Sensor, Sun, Thermal};
use crate::spectral::{Band, Extend, SpectralLibrary, Spectrum, solar_e490, solar_mean};
use crate::units::AU_M;

use super::database::Database;
use super::folder::Folder;
use super::from_scene::{
    camera_deg, intervals, irradiance, latitude_longitude_altitude, spectra, tabulated, thermal_functions, width_um,
};
use super::sidecar::{self, Sidecar};
use super::simulation::{Camera, Links, Object, OpticalKind, OpticalProperty, Simulation};
use super::{frame, groups};

/// What a conversion needs to know beside the simulation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneOptions {
    /// Where the middle of the scene's ground is on the body, body-fixed, m; `None`: nowhere, the body's axes are East, North and up.
    pub origin_m: Option<DVec3>,
}

/// A scene, and how it came about.
#[derive(Debug, Clone)]
pub struct Converted {
    /// The scene, checked.
    pub scene: Scene,
    /// What has no counterpart, and what was taken for what the simulation does not say.
    pub report: Report,
    /// Files that were read: the OBJ files, databases, and `mmxrt.toml`.
    pub inputs: Vec<InputFile>,
}

/// Two numbers that went through a text, or through percent, are the same within this, relative.
const SAME: f64 = 1e-12;
/// Reflectance of what cannot be looked up.
const UNKNOWN_REFLECTANCE: f64 = 0.1;
/// Bolometric emissivity of what does not say: Phobos and most powders lie between 0.9 and 1.
const EMISSIVITY_BOLOMETRIC: f64 = 0.95;
/// More vertices, or more facets, of all objects are refused.
const MOST: usize = 1 << 27;
/// Where a simulation has no camera, one looks down from so many times the scene's extent.
const CAMERA_DISTANCE: f64 = 10.0;

/// The scene of a simulation whose folder holds the files it names, and `mmxrt.toml` if it was written here.
///
/// # Errors
/// [`Error::Invalid`] for links that lead nowhere, files that are missing, lie outside, or cannot be used, and as [`Scene::check`];
/// [`Error::Io`]; [`Error::Interrupted`].
pub fn to_scene(
    simulation: &Simulation,
    folder: &Folder,
    options: &SceneOptions,
    watch: Watch<'_>,
) -> Result<Converted> {
    let mut reader = Reader {
        simulation,
        folder,
        options,
        watch,
        report: Report::default(),
        inputs: Vec::new(),
        databases: BTreeMap::new(),
        objs: BTreeMap::new(),
        sidecar: None,
    };
    if let Some((sidecar, input)) = Sidecar::read(&folder.simulation.join(sidecar::FILE))? {
        reader.inputs.push(input);
        reader.sidecar = Some(sidecar);
    }
    let scene = reader.scene()?.check()?;
    Ok(Converted { scene, report: reader.report, inputs: reader.inputs })
}

struct Reader<'a> {
    simulation: &'a Simulation,
    folder: &'a Folder,
    options: &'a SceneOptions,
    watch: Watch<'a>,
    report: Report,
    inputs: Vec<InputFile>,
    /// Open databases by the name in the simulation; `None` for one that is not there.
    databases: BTreeMap<String, Option<Database>>,
    /// OBJ files by the name in the simulation.
    objs: BTreeMap<String, Rc<ObjFile>>,
    sidecar: Option<Sidecar>,
}

/// The scene's frame in DART's.
struct Place {
    origin_m: DVec3,
    dart_from_body: DMat3,
    origin_in_dart_m: DVec3,
    /// As `mmxrt.toml` has it, whose body-fixed vectors so mean the same.
    is_kept: bool,
}

impl Place {
    fn local_m(&self, dart_m: DVec3) -> DVec3 {
        self.dart_from_body.transpose() * (dart_m - self.origin_in_dart_m)
    }
}

impl Reader<'_> {
    fn note(&mut self, fate: Fate, at: &Location, message: impl Into<String>) {
        self.report.note(fate, at.clone(), message);
    }

    fn scene(&mut self) -> Result<Scene> {
        let simulation = self.simulation;
        let place = self.place();
        let bands = self.bands();
        let sun = self.sun(&place, &bands);
        let (materials, material_of) = self.materials(&bands)?;
        let mut mesh = self.mesh(&place, &material_of)?;
        if let Some(sidecar) = self.sidecar.as_ref().filter(|_| simulation.objects.len() == 1) {
            mesh.face_of_facet = match sidecar.faces(mesh.facets.len()) {
                faces if faces.is_empty() => mesh.face_of_facet,
                faces => faces,
            };
        }
        let camera = self.camera(&place, &mesh);
        let mars = self.sidecar.as_ref().and_then(Sidecar::mars);
        if mars.is_some() && !place.is_kept {
            self.note(
                Fate::Dropped,
                &Location::item("mars"),
                "the scene is elsewhere than where Mars was given for it",
            );
        }
        let mars = mars.filter(|_| place.is_kept);
        let name = self.sidecar.as_ref().map_or("DART camera", Sidecar::sensor_name).to_owned();
        let sensor = Sensor { name, camera, bands };
        let scene = Scene { origin_m: place.origin_m, mesh, materials, sun, mars, thermal: Thermal::Off, sensor };
        Ok(self.with_thermal(scene))
    }

    /// Where the scene is on the body.
    fn place(&mut self) -> Place {
        let maket = &self.simulation.maket;
        if let (Some(sidecar), None) = (&self.sidecar, self.options.origin_m) {
            let origin_m = DVec3::from_array(sidecar.origin_m);
            let written = latitude_longitude_altitude(origin_m);
            if same_all(&written, &maket.latitude_longitude_altitude) {
                let origin_in_dart_m = DVec3::from_array(sidecar.origin_in_dart_m);
                return Place {
                    origin_m,
                    dart_from_body: frame::dart_from_body(origin_m),
                    origin_in_dart_m,
                    is_kept: true,
                };
            }
        }
        let [x, y] = maket.size_m;
        let message = match self.options.origin_m {
            Some(_) => None,
            None => Some(
                "DART does not say where on the body the scene is: taken to be at its centre, with x East, y North and z up. \
                 Give the place of the scene's middle",
            ),
        };
        if let Some(message) = message {
            self.note(Fate::Defaulted, &Location::item("origin_m"), message);
        }
        let origin_m = self.options.origin_m.unwrap_or(DVec3::ZERO);
        Place {
            origin_m,
            dart_from_body: frame::dart_from_body(origin_m),
            origin_in_dart_m: DVec3::new(0.5 * x, 0.5 * y, 0.0),
            is_kept: false,
        }
    }

    fn bands(&mut self) -> Vec<Band> {
        let (mut rectangles, mut wide) = (None, None);
        let intervals = &self.simulation.phase.bands;
        let bands = intervals.iter().enumerate().map(|(i, interval)| {
            let kept = self.sidecar.as_ref().and_then(|s| s.band(i, interval.mean_um));
            if let Some(band) = kept.filter(|band| same(width_um(band), interval.width_um)) {
                return band;
            }
            let fwhm_um = (interval.width_um > 0.0).then_some(interval.width_um);
            let band = Band { centre_um: interval.mean_um, fwhm_um };
            // Where sunlight is not known, or below all wavelengths.
            if fwhm_um.is_some() && band.support_um().0 < solar_e490().coverage_um().0 {
                wide.get_or_insert(&interval.at);
                return Band { fwhm_um: None, ..band };
            }
            rectangles.get_or_insert(&interval.at);
            band
        });
        let bands = bands.collect();
        if let Some(at) = rectangles {
            let message = "DART's bands are rectangles: taken as Gaussian responses with the same full width";
            self.report.note(Fate::Approximated, at.clone(), message);
        }
        if let Some(at) = wide {
            let message =
                "a Gaussian response as wide as this band would reach beyond sunlight: taken at the centre alone";
            self.report.note(Fate::Approximated, at.clone(), message);
        }
        bands
    }

    fn sun(&mut self, place: &Place, bands: &[Band]) -> Sun {
        let phase = &self.simulation.phase;
        let directions = &self.simulation.directions;
        let towards = place.dart_from_body.transpose() * frame::vector(directions.sun_deg);
        // A vector made of an angle has a length.
        let direction = Direction::new(towards).unwrap_or_else(|| Direction::new(DVec3::Z).expect("z has a direction"));
        let given: Vec<f64> = phase.irradiance.iter().map(|(irradiance, _)| *irradiance).collect();
        if phase.irradiance.iter().any(|(_, diffuse)| *diffuse != 0.0) {
            let message = "diffuse light from the sky: there is none without an atmosphere";
            self.report.note(Fate::Dropped, directions.at.clone().with_item("SpectralIrradianceValue/@Skyl"), message);
        }
        let is_given = phase.irradiance_mode == 1 && given.len() == bands.len();
        if let Some(sun) = self.sidecar.as_ref().and_then(|s| s.sun(direction))
            && is_given
            && same_all(&irradiance(&sun, bands), &given)
        {
            return sun;
        }
        let e490 = solar_e490();
        let total = e490.integral(e490.coverage_um().0, e490.coverage_um().1).unwrap_or(crate::units::TSI_1AU_W_M2);
        let at_1_au =
            Sun { direction, distance_m: AU_M, irradiance_1au: e490.clone(), total_irradiance_1au_w_m2: total };
        let item = Location::item("sun");
        if !is_given {
            let message = "DART does not say how far the Sun is: taken to be 1 au, with the spectrum ASTM E490-00a";
            self.note(Fate::Defaulted, &item, message);
            return at_1_au;
        }
        // What E490 would have to be divided by is the square of the distance.
        let standard =
            bands.iter().map(|b| b.quadrature(&[]).iter().map(|(um, w)| w * e490.at(*um).unwrap_or(0.0)).sum::<f64>());
        let mut ratios: Vec<f64> = standard.zip(&given).filter(|(_, e)| **e > 0.0).map(|(s, e)| s / e).collect();
        ratios.sort_by(f64::total_cmp);
        let squared = ratios.get(ratios.len() / 2).copied().filter(|r| *r > 0.0).unwrap_or(1.0);
        let mut points: Vec<(f64, f64)> =
            bands.iter().map(|b| b.centre_um).zip(given.iter().map(|e| e * squared)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.dedup_by_key(|p| p.0);
        let (wavelength_um, value) = points.into_iter().unzip();
        let message = format!(
            "DART has irradiances of bands only: the distance, {:.4} au, is that where the spectrum ASTM E490-00a has them in the \
             middle, and the spectrum is linear between the bands",
            squared.sqrt()
        );
        self.note(Fate::Defaulted, &item, message);
        Sun {
            distance_m: squared.sqrt() * AU_M,
            irradiance_1au: Spectrum::new(wavelength_um, value, Extend::Hold).unwrap_or_else(|| e490.clone()),
            ..at_1_au
        }
    }

    /// Materials, and which of them an optical property is: by its place in the simulation's list.
    fn materials(&mut self, bands: &[Band]) -> Result<(Vec<Material>, Vec<Option<usize>>)> {
        let simulation = self.simulation;
        let mut is_linked = vec![false; simulation.optical.len()];
        for links in self.links() {
            is_linked[self.property(links)?] = true;
        }
        let ground = self.property(&simulation.maket.ground)?;
        let is_ground = |i: usize| simulation.maket.ground_enabled && i == ground;
        let mut found = Vec::new();
        let mut default = None;
        for (i, property) in simulation.optical.iter().enumerate() {
            let notes = self.report.notes.len();
            let Some(table) = self.table(property, is_linked[i] || is_ground(i), bands)? else { continue };
            // A black ground at 0 K that nothing else is made of stands for the sky.
            if !is_linked[i] && i == ground && self.is_sky(property.kind, &table) {
                self.report.notes.truncate(notes);
                continue;
            }
            let kept = self.sidecar.as_ref().and_then(|s| s.material(&property.ident));
            let is_same = |material: &Material| {
                let (kind, spectra) = spectra(material);
                // Bands may have been edited: as far as the table itself reaches.
                let um = table[0].wavelength_um();
                let (um, columns) = tabulated(&spectra, (um[0], um[um.len() - 1]));
                let same_column = |(values, s): (&Vec<f64>, &Spectrum)| {
                    same_all(&um, s.wavelength_um()) && same_all(values, s.value())
                };
                kind == property.kind && columns.len() == table.len() && columns.iter().zip(&table).all(same_column)
            };
            let kept = kept.filter(is_same);
            if kept.is_some() {
                // What looks strange in it was so in the scene.
                self.report.notes.truncate(notes);
            }
            let material = kept.unwrap_or_else(|| {
                default.get_or_insert(&property.at);
                material(property, table)
            });
            found.push((i, material));
        }
        if let Some(at) = default {
            let message = format!(
                "Bond albedo (the mean of the reflectance, weighted with sunlight) and bolometric emissivity ({EMISSIVITY_BOLOMETRIC}): \
                 DART has none, nor a hemispherical reflectance by Hapke or RPV (diffusive, from w; rho0)"
            );
            self.report.note(Fate::Defaulted, at.clone(), message);
        }
        if let Some(sidecar) = &self.sidecar {
            found.sort_by_key(|(_, material)| sidecar.place_of(&material.name).unwrap_or(usize::MAX));
        }
        let mut material_of = vec![None; simulation.optical.len()];
        for (place, (i, material)) in found.iter_mut().enumerate() {
            material_of[*i] = Some(place);
            if material.mixture.is_empty() {
                material.mixture = vec![(place, 1.0)];
            }
        }
        let count = found.len();
        let mut materials: Vec<Material> = found.into_iter().map(|(_, material)| material).collect();
        for (i, material) in materials.iter_mut().enumerate() {
            if material.mixture.iter().any(|(part, _)| *part >= count) {
                material.mixture = vec![(i, 1.0)];
            }
        }
        Ok((materials, material_of))
    }

    /// Links of visible objects.
    fn links(&self) -> impl Iterator<Item = &Links> {
        let models = self.simulation.fields.iter().flat_map(|f| &f.models);
        let objects = self.simulation.objects.iter().chain(models).filter(|o| !o.hidden);
        objects.flat_map(|o| o.links.iter().chain(o.groups.iter().filter_map(|g| g.links.as_ref())))
    }

    /// Place of the linked property in the simulation's list.
    fn property(&self, links: &Links) -> Result<usize> {
        let of_kind = |(_, p): &(usize, &OpticalProperty)| p.kind as u32 == links.kind;
        let mut list = self.simulation.optical.iter().enumerate().filter(of_kind);
        list.nth(links.index as usize).map(|(i, _)| i).ok_or_else(|| {
            let message = format!(
                "the link leads to entry {} of type {}, which coeff_diff.xml does not have ({:?}): DART would stop, or take another",
                links.index, links.kind, links.ident
            );
            Error::invalid(links.at.clone(), message)
        })
    }

    /// Whether the ground, of this table, neither reflects nor glows.
    fn is_sky(&self, kind: OpticalKind, table: &[Spectrum]) -> bool {
        let thermal = self.simulation.thermal.get(self.simulation.maket.ground.thermal_index as usize);
        kind == OpticalKind::Lambertian
            && table[0].value().iter().all(|v| *v == 0.0)
            && thermal.is_some_and(|t| t.mean_k == 0.0 && t.range_k == 0.0)
    }

    /// What a property's table holds, as [`spectra`] has it; `None` if it is not needed and not there.
    fn table(&mut self, property: &OpticalProperty, is_needed: bool, bands: &[Band]) -> Result<Option<Vec<Spectrum>>> {
        let Some(database) = self.database(property)? else {
            if !is_needed {
                return Ok(None);
            }
            let message = format!(
                "the database {:?} of {:?} is not there: a Lambert surface of reflectance {UNKNOWN_REFLECTANCE} is taken. Name the \
                 folder it is in",
                property.database, property.ident
            );
            self.note(Fate::Approximated, &property.at, message);
            return Ok(Some(vec![Spectrum::constant(UNKNOWN_REFLECTANCE)]));
        };
        let of_library = |(library, report): (SpectralLibrary, Report)| {
            let spectra: Option<Vec<Spectrum>> =
                library.columns.iter().map(|c| library.spectrum(&c.name, Extend::Error)).collect();
            spectra.map(|spectra| (spectra, report))
        };
        let read = match property.kind {
            OpticalKind::Lambertian => {
                database.lambertian(&property.model).map(|(s, report)| Some((vec![s], report)))?
            }
            OpticalKind::Hapke => of_library(database.hapke(&property.model)?),
            OpticalKind::Rpv => of_library(database.rpv(&property.model)?),
        };
        let Some((mut spectra, report)) = read else {
            return Err(Error::invalid(property.at.clone(), format!("the table {:?} is no spectrum", property.model)));
        };
        self.report.notes.extend(report.notes);
        self.multiply(property, bands, &mut spectra);
        let (first, last) = spectra[0].coverage_um();
        let needed =
            bands.iter().map(Band::support_um).fold((f64::INFINITY, 0.0f64), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        if is_needed && (needed.0 < first || last < needed.1) {
            let message = format!(
                "{:?} is known from {first} to {last} um, which does not cover all bands: its end values are held",
                property.ident
            );
            self.note(Fate::Approximated, &property.at, message);
            let held = |s: &Spectrum| Spectrum::new(s.wavelength_um().to_vec(), s.value().to_vec(), Extend::Hold);
            spectra = spectra.iter().map(|s| held(s).unwrap_or_else(|| s.clone())).collect();
        }
        Ok(Some(spectra))
    }

    /// Multiplicative factors of a table's columns.
    fn multiply(&mut self, property: &OpticalProperty, bands: &[Band], spectra: &mut [Spectrum]) {
        let names: &[&str] = match property.kind {
            OpticalKind::Lambertian => &["reflectanceFactor"],
            OpticalKind::Hapke => &[
                "hapkeParameterW",
                "hapkeParameterC1",
                "hapkeParameterC2",
                "hapkeParameterC3",
                "hapkeParameterC4",
                "hapkeParameterH1",
                "hapkeParameterH2",
            ],
            OpticalKind::Rpv => &[
                "rhoZero_RPVMultiplicativeFactor",
                "k_RPVMultiplicativeFactor",
                "g_RPVMultiplicativeFactor",
                "h_RPVMultiplicativeFactor",
            ],
        };
        let mut varies = false;
        for (spectrum, name) in spectra.iter_mut().zip(names) {
            let factor = |band: &Vec<(String, f64)>| band.iter().find(|(n, _)| n == name).map_or(1.0, |f| f.1);
            let factors: Vec<f64> = property.factors.iter().map(factor).collect();
            if factors.iter().all(|f| *f == factors[0]) {
                *spectrum = factors.first().map_or_else(|| spectrum.clone(), |factor| spectrum.map(|v| v * factor));
                continue;
            }
            varies = true;
            let in_band =
                |(band, factor): (&Band, &f64)| (band.centre_um, factor * spectrum.at(band.centre_um).unwrap_or(0.0));
            let mut points: Vec<(f64, f64)> = bands.iter().zip(&factors).map(in_band).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points.dedup_by_key(|p| p.0);
            let (um, value) = points.into_iter().unzip();
            *spectrum = Spectrum::new(um, value, Extend::Hold).unwrap_or_else(|| spectrum.clone());
        }
        if varies {
            let message =
                "factors that differ from band to band: what they multiply is linear between the bands' centres";
            self.note(Fate::Approximated, &property.at, message);
        }
    }

    fn database(&mut self, property: &OpticalProperty) -> Result<Option<&Database>> {
        let name = &property.database;
        if !self.databases.contains_key(name) {
            let path = self.folder.locate(name, &property.at).map_err(|problem| Error::Invalid(vec![problem]))?;
            let opened = path.as_deref().map(Database::open).transpose()?;
            if let Some(path) = path {
                self.inputs.push(InputFile::of(&path, &input::bytes(&path, 1 << 40)?));
            }
            self.databases.insert(name.clone(), opened);
        }
        Ok(self.databases.get(name).and_then(Option::as_ref))
    }

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
        let file = std::fs::File::open(&path).map_err(|e| Error::io(&path, "reading", e))?;
        let mut source = Hashing::new(file);
        let read = Rc::new(obj::parse(&mut source, &path, &mut |_| Ok(Vec::new()))?);
        self.inputs.push(source.finish(&path));
        self.objs.insert(object.file.clone(), read.clone());
        Ok(read)
    }

    /// All objects in one mesh, in the scene's frame, and the ground if it is something.
    fn mesh(&mut self, place: &Place, material_of: &[Option<usize>]) -> Result<Mesh> {
        let simulation = self.simulation;
        let placed = || {
            let of_fields = simulation.fields.iter().flat_map(|f| f.objects()).map(Cow::Owned);
            simulation.objects.iter().map(Cow::Borrowed).chain(of_fields)
        };
        // A field of a few lines can ask for more than any memory holds.
        let (mut vertices, mut facets) = (0, 0);
        for object in placed().filter(|object| !object.hidden) {
            let read = self.obj(&object)?;
            (vertices, facets) = (vertices + read.vertices.len(), facets + read.facets.len());
            if vertices.max(facets) > MOST {
                let message = format!("with {:?} there are more than {MOST} vertices or facets", object.name);
                return Err(Error::invalid(object.at.clone(), message));
            }
        }
        let mut meshes = Vec::new();
        for object in placed() {
            if object.hidden {
                self.note(Fate::Dropped, &object.at, format!("{:?} is hidden: DART ignores it too", object.name));
                continue;
            }
            tell(self.watch, "reading meshes", 0, 1)?;
            meshes.push(self.object(&object, place, material_of)?);
        }
        let mut meshes = meshes.into_iter();
        let mut all = meshes.next().unwrap_or_default();
        all.append_all(meshes);
        self.ground(place, material_of, &mut all)?;
        if all.facets.is_empty() {
            let problem = Problem::new(
                Location::file(&self.folder.simulation),
                "the simulation has no objects and no ground that is seen",
            );
            return Err(Error::Invalid(vec![problem]));
        }
        if simulation.maket.boundary != 0 {
            let message = "the scene goes on beyond its edges: only one of it is taken";
            self.note(Fate::Dropped, &Location::item("Maket/@exactlyPeriodicScene"), message);
        }
        tell(self.watch, "reading meshes", 1, 1)?;
        Ok(all)
    }

    fn object(&mut self, object: &Object, place: &Place, material_of: &[Option<usize>]) -> Result<Mesh> {
        let read = self.obj(object)?;
        let numbered = groups::order(&read.groups, &self.simulation.version);
        let mut links_of_group = vec![object.links.as_ref(); read.groups.len().max(1)];
        for group in &object.groups {
            let Some(&place) = (group.number as usize).checked_sub(1).and_then(|n| numbered.get(n)) else {
                let message =
                    format!("group {} ({:?}): the OBJ has {} groups", group.number, group.name, numbered.len());
                return Err(Error::invalid(group.at.clone(), message));
            };
            links_of_group[place] = group.links.as_ref().or(object.links.as_ref());
            if group.double_face || object.double_face {
                self.note(Fate::Dropped, &group.at, format!("the back of {:?}: backs are black", group.name));
            }
        }
        if object.groups.is_empty() && object.double_face {
            self.note(Fate::Dropped, &object.at, format!("the back of {:?}: backs are black", object.name));
        }
        let mut material_of_group = Vec::new();
        for (i, links) in links_of_group.iter().enumerate() {
            let Some(links) = links else {
                let name = read.groups.get(i).map_or("", String::as_str);
                let message = format!("nothing says what group {name:?} of {:?} is made of", object.file);
                return Err(Error::invalid(object.at.clone(), message));
            };
            material_of_group.push(material_id(material_of[self.property(links)?], &links.at)?);
        }
        let material = match read.facet_group.is_empty() {
            true => vec![material_of_group[0]; read.facets.len()],
            false => read.facet_group.iter().map(|g| material_of_group[*g as usize]).collect(),
        };

        let hidden: Vec<usize> = object
            .groups
            .iter()
            .filter(|g| g.hidden)
            .filter_map(|g| numbered.get(g.number as usize - 1).copied())
            .collect();
        let is_seen = |f: usize| read.facet_group.get(f).is_none_or(|g| !hidden.contains(&(*g as usize)));

        let turned = DMat3::from_rotation_z(object.rotation_deg.z.to_radians())
            * DMat3::from_rotation_y(object.rotation_deg.y.to_radians())
            * DMat3::from_rotation_z(object.rotation_deg.x.to_radians());
        if object.rotation_deg.x != 0.0 || object.rotation_deg.y != 0.0 {
            let message = "rotations about more than the vertical: their order is inferred, not documented";
            self.note(Fate::Approximated, &object.at, message);
        }
        let is_turned = object.rotation_deg != DVec3::ZERO;
        let mut vertices_m = read.vertices.clone();
        for vertex in &mut vertices_m {
            let v = object.scale * frame::dart_from_obj(*vertex);
            *vertex = object.position_m + if is_turned { turned * v } else { v };
        }
        let mut mesh =
            Mesh { vertices_m, facets: read.facets.clone(), material, face_of_facet: read.face_of_facet.clone() };
        if !hidden.is_empty() {
            self.note(
                Fate::Dropped,
                &object.at,
                format!("{} hidden groups of {:?}: DART ignores them too", hidden.len(), object.name),
            );
            let seen: Vec<usize> = (0..mesh.facets.len()).filter(|f| is_seen(*f)).collect();
            mesh.face_of_facet = seen.iter().map(|f| mesh.face(*f)).collect();
            mesh.material = seen.iter().map(|f| mesh.material[*f]).collect();
            mesh.facets = seen.iter().map(|f| mesh.facets[*f]).collect();
        }
        if object.scale.x * object.scale.y * object.scale.z < 0.0 {
            mesh.facets.iter_mut().for_each(|f| f.swap(1, 2));
        }
        self.settle(object, &mut mesh);
        mesh.vertices_m.iter_mut().for_each(|v| *v = place.local_m(*v));
        Ok(mesh)
    }

    /// Puts an object on the ground where DART does, and says what is beyond the scene's edge.
    fn settle(&mut self, object: &Object, mesh: &mut Mesh) {
        let Some((low_m, high_m)) = mesh.bounds_m() else { return };
        if object.dem_mode != 2 && self.simulation.maket.topography.is_some() {
            self.note(
                Fate::Approximated,
                &object.at,
                format!("{:?} stands on the terrain: put on a plane at z = 0", object.name),
            );
        }
        if object.dem_mode == 0 {
            mesh.vertices_m.iter_mut().for_each(|v| v.z -= low_m.z);
        }
        let [x, y] = self.simulation.maket.size_m;
        let is_beyond = low_m.x < 0.0 || low_m.y < 0.0 || high_m.x > x || high_m.y > y;
        if is_beyond && object.repeated_on_border {
            let message = format!(
                "{:?} reaches beyond the scene's edge, where DART lets it come in at the other side",
                object.name
            );
            self.note(Fate::Dropped, &object.at, message);
        }
    }

    fn ground(&mut self, place: &Place, material_of: &[Option<usize>], mesh: &mut Mesh) -> Result<()> {
        let maket = &self.simulation.maket;
        if let Some(file) = &maket.topography {
            let message = format!("the terrain {file:?}: the ground is a plane at z = 0");
            self.note(Fate::Dropped, &maket.ground.at, message);
        }
        let property = self.property(&maket.ground)?;
        let Some(material) = material_of[property].filter(|_| maket.ground_enabled) else { return Ok(()) };
        let [x, y] = maket.size_m;
        let corners = [[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]];
        mesh.append(Mesh {
            vertices_m: corners.map(|[x, y]| place.local_m(DVec3::new(x, y, 0.0))).to_vec(),
            facets: vec![[0, 1, 2], [0, 2, 3]],
            material: vec![material_id(Some(material), &maket.ground.at)?; 2],
            face_of_facet: vec![0, 0],
        });
        Ok(())
    }

    fn camera(&mut self, place: &Place, mesh: &Mesh) -> FrameCamera {
        let simulation = self.simulation;
        let Some(camera) = simulation.phase.cameras.first() else {
            let (low_m, high_m) = mesh.bounds_m().unwrap_or_default();
            let extent_m = (high_m - low_m).length().max(1e-3);
            let message =
                format!("there is no camera: one looks straight down from {CAMERA_DISTANCE} times the scene's extent");
            self.note(Fate::Defaulted, &simulation.directions.at, message);
            let rotation = place.dart_from_body.transpose() * frame::camera_rotation([180.0, 180.0], 0.0);
            let centre_m = 0.5 * (low_m + high_m) + rotation.z_axis * (-CAMERA_DISTANCE * extent_m);
            let world_from_sensor = Pose { rotation, translation_m: centre_m };
            return FrameCamera { world_from_sensor, samples: 256, lines: 256, pitch: 1.0 / (CAMERA_DISTANCE * 256.0) };
        };
        for other in &simulation.phase.cameras[1..] {
            self.note(Fate::Dropped, &other.at, "a scene has one camera: this is not the first");
        }
        let pitch = |angle_deg: f64, pixels: u32| 2.0 * (0.5 * angle_deg.to_radians()).tan() / f64::from(pixels.max(1));
        let [width_deg, height_deg] = camera.field_of_view_deg;
        let [samples, lines] = camera.pixels;
        let (across, down) = (pitch(width_deg, samples), pitch(height_deg, lines));
        if (across / down - 1.0).abs() > SAME.sqrt() {
            let message =
                format!("pixels are not square: {across:e} by {down:e} of the focal length; the first is taken");
            self.note(Fate::Approximated, &camera.at, message);
        }
        let is_written = |rotation: &DMat3| {
            let (look_deg, roll_deg) = camera_deg(place.dart_from_body * *rotation, across);
            place.is_kept && same_all(&look_deg, &camera.look_deg) && same(roll_deg, camera.roll_deg)
        };
        let kept = self.sidecar.as_ref().and_then(Sidecar::world_from_sensor).filter(is_written);
        if camera.roll_deg != 0.0 && kept.is_none() {
            let message = "a turn about the line of sight: which way DART turns is not known; taken is clockwise as seen along it";
            self.note(Fate::Approximated, &camera.at, message);
        }
        self.other_views(camera, place, mesh);
        let given = || place.dart_from_body.transpose() * frame::camera_rotation(camera.look_deg, camera.roll_deg);
        let rotation = kept.unwrap_or_else(given);
        let world_from_sensor = Pose { rotation, translation_m: place.local_m(camera.position_m) };
        FrameCamera { world_from_sensor, samples, lines, pitch: across }
    }

    /// Parallel views: one from the scene's middle towards the camera is the camera's own.
    fn other_views(&mut self, camera: &Camera, place: &Place, mesh: &Mesh) {
        let directions = &self.simulation.directions;
        let dart_m =
            |f: &[u32; 3]| f.map(|v| place.dart_from_body * mesh.vertices_m[v as usize] + place.origin_in_dart_m);
        let mut corners_m = mesh.facets.iter().flat_map(dart_m);
        let first_m = corners_m.next().unwrap_or_default();
        let (low_m, high_m) = corners_m.fold((first_m, first_m), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let towards = camera.position_m - 0.5 * (low_m + high_m);
        let is_camera = |view: &&[f64; 2]| crate::geometry::angle_rad(frame::vector(**view), towards) < 1e-9;
        let others = directions.views_deg.iter().filter(|v| !is_camera(v)).count();
        if others > 0 {
            let message = format!("{others} parallel views: a scene has one camera");
            self.note(Fate::Dropped, &directions.at, message);
        }
    }

    /// The thermal model: the one that these temperatures were made of, or the one that is nearest.
    fn with_thermal(&mut self, mut scene: Scene) -> Scene {
        let simulation = self.simulation;
        if let Some(sidecar) = &self.sidecar {
            scene.thermal = sidecar.thermal();
            let functions = thermal_functions(&scene);
            let modes = intervals(&scene, &functions);
            let is_same = functions.len() == simulation.thermal.len()
                && functions
                    .iter()
                    .zip(&simulation.thermal)
                    .all(|(a, b)| same(a.mean_k, b.mean_k) && same(a.range_k, b.range_k))
                && modes.iter().map(|m| m.mode).eq(simulation.phase.bands.iter().map(|b| b.mode));
            if is_same {
                return scene;
            }
        }
        if simulation.phase.bands.iter().all(|band| band.mode == 0) {
            scene.thermal = Thermal::Off;
            return scene;
        }
        let at = simulation.thermal.first().map_or(Location::item("thermal"), |t| t.at.clone());
        let message = "temperatures are spread between two ends by sunlight: taken to be those of equilibrium";
        self.note(Fate::Approximated, &at, message);
        scene.thermal = Thermal::Equilibrium;
        scene
    }
}

/// A material of what DART says of it.
fn material(property: &OpticalProperty, table: Vec<Spectrum>) -> Material {
    // What a thick layer of isotropic scatterers reflects of diffuse light.
    let diffusive = |w: f64| (1.0 - (1.0 - w).max(0.0).sqrt()) / (1.0 + (1.0 - w).max(0.0).sqrt());
    let first = table[0].clone();
    let (reflectance, photometry) = match (property.kind, <[Spectrum; 7]>::try_from(table)) {
        (OpticalKind::Hapke, Ok(all)) => (first.map(diffusive), Photometry::Hapke(Box::new(Hapke::from(all)))),
        (OpticalKind::Rpv, Err(table)) => match <[Spectrum; 4]>::try_from(table) {
            Ok(all) => (first.map(|rho| rho.min(1.0)), Photometry::Rpv(Box::new(Rpv::from(all)))),
            Err(_) => (first, Photometry::Lambert),
        },
        _ => (first, Photometry::Lambert),
    };
    Material {
        name: property.ident.clone(),
        emissivity: reflectance.map(|r| 1.0 - r),
        bond_albedo: solar_mean(&reflectance).unwrap_or(0.0),
        emissivity_bolometric: EMISSIVITY_BOLOMETRIC,
        mixture: Vec::new(),
        reflectance,
        photometry,
    }
}

fn material_id(material: Option<usize>, at: &Location) -> Result<MaterialId> {
    let id = material.and_then(|m| u16::try_from(m).ok()).map(MaterialId);
    id.ok_or_else(|| Error::invalid(at.clone(), "more materials than can be told apart"))
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

fn same_all(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(*a, *b))
}
