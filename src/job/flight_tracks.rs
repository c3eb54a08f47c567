//! Plots of a flight-dynamics file: ground tracks, altitudes and phase angles of trajectories; directions and rates of
//! rotating frames.

use std::path::Path;

use glam::DVec3;

use crate::error::{Error, Location, Result};
use crate::flight::{Almanac, Epoch, LeapSeconds, Orientation, Scale, Span, Trajectory, altitude_m, radii_m};
use crate::formats::ephemeris;
use crate::formats::track_picture::{self, Broken, Quantity, Track, TrackSheet};
use crate::geometry::{angle_rad, planetocentric_deg, turn_rad};

/// Number of epochs per plotted span.
const MOMENTS: u32 = 600;
/// Shown in an empty panel.
const NO_TIME: &str = "known at fewer than two times";
/// Smallest rotation that gives a rate, rad.
const STILL_RAD: f64 = 1e-12;

/// Draws a file's contents as SVG or PNG.
///
/// # Errors
/// Those of [`flight_sheet`] and of [`track_picture::write`].
pub fn draw_flight(path: &Path, target: &Path, replace: bool) -> Result<()> {
    track_picture::write(&flight_sheet(path)?, target, replace, path)
}

/// What of a file is plotted, the almanac that it is known by, and its time scale.
struct Plotted {
    trajectories: Vec<Trajectory>,
    orientations: Vec<Orientation>,
    almanac: Almanac,
    scale: Scale,
}

/// What a file that is not a kernel knows.
fn of_file(path: &Path) -> Result<Plotted> {
    let file = ephemeris::read(path, &LeapSeconds::default())?;
    let mut almanac = Almanac::with_rough_trajectories();
    let trajectories: Vec<Trajectory> = file.trajectories.into_iter().map(|(_, trajectory)| trajectory).collect();
    let orientations: Vec<Orientation> = file.orientations.into_iter().map(|(_, orientation)| orientation).collect();
    almanac.trajectories.extend(trajectories.iter().cloned());
    almanac.orientations.extend(orientations.iter().cloned());
    Ok(Plotted { trajectories, orientations, almanac, scale: file.scale })
}

/// What a kernel knows, or those that a meta-kernel lists: of things about different centres those about the centre of the
/// first spacecraft, or of the first thing.
fn of_kernel(path: &Path) -> Result<Plotted> {
    let mut almanac = Almanac::with_rough_trajectories();
    let known = (almanac.trajectories.len(), almanac.orientations.len());
    ephemeris::furnish(path, &mut almanac)?;
    let mut trajectories = almanac.trajectories[known.0..].to_vec();
    let orientations = almanac.orientations[known.1..].to_vec();
    let is_craft = |of: &&Trajectory| almanac.names.id(&of.target).is_some_and(|id| id < 0);
    if let Some(first) = trajectories.iter().find(is_craft).or(trajectories.first()) {
        let (centre, frame) = (first.centre.clone(), first.frame.clone());
        trajectories.retain(|of| of.centre == centre && of.frame == frame);
    }
    Ok(Plotted { trajectories, orientations, almanac, scale: Scale::Tdb })
}

/// The plots of a file: sub-object points of trajectories, if their centre's rotation is known; for a file without
/// trajectories, the +z axes of its frames.
///
/// # Errors
/// Those of its reader; [`Error::Invalid`] if nothing of it can be drawn.
pub fn flight_sheet(path: &Path) -> Result<TrackSheet> {
    let plotted = if ephemeris::is_kernel(path)? { of_kernel(path)? } else { of_file(path)? };
    let Plotted { trajectories, orientations, almanac, scale } = plotted;
    let spans: Vec<Span> = trajectories
        .iter()
        .flat_map(Trajectory::spans)
        .chain(orientations.iter().flat_map(|of| of.spans().unwrap_or_default()))
        .collect();
    let Some(start) = spans.iter().map(|span| span.start).min_by(|a, b| a.tdb_s().total_cmp(&b.tdb_s())) else {
        return Err(Error::invalid(Location::file(path), "knows no span of time that could be drawn"));
    };
    let name = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let begins = format!("{} {}", start.to_text(scale, 0, &LeapSeconds::default()), scale.name());
    Ok(if trajectories.is_empty() {
        TrackSheet {
            title: format!("{name}: where +z points"),
            map_labels: ["right ascension, deg".into(), "declination, deg".into()],
            quantities: vec![
                Quantity { label: "turned, deg".into(), unknown: NO_TIME },
                Quantity { label: "rate, deg/s".into(), unknown: NO_TIME },
            ],
            begins,
            tracks: orientations.iter().map(|of| of_orientation(of, start)).collect::<Result<_>>()?,
        }
    } else {
        let fixed = format!("IAU_{}", trajectories[0].centre);
        let turns = almanac.rotation(&fixed, &trajectories[0].frame, start).is_ok();
        let [across, upwards] = if turns { ["longitude east", "latitude"] } else { ["right ascension", "declination"] };
        TrackSheet {
            title: format!("{name}: about {}", trajectories[0].centre),
            map_labels: [across, upwards].map(|label| format!("{label}, deg")),
            quantities: vec![
                Quantity { label: "height, km".into(), unknown: NO_TIME },
                Quantity { label: "phase angle, deg".into(), unknown: "where the Sun is from here is not known" },
            ],
            begins,
            tracks: trajectories.iter().map(|of| of_trajectory(of, &almanac, start)).collect::<Result<_>>()?,
        }
    })
}

/// Equally spaced epochs of a span, both ends included.
fn moments(span: &Span) -> impl Iterator<Item = Epoch> + use<> {
    let (start, length_s) = (span.start, span.end.since_s(span.start));
    let end = span.end;
    (0..=MOMENTS).map(move |i| match i {
        MOMENTS => end,
        _ => start.after_s(length_s * f64::from(i) / f64::from(MOMENTS)),
    })
}

/// Longitude, 0 to 360, and latitude of a direction, deg.
fn directed_deg(p: DVec3) -> [f64; 2] {
    let [latitude, longitude] = planetocentric_deg(p);
    [longitude, latitude]
}

/// The sub-object point, the altitude above the centre's ellipsoid (or distance from the centre), and the phase angle.
fn of_trajectory(of: &Trajectory, almanac: &Almanac, start: Epoch) -> Result<Track> {
    let fixed = format!("IAU_{}", of.centre);
    let radii_m = almanac.radii_m(&of.centre).or_else(|| radii_m(&of.centre));
    let (mut map, mut heights, mut phases): (Broken, Broken, Broken) = Default::default();
    for span in of.spans() {
        let (mut places, mut height, mut phase) = (vec![], vec![], vec![]);
        for epoch in moments(&span) {
            let Some(state) = of.state(epoch)? else { continue };
            let hours = epoch.since_s(start) / 3600.0;
            let rotation = almanac.rotation(&fixed, &of.frame, epoch).ok();
            let position_m = rotation.map_or(state.position_m, |rotation| rotation * state.position_m);
            places.push(directed_deg(position_m));
            let height_m = match radii_m.filter(|_| rotation.is_some()) {
                Some(radii_m) => altitude_m(position_m, radii_m),
                None => position_m.length(),
            };
            height.push([hours, height_m / 1000.0]);
            if let Ok(sun) = almanac.state("SUN", &of.centre, &of.frame, epoch) {
                phase.push([hours, angle_rad(sun.position_m, state.position_m).to_degrees()]);
            }
        }
        map.push(places);
        heights.push(height);
        phases.push(phase);
    }
    Ok(Track { name: of.target.clone(), map, series: vec![heights, phases] })
}

/// The direction of its +z in the base, the rotation since the first epoch, and the rate.
fn of_orientation(of: &Orientation, start: Epoch) -> Result<Track> {
    let (mut map, mut angles, mut rates): (Broken, Broken, Broken) = Default::default();
    let mut first = None;
    for span in of.spans().unwrap_or_default() {
        let (mut places, mut angle, mut rate) = (vec![], vec![], vec![]);
        let mut before: Option<(f64, glam::DQuat)> = None;
        for epoch in moments(&span) {
            let Some(rotation) = of.frame_from_base(epoch)? else { continue };
            let s = epoch.since_s(start);
            let turn = glam::DQuat::from_mat3(&rotation);
            let from = *first.get_or_insert(turn);
            places.push(directed_deg(rotation.transpose() * DVec3::Z));
            angle.push([s / 3600.0, turn_rad(from, turn).to_degrees()]);
            if let Some((before_s, before)) = before.filter(|(before_s, _)| s > *before_s) {
                let turned_rad = turn_rad(before, turn);
                let turned_rad = if turned_rad > STILL_RAD { turned_rad } else { 0.0 };
                rate.push([0.5 * (before_s + s) / 3600.0, turned_rad.to_degrees() / (s - before_s)]);
            }
            before = Some((s, turn));
        }
        map.push(places);
        angles.push(angle);
        rates.push(rate);
    }
    Ok(Track { name: of.frame.clone(), map, series: vec![angles, rates] })
}
