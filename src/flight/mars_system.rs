//! Mars, Phobos and Deimos: approximate positions, and rotations by the IAU working group (Archinal et al. 2018), with
//! the constants of NAIF's kernel pck00011.

use glam::DVec3;

use super::kepler::Elements;
use super::rotation_model::{Angle, RotationModel};
use super::trajectory::{Path, Segment, Span, Trajectory};
use super::{ECLIPTIC, Epoch};
use crate::units::{DAY_S, PHOBOS_ORBIT_M};

/// Semi-major axis of Deimos' orbit, m.
const DEIMOS_ORBIT_M: f64 = 23_458_000.0;

/// Approximate trajectories for scenes without ephemerides: Mars about the Sun within 40 arcsec (1800 to 2050), its
/// moons about Mars on circles, along their long axes: Phobos within 3 deg, by which its long axis swings about the
/// direction of Mars.
pub(super) fn roughly() -> Vec<Trajectory> {
    let trajectory = |target: &str, centre: &str, frame: &str, years: Option<[f64; 2]>, path: Path| {
        let year = |year: f64| Epoch::J2000.after_s((year - 2000.0) * 365.25 * DAY_S);
        let span = match years {
            Some([first, last]) => Span { start: year(first), end: year(last) },
            None => Span { start: Epoch::FIRST, end: Epoch::LAST },
        };
        Trajectory {
            target: target.to_owned(),
            centre: centre.to_owned(),
            frame: frame.to_owned(),
            source: "mean elements".to_owned(),
            segments: vec![Segment { span, path }],
        }
    };
    let moon = |name: &str, orbit_m: f64| {
        trajectory(name, "MARS", &format!("IAU_{name}"), None, Path::Fixed(DVec3::new(-orbit_m, 0.0, 0.0)))
    };
    vec![
        trajectory("MARS", "SUN", ECLIPTIC, Some([1800.0, 2050.0]), Path::Elements(Elements::MARS)),
        moon("PHOBOS", PHOBOS_ORBIT_M),
        moon("DEIMOS", DEIMOS_ORBIT_M),
    ]
}

/// Periodic angles of all three: deg, deg per century, deg per century^2 (Phobos, whose orbit shrinks).
#[rustfmt::skip]
const PHASES: [[f64; 3]; 26] = [
    [190.72646643, 15917.10818695, 0.0],
    [21.4689247, 31834.27934054, 0.0],
    [332.86082793, 19139.89694742, 0.0],
    [394.93256437, 38280.79631835, 0.0],
    [189.6327156, 41215158.1842005, 12.711923222],
    [121.46893664, 660.22803474, 0.0],
    [231.05028581, 660.9912354, 0.0],
    [251.37314025, 1320.50145245, 0.0],
    [217.98635955, 38279.9612555, 0.0],
    [196.19729402, 19139.83628608, 0.0],
    [198.991226, 19139.4819985, 0.0],
    [226.292679, 38280.8511281, 0.0],
    [249.663391, 57420.7251593, 0.0],
    [266.18351, 76560.636795, 0.0],
    [79.398797, 0.5042615, 0.0],
    [122.433576, 19139.9407476, 0.0],
    [43.058401, 38280.8753272, 0.0],
    [57.663379, 57420.7517205, 0.0],
    [79.476401, 76560.6495004, 0.0],
    [166.325722, 0.5042615, 0.0],
    [129.071773, 19140.0328244, 0.0],
    [36.352167, 38281.0473591, 0.0],
    [56.668646, 57420.929536, 0.0],
    [67.364003, 76560.2552215, 0.0],
    [104.79268, 95700.4387578, 0.0],
    [95.391654, 0.5042615, 0.0],
];

/// An angle from its polynomial and its (number of a phase, amplitude).
fn angle(polynomial: [f64; 3], terms: &[(usize, f64)]) -> Angle {
    let mut periodic = vec![0.0; terms.last().map_or(0, |(last, _)| last + 1)];
    terms.iter().for_each(|(phase, amplitude)| periodic[*phase] = *amplitude);
    Angle { polynomial: polynomial.to_vec(), periodic }
}

/// The model of a body of the Mars system.
#[rustfmt::skip]
pub(super) fn rotation_model(body: &str) -> Option<RotationModel> {
    let [right_ascension, declination, prime_meridian] = match body {
        "MARS" => [
            angle([317.269202, -0.10927547, 0.0], &[(10, 6.8e-05), (11, 0.000238), (12, 5.2e-05), (13, 9e-06), (14, 0.419057)]),
            angle([54.432516, -0.05827105, 0.0], &[(15, 5.1e-05), (16, 0.000141), (17, 3.1e-05), (18, 5e-06), (19, 1.591274)]),
            angle([176.049863, 350.891982443297, 0.0], &[(20, 0.000145), (21, 0.000157), (22, 4e-05), (23, 1e-06), (24, 1e-06), (25, 0.584542)]),
        ],
        "PHOBOS" => [
            angle([317.67071657, -0.10844326, 0.0], &[(0, -1.78428399), (1, 0.02212824), (2, -0.01028251), (3, -0.00475595)]),
            angle([52.88627266, -0.06134706, 0.0], &[(0, -1.07516537), (1, 0.00668626), (2, -0.0064874), (3, 0.00281576)]),
            angle([35.1877444, 1128.84475928, 9.536137031212154e-09], &[(0, 1.42421769), (1, -0.02273783), (2, 0.00410711), (3, 0.00631964), (4, -1.143)]),
        ],
        "DEIMOS" => [
            angle([316.65705808, -0.10518014, 0.0], &[(5, 3.09217726), (6, 0.22980637), (7, 0.06418655), (8, 0.02533537), (9, 0.00778695)]),
            angle([53.50992033, -0.05979094, 0.0], &[(5, 1.83936004), (6, 0.1432532), (7, 0.01911409), (8, -0.0148259), (9, 0.0019243)]),
            angle([79.39932954, 285.16188899, 0.0], &[(5, -2.73954829), (6, -0.39968606), (7, -0.06563259), (8, -0.0291294), (9, 0.0169916)]),
        ],
        _ => return None,
    };
    Some(RotationModel { right_ascension, declination, prime_meridian, phases: PHASES.map(|of| of.to_vec()).to_vec() })
}
