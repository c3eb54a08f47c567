//! What two simulations differ in, by meaning: not by text, order of attributes, names that DART ignores, or how a link is numbered.
//!
//! Every struct is taken apart with all its fields named: one that is new does not compile before it is compared here.

use std::fmt::Debug;
use std::path::Path;

use glam::DVec3;

use crate::error::Result;
use crate::geometry::angle_rad;
use crate::report::Fate;

use super::frame;
use super::read::unread::{self, ROUNDING};
use super::read::{self, Inputs, ReadOptions};
use super::simulation::{
    CellTemperatures, Directions, FieldInstance, Group, Links, Maket, Object, ObjectField, OpticalProperty, Phase,
    Pinhole, Sequence, SequenceEntry, SequenceGroup, Simulation, SpectralInterval, ThermalFunction, Topography,
    Version,
};

/// At most this many attributes that are not read, and differences of a field's places, are listed one by one.
const TOLD: usize = 10;

/// How the inputs of two simulations differ, one line each: as [`diff`], then ignored content that differs, and the
/// same for those in `mars/`, which are lit by Mars.
///
/// # Errors
/// As [`read::read`].
pub fn differences(a: &Path, b: &Path, options: &ReadOptions) -> Result<Vec<String>> {
    let mut lines = of_inputs(a, b, options)?;
    let [mars_a, mars_b] = [a, b].map(|path| options.folder(path).simulation.join("mars"));
    let is_there = |mars: &Path| options.folder(mars).input.join("maket.xml").is_file();
    match (is_there(&mars_a), is_there(&mars_b)) {
        (true, true) => {
            lines.extend(of_inputs(&mars_a, &mars_b, options)?.into_iter().map(|line| format!("mars/ {line}")));
        }
        (false, false) => {}
        (true, false) => lines.push("mars/: is there | is not".into()),
        (false, true) => lines.push("mars/: is not | is there".into()),
    }
    Ok(lines)
}

fn of_inputs(a: &Path, b: &Path, options: &ReadOptions) -> Result<Vec<String>> {
    let ((of_a, report_a, _), (of_b, report_b, _)) = (read::read(a, options)?, read::read(b, options)?);
    let mut lines = diff(&of_a, &of_b);
    let told = |report: crate::report::Report| -> Vec<String> {
        let is_loss = |fate: Fate| matches!(fate, Fate::Dropped | Fate::Approximated);
        report.notes.into_iter().filter(|note| is_loss(note.fate)).map(|note| note.message).collect()
    };
    let (told_a, told_b) = (told(report_a), told(report_b));
    let only = |told: &[String], other: &[String], which: &str| -> Vec<String> {
        let new = told.iter().filter(|message| !other.contains(message));
        new.map(|message| format!("in the {which} alone: {message}")).collect()
    };
    lines.extend(only(&told_a, &told_b, "first"));
    lines.extend(only(&told_b, &told_a, "second"));
    // Versions differ in what they have.
    if of_a.version == of_b.version {
        let inputs = |path: &Path| Inputs::read(&options.folder(path));
        let mut others = unread::differences((&inputs(a)?, &of_a), (&inputs(b)?, &of_b));
        let more = others.len().saturating_sub(TOLD);
        others.truncate(TOLD);
        lines.extend(others);
        if more > 0 {
            lines.push(format!("and {more} more attributes"));
        }
    }
    Ok(lines)
}

/// One line for each difference: where, and both values. Numbers differ if rounding does not explain it. Empty: the same in meaning.
///
/// Not compared: idents, names of objects and groups, places of optical properties in their lists (links are followed), and what
/// nothing is linked to.
pub fn diff(a: &Simulation, b: &Simulation) -> Vec<String> {
    let mut lines = Lines(Vec::new());
    // Optical properties and temperatures are compared where links lead to them.
    let Simulation { version, maket, optical: _, thermal: _, objects, fields, phase, directions, sequences } = a;
    let text = |Version { version, build }: &Version| format!("{version} {build}");
    if *version != b.version {
        lines.push("version", &text(version), &text(&b.version));
    }
    lines.maket((a, maket), (b, &b.maket));
    lines.each("object_3d.xml Object", objects, &b.objects, |lines, at, x, y| lines.object(at, (a, x), (b, y)));
    lines.each("object_3d.xml Field", fields, &b.fields, |lines, at, x, y| {
        // What its text holds are its places.
        let ObjectField { name: _, file: _, models, places, at: _ } = x;
        lines.each(&format!("{at} Object"), models, &y.models, |lines, at, x, y| lines.object(at, (a, x), (b, y)));
        let before = lines.0.len();
        lines.each(&format!("{at} place"), places, &y.places, Lines::placement);
        let more = (lines.0.len() - before).saturating_sub(TOLD);
        if more > 0 {
            lines.0.truncate(before + TOLD);
            lines.0.push(format!("{at}: and {more} more differences of places"));
        }
    });
    lines.phase(phase, &b.phase);
    let Directions { sun_deg, views_deg, at: _ } = directions;
    lines.directions("directions.xml Sun, zenith angle and azimuth, deg", sun_deg, &b.directions.sun_deg);
    lines.each("directions.xml AddedDirections", views_deg, &b.directions.views_deg, |lines, at, x, y| {
        lines.directions(&format!("{at} zenith angle and azimuth, deg"), x, y);
    });
    lines.each("sequence", sequences, &b.sequences, |lines, at, x, y| {
        let Sequence { name: _, groups, at: _ } = x;
        lines.each(&format!("{at} group"), groups, &y.groups, |lines, at, x, y| {
            let SequenceGroup { name: _, entries } = x;
            lines.each(&format!("{at} entry"), entries, &y.entries, |lines, at, x, y| {
                let SequenceEntry { property, values, at: _ } = x;
                lines.differ(&format!("{at} propertyName"), property, &y.property);
                lines.differ(&format!("{at} args"), values, &y.values);
            });
        });
    });
    lines.0
}

struct Lines(Vec<String>);

impl Lines {
    fn push(&mut self, at: &str, a: &str, b: &str) {
        self.0.push(format!("{at}: {a} | {b}"));
    }

    fn differ<T: PartialEq + Debug>(&mut self, at: &str, a: &T, b: &T) {
        if a != b {
            self.push(at, &format!("{a:?}"), &format!("{b:?}"));
        }
    }

    /// `scale`: differences that are small compared with it are ignored.
    fn numbers(&mut self, at: &str, a: &[f64], b: &[f64], scale: f64) {
        let same = |(x, y): (&f64, &f64)| x == y || (x - y).abs() <= ROUNDING * x.abs().max(y.abs()).max(scale);
        if a.len() != b.len() || !a.iter().zip(b).all(same) {
            self.push(at, &format!("{a:?}"), &format!("{b:?}"));
        }
    }

    /// Zenith angles and azimuths: near the zenith an azimuth says little.
    fn directions(&mut self, at: &str, a_deg: &[f64; 2], b_deg: &[f64; 2]) {
        if angle_rad(frame::vector(*a_deg), frame::vector(*b_deg)) > ROUNDING {
            self.push(at, &format!("{a_deg:?}"), &format!("{b_deg:?}"));
        }
    }

    fn vectors(&mut self, at: &str, a: DVec3, b: DVec3) {
        self.numbers(at, &a.to_array(), &b.to_array(), 1.0);
    }

    /// Two lists, entry by entry; how many there are if that differs.
    fn each<T>(&mut self, at: &str, a: &[T], b: &[T], compare: impl Fn(&mut Self, &str, &T, &T)) {
        if a.len() != b.len() {
            self.push(&format!("{at}, number of them"), &a.len().to_string(), &b.len().to_string());
        }
        for (i, (x, y)) in a.iter().zip(b).enumerate() {
            compare(self, &format!("{at}[{i}]"), x, y);
        }
    }

    fn maket(&mut self, (of_a, a): (&Simulation, &Maket), (of_b, b): (&Simulation, &Maket)) {
        let Maket { size_m, cell_m, boundary, ground, ground_enabled, topography, latitude_longitude_altitude, at: _ } =
            a;
        self.numbers("maket.xml Scene/SceneDimensions, m", size_m, &b.size_m, 1.0);
        self.numbers("maket.xml Scene/CellDimensions, m", cell_m, &b.cell_m, 0.0);
        self.differ("maket.xml Maket/@exactlyPeriodicScene", boundary, &b.boundary);
        self.differ("maket.xml Soil/@groundEnabled", ground_enabled, &b.ground_enabled);
        if *ground_enabled && b.ground_enabled {
            self.links("maket.xml Soil", (of_a, Some(ground)), (of_b, Some(&b.ground)));
        }
        let raster = |topography: &Option<Topography>| {
            topography.as_ref().map(|Topography { file, generated, at: _ }| match generated {
                true => format!("{file}, which DART makes"),
                false => file.clone(),
            })
        };
        self.differ("maket.xml Soil/Topography", &raster(topography), &raster(&b.topography));
        let (place_a, place_b) = (latitude_longitude_altitude, &b.latitude_longitude_altitude);
        self.numbers("maket.xml LatLon", place_a, place_b, 1.0);
    }

    fn phase(&mut self, a: &Phase, b: &Phase) {
        let Phase { bands, irradiance_mode, irradiance, temperature_mode, cells, radiance_products, cameras } = a;
        self.each("phase.xml SpectralIntervalsProperties", bands, &b.bands, |lines, at, x, y| {
            let SpectralInterval { mean_um, width_um, mode, at: _ } = x;
            lines.numbers(&format!("{at} meanLambda, um"), &[*mean_um], &[y.mean_um], 0.0);
            lines.numbers(&format!("{at} deltaLambda, um"), &[*width_um], &[y.width_um], 0.0);
            lines.differ(&format!("{at} spectralDartMode"), mode, &y.mode);
        });
        self.differ("phase.xml nodeIlluminationMode/@irradianceMode", irradiance_mode, &b.irradiance_mode);
        if *irradiance_mode == 1 && b.irradiance_mode == 1 {
            self.each("phase.xml SpectralIrradianceValue", irradiance, &b.irradiance, |lines, at, x, y| match (x, y) {
                (Some((irradiance, diffuse)), Some(y)) => {
                    lines.numbers(&format!("{at} irradiance, W m-2 um-1"), &[*irradiance], &[y.0], 0.0);
                    lines.numbers(&format!("{at} Skyl"), &[*diffuse], &[y.1], 0.0);
                }
                (x, y) => lines.differ(at, x, y),
            });
        }
        self.differ("phase.xml SpectralDomainTir/@temperatureMode", temperature_mode, &b.temperature_mode);
        self.cells(cells.as_ref(), b.cells.as_ref());
        let (products_a, products_b) = (radiance_products, &b.radiance_products);
        self.differ("phase.xml BrfProductsProperties/@luminanceProducts", products_a, products_b);
        self.each("phase.xml camera", cameras, &b.cameras, Lines::camera);
    }

    fn cells(&mut self, a: Option<&CellTemperatures>, b: Option<&CellTemperatures>) {
        let at = "phase.xml TemperatureFile";
        let count = |cells: Option<&CellTemperatures>| {
            // Its name says nothing.
            let CellTemperatures { file: _, count, values_k: _, at: _ } = cells?;
            Some(*count)
        };
        self.differ(&format!("{at}, cells"), &count(a), &count(b));
        let pairs = a.zip(b).filter(|(a, b)| a.count == b.count).into_iter();
        let pairs: Vec<_> =
            pairs.flat_map(|(a, b)| a.values_k.iter().zip(&b.values_k)).filter(|(a, b)| a != b).collect();
        if let Some((a, b)) = pairs.first() {
            self.push(&format!("{at}, {} temperatures, the first, K", pairs.len()), &a.to_string(), &b.to_string());
        }
    }

    fn object(&mut self, at: &str, (of_a, a): (&Simulation, &Object), (of_b, b): (&Simulation, &Object)) {
        let Object {
            name: _,
            file,
            position_m,
            scale,
            rotation_deg,
            dem_mode,
            hidden,
            repeated_on_border,
            double_face,
            links,
            back,
            groups,
            at: _,
        } = a;
        self.differ(&format!("{at} file_src"), file, &b.file);
        self.vectors(&format!("{at} position, m"), *position_m, b.position_m);
        self.vectors(&format!("{at} scale"), *scale, b.scale);
        self.vectors(&format!("{at} rotation, deg"), *rotation_deg, b.rotation_deg);
        self.differ(&format!("{at} objectDEMMode"), dem_mode, &b.dem_mode);
        self.differ(&format!("{at} hidden"), hidden, &b.hidden);
        self.differ(&format!("{at} repeatedOnBorder"), repeated_on_border, &b.repeated_on_border);
        self.differ(&format!("{at} doubleFace"), double_face, &b.double_face);
        self.links(at, (of_a, links.as_ref()), (of_b, b.links.as_ref()));
        self.links(&format!("{at} back"), (of_a, back.as_ref()), (of_b, b.back.as_ref()));
        self.each(&format!("{at} Group"), groups, &b.groups, |lines, at, x, y| {
            let Group { number, name: _, hidden, double_face, links, back, at: _ } = x;
            lines.differ(&format!("{at} num"), number, &y.number);
            lines.differ(&format!("{at} hidden"), hidden, &y.hidden);
            lines.differ(&format!("{at} doubleFace"), double_face, &y.double_face);
            lines.links(at, (of_a, links.as_ref()), (of_b, y.links.as_ref()));
            lines.links(&format!("{at} back"), (of_a, back.as_ref()), (of_b, y.back.as_ref()));
        });
    }

    fn placement(&mut self, at: &str, a: &FieldInstance, b: &FieldInstance) {
        let FieldInstance { model, position_m, scale, rotation_deg } = a;
        self.differ(&format!("{at} model"), model, &b.model);
        self.vectors(&format!("{at} position, m"), *position_m, b.position_m);
        self.vectors(&format!("{at} scale"), *scale, b.scale);
        self.vectors(&format!("{at} rotation, deg"), *rotation_deg, b.rotation_deg);
    }

    /// What links lead to, not what they are numbered.
    fn links(&mut self, at: &str, (of_a, a): (&Simulation, Option<&Links>), (of_b, b): (&Simulation, Option<&Links>)) {
        let (Some(a), Some(b)) = (a, b) else {
            let text = |links: Option<&Links>| if links.is_some() { "has links" } else { "has none" };
            if a.is_some() != b.is_some() {
                self.push(at, text(a), text(b));
            }
            return;
        };
        // Types and indices are followed, names are for people.
        let Links { kind, index, ident: _, thermal_index, thermal_ident: _, at: _ } = a;
        match (optical(of_a, *kind, *index), optical(of_b, b.kind, b.index)) {
            (Some(x), Some(y)) => {
                let OpticalProperty { kind, ident: _, database, model, transmittance, factors, at: _ } = x;
                self.differ(&format!("{at} kind of reflectance"), kind, &y.kind);
                let (table_a, table_b) = (format!("{database}/{model}"), format!("{}/{}", y.database, y.model));
                self.differ(&format!("{at} table"), &table_a, &table_b);
                self.differ(&format!("{at} transmittance"), transmittance, &y.transmittance);
                self.differ(&format!("{at} multiplicative factors"), factors, &y.factors);
            }
            (x, y) => self.differ(&format!("{at} the link leads somewhere"), &x.is_some(), &y.is_some()),
        }
        let temperatures = |s: &Simulation, index: u32| -> Vec<f64> {
            let range = |t: &ThermalFunction| {
                let ThermalFunction { ident: _, mean_k, range_k, overrides_cells: _, at: _ } = t;
                vec![*mean_k, *range_k]
            };
            s.thermal.get(index as usize).map_or(vec![], range)
        };
        let (x, y) = (temperatures(of_a, *thermal_index), temperatures(of_b, b.thermal_index));
        self.numbers(&format!("{at} temperature, mean and range, K"), &x, &y, 1.0);
        let overrides = |s: &Simulation, index: u32| s.thermal.get(index as usize).is_some_and(|t| t.overrides_cells);
        let (x, y) = (overrides(of_a, *thermal_index), overrides(of_b, b.thermal_index));
        self.differ(&format!("{at} override3DMatrix"), &x, &y);
    }

    fn camera(&mut self, at: &str, a: &Pinhole, b: &Pinhole) {
        let Pinhole { position_m, look_deg, roll_deg, field_of_view_deg, pixels, at: _ } = a;
        self.vectors(&format!("{at} position, m"), *position_m, b.position_m);
        self.numbers(&format!("{at} line of sight, zenith angle and azimuth, deg"), look_deg, &b.look_deg, 1.0);
        self.numbers(&format!("{at} turn about it, deg"), &[*roll_deg], &[b.roll_deg], 1.0);
        self.numbers(&format!("{at} field of view, deg"), field_of_view_deg, &b.field_of_view_deg, 0.0);
        self.differ(&format!("{at} pixels"), pixels, &b.pixels);
    }
}

fn optical(simulation: &Simulation, kind: u32, index: u32) -> Option<&OpticalProperty> {
    simulation.optical.iter().filter(|p| p.kind as u32 == kind).nth(index as usize)
}
