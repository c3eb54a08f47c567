//! Approximate position of Mars about the Sun: mean elements that change linearly.

use glam::{DMat3, DVec3};

use super::{Epoch, State};
use crate::units::{AU_M, DAY_S};

/// Elements of an orbit at J2000, and their changes per century.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elements {
    /// Semi-major axis, au.
    pub semi_major_au: [f64; 2],
    /// Eccentricity.
    pub eccentricity: [f64; 2],
    /// Inclination to the ecliptic, deg.
    pub inclination_deg: [f64; 2],
    /// Mean longitude, deg.
    pub mean_longitude_deg: [f64; 2],
    /// Longitude of perihelion, deg.
    pub perihelion_deg: [f64; 2],
    /// Longitude of the ascending node, deg.
    pub node_deg: [f64; 2],
}

impl Elements {
    /// Mars, 1800 to 2050 (Standish & Williams, *Approximate positions of the planets*, JPL): within 40 arcsec (44 000
    /// km) along the orbit, 2 arcsec across it, and 25 000 km in distance.
    pub const MARS: Elements = Elements {
        semi_major_au: [1.523_710_34, 0.000_018_47],
        eccentricity: [0.093_394_10, 0.000_078_82],
        inclination_deg: [1.849_691_42, -0.008_131_31],
        mean_longitude_deg: [-4.553_432_05, 19_140.302_684_99],
        perihelion_deg: [-23.943_629_59, 0.444_410_88],
        node_deg: [49.559_538_91, -0.292_573_43],
    };

    /// Position and velocity about the Sun, along the axes of the ecliptic at J2000.
    pub fn state(&self, epoch: Epoch) -> State {
        let centuries = epoch.centuries();
        let [a, e, inclination, longitude, perihelion, node] = [
            self.semi_major_au,
            self.eccentricity,
            self.inclination_deg,
            self.mean_longitude_deg,
            self.perihelion_deg,
            self.node_deg,
        ]
        .map(|[at_2000, rate]| at_2000 + rate * centuries);
        let mean_rad = (longitude - perihelion).rem_euclid(360.0).to_radians();
        // Newton's method from M + e sin M: eccentricities are below 0.2.
        let mut eccentric = mean_rad + e * mean_rad.sin();
        for _ in 0..8 {
            eccentric -= (eccentric - e * eccentric.sin() - mean_rad) / (1.0 - e * eccentric.cos());
        }
        let (sin, cos) = eccentric.sin_cos();
        let (a_m, flat) = (a * AU_M, (1.0 - e * e).sqrt());
        let mean_motion_rad_s = (self.mean_longitude_deg[1] - self.perihelion_deg[1]).to_radians() / (36_525.0 * DAY_S);
        let rate = mean_motion_rad_s / (1.0 - e * cos);
        let plane = DMat3::from_rotation_z(node.to_radians())
            * DMat3::from_rotation_x(inclination.to_radians())
            * DMat3::from_rotation_z((perihelion - node).to_radians());
        State {
            position_m: plane * DVec3::new(a_m * (cos - e), a_m * flat * sin, 0.0),
            velocity_m_s: plane * DVec3::new(-a_m * rate * sin, a_m * flat * rate * cos, 0.0),
        }
    }
}
