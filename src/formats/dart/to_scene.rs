//! A DART simulation as a scene, and its parts without a counterpart.

mod mars;
mod mesh;
mod temperatures;

pub(in crate::formats) use mars::{FOLDER as MARS, has_mars};

use std::collections::BTreeMap;
use std::rc::Rc;

use glam::{DMat3, DVec3};

use crate::error::{Error, Location, Problem, Result, number};
use crate::formats::input::InputFile;
use crate::formats::obj::ObjFile;
use crate::formats::scene_toml::{EMISSIVITY_BOLOMETRIC, USUAL_UM};
use crate::geometry::{Direction, FrameCamera, Mesh, Pose};
use crate::progress::Watch;
use crate::report::{Fate, Report};
use crate::scene::{
    Body, Exposure, Hapke, Material, Models, Photometry, Rpv, Scene, Setup, Sky, Spectrometer, Sun, SunModel, Surface,
    Thermal,
};
use crate::spectral::{ALL_UM, Band, Extend, Light, MOST_BEYOND, SpectralLibrary, Spectrum, solar_e490, solar_mean};
use crate::units::AU_M;

use super::database::Database;
use super::folder::Folder;
use super::frame;
use super::from_scene::{camera_deg, irradiance, spectra, tabulated, width_um};
use super::place::{SAME, SceneFrame, same, same_all};
use super::sidecar::{self, Sidecar};
use super::simulation::{Links, OpticalKind, OpticalProperty, Pinhole, Simulation, SpectralInterval};
use super::text_spectra;
use temperatures::{LinkedMaterials, Warmth, named};

/// What a conversion needs besides the simulation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneOptions {
    /// Where the middle of the scene's ground is on the body, body-fixed, m; `None`: nowhere, the body's axes are East, North and up.
    pub origin_m: Option<DVec3>,
    /// Copies of a repeated scene that are taken on each side: (2 `repeat` + 1)^2 scenes in all.
    pub repeat: u32,
}

/// A scene, and how it came about.
#[derive(Debug, Clone)]
pub struct Converted {
    /// The scene, checked, as the first camera sees it.
    pub scene: Scene,
    /// What else looks at it, and where that stands.
    pub cameras: Vec<(FrameCamera, Location)>,
    /// What has no counterpart, and the defaults for what the simulation does not state.
    pub report: Report,
    /// Files that were read: the OBJ files, databases, and `mmxrt.toml`.
    pub inputs: Vec<InputFile>,
}

/// Reflectance of what cannot be looked up.
const UNKNOWN_REFLECTANCE: f64 = 0.1;
/// Rounds that bring the Sun's spectrum to the irradiances of bands; each leaves some hundredths of the error.
const ROUNDS: usize = 8;
/// Irradiances of bands that are off by more than this share are reported.
const UNFIT: f64 = 1e-6;
/// A view is a camera's own within the digits that DART prints of both.
const SAME_VIEW_RAD: f64 = 1e-9;
/// Where a simulation has no camera, one looks down from this many times the scene's extent.
const CAMERA_DISTANCE: f64 = 10.0;

/// The scene of a simulation whose folder holds the files it names, and `mmxrt.toml` if it was written here.
///
/// # Errors
/// [`Error::Invalid`] for links that lead nowhere, files that are missing, lie outside, or cannot be used, a scene that cannot be
/// repeated as often as is asked for, and as [`Scene::new`]; [`Error::Unsupported`] for terrains as [`super::terrain`];
/// [`Error::Io`]; [`Error::Interrupted`].
pub fn to_scene(
    simulation: &Simulation,
    folder: &Folder,
    options: &SceneOptions,
    watch: Watch<'_>,
) -> Result<Converted> {
    let mut reader = SceneBuilder {
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
    let (scene, cameras) = reader.scene()?;
    Ok(Converted { scene, cameras, report: reader.report, inputs: reader.inputs })
}

struct SceneBuilder<'a> {
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

impl SceneBuilder<'_> {
    fn note(&mut self, fate: Fate, at: &Location, message: impl Into<String>) {
        self.report.note(fate, at.clone(), message);
    }

    fn scene(&mut self) -> Result<(Scene, Vec<(FrameCamera, Location)>)> {
        let place = self.place();
        self.wavelengths()?;
        let bands = self.bands();
        let sun = self.sun(&place, &bands);
        let (mut materials, linked) = self.materials(&bands)?;
        let mesh = self.mesh(&place, &mut materials, &linked)?;
        let camera = self.camera(&place, &mesh);
        let others = self.simulation.phase.cameras.iter().skip(1);
        let others: Vec<_> = others.map(|other| (self.pinhole(other, &place), other.at.clone())).collect();
        let name = self.sidecar.as_ref().map_or("DART camera", Sidecar::sensor_name).to_owned();
        let exposure = Exposure { instrument: name, camera, bands, spectrometer: Spectrometer::default() };
        let sky = self.sky(sun, &place);
        let scene = Setup {
            body: Body::new(Surface { origin_m: place.origin_m, mesh, materials, textures: vec![] })?,
            sky,
            exposure,
            models: Models {
                thermal: Thermal::Off,
                sun: self.sidecar.as_ref().map_or(SunModel::Point, |sidecar| sidecar.models().sun),
                ..Models::default()
            },
        };
        let scene = self.with_mars(scene, &place);
        let scene = Scene::new(self.with_thermal(scene)?)?;
        let mut cameras = Vec::new();
        for (camera, at) in others {
            match scene.seen_by(Exposure { camera: camera.clone(), ..scene.exposure.clone() }) {
                Ok(_) => cameras.push((camera, at)),
                Err(error) => {
                    let why: Vec<String> = error.problems().into_iter().map(|problem| problem.message).collect();
                    self.note(Fate::Dropped, &at, format!("a camera: {}", why.join("; ")));
                }
            }
        }
        Ok((scene, cameras))
    }

    /// The sky under this Sun, with what was written beside the simulation for this place.
    fn sky(&mut self, sun: Sun, place: &SceneFrame) -> Sky {
        let mut sky = Sky { sun, mars: None, bodies: vec![], beams: vec![], rotation: None, past: None };
        let Some(sidecar) = &self.sidecar else { return sky };
        let (bodies, beams, rotation) = (sidecar.bodies(), sidecar.beams(), sidecar.rotation());
        if place.is_kept {
            (sky.bodies, sky.beams, sky.rotation) = (bodies, beams, rotation);
        } else if !bodies.is_empty() || !beams.is_empty() || rotation.is_some() {
            let message =
                "bodies, lamps and the length of a day: the scene is elsewhere than where they were given for it";
            self.note(Fate::Dropped, &Location::item("bodies"), message);
        }
        sky
    }

    /// Where the scene is on the body.
    fn place(&mut self) -> SceneFrame {
        let place = SceneFrame::of(&self.simulation.maket, self.sidecar.as_ref(), self.options.origin_m);
        if !place.is_kept && self.options.origin_m.is_none() {
            let message = "DART does not say where on the body the scene is: taken to be at its centre, with x East, y North and z up. \
                           Give the place of the scene's middle";
            self.note(Fate::Defaulted, &Location::item("origin_m"), message);
        }
        place
    }

    /// Refuses bands at wavelengths that no scene has: they are in another unit.
    fn wavelengths(&self) -> Result<()> {
        let long = self.simulation.phase.bands.iter().filter(|band| band.mean_um > USUAL_UM);
        let problem = |band: &SpectralInterval| {
            let message = format!("a band at {} um: DART's wavelengths are in micrometres", band.mean_um);
            Problem::new(band.at.clone(), message).with_help(nanometres(band))
        };
        let problems: Vec<Problem> = long.map(problem).collect();
        if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
    }

    fn bands(&mut self) -> Vec<Band> {
        let mut cut = None;
        let (first_um, last_um) = solar_e490().coverage_um();
        let intervals = &self.simulation.phase.bands;
        let bands = intervals.iter().enumerate().map(|(i, interval)| {
            let light = light(interval.mode);
            let kept = self.sidecar.as_ref().and_then(|s| s.band(i, interval.mean_um));
            if let Some(band) = kept.filter(|band| same(width_um(band), interval.width_um)) {
                // `with_thermal` asks whether its light is still what was written.
                return band;
            }
            if interval.width_um == 0.0 {
                return Band { light, ..Band::new(interval.mean_um, None) };
            }
            let band = Band { light, ..Band::boxed(interval.mean_um, interval.width_um) };
            let known_um = if light.is_lit() { (first_um, last_um) } else { ALL_UM };
            if band.share_beyond(known_um) <= MOST_BEYOND {
                return band;
            }
            cut.get_or_insert(&interval.at);
            let (from, to) = band.support_within_um(known_um);
            if from < to { Band { light, ..Band::boxed(0.5 * (from + to), to - from) } } else { band }
        });
        let bands = bands.collect();
        if let Some(at) = cut {
            let message =
                format!("a band reaches beyond sunlight as it is known, {first_um} to {last_um} um: it ends there");
            self.report.note(Fate::Approximated, at.clone(), message);
        }
        bands
    }

    fn sun(&mut self, place: &SceneFrame, bands: &[Band]) -> Sun {
        let phase = &self.simulation.phase;
        let directions = &self.simulation.directions;
        let towards = place.dart_from_body.transpose() * frame::vector(directions.sun_deg);
        // A vector made of angles is of length 1, turned or not.
        let direction = Direction::new(towards).unwrap_or(Direction::Z);
        let given: Vec<Option<f64>> = phase.irradiance.iter().map(|value| Some((*value)?.0)).collect();
        let is_given = phase.irradiance_mode == 1 && given.iter().any(Option::is_some);
        let is_as_given = |sun: &Sun| {
            let pairs = irradiance(sun, bands).into_iter().zip(&given);
            pairs.into_iter().all(|(now, given)| given.is_none_or(|given| same(now, given)))
        };
        if let Some(sun) = self.sidecar.as_ref().and_then(|s| s.sun(s.sun_below_horizon()?))
            && is_given
            && place.is_kept
            && directions.sun_deg == [0.0; 2]
            && given.iter().flatten().all(|e| *e == 0.0)
        {
            return sun;
        }
        if let Some(sun) = self.sidecar.as_ref().and_then(|s| s.sun(direction))
            && is_given
            && is_as_given(&sun)
        {
            return sun;
        }
        let e490 = solar_e490();
        let total = e490.integral(e490.coverage_um().0, e490.coverage_um().1).unwrap_or(crate::units::TSI_1AU_W_M2);
        let at_1_au = Sun {
            direction,
            distance_m: AU_M,
            irradiance_1au: e490.clone(),
            total_irradiance_1au_w_m2: total,
            limb_darkening: 0.0,
        };
        let item = Location::item("sun");
        if !is_given {
            let message = "DART does not say how far the Sun is: taken to be 1 au, with the spectrum ASTM E490-00a";
            self.note(Fate::Defaulted, &item, message);
            return at_1_au;
        }
        // Bands that see sunlight, in ascending order, and how much more than E490 at 1 au they have.
        let told = |i: usize| given.get(i).copied().flatten();
        let all: Vec<usize> = (0..bands.len()).filter(|&i| phase.bands[i].mode != 2 && told(i).is_some()).collect();
        let given: Vec<f64> = (0..bands.len()).map(|i| told(i).unwrap_or(0.0)).collect();
        let mut lit = all.clone();
        lit.sort_by(|&i, &j| bands[i].centre_um.total_cmp(&bands[j].centre_um));
        lit.dedup_by_key(|i| bands[*i].centre_um);
        let of_e490 = irradiance(&at_1_au, bands);
        let mut ratios: Vec<f64> =
            lit.iter().map(|&i| given[i] / of_e490[i]).filter(|r| *r > 0.0 && r.is_finite()).collect();
        ratios.sort_by(f64::total_cmp);
        // Their middle gives the distance.
        let middle = ratios.get(ratios.len() / 2).copied().unwrap_or(1.0);
        let distance_au = middle.sqrt().recip();
        let message = format!(
            "DART has irradiances of bands only: the distance, {distance_au:.4} au, is that where the spectrum ASTM E490-00a has them \
             in the middle; what they have more or less than it is linear between the bands"
        );
        self.note(Fate::Defaulted, &item, message);
        let mut sun = Sun { distance_m: distance_au * AU_M, ..at_1_au };
        let mut factors = vec![1.0; lit.len()];
        // A band sees what lies around its centre: a few rounds make its mean what is given.
        for _ in 0..ROUNDS {
            let now = irradiance(&sun, bands);
            if lit.iter().all(|&i| same(now[i], given[i])) {
                break;
            }
            for (factor, &i) in factors.iter_mut().zip(&lit) {
                let more = given[i] / now[i];
                *factor *= if more.is_finite() { more } else { 0.0 };
            }
            let um: Vec<f64> = lit.iter().map(|&i| bands[i].centre_um).collect();
            sun.irradiance_1au = times(e490, um, factors.clone()).unwrap_or_else(|| e490.clone());
        }
        let now = irradiance(&sun, bands);
        let off = |i: usize| (now[i] - given[i]).abs() / now[i].max(given[i]).max(f64::MIN_POSITIVE);
        if let Some(&i) = all.iter().max_by(|i, j| off(**i).total_cmp(&off(**j))).filter(|i| off(**i) > UNFIT) {
            let (is, wanted, at) = (now[i], given[i], phase.bands[i].at.clone());
            let message = format!(
                "no spectrum that is linear between the bands' centres has all of their irradiances: this band has {is} W m-2 um-1 \
                 instead of {wanted}"
            );
            self.note(Fate::Approximated, &at, message);
        }
        let (first, last) = sun.irradiance_1au.coverage_um();
        // A total of nothing would be no Sun.
        let all = sun.irradiance_1au.integral(first, last).filter(|all| *all > 0.0);
        Sun { total_irradiance_1au_w_m2: all.unwrap_or(total), ..sun }
    }

    /// Materials, and which of them links lead to.
    fn materials(&mut self, bands: &[Band]) -> Result<(Vec<Material>, LinkedMaterials)> {
        let simulation = self.simulation;
        let mut warmths: Vec<Vec<Warmth>> = vec![Vec::new(); simulation.optical.len()];
        for links in self.links() {
            let property = self.property(links)?;
            let warmth = self.warmth(links, property)?;
            if !warmths[property].contains(&warmth) {
                warmths[property].push(warmth);
            }
        }
        let is_linked: Vec<bool> = warmths.iter().map(|of_property| !of_property.is_empty()).collect();
        let ground = self.property(&simulation.maket.ground)?;
        let is_ground = |i: usize| simulation.maket.ground_enabled && i == ground;
        let mut found = Vec::new();
        let mut default = None;
        for (i, property) in simulation.optical.iter().enumerate() {
            let notes = self.report.notes.len();
            let Some(table) = self.table(property, is_linked[i] || is_ground(i), bands)? else { continue };
            // A black ground at 0 K whose material nothing else uses represents the sky.
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
            let mut of_property = std::mem::take(&mut warmths[i]);
            if is_ground(i) {
                of_property.push(self.warmth(&simulation.maket.ground, i)?);
            }
            if of_property.is_empty() {
                of_property.push(Warmth::Modelled);
            }
            // The first keeps its name.
            of_property.sort_by_key(|warmth| match warmth {
                Warmth::Modelled => 0,
                Warmth::OfCell => 1,
                Warmth::Held(_) => 2,
            });
            for (n, warmth) in of_property.iter().enumerate().filter(|(n, warmth)| !of_property[..*n].contains(warmth))
            {
                let mut material = material.clone();
                material.temperature_k = match warmth {
                    Warmth::Held(t_k) => Some(*t_k),
                    Warmth::Modelled | Warmth::OfCell => None,
                };
                if n > 0 {
                    let is_taken = |name: &str| {
                        let is_found = found.iter().any(|(_, other): &(_, Material)| other.name == name);
                        is_found || simulation.optical.iter().any(|other| other.ident == name)
                    };
                    material.name = named(is_taken, &material.name, material.temperature_k);
                }
                found.push(((i, *warmth), material));
            }
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
        let mut linked = LinkedMaterials::default();
        for (place, ((property, warmth), material)) in found.iter_mut().enumerate() {
            linked.put(*property, *warmth, place);
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
        Ok((materials, linked))
    }

    /// Links of visible objects, those of their backs too.
    fn links(&self) -> impl Iterator<Item = &Links> {
        let models = self.simulation.fields.iter().flat_map(|f| &f.models);
        let objects = self.simulation.objects.iter().chain(models).filter(|o| !o.hidden);
        objects.flat_map(|o| {
            let of_groups = o.groups.iter().flat_map(|g| g.links.iter().chain(&g.back));
            o.links.iter().chain(&o.back).chain(of_groups)
        })
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
        let has_cells = self.simulation.phase.cells.is_some();
        kind == OpticalKind::Lambertian
            && table[0].value().iter().all(|v| *v == 0.0)
            && thermal.is_some_and(|t| t.mean_k == 0.0 && t.range_k == 0.0 && (t.overrides_cells || !has_cells))
            // Hills hide what is behind them.
            && self.simulation.maket.topography.is_none()
    }

    /// What a property's table holds, as [`spectra`] has it; `None` if it is not needed and not there.
    fn table(&mut self, property: &OpticalProperty, is_needed: bool, bands: &[Band]) -> Result<Option<Vec<Spectrum>>> {
        let found = match self.spectra(property) {
            // What nothing is made of does not matter.
            Err(Error::Invalid(_) | Error::Syntax { .. } | Error::Unsupported { .. } | Error::Io { .. })
                if !is_needed =>
            {
                None
            }
            found => found?,
        };
        let Some((mut spectra, report)) = found else {
            if !is_needed {
                return Ok(None);
            }
            let what = if property.model.is_empty() { "text" } else { "database" };
            let message = format!(
                "the {what} {:?} of {:?} is not there: a Lambert surface of reflectance {UNKNOWN_REFLECTANCE} is taken. Name the \
                 folder it is in",
                property.database, property.ident
            );
            self.note(Fate::Approximated, &property.at, message);
            return Ok(Some(vec![Spectrum::constant(UNKNOWN_REFLECTANCE)]));
        };
        self.report.notes.extend(report.notes);
        let (first, last) = spectra[0].coverage_um();
        let needed =
            bands.iter().map(Band::support_um).fold((f64::INFINITY, 0.0f64), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        if needed.0 < first || last < needed.1 {
            if is_needed {
                let unit = if first > USUAL_UM { " (are these nanometres? DART's tables are in um)" } else { "" };
                let message = format!(
                    "{:?} is known from {first} to {last} um{unit}, which does not cover all bands: its end values are held",
                    property.ident
                );
                self.note(Fate::Approximated, &property.at, message);
            }
            let held = |s: &Spectrum| Spectrum::new(s.wavelength_um().to_vec(), s.value().to_vec(), Extend::Hold);
            spectra = spectra.iter().map(|s| held(s).unwrap_or_else(|| s.clone())).collect();
        }
        self.multiply(property, bands, &mut spectra);
        Ok(Some(spectra))
    }

    /// The columns of a property's table, and what is lost of it; `None` if there is no such file.
    fn spectra(&mut self, property: &OpticalProperty) -> Result<Option<(Vec<Spectrum>, Report)>> {
        if property.model.is_empty() {
            return self.text(property);
        }
        let Some(database) = self.database(property)? else { return Ok(None) };
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
        let none = || Error::invalid(property.at.clone(), format!("the table {:?} is not a spectrum", property.model));
        read.ok_or_else(none).map(Some)
    }

    /// The reflectance of a text, which is what properties were before 5.7.
    fn text(&mut self, property: &OpticalProperty) -> Result<Option<(Vec<Spectrum>, Report)>> {
        let OpticalProperty { database: name, at, .. } = property;
        if name.is_empty() {
            return Err(Error::invalid(
                at.clone(),
                format!("{:?} is neither a table of a database nor a text file", property.ident),
            ));
        }
        let located = self.folder.locate(name, at).map_err(|problem| Error::Invalid(vec![problem]))?;
        let Some(path) = located else { return Ok(None) };
        let (library, mut report) = text_spectra::read(&path)?;
        self.inputs.push(InputFile::hashed(&path)?);
        let most = |name: &str| library.column(name).unwrap_or_default().iter().copied().fold(0.0, f64::max);
        let percent = 100.0 * (most("direct_transmittance") + most("diffuse_transmittance"));
        if percent > 0.0 {
            let message = format!("a transmittance of up to {percent} %: taken to be opaque");
            report.note(Fate::Dropped, Location::file(&path), message);
        }
        if property.kind != OpticalKind::Lambertian {
            let message = format!(
                "how {:?} takes its parameters from a text is not known: taken is a Lambert surface of the reflectance there",
                property.ident
            );
            report.note(Fate::Approximated, at.clone(), message);
        }
        let reflectance = library.spectrum("reflectance", Extend::Error);
        let reflectance = reflectance.ok_or_else(|| Error::invalid(Location::file(&path), "has no reflectance"))?;
        Ok(Some((vec![reflectance], report)))
    }

    /// Multiplicative factors of a table's columns.
    fn multiply(&mut self, property: &OpticalProperty, bands: &[Band], spectra: &mut [Spectrum]) {
        let names: &[&str] = match property.kind {
            _ if property.model.is_empty() => &["reflectanceFactor"],
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
        let (mut varies, mut differ) = (false, false);
        for (spectrum, name) in spectra.iter_mut().zip(names) {
            let factor = |band: &Vec<(String, f64)>| band.iter().find(|(n, _)| n == name).map_or(1.0, |f| f.1);
            let factors: Vec<f64> = property.factors.iter().map(factor).collect();
            let Some(&last) = factors.last() else { continue };
            if factors.iter().all(|f| *f == last) {
                *spectrum = spectrum.map(|v| v * last);
                continue;
            }
            varies = true;
            let mut points: Vec<(f64, f64)> = Vec::new();
            for (i, band) in bands.iter().enumerate() {
                let um = band.centre_um;
                // Known at every centre: what does not cover the bands is held.
                let Some(value) = spectrum.at(um) else { continue };
                points.push((um, factors.get(i).copied().unwrap_or(last) * value));
            }
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points.dedup_by(|b, a| {
                let is_same = a.0 == b.0;
                differ |= is_same && a.1 != b.1;
                is_same
            });
            let (um, value) = points.into_iter().unzip();
            *spectrum = Spectrum::new(um, value, Extend::Hold).unwrap_or_else(|| spectrum.clone());
        }
        if differ {
            let message = "bands of one centre have different factors: those of the first are taken for both";
            self.note(Fate::Approximated, &property.at, message);
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
                self.inputs.push(InputFile::hashed(&path)?);
            }
            self.databases.insert(name.clone(), opened);
        }
        Ok(self.databases.get(name).and_then(Option::as_ref))
    }

    /// The first camera.
    fn camera(&mut self, place: &SceneFrame, mesh: &Mesh) -> FrameCamera {
        let simulation = self.simulation;
        let Some(camera) = simulation.phase.cameras.first() else {
            let (low_m, high_m) = mesh.bounds_m().unwrap_or_default();
            // A point has no extent.
            let extent_m = Some((high_m - low_m).length()).filter(|extent_m| *extent_m > 0.0).unwrap_or(1.0);
            let message =
                format!("there is no camera: one looks straight down from {CAMERA_DISTANCE} times the scene's extent");
            self.note(Fate::Defaulted, &simulation.directions.at, message);
            let rotation = place.dart_from_body.transpose() * frame::camera_rotation([180.0, 180.0], 0.0);
            let centre_m = 0.5 * (low_m + high_m) + rotation.z_axis * (-CAMERA_DISTANCE * extent_m);
            let world_from_sensor = Pose { rotation, translation_m: centre_m };
            return FrameCamera::centred(world_from_sensor, 256, 256, 1.0 / (CAMERA_DISTANCE * 256.0));
        };
        self.other_views(place, mesh);
        self.pinhole(camera, place)
    }

    fn pinhole(&mut self, camera: &Pinhole, place: &SceneFrame) -> FrameCamera {
        let pitch = |angle_deg: f64, pixels: u32| FrameCamera::pitch_of_angle(angle_deg.to_radians(), pixels.max(1));
        let [width_deg, height_deg] = camera.field_of_view_deg;
        let [samples, lines] = camera.pixels;
        let (across, down) = (pitch(width_deg, samples), pitch(height_deg, lines));
        // Angles are rounded: pixels that differ by no more are square.
        let is_square = (across / down - 1.0).abs() <= SAME.sqrt();
        let is_written = |rotation: &DMat3| {
            let (look_deg, roll_deg) = camera_deg(place.dart_from_body * *rotation, across);
            place.is_kept && same_all(&look_deg, &camera.look_deg) && same(roll_deg, camera.roll_deg)
        };
        let kept = self.sidecar.as_ref().and_then(Sidecar::world_from_sensor).filter(is_written);
        if camera.roll_deg != 0.0 && kept.is_none() {
            let message = "a turn about the line of sight: which way DART turns is not known; taken is clockwise as seen along it";
            self.note(Fate::Approximated, &camera.at, message);
        }
        let given = || place.dart_from_body.transpose() * frame::camera_rotation(camera.look_deg, camera.roll_deg);
        let rotation = kept.unwrap_or_else(given);
        let world_from_sensor = Pose { rotation, translation_m: place.local_m(camera.position_m) };
        let centred = FrameCamera::centred(world_from_sensor, samples, lines, across);
        if is_square { centred } else { FrameCamera { pitch: [across, down], ..centred } }
    }

    /// Parallel views: one from the scene's middle towards a camera is that camera's own.
    fn other_views(&mut self, place: &SceneFrame, mesh: &Mesh) {
        let directions = &self.simulation.directions;
        let dart_m =
            |f: &[u32; 3]| f.map(|v| place.dart_from_body * mesh.vertices_m[v as usize] + place.origin_in_dart_m);
        let mut corners_m = mesh.facets.iter().flat_map(dart_m);
        let first_m = corners_m.next().unwrap_or_default();
        let (low_m, high_m) = corners_m.fold((first_m, first_m), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let middle_m = 0.5 * (low_m + high_m);
        let is_camera = |view: &&[f64; 2]| {
            let is_towards = |c: &Pinhole| {
                crate::geometry::angle_rad(frame::vector(**view), c.position_m - middle_m) < SAME_VIEW_RAD
            };
            self.simulation.phase.cameras.iter().any(is_towards)
        };
        let others = directions.views_deg.iter().filter(|v| !is_camera(v)).count();
        if others > 0 {
            let message = format!("{others} parallel views: a scene has one camera");
            self.note(Fate::Dropped, &directions.at, message);
        }
    }
}

/// What to write instead of nanometres.
pub(super) fn nanometres(band: &SpectralInterval) -> String {
    let [mean_um, width_um] = [band.mean_um, band.width_um].map(|nm| number(nm / 1000.0));
    format!("if this is nanometres, write {mean_um} and a width of {width_um}")
}

/// What light a band has by its `spectralDartMode`.
fn light(mode: u32) -> Light {
    match mode {
        0 => Light::Sunlight,
        1 => Light::Both,
        _ => Light::Heat,
    }
}

/// A spectrum times a factor that is linear between these points, and beyond them that of the first or the last.
fn times(spectrum: &Spectrum, um: Vec<f64>, factors: Vec<f64>) -> Option<Spectrum> {
    let factor = Spectrum::new(um, factors, Extend::Hold)?;
    let mut um = [spectrum.wavelength_um(), factor.wavelength_um()].concat();
    um.sort_by(f64::total_cmp);
    um.dedup();
    let value: Option<Vec<f64>> = um.iter().map(|&um| Some(spectrum.at(um)? * factor.at(um)?)).collect();
    Spectrum::new(um, value?, spectrum.extend())
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
        thermal_inertia: 0.0,
        temperature_k: None,
        mixture: Vec::new(),
        reflectance,
        photometry,
    }
}
