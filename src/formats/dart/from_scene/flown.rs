//! The exposures of a scene that moves, as a sequence: simulations that differ in the Sun, the camera and irradiances.
//!
//! What differs is found by writing the inputs of each exposure and looking which attributes change, so that nothing is said twice.

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::formats::xml::Element;
use crate::report::{Fate, Report};
use crate::scene::{Motion, Readout, Scene, Setup, Thermal, Timing};

use super::super::frame;
use super::super::inputs::of_a_moment;
use super::super::read::sequence::count;
use super::super::simulation::{Sequence, SequenceEntry, SequenceGroup, SequenceValues, Simulation};
use super::optics::sunlight;
use super::{Package, SAME, Site, lit_by_mars};

/// The sequence's name, and its file's.
const NAME: &str = "flight";
/// Of more exposures nobody makes simulations.
const MOST: usize = 10_000;
/// Elements of which there may be many: their places are numbers, even of a single one.
const LISTED: [[&str; 2]; 4] = [
    ["SensorImageSimulation", "Pinhole"],
    ["SensorImageSimulation", "Sensor"],
    ["Directions", "AddedDirections"],
    ["SpectralIrradiance", "SpectralIrradianceValue"],
];

/// Adds to the simulation of a scene that moves, and to that by Mars, a sequence of one simulation for each of its exposures.
///
/// # Errors
/// [`Error::Invalid`] if where something is, is not known at one of them; [`Error::Unsupported`] as [`inputs`](super::super::inputs()).
pub fn add_flight(
    package: &mut Package,
    scene: &Scene,
    (motion, timing): (&Motion, &Timing),
    report: &mut Report,
) -> Result<()> {
    let mut note = |fate, message: String| report.note(fate, Location::item("flight"), message);
    let exposures = timing.count(&scene.exposure);
    let when = motion.start.after_s(timing.middle_s(timing.reference(&scene.exposure)));
    if exposures < 2 {
        note(Fate::Carried, format!("the simulation is that of the only exposure, {when}"));
        return Ok(());
    }
    if exposures > MOST {
        let message = format!("{exposures} exposures, more than {MOST}: the simulation is that of {when} alone");
        note(Fate::Dropped, message);
        return Ok(());
    }
    let dart_from_body = frame::dart_from_body(scene.body.origin_m);
    let origin_in_dart_m = package.simulation.objects.first().map_or(DVec3::ZERO, |object| object.position_m);
    let base = &package.simulation;
    let middle_m = 0.5 * DVec3::from_array(package.size.cells.map(|count| count as f64)) * base.maket.cell_m[0];
    let mut by_sun = Varied::of(base)?;
    let mut by_mars = package.mars.as_ref().map(Varied::of).transpose()?;
    let mut unlit_by_mars = 0;
    for take in timing.takes(&scene.exposure) {
        let epoch = motion.start.after_s(take.middle_s);
        let mut exposure = scene.exposure.clone();
        exposure.camera = take.exposure(&scene.exposure).camera;
        exposure.camera.world_from_sensor = take.pose(motion.pose(epoch)?, take.middle_s);
        let sky = motion.sky(&scene.sky, epoch)?;
        let then = Scene::new(Setup { body: scene.body.clone(), sky, exposure, models: scene.models })?;
        let site = Site { scene: &then, dart_from_body, origin_in_dart_m };
        let mut simulation = base.clone();
        let camera = site.camera();
        let towards_camera = camera.position_m - middle_m;
        if let Some(view_deg) = simulation.directions.views_deg.first_mut().filter(|_| towards_camera.z > 0.0) {
            *view_deg = frame::angles_deg(towards_camera);
        }
        simulation.phase.cameras = vec![camera];
        if let Some(sun_deg) = frame::sun_deg(scene.body.origin_m, then.sky.sun.direction) {
            simulation.directions.sun_deg = sun_deg;
        }
        simulation.phase.irradiance = sunlight(&then).into_iter().map(|e| Some((e, 0.0))).collect();
        let lit = lit_by_mars(&then, dart_from_body, &simulation);
        hold(&base.phase.irradiance, &mut simulation.phase.irradiance);
        by_sun.add(&simulation)?;
        match (&mut by_mars, &package.mars, lit) {
            (Some(varied), Some(base), Some(mut lit)) => {
                hold(&base.phase.irradiance, &mut lit.phase.irradiance);
                varied.add(&lit)?;
            }
            (Some(varied), Some(base), None) => {
                let mut dark = Simulation { directions: base.directions.clone(), ..simulation };
                dark.phase.irradiance = base.phase.irradiance.iter().map(|e| e.map(|_| (0.0, 0.0))).collect();
                dark.phase.bands.clone_from(&base.phase.bands);
                varied.add(&dark)?;
            }
            (_, _, lit) => unlit_by_mars += usize::from(lit.is_some()),
        }
    }
    if unlit_by_mars > 0 {
        let message = format!(
            "Mars lights {unlit_by_mars} of {exposures} exposures, but not the middle one: no simulation has its light"
        );
        note(Fate::Dropped, message);
    }
    let Some(sequence) = by_sun.sequence() else {
        note(Fate::Carried, format!("{exposures} exposures see the same: one simulation serves all of them"));
        return Ok(());
    };
    if let Err(error) = count(&sequence) {
        let why = match error {
            Error::Invalid(problems) => problems.iter().map(|p| p.message.clone()).collect::<Vec<_>>().join("; "),
            other => other.to_string(),
        };
        note(
            Fate::Dropped,
            format!("{exposures} exposures: their sequence {why}; the simulation is that of {when} alone"),
        );
        return Ok(());
    }
    let of_what = match timing.readout {
        Readout::Band => "the simulation of each has all bands, of which one is exposed then",
        Readout::Line => "the images of each are a line",
        Readout::Sample(_) => "the images of each are a column",
        Readout::Frame => "the images of each are a frame",
    };
    note(
        Fate::Carried,
        format!(
            "{exposures} exposures are the sequence `{NAME}.xml`, with the Sun, camera and (where they change by more than {SAME}) irradiances of \
             each; {of_what}; the simulation itself is that of {when}"
        ),
    );
    if scene.models.thermal != Thermal::Off {
        note(
            Fate::Approximated,
            format!("ends of temperatures are those of {when}, in all simulations of the sequence"),
        );
    }
    if timing.exposure_s > 0.0 {
        note(
            Fate::Dropped,
            format!("motion within each exposure of {} s: DART looks from one place", timing.exposure_s),
        );
    }
    package.simulation.sequences = vec![sequence];
    if let (Some(mars), Some(sequence)) = (&mut package.mars, by_mars.and_then(Varied::sequence)) {
        mars.sequences = vec![sequence];
    }
    Ok(())
}

/// Irradiances that are next to those of the simulation itself are those.
fn hold(base: &[Option<(f64, f64)>], then: &mut [Option<(f64, f64)>]) {
    for (base, then) in base.iter().zip(then) {
        if let (Some((kept, _)), Some((e, _))) = (base, &mut *then)
            && (*e - kept).abs() <= SAME * kept.abs()
        {
            *then = *base;
        }
    }
}

/// The attributes of inputs that change from simulation to simulation.
struct Varied {
    /// Dotted path and value of each attribute of the simulation itself.
    base: Vec<(String, String)>,
    /// Of each that has had another value: all values so far.
    values: Vec<Option<Vec<String>>>,
    simulations: usize,
}

impl Varied {
    fn of(simulation: &Simulation) -> Result<Self> {
        let base = attributes(simulation)?;
        Ok(Varied { values: vec![None; base.len()], base, simulations: 0 })
    }

    fn add(&mut self, simulation: &Simulation) -> Result<()> {
        // One writer makes the same attributes of as many bands, cameras and views.
        for (((_, kept), values), (_, value)) in self.base.iter().zip(&mut self.values).zip(attributes(simulation)?) {
            match values {
                Some(values) => values.push(value),
                None if value == *kept => {}
                None => {
                    let mut all = vec![kept.clone(); self.simulations];
                    all.push(value);
                    *values = Some(all);
                }
            }
        }
        self.simulations += 1;
        Ok(())
    }

    fn sequence(self) -> Option<Sequence> {
        let at = Location::item("flight");
        let entry = |((property, _), values): ((String, String), Option<Vec<String>>)| {
            Some(SequenceEntry { property, values: SequenceValues::Enumerated(values?), at: at.clone() })
        };
        let entries: Vec<SequenceEntry> = self.base.into_iter().zip(self.values).filter_map(entry).collect();
        let groups = vec![SequenceGroup { name: "exposures".into(), entries }];
        (!groups[0].entries.is_empty()).then(|| Sequence { name: NAME.into(), groups, at: Location::item("flight") })
    }
}

/// Each attribute of what depends on the moment: dotted path and value.
fn attributes(simulation: &Simulation) -> Result<Vec<(String, String)>> {
    let mut all = Vec::new();
    for root in of_a_moment(simulation)? {
        add_attributes(&root, &root.name, &mut all);
    }
    Ok(all)
}

fn add_attributes(element: &Element, path: &str, all: &mut Vec<(String, String)>) {
    all.extend(element.attributes.iter().map(|a| (format!("{path}.{}", a.name), a.value.clone())));
    for (i, child) in element.children.iter().enumerate() {
        let before = element.children[..i].iter().filter(|other| other.name == child.name).count();
        let is_listed = LISTED.contains(&[element.name.as_str(), child.name.as_str()]);
        let place = if is_listed || before > 0 { format!("[{before}]") } else { String::new() };
        add_attributes(child, &format!("{path}.{}{place}", child.name), all);
    }
}
