//! A scene as a DART simulation, with all the files it names.

mod fields;
mod flown;
mod optics;
mod sheets;
mod surfaces;

use glam::{DAffine3, DMat3, DVec3};

use crate::error::{Error, Location, Problem, Result};
use crate::geometry::{Copies, Direction, FrameCamera, Mesh, index_u32, whole};
use crate::physics::sun;
use crate::physics::sun_disc::share_beside_sphere;
use crate::report::{Fate, Report};
use crate::scene::{Globe, Photometry, Scene, Setup, Sky, SunModel, Thermal};
use crate::spectral::{Band, Response, SpectralLibrary};

use super::frame;
use super::inputs::{TargetVersion, unknown};
use super::sidecar::{self, Sidecar};
use super::simulation::{Directions, Group, Links, Maket, Object, ObjectField, Phase, Pinhole, Simulation};
pub(super) use fields::text as places_text;
pub use flown::add_flight;
use optics::{
    MONOCHROMATIC_UM, band_mean, databases, emissivity_off, links, on_facet_from_mars, optical, rectangle_off,
    sunlight, unique_names,
};
pub(super) use optics::{intervals, irradiance, spectra, tabulated, thermal_functions, width_um};
pub use surfaces::group_names;
use surfaces::{GROUPS, surfaces};

/// Differences up to this are not reported: they are the same in DART.
const SAME: f64 = 1e-3;

/// What a simulation's folder holds.
#[derive(Debug, Clone)]
pub struct Package {
    /// The inputs.
    pub simulation: Simulation,
    /// The meshes that its objects name, in the order of the objects.
    pub surfaces: Vec<ObjectMesh>,
    /// The same of its object fields, each of which has one model.
    pub fields: Vec<ObjectMesh>,
    /// Its databases: file name and tables.
    pub databases: Vec<(String, Vec<SpectralLibrary>)>,
    /// The same surface lit by Mars alone, where it is: DART has one parallel source, and light adds.
    pub mars: Option<Simulation>,
    /// What DART cannot hold.
    pub sidecar: Option<Sidecar>,
    /// What DART will have to cope with.
    pub size: Size,
}

/// An OBJ file's mesh.
#[derive(Debug, Clone)]
pub struct ObjectMesh {
    /// In DART's axes, its own origin; a facet's material is its place among the groups.
    pub mesh: Mesh,
    /// Its groups, in the order that DART gives them.
    pub groups: Vec<ObjectGroup>,
}

/// Facets of an OBJ file that are made of the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ObjectGroup {
    /// Its name in the file.
    pub name: String,
    /// The scene's material.
    pub front: usize,
    /// That of the other side, if there is one.
    pub back: Option<usize>,
}

/// How large a simulation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Triangles.
    pub facets: u64,
    /// Cells along x, y and z.
    pub cells: [u64; 3],
    /// Memory that DART may need: [`Size::of`].
    pub bytes: u64,
}

impl Size {
    /// Memory by a formula that is inferred, not known: a cell 64 bytes; a triangle 256, and 80 for each band (light in ten angular
    /// sectors); a pixel of an image 8 bytes a band.
    pub fn of(simulation: &Simulation, facets: u64, height_m: f64) -> Self {
        let maket = &simulation.maket;
        let count = |extent_m: f64, cell_m: f64| whole((extent_m / cell_m - 1e-9).ceil()).max(1) as u64;
        let [x, y] = maket.size_m.map(|extent_m| count(extent_m, maket.cell_m[0]));
        let cells = [x, y, count(height_m, maket.cell_m[1])];
        let bands = simulation.phase.bands.len() as u64;
        let of_camera = |c: &Pinhole| u64::from(c.pixels[0]) * u64::from(c.pixels[1]);
        let views = 1 + simulation.directions.views_deg.len() as u64;
        let product = |factors: &[u64]| factors.iter().fold(1_u64, |n, factor| n.saturating_mul(*factor));
        let pixels =
            simulation.phase.cameras.iter().map(of_camera).fold(product(&[views, x, y]), |n, of| n.saturating_add(of));
        let bytes = [
            product(&[64, cells[0], cells[1], cells[2]]),
            product(&[facets, 256 + 80 * bands]),
            product(&[pixels, bands, 8]),
        ];
        let bytes = bytes.iter().fold(0_u64, |n, of| n.saturating_add(*of));
        Size { facets, cells, bytes }
    }
}

/// What a conversion leaves to its caller.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationOptions {
    /// Version of DART.
    pub target: TargetVersion,
    /// Size of a cell, m; `None`: the footprint of a camera pixel.
    pub cell_m: Option<f64>,
    /// Memory that DART may take, bytes.
    pub memory_bytes: u64,
    /// Facets of the scene that are copies of a mesh: they become object fields, in the version of which these are known.
    pub copies: Vec<Copies>,
}

impl Default for SimulationOptions {
    fn default() -> Self {
        SimulationOptions { target: TargetVersion::default(), cell_m: None, memory_bytes: 16 << 30, copies: Vec::new() }
    }
}

/// The OBJ file, and the object that it is.
const SURFACE: &str = "surface";
/// A camera farther away than this many times the scene's extent sees it as a parallel view does.
const DISTANT: f64 = 5.0;

/// The simulation of a scene, and what became of what DART has no exact counterpart for.
///
/// The surface keeps its own origin, turned into the site's axes (South, East, up); its place in DART's frame is that of the
/// scene's corner, with a margin of at most half a cell.
///
/// # Errors
/// [`Error::Invalid`] for a cell that is not a length, and materials that the version is not known to have.
pub fn from_scene(scene: &Scene, options: &SimulationOptions) -> Result<(Package, Report)> {
    let mut report = Report::default();
    let dart_from_body = frame::dart_from_body(scene.body.origin_m);
    let mut mesh = scene.body.mesh.clone();
    mesh.vertices_m.iter_mut().for_each(|v| *v = dart_from_body * *v);
    mesh.face_of_facet = Vec::new();
    let (low_m, high_m) = mesh.bounds_m().unwrap_or_default();
    let size_m = high_m - low_m;
    let names = unique_names(scene);
    let optical = optical(scene, &names);
    let mut problems = unknown(&optical, options.target);
    if let Some(cell_m) = options.cell_m.filter(|cell_m| !(*cell_m > 0.0 && cell_m.is_finite())) {
        problems.push(Problem::new(Location::item("cell"), format!("{cell_m} m is not a positive length")));
    }
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let cell_m = match options.cell_m {
        Some(cell_m) => cell_m,
        None => {
            let cell_m = pixel_m(scene, size_m);
            let message = format!("cells of {cell_m} m: about what a pixel of the camera sees");
            report.note(Fate::Defaulted, Location::item("cell"), message);
            cell_m
        }
    };
    // A whole number of cells, and a margin on all sides: nothing lies on the scene's edge or in the ground plane.
    let extent_m = extent_m(size_m, cell_m);
    let origin_in_dart_m = 0.5 * (extent_m - size_m) - low_m;
    let site = Site { scene, dart_from_body, origin_in_dart_m };

    let links = links(scene, &names);
    let thermal = thermal_functions(scene);
    // Of 5.11 fields are not known.
    let copies = if options.target == TargetVersion::V5_7_4 { &options.copies[..] } else { &[] };
    let dart_from_mesh = DAffine3 { matrix3: dart_from_body, translation: origin_in_dart_m };
    let mut split = fields::split(&mesh, copies, dart_from_mesh, [extent_m.x, extent_m.y]);
    let faces = sidecar::runs_in_order(&scene.body.mesh, &sheets::as_read(&mesh));
    let surfaces = surfaces(split.rest.take().unwrap_or(mesh));
    let bands = intervals(scene, &thermal);
    let irradiance = sunlight(scene).into_iter().map(|e| Some((e, 0.0))).collect();
    let camera = site.camera();
    let centre_m = 0.5 * extent_m;
    let towards_camera = camera.position_m - centre_m;
    let is_distant = towards_camera.length() > DISTANT * size_m.length();
    let views_deg = (is_distant && towards_camera.z > 0.0).then(|| frame::angles_deg(towards_camera));
    let mut simulation = Simulation {
        version: options.target.version(),
        maket: Maket {
            size_m: [extent_m.x, extent_m.y],
            cell_m: [cell_m; 2],
            boundary: 0,
            ground: links[scene.body.materials.len()].clone(),
            ground_enabled: options.target == TargetVersion::V5_7_4,
            topography: None,
            latitude_longitude_altitude: frame::latitude_longitude_altitude(scene.body.origin_m),
            at: Location::item("maket"),
        },
        optical,
        thermal,
        objects: Vec::new(),
        fields: Vec::new(),
        sequences: Vec::new(),
        phase: Phase {
            bands,
            irradiance_mode: 1,
            irradiance,
            temperature_mode: 0,
            cells: None,
            radiance_products: true,
            cameras: vec![camera],
        },
        directions: Directions {
            // A Sun without light stands in the zenith.
            sun_deg: frame::sun_deg(scene.body.origin_m, scene.sky.sun.direction).unwrap_or_default(),
            views_deg: views_deg.into_iter().collect(),
            at: Location::item("sun"),
        },
    };
    let object = |(i, surface): (usize, &ObjectMesh)| site.object(i, &surface.groups, options.target, &links);
    simulation.objects = surfaces.iter().enumerate().map(object).collect();
    let field = |(i, field): (usize, &fields::Field)| {
        let name = format!("field_{}", i + 1);
        let model = Object {
            file: format!("obj/{name}.obj"),
            name: name.clone(),
            position_m: DVec3::ZERO,
            ..site.object(0, &field.surface.groups, options.target, &links)
        };
        let (file, places) = (format!("{name}.txt"), field.places.clone());
        ObjectField { name, file, models: vec![model], places, at: Location::item("mesh") }
    };
    simulation.fields = split.fields.iter().enumerate().map(field).collect();
    let of_surfaces: usize = surfaces.iter().map(|surface| surface.mesh.facets.len()).sum();
    let of_field = |field: &fields::Field| field.places.len() * field.surface.mesh.facets.len();
    let facets = of_surfaces + split.fields.iter().map(of_field).sum::<usize>();
    let backs = scene.body.mesh.facets.len().saturating_sub(facets);
    let size = Size::of(&simulation, facets as u64, extent_m.z);
    let mut sidecar = Sidecar::of(scene, origin_in_dart_m);
    let faces = faces.filter(|_| simulation.fields.is_empty());
    sidecar.take_faces(faces.clone());
    site.field_notes(&simulation, &split, &mut report);
    sheet_notes(backs, options.target, &mut report);
    site.notes(&simulation, &size, options, faces.as_deref(), &mut report);
    let mars = site.by_mars(&simulation, &mut report);
    let databases = databases(scene, &names);
    let fields = split.fields.into_iter().map(|field| field.surface).collect();
    Ok((Package { simulation, surfaces, fields, databases, mars, sidecar: Some(sidecar), size }, report))
}

/// What became of facets that are the other side of one.
fn sheet_notes(backs: usize, target: TargetVersion, report: &mut Report) {
    if backs == 0 {
        return;
    }
    let (item, mut message) = (Location::item("mesh"), format!("{backs} facets are another one turned round: "));
    message += "they are its back in DART (`doubleFace`)";
    report.note(Fate::Carried, item.clone(), message);
    if target == TargetVersion::V5_11_0 {
        let message = "how 5.11 has properties of a back is inferred from 5.7.4, not documented";
        report.note(Fate::Approximated, item, message);
    }
}

/// What cells hold all of a surface of this size, m.
fn extent_m(size_m: DVec3, cell_m: f64) -> DVec3 {
    (size_m / cell_m).floor() * cell_m + DVec3::splat(cell_m)
}

/// A simulation of the scene with Mars in the Sun's place: a beam from its centre, with the irradiance of a facet that faces it.
/// `None` without a Mars, and if it is below the site's horizon, or dark.
pub(super) fn lit_by_mars(scene: &Setup, dart_from_body: DMat3, simulation: &Simulation) -> Option<Simulation> {
    let mars = scene.sky.mars.as_ref()?;
    let towards = Direction::new(mars.centre_m)?.vec();
    let mars_deg = frame::angles_deg(dart_from_body * towards);
    let share = on_facet_from_mars(mars, scene.models.mars_light, towards, scene.sky.sun.direction.vec());
    if mars_deg[0] >= 90.0 || share <= 0.0 {
        return None;
    }
    let sun = &scene.sky.sun;
    let irradiance = scene.exposure.bands.iter().map(|band| {
        // A band of heat alone has no light of Mars either.
        let product = match band.light.is_lit() {
            true => band_mean(band, &[&sun.irradiance_1au, &mars.reflectance]),
            false => 0.0,
        };
        Some((share * sun::irradiance_at(product, sun.distance_m), 0.0))
    });
    let mut by_mars = simulation.clone();
    by_mars.phase.irradiance = irradiance.collect();
    // Heat is in the other simulation.
    by_mars.phase.bands.iter_mut().for_each(|band| band.mode = 0);
    by_mars.directions.sun_deg = mars_deg;
    by_mars.directions.at = Location::item("mars");
    Some(by_mars)
}

/// What a pixel of the camera sees of the scene's middle, m, in two digits; between a tenth and a two-thousandth of its extent.
fn pixel_m(scene: &Scene, size_m: DVec3) -> f64 {
    let (low_m, high_m) = scene.body.mesh.bounds_m().unwrap_or_default();
    let camera = &scene.exposure.camera;
    // A point has no extent.
    let extent_m = Some(size_m.max_element()).filter(|extent_m| *extent_m > 0.0).unwrap_or(1.0);
    let pixel_m = (camera.mean_pitch() * (camera.centre_m() - 0.5 * (low_m + high_m)).length())
        .clamp(extent_m / 2000.0, extent_m / 10.0);
    let step = 10f64.powf(pixel_m.log10().floor() - 1.0);
    // Division by a power of ten is exact to the digit that multiplication is not.
    if step < 1.0 { (pixel_m / step).round() / (1.0 / step).round() } else { (pixel_m / step).round() * step.round() }
}

/// A camera's line of sight and turn, deg; straight down if it is that within a tenth of a pixel.
pub(super) fn camera_deg(dart_from_sensor: DMat3, pitch: f64) -> ([f64; 2], f64) {
    frame::camera_deg(dart_from_sensor, 0.1 * pitch)
}

/// A scene and its place in DART's frame.
struct Site<'a> {
    scene: &'a Scene,
    dart_from_body: DMat3,
    origin_in_dart_m: DVec3,
}

impl Site<'_> {
    /// The object of the OBJ file with this number, from 0.
    fn object(&self, number: usize, groups: &[ObjectGroup], target: TargetVersion, links: &[Links]) -> Object {
        let name = if number == 0 { SURFACE.into() } else { format!("{SURFACE}_{}", number + 1) };
        let group = |(i, ObjectGroup { name, front, back }): (usize, &ObjectGroup)| Group {
            number: index_u32(i) + 1,
            name: name.clone(),
            hidden: false,
            double_face: back.is_some(),
            links: Some(links[*front].clone()),
            back: back.map(|back| links[back].clone()),
            at: Location::item("mesh"),
        };
        let mut groups: Vec<Group> = groups.iter().enumerate().map(group).collect();
        // Of an OBJ with one group 5.7 wants no list; what 5.11 wants is known with a list only.
        let whole = if target == TargetVersion::V5_7_4 && groups.len() == 1 { groups.pop() } else { None };
        let double_face = whole.as_ref().is_some_and(|whole| whole.double_face);
        let (links, back) = whole.map_or((None, None), |whole| (whole.links, whole.back));
        Object {
            file: format!("obj/{name}.obj"),
            name,
            position_m: self.origin_in_dart_m,
            scale: DVec3::ONE,
            rotation_deg: DVec3::ZERO,
            dem_mode: 2,
            hidden: false,
            repeated_on_border: false,
            double_face,
            links,
            back,
            groups,
            at: Location::item("mesh"),
        }
    }

    fn camera(&self) -> Pinhole {
        let camera = &self.scene.exposure.camera;
        let (look_deg, roll_deg) = camera_deg(self.dart_from_body * camera.world_from_sensor.rotation, camera.pitch[0]);
        let angle_deg = |pixels: u32, pitch: f64| FrameCamera::angle_of_pitch(pitch, pixels).to_degrees();
        Pinhole {
            position_m: self.dart_from_body * camera.centre_m() + self.origin_in_dart_m,
            look_deg,
            roll_deg,
            field_of_view_deg: [angle_deg(camera.samples, camera.pitch[0]), angle_deg(camera.lines, camera.pitch[1])],
            pixels: [camera.samples, camera.lines],
            at: Location::item("sensor"),
        }
    }

    /// Share of the facets that have light of Mars above their own horizon.
    fn under_mars(&self, mars: &Globe) -> f64 {
        let (mesh, to_sun) = (&self.scene.body.mesh, self.scene.sky.sun.direction.vec());
        let Some(towards) = Direction::new(mars.centre_m).map(Direction::vec) else { return 0.0 };
        if on_facet_from_mars(mars, self.scene.models.mars_light, towards, to_sun) <= 0.0 || mesh.facets.is_empty() {
            return 0.0;
        }
        let sees =
            |f: &usize| mesh.facet(*f).normal().dot(towards) > -(mars.radius_m / mars.centre_m.length()).min(1.0);
        (0..mesh.facets.len()).filter(sees).count() as f64 / mesh.facets.len() as f64
    }

    /// What a beam from Mars' centre sends to level ground, against all of Mars: in words.
    fn beam_on_level_ground(&self, mars: &Globe) -> String {
        let (towards, up) = (Direction::new(mars.centre_m), Direction::new(self.scene.body.origin_m));
        let (Some(towards), Some(up)) = (towards.map(Direction::vec), up.map(Direction::vec)) else {
            return "another one".into();
        };
        let (model, to_sun) = (self.scene.models.mars_light, self.scene.sky.sun.direction.vec());
        let on_facet = |normal| on_facet_from_mars(mars, model, normal, to_sun);
        let off = on_facet(towards) * towards.dot(up).max(0.0) / on_facet(up) - 1.0;
        if off.is_finite() { format!("{:.1} % off", 100.0 * off.abs()) } else { "another one".into() }
    }

    /// The simulation with Mars in the Sun's place.
    fn by_mars(&self, simulation: &Simulation, report: &mut Report) -> Option<Simulation> {
        let mars = self.scene.sky.mars.as_ref()?;
        let by_mars = lit_by_mars(self.scene, self.dart_from_body, simulation);
        let (fate, message): (Fate, String) = match by_mars {
            None => match self.under_mars(mars) {
                0.0 => (Fate::Carried, "Mars sends no light to the scene: no simulation has any".into()),
                share => (
                    Fate::Dropped,
                    format!(
                        "Mars' centre is below the site's horizon, where DART has no source, but {:.0} % of the facets see some of it: no \
                         simulation has that light",
                        100.0 * share
                    ),
                ),
            },
            Some(_) => (
                Fate::Approximated,
                format!(
                    "Mars is {:.1} deg in radius; DART has one source, a parallel one: the simulation in `mars` has Mars' light as a beam from \
                     its centre, right on a facet that faces it, {} on level ground; its radiances are to be added to the Sun's",
                    (mars.radius_m / mars.centre_m.length()).asin().to_degrees(),
                    self.beam_on_level_ground(mars)
                ),
            ),
        };
        report.note(fate, Location::item("mars"), message);
        by_mars
    }

    /// What became of lights and shadows that DART has not; mmxrt.toml keeps all of them for the way back.
    fn sky_notes(&self, report: &mut Report) {
        let (scene, sky) = (self.scene, &self.scene.sky);
        let mut note = |fate, item: String, message: String| report.note(fate, Location::item(item), message);
        for beam in &sky.beams {
            let message = "a second beam: a simulation of DART has the Sun alone; kept for the way back";
            note(Fate::Dropped, format!("beams.{:?}", beam.name), message.into());
        }
        for body in &sky.bodies {
            let message = "light and heat of a further body are in no simulation; kept for the way back";
            note(Fate::Dropped, format!("bodies.{:?}", body.name), message.into());
        }
        for (globe, _) in scene.globes_in_view() {
            let message = "is in view, and DART's images show the sky there";
            let item = if globe.name == Sky::MARS { Sky::MARS.to_owned() } else { format!("bodies.{:?}", globe.name) };
            note(Fate::Dropped, item, message.into());
        }
        if sky.mars.is_some() && scene.models.mars_heat {
            note(
                Fate::Dropped,
                "mars.heat".into(),
                "its heat as light is in no simulation; kept for the way back".into(),
            );
        }
        if scene.models.eclipses {
            let share = |(centre_m, radius_m): (DVec3, f64)| {
                let (towards, sin_radius) = (sky.sun.direction.vec(), sky.sun.sin_radius());
                share_beside_sphere(towards, sin_radius, sky.sun.limb_darkening, centre_m, radius_m)
            };
            let left: f64 = sky.spheres().map(share).product();
            let (fate, message) = match left < 1.0 {
                true => (
                    Fate::Approximated,
                    format!("bodies leave {:.1} % of the Sun, of which DART has all", 100.0 * left),
                ),
                false => (Fate::Carried, "bodies may hide the Sun: here they do not".to_owned()),
            };
            note(fate, "sun".into(), message);
        }
        if let SunModel::Disc(rule) = scene.models.sun {
            let message = format!(
                "{} points of its disc, {:.2} deg in radius: DART has a parallel beam, shadows have no penumbrae",
                rule.count(),
                sky.sun.sin_radius().asin().to_degrees()
            );
            note(Fate::Approximated, "sun.points".into(), message);
        }
        if let Some(steps) = scene.models.conduction {
            let message = format!(
                "heat is conducted in {steps} steps of a day; DART's temperatures are spread between two ends, which are those of equilibrium"
            );
            note(Fate::Approximated, "thermal.model".into(), message);
        }
        if scene.models.floor_k > 0.0 {
            let message = format!("no part of a facet is colder than {} K; DART knows no floor", scene.models.floor_k);
            note(Fate::Approximated, "thermal.floor_k".into(), message);
        }
        if sky.rotation.is_some() {
            note(Fate::Carried, "thermal.period_s".into(), "length and axis of the day: DART knows no time".into());
        }
        if scene.body.materials.iter().any(|material| material.thermal_inertia != 0.0) {
            note(Fate::Carried, "thermal.inertia".into(), "DART stores no heat".into());
        }
    }

    /// What became of meshes that stand in several places.
    fn field_notes(&self, simulation: &Simulation, split: &fields::Split, report: &mut Report) {
        let mut note = |fate, message: String| report.note(fate, Location::item("mesh.instances"), message);
        let places = || simulation.fields.iter().flat_map(|field| &field.places);
        let fields = simulation.fields.len();
        if fields > 0 {
            note(Fate::Carried, format!("{} instances are in {fields} object fields", places().count()));
        }
        if places().any(|place| place.rotation_deg.y != 0.0) {
            let message = "instances are turned about more than the vertical: the order of DART's rotations is inferred, not documented";
            note(Fate::Approximated, message.into());
        }
        for (count, why) in [(split.sheared, "are sheared"), (split.outside, "have their origin outside of the scene")]
        {
            if count > 0 {
                note(Fate::Carried, format!("{count} instances {why}: they are part of the surface"));
            }
        }
    }

    /// What became of what DART has no exact counterpart for.
    /// `faces`: runs of faces that are read back, if they are.
    fn notes(
        &self,
        simulation: &Simulation,
        size: &Size,
        options: &SimulationOptions,
        faces: Option<&[(u32, u32)]>,
        report: &mut Report,
    ) {
        let scene = self.scene;
        let item = Location::item;
        let camera = &scene.exposure.camera;
        let middle_px = [camera.samples, camera.lines].map(|n| 0.5 * f64::from(n));
        if camera.boresight_px != middle_px {
            report.note(
                Fate::Dropped,
                item("sensor"),
                format!(
                    "the boresight at sample and line {:?}: DART's camera looks through the middle of its image, {middle_px:?}",
                    camera.boresight_px
                ),
            );
        }
        if camera.lens.is_some() {
            let message = "what the lens does to the image: DART's camera is a pinhole";
            report.note(Fate::Dropped, item("sensor.distortion"), message.to_owned());
        }
        self.sky_notes(report);
        report.note(
            Fate::Carried,
            item("origin_m"),
            "DART's frame starts at the scene's corner; x is South, y East, z outward",
        );
        report.note(
            Fate::Carried,
            item("sun"),
            format!(
                "distance and spectrum: DART has irradiances at the body, one for each of {} bands",
                scene.exposure.bands.len()
            ),
        );
        if frame::sun_deg(scene.body.origin_m, scene.sky.sun.direction).is_none() {
            let towards = self.dart_from_body * scene.sky.sun.direction.vec();
            let message = format!(
                "the Sun stands {:.3} deg below the site's horizon, where DART has none: irradiance 0",
                frame::angles_deg(towards)[0] - 90.0
            );
            report.note(Fate::Approximated, item("sun"), message);
        }
        if scene.models.thermal != Thermal::Off {
            let message =
                "DART spreads temperatures by sunlight between two ends, which are those of this scene's model";
            report.note(Fate::Carried, item("thermal"), message);
        }
        report.note(
            Fate::Carried,
            item("materials"),
            "Bond albedo, bolometric emissivity and mixtures; DART's emissivity is 1 - reflectance",
        );
        for (material, key) in scene
            .body
            .materials
            .iter()
            .filter(|m| matches!(m.photometry, Photometry::Model(_) | Photometry::Table(_)))
            .filter_map(|m| Some((m, m.photometry.key()?)))
        {
            let at = Location::item(format!("materials.{:?}.{key}", material.name));
            report.note(Fate::Approximated, at, "a Lambert surface of the same hemispherical reflectance");
        }
        for (material, function) in scene.body.materials.iter().zip(&simulation.thermal) {
            let off = emissivity_off(scene, material, &simulation.phase.bands);
            if off > 1e-12 && function.mean_k > 0.0 {
                let message = format!("in DART it is 1 - reflectance: up to {off:.4} off in the bands with heat");
                report.note(
                    Fate::Approximated,
                    Location::item(format!("materials.{:?}.emissivity", material.name)),
                    message,
                );
            }
        }
        let bands = &scene.exposure.bands;
        let monochromatic = bands.iter().filter(|b| b.fwhm_um.is_none()).count();
        for (is_table, message) in [
            (false, "Gaussian responses, or squared sincs; DART's are rectangles of the same width"),
            (true, "tabulated responses; DART's are rectangles of the same centre and equivalent width"),
        ] {
            let is_one = |band: &&Band| match band.response {
                Response::Gaussian | Response::Sinc2 => !is_table && band.fwhm_um.is_some(),
                Response::Table(_) => is_table,
                Response::Box => false,
            };
            if bands.iter().any(|band| is_one(&band)) {
                let lit = bands.iter().filter(|band| is_one(band) && band.light.is_lit());
                let off = lit.map(|band| rectangle_off(scene, band)).fold(0.0, f64::max);
                let fate = if off > SAME { Fate::Approximated } else { Fate::Carried };
                report.note(fate, item("sensor.bands"), format!("{message}: what is reflected is up to {off:.1e} off"));
            }
        }
        if monochromatic > 0 {
            let message = format!("{monochromatic} monochromatic bands are {MONOCHROMATIC_UM} um wide in DART");
            report.note(Fate::Defaulted, item("sensor.bands"), message);
        }
        if simulation.phase.cameras.iter().any(|c| c.roll_deg != 0.0) {
            let message = format!(
                "roll unverified: the camera is turned by {} deg about its line of sight, clockwise as it looks; DART does not \
                 document the sign. Compare an image before you trust it",
                simulation.phase.cameras[0].roll_deg
            );
            report.note(Fate::Defaulted, item("observer"), message);
        }
        let ahead = self.dart_from_body * scene.exposure.camera.world_from_sensor.rotation.z_axis;
        let tilt_rad = crate::geometry::angle_rad(ahead, DVec3::NEG_Z);
        if simulation.phase.cameras.iter().any(|c| c.look_deg[0] == 180.0) && tilt_rad > 0.0 {
            let message = format!(
                "the camera looks straight down but for {tilt_rad:.1e} rad, less than a tenth of a pixel: straight down"
            );
            report.note(Fate::Carried, item("observer"), message);
        }
        let files = simulation.objects.len();
        if files > 1 {
            let message = format!("{files} OBJ files: the groups of one are told apart up to {GROUPS} materials");
            report.note(Fate::Carried, item("mesh"), message);
        }
        match faces {
            _ if scene.body.mesh.face_of_facet.is_empty() => {}
            Some(_) if files == 1 => report.note(Fate::Carried, item("mesh"), "which face each triangle was cut from"),
            _ => report.note(
                Fate::Dropped,
                item("mesh"),
                "which face each triangle was cut from: their order is not the triangles'",
            ),
        }
        let ground = match options.target {
            TargetVersion::V5_7_4 => {
                "DART has a ground plane at z = 0: it is black and at 0 K, below all of the surface"
            }
            TargetVersion::V5_11_0 => "DART's ground plane is switched off",
        };
        report.note(Fate::Defaulted, item("ground"), ground);
        let [x, y, z] = size.cells;
        let gib = |bytes: u64| bytes as f64 / (1u64 << 30) as f64;
        let mut message = format!(
            "{} triangles, {x} x {y} x {z} cells of {} m: DART may need {:.1} GiB (64 B a cell, 256 B a triangle and 80 B for each \
             of its bands, 8 B for each band of a pixel; a formula that is inferred, not known)",
            size.facets,
            simulation.maket.cell_m[0],
            gib(size.bytes)
        );
        if size.bytes > options.memory_bytes {
            message.push_str(&match coarser(simulation, size, options.memory_bytes) {
                Some(cell_m) => {
                    format!(", more than {:.1} GiB: cells of {cell_m} m would fit", gib(options.memory_bytes))
                }
                None => format!(
                    ", more than {:.1} GiB whatever the cells: convert fewer bands or facets at a time",
                    gib(options.memory_bytes)
                ),
            });
        }
        report.note(Fate::Defaulted, item("size"), message);
    }
}

/// The least power of two times the cell size that fits, m.
fn coarser(simulation: &Simulation, size: &Size, memory_bytes: u64) -> Option<f64> {
    let mut simulation = simulation.clone();
    let height_m = size.cells[2] as f64 * simulation.maket.cell_m[1];
    loop {
        simulation.maket.cell_m = simulation.maket.cell_m.map(|c| 2.0 * c);
        let coarser = Size::of(&simulation, size.facets, height_m);
        if coarser.bytes <= memory_bytes {
            return Some(simulation.maket.cell_m[0]);
        }
        if coarser.cells == [1; 3] {
            return None;
        }
    }
}
