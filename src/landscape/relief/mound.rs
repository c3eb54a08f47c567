//! One big structure with a flat top and steep flanks, around a line.

use crate::landscape::noise::{Form, Octaves, presence, smooth_step};

/// A mound, or a hollow.
#[derive(Debug, Clone)]
pub(in crate::landscape) struct Mound {
    centre_m: [f64; 2],
    height_m: f64,
    flank_m: f64,
    half_length_m: f64,
    /// Where its line points to: east and north.
    along: [f64; 2],
    top_m: f64,
    /// What its flanks are ragged by, in widths of a flank.
    octaves: Octaves,
}

/// Width of a flank, m, whose steepest slope is this: it falls as 3 t^2 - 2 t^3, half as steep again as on average.
pub(in crate::landscape) fn flank_m(height_m: f64, flank_deg: f64) -> f64 {
    1.5 * height_m.abs() / flank_deg.to_radians().tan()
}

impl Mound {
    pub(in crate::landscape) fn new(
        centre_m: [f64; 2],
        height_m: f64,
        flank_m: f64,
        length_m: f64,
        along_deg: f64,
        top_m: f64,
        octaves: Octaves,
    ) -> Self {
        let (east, north) = along_deg.to_radians().sin_cos();
        Mound { centre_m, height_m, flank_m, half_length_m: 0.5 * length_m, along: [east, north], top_m, octaves }
    }

    /// Height over the ground, m.
    pub(in crate::landscape) fn height_m(&self, x_m: f64, y_m: f64, step_m: f64) -> f64 {
        let [dx_m, dy_m] = [x_m - self.centre_m[0], y_m - self.centre_m[1]];
        let along_m = dx_m * self.along[0] + dy_m * self.along[1];
        let across_m = dx_m * self.along[1] - dy_m * self.along[0];
        let beyond_m = (along_m.abs() - self.half_length_m).max(0.0);
        let distance_m = beyond_m.hypot(across_m) - self.top_m;
        // Of no height it has no flank, and is nowhere.
        if self.height_m == 0.0 {
            return 0.0;
        }
        let outward = distance_m / self.flank_m + self.octaves.height_m(Form::Rolling, x_m, y_m, step_m);
        let t = (1.0 - outward).clamp(0.0, 1.0);
        presence(2.0 * (self.flank_m + self.top_m), step_m) * self.height_m * smooth_step(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesa_has_its_height_its_flanks_and_its_place() {
        // 100 m high, flanks of 45 deg at the steepest: 150 m wide. A line of 400 m to the north-east, a top of 50 m around it.
        let flank_m = flank_m(100.0, 45.0);
        assert!((flank_m - 150.0).abs() < 1e-9);
        let mesa = Mound::new([10.0, 20.0], 100.0, flank_m, 400.0, 45.0, 50.0, Octaves::new(|k| k, 0.0, 1.0, 1.0, 1.0));
        let at = |along_m: f64, across_m: f64| {
            let (s, c) = std::f64::consts::FRAC_PI_4.sin_cos();
            mesa.height_m(10.0 + along_m * s + across_m * c, 20.0 + along_m * c - across_m * s, 1.0)
        };
        for (along_m, across_m, height_m) in [
            (0.0, 0.0, 100.0),
            (-200.0, 49.0, 100.0),
            (249.0, 0.0, 100.0),
            (0.0, 125.0, 50.0),
            (325.0, 0.0, 50.0),
            (0.0, -200.0, 0.0),
            (0.0, 201.0, 0.0),
        ] {
            assert!((at(along_m, across_m) - height_m).abs() < 1e-9, "{along_m} {across_m}: {}", at(along_m, across_m));
        }
        let slope = (at(0.0, 125.0 + 1e-3) - at(0.0, 125.0 - 1e-3)) / 2e-3;
        assert!((slope + 1.0).abs() < 1e-6, "{slope}");
    }
}
