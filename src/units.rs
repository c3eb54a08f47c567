//! Constants and conversions, each with its source.

/// Planck constant, J s (SI 2019, exact).
pub const PLANCK_J_S: f64 = 6.626_070_15e-34;
/// Speed of light in vacuum, m/s (SI, exact).
pub const LIGHT_SPEED_M_S: f64 = 299_792_458.0;
/// Energy of 1 eV, J (SI 2019, exact).
pub const ELECTRONVOLT_J: f64 = 1.602_176_634e-19;
/// Boltzmann constant, J/K (SI 2019, exact).
pub const BOLTZMANN_J_K: f64 = 1.380_649e-23;
/// Stefan-Boltzmann constant, W m-2 K-4: 2 pi^5 k^4 / (15 h^3 c^2).
pub const STEFAN_BOLTZMANN_W_M2_K4: f64 = 5.670_374_419_184_429e-8;
/// Metres of a kilometre.
pub const KM_M: f64 = 1000.0;
/// Seconds of a day.
pub const DAY_S: f64 = 86_400.0;
/// TT - TAI, s (by definition).
pub const TT_TAI_S: f64 = 32.184;
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

/// The golden ratio less 1: its multiples, modulo 1, are evenly spread.
pub const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Micrometres from nanometres.
pub fn um_from_nm(nm: f64) -> f64 {
    nm / 1000.0
}

/// The width in wavenumbers, cm-1, of 1 um at a wavelength: the derivative of nu = 1e4 / lambda, which is 1e4 / lambda^2.
pub fn cm_1_per_um(wavelength_um: f64) -> f64 {
    1e4 / (wavelength_um * wavelength_um)
}

/// A fraction from percent: the decimal point moves, so that 7 becomes the number nearest to 0.07 and comes back as 7.
///
/// Exact both ways for numbers of up to 15 digits; others are off by at most a rounding.
pub fn fraction_from_percent(percent: f64) -> f64 {
    shift_decimal(percent, -2)
}

/// Percent from a fraction, as [`fraction_from_percent`]; 0.07 times 100 would be 7.000000000000001.
pub fn percent_from_fraction(fraction: f64) -> f64 {
    shift_decimal(fraction, 2)
}

/// A number times a power of ten, as its shortest decimal text has it.
fn shift_decimal(x: f64, places: i32) -> f64 {
    let text = format!("{x:e}");
    let shifted = text
        .split_once('e')
        .and_then(|(digits, exponent)| format!("{digits}e{}", exponent.parse::<i32>().ok()? + places).parse().ok());
    shifted.unwrap_or(x * 10.0_f64.powi(places)) // NaN and infinity have no exponent
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_written_as_decimals_stay_as_written() {
        for i in 0..=100_000 {
            let percent = f64::from(i) / 1000.0;
            let fraction = fraction_from_percent(percent);
            assert_eq!(percent_from_fraction(fraction), percent);
            assert!((fraction - percent / 100.0).abs() <= f64::EPSILON * fraction, "{percent}");
        }
        assert_eq!(fraction_from_percent(7.0), 0.07);
        assert_eq!(percent_from_fraction(0.07), 7.0);
        assert_eq!(percent_from_fraction(-0.0), 0.0);
        assert!(percent_from_fraction(f64::NAN).is_nan());
        assert_eq!(fraction_from_percent(f64::INFINITY), f64::INFINITY);
    }
}
