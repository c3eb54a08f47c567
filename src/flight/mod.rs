//! Flight dynamics: positions and orientations over time.
//!
//! Positions, velocities and rotations come from files, rotation models or equations of motion; all become a
//! [`Trajectory`] of one object relative to another or an [`Orientation`] of one frame relative to another, each with
//! its coverage. An [`Almanac`] joins them. Nothing is extrapolated: a request outside the coverage is an error that
//! says where the data end.
//!
//! # Index
//!
//! | equation | function | source | test |
//! |---|---|---|---|
//! | UTC, TAI, TT, TDB, GPS | [`Epoch`] | leap seconds of IERS bulletin C; TDB as in NAIF's leapseconds kernel | oracles `time` |
//! | Lagrange and Hermite interpolation | [`interpolation`] | Neville's scheme on repeated nodes | polynomials |
//! | Chebyshev series and their derivatives | [`Chebyshev`] | Clenshaw | oracles `spk` |
//! | rotations between two | [`Orientation`] | great arcs of unit quaternions | a steady turn |
//! | rotation of Mars, Phobos, Deimos | [`RotationModel`] | Archinal et al. (2018) | oracles `iau` |
//! | Hill's problem, quasi-satellite orbits | [`Hill`] | Hill (1878) | oracles `qso`; Jacobi's constant; a circle without the body |
//! | Mars about the Sun, roughly | [`Elements`] | Standish & Williams | kernels |
//! | sizes of bodies, and heights above them | [`altitude_m`] | NAIF's kernel pck00011 | an ellipsoid's axes |
//! | light time and aberration | [`Almanac::apparent`] | Explanatory Supplement (2013), 7.2 | oracles `spice` |

mod almanac;
mod chebyshev;
mod epoch;
mod hill;
pub mod interpolation;
mod kepler;
mod mars_system;
mod names;
mod orientation;
mod pointing;
mod pool;
mod qso;
mod radii;
mod rotation_model;
mod trajectory;
mod unread;

pub use almanac::{Almanac, Correction};
pub use chebyshev::Chebyshev;
pub(crate) use epoch::calendar_s;
pub use epoch::{Epoch, LeapSeconds, Scale};
pub use hill::{Hill, Orbit, PHOBOS_GM_M3_S2, PHOBOS_MEAN_MOTION_RAD_S, QuasiSatellite};
pub use kepler::Elements;
pub use names::{Names, body_id, body_name, frame_name};
pub use orientation::{Attitudes, Between, Orientation, Spin, Turn, Turning};
pub use pointing::{Aim, Circumstances, Jitter, Pointing, Scan, Up};
pub(crate) use pool::whole;
pub use pool::{Pool, Values, Variable};
pub use qso::Qso;
pub use radii::{altitude_m, radii_m};
pub use rotation_model::{Angle, RotationModel};
pub use trajectory::{Interpolation, Nodes, Path, Segment, Span, State, Trajectory};
pub use unread::Unread;

/// The inertial frame that all others refer to: J2000, which SPICE identifies with the ICRF.
pub const J2000: &str = "J2000";
/// The ecliptic at J2000.
pub const ECLIPTIC: &str = "ECLIPJ2000";
