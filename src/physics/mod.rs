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
//! | conduction into the ground over a day | [`conduction::Ground`] | Spencer, Lebofsky & Sykes (1989) | small waves; absorbed = emitted; oracles `conduction_equator` |
//! | waves at depth, constant flux | [`conduction::wave_at_depth`], [`conduction::rise_by_constant_flux_k`] | Carslaw & Jaeger (1959) | oracles `thermal` |
//! | (9) | [`heat::thesis_temperature_k`] | Domagala (2020) | oracles `thesis_eq9_T` |
//! | (3) | [`sun::irradiance_on_facet`] | Lambert's cosine | flat plane |
//! | (5) inverse square | [`sun::irradiance_at`] | - | oracles `TSI` |
//! | angular radius, solid angle, light time | [`sun::angular_radius_rad`], [`sun::solid_angle_sr`], [`sun::light_time_s`] | - | oracles `sun` |
//! | form factors of rectangles, strips, discs and polygons | [`form_factor`] | Howell, catalogue; Lambert | a closed cube; oracles `formfactor` |
//! | sphere of uniform radiance over a tilted facet | [`mars::uniform_sphere_form_factor`] | Naraghi (1988); Howell, catalogue | oracles `plane_to_sphere_F` |
//! | Lambert sphere lit by the Sun, near at hand | [`mars::irradiance`], [`mars::irradiance_vector`] | integral over the visible cap | oracles `marsshine` |
//! | parts of its lit disc, which terrain may hide | [`mars_points::lit_points`] | Lambert's law | [`mars::irradiance`] of tilted facets |
//! | directions that stand for its light on a model | [`mars_directions::Directions`] | Lobatto's quadrature over the lit part above the horizon | sums over patches of the sphere |
//! | the same, fast, for the facets of one scene | [`mars_light::MarsLight`] | E'' + E = great-circle integral | against [`mars::irradiance`] |
//! | (4), (6), (7), (8) | [`mars::thesis_irradiance`] | Domagala (2020), as printed | 0.06516322993 |
//! | bounds of Mars-light, interreflection, neighbours' heat, penumbra, the Sun at the horizon | [`bounds::mars_light`], [`bounds::interreflection`], [`bounds::neighbours_heat`], [`bounds::surroundings_form_factor`], [`bounds::penumbra_width_m`], [`bounds::terminator`] | set up here | full Mars; Ingersoll's bowl; flat ground; straight edge; flat horizon |
//! | what a point Sun, or points of its disc, miss at a shadow's edge | [`bounds::shadow_edge`] | set up here | a sharp edge |
//! | irradiance by the Sun's disc at a facet's horizon, and by its points | [`sun_disc::irradiance_on_facet`], [`sun_disc::SubSun`] | integral of the visible share | oracles `penumbra`; a disc that is up is a point |
//! | share of the Sun's disc beyond an edge, beside a disc | [`sun_disc::share_beyond_edge`], [`sun_disc::share_beside_disc`], [`sun_disc::share_beside_sphere`] | integrals | oracles `penumbra` |
//! | points that stand for the Sun's disc, and what they are off by behind an edge | [`sun_disc::DiscRule`] | Stroud (1971) | polynomials; all edges |
//! | eclipse | [`sun::eclipse`] | two discs | oracles `eclipse_by_mars_central_duration` |
//! | radiance of a reflectance factor, of a Lambert surface's exitance | [`reflectance::radiance_of_reflectance_factor`], [`reflectance::lambert_radiance`] | Nicodemus et al. (1977); Lambert | white surface; integral over the hemisphere |
//! | (2), (13): BRDF of any model | [`reflectance::Brdf`], [`reflectance::PhotometricAngles`] | Nicodemus et al. (1977) | reciprocity over 1e5 geometries |
//! | Lambert's, Lommel and Seeliger's, McEwen's, Minnaert's, Akimov's, RPV | [`reflectance::Lambert`], [`reflectance::LommelSeeliger`], [`reflectance::LunarLambert`], [`reflectance::Minnaert`], [`reflectance::Akimov`], [`reflectance::Rpv`] | each in its file | oracles `brdf` |
//! | Hapke's, rough, with both opposition effects | [`reflectance::Hapke`] | Hapke (1981, 1984, 2002, 2008) | oracles `brdf`, `hapke_parts` |
//! | Chandrasekhar's H, and Hapke's two | [`reflectance::hapke::HFormula`] | Chandrasekhar (1960); Stibbs & Weir (1959) | its integral equation; a white layer loses nothing |
//! | Hapke's at all wavelengths from a few w; its bound | [`reflectance::hapke::AlbedoNodes`], [`reflectance::hapke::interpolation_error`] | Chebyshev | no error above the bound |
//! | w from a reflectance | [`reflectance::hapke::Inverse`] | Dowell & Jarratt (1971) | a known w is found again |
//! | reflectance by tables (13) to (15) | [`reflectance::Table`] | Domagala (2020) | by hand |
//! | surfaces of Phobos, Deimos, the Moon and Mars; what their uncertain numbers are worth | [`reflectance::Preset`] | told with each | the geometric albedo of Phobos; single scattering |
//! | albedos, phase integral, emissivity by direction | [`reflectance::albedo`] | Hapke (2012); Kirchhoff | white surfaces; 1 - sqrt(1 - w) H |
//! | (17) to (19), (22): the scene as a camera at the Sun sees it | [`thesis_projection::SunCamera`] | Domagala (2020) | round trip; where it breaks |
//! | transfer of a detector's area, smear, jitter, a lens; an edge behind them | [`mtf`] | Fourier transforms; Goodman (2005) | oracles `mtf`, `psf` |
//! | electrons of a radiance and of a warm surrounding, their noise | [`signal::electrons_per_radiance`], [`signal::background_electrons_s`], [`signal::snr`] | Poisson; etendue of a cone | oracles `snr`; photons of a black body |
//! | sRGB to linear light and back | [`srgb::linear_from_hex`], [`srgb::hex_from_linear`] | IEC 61966-2-1 | mid grey; the straight part |
//!
//! Elsewhere, because they are geometry or sums: (11) to (13) in `solve::Emission`, (16) in `spectral::Band::in_band_w_m2_sr`,
//! (17) to (19) of the sensor in `geometry::FrameCamera`, a Lambert sphere's disc, with its phase, in `geometry::SphereImage`.

pub mod blackbody;
pub mod bounds;
pub mod conduction;
pub mod form_factor;
pub mod heat;
pub mod mars;
pub mod mars_directions;
pub mod mars_light;
pub mod mars_points;
pub mod mtf;
mod quadrature;
pub mod reflectance;
pub mod signal;
pub mod srgb;
pub mod sun;
pub mod sun_disc;
pub mod thesis_projection;

pub(crate) use quadrature::GaussLegendre;
