//! What in rows of flight dynamics is rather a mistake than meant: rows far apart, over which polynomials go anywhere, and velocities that are not those of
//! the positions. It is read as it stands all the same.

use glam::DVec3;

use super::flight_file::{FlightFile, time_text};
use crate::error::number;
use crate::flight::{Between, Epoch, LeapSeconds, Nodes, Path, Turning};

/// A step so many times as long as most of its segment is told.
const UNEVEN: f64 = 10.0;
/// Speeds and ways so far apart are told: units differ by a thousand, and what moves unevenly does not by this much.
const APART: f64 = 30.0;
/// Between rows whose velocities enclose more than 60 deg, by its cosine, the way is no measure of the speed.
const STRAIGHT: f64 = 0.5;
/// So many steps at least have a median worth telling.
const FEW: usize = 3;

/// What is doubtful in a file, a sentence each.
pub fn doubts(file: &FlightFile) -> Vec<String> {
    let time = |tdb_s: f64| {
        Epoch::from_tdb_s(tdb_s).map_or_else(String::new, |epoch| {
            format!("{} {}", time_text(epoch, file.scale, &LeapSeconds::default()), file.scale.name())
        })
    };
    let mut all = Vec::new();
    for (_, trajectory) in &file.trajectories {
        let nodes: Vec<&Nodes> = trajectory
            .segments
            .iter()
            .filter_map(|segment| if let Path::Nodes(nodes) = &segment.path { Some(nodes) } else { None })
            .collect();
        let rows: Vec<&[f64]> = nodes.iter().map(|nodes| &nodes.tdb_s[..]).collect();
        all.extend(uneven(&rows, &trajectory.target, time));
        let wrong =
            nodes.iter().find_map(|nodes| speed_over_way(nodes).filter(|of| !(1.0 / APART..APART).contains(of)));
        all.extend(wrong.map(|times| {
            format!(
                "{}: velocities are {} times what positions change by: is one of them in another unit than it says?",
                trajectory.target,
                number(two_digits(times))
            )
        }));
    }
    for (_, orientation) in &file.orientations {
        let rows: Vec<&[f64]> = orientation
            .turns
            .iter()
            .filter_map(|turn| match &turn.turning {
                // What holds until the next is known in between.
                Turning::Attitudes(of) if of.between != Between::Steps => Some(&of.tdb_s[..]),
                _ => None,
            })
            .collect();
        all.extend(uneven(&rows, &orientation.frame, time));
    }
    all
}

/// Says that some steps between the rows of segments are far longer than most of their segment, and which is the longest.
fn uneven(segments: &[&[f64]], of: &str, time: impl Fn(f64) -> String) -> Option<String> {
    let (mut count, mut worst) = (0, [0.0; 3]);
    for tdb_s in segments {
        let steps = || tdb_s.windows(2).map(|two| two[1] - two[0]);
        let mut sorted: Vec<f64> = steps().collect();
        sorted.sort_by(f64::total_cmp);
        // Of two steps the shorter one.
        let Some(most_s) = sorted.get(sorted.len().saturating_sub(1) / 2).copied() else { continue };
        for (step_s, after) in steps().zip(*tdb_s).filter(|(step_s, _)| *step_s > UNEVEN * most_s) {
            count += 1;
            if step_s > worst[0] {
                worst = [step_s, most_s, *after];
            }
        }
    }
    let [step_s, most_s, after] = worst;
    let also = if count > 1 { format!(", and {} more such steps", count - 1) } else { String::new() };
    (count > 0).then(|| {
        format!(
            "{of}: no row for {} s after {}, where most are {} s apart{also}: what is interpolated over that may be far off; give rows in \
             between, or end a segment there",
            number(two_digits(step_s)),
            time(after),
            number(two_digits(most_s))
        )
    })
}

/// How many times as fast as positions change velocities say they do: the median over steps, if there are enough.
fn speed_over_way(nodes: &Nodes) -> Option<f64> {
    let rows = nodes.tdb_s.iter().zip(&nodes.position_m).zip(&nodes.velocity_m_s).collect::<Vec<_>>();
    let straight = |a: DVec3, b: DVec3| a.dot(b) >= STRAIGHT * a.length() * b.length();
    let ratio = |two: &[((&f64, &DVec3), &DVec3)]| {
        let [((t0, r0), v0), ((t1, r1), v1)] = *two.first_chunk()?;
        let way = (*r1 - *r0).length() / (t1 - t0);
        let speed = 0.5 * (v0.length() + v1.length());
        (straight(*v0, *v1) && (way > 0.0 || speed > 0.0)).then_some(speed / way)
    };
    let mut all: Vec<f64> = rows.windows(2).filter_map(ratio).filter(|ratio| !ratio.is_nan()).collect();
    all.sort_by(f64::total_cmp);
    (all.len() >= FEW).then(|| all[all.len() / 2])
}

/// Rounded to two digits, or what it is if it has no digits.
fn two_digits(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::Interpolation;

    /// A circle of 40 km at 2e-4 rad/s, a row a minute; positions and velocities so many times what they are.
    fn circle(place: f64, speed: f64, rows: usize) -> Nodes {
        let turned = |i: usize| glam::DVec2::from_angle(2e-4 * 60.0 * i as f64);
        let across = |of: glam::DVec2| of.extend(0.0);
        Nodes {
            tdb_s: (0..rows).map(|i| 60.0 * i as f64).collect(),
            position_m: (0..rows).map(|i| place * 4e4 * across(turned(i))).collect(),
            velocity_m_s: (0..rows).map(|i| speed * 8.0 * across(turned(i).perp())).collect(),
            interpolation: Interpolation::Hermite(4),
        }
    }

    #[test]
    fn velocities_in_other_units_are_found_whichever_is_wrong() {
        let of = |place, speed, rows| speed_over_way(&circle(place, speed, rows));
        // A chord is shorter than its arc: of 0.012 rad by 6e-6.
        for (place, speed, expected) in [(1.0, 1.0, 1.0), (1.0, 1000.0, 1000.0), (1000.0, 1.0, 1e-3)] {
            assert!((of(place, speed, 9).unwrap() / expected - 1.0).abs() < 1e-5);
        }
        // What stands still, has no velocities, too few rows, or goes half around between them, tells nothing.
        assert_eq!((of(0.0, 0.0, 9), of(1.0, 1.0, 3)), (None, None));
        assert_eq!(speed_over_way(&Nodes { velocity_m_s: vec![], ..circle(1.0, 1.0, 9) }), None);
        let half = Nodes { tdb_s: (0..9).map(|i| f64::from(i) * 15708.0).collect(), ..circle(1.0, 1.0, 9) };
        let half = Nodes {
            position_m: (0..9).map(|i| DVec3::X * if i % 2 == 0 { 4e4 } else { -4e4 }).collect(),
            velocity_m_s: (0..9).map(|i| DVec3::Y * if i % 2 == 0 { 8.0 } else { -8.0 }).collect(),
            ..half
        };
        assert_eq!(speed_over_way(&half), None);
        // Velocities that were left at nothing, and places that were.
        assert_eq!((of(1.0, 0.0, 9), of(0.0, 1.0, 9)), (Some(0.0), Some(f64::INFINITY)));
    }

    #[test]
    fn rows_far_apart_are_found() {
        let said = |segments: &[&[f64]]| uneven(segments, "MMX", |s| format!("{s}"));
        assert_eq!(said(&[&[0.0, 60.0, 120.0, 720.0], &[], &[5.0], &[0.0, 1e5]]), None);
        let of_two = said(&[&[0.0, 60.0, 98940.0]]).unwrap();
        assert!(of_two.contains("no row for 99000 s after 60, where most are 60 s apart:"), "{of_two}");
        // What lies between two segments is no step.
        assert_eq!(said(&[&[0.0, 60.0, 120.0], &[9e4, 9e4 + 60.0]]), None);
        let three = said(&[&[0.0, 1.0, 2.0, 20.0, 21.0, 90.0, 91.0, 92.0, 103.0]]).unwrap();
        assert!(three.contains("for 69 s after 21,") && three.contains("and 2 more such steps"), "{three}");
    }
}
