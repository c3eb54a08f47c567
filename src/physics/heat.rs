//! How warm a surface is.

use crate::units::STEFAN_BOLTZMANN_W_M2_K4;

/// Temperature at which a surface emits what it absorbs, K: T = (q / (eps sigma))^(1/4).
///
/// `absorbed_w_m2` is all of q: (1 - A) (E_sun + E_mars) of sunlight over all wavelengths, plus eps times the thermal
/// irradiance of Mars; A the Bond albedo, eps the emissivity over all wavelengths.
/// Source: Stefan-Boltzmann. Limits: no heat from below and no thermal inertia, so a fresh shadow is too cold.
pub fn equilibrium_temperature_k(absorbed_w_m2: f64, emissivity_bolometric: f64) -> f64 {
    (absorbed_w_m2.max(0.0) / (emissivity_bolometric * STEFAN_BOLTZMANN_W_M2_K4)).sqrt().sqrt()
}

/// What a surface emits over all wavelengths, W m-2: eps sigma T^4. Source: Stefan-Boltzmann.
pub fn emitted_w_m2(t_k: f64, emissivity_bolometric: f64) -> f64 {
    emissivity_bolometric * STEFAN_BOLTZMANN_W_M2_K4 * t_k.powi(4)
}

/// Temperature by the thesis, K: T = 150 + 180 E_sun / E_S, E_sun / E_S the cosine of incidence, 0 in shadow.
///
/// Source: equation (9) of Domagala (2020), as printed. Limits: linear in the cosine, at any distance from the Sun;
/// with 330 K at the sub-solar point, equilibrium at 60 deg incidence is 277.5 K, not 240 K.
pub fn thesis_temperature_k(sun_share: f64) -> f64 {
    150.0 + 180.0 * sun_share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equilibrium_of_phobos_at_the_sub_solar_point() {
        // A 0.03, eps 0.95, 1361 W m-2 at 1 au: independently computed.
        for (d_au, cos_i, expected_k) in [
            (1.381, 1.0, 336.687_342_783_841_13),
            (1.523_679, 0.5, 269.537_620_146_059_45),
            (1.666, 0.1, 172.379_704_086_598_34),
        ] {
            let got = equilibrium_temperature_k(0.97 * 1361.0 / (d_au * d_au) * cos_i, 0.95);
            assert!((got / expected_k - 1.0).abs() < 1e-13, "{got} {expected_k}");
        }
    }

    #[test]
    fn half_the_sun_is_the_fourth_root_of_half_the_temperature() {
        let full = equilibrium_temperature_k(600.0, 0.95);
        assert!((equilibrium_temperature_k(300.0, 0.95) / full - 0.5f64.powf(0.25)).abs() < 1e-15);
        assert_eq!(equilibrium_temperature_k(0.0, 0.95), 0.0);
        assert_eq!(equilibrium_temperature_k(-1.0, 0.95), 0.0);
        assert!((emitted_w_m2(full, 0.95) / 600.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_thesis_is_linear() {
        assert_eq!(thesis_temperature_k(0.0), 150.0);
        assert_eq!(thesis_temperature_k(0.25), 195.0);
        assert_eq!(thesis_temperature_k(1.0), 330.0);
    }
}
