//! Upper bounds of what an image leaves out: cheap, and never below the truth.
//!
//! Each is a change of radiance relative to sunlight reflected at incidence i by the same surface.

use std::f64::consts::SQRT_2;

/// Mars-light over sunlight: rho_M q^2 / cos i, q the sine of Mars' angular radius.
///
/// Every visible patch of Mars under a Sun at its zenith, all of Mars above a facet that faces it: E = rho_M q^2 E_S.
/// Limits: a Lambert Mars; 1.2 to 1.5 times the light of a full one, and far above that of a waning one.
pub fn mars_light(mars_reflectance: f64, sin_angular_radius: f64, cos_incidence: f64) -> f64 {
    mars_reflectance * sin_angular_radius * sin_angular_radius / cos_incidence
}

/// Light by way of the surroundings over direct sunlight, all bounces: (rho + m) F / ((1 - rho F) cos i).
///
/// No surface has a radiosity above rho (E_S + E) + m E_S, m the most that one emits, over E_S; so E <= F (rho (E_S + E) + m E_S),
/// F the surroundings' form factor. Limits: F < 1 / rho.
pub fn interreflection(reflectance: f64, emitted: f64, form_factor: f64, cos_incidence: f64) -> f64 {
    (reflectance + emitted) * form_factor / ((1.0 - reflectance * form_factor) * cos_incidence)
}

/// Radiance that arrives of what the surroundings emit, by way of others too, averaged over all directions with their cosines: L F / (1 - rho F).
///
/// L is the most that one emits, rho the most that one reflects, F the surroundings' form factor. What a facet reflects of it is rho times that.
/// Limits: F < 1 / rho.
pub fn neighbours_heat(emitted: f64, reflectance: f64, form_factor: f64) -> f64 {
    emitted * form_factor / (1.0 - reflectance * form_factor)
}

/// Form factor of the surroundings of a facet of a height field whose slopes nowhere exceed b: 1 - cos^3 b.
///
/// From no point does such a surface rise above an elevation of b. What is above it is a cone of sky of half angle
/// pi / 2 - b, whose form factor to a facet of slope b, which sees all of it, is sin^2(pi / 2 - b) cos b.
/// 1 where slopes reach pi / 2, as on boulders.
pub fn surroundings_form_factor(cos_steepest: f64) -> f64 {
    1.0 - cos_steepest.clamp(0.0, 1.0).powi(3)
}

/// Width of a penumbra on a surface, m: 2 s d / cos i behind an edge at distance d along the ray, s the Sun's angular radius.
///
/// Limits: light square to the edge (the widest), s much smaller than pi / 2 - i.
pub fn penumbra_width_m(distance_m: f64, sun_radius_rad: f64, cos_incidence: f64) -> f64 {
    2.0 * sun_radius_rad * distance_m / cos_incidence
}

/// Radiance behind the straight edge of a shadow that crosses a pixel, if points stand for the Sun's disc, over that of a surface lit at
/// incidence i: off by at most sqrt(2) c s d / (p cos i), and by 1 / cos i whatever the edges.
///
/// c is the [error of the points](super::sun_disc::DiscRule::edge_error), s the sine of the disc's radius, d how far the shadow is thrown along the rays,
/// p the pixel at the surface, square to the line of sight: the edge is at most sqrt(2) p / cos e long, e the emission, and a strip across it, square to
/// the rays, gains or loses at most c s d of full sunlight. Limits: one edge in the pixel; several add up.
pub fn shadow_edge(edge_error: f64, sin_radius: f64, throw_m: f64, pixel_m: f64, cos_incidence: f64) -> f64 {
    (SQRT_2 * edge_error * sin_radius * throw_m / pixel_m).min(1.0) / cos_incidence
}

/// Sunlight on a surface along the rays, of which a point Sun gives none, over that square to them: 2 s / (3 pi).
///
/// At any other incidence the disc's upper limb adds less. Limits: s, the Sun's angular radius, much smaller than 1.
pub fn terminator(sun_radius_rad: f64) -> f64 {
    2.0 * sun_radius_rad / (3.0 * std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mars_light_stays_below_its_bound() {
        // rho 0.25, R 3389.5 km, D 9389 km: 0.03258161496; a full Lambert sphere near at hand, D 9376 km: 0.0271.
        assert!((mars_light(0.25, 3389.5 / 9389.0, 1.0) - 0.032_581_614_96).abs() < 1e-11);
        assert!(mars_light(0.25, 3389.5 / 9376.0, 1.0) > 0.25 * 0.108_426_08);
    }

    #[test]
    fn light_in_a_bowl_stays_below_its_bound() {
        // Ingersoll's bowl, depth / diameter 0.2, Sun 30 deg up, 586.22 W m-2, reflectance 0.07: E = 2.463524 W m-2. All of
        // the bowl's f = 0.137931 is what its floor sees; its walls slope by up to 43.6 deg.
        let direct = 586.22 * 0.5;
        assert!(interreflection(0.07, 0.0, 0.137_931, 0.5) * direct > 2.463_524);
        // All its light, over all wavelengths, with the heat of its walls: 37.96642 W m-2 more. A wall emits no more than it absorbs.
        assert!(interreflection(0.07, 0.93, 0.137_931, 0.5) * direct > 2.463_524 + 37.966_42);
        let f = surroundings_form_factor(43.6_f64.to_radians().cos());
        assert!(f > 0.137_931 && f < 1.0, "{f}");
    }

    #[test]
    fn heat_in_a_furnace_is_black() {
        // Walls of reflectance rho emit 1 - rho of a black body; all around, with what they reflect, they send what it does.
        assert!((neighbours_heat(0.3, 0.7, 1.0) - 1.0).abs() < 1e-15);
        assert_eq!(neighbours_heat(0.9, 0.1, 0.0), 0.0);
    }

    #[test]
    fn flat_ground_sees_only_sky_and_a_boulder_may_see_only_ground() {
        assert_eq!(surroundings_form_factor(1.0), 0.0);
        assert_eq!(surroundings_form_factor(-0.1), 1.0);
        // Slopes of 60 deg: at least an eighth of the light of a whole sky.
        assert!((surroundings_form_factor(0.5) - 0.875).abs() < 1e-15);
    }

    #[test]
    fn a_sharp_edge_misses_less_than_a_point_sun_may() {
        // Light that a sharp edge gives too much on one side: 2 / (3 pi) of half the penumbra's width, s d. Square across a pixel of 1 m, 12 m off, 60 deg.
        let missed = 2.0 / (3.0 * std::f64::consts::PI) * 3.0522e-3 * 12.0 / 0.5;
        let bound = shadow_edge(0.2123, 3.0522e-3, 12.0, 1.0, 0.5);
        assert!(bound > missed && bound < 1.5 * missed, "{bound} {missed}");
        assert_eq!(shadow_edge(0.2123, 3e-3, 1e9, 1.0, 0.5), 2.0);
    }

    #[test]
    fn a_penumbra_of_known_width() {
        // 12 m high, incidence 60 deg, Sun of 3.0522 mrad: h tan(i + s) - h tan(i - s) = 0.293 m.
        let (h, i, s) = (12.0, 60f64.to_radians(), 3.0522e-3);
        let exact = h * ((i + s).tan() - (i - s).tan());
        assert!((exact - 0.293).abs() < 5e-4);
        assert!((penumbra_width_m(h / i.cos(), s, i.cos()) / exact - 1.0).abs() < 1e-3);
        // Half the Sun above a flat horizon at 1.523679 au: 6.476840338e-4 of its irradiance (closed form of a cut sphere).
        assert!((terminator(3.052_135_3e-3) / 6.476_840_338e-4 - 1.0).abs() < 1e-4);
    }
}
