//! Zarr, version 3, as it is written: a folder for each array, whose numbers are one file, uncompressed, of chunks one behind the other.
//!
//! Source: "Zarr core specification, version 3.0", and of its codecs `sharding_indexed`, version 1.0: a file that holds many chunks, with a list of them at its
//! end. A chunk is a band, or all of an array of two axes.

use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value as Json, json};

use super::dataset::{Attributes, Dataset, Slot, Value, Variable};
use super::number::DataType;
use crate::error::{Error, Result};

/// The name of what describes a group or an array.
const ABOUT: &str = "zarr.json";

/// The name of a type.
fn name(data_type: DataType) -> &'static str {
    match data_type {
        DataType::U8 => "uint8",
        DataType::I8 => "int8",
        DataType::U16 => "uint16",
        DataType::I16 => "int16",
        DataType::U32 => "uint32",
        DataType::I32 => "int32",
        DataType::U64 => "uint64",
        DataType::I64 => "int64",
        DataType::F32 => "float32",
        DataType::F64 => "float64",
    }
}

/// A number in JSON, which has no NaN.
fn number(value: f64) -> Json {
    if value.is_finite() {
        return json!(value);
    }
    json!(if value.is_nan() {
        "NaN"
    } else if value > 0.0 {
        "Infinity"
    } else {
        "-Infinity"
    })
}

fn attributes(attributes: &Attributes) -> Map<String, Json> {
    let value = |value: &Value| match value {
        Value::Text(text) => json!(text),
        Value::Sample(sample) => number(*sample),
    };
    // NaN needs no mark.
    let is_nan = |value: &Value| matches!(value, Value::Sample(number) if number.is_nan());
    let of = attributes.iter().filter(|(_, value)| !is_nan(value));
    of.map(|(name, of)| ((*name).to_owned(), value(of))).collect()
}

/// Chunks of a variable: how many, and of what shape.
fn chunks(shape: &[usize]) -> (usize, Vec<usize>) {
    match shape {
        [bands, within @ ..] if within.len() > 1 => (*bands, [&[1], within].concat()),
        _ => (1, shape.to_vec()),
    }
}

/// The folder of a variable, and the one file of its numbers.
fn files(path: &Path, variable: &Variable<'_>) -> (PathBuf, PathBuf) {
    let folder = path.join(&variable.name);
    let mut numbers = folder.join("c");
    variable.axes.iter().for_each(|_| numbers.push("0"));
    (folder, numbers)
}

fn about(data: &Dataset<'_>, variable: &Variable<'_>) -> Json {
    let shape = data.shape(variable);
    let (_, chunk) = chunks(&shape);
    let bytes = json!({ "name": "bytes", "configuration": { "endian": "little" } });
    let names: Vec<&str> = variable.axes.iter().map(|axis| data.axes[*axis].name).collect();
    let fill = variable.attributes.iter().find_map(|(name, value)| match value {
        Value::Sample(value) if *name == "_FillValue" => Some(number(*value)),
        _ => None,
    });
    let none = if variable.data_type.is_integer() { json!(0) } else { json!("NaN") };
    json!({
        "zarr_format": 3,
        "node_type": "array",
        "shape": shape,
        "data_type": name(variable.data_type),
        "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": shape } },
        "chunk_key_encoding": { "name": "default", "configuration": { "separator": "/" } },
        "fill_value": fill.unwrap_or(none),
        "codecs": [{ "name": "sharding_indexed", "configuration": {
            "chunk_shape": chunk, "codecs": [bytes], "index_codecs": [bytes], "index_location": "end",
        } }],
        "attributes": attributes(&variable.attributes),
        "dimension_names": names,
    })
}

/// Where the numbers of each variable go.
pub(super) fn slots(path: &Path, data: &Dataset<'_>) -> Vec<Slot> {
    let slot = |variable| Slot { path: files(path, variable).1, start: 0, big_endian: false };
    data.variables.iter().map(slot).collect()
}

/// Writes what describes the arrays and the group: they are then whole.
///
/// # Errors
/// [`Error::Io`].
pub(super) fn finish(path: &Path, data: &Dataset<'_>) -> Result<()> {
    let write = |path: &Path, json: &Json| {
        let text = serde_json::to_string_pretty(json).map_err(std::io::Error::other);
        text.and_then(|text| fs::write(path, text + "\n")).map_err(|e| Error::io(path, "writing", e))
    };
    let mut metadata = Map::new();
    for variable in &data.variables {
        let (folder, numbers) = files(path, variable);
        let about = about(data, variable);
        write(&folder.join(ABOUT), &about)?;
        metadata.insert(variable.name.clone(), about);
        let (count, _) = chunks(&data.shape(variable));
        let bytes = data.bytes(variable);
        // Where each chunk begins, and its bytes.
        let each = bytes / (count as u64).max(1);
        let list: Vec<u8> = (0..count as u64).flat_map(|i| [i * each, each]).flat_map(u64::to_le_bytes).collect();
        let append = || {
            let mut file = File::options().write(true).open(&numbers)?;
            file.seek(SeekFrom::Start(bytes))?;
            file.write_all(&list)
        };
        append().map_err(|e| Error::io(&numbers, "writing", e))?;
    }
    let mut of_group = attributes(&data.attributes);
    for text in &data.texts {
        // Reports are JSON already.
        let value = serde_json::from_str(&text.text).unwrap_or_else(|_| json!(text.text));
        of_group.insert(text.name.to_owned(), value);
    }
    let consolidated = json!({ "kind": "inline", "must_understand": false, "metadata": metadata });
    let group = json!({
        "zarr_format": 3, "node_type": "group", "attributes": of_group, "consolidated_metadata": consolidated,
    });
    write(&path.join(ABOUT), &group)
}
