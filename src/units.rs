//! Constants and conversions, each with its source.

/// Planck constant, J s (SI 2019, exact).
pub const PLANCK_J_S: f64 = 6.626_070_15e-34;
/// Speed of light in vacuum, m/s (SI, exact).
pub const LIGHT_SPEED_M_S: f64 = 299_792_458.0;
/// Boltzmann constant, J/K (SI 2019, exact).
pub const BOLTZMANN_J_K: f64 = 1.380_649e-23;
/// Stefan-Boltzmann constant, W m-2 K-4: 2 pi^5 k^4 / (15 h^3 c^2).
pub const STEFAN_BOLTZMANN_W_M2_K4: f64 = 5.670_374_419_184_429e-8;
/// Astronomical unit, m (IAU 2012 Resolution B2, exact).
pub const AU_M: f64 = 149_597_870_700.0;
/// Nominal solar radius, m (IAU 2015 Resolution B3).
pub const SUN_RADIUS_M: f64 = 695_700_000.0;
/// Nominal total solar irradiance at 1 au, W m-2 (IAU 2015 Resolution B3).
pub const TSI_1AU_W_M2: f64 = 1361.0;
/// Mean distance of Phobos from the centre of Mars, m (Lainey et al. 2007).
pub const PHOBOS_ORBIT_M: f64 = 9_376_000.0;
/// Volumetric mean radius of Mars, m (IAU 2015, pck00011).
pub const MARS_RADIUS_M: f64 = 3_389_500.0;

/// Micrometres from nanometres.
pub fn um_from_nm(nm: f64) -> f64 {
    nm / 1000.0
}
