//! What lights a body, as one list: the Sun first, then Mars if there is one, then further beams.

use glam::DVec3;

use super::{Beam, Mars, Setup, Sky};
use crate::geometry::Direction;
use crate::physics::mars_points::day_share;
use crate::spectral::Spectrum;

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
    /// Sunlight that something of this reflectance sends on.
    Reflected(&'a Spectrum),
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
    Sphere(&'a Mars),
    /// The same sphere by its own heat: of uniform radiance.
    Glow(&'a Mars),
}

/// A source of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// What it is called.
    pub name: &'a str,
    /// From where its light comes.
    pub field: DirectionField,
    /// The spectrum of its light.
    pub incoming: Incoming<'a>,
    /// What it is.
    pub kind: SourceKind<'a>,
}

impl Setup {
    /// All sources that are computed; the Sun is the first.
    pub fn sources(&self) -> Vec<Source<'_>> {
        let mut all = self.sky.sources();
        if let Some(mars) = self.sky.mars.as_ref().filter(|_| self.models.mars_heat) {
            let day = day_share(mars.centre_m, mars.radius_m, self.sky.sun.direction);
            let [day_k, night_k] = mars.day_night_k;
            all.push(Source {
                name: Sky::MARS_HEAT,
                field: DirectionField::Near(mars.centre_m),
                incoming: Incoming::Heat([(day, day_k), (1.0 - day, night_k)]),
                kind: SourceKind::Glow(mars),
            });
        }
        all
    }
}

impl Sky {
    /// Name of the Sun in the list.
    pub const SUN: &'static str = "sun";
    /// Name of Mars in the list.
    pub const MARS: &'static str = "mars";
    /// Name of the heat of Mars in the list.
    pub const MARS_HEAT: &'static str = "mars-heat";

    /// Bodies that may hide the Sun: centre, local, m, and radius, m.
    pub fn spheres(&self) -> impl Iterator<Item = (DVec3, f64)> {
        self.mars.iter().map(|mars| (mars.centre_m, mars.radius_m))
    }

    /// All sources but the heat of Mars; the Sun is the first.
    pub fn sources<'s>(&'s self) -> Vec<Source<'s>> {
        let sun = Source {
            name: Sky::SUN,
            field: DirectionField::Afar(self.sun.direction),
            incoming: Incoming::Sunlight,
            kind: SourceKind::Beam(self.sun.total_irradiance_w_m2()),
        };
        let mars = self.mars.as_ref().map(|sphere| Source {
            name: Sky::MARS,
            field: DirectionField::Near(sphere.centre_m),
            incoming: Incoming::Reflected(&sphere.reflectance),
            kind: SourceKind::Sphere(sphere),
        });
        let of_beam = |beam: &'s Beam| Source {
            name: &beam.name,
            field: DirectionField::Afar(beam.direction),
            incoming: Incoming::Own(&beam.irradiance),
            kind: SourceKind::Beam(beam.total_irradiance_w_m2),
        };
        [sun].into_iter().chain(mars).chain(self.beams.iter().map(of_beam)).collect()
    }
}
