//! Segments of an AEM: the orientation of a frame B relative to a frame A.
//!
//! With Q = (q1, q2, q3, qc), qc the scalar, and the direction A to B, the matrix
//!
//! ```text
//! q1^2 - q2^2 - q3^2 + qc^2   2 (q1 q2 + q3 qc)            2 (q1 q3 - q2 qc)
//! 2 (q1 q2 - q3 qc)          -q1^2 + q2^2 - q3^2 + qc^2    2 (q2 q3 + q1 qc)
//! 2 (q1 q3 + q2 qc)           2 (q2 q3 - q1 qc)           -q1^2 - q2^2 + q3^2 + qc^2
//! ```
//!
//! carries components along A into components along B (504.0-B, annex): it turns vectors by the inverse of Q, as one that turns axes.
//! Version 1 says in which order components stand (QUATERNION_TYPE) and which way they turn (ATTITUDE_DIR); version 2 always has the
//! scalar last and turns from A to B, unless a file says otherwise.
//!
//! Euler angles stand in the order of their axes in EULER_ROT_SEQ, and each turns axes: M = R_k(third) R_j(second) R_i(first).

use std::f64::consts::PI;

use glam::{DQuat, DVec3, DVec4};

use super::message::{Block, Column, Entry, Place, Reading, column, shown};
use super::segment::{Method, Rows, method, object, rows, span};
use crate::error::Result;
use crate::flight::{Attitudes, Between, Orientation, Scale, Turn, Turning, frame_name};
use crate::formats::flight_file::{MOST_OFF, Object};
use crate::report::Fate;

/// Metadata keys of an AEM beyond those shared with an OEM.
pub(super) const KEYS: &[&str] = &[
    "REF_FRAME_A",
    "REF_FRAME_B",
    "ATTITUDE_DIR",
    "ATTITUDE_TYPE",
    "QUATERNION_TYPE",
    "EULER_ROT_SEQ",
    "RATE_FRAME",
    "ANGVEL_FRAME",
    "INTERPOLATION_METHOD",
];

/// Quaternions whose length is nearer to 1 are used as they are: the length of a product of two rounded ones.
const EXACT: f64 = 4.0 * f64::EPSILON;
/// Larger deviations of the length from 1 than 7-digit rounding are reported.
const TOLD: f64 = 1e-8;

const QUATERNION: [Column; 4] = [column("Q1", "", 0), column("Q2", "", 0), column("Q3", "", 0), column("QC", "", 0)];
const DERIVATIVE: [Column; 4] =
    [column("Q1_DOT", "1/s", 0), column("Q2_DOT", "1/s", 0), column("Q3_DOT", "1/s", 0), column("QC_DOT", "1/s", 0)];
const VELOCITY: [Column; 3] =
    [column("ANGVEL_X", "deg/s", 0), column("ANGVEL_Y", "deg/s", 0), column("ANGVEL_Z", "deg/s", 0)];
const ANGLES: [Column; 3] =
    [angle("ANGLE_1", "rotation1"), angle("ANGLE_2", "rotation2"), angle("ANGLE_3", "rotation3")];
/// Euler angle rates, which are not used.
const RATES: [Column; 3] = [
    Column { names: ["ANGLE_1_DOT", "rotation1"], unit: "", power: 0 },
    Column { names: ["ANGLE_2_DOT", "rotation2"], unit: "", power: 0 },
    Column { names: ["ANGLE_3_DOT", "rotation3"], unit: "", power: 0 },
];

const fn angle(name: &'static str, old: &'static str) -> Column {
    Column { names: [name, old], unit: "deg", power: 0 }
}

/// An orientation, and what the message calls the thing that turns.
pub(super) type Found = (Object, Orientation);

/// What the rows hold.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Given {
    Quaternion,
    WithDerivative,
    WithVelocity,
    WithRates,
    /// Axes, and whether there are rates.
    Angles([usize; 3], Option<[Column; 3]>),
}

/// The orientation of one segment; `None` if any of it is unusable, which has been reported.
///
/// # Errors
/// [`Unsupported`](crate::Error::Unsupported) for a spinning object.
pub(super) fn orientation<'a>(
    block: &Block<'a>,
    scale: Scale,
    version: u32,
    reading: &mut Reading<'a>,
) -> Result<Option<Found>> {
    let object = object(block, reading);
    let base = reading.needed(block, "REF_FRAME_A");
    let frame = reading.needed(block, "REF_FRAME_B");
    let given = given(block, reading)?;
    let is_old = version < 2;
    let is_from_a = word(block, "ATTITUDE_DIR", ["A2B", "B2A"], is_old, reading);
    let is_of_quaternions = given.is_some_and(|given| !matches!(given, Given::Angles(..)));
    let is_last = match block.rows.first() {
        Some(Place::Text(_)) if is_of_quaternions => word(block, "QUATERNION_TYPE", ["LAST", "FIRST"], is_old, reading),
        // In XML components have names.
        _ => Some(true),
    };
    let (Some(given), Some(is_from_a), Some(is_last), Some(base), Some(frame), Some(object)) =
        (given, is_from_a, is_last, base, frame, object)
    else {
        return Ok(None);
    };
    let columns = given.columns();
    let Some(rows) = rows(block, &columns, &[columns.len()], scale, reading) else { return Ok(None) };
    let span = span(block, &rows, scale, reading);
    let (rotation, derivative) = match given {
        Given::Angles(axes, rates) => {
            if rates.is_some() {
                reading.note(Fate::Dropped, block.at, "rates of the angles");
            }
            (of_angles(&rows, axes), vec![])
        }
        _ => of_quaternions(block, &rows, given, is_last, reading),
    };
    let derivative = match given {
        Given::WithVelocity => from_velocity(block, &rows, &rotation, [base, frame], is_from_a, reading),
        _ => derivative,
    };
    // The file's rotation turns axes from A to B; components along A transform by the inverse.
    let turned = |q: DQuat| if is_from_a { q.conjugate() } else { q };
    let frame_from_base: Vec<DQuat> = rotation.into_iter().map(turned).collect();
    let derivative: Vec<DVec4> = derivative.into_iter().map(|q| DVec4::from(turned(DQuat::from_vec4(q)))).collect();
    let what = ("derivatives", !derivative.is_empty());
    let Some(method) = method(block, "INTERPOLATION_METHOD", what, Method::Linear, reading) else { return Ok(None) };
    let attitudes = Attitudes {
        tdb_s: rows.epochs.iter().map(|epoch| epoch.tdb_s()).collect(),
        frame_from_base,
        derivative,
        between: match method {
            Method::Linear => Between::SteadyTurn,
            Method::Lagrange(nodes) => Between::Lagrange(nodes),
            Method::Hermite(nodes) => Between::Hermite(nodes),
        },
    };
    let turning = Turning::Attitudes(attitudes.with_continuous_signs());
    let orientation = Orientation {
        frame: frame_name(frame.value),
        base: frame_name(base.value),
        source: reading.path.display().to_string(),
        turns: vec![Turn { span, turning }],
    };
    Ok(span.is_some().then_some((object, orientation)))
}

/// The rows' contents, by ATTITUDE_TYPE.
fn given<'a>(block: &Block<'a>, reading: &mut Reading<'a>) -> Result<Option<Given>> {
    let Some(entry) = reading.needed(block, "ATTITUDE_TYPE") else { return Ok(None) };
    let name: String = entry.value.split_whitespace().collect::<Vec<_>>().join("_").to_ascii_uppercase();
    let mut axes = || axes(block, reading);
    Ok(match name.as_str() {
        "QUATERNION" => Some(Given::Quaternion),
        "QUATERNION/DERIVATIVE" => Some(Given::WithDerivative),
        "QUATERNION/ANGVEL" => Some(Given::WithVelocity),
        "QUATERNION/RATE" => Some(Given::WithRates),
        "EULER_ANGLE" => axes().map(|axes| Given::Angles(axes, None)),
        "EULER_ANGLE/RATE" | "EULER_ANGLE/DERIVATIVE" => axes().map(|axes| Given::Angles(axes, Some(RATES))),
        "EULER_ANGLE/ANGVEL" => axes().map(|axes| Given::Angles(axes, Some(VELOCITY))),
        _ if name.starts_with("SPIN") => {
            let feature = format!("ATTITUDE_TYPE = {} (write its quaternions)", shown(entry.value));
            return Err(reading.unsupported(entry.at, feature));
        }
        _ => {
            let message = format!("`{}` is not a type of attitude", shown(entry.value));
            let help = "QUATERNION, QUATERNION/DERIVATIVE, QUATERNION/ANGVEL, EULER_ANGLE and so on";
            reading.wrong_with(entry.at, message, help);
            None
        }
    })
}

/// The axes of EULER_ROT_SEQ, from 0: 321 or ZYX.
fn axes<'a>(block: &Block<'a>, reading: &mut Reading<'a>) -> Option<[usize; 3]> {
    let entry = reading.needed(block, "EULER_ROT_SEQ")?;
    let of = |c: char| match c.to_ascii_uppercase() {
        '1' | 'X' => Some(0),
        '2' | 'Y' => Some(1),
        '3' | 'Z' => Some(2),
        _ => None,
    };
    let axes: Option<Vec<usize>> = entry.value.chars().map(of).collect();
    let axes = axes.and_then(|axes| <[usize; 3]>::try_from(axes).ok());
    let axes = axes.filter(|[first, second, third]| first != second && second != third);
    if axes.is_none() {
        reading.wrong(entry.at, format!("`{}` is not a sequence of axes, e.g. 321 or ZXZ", shown(entry.value)));
    }
    axes
}

/// Whether a key has the first of two words; the default is the first in new versions.
fn word<'a>(
    block: &Block<'a>,
    key: &str,
    words: [&str; 2],
    is_needed: bool,
    reading: &mut Reading<'a>,
) -> Option<bool> {
    let entry = match block.entry(key) {
        None if !is_needed => return Some(true),
        _ => reading.needed(block, key)?,
    };
    let found = words.iter().position(|word| word.eq_ignore_ascii_case(entry.value));
    if found.is_none() {
        reading.wrong(entry.at, format!("{key} must be {} or {}, not `{}`", words[0], words[1], shown(entry.value)));
    }
    found.map(|i| i == 0)
}

impl Given {
    fn columns(self) -> Vec<Column> {
        match self {
            Given::Quaternion => QUATERNION.to_vec(),
            Given::WithDerivative => [QUATERNION, DERIVATIVE].concat(),
            Given::WithVelocity => [&QUATERNION[..], &VELOCITY].concat(),
            Given::WithRates => [&QUATERNION[..], &RATES].concat(),
            Given::Angles(_, rates) => [&ANGLES[..], rates.as_ref().map_or(&[][..], |rates| rates)].concat(),
        }
    }
}

/// Rotations of axes from angles in degrees.
fn of_angles(rows: &Rows<'_>, axes: [usize; 3]) -> Vec<DQuat> {
    let turn = |axis: usize, angle_deg: f64| DQuat::from_axis_angle(DVec3::AXES[axis], angle_deg.to_radians());
    // Rotations are intrinsic: the first one is leftmost.
    let of = |angles: &Vec<f64>| turn(axes[0], angles[0]) * turn(axes[1], angles[1]) * turn(axes[2], angles[2]);
    rows.values.iter().map(|angles| of(angles).normalize()).collect()
}

/// Normalised quaternions, and their derivatives if the rows have them.
fn of_quaternions<'a>(
    block: &Block<'a>,
    rows: &Rows<'a>,
    given: Given,
    is_last: bool,
    reading: &mut Reading<'a>,
) -> (Vec<DQuat>, Vec<DVec4>) {
    let in_order = |v: &[f64]| if is_last { [v[0], v[1], v[2], v[3]] } else { [v[1], v[2], v[3], v[0]] };
    let (mut rotation, mut derivative, mut most_off) = (Vec::new(), Vec::new(), 0.0_f64);
    for (values, at) in rows.values.iter().zip(&rows.at) {
        let q = DVec4::from_array(in_order(values));
        let length = q.length();
        let off = (length - 1.0).abs();
        if off > MOST_OFF {
            let message = format!("quaternion of length {length:.6}: must be 1");
            reading.wrong_with(*at, message, "check QUATERNION_TYPE and the columns, or divide it by its length");
        }
        most_off = most_off.max(off);
        let scale = if off > EXACT { length.recip() } else { 1.0 };
        rotation.push(DQuat::from_vec4(q * scale));
        if given == Given::WithDerivative {
            derivative.push(DVec4::from_array(in_order(&values[4..])) * scale);
        }
    }
    if most_off > TOLD {
        let message = format!("quaternion lengths differ from 1 by up to {most_off:.1e}: they are normalised");
        reading.note(Fate::Approximated, block.at, message);
    }
    if given == Given::WithRates {
        reading.note(Fate::Dropped, block.at, "rates of rotation");
    }
    (rotation, derivative)
}

/// Derivatives of quaternions that turn axes from A to B, from the angular velocity of B in A, deg/s: dQ/dt = Q w / 2 with w along B, or
/// w Q / 2 with w along A.
fn from_velocity<'a>(
    block: &Block<'a>,
    rows: &Rows<'a>,
    rotation: &[DQuat],
    [base, frame]: [Entry<'a>; 2],
    is_from_a: bool,
    reading: &mut Reading<'a>,
) -> Vec<DVec4> {
    let along = block.entry("ANGVEL_FRAME");
    let is =
        |name: &str, key: &str, of: Entry<'_>| name.eq_ignore_ascii_case(of.value) || name.eq_ignore_ascii_case(key);
    let along_b = match along {
        Some(entry) if is(entry.value, "REF_FRAME_B", frame) => Some(true),
        Some(entry) if is(entry.value, "REF_FRAME_A", base) => Some(false),
        _ => None,
    };
    let Some(along_b) = along_b.filter(|_| is_from_a) else {
        let at = along.map_or(block.at, |entry| entry.at);
        reading.note(
            Fate::Dropped,
            at,
            "angular velocities: they are read along REF_FRAME_A or B, of attitudes from A to B",
        );
        return vec![];
    };
    let of = |(values, q): (&Vec<f64>, &DQuat)| {
        let half = DVec3::from_slice(&values[4..7]) * (PI / 360.0);
        let half = DQuat::from_xyzw(half.x, half.y, half.z, 0.0);
        DVec4::from(if along_b { *q * half } else { half * *q })
    };
    rows.values.iter().zip(rotation).map(of).collect()
}
