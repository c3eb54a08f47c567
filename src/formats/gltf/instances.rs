//! `EXT_mesh_gpu_instancing`: a node's mesh, many times.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::error::{Error, Result};

use super::accessor::Data;
use super::extensions::INSTANCING;
use super::json::{Instancing, Node, extension};

/// Where the instances of a node's mesh stand, from the node; `None` for a node that draws its mesh once, as it stands.
///
/// # Errors
/// [`Error::Invalid`] for attributes of different lengths, or a rotation that is none.
pub(super) fn instances(data: &Data<'_>, node: &Node, item: &str) -> Result<Option<(Vec<DAffine3>, Vec<String>)>> {
    let item = format!("{item}.extensions.{INSTANCING}");
    let attributes = match extension::<Instancing>(&node.extensions, INSTANCING) {
        None => return Ok(None),
        Some(Ok(instancing)) => instancing.attributes,
        Some(Err(message)) => return data.wrong(item, message),
    };
    let mut count = None;
    let mut read = |name: &str, shape: &str, width: usize| -> Result<Option<Vec<f64>>> {
        let item = format!("{item}.attributes.{name}");
        let Some(&accessor) = attributes.get(name) else { return Ok(None) };
        let numbers = data.numbers(accessor, &[shape], &item)?;
        let rows = numbers.len() / width;
        if *count.get_or_insert(rows) != rows {
            let message = format!("{rows} instances, where another attribute has {}", count.unwrap_or(0));
            return Err(Error::invalid(data.at(item), message));
        }
        Ok(Some(numbers))
    };
    let translations = read("TRANSLATION", "VEC3", 3)?;
    let rotations = read("ROTATION", "VEC4", 4)?;
    let scales = read("SCALE", "VEC3", 3)?;
    let Some(count) = count else {
        return data
            .wrong(item, "has none of TRANSLATION, ROTATION and SCALE: how many instances there are is not known");
    };
    let row = |list: &Option<Vec<f64>>, i: usize, otherwise: DVec3| {
        list.as_ref().map_or(otherwise, |list| DVec3::from_slice(&list[3 * i..]))
    };
    let mut places = Vec::with_capacity(count);
    for i in 0..count {
        let xyzw = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |r| [0, 1, 2, 3].map(|k| r[4 * i + k]));
        let rotation = DQuat::from_array(xyzw);
        if !(rotation.length() > 0.0 && rotation.length().is_finite()) {
            return data.wrong(format!("{item}.attributes.ROTATION"), format!("that of instance {i} has no length"));
        }
        places.push(DAffine3 {
            matrix3: DMat3::from_quat(rotation.normalize()) * DMat3::from_diagonal(row(&scales, i, DVec3::ONE)),
            translation: row(&translations, i, DVec3::ZERO),
        });
    }
    let others = attributes.into_keys().filter(|name| !["TRANSLATION", "ROTATION", "SCALE"].contains(&name.as_str()));
    Ok(Some((places, others.collect())))
}
