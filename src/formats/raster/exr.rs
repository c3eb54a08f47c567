//! OpenEXR: every channel a band. Blocks are decompressed one by one, and no more of the file is held than the bands that
//! are asked for.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use exr::block::reader::ChunksReader;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::exr_cube;
use crate::formats::number::DataType;
use crate::report::{Fate, Report};

use super::{Raster, RasterBand, Reader, check_size};

/// Where a band is.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    /// Its part of the file.
    part: usize,
    /// Its place in that.
    index: usize,
    sample: SampleType,
}

/// Opens an image: the channels of its first part, and of others of the same size.
pub(super) fn open(path: &Path) -> Result<Raster> {
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|e| exr_cube::failed(path, e))?;
    let at = || Location::file(path);
    let Some(first) = meta.headers.first() else {
        return Err(Error::syntax(at(), "an OpenEXR file without a part"));
    };
    let (rows, columns) = (first.layer_size.height(), first.layer_size.width());
    let size = |header: &Header| (header.layer_size, header.own_attributes.layer_position);
    let (mut report, mut problems) = (Report::default(), Vec::new());
    let mut found: Vec<(RasterBand, Channel)> = Vec::new();
    for (part, header) in meta.headers.iter().enumerate() {
        let layer = header.own_attributes.layer_name.as_ref().map(ToString::to_string);
        if size(header) != size(first) {
            let message = format!("part {} is of another size than the first", part + 1);
            report.note(Fate::Dropped, at(), message);
            continue;
        }
        if header.deep {
            return Err(Error::Unsupported { at: at(), feature: "deep OpenEXR data".into() });
        }
        for (index, channel) in header.channels.list.iter().enumerate() {
            let name = channel.name.to_string();
            if channel.sampling.x() != 1 || channel.sampling.y() != 1 {
                let feature = "a channel that does not have every pixel".to_owned();
                return Err(Error::Unsupported { at: at().with_item(name), feature });
            }
            let centre_um = exr_cube::wavelength_um(&name);
            let name = match &layer {
                Some(layer) if meta.headers.len() > 1 => format!("{layer}.{name}"),
                _ => name,
            };
            let band = RasterBand { name, centre_um, fwhm_um: None };
            found.push((band, Channel { part, index, sample: channel.sample_type }));
        }
        // As many blocks have at least a place in a table, and a head.
        let length = std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len();
        if header.chunk_count as u64 > length / 16 {
            let message = format!("{} blocks are promised in {length} bytes: it is cut short", header.chunk_count);
            problems.push(Problem::new(at(), message));
        }
    }
    check_size(at(), rows, columns, found.len())?;
    let mut names: Vec<&str> = found.iter().map(|f| f.0.name.as_str()).collect();
    names.sort_unstable();
    for pair in names.windows(2).filter(|pair| pair[0] == pair[1]) {
        problems.push(Problem::new(at().with_item(pair[0]), "a channel of this name is there twice"));
    }
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    if found.iter().all(|f| f.0.centre_um.is_some()) {
        // Names sort as text, which is not the order of wavelength where they have no leading zeros.
        found.sort_by(|a, b| a.0.centre_um.unwrap_or(0.0).total_cmp(&b.0.centre_um.unwrap_or(0.0)));
    }
    let attributes = first.own_attributes.other.iter().chain(&first.shared_attributes.other);
    let unit = |wanted: &str| {
        attributes.clone().find_map(|(name, value)| match value {
            AttributeValue::Text(text) if *name == *wanted => Some(text.to_string()),
            _ => None,
        })
    };
    let all_f32 = found.iter().all(|f| f.1.sample != SampleType::U32);
    let (bands, channels) = found.into_iter().unzip();
    let data_type = if all_f32 { DataType::F32 } else { DataType::F64 };
    let unit = unit("radianceUnits").or_else(|| unit("emissiveUnits"));
    Ok(Raster { unit, report, ..Raster::of(path, (rows, columns), bands, data_type, Reader::Exr(channels)) })
}

/// Reads some bands, [band, row, column].
pub(super) fn read(
    path: &Path,
    (rows, columns): (usize, usize),
    channels: &[Channel],
    bands: Range<usize>,
    values: &mut [f64],
) -> Result<()> {
    let failed = |e| exr_cube::failed(path, e);
    let file = File::open(path).map_err(|e| Error::io(path, "reading", e))?;
    let reader = exr::block::read(BufReader::with_capacity(1 << 20, file), false).map_err(failed)?;
    let band_of =
        |part: usize, index: usize| channels[bands.clone()].iter().position(|c| (c.part, c.index) == (part, index));
    let of_channel: Vec<Vec<Option<usize>>> = (reader.headers().iter().enumerate())
        .map(|(part, header)| (0..header.channels.list.len()).map(|index| band_of(part, index)).collect())
        .collect();
    let mut there = vec![false; bands.len() * rows];
    let mut incomplete = None;
    let parts = of_channel.iter().map(|of| of.iter().any(Option::is_some)).collect::<Vec<_>>();
    let chunks = reader.filter_chunks(false, |_, _, block| parts[block.layer] && block.level == Vec2(0, 0));
    let insert = |meta: &exr::meta::MetaData, block: exr::block::UncompressedBlock| {
        let channel_list = &meta.headers[block.index.layer].channels;
        for line in block.lines(channel_list) {
            let Some(band) = of_channel[line.location.layer][line.location.channel] else { continue };
            let (x, y) = (line.location.position.x(), line.location.position.y());
            let start = (band * rows + y) * columns + x;
            let end = start.saturating_add(line.location.sample_count);
            let (Some(values), true) =
                (values.get_mut(start..end), y < rows && x + line.location.sample_count <= columns)
            else {
                incomplete = Some("a block lies outside the image");
                continue;
            };
            there[band * rows + y] = true;
            match channels[bands.start + band].sample {
                SampleType::F16 => put(values, line.read_samples::<f16>(), |v| f64::from(v.to_f32()))?,
                SampleType::F32 => put(values, line.read_samples::<f32>(), f64::from)?,
                SampleType::U32 => put(values, line.read_samples::<u32>(), f64::from)?,
            }
        }
        Ok(())
    };
    chunks.and_then(|chunks| chunks.decompress_sequential(false, insert)).map_err(failed)?;
    if there.contains(&false) {
        incomplete = Some("lines are missing");
    }
    match incomplete {
        Some(message) => Err(Error::syntax(Location::file(path), message)),
        None => Ok(()),
    }
}

fn put<T>(
    values: &mut [f64],
    samples: impl Iterator<Item = exr::error::Result<T>>,
    number: impl Fn(T) -> f64,
) -> exr::error::UnitResult {
    values.iter_mut().zip(samples).try_for_each(|(value, sample)| {
        *value = number(sample?);
        Ok(())
    })
}
