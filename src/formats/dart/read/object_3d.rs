//! object_3d.xml: objects, their groups and what these are made of, and fields of objects.

use std::path::Path;

use glam::DVec3;

use crate::error::{Location, Problem, Result};
use crate::formats::input;
use crate::formats::xml::Element;
use crate::geometry::whole_u32;
use crate::report::Fate;

use super::super::{FieldInstance, Group, Links, Object, ObjectField};
use super::reading::{Reading, number, wrapped};

/// No text of an object field is longer, bytes.
const FIELD_TEXT: u64 = 256 << 20;
/// Turbid media, elements with their own properties, and what versions that are not known may have.
const UNKNOWN_MATERIAL: &str = "what this is made of: no `<OpticalPropertyLink>` stands here";
const NO_SCALE: &str = "a scale of 0 leaves nothing of the object: give it another";
/// No object field has more places.
const PLACES: usize = 2_000_000;

pub(super) fn objects(object_3d: &Element, reading: &mut Reading) -> Vec<Object> {
    let list = object_3d.child("ObjectList");
    list.iter().flat_map(|list| list.all("Object")).map(|element| object(element, reading)).collect()
}

fn object(element: &Element, reading: &mut Reading) -> Object {
    let file = reading.text(element, "file_src");
    if element.get("file_src").is_some()
        && let Err(problem) = reading.folder.locate(&file, &element.at_attribute("file_src"))
    {
        reading.problems.push(|| problem);
    }
    let geometry = reading.child(element, "GeometricProperties");
    let position = geometry.and_then(|g| reading.child(g, "PositionProperties"));
    let mut three = |parent: Option<&Element>, names: [&str; 3], default: f64| {
        DVec3::from_array(names.map(|name| parent.map_or(default, |e| reading.number_or(e, name, default))))
    };
    let position_m = three(position, ["xpos", "ypos", "zpos"], 0.0);
    let scale = three(geometry.and_then(|g| g.child("ScaleProperties")), ["xscale", "yscale", "zscale"], 1.0);
    let rotation_deg = three(geometry.and_then(|g| g.child("RotationProperties")), ["xrot", "yrot", "zrot"], 0.0);
    if scale.to_array().contains(&0.0) {
        reading.problem(element.at(), NO_SCALE);
    }

    let has_groups = reading.flag(element, "hasGroups");
    let optics = reading.child(element, "ObjectOpticalProperties");
    // One property for all groups; from 5.10 temperatures have a switch of their own.
    let same_optical = !has_groups || optics.is_some_and(|o| reading.flag(o, "sameOPObject"));
    let same_thermal = match optics {
        Some(o) if has_groups && o.get("sameExitanceObject").is_some() => reading.flag(o, "sameExitanceObject"),
        _ => same_optical,
    };
    let double_face = optics.is_some_and(|o| is_double(o, reading));
    let (mut links_of_all, mut back_of_all) = (None, None);
    if let Some(o) = optics.filter(|_| same_optical && same_thermal) {
        links_of_all = reading.links(o, None);
        back_of_all = back(o, None, reading).filter(|_| double_face);
        if links_of_all.is_none() {
            reading.note(Fate::Dropped, o.at(), UNKNOWN_MATERIAL);
        }
    }
    let mut groups = Vec::new();
    if has_groups {
        let shared = Shared {
            optical: optics.filter(|_| same_optical && !same_thermal),
            thermal: optics.filter(|_| same_thermal && !same_optical),
            all: same_optical && same_thermal,
        };
        if let Some(list) = reading.child(element, "Groups") {
            groups.extend(list.all("Group").map(|g| group(g, &shared, reading)));
        }
    }
    Object {
        name: element.get("name").unwrap_or_default().to_owned(),
        file,
        position_m,
        scale,
        rotation_deg,
        dem_mode: reading.code(element, "objectDEMMode", 0, 3),
        hidden: reading.flag(element, "hidden"),
        repeated_on_border: reading.code(element, "repeatedOnBorder", 1, 1) == 1,
        double_face,
        links: links_of_all,
        back: back_of_all,
        groups,
        at: element.at(),
    }
}

/// What groups have from their object.
struct Shared<'e> {
    optical: Option<&'e Element>,
    thermal: Option<&'e Element>,
    /// Everything: groups have no links.
    all: bool,
}

fn group(element: &Element, shared: &Shared, reading: &mut Reading) -> Group {
    let optics = element.child("GroupOpticalProperties");
    let double_face = optics.is_some_and(|o| is_double(o, reading));
    let (mut front, mut behind) = (None, None);
    // A group that DART turns into a turbid medium has no surface; that is reported elsewhere.
    if let Some(o) = optics.filter(|_| !shared.all) {
        front = match shared.optical {
            Some(object) => reading.links(object, Some(o)),
            None => reading.links(o, shared.thermal),
        };
        behind = back(o, shared.thermal, reading).filter(|_| double_face);
        if front.is_none() {
            reading.note(Fate::Dropped, o.at(), UNKNOWN_MATERIAL);
        }
    }
    Group {
        number: reading.integer(element, "num"),
        name: element.get("name").unwrap_or_default().to_owned(),
        hidden: reading.flag(element, "hidden"),
        double_face,
        links: front,
        back: behind,
        at: element.at(),
    }
}

fn is_double(optics: &Element, reading: &mut Reading) -> bool {
    // From 5.10 the switch stands in a wrapper.
    let wrapped = optics.child("SurfaceOpticalProperties");
    reading.flag(optics, "doubleFace") || wrapped.is_some_and(|w| reading.flag(w, "doubleFace"))
}

/// The links of back faces, if there are any.
fn back(element: &Element, thermal: Option<&Element>, reading: &mut Reading) -> Option<Links> {
    let optical = wrapped(element, "SurfaceOpticalProperties", "BackFaceOpticalProperty")?;
    let thermal = wrapped(thermal.unwrap_or(element), "SurfaceExitanceProperties", "BackFaceThermalProperty");
    let optical = reading.child(optical, "OpticalPropertyLink")?;
    Some(reading.pair(optical, thermal.and_then(|t| t.child("ThermalPropertyLink"))))
}

pub(super) fn fields(object_3d: &Element, reading: &mut Reading) -> Vec<ObjectField> {
    let list = object_3d.child("ObjectFields");
    list.iter().flat_map(|list| list.all("Field")).filter_map(|element| field(element, reading)).collect()
}

fn field(element: &Element, reading: &mut Reading) -> Option<ObjectField> {
    let file = reading.text(element, "fieldDescriptionFileName");
    let models: Vec<Object> =
        element.child("ModelList").iter().flat_map(|l| l.all("Object")).map(|o| object(o, reading)).collect();
    let at = element.at_attribute("fieldDescriptionFileName");
    let name = element.get("name").unwrap_or_default().to_owned();
    let path = match reading.folder.locate(&file, &at) {
        Ok(Some(path)) => path,
        Ok(None) => {
            reading.note(Fate::Dropped, at, format!("an object field whose text `{file}` is not in the input folder"));
            return Some(ObjectField { name, file, models, places: Vec::new(), at: element.at() });
        }
        Err(problem) => {
            reading.problems.push(|| problem);
            return None;
        }
    };
    let text = match input::text(&path, FIELD_TEXT) {
        Ok((text, file)) => {
            reading.inputs.push(file);
            text
        }
        Err(error) => {
            reading.problem(at, error.to_string());
            return None;
        }
    };
    let places = places(&text, &path, &models, reading);
    if places.is_empty() {
        reading.note(Fate::Defaulted, at, format!("the object field {name:?} has no places: nothing stands in it"));
    }
    Some(ObjectField { name, file, models, places, at: element.at() })
}

/// The lines of a field's text: `index x y z sx sy sz xrot yrot zrot` below the line `complete transformation`, else
/// `index x y`.
fn places(text: &str, path: &Path, models: &[Object], reading: &mut Reading) -> Vec<FieldInstance> {
    let text = without_comments(text);
    let (mut places, mut complete, mut first) = (Vec::new(), false, true);
    let mut start = 0;
    for raw in text.split_inclusive('\n') {
        let line = raw.trim();
        let at = || Location::span(path, &text, start, start + raw.trim_end().len());
        if line.is_empty() {
        } else if first && is_heading(line) {
            (complete, first) = (true, false);
        } else {
            first = false;
            let numbers: Option<Vec<f64>> = line.split_whitespace().map(number).collect();
            let model = numbers.as_ref().and_then(|n| n.first()).filter(|i| i.fract() == 0.0);
            let model = model.filter(|i| (0.0..models.len() as f64).contains(*i)).map(|i| whole_u32(*i));
            match (model, numbers.as_deref()) {
                (Some(model), Some(&[_, x, y, z, sx, sy, sz, xr, yr, zr])) if complete => {
                    if [sx, sy, sz].contains(&0.0) {
                        reading.problems.push(|| Problem::new(at(), NO_SCALE));
                    }
                    places.push(FieldInstance {
                        model,
                        position_m: DVec3::new(x, y, z),
                        scale: DVec3::new(sx, sy, sz),
                        rotation_deg: DVec3::new(xr, yr, zr),
                    });
                }
                (Some(model), Some(&[_, x, y])) if !complete => {
                    let Object { position_m, scale, rotation_deg, .. } = models[model as usize];
                    places.push(FieldInstance {
                        model,
                        position_m: DVec3::new(x, y, position_m.z),
                        scale,
                        rotation_deg,
                    });
                }
                (None, Some([index, ..])) => {
                    let message = format!("model {index}: the field has {} models, counted from 0", models.len());
                    reading.problems.push(|| Problem::new(at(), message));
                }
                _ => {
                    let wanted = if complete { "index x y z sx sy sz xrot yrot zrot" } else { "index x y" };
                    reading.problems.push(|| Problem::new(at(), format!("a line of `{wanted}` belongs here")));
                }
            }
            if places.len() > PLACES {
                reading.problem(at(), format!("more than {PLACES} places"));
                return places;
            }
        }
        start += raw.len();
    }
    if !complete && !places.is_empty() {
        let message = "places without a transformation: DART turns and scales such objects at random, here all are as their model";
        reading.note(Fate::Approximated, Location::file(path), message);
    }
    places
}

/// The line above places with all of their scale and rotation.
fn is_heading(line: &str) -> bool {
    let mut words = line.split_whitespace();
    let mut is = |wanted: &str| words.next().is_some_and(|word| word.eq_ignore_ascii_case(wanted));
    is("complete") && is("transformation") && words.next().is_none()
}

/// The first number of a field's text that has an exponent, which DART does not read.
///
/// # Errors
/// As [`input::text`].
pub(in crate::formats::dart) fn first_exponent(path: &Path) -> Result<Option<Location>> {
    let (text, _) = input::text(path, FIELD_TEXT)?;
    let text = without_comments(&text);
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let mut words = line.split_whitespace();
        if words.any(|word| word.contains(['e', 'E']) && number(word).is_some()) {
            return Ok(Some(Location::span(path, &text, start, start + line.trim_end().len())));
        }
        start += line.len();
    }
    Ok(None)
}

/// The text with blanks where comments were, `/* */` and `//`, so that places stay the same.
fn without_comments(text: &str) -> String {
    let mut clean = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(i) = rest.find('/') {
        clean.push_str(&rest[..i]);
        let comment = &rest[i..];
        let length = match comment.as_bytes().get(1) {
            Some(b'*') => comment[2..].find("*/").map_or(comment.len(), |end| end + 4),
            Some(b'/') => comment.find('\n').unwrap_or(comment.len()),
            _ => {
                clean.push('/');
                rest = &comment[1..];
                continue;
            }
        };
        clean.extend(comment[..length].bytes().map(|b| if b == b'\n' { '\n' } else { ' ' }));
        rest = &comment[length..];
    }
    clean.push_str(rest);
    clean
}
