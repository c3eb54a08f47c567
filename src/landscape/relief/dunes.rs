//! Dunes: rows that rise slowly and fall steeply, with crests that wander.

use std::f64::consts::PI;

use crate::landscape::noise::{Form, Octaves, presence};

/// Rows of dunes.
#[derive(Debug, Clone)]
pub(in crate::landscape) struct Dunes {
    height_m: f64,
    wavelength_m: f64,
    /// Where the wind goes to: east and north.
    wind: [f64; 2],
    rise: f64,
    wander: f64,
    /// What crests wander by, in units of `wander`: of spread 1.
    octaves: Octaves,
}

/// How far from where its crests wander by a noise its heights are read, in wavelengths: far enough that the two have nothing in common.
const APART: f64 = 1000.5;

impl Dunes {
    pub(in crate::landscape) fn new(
        height_m: f64,
        wavelength_m: f64,
        towards_deg: f64,
        rise: f64,
        wander: f64,
        octaves: Octaves,
    ) -> Self {
        let (east, north) = towards_deg.to_radians().sin_cos();
        Dunes { height_m, wavelength_m, wind: [east, north], rise, wander, octaves }
    }

    /// Height, m, from half of the dunes' height below 0 to half above.
    ///
    /// Half a cosine over the part that rises, another over the part that falls: smooth, with the steepest slopes pi height / (2 part).
    pub(in crate::landscape) fn height_m(&self, x_m: f64, y_m: f64, step_m: f64) -> f64 {
        let share = presence(self.wavelength_m * self.rise.min(1.0 - self.rise) * 2.0, step_m);
        if share == 0.0 {
            return 0.0;
        }
        let noise = |x_m: f64, y_m: f64| match self.wander {
            0.0 => 0.0,
            wander => wander * self.octaves.height_m(Form::Rolling, x_m, y_m, step_m),
        };
        let along = (x_m * self.wind[0] + y_m * self.wind[1]) / self.wavelength_m + noise(x_m, y_m);
        let place = along - along.floor();
        let wave = match place < self.rise {
            true => -(PI * place / self.rise).cos(),
            false => (PI * (place - self.rise) / (1.0 - self.rise)).cos(),
        };
        // No dune is lower than 0 or twice as high.
        let apart_m = APART * self.wavelength_m;
        let height = (1.0 + noise(x_m + apart_m, y_m - apart_m)).clamp(0.0, 2.0);
        0.5 * self.height_m * share * height * wave
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dunes(wander: f64) -> Dunes {
        Dunes::new(6.0, 60.0, 90.0, 0.75, wander, Octaves::new(|k| k, 1.0, 240.0, 0.8, 1.0))
    }

    #[test]
    fn straight_dunes_rise_slowly_and_fall_steeply_downwind() {
        let dunes = dunes(0.0);
        let at = |x_m: f64| dunes.height_m(x_m, 17.0, 0.1);
        // Wind to the east: 45 m up, 15 m down.
        for (x_m, height_m) in
            [(0.0, -3.0), (22.5, 0.0), (45.0, 3.0), (52.5, 0.0), (60.0, -3.0), (105.0, 3.0), (-15.0, 3.0)]
        {
            assert!((at(x_m) - height_m).abs() < 1e-12, "{x_m}: {}", at(x_m));
        }
        // Steepest slopes: pi 6 / (2 45) and pi 6 / (2 15).
        let slope = |x_m: f64| (at(x_m + 1e-4) - at(x_m - 1e-4)) / 2e-4;
        assert!((slope(22.5) - PI * 6.0 / 90.0).abs() < 1e-6 && (slope(52.5) + PI * 6.0 / 30.0).abs() < 1e-6);
    }

    #[test]
    fn crests_wander_and_none_is_twice_as_high() {
        let dunes = dunes(0.5);
        let heights: Vec<f64> =
            (0..40_000).map(|i| dunes.height_m(f64::from(i % 200) * 7.0, f64::from(i / 200) * 7.0, 0.1)).collect();
        let highest = heights.iter().fold(0f64, |m, h| m.max(h.abs()));
        assert!(highest <= 6.0 && highest > 4.0, "{highest}");
        let differ = (0..50).filter(|i| dunes.height_m(30.0, f64::from(*i) * 40.0, 0.1) > 0.0).count();
        assert!((5..46).contains(&differ), "{differ}");
    }
}
