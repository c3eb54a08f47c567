//! Poses of cameras as other programs print them: matrices, by the axes that each of them means, and rotations in few digits.

use glam::{DMat3, DVec3};

use super::types::ConventionToml;
use super::{ROUNDED, TomlReader, UNIT_TOLERANCE};

/// A scale that differs from 1 by less is single precision's.
const SCALED: f64 = 1e-6;

impl ConventionToml {
    /// The sensor's axes (right, down, ahead) in the camera's.
    fn camera_from_sensor(self) -> DMat3 {
        let [x, y, z] = match self {
            // x right, y down, z ahead.
            ConventionToml::Opencv => [1.0, 1.0, 1.0],
            // x right, y up, z backwards.
            ConventionToml::Opengl | ConventionToml::Blender => [1.0, -1.0, -1.0],
            // x left, y up, z ahead.
            ConventionToml::Mitsuba => [-1.0, -1.0, 1.0],
        };
        DMat3::from_diagonal(DVec3::new(x, y, z))
    }
}

/// The rotation that is meant by a matrix of rounded numbers, and by how much its elements are off. The third axis keeps its direction.
/// `None` if it has no inverse, or is a mirror image.
pub(in crate::formats) fn rotation_near(m: DMat3) -> Option<(DMat3, f64)> {
    if m.determinant().is_nan() || m.determinant() <= 0.0 {
        return None;
    }
    let z = m.z_axis.normalize();
    let x = (m.x_axis - z * z.dot(m.x_axis)).normalize();
    let rotation = DMat3::from_cols(x, z.cross(x), z);
    let off = (0..3).map(|k| (m.col(k) - rotation.col(k)).abs().max_element()).fold(0.0, f64::max);
    (rotation.is_finite() && off.is_finite()).then_some((rotation, off))
}

/// Why axes of length 1, the columns, are those of no camera.
pub(super) fn no_rotation(axes: DMat3) -> String {
    match rotation_near(axes) {
        Some((_, off)) => {
            format!("axes are not at right angles: {off:.1e} off, and more than {ROUNDED} is not rounding")
        }
        None if axes.determinant() < 0.0 => "axes are left-handed: a mirror image".to_owned(),
        None => "axes lie in one plane".to_owned(),
    }
}

impl TomlReader<'_> {
    /// A rotation from rounded numbers, made exact and reported; `None`, without a report, if it is not a rotation.
    pub(in crate::formats) fn unrounded(&mut self, item: &str, m: DMat3) -> Option<DMat3> {
        match rotation_near(m) {
            Some((_, off)) if off <= UNIT_TOLERANCE => Some(m),
            Some((rotation, off)) if off <= ROUNDED => {
                self.notes.push(format!(
                    "{item}: axes are rounded, and {off:.1e} off axes of length 1 at right angles: they are made such, and the line of \
                     sight stays"
                ));
                Some(rotation)
            }
            _ => None,
        }
    }

    /// Sensor axes and projection centre, m, of a camera's pose as a 4 x 4 matrix.
    pub(super) fn camera_to_world(
        &mut self,
        rows: &[[f64; 4]; 4],
        convention: Option<ConventionToml>,
    ) -> Option<(DMat3, DVec3)> {
        let item = "observer.camera_to_world";
        let Some(convention) = convention else {
            self.helped(
                "observer.convention",
                "is missing: a matrix does not say which way a camera looks",
                "\"opencv\" looks along +z with y down, \"opengl\" and \"blender\" along -z with y up, \"mitsuba\" along +z with y up",
            );
            return None;
        };
        let last = rows[3];
        if last != [0.0, 0.0, 0.0, 1.0] {
            let is_transposed = (0..3).all(|i| rows[i][3] == 0.0) && last[3] == 1.0;
            let help = if is_transposed {
                "the position is in the last row: exchange rows and columns"
            } else {
                "each of its four rows has the x, y, z axes' component and the position's; the last is 0, 0, 0, 1"
            };
            self.helped(item, format!("has the last row {last:?}, which is [0, 0, 0, 1]"), help);
            return None;
        }
        let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
        let axes = DMat3::from_cols(column(0), column(1), column(2));
        let lengths = [0, 1, 2].map(|k| axes.col(k).length());
        let [least, most] = [f64::min, f64::max].map(|of| lengths.into_iter().reduce(of).unwrap_or_default());
        if !(least > 0.0 && most / least - 1.0 <= ROUNDED) {
            self.problem(item, format!("its axes have the lengths {lengths:?}: those of a camera are alike"));
            return None;
        }
        if (most - 1.0).abs() > SCALED {
            self.notes.push(format!("{item}: a scale of {most}, which means nothing for a camera, is left out"));
        }
        let unit = DMat3::from_cols(axes.x_axis.normalize(), axes.y_axis.normalize(), axes.z_axis.normalize());
        let Some(rotation) = self.unrounded(item, unit) else {
            self.problem(item, no_rotation(unit));
            return None;
        };
        Some((rotation * convention.camera_from_sensor(), column(3)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_of_few_digits_are_made_rotations() {
        let exact = DMat3::from_rotation_y(0.3) * DMat3::from_rotation_x(1.1);
        let rounded = DMat3::from_cols_array(&exact.to_cols_array().map(|x| (x * 1e7).round() / 1e7));
        let (rotation, off) = rotation_near(rounded).unwrap();
        assert!(
            off < 2e-7
                && (rotation.transpose() * rotation - DMat3::IDENTITY).to_cols_array().iter().all(|x| x.abs() < 1e-15)
        );
        assert!(rotation_near(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))).is_none());
        assert!(rotation_near(DMat3::ZERO).is_none());
        assert!(rotation_near(DMat3::from_diagonal(DVec3::new(1.0, f64::NAN, 1.0))).is_none());
    }
}
