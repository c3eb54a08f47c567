//! Zarr, version 3: the image among the arrays of a group, or one array (see `arrays.rs`). Chunks as they are, by gzip, with a checksum, and in shards.
//!
//! Source: "Zarr core specification, version 3.0", and those of the codecs `bytes`, `gzip`, `crc32c` and `sharding_indexed`, version 1.0.

use std::fs;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::Value as Json;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::container::Container;
use crate::formats::format::{Format, Holds};
use crate::formats::input;
use crate::formats::number::DataType;

use super::arrays::{self, Array, BandAxis, LONGEST};
use super::{BandReader, Raster, Target};

/// Zarr.
pub(in crate::formats) static ZARR: Format = Format {
    name: "zarr",
    extensions: &["zarr"],
    reads: "version 3, not compressed or by gzip: the array of three axes, or all of two that are alike; wavelengths, where a map lies",
    writes: "version 3, not compressed, a chunk for each band",
    mark: &[],
    told: Some(|path, _| is_zarr(path).then(|| path.to_owned())),
    holds: Holds::Image { kind: "Zarr", open, target: Ok(|_| Target::Container(Container::Zarr)) },
};

/// What describes a group or an array; its text is no longer than this, bytes.
const ABOUT: &str = "zarr.json";
const LIMIT: u64 = 64 << 20;
/// A chunk has no more bytes.
const CHUNK: u64 = 1 << 30;

fn is_zarr(path: &Path) -> bool {
    path.is_dir() && [ABOUT, ".zgroup", ".zarray"].iter().any(|name| path.join(name).is_file())
}

/// Where the bands of a group are.
#[derive(Debug, Clone)]
pub(super) struct Bands {
    /// One array, or one for each band.
    stored: Vec<Stored>,
    band_axis: BandAxis,
    pub(super) count: usize,
}

/// An array as it is stored.
#[derive(Debug, Clone)]
struct Stored {
    folder: PathBuf,
    shape: Vec<usize>,
    chunk: Vec<usize>,
    data_type: DataType,
    fill: f64,
    /// What is between the name of an axis's chunks and the next axis's, and what comes first.
    separator: char,
    prefix: &'static str,
    codecs: Codecs,
    /// Within each chunk, smaller ones.
    shard: Option<Shard>,
}

/// How the bytes of a chunk are made.
#[derive(Debug, Clone, Copy, Default)]
struct Codecs {
    big_endian: bool,
    is_gzip: bool,
    has_checksum: bool,
}

impl Codecs {
    /// What a checksum is of, if there is one, and it is right.
    fn checked(self, bytes: &[u8]) -> std::result::Result<&[u8], &'static str> {
        if !self.has_checksum {
            return Ok(bytes);
        }
        let (bytes, sum) = bytes.split_last_chunk::<4>().ok_or("it has no checksum")?;
        if crc32c::crc32c(bytes) == u32::from_le_bytes(*sum) {
            Ok(bytes)
        } else {
            Err("its checksum is that of other bytes")
        }
    }
}

/// How a chunk holds smaller ones.
#[derive(Debug, Clone)]
struct Shard {
    chunk: Vec<usize>,
    codecs: Codecs,
    index: Codecs,
    index_first: bool,
}

/// What is wrong with a file of Zarr, at its place.
struct About {
    path: PathBuf,
    json: Json,
}

impl About {
    fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(ABOUT);
        let bytes = input::bytes(&path, LIMIT)?;
        let json = serde_json::from_slice(&bytes)
            .map_err(|e| Error::syntax(Location::line(&path, e.line()), format!("not JSON: {e}")))?;
        Ok(About { path, json })
    }

    fn wrong<T>(&self, key: &str, message: impl Into<String>) -> Result<T> {
        Err(Error::invalid(Location::file(&self.path).with_item(key), message.into()))
    }

    fn unsupported<T>(&self, key: &str, feature: String) -> Result<T> {
        Err(Error::Unsupported { at: Location::file(&self.path).with_item(key), feature })
    }

    fn lengths(&self, key: &str, json: &Json) -> Result<Vec<usize>> {
        let length = |n: &Json| n.as_u64().and_then(|n| usize::try_from(n).ok());
        match json.as_array().map(|list| list.iter().map(length).collect::<Option<Vec<usize>>>()) {
            Some(Some(lengths)) if lengths.len() <= 8 => Ok(lengths),
            _ => self.wrong(key, "must be a list of up to 8 lengths"),
        }
    }

    /// Codecs that make bytes of numbers.
    fn codecs(&self, key: &str, list: &Json) -> Result<Codecs> {
        let mut codecs = Codecs::default();
        for codec in list.as_array().into_iter().flatten() {
            match codec["name"].as_str().or_else(|| codec.as_str()).unwrap_or_default() {
                "bytes" => codecs.big_endian = codec["configuration"]["endian"] == "big",
                // A checksum of what is packed then would be within, where no one has it.
                "gzip" if !codecs.has_checksum => codecs.is_gzip = true,
                "crc32c" => codecs.has_checksum = true,
                other => {
                    let feature = format!(
                        "the codec {other:?}: `bytes`, `gzip`, `crc32c` and `sharding_indexed` are read (in Python: `zarr.create_array(.., compressors=None)`, \
                         or `to_zarr(.., encoding={{NAME: {{\"compressors\": None}}}})`)"
                    );
                    return self.unsupported(key, feature);
                }
            }
        }
        Ok(codecs)
    }

    fn stored(&self, folder: &Path) -> Result<Stored> {
        let json = &self.json;
        let shape = self.lengths("shape", &json["shape"])?;
        let name = json["data_type"].as_str().unwrap_or_default();
        let data_type = match name {
            "bool" | "uint8" => DataType::U8,
            "int8" => DataType::I8,
            "uint16" => DataType::U16,
            "int16" => DataType::I16,
            "uint32" => DataType::U32,
            "int32" => DataType::I32,
            "uint64" => DataType::U64,
            "int64" => DataType::I64,
            "float32" => DataType::F32,
            "float64" => DataType::F64,
            other => return self.unsupported("data_type", format!("numbers of type {other:?}")),
        };
        let grid = &json["chunk_grid"];
        if grid["name"] != "regular" {
            return self.unsupported("chunk_grid", format!("the chunk grid {}", grid["name"]));
        }
        let chunk = self.lengths("chunk_grid", &grid["configuration"]["chunk_shape"])?;
        let encoding = &json["chunk_key_encoding"];
        let (prefix, by_default) = match encoding["name"].as_str() {
            Some("default") => ("c", '/'),
            Some("v2") => ("", '.'),
            _ => return self.unsupported("chunk_key_encoding", format!("chunks named by {}", encoding["name"])),
        };
        let separator = match encoding["configuration"]["separator"].as_str() {
            Some("/") => '/',
            Some(".") => '.',
            _ => by_default,
        };
        let fill = match &json["fill_value"] {
            Json::Number(n) => n.as_f64().unwrap_or(0.0),
            Json::String(text) if text == "Infinity" => f64::INFINITY,
            Json::String(text) if text == "-Infinity" => f64::NEG_INFINITY,
            Json::String(_) => f64::NAN,
            _ => 0.0,
        };
        let list = &json["codecs"];
        let (codecs, shard) = match &list[0] {
            only if only["name"] == "sharding_indexed" => {
                let of = &only["configuration"];
                let shard = Shard {
                    chunk: self.lengths("codecs", &of["chunk_shape"])?,
                    codecs: self.codecs("codecs", &of["codecs"])?,
                    index: self.codecs("codecs", &of["index_codecs"])?,
                    index_first: of["index_location"] == "start",
                };
                if list.as_array().is_some_and(|list| list.len() > 1) || shard.index.is_gzip {
                    return self.unsupported("codecs", "shards that are compressed as a whole".to_owned());
                }
                (Codecs::default(), Some(shard))
            }
            _ => (self.codecs("codecs", list)?, None),
        };
        let small = shard.as_ref().map_or(&chunk, |shard| &shard.chunk);
        let fits =
            chunk.len() == shape.len() && small.len() == shape.len() && !chunk.contains(&0) && !small.contains(&0);
        let whole = chunk.iter().zip(small).all(|(chunk, small)| chunk % small.max(&1) == 0);
        let bytes = small.iter().try_fold(data_type.bytes() as u64, |n, length| n.checked_mul(*length as u64));
        if !fits || !whole || bytes.is_none_or(|bytes| bytes > CHUNK) {
            return self.wrong("chunk_grid", format!("chunks of {chunk:?} do not fit an array of {shape:?}"));
        }
        Ok(Stored { folder: folder.to_owned(), shape, chunk, data_type, fill, separator, prefix, codecs, shard })
    }

    fn no_data(&self) -> Option<f64> {
        self.json["attributes"]["_FillValue"].as_f64()
    }

    fn array(&self, name: &str, stored: &Stored) -> Array {
        let text = |key: &str| self.json["attributes"][key].as_str().map(str::to_owned);
        let axis =
            |i: usize| self.json["dimension_names"][i].as_str().map_or_else(|| format!("axis {i}"), str::to_owned);
        let coordinates = text("coordinates");
        Array {
            name: name.to_owned(),
            axes: stored.shape.iter().enumerate().map(|(i, length)| (axis(i), *length)).collect(),
            is_number: true,
            unit: text("units"),
            standard_name: text("standard_name"),
            coordinates: coordinates.iter().flat_map(|all| all.split_whitespace().map(str::to_owned)).collect(),
            band_names: text("band_names"),
            values: None,
        }
    }
}

/// Opens a group, or an array.
fn open(path: &Path) -> Result<Raster> {
    if !path.join(ABOUT).is_file() {
        let problem = Problem::new(Location::file(path), "is Zarr of version 2, or none");
        return Err(Error::Invalid(vec![problem.with_help("write it as version 3: `to_zarr(.., zarr_format=3)`")]));
    }
    let about = About::read(path)?;
    // Arrays, how they are stored, and the number that stands for no data.
    let mut found: Vec<(Array, Stored, Option<f64>)> = Vec::new();
    if about.json["node_type"] == "array" {
        let stored = about.stored(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        found.push((about.array(&name, &stored), stored, about.no_data()));
    } else {
        let entries = fs::read_dir(path).map_err(|e| Error::io(path, "reading", e))?;
        let mut folders: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        folders.sort();
        let mut refused = None;
        for folder in folders.iter().filter(|folder| folder.join(ABOUT).is_file()) {
            let about = About::read(folder)?;
            if about.json["node_type"] != "array" {
                continue;
            }
            // One that is not read may be none that is needed, such as a list of names.
            match about.stored(folder) {
                Ok(stored) => {
                    let name = folder.file_name().unwrap_or_default().to_string_lossy();
                    found.push((about.array(&name, &stored), stored, about.no_data()));
                }
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        if let (true, Some(error)) = (found.iter().all(|(array, ..)| array.axes.len() < 2), refused) {
            return Err(error);
        }
    }
    for (array, stored, _) in &mut found {
        if stored.shape.len() == 1 && stored.shape[0] <= LONGEST {
            let mut values = vec![0.0; stored.shape[0]];
            let all: Vec<Range<usize>> = stored.shape.iter().map(|length| 0..*length).collect();
            stored.read(&all, &mut values)?;
            array.values = Some(values);
        }
    }
    let arrays: Vec<Array> = found.iter().map(|(array, ..)| array.clone()).collect();
    let image = arrays::image(path, &arrays)?;
    let stored: Vec<Stored> = image.arrays.iter().map(|i| found[*i].1.clone()).collect();
    let data_type = match stored.iter().all(|of| of.data_type == stored[0].data_type) {
        true => stored[0].data_type,
        false => DataType::F64,
    };
    let ignore = found[image.arrays[0]].2;
    let reader = BandReader::Zarr(Bands { stored, band_axis: image.band_axis, count: image.bands.len() });
    Ok(Raster { ignore, ..image.raster(path, data_type, reader) })
}

impl Bands {
    /// How many bands are read in one go, where so many fit into the memory for them.
    pub(super) fn together(&self, fit: usize) -> usize {
        let Some(first) = self.stored.first() else { return 1 };
        let small = first.shard.as_ref().map_or(&first.chunk, |shard| &shard.chunk);
        match self.band_axis {
            BandAxis::None => 1,
            BandAxis::Last => fit,
            BandAxis::First => fit.min(small.iter().rev().nth(2).copied().unwrap_or(1)),
        }
    }

    /// Reads some bands, [band, row, column].
    pub(super) fn read(&self, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
        let ranges = |of: &Stored, bands: Range<usize>| {
            let mut ranges: Vec<Range<usize>> = of.shape.iter().map(|length| 0..*length).collect();
            let count = ranges.len();
            match self.band_axis {
                BandAxis::None => {}
                BandAxis::First => ranges[count - 3] = bands,
                BandAxis::Last => ranges[count - 1] = bands,
            }
            ranges
        };
        let pixels = values.len() / bands.len().max(1);
        match self.band_axis {
            BandAxis::None => bands.zip(values.chunks_exact_mut(pixels)).try_for_each(|(band, plane)| {
                let of = &self.stored[band];
                of.read(&ranges(of, 0..1), plane)
            }),
            BandAxis::First => self.stored[0].read(&ranges(&self.stored[0], bands), values),
            BandAxis::Last => {
                let count = bands.len();
                let mut mixed = vec![0.0; values.len()];
                self.stored[0].read(&ranges(&self.stored[0], bands), &mut mixed)?;
                for (i, value) in mixed.iter().enumerate() {
                    values[i % count * pixels + i / count] = *value;
                }
                Ok(())
            }
        }
    }
}

impl Stored {
    /// Reads a part of the array, [..axes of it].
    fn read(&self, part: &[Range<usize>], values: &mut [f64]) -> Result<()> {
        values.fill(self.fill);
        for at in places(part, &self.chunk) {
            let names: Vec<String> = at.iter().map(ToString::to_string).collect();
            let before = Some(self.prefix.to_owned()).filter(|prefix| !prefix.is_empty());
            let name = before.into_iter().chain(names).collect::<Vec<_>>().join(&self.separator.to_string());
            let path = self.folder.join(name);
            if !path.is_file() {
                // A chunk that is not there is all of the number that fills.
                continue;
            }
            let first: Vec<usize> = at.iter().zip(&self.chunk).map(|(at, length)| at * length).collect();
            match &self.shard {
                None => {
                    let bytes = input::bytes(&path, 2 * CHUNK)?;
                    self.place(&path, &bytes, self.codecs, (&first, &self.chunk), part, values)?;
                }
                Some(shard) => self.read_shard(&path, shard, &first, part, values)?,
            }
        }
        Ok(())
    }

    /// Reads the chunks of a shard that a part of the array needs.
    fn read_shard(
        &self,
        path: &Path,
        shard: &Shard,
        first: &[usize],
        part: &[Range<usize>],
        values: &mut [f64],
    ) -> Result<()> {
        let reading = |e| Error::io(path, "reading", e);
        let broken = |what: &str| Error::syntax(Location::file(path), format!("not a complete shard of Zarr: {what}"));
        let counts: Vec<usize> = self.chunk.iter().zip(&shard.chunk).map(|(chunk, small)| chunk / small).collect();
        let count = counts.iter().try_fold(1usize, |n, count| n.checked_mul(*count)).filter(|n| *n < 1 << 26);
        let count = count.ok_or_else(|| broken("it would hold more chunks than any"))?;
        let length = 16 * count as u64 + if shard.index.has_checksum { 4 } else { 0 };
        let mut file = input::open(path).map_err(reading)?;
        let there = file.metadata().map_err(reading)?.len();
        let start = if shard.index_first { Some(0) } else { there.checked_sub(length) };
        let start =
            start.filter(|start| start + length <= there).ok_or_else(|| broken("it ends before its list of chunks"))?;
        #[expect(clippy::cast_possible_truncation, reason = "16 times less than 2^26, and 4")]
        let mut index = vec![0; length as usize];
        file.seek(SeekFrom::Start(start)).and_then(|_| file.read_exact(&mut index)).map_err(reading)?;
        let index = shard.index.checked(&index).map_err(|what| broken(&format!("its list of chunks: {what}")))?;
        let number = |i: usize| {
            let bytes = std::array::from_fn(|k| index[8 * i + k]);
            if shard.index.big_endian { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) }
        };
        // The part, from the first number of the shard on, as far as it lies in it.
        let within: Vec<Range<usize>> = part
            .iter()
            .zip(first)
            .zip(&self.chunk)
            .map(|((part, first), length)| {
                part.start.saturating_sub(*first)..part.end.saturating_sub(*first).min(*length)
            })
            .collect();
        for at in places(&within, &shard.chunk) {
            let which = at.iter().zip(&counts).fold(0, |n, (at, count)| n * count + at);
            let (offset, bytes) = (number(2 * which), number(2 * which + 1));
            if offset == u64::MAX && bytes == u64::MAX {
                continue;
            }
            if bytes > 2 * CHUNK || offset.checked_add(bytes).is_none_or(|end| end > there) {
                return Err(broken("a chunk would lie beyond its end"));
            }
            #[expect(clippy::cast_possible_truncation, reason = "no more than two GiB")]
            let mut chunk = vec![0; bytes as usize];
            file.seek(SeekFrom::Start(offset)).and_then(|_| file.read_exact(&mut chunk)).map_err(reading)?;
            let first: Vec<usize> =
                at.iter().zip(&shard.chunk).zip(first).map(|((at, length), first)| first + at * length).collect();
            self.place(path, &chunk, shard.codecs, (&first, &shard.chunk), part, values)?;
        }
        Ok(())
    }

    /// Puts the numbers of a chunk where they belong.
    fn place(
        &self,
        path: &Path,
        bytes: &[u8],
        codecs: Codecs,
        (first, shape): (&[usize], &[usize]),
        part: &[Range<usize>],
        values: &mut [f64],
    ) -> Result<()> {
        let broken = |what: &str| Error::syntax(Location::file(path), format!("not a complete chunk of Zarr: {what}"));
        let bytes = codecs.checked(bytes).map_err(broken)?;
        let wanted = shape.iter().product::<usize>() * self.data_type.bytes();
        let mut unpacked = Vec::new();
        let bytes = if codecs.is_gzip {
            flate2::read::MultiGzDecoder::new(bytes)
                .take(wanted as u64)
                .read_to_end(&mut unpacked)
                .map_err(|e| broken(&e.to_string()))?;
            &unpacked[..]
        } else {
            bytes
        };
        if bytes.len() != wanted {
            return Err(broken(&format!("{} bytes where {wanted} belong", bytes.len())));
        }
        let mut numbers = vec![0.0; shape.iter().product()];
        self.data_type.decode(codecs.big_endian, bytes, &mut numbers);
        // The last axis in runs.
        let Some((last, before)) = shape.split_last() else {
            values.iter_mut().zip(&numbers).for_each(|(value, number)| *value = *number);
            return Ok(());
        };
        let n = shape.len() - 1;
        let run = part[n].start.max(first[n])..part[n].end.min(first[n] + last);
        if run.is_empty() {
            return Ok(());
        }
        let rows: usize = before.iter().product();
        for row in 0..rows {
            let (mut rest, mut to, mut step, mut is_within) = (row, 0, part[n].len(), true);
            for axis in (0..n).rev() {
                let at = first[axis] + rest % shape[axis];
                rest /= shape[axis];
                is_within &= part[axis].contains(&at);
                to += at.saturating_sub(part[axis].start) * step;
                step *= part[axis].len();
            }
            if is_within {
                let from = row * last + run.start - first[n];
                values[to + run.start - part[n].start..][..run.len()].copy_from_slice(&numbers[from..][..run.len()]);
            }
        }
        Ok(())
    }
}

/// Numbers of the chunks of this shape that a part of an array lies in, the last axis fastest.
fn places(part: &[Range<usize>], chunk: &[usize]) -> Vec<Vec<usize>> {
    let mut places = vec![Vec::new()];
    for (range, length) in part.iter().zip(chunk) {
        let of_axis = if range.is_empty() { 0..0 } else { range.start / length..(range.end - 1) / length + 1 };
        places = places
            .into_iter()
            .flat_map(|before| of_axis.clone().map(move |at| [before.as_slice(), &[at]].concat()))
            .collect();
    }
    places
}
