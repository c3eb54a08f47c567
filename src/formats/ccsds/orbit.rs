//! Segments of an OEM: positions in km, and velocities in km/s.

use glam::DVec3;

use super::message::{Block, Column, Reading, column};
use super::segment::{Method, method, object, rows, span};
use crate::flight::{Interpolation, Nodes, Path, Scale, Segment, Trajectory, body_name, frame_name};
use crate::formats::flight_file::Object;
use crate::report::Fate;

/// Metadata keys of an OEM beyond those shared with an AEM.
pub(super) const KEYS: &[&str] = &["REF_FRAME", "REF_FRAME_EPOCH", "INTERPOLATION"];

/// Of km in m.
const KM: i32 = 3;
const COLUMNS: [Column; 9] = [
    column("X", "km", KM),
    column("Y", "km", KM),
    column("Z", "km", KM),
    column("X_DOT", "km/s", KM),
    column("Y_DOT", "km/s", KM),
    column("Z_DOT", "km/s", KM),
    column("X_DDOT", "km/s**2", KM),
    column("Y_DDOT", "km/s**2", KM),
    column("Z_DDOT", "km/s**2", KM),
];

/// A trajectory, and what the message calls the thing that moves.
pub(super) type Found = (Object, Trajectory);

/// The trajectory of one segment; `None` if any of it is unusable, which has been reported.
pub(super) fn trajectory<'a>(block: &Block<'a>, scale: Scale, reading: &mut Reading<'a>) -> Option<Found> {
    let object = object(block, reading);
    let centre = reading.needed(block, "CENTER_NAME");
    let frame = reading.needed(block, "REF_FRAME");
    if let Some(epoch) = block.entry("REF_FRAME_EPOCH") {
        reading.note(Fate::Dropped, epoch.at, "REF_FRAME_EPOCH: the frame is taken by its name alone");
    }
    let rows = rows(block, &COLUMNS, &[3, 6, 9], scale, reading)?;
    let span = span(block, &rows, scale, reading);
    // Accelerations may be missing in some rows, velocities only in all.
    let has_velocities = rows.values[0].len() > 3;
    if let Some(i) = rows.values.iter().position(|values| (values.len() > 3) != has_velocities) {
        let (here, before) = if has_velocities { ("no velocity", "have one") } else { ("a velocity", "have none") };
        reading.wrong(rows.at[i], format!("has {here}, but the previous rows {before}"));
    }
    let otherwise = Method::by_default(has_velocities);
    let method = method(block, "INTERPOLATION", ("velocities", has_velocities), otherwise, reading);
    if let Some(i) = rows.values.iter().position(|values| values.len() == 9) {
        reading.note(Fate::Dropped, rows.at[i], "accelerations");
    }
    if let Some(at) = block.covariance {
        reading.note(Fate::Dropped, at, "covariances");
    }
    let vector = |from: usize| -> Vec<DVec3> {
        rows.values.iter().filter_map(|values| Some(DVec3::from_slice(values.get(from..from + 3)?))).collect()
    };
    let nodes = Nodes {
        tdb_s: rows.epochs.iter().map(|epoch| epoch.tdb_s()).collect(),
        position_m: vector(0),
        velocity_m_s: vector(3),
        interpolation: match method? {
            Method::Linear => Interpolation::Lagrange(2),
            Method::Lagrange(nodes) => Interpolation::Lagrange(nodes),
            Method::Hermite(nodes) => Interpolation::Hermite(nodes),
        },
    };
    let object = object?;
    let trajectory = Trajectory {
        target: body_name(&object.name),
        centre: body_name(centre?.value),
        frame: frame_name(frame?.value),
        source: reading.path.display().to_string(),
        segments: vec![Segment { span: span?, path: Path::Nodes(nodes) }],
    };
    Some((object, trajectory))
}
