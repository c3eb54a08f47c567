//! Every equation once: numbers and small structs in, numbers out. Knows no mesh, file or sensor.
//!
//! # Index
//!
//! Numbers in brackets are those of Domagala, *Image simulations of the mission Martian Moons eXploration* (KTH, 2020).
//!
//! | equation | function | source | closed-form test |
//! |---|---|---|---|
//! | Planck radiance, (10) without emissivity | [`blackbody::radiance_w_m2_sr_um`] | Planck; SI 2019 constants | oracles `planck_L` |
//! | Planck radiance of a band | [`blackbody::band_radiance_w_m2_sr`] | Chang & Rhee (1984) | oracles `band_L`; whole spectrum = sigma T^4 / pi |
//! | emissivity 1 - rho | [`reflectance::kirchhoff_emissivity`] | Kirchhoff | energy balance |
//! | local equilibrium temperature | [`heat::equilibrium_temperature_k`], [`heat::emitted_w_m2`] | Stefan-Boltzmann | oracles `radiative_equilibrium_T` |
//! | (9) | [`heat::thesis_temperature_k`] | Domagala (2020) | oracles `thesis_eq9_T` |
//! | (3) | [`sun::irradiance_on_facet`] | Lambert's cosine | flat plane |
//! | (5) inverse square | [`sun::irradiance_at`] | - | oracles `TSI` |
//! | angular radius, solid angle, light time | [`sun::angular_radius_rad`], [`sun::solid_angle_sr`], [`sun::light_time_s`] | - | oracles `sun` |
//! | sphere of uniform radiance over a tilted facet | [`mars::uniform_sphere_form_factor`] | Naraghi (1988); Howell, catalogue | oracles `plane_to_sphere_F` |
//! | Lambert sphere lit by the Sun, near at hand | [`mars::irradiance`], [`mars::irradiance_vector`] | integral over the visible cap | oracles `marsshine` |
//! | the same, fast, for the facets of one scene | [`mars_light::MarsLight`] | E'' + E = great-circle integral | against [`mars::irradiance`] |
//! | (4), (6), (7), (8) | [`mars::thesis_irradiance`] | Domagala (2020), as printed | 0.06516322993 |
//! | bounds of Mars-light, interreflection, penumbra, the Sun at the horizon | [`bounds::mars_light`], [`bounds::interreflection`], [`bounds::surroundings_form_factor`], [`bounds::penumbra_width_m`], [`bounds::terminator`] | set up here | full Mars; Ingersoll's bowl; flat ground; straight edge; flat horizon |
//! | eclipse | [`sun::eclipse`] | two discs | oracles `eclipse_by_mars_central_duration` |
//! | radiance of a reflectance factor, of a Lambert surface's exitance | [`reflectance::radiance_of_reflectance_factor`], [`reflectance::lambert_radiance`] | Nicodemus et al. (1977); Lambert | white surface; integral over the hemisphere |
//! | (2), (13): BRDF | [`reflectance::Brdf`] | Nicodemus et al. (1977); Hapke (2012) | Lambert rho / pi |
//! | sRGB to linear light and back | [`srgb::linear_from_hex`], [`srgb::hex_from_linear`] | IEC 61966-2-1 | mid grey; the straight part |
//!
//! Elsewhere, because they are geometry or sums: (11) to (13) in `solve::Emission`, (16) in `spectral::Band::in_band_w_m2_sr`,
//! (17) to (19) in `geometry::FrameCamera`.

pub mod blackbody;
pub mod bounds;
pub mod heat;
pub mod mars;
pub mod mars_light;
mod quadrature;
pub mod reflectance;
pub mod srgb;
pub mod sun;

pub(crate) use quadrature::GaussLegendre;
