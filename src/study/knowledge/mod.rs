//! Geolocation error budget from uncertain pointing, orbit, clock, focal length and shape.
//!
//! The true ground point of a pixel is what [`Locator`](super::locate::Locator) finds. The believed one is where the
//! same pixel's ray meets the believed surface from the believed state (clock, position, attitude, focal length). An
//! error is believed minus true.
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

/// Sources of error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Attitude.
    Attitude,
    /// Position.
    Position,
    /// Clock.
    Clock,
    /// Focal length.
    FocalLength,
    /// Height of the surface.
    Height,
    /// Shape.
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

/// Deviation of a believed state from the true one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Rotation about the sensor's axes x, y, z, right-handed, rad.
    pub attitude_rad: DVec3,
    /// Displacement along the axes chosen for positions, m.
    pub position_m: DVec3,
    /// Clock, s, positive if late.
    pub clock_s: f64,
    /// Focal length, relative, positive if long.
    pub focal_length: f64,
    /// Height, positive if high, along the radius through the pixel's true point, m.
    pub height_m: f64,
}

impl Deviation {
    /// Sum of two.
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

    /// Negated.
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

    /// The part due to one source.
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

/// Axes of position errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PositionAxes {
    /// Along-track over the rotating body, cross-track (radial x along), and radial.
    #[default]
    Track,
    /// Body axes.
    Body,
}

/// Scatter: factors L of covariances L L^T.
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

/// Biases and scatter of all sources.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Knowledge {
    /// Mean belief minus truth.
    pub bias: Deviation,
    /// Scatter about that; sources are independent.
    pub scatter: Scatter,
    /// Axes of position errors.
    pub axes: PositionAxes,
    /// The believed surface, local to the scene's origin, m; `None`: the true one.
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

    /// Sources with a stated bias, scatter or mesh.
    pub fn sources(&self) -> Vec<Source> {
        let is_stated = |source: &Source| match source {
            Source::Mesh => self.mesh.is_some(),
            _ => self.bias.of(*source) != Deviation::default() || !self.columns(*source).is_empty(),
        };
        Source::ALL.into_iter().filter(is_stated).collect()
    }

    /// A random believed state: always nine normal numbers, so that a source keeps its own when others are added.
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

/// Options of a budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Asked {
    /// The band, counted from 0.
    pub band: usize,
    /// Every so many pixels in either direction: 1 is all.
    pub every: u32,
    /// Number of draws; 0: none.
    pub draws: u32,
    /// Seed.
    pub seed: u64,
}

/// Elements of a covariance that should be the same differ by this at most, over the standard deviations of their rows: the digits of a file.
const WRITTEN: f64 = 1e-5;

/// The Cholesky factor L of a covariance L L^T, rows first; the covariance may be singular. `None` if it is not
/// symmetric, or negative by more than rounding.
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
