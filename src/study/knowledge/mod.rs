//! How far off a pixel is placed by someone who knows pointing, orbit, clock, lens and shape only so well.
//!
//! The true place of a pixel is what [`Locator`](super::locate::Locator) says. The believed one is where the same pixel's ray meets the believed surface, from the
//! believed state: that of the moment that the clock says, moved, turned and with the focal length as they are believed. An error is believed minus true.
//!
//! | what is wrong | moves the ground point, on level ground seen at emission e from a distance R, by |
//! |---|---|
//! | attitude by d, rad | R d / cos e along the plane of emission, R d across |
//! | position by d | d, plus its part along the ground's normal times tan e |
//! | clock by dt | the velocity of the pixel over the ground times dt |
//! | focal length by f | the way from the boresight's point times -f / (1 + f) |
//! | height by h | h tan e towards the camera, and h upwards |

mod budget;
mod drawn;
mod sight;
mod summary;

use glam::{DMat3, DVec3};

use crate::geometry::Mesh;
use crate::random::Draws;

pub use budget::{Budget, Part, PixelBudget, budget};
pub use drawn::Sampled;
pub use summary::{Row, Spread, summary};

/// What may be known wrongly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// How the sensor is turned.
    Attitude,
    /// Where it is.
    Position,
    /// When it looks.
    Clock,
    /// How long its focal length is.
    FocalLength,
    /// How high the surface is.
    Height,
    /// Which shape it has.
    Mesh,
}

impl Source {
    /// All of them.
    pub const ALL: [Source; 6] =
        [Source::Attitude, Source::Position, Source::Clock, Source::FocalLength, Source::Height, Source::Mesh];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Source::Attitude => "attitude",
            Source::Position => "position",
            Source::Clock => "clock",
            Source::FocalLength => "focal_length",
            Source::Height => "height",
            Source::Mesh => "mesh",
        }
    }
}

/// By how much a believed state differs from the true one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// A turn about the sensor's axes x, y, z, by the right hand, rad.
    pub attitude_rad: DVec3,
    /// A way along the axes that the positions are stated in, m.
    pub position_m: DVec3,
    /// Later than it is, s.
    pub clock_s: f64,
    /// Longer than it is, relative.
    pub focal_length: f64,
    /// Higher than it is, along the radius through the pixel's true point, m.
    pub height_m: f64,
}

impl Deviation {
    /// One after the other.
    #[must_use]
    fn and(self, other: Deviation) -> Self {
        Deviation {
            attitude_rad: self.attitude_rad + other.attitude_rad,
            position_m: self.position_m + other.position_m,
            clock_s: self.clock_s + other.clock_s,
            focal_length: self.focal_length + other.focal_length,
            height_m: self.height_m + other.height_m,
        }
    }

    /// The other way.
    #[must_use]
    fn reversed(self) -> Self {
        Deviation {
            attitude_rad: -self.attitude_rad,
            position_m: -self.position_m,
            clock_s: -self.clock_s,
            focal_length: -self.focal_length,
            height_m: -self.height_m,
        }
    }

    /// What of it is one source's.
    #[must_use]
    fn of(self, source: Source) -> Self {
        let nothing = Deviation::default();
        match source {
            Source::Attitude => Deviation { attitude_rad: self.attitude_rad, ..nothing },
            Source::Position => Deviation { position_m: self.position_m, ..nothing },
            Source::Clock => Deviation { clock_s: self.clock_s, ..nothing },
            Source::FocalLength => Deviation { focal_length: self.focal_length, ..nothing },
            Source::Height => Deviation { height_m: self.height_m, ..nothing },
            Source::Mesh => nothing,
        }
    }
}

/// The axes that an error of position is stated in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PositionAxes {
    /// Along the way over the turning body, across it (radial x along), and away from the body's centre.
    #[default]
    Track,
    /// The body's.
    Body,
}

/// How much numbers scatter: factors L of covariances L L^T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Of the attitude, rad.
    pub attitude_rad: DMat3,
    /// Of the position, m.
    pub position_m: DMat3,
    /// Standard deviation of the clock, s.
    pub clock_s: f64,
    /// Of the focal length, relative.
    pub focal_length: f64,
    /// Of the height, m.
    pub height_m: f64,
}

impl Default for Scatter {
    /// Not at all.
    fn default() -> Self {
        Scatter { attitude_rad: DMat3::ZERO, position_m: DMat3::ZERO, clock_s: 0.0, focal_length: 0.0, height_m: 0.0 }
    }
}

/// What is believed, and how well.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Knowledge {
    /// The mean of what is believed, minus what is true.
    pub bias: Deviation,
    /// How it scatters about that; sources are independent of each other.
    pub scatter: Scatter,
    /// The axes of errors of position.
    pub axes: PositionAxes,
    /// The surface that is believed to be there, local to the scene's origin, m; `None`: the true one.
    pub mesh: Option<Mesh>,
}

impl Knowledge {
    /// Deviations by one standard deviation along each independent direction of a source.
    fn columns(&self, source: Source) -> Vec<Deviation> {
        let nothing = Deviation::default();
        let Scatter { attitude_rad, position_m, clock_s, focal_length, height_m } = self.scatter;
        let axes = |m: DMat3| [m.x_axis, m.y_axis, m.z_axis];
        let all = match source {
            Source::Attitude => axes(attitude_rad).map(|attitude_rad| Deviation { attitude_rad, ..nothing }).to_vec(),
            Source::Position => axes(position_m).map(|position_m| Deviation { position_m, ..nothing }).to_vec(),
            Source::Clock => vec![Deviation { clock_s, ..nothing }],
            Source::FocalLength => vec![Deviation { focal_length, ..nothing }],
            Source::Height => vec![Deviation { height_m, ..nothing }],
            Source::Mesh => vec![],
        };
        all.into_iter().filter(|column| *column != nothing).collect()
    }

    /// What is stated of: a source without a bias, a scatter or a mesh has no errors.
    pub fn sources(&self) -> Vec<Source> {
        let is_stated = |source: &Source| match source {
            Source::Mesh => self.mesh.is_some(),
            _ => self.bias.of(*source) != Deviation::default() || !self.columns(*source).is_empty(),
        };
        Source::ALL.into_iter().filter(is_stated).collect()
    }

    /// One of the states that may be believed: nine normal numbers, whatever is stated, so that a source keeps its own when others are added.
    fn drawn(&self, draws: &mut Draws) -> Deviation {
        let mut three = || DVec3::from_array([0; 3].map(|_| draws.normal()));
        let (attitude, position, others) = (three(), three(), three());
        self.bias.and(Deviation {
            attitude_rad: self.scatter.attitude_rad * attitude,
            position_m: self.scatter.position_m * position,
            clock_s: self.scatter.clock_s * others.x,
            focal_length: self.scatter.focal_length * others.y,
            height_m: self.scatter.height_m * others.z,
        })
    }
}

/// What a budget is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Asked {
    /// The band, counted from 0.
    pub band: usize,
    /// One pixel of so many in either direction: 1 is all.
    pub every: u32,
    /// So many draws; 0: none.
    pub draws: u32,
    /// The same seed, the same draws.
    pub seed: u64,
}

/// Elements of a covariance that should be the same differ by this at most, over the standard deviations of their rows: the digits of a file.
const WRITTEN: f64 = 1e-5;

/// The factor L of a covariance L L^T, rows first, by Cholesky; of one that has no extent in some direction too. `None` if it is no covariance: not symmetric, or
/// negative somewhere, by more than rounding.
pub fn factor(covariance: [[f64; 3]; 3]) -> Option<DMat3> {
    // Files hold six digits or more; what is meant lies between the two.
    let half = |i: usize, j: usize| 0.5 * (covariance[i][j] + covariance[j][i]);
    let c: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| half(i, j)));
    // Of an element, by the diagonal.
    let size = |i: usize, j: usize| (c[i][i] * c[j][j]).abs().sqrt();
    let is_symmetric =
        (0..3).all(|i| (0..3).all(|j| (covariance[i][j] - covariance[j][i]).abs() <= WRITTEN * size(i, j)));
    if !is_symmetric || !c.as_flattened().iter().all(|x| x.is_finite()) {
        return None;
    }
    let rounding = |i: usize, j: usize| 64.0 * f64::EPSILON * size(i, j);
    let mut l = [[0.0_f64; 3]; 3];
    for j in 0..3 {
        let left = |i: usize, l: &[[f64; 3]; 3]| c[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
        let pivot = left(j, &l);
        if pivot < -rounding(j, j) {
            return None;
        }
        let has_extent = pivot > rounding(j, j);
        for i in j..3 {
            let rest = left(i, &l);
            l[i][j] = match has_extent {
                true => rest / pivot.sqrt(),
                false if rest.abs() <= rounding(i, j) => 0.0,
                false => return None,
            };
        }
    }
    Some(DMat3::from_cols_array_2d(&l).transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covariances_have_factors() {
        // By hand: [[4, 2, 0], [2, 5, 3], [0, 3, 10]] = L L^T with rows (2), (1, 2), (0, 1.5, sqrt(7.75)).
        let l = factor([[4.0, 2.0, 0.0], [2.0, 5.0, 3.0], [0.0, 3.0, 10.0]]).unwrap();
        let rows = [DVec3::new(2.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 0.0), DVec3::new(0.0, 1.5, 7.75_f64.sqrt())];
        (0..3).for_each(|i| assert!((l.row(i) - rows[i]).length() < 1e-14, "{l:?}"));
        // Fully dependent numbers, and none at all.
        let l = factor([[1.0, -2.0, 0.0], [-2.0, 4.0, 0.0], [0.0; 3]]).unwrap();
        assert_eq!(l.row(1), DVec3::new(-2.0, 0.0, 0.0));
        // Six digits in a file: the mean of both is meant.
        let l = factor([[4.0, 2.000_02, 0.0], [1.999_98, 5.0, 3.0], [0.0, 3.0, 10.0]]).unwrap();
        assert!(
            (l * l.transpose() - DMat3::from_cols_array(&[4.0, 2.0, 0.0, 2.0, 5.0, 3.0, 0.0, 3.0, 10.0]))
                .abs_diff_eq(DMat3::ZERO, 1e-12)
        );
        assert_eq!(factor([[4.0, 2.0, 0.0], [1.99, 5.0, 3.0], [0.0, 3.0, 10.0]]), None);
        assert_eq!(factor([[0.0; 3]; 3]), Some(DMat3::ZERO));
        for no_covariance in [
            [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ] {
            assert_eq!(factor(no_covariance), None, "{no_covariance:?}");
        }
    }
}
