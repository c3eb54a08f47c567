//! What lights a body, as one list: the Sun first, then Mars and other bodies of the sky if there are any, then further beams.

use std::borrow::Cow;
use std::f64::consts::PI;

use glam::DVec3;

use super::{Beam, Globe, Setup, Sky};
use crate::geometry::Direction;
use crate::physics::blackbody;
use crate::physics::mars_points::day_share;
use crate::spectral::{Light, Spectrum};

/// From where a source's light comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DirectionField {
    /// From infinity: in this direction everywhere.
    Afar(Direction),
    /// From a point, or the centre of a body near at hand, local, m.
    Near(DVec3),
}

impl DirectionField {
    /// Towards the source from a point, local, m; of any length.
    pub fn towards(&self, p_m: DVec3) -> DVec3 {
        match self {
            DirectionField::Afar(direction) => direction.vec(),
            DirectionField::Near(centre_m) => *centre_m - p_m,
        }
    }

    /// Towards the source from the origin; `None` if it is there.
    pub fn direction(&self) -> Option<Direction> {
        match self {
            DirectionField::Afar(direction) => Some(*direction),
            DirectionField::Near(centre_m) => Direction::new(*centre_m),
        }
    }
}

/// The spectrum that a source's light has, before it meets the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Incoming<'a> {
    /// Sunlight.
    Sunlight,
    /// Sunlight that something of this reflectance sends on, so many times as strong there as at the scene.
    Reflected(&'a Spectrum, f64),
    /// Its own irradiance on a plane normal to the beam, W m-2 um-1.
    Own(&'a Spectrum),
    /// What black bodies of these temperatures, K, send to a plane that sees nothing else, by their shares.
    Heat([(f64, f64); 2]),
}

/// What a source is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SourceKind<'a> {
    /// A point at infinity, which casts shadows; its total irradiance normal to the beam, W m-2.
    Beam(f64),
    /// A sphere in the near field, lit by the Sun; a facet's own horizon cuts it, other terrain does not.
    Sphere(&'a Globe),
    /// The same sphere by its own heat: of uniform radiance.
    Glow(&'a Globe),
}

/// A source of light.
#[derive(Debug, Clone, PartialEq)]
pub struct Source<'a> {
    /// What it is called.
    pub name: Cow<'a, str>,
    /// From where its light comes.
    pub field: DirectionField,
    /// The spectrum of its light.
    pub incoming: Incoming<'a>,
    /// What it is.
    pub kind: SourceKind<'a>,
}

impl<'a> Source<'a> {
    fn sphere(sky: &Sky, globe: &'a Globe) -> Self {
        Source {
            name: Cow::from(&globe.name),
            field: DirectionField::Near(globe.centre_m),
            incoming: Incoming::Reflected(&globe.reflectance, sky.sun_on(globe).strength),
            kind: SourceKind::Sphere(globe),
        }
    }

    fn glow(sky: &Sky, globe: &'a Globe) -> Self {
        let day = day_share(globe.centre_m, globe.radius_m, sky.sun_on(globe).direction);
        let [day_k, night_k] = globe.day_night_k;
        Source {
            name: globe.heat_name().into(),
            field: DirectionField::Near(globe.centre_m),
            incoming: Incoming::Heat([(day, day_k), (1.0 - day, night_k)]),
            kind: SourceKind::Glow(globe),
        }
    }

    fn beam(beam: &'a Beam) -> Self {
        Source {
            name: Cow::from(&beam.name),
            field: DirectionField::Afar(beam.direction),
            incoming: Incoming::Own(&beam.irradiance),
            kind: SourceKind::Beam(beam.total_irradiance_w_m2),
        }
    }
}

impl Setup {
    /// All sources that are computed; the Sun is the first.
    pub fn sources(&self) -> Vec<Source<'_>> {
        let sky = &self.sky;
        let sun = Source {
            name: Sky::SUN.into(),
            field: DirectionField::Afar(sky.sun.direction),
            incoming: Incoming::Sunlight,
            kind: SourceKind::Beam(sky.sun.total_irradiance_w_m2()),
        };
        let bodies = || self.lighting_bodies().into_iter();
        let mut all = vec![sun];
        all.extend(sky.mars.iter().map(|mars| Source::sphere(sky, mars)));
        all.extend(bodies().map(|body| Source::sphere(sky, body)));
        all.extend(sky.beams.iter().map(Source::beam));
        all.extend(sky.mars.iter().filter(|_| self.models.mars_heat).map(|mars| Source::glow(sky, mars)));
        all.extend(bodies().filter(|body| body.day_night_k != [0.0; 2]).map(|body| Source::glow(sky, body)));
        all
    }

    /// Irradiance normal to the beam in bands of some kind, W m-2 um-1, as a product of a light and of what happens to it on the way; NaN where
    /// it is not known.
    pub fn incoming_w_m2_um(&self, incoming: Incoming, light: Light, um: f64) -> [f64; 2] {
        let at = |spectrum: &Spectrum| spectrum.at(um).unwrap_or(f64::NAN);
        let sunlight = || self.sky.sun.irradiance_w_m2_um(um).unwrap_or(f64::NAN);
        match incoming {
            Incoming::Sunlight => [sunlight(), 1.0],
            Incoming::Reflected(reflectance, strength) => [sunlight(), strength * at(reflectance)],
            Incoming::Own(irradiance) => [at(irradiance), 1.0],
            Incoming::Heat(parts) if light.glows() => {
                let of_part = |(share, t_k): (f64, f64)| share * PI * blackbody::radiance_w_m2_sr_um(um, t_k);
                [parts.map(of_part).iter().sum(), 1.0]
            }
            Incoming::Heat(_) => [0.0, 1.0],
        }
    }

    /// Bodies besides Mars whose light and heat is computed: as many as the models say, those that fill the most sky first, in the scene's order.
    pub fn lighting_bodies(&self) -> Vec<&Globe> {
        let bodies = &self.sky.bodies;
        let size = |i: &usize| bodies[*i].radius_m / bodies[*i].centre_m.length();
        let mut order: Vec<usize> = (0..bodies.len()).collect();
        order.sort_by(|a, b| size(b).total_cmp(&size(a)));
        order.truncate(self.models.bodies as usize);
        order.sort_unstable();
        order.into_iter().map(|i| &bodies[i]).collect()
    }
}

impl Sky {
    /// Name of the Sun in the list.
    pub const SUN: &'static str = "sun";
    /// Name of Mars in the list.
    pub const MARS: &'static str = "mars";
    /// Name of the heat of Mars in the list.
    pub const MARS_HEAT: &'static str = "mars-heat";

    /// Bodies that may hide the Sun: centre, local, m, and radius, m; what is beyond the Sun does not.
    pub fn spheres(&self) -> impl Iterator<Item = (DVec3, f64)> {
        let is_before = |globe: &&Globe| globe.centre_m.length() < self.sun.distance_m;
        self.globes().filter(is_before).map(|globe| (globe.centre_m, globe.radius_m))
    }
}
