//! What a space camera sees of a small body: exact facet-to-pixel hyperspectral image simulation.
//!
//! Geometry is computed once, exactly and without wavelength; spectra are multiplied in afterwards.
//! A [`Scene`](scene::Scene) is solved ([`solve::solve`]: where each facet is lit, what reaches it, how warm it is) and
//! looked at ([`integrate::integrate`]: which facets each pixel sees, and the cube and backplanes that follow).
//! [`study::simulate`] does both; [`formats`] reads scenes and writes products; [`job`] does what a command does, from files to files; the command `mmxrt` is built on these.
//!
//! A tour: a plane, half of it in the shadow of a wall, seen from above.
//!
//! ```
//! use glam::{DMat3, DVec3};
//! use mmxrt::geometry::{Direction, FrameCamera, MaterialId, Mesh, Pose};
//! use mmxrt::progress::unwatched;
//! use mmxrt::scene::{Exposure, Material, Models, SceneParts, Photometry, Sky, Spectrometer, Sun, Surface, Thermal};
//! use mmxrt::spectral::{Band, Spectrum};
//! use mmxrt::units::AU_M;
//!
//! // Ground 2 x 2 m, and a wall along x = 0, 1 m high. Facets are counter-clockwise from outside: the wall faces +x.
//! let points = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, -1, 0], [0, 1, 0], [0, 1, 1], [0, -1, 1]];
//! let mesh = Mesh {
//!     vertices_m: points.map(|p| DVec3::from_array(p.map(f64::from))).to_vec(),
//!     facets: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
//!     material: vec![MaterialId(0); 4],
//!     face_of_facet: vec![0, 0, 1, 1],
//!     uv: vec![],
//! };
//! let grey = Material {
//!     name: "grey".into(),
//!     reflectance: Spectrum::constant(0.07),
//!     photometry: Photometry::Lambert,
//!     emissivity: Spectrum::constant(0.93),
//!     bond_albedo: 0.07,
//!     emissivity_bolometric: 0.95,
//!     thermal_inertia: 0.0,
//!     temperature_k: None,
//!     mixture: vec![(0, 1.0)],
//! };
//! // 4 x 4 pixels of 0.5 m from 1 km above: right is +x, down is -y.
//! let rotation = DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z);
//! let world_from_sensor = Pose { rotation, translation_m: DVec3::new(0.0, 0.0, 1000.0) };
//! let sun = Sun {
//!     direction: Direction::new(DVec3::new(1.0, 0.0, 1.0)).unwrap(),
//!     distance_m: 1.5 * AU_M,
//!     irradiance_1au: Spectrum::constant(700.0),
//!     total_irradiance_1au_w_m2: 1361.0,
//!     limb_darkening: 0.0,
//! };
//! let scene = SceneParts {
//!     surface: Surface { origin_m: DVec3::new(0.0, 0.0, 11_000.0), mesh, materials: vec![grey], textures: vec![] },
//!     sky: Sky { sun, mars: None, bodies: vec![], beams: vec![], rotation: None, past: None },
//!     models: Models { thermal: Thermal::Off, ..Models::default() },
//!     exposure: Exposure {
//!         instrument: "tour".into(),
//!         camera: FrameCamera::centred(world_from_sensor, 4, 4, 5e-4),
//!         bands: vec![Band::new(1.0, None)],
//!         spectrometer: Spectrometer::default(),
//!     },
//! }
//! .check()?;
//! let (table, seen) = mmxrt::study::simulate(&scene, &unwatched)?;
//!
//! // The wall's shadow reaches 1 m to the west (x < 0): half of either triangle of the ground.
//! let sunlit = table.sunlit().unwrap();
//! assert!((sunlit.fraction(0) + sunlit.fraction(1) - 1.0).abs() < 1e-12);
//! // L = reflectance / pi x irradiance x cos 45 deg in the east, nothing in the west.
//! let lit = 0.07 / std::f64::consts::PI * 700.0 / 1.5_f64.powi(2) * 0.5_f64.sqrt();
//! let radiance = seen.cube.band(0);
//! assert_eq!(radiance[4], 0.0);
//! assert!((radiance[7] / lit - 1.0).abs() < 1e-12);
//! # Ok::<(), mmxrt::Error>(())
//! ```

// Small numbers of cases fit any type.
#![cfg_attr(test, allow(clippy::cast_possible_truncation))]

// Lowest layer first: a module uses only those above it in this list (tests/it/layers.rs).
pub mod error;
pub mod progress;
pub mod report;
pub mod units;
pub mod random;
pub mod geometry;
pub mod flight;
pub mod visibility;
pub mod spectral;
pub mod physics;
pub mod instrument;
pub mod scene;
pub mod landscape;
pub mod product;
pub mod solve;
pub mod integrate;
pub mod study;
pub mod formats;
pub mod job;

pub use error::{Error, Location, Problem, Result};
