//! What two simulations differ in, by meaning: not by text, order of attributes, names that DART ignores, or how a link is numbered.

use std::fmt::Debug;

use glam::DVec3;

use crate::geometry::angle_rad;

use super::frame;
use super::simulation::{Camera, Links, Object, OpticalProperty, Simulation};

/// Numbers of one meaning that were computed along two ways differ by less: relative, and lengths, angles and temperatures in their unit.
const ROUNDING: f64 = 1e-12;

/// One line for each difference: where, and both values. Numbers differ if rounding does not explain it. Empty: the same in meaning.
///
/// Not compared: idents, names of objects and groups, places of optical properties in their lists (links are followed), and what
/// nothing is linked to.
pub fn diff(a: &Simulation, b: &Simulation) -> Vec<String> {
    let mut lines = Lines(Vec::new());
    if a.version != b.version {
        let text = |s: &Simulation| format!("{} {}", s.version.version, s.version.build);
        lines.push("version", &text(a), &text(b));
    }
    lines.numbers("maket.xml Scene/SceneDimensions, m", &a.maket.size_m, &b.maket.size_m, 1.0);
    lines.numbers("maket.xml Scene/CellDimensions, m", &a.maket.cell_m, &b.maket.cell_m, 0.0);
    lines.differ("maket.xml Maket/@exactlyPeriodicScene", &a.maket.boundary, &b.maket.boundary);
    lines.differ("maket.xml Soil/@groundEnabled", &a.maket.ground_enabled, &b.maket.ground_enabled);
    if a.maket.ground_enabled && b.maket.ground_enabled {
        lines.links("maket.xml Soil", (a, Some(&a.maket.ground)), (b, Some(&b.maket.ground)));
    }
    let raster = |s: &Simulation| s.maket.topography.as_ref().map(|t| t.file.clone());
    lines.differ("maket.xml Soil/Topography", &raster(a), &raster(b));
    let (place_a, place_b) = (a.maket.latitude_longitude_altitude, b.maket.latitude_longitude_altitude);
    lines.numbers("maket.xml LatLon", &place_a, &place_b, 1.0);

    lines.each("object_3d.xml Object", &a.objects, &b.objects, |lines, at, x, y| lines.object(at, (a, x), (b, y)));

    lines.each("object_3d.xml Field", &a.fields, &b.fields, |lines, at, x, y| {
        lines.each(&format!("{at} Object"), &x.models, &y.models, |lines, at, x, y| lines.object(at, (a, x), (b, y)));
        lines.each(&format!("{at} place"), &x.places, &y.places, |lines, at, x, y| lines.differ(at, x, y));
    });

    lines.each("phase.xml SpectralIntervalsProperties", &a.phase.bands, &b.phase.bands, |lines, at, x, y| {
        lines.numbers(&format!("{at} meanLambda, um"), &[x.mean_um], &[y.mean_um], 0.0);
        lines.numbers(&format!("{at} deltaLambda, um"), &[x.width_um], &[y.width_um], 0.0);
        lines.differ(&format!("{at} spectralDartMode"), &x.mode, &y.mode);
    });
    lines.differ("phase.xml nodeIlluminationMode/@irradianceMode", &a.phase.irradiance_mode, &b.phase.irradiance_mode);
    if a.phase.irradiance_mode == 1 && b.phase.irradiance_mode == 1 {
        lines.each("phase.xml SpectralIrradianceValue", &a.phase.irradiance, &b.phase.irradiance, |lines, at, x, y| {
            lines.numbers(&format!("{at} irradiance, W m-2 um-1"), &[x.0], &[y.0], 0.0);
            lines.numbers(&format!("{at} Skyl"), &[x.1], &[y.1], 0.0);
        });
    }
    lines.differ(
        "phase.xml BrfProductsProperties/@luminanceProducts",
        &a.phase.radiance_products,
        &b.phase.radiance_products,
    );
    lines.each("phase.xml camera", &a.phase.cameras, &b.phase.cameras, Lines::camera);

    lines.directions("directions.xml Sun, zenith angle and azimuth, deg", &a.directions.sun_deg, &b.directions.sun_deg);
    lines.each(
        "directions.xml AddedDirections",
        &a.directions.views_deg,
        &b.directions.views_deg,
        |lines, at, x, y| {
            lines.directions(&format!("{at} zenith angle and azimuth, deg"), x, y);
        },
    );
    lines.each("sequence", &a.sequences, &b.sequences, |lines, at, x, y| {
        lines.each(&format!("{at} group"), &x.groups, &y.groups, |lines, at, x, y| {
            lines.each(&format!("{at} entry"), &x.entries, &y.entries, |lines, at, x, y| {
                lines.differ(&format!("{at} propertyName"), &x.property, &y.property);
                lines.differ(&format!("{at} args"), &x.values, &y.values);
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

    /// `scale`: what is small beside it is small.
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

    fn object(&mut self, at: &str, (of_a, a): (&Simulation, &Object), (of_b, b): (&Simulation, &Object)) {
        self.differ(&format!("{at} file_src"), &a.file, &b.file);
        self.vectors(&format!("{at} position, m"), a.position_m, b.position_m);
        self.vectors(&format!("{at} scale"), a.scale, b.scale);
        self.vectors(&format!("{at} rotation, deg"), a.rotation_deg, b.rotation_deg);
        self.differ(&format!("{at} objectDEMMode"), &a.dem_mode, &b.dem_mode);
        self.differ(&format!("{at} hidden"), &a.hidden, &b.hidden);
        self.differ(&format!("{at} repeatedOnBorder"), &a.repeated_on_border, &b.repeated_on_border);
        self.differ(&format!("{at} doubleFace"), &a.double_face, &b.double_face);
        self.links(at, (of_a, a.links.as_ref()), (of_b, b.links.as_ref()));
        self.links(&format!("{at} back"), (of_a, a.back.as_ref()), (of_b, b.back.as_ref()));
        self.each(&format!("{at} Group"), &a.groups, &b.groups, |lines, at, x, y| {
            lines.differ(&format!("{at} num"), &x.number, &y.number);
            lines.differ(&format!("{at} hidden"), &x.hidden, &y.hidden);
            lines.differ(&format!("{at} doubleFace"), &x.double_face, &y.double_face);
            lines.links(at, (of_a, x.links.as_ref()), (of_b, y.links.as_ref()));
            lines.links(&format!("{at} back"), (of_a, x.back.as_ref()), (of_b, y.back.as_ref()));
        });
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
        match (optical(of_a, a), optical(of_b, b)) {
            (Some(x), Some(y)) => {
                self.differ(&format!("{at} kind of reflectance"), &x.kind, &y.kind);
                let table = |p: &OpticalProperty| format!("{}/{}", p.database, p.model);
                self.differ(&format!("{at} table"), &table(x), &table(y));
                self.differ(&format!("{at} transmittance"), &x.transmittance, &y.transmittance);
                self.differ(&format!("{at} multiplicative factors"), &x.factors, &y.factors);
            }
            (x, y) => self.differ(&format!("{at} the link leads somewhere"), &x.is_some(), &y.is_some()),
        }
        let temperatures = |s: &Simulation, links: &Links| -> Vec<f64> {
            s.thermal.get(links.thermal_index as usize).map_or(vec![], |t| vec![t.mean_k, t.range_k])
        };
        let (x, y) = (temperatures(of_a, a), temperatures(of_b, b));
        self.numbers(&format!("{at} temperature, mean and range, K"), &x, &y, 1.0);
    }

    fn camera(&mut self, at: &str, a: &Camera, b: &Camera) {
        self.vectors(&format!("{at} position, m"), a.position_m, b.position_m);
        self.numbers(&format!("{at} line of sight, zenith angle and azimuth, deg"), &a.look_deg, &b.look_deg, 1.0);
        self.numbers(&format!("{at} turn about it, deg"), &[a.roll_deg], &[b.roll_deg], 1.0);
        self.numbers(&format!("{at} field of view, deg"), &a.field_of_view_deg, &b.field_of_view_deg, 0.0);
        self.differ(&format!("{at} pixels"), &a.pixels, &b.pixels);
    }
}

fn optical<'a>(simulation: &'a Simulation, links: &Links) -> Option<&'a OpticalProperty> {
    simulation.optical.iter().filter(|p| p.kind as u32 == links.kind).nth(links.index as usize)
}
