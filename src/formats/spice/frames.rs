//! SPICE frames: their numbers, and their orientations by frame kernels (FK) and text PCK.

use std::collections::BTreeSet;

use glam::{DMat3, DQuat, DVec3};

use crate::error::Result;
use crate::flight::{
    Almanac, Angle, ECLIPTIC, J2000, Orientation, Pool, RotationModel, Turn, Turning, Unread, frame_name, whole,
};

/// Frames that are known without a kernel, by their numbers.
const KNOWN: [(i32, &str); 3] = [(1, J2000), (17, ECLIPTIC), (13_000, "ITRF93")];
/// Numbers of frames `IAU_X`, and of the bodies X.
#[rustfmt::skip]
const OF_BODIES: [(i32, i32); 13] = [
    (10_010, 10), (10_011, 199), (10_012, 299), (10_013, 399), (10_014, 499), (10_015, 599), (10_016, 699), (10_017, 799), (10_018, 899),
    (10_019, 999), (10_020, 301), (10_021, 401), (10_022, 402),
];
/// The number of `ITRF93` among frames of binary PCK.
const ITRF93_CLASS: i32 = 3000;

/// A frame that a kernel defines.
#[derive(Debug, Clone, PartialEq)]
struct Defined {
    id: i32,
    name: String,
    class: i32,
    class_id: i32,
}

/// Names of frames.
#[derive(Debug, Clone, Default)]
pub(super) struct Frames {
    defined: Vec<Defined>,
    /// Names of bodies, for `IAU_X`.
    names: crate::flight::Names,
}

impl Frames {
    /// Frame class of PCK.
    pub(super) const PCK: i32 = 2;
    /// Frame class of CK.
    pub(super) const CK: i32 = 3;
    /// Frame class of fixed offsets (TK).
    const TK: i32 = 4;

    /// All frames that text kernels define.
    pub(super) fn of(almanac: &Almanac) -> Result<Self> {
        let pool = &almanac.pool;
        let mut defined = Vec::new();
        for (variable, _) in pool.iter() {
            let id = variable.strip_prefix("FRAME_").and_then(|rest| rest.strip_suffix("_NAME"));
            let Some(id) = id.and_then(|id| id.parse().ok()) else { continue };
            let Some(name) = pool.text(variable)? else { continue };
            let either = |of: &str| -> Result<Option<i32>> {
                match pool.integer(&format!("FRAME_{id}_{of}"))? {
                    None => pool.integer(&format!("FRAME_{name}_{of}")),
                    found => Ok(found),
                }
            };
            if let Some(class) = either("CLASS")? {
                let class_id = either("CLASS_ID")?.unwrap_or(id);
                defined.push(Defined { id, name: frame_name(name), class, class_id });
            }
        }
        Ok(Frames { defined, names: almanac.names.clone() })
    }

    /// The name of a frame by its number.
    pub(super) fn of_id(&self, id: i32) -> String {
        let defined = self.defined.iter().find(|frame| frame.id == id).map(|frame| frame.name.clone());
        let known = || KNOWN.iter().find(|(of, _)| *of == id).map(|(_, name)| (*name).to_owned());
        let of_body = || OF_BODIES.iter().find(|(of, _)| *of == id).map(|(_, body)| self.of_body(*body));
        defined.or_else(known).or_else(of_body).unwrap_or_else(|| format!("FRAME {id}"))
    }

    /// The name of a frame by its number among those of a class.
    pub(super) fn of_class(&self, class: i32, class_id: i32) -> String {
        let is_it = |frame: &&Defined| frame.class == class && frame.class_id == class_id;
        // A body's built-in name takes precedence over others that a kernel gives to the same rotation.
        match class {
            Self::PCK if class_id == ITRF93_CLASS => "ITRF93".to_owned(),
            Self::PCK if self.has_name(class_id) => self.of_body(class_id),
            _ => match self.defined.iter().find(is_it) {
                Some(frame) => frame.name.clone(),
                None => format!("{} {class_id}", if class == Self::CK { "CK" } else { "PCK" }),
            },
        }
    }

    /// Names of all frames that kernels define.
    pub(super) fn names(&self) -> Vec<String> {
        self.defined.iter().map(|frame| frame.name.clone()).collect()
    }

    fn has_name(&self, body: i32) -> bool {
        self.names.body(&body.to_string()) != body.to_string()
    }

    /// The name of the body-fixed frame that text PCK orient.
    pub(super) fn of_body(&self, body: i32) -> String {
        format!("IAU_{}", self.names.body(&body.to_string()).replace(' ', "_"))
    }
}

/// Variables of a rotation, after the body's number.
const ROTATION: [&str; 3] = ["POLE_RA", "POLE_DEC", "PM"];

/// Bodies of whose rotation something is known, ascending.
pub(super) fn rotating_bodies(pool: &Pool) -> BTreeSet<i32> {
    let body = |variable: &str| {
        let (body, of) = variable.strip_prefix("BODY")?.split_once('_')?;
        ROTATION.contains(&of).then(|| body.parse().ok()).flatten()
    };
    pool.iter().filter_map(|(variable, _)| body(variable)).collect()
}

/// Orients frames by the variables of text kernels.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) for variables that are not what they should be.
pub(super) fn furnish(source: &str, almanac: &mut Almanac) -> Result<()> {
    let frames = Frames::of(almanac)?;
    let mut found = Vec::new();
    for body in rotating_bodies(&almanac.pool) {
        let turning = rotation_model(body, &almanac.pool)?;
        found.push((frames.of_body(body), J2000.to_owned(), turning));
    }
    for frame in &frames.defined {
        let name = frame.name.clone();
        match frame.class {
            // Its name before its definition was read.
            Frames::PCK | Frames::CK => {
                let before = Frames { defined: vec![], names: almanac.names.clone() };
                let before = before.of_class(frame.class, frame.class_id);
                let now = frames.of_class(frame.class, frame.class_id);
                for orientation in almanac.orientations.iter_mut().filter(|of| of.frame == before) {
                    orientation.frame.clone_from(&now);
                }
                if name != now {
                    found.push((name, now, Turning::Fixed(DMat3::IDENTITY)));
                }
            }
            Frames::TK => {
                let (base, turning) = fixed(frame, &almanac.pool)?;
                found.push((name, base, turning));
            }
            1 => {}
            class => {
                let what = format!("{name}, a frame of class {class},");
                let at = almanac.pool.at(&format!("FRAME_{}_NAME", frame.id));
                found.push((name, J2000.to_owned(), Turning::Unread(Unread { at, what })));
            }
        }
        let before = format!("FRAME {}", frame.id);
        for orientation in almanac.orientations.iter_mut().filter(|of| of.base == before) {
            orientation.base.clone_from(&frame.name);
        }
        for trajectory in almanac.trajectories.iter_mut().filter(|of| of.frame == before) {
            trajectory.frame.clone_from(&frame.name);
        }
    }
    for (frame, base, turning) in found {
        settle(
            Orientation { frame, base, source: source.to_owned(), turns: vec![Turn { span: None, turning }] },
            almanac,
        );
    }
    Ok(())
}

/// Replaces the orientation of a frame that holds at all times. A new one goes to the front: as in SPICE, binary
/// kernels override it within their coverage, whatever the load order.
fn settle(orientation: Orientation, almanac: &mut Almanac) {
    let holds_always = |of: &Orientation| matches!(of.turns[..], [Turn { span: None, .. }]);
    match almanac.orientations.iter_mut().find(|of| of.frame == orientation.frame && holds_always(of)) {
        // Unchanged ones keep their source.
        Some(same) if same.base == orientation.base && same.turns == orientation.turns => {}
        Some(before) => *before = orientation,
        None => almanac.orientations.insert(0, orientation),
    }
}

/// Coefficients of an angle of a rotation, as SPICE has it.
const MOST_COEFFICIENTS: usize = 3;

/// A body's rotation from the variables `BODYn_...`; periodic angles are those of its system's barycentre (of 4 for
/// 401).
fn rotation_model(body: i32, pool: &Pool) -> Result<Turning> {
    let barycentre = match body {
        100..1000 => body / 100,
        10_000..100_000 => body / 10_000,
        _ => body,
    };
    for other in ["CONSTANTS_JED_EPOCH", "CONSTS_JED_EPOCH", "CONSTANTS_REF_FRAME", "CONSTS_REF_FRAME"] {
        let name = format!("BODY{body}_{other}");
        if pool.has(&name) {
            let what = "a rotation that does not count from J2000".to_owned();
            return Ok(Turning::Unread(Unread { at: pool.at(&name), what }));
        }
    }
    let list = |body: i32, name: &str| -> Result<Vec<f64>> {
        Ok(pool.numbers(&format!("BODY{body}_{name}"))?.unwrap_or_default().to_vec())
    };
    let angle = |polynomial: &str, periodic: &str| -> Result<Angle> {
        let angle = Angle { polynomial: list(body, polynomial)?, periodic: list(body, periodic)? };
        let name = format!("BODY{body}_{polynomial}");
        match angle.polynomial.len() {
            0 => {
                // Said where one of the others is.
                let there = ROTATION.map(|of| format!("BODY{body}_{of}"));
                let there = there.iter().find(|name| pool.has(name)).unwrap_or(&name);
                Err(pool.wrong(there, &format!("is not all of a rotation: {name} is missing")))
            }
            1..=MOST_COEFFICIENTS => Ok(angle),
            count => {
                Err(pool
                    .wrong(&name, &format!("has {count} coefficients: {MOST_COEFFICIENTS} at most are known to SPICE")))
            }
        }
    };
    let degree = pool.integer(&format!("BODY{barycentre}_MAX_PHASE_DEGREE"))?.unwrap_or(1);
    let terms = usize::try_from(degree).ok().filter(|degree| (1..=9).contains(degree)).map(|degree| degree + 1);
    let terms = terms.ok_or_else(|| pool.wrong(&format!("BODY{barycentre}_MAX_PHASE_DEGREE"), "must be 1 to 9"))?;
    let phases = list(barycentre, "NUT_PREC_ANGLES")?;
    let model = RotationModel {
        right_ascension: angle("POLE_RA", "NUT_PREC_RA")?,
        declination: angle("POLE_DEC", "NUT_PREC_DEC")?,
        prime_meridian: angle("PM", "NUT_PREC_PM")?,
        phases: phases.chunks(terms).map(<[f64]>::to_vec).collect(),
    };
    for (name, angle) in [("RA", &model.right_ascension), ("DEC", &model.declination), ("PM", &model.prime_meridian)] {
        if angle.periodic.len() > model.phases.len() {
            let message = format!(
                "has {} amplitudes but BODY{barycentre}_NUT_PREC_ANGLES has {} angles",
                angle.periodic.len(),
                model.phases.len()
            );
            return Err(pool.wrong(&format!("BODY{body}_NUT_PREC_{name}"), &message));
        }
    }
    Ok(Turning::Model(model))
}

/// The orientation of a fixed-offset frame, and its base.
fn fixed(frame: &Defined, pool: &Pool) -> Result<(String, Turning)> {
    let find = |of: &str| {
        let names = [frame.id.to_string(), frame.name.clone()].map(|name| format!("TKFRAME_{name}_{of}"));
        names.into_iter().find(|name| pool.has(name)).unwrap_or_else(|| format!("TKFRAME_{}_{of}", frame.id))
    };
    let (spec, relative) = (find("SPEC"), find("RELATIVE"));
    let definition = format!("FRAME_{}_NAME", frame.id);
    let unread = |what: String| Turning::Unread(Unread { at: pool.at(&definition), what });
    let (Some(spec), Some(base)) = (pool.text(&spec)?, pool.text(&relative)?) else {
        let what = format!("{}, a frame at rest without {spec} and {relative},", frame.name);
        return Ok((J2000.to_owned(), unread(what)));
    };
    let list = |of: &str, count: usize| -> Result<&[f64]> {
        let name = find(of);
        let numbers = pool.numbers(&name)?.filter(|numbers| numbers.len() == count);
        numbers.ok_or_else(|| {
            pool.wrong(if pool.has(&name) { &name } else { &definition }, &format!("{name} must have {count} numbers"))
        })
    };
    // All three give the rotation from this frame's axes to the base's.
    let base_from_frame = match spec.to_ascii_uppercase().as_str() {
        "MATRIX" => {
            let numbers = list("MATRIX", 9)?;
            let matrix = DMat3::from_cols_slice(numbers);
            rotation_near(matrix).ok_or_else(|| pool.wrong(&find("MATRIX"), "must be a rotation matrix"))?
        }
        "QUATERNION" => {
            let numbers = list("Q", 4)?;
            let q = DQuat::from_xyzw(numbers[1], numbers[2], numbers[3], numbers[0]);
            let square = q.length_squared();
            if !square.is_normal() {
                return Err(pool.wrong(&find("Q"), "must have a length above 0"));
            }
            DMat3::from_quat(q * square.sqrt().recip())
        }
        "ANGLES" => {
            let (angles, axes, units) = (list("ANGLES", 3)?, list("AXES", 3)?, find("UNITS"));
            let unit_rad = match pool.text(&units)?.unwrap_or("").to_ascii_uppercase().as_str() {
                "DEGREES" => 1_f64.to_radians(),
                "RADIANS" => 1.0,
                "ARCMINUTES" => (1.0_f64 / 60.0).to_radians(),
                "ARCSECONDS" => (1.0_f64 / 3600.0).to_radians(),
                _ => {
                    let at = if pool.has(&units) { &units } else { &definition };
                    return Err(pool.wrong(at, "UNITS must be DEGREES, RADIANS, ARCMINUTES or ARCSECONDS"));
                }
            };
            let mut matrix = DMat3::IDENTITY;
            for (angle, axis) in angles.iter().zip(axes) {
                let axis = match whole(*axis) {
                    Some(1) => DVec3::X,
                    Some(2) => DVec3::Y,
                    Some(3) => DVec3::Z,
                    _ => return Err(pool.wrong(&find("AXES"), "must each be 1, 2 or 3")),
                };
                // Axes turn by the angle, so components turn back.
                matrix *= DMat3::from_axis_angle(axis, -angle * unit_rad);
            }
            matrix
        }
        other => return Ok((frame_name(base), unread(format!("{}, a frame by {other},", frame.name)))),
    };
    Ok((frame_name(base), Turning::Fixed(base_from_frame.transpose())))
}

/// SPICE's tolerance for the columns of a rotation matrix.
const OFF: f64 = 1e-3;

/// The rotation nearest to a rounded matrix; `None` if it is too far from one.
fn rotation_near(matrix: DMat3) -> Option<DMat3> {
    let x = matrix.x_axis.try_normalize()?;
    let y = matrix.y_axis.reject_from_normalized(x).try_normalize()?;
    let near = DMat3::from_cols(x, y, x.cross(y));
    near.abs_diff_eq(matrix, OFF).then_some(near)
}
