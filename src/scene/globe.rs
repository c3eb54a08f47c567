//! Bodies of the sky: Mars, and any others, as spheres that reflect sunlight, are warm, and hide what is behind them.

use glam::DVec3;

use super::sky::check_irradiance;
use super::{Body, Setup, Sky};
use crate::error::{Location, Problem};
use crate::geometry::polygon::Rect;
use crate::geometry::{Direction, SphereImage, nearest_on_triangle};
use crate::spectral::Spectrum;
use crate::units::{STEFAN_BOLTZMANN_W_M2_K4, SUN_RADIUS_M};

/// Lambert reflectance of Mars where nothing else is said.
pub const MARS_ALBEDO: f64 = 0.25;

/// Brightness temperatures of the day and night side of Mars where nothing else is said, K.
pub const MARS_DAY_NIGHT_K: [f64; 2] = [270.0, 200.0];

/// Globes that are nearer than this share of the Sun's distance have the scene's sunlight: its direction is off by no more radians there, its
/// irradiance by no more than twice as much. All others have their own.
pub const SAME_SUNLIGHT: f64 = 1e-3;

/// A body of the sky: a Lambert sphere, with a day and a night side.
#[derive(Debug, Clone, PartialEq)]
pub struct Globe {
    /// What it is called: letters, digits, `-` and `_`.
    pub name: String,
    /// Centre, local to the scene's origin, axes of the body-fixed frame, m.
    pub centre_m: DVec3,
    /// Radius, m.
    pub radius_m: f64,
    /// Lambert reflectance (dimensionless).
    pub reflectance: Spectrum,
    /// Bond albedo, for the heat balance of what it lights.
    pub bond_albedo: f64,
    /// Mean thermal exitance, for the same, W m-2.
    pub thermal_exitance_w_m2: f64,
    /// Brightness temperature of its day and of its night side, for what it emits in bands, K.
    pub day_night_k: [f64; 2],
}

/// Sunlight on a globe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunOnGlobe {
    /// From the globe's centre towards the Sun.
    pub direction: Direction,
    /// Irradiance normal to the beam, over that at the scene.
    pub strength: f64,
}

impl Globe {
    /// Name of its heat in the list of sources.
    pub fn heat_name(&self) -> String {
        format!("{}-heat", self.name)
    }

    /// Exitance of a globe of which half is as warm as its day and half as its night side, W m-2.
    pub fn mean_exitance_w_m2([day_k, night_k]: [f64; 2]) -> f64 {
        0.5 * STEFAN_BOLTZMANN_W_M2_K4 * (day_k.powi(4) + night_k.powi(4))
    }

    pub(super) fn check(&self, item: &str, problem: &mut impl FnMut(&str, String)) {
        super::near_enough(&format!("{item}.position_m"), self.centre_m, problem);
        for (name, t_k) in ["day_k", "night_k"].iter().zip(self.day_night_k) {
            if !(0.0..=1e4).contains(&t_k) {
                problem(&format!("{item}.{name}"), format!("{t_k} K is not a temperature of a planet"));
            }
        }
        check_irradiance(&format!("{item}.thermal_exitance_w_m2"), self.thermal_exitance_w_m2, problem);
        if !(self.radius_m > 0.0 && self.radius_m.is_finite()) {
            problem(&format!("{item}.radius_m"), format!("{} is not a positive length", self.radius_m));
        } else if self.centre_m.length() <= self.radius_m {
            let whose = if self.name == Sky::MARS { "Mars" } else { &self.name };
            problem(&format!("{item}.position_m"), format!("the scene lies inside {whose}"));
        }
    }
}

impl Setup {
    /// Bodies of the sky that the camera may have in its field, as they appear there; of two that overlap in the image the one in front comes first.
    pub fn globes_in_view(&self) -> Vec<(&Globe, SphereImage)> {
        let camera = self.exposure.camera.drawn().pinhole;
        let image = Rect { min: [0.0; 2], max: [f64::from(camera.samples), f64::from(camera.lines)] };
        let in_view = |globe| {
            let sun = self.sky.sun_on(globe).direction;
            let seen = SphereImage::new(&camera, globe.centre_m, globe.radius_m, sun)?;
            seen.may_touch(&image).then_some((globe, seen))
        };
        let mut all: Vec<(&Globe, SphereImage)> = self.sky.globes().filter_map(in_view).collect();
        all.sort_by(|a, b| a.1.tangent_m2().total_cmp(&b.1.tangent_m2()));
        all
    }
}

/// Bodies of the sky that touch each other, the mesh or the camera: none of them is before or behind the other.
pub(super) fn touching(sky: &Sky, body: &Body, eye_m: DVec3) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut problem = |item: &str, message: String| {
        let help = "positions are in metres from the body's centre: check their unit, `origin_m`, and the radius";
        problems.push(Problem::new(Location::item(item), message).with_help(help));
    };
    let globes: Vec<&Globe> = sky.globes().collect();
    for (i, globe) in globes.iter().enumerate() {
        let Globe { centre_m, radius_m, .. } = **globe;
        let (item, called) = match globe.name == Sky::MARS {
            true => (Sky::MARS.to_owned(), "Mars"),
            false => (super::sky::body_item(i - usize::from(sky.mars.is_some())), globe.name.as_str()),
        };
        if (eye_m - centre_m).length() <= radius_m {
            problem("observer.position_m", format!("the camera is inside {called}"));
        }
        for other in &globes[..i] {
            if (other.centre_m - centre_m).length() <= other.radius_m + radius_m {
                problem(&format!("{item}.position_m"), format!("{called} and {} touch", other.name));
            }
        }
        let reaches = |p_m: DVec3| (p_m - centre_m).length() <= radius_m;
        let is_near = body.bounds_m().is_some_and(|(low_m, high_m)| reaches(centre_m.clamp(low_m, high_m)));
        let mesh = &body.mesh;
        let touches = |f: usize| reaches(nearest_on_triangle(centre_m, mesh.facet(f).corners_m));
        if is_near && let Some(facet) = (0..mesh.facets.len()).find(|f| touches(*f)) {
            problem(&format!("{item}.position_m"), format!("{called} touches facet {facet} of the mesh"));
        }
    }
    problems
}

impl Sky {
    /// All bodies of the sky: Mars first.
    pub fn globes(&self) -> impl Iterator<Item = &Globe> {
        self.mars.iter().chain(&self.bodies)
    }

    /// The sunlight on a globe.
    pub fn sun_on(&self, globe: &Globe) -> SunOnGlobe {
        let (direction, distance_m) = (self.sun.direction, self.sun.distance_m);
        let from_globe_m = distance_m * direction.vec() - globe.centre_m;
        match Direction::new(from_globe_m) {
            Some(own) if globe.centre_m.length() > SAME_SUNLIGHT * distance_m => {
                // Inside the Sun it is as strong as at its surface.
                let nearest_m = from_globe_m.length().max(SUN_RADIUS_M);
                SunOnGlobe { direction: own, strength: (distance_m / nearest_m).powi(2) }
            }
            _ => SunOnGlobe { direction, strength: 1.0 },
        }
    }
}
