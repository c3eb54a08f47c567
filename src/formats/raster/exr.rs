//! OpenEXR: every channel a band. A file keeps all channels of a few lines together, compressed as one: it is read once, on all
//! threads, and all bands are held as they are stored.

use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::chunk::Chunk;
use exr::block::reader::ChunksReader;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, LevelMode, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;
use rayon::prelude::*;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::exr_cube;
use crate::formats::format::{Format, Holds};
use crate::formats::input::MOST_DEFLATED;
use crate::formats::marks;
use crate::formats::number::{DataType, single};
use crate::geometry::index_u32;
use crate::report::{Fate, Report};

use super::layers::{self, Layer};
use super::{BandReader, PASS_BYTES, Raster, RasterBand, Target, check_size, names};
use crate::formats::input;

/// An OpenEXR image.
pub(in crate::formats) static OPEN_EXR: Format = Format {
    name: "exr",
    extensions: &["exr"],
    reads: "channels, wavelengths",
    writes: "the same, f32",
    mark: marks::OPEN_EXR,
    told: None,
    holds: Holds::Image { kind: "OpenEXR image", open, target: Ok(|_| Target::Exr) },
};

/// All bands of a file are held in memory up to this size, or as many as fit.
const HELD_BYTES: usize = 8 << 30;
/// Blocks that are decompressed at a time, for each thread.
const AHEAD: usize = 4;

/// A file.
#[derive(Debug, Clone)]
pub(super) struct Channels {
    /// For each band.
    list: Vec<Channel>,
    /// Where the data window of each part begins in the image; lines and columns may be negative.
    corners: Vec<[i64; 2]>,
    /// Whether parts of the image have no data.
    has_margin: bool,
    file_bytes: u64,
}

/// Where a band is.
#[derive(Debug, Clone)]
struct Channel {
    /// Its part of the file.
    part: usize,
    /// Its place in that.
    index: usize,
    sample: SampleType,
}

impl Channels {
    /// Number of bands.
    pub(super) fn count(&self) -> usize {
        self.list.len()
    }

    /// Whether all numbers of a band are f32, or less.
    pub(super) fn are_f32(&self) -> bool {
        self.list.iter().all(|channel| channel.sample != SampleType::U32)
    }

    /// A number as a band's type holds it.
    pub(super) fn as_stored(&self, band: usize, number: f64) -> f64 {
        match self.list.get(band).map(|channel| channel.sample) {
            Some(SampleType::F16) => f64::from(f16::from_f64(number).to_f32()),
            Some(SampleType::F32) => f64::from(single(number)),
            Some(SampleType::U32) | None => number,
        }
    }

    /// Bands that are read together.
    pub(super) fn together(&self, pixels: usize) -> usize {
        let bytes = if self.are_f32() { 4 } else { 8 };
        // A small file may claim a large image: of what it cannot fill no more is held than of others.
        let most = HELD_BYTES
            .min(usize::try_from(self.file_bytes.saturating_mul(MOST_DEFLATED)).unwrap_or(usize::MAX))
            .max(PASS_BYTES);
        (most / (bytes * pixels)).max(1)
    }
}

/// Opens an image: all its parts, on the display window.
pub(super) fn open(path: &Path) -> Result<Raster> {
    let meta = MetaData::read_from_file(path, false).map_err(|e| exr_cube::failed(path, e))?;
    let at = || Location::file(path);
    let Some(first) = meta.headers.first() else {
        return Err(Error::syntax(at(), "an OpenEXR file without a part"));
    };
    let window = first.shared_attributes.display_window;
    let (rows, columns) = (window.size.height(), window.size.width());
    check_size(at().with_item("displayWindow"), rows, columns, 1)?;
    let (mut report, mut problems) = (Report::default(), Vec::new());
    let mut found: Vec<(RasterBand, Channel)> = Vec::new();
    let mut corners = Vec::new();
    let mut has_margin = false;
    let length = std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len();
    for (part, header) in meta.headers.iter().enumerate() {
        let name = header.own_attributes.layer_name.as_ref().map(ToString::to_string);
        let called =
            name.as_ref().map_or_else(|| format!("part {}", part + 1), |name| format!("part {} ({name})", part + 1));
        let begins = header.own_attributes.layer_position;
        let corner = [
            i64::from(begins.x()) - i64::from(window.position.x()),
            i64::from(begins.y()) - i64::from(window.position.y()),
        ];
        corners.push(corner);
        if header.deep {
            report.note(Fate::Dropped, at(), format!("{called}: deep data, which are not read"));
            continue;
        }
        let margins = margins(header, corner, [columns, rows]);
        if !margins.overlaps {
            let message = format!("{called}: its data window lies outside the display window, {columns} x {rows}");
            report.note(Fate::Dropped, at(), message);
            continue;
        }
        if margins.cut {
            report.note(Fate::Dropped, at(), format!("{called}: what its data window holds beyond the display window"));
        }
        if margins.leaves {
            let size = header.layer_size;
            let message = format!(
                "{called}: holds {} x {} pixels, from column {} and row {}, of an image of {columns} x {rows}: the others have no data",
                size.width(),
                size.height(),
                corner[0],
                corner[1]
            );
            report.note(Fate::Defaulted, at(), message);
            has_margin = true;
        }
        if let BlockDescription::Tiles(tiles) = header.blocks
            && tiles.level_mode != LevelMode::Singular
        {
            report.note(Fate::Dropped, at(), format!("{called}: all but the first of its levels of detail"));
        }
        let widths_um = text(header, exr_cube::WIDTHS)
            .and_then(|widths| exr_cube::read_widths(&widths, header.channels.list.len()))
            .unwrap_or_default();
        for (index, channel) in header.channels.list.iter().enumerate() {
            let text = utf8(&channel.name.to_string());
            if channel.sampling.x() != 1 || channel.sampling.y() != 1 {
                let feature = "a channel that does not have every pixel".to_owned();
                return Err(Error::Unsupported { at: at().with_item(text), feature });
            }
            let text = match &name {
                Some(name) if meta.headers.len() > 1 && !text.starts_with(&format!("{name}.")) => {
                    format!("{name}.{text}")
                }
                _ => text,
            };
            let wavelength = names::wavelength(&text);
            let band = RasterBand {
                name: text,
                centre_um: wavelength.map(|w| w.centre_um),
                fwhm_um: wavelength.and_then(|w| w.width_um.or_else(|| *widths_um.get(index)?)),
                is_bad: false,
            };
            found.push((band, Channel { part, index, sample: channel.sample_type }));
        }
        // As many blocks have at least a place in a table, and a head.
        if header.chunk_count as u64 > length / 16 {
            let message = format!("{} blocks are promised in {length} bytes: it is cut short", header.chunk_count);
            problems.push(Problem::new(at(), message));
        }
    }
    if found.is_empty() {
        let why: Vec<String> = report.notes.iter().map(|note| note.message.clone()).collect();
        let feature = format!("an OpenEXR file without an image ({})", why.join("; "));
        return Err(Error::Unsupported { at: at(), feature });
    }
    check_size(at(), rows, columns, found.len())?;
    let mut sorted: Vec<&str> = found.iter().map(|f| f.0.name.as_str()).collect();
    sorted.sort_unstable();
    for pair in sorted.windows(2).filter(|pair| pair[0] == pair[1]) {
        problems.push(Problem::new(at().with_item(pair[0]), "a channel of this name appears twice"));
    }
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let all: Vec<&str> = found.iter().map(|f| f.0.name.as_str()).collect();
    let (order, layers): (Vec<usize>, Vec<Layer>) = layers::of(&all, |a, b| {
        let window = |i: usize| (corners[found[i].1.part], meta.headers[found[i].1.part].layer_size);
        window(a) == window(b)
    });
    let mut found: Vec<Option<(RasterBand, Channel)>> = found.into_iter().map(Some).collect();
    let (bands, list): (Vec<RasterBand>, Vec<Channel>) = order.iter().filter_map(|i| found[*i].take()).unzip();
    let pixel_aspect = f64::from(first.shared_attributes.pixel_aspect);
    if pixel_aspect != 1.0 {
        report.note(
            Fate::Approximated,
            at().with_item("pixelAspectRatio"),
            format!("pixels are {pixel_aspect} times as wide as high"),
        );
    }
    let channels = Channels { list, corners, has_margin, file_bytes: length };
    let data_type = if channels.are_f32() { DataType::F32 } else { DataType::F64 };
    let unit = text(first, "radianceUnits").or_else(|| text(first, "emissiveUnits"));
    let raster = Raster::of(path, (rows, columns), bands, data_type, BandReader::Exr(channels));
    Ok(Raster { unit, report, layers, pixel_aspect, ..raster })
}

/// What a text attribute of a part says.
fn text(header: &Header, wanted: &str) -> Option<String> {
    let attributes = header.own_attributes.other.iter().chain(&header.shared_attributes.other);
    attributes.into_iter().find_map(|(name, value)| match value {
        AttributeValue::Text(text) if *name == *wanted => Some(text.to_string()),
        _ => None,
    })
}

/// A name whose bytes the reader took for Latin-1, where they are UTF-8.
fn utf8(name: &str) -> String {
    let bytes: Option<Vec<u8>> = name.chars().map(|c| u8::try_from(c).ok()).collect();
    bytes.and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_else(|| name.to_owned())
}

/// How the data of a part and the image overlap.
struct Margins {
    overlaps: bool,
    /// There are data beyond the image.
    cut: bool,
    /// There is image beyond the data.
    leaves: bool,
}

fn margins(header: &Header, corner: [i64; 2], image: [usize; 2]) -> Margins {
    let size = [header.layer_size.width() as i64, header.layer_size.height() as i64];
    let image = image.map(|n| n as i64);
    let any = |of: &dyn Fn(usize) -> bool| of(0) || of(1);
    Margins {
        overlaps: !any(&|k| corner[k] >= image[k] || corner[k] + size[k] <= 0),
        cut: any(&|k| corner[k] < 0 || corner[k] + size[k] > image[k]),
        leaves: any(&|k| corner[k] > 0 || corner[k] + size[k] < image[k]),
    }
}

/// Numbers of bands as they are stored: [band, row, column].
#[derive(Debug, Clone)]
pub(super) enum Numbers {
    F32(Vec<f32>),
    F64(Vec<f64>),
}

impl Default for Numbers {
    fn default() -> Self {
        Numbers::F32(Vec::new())
    }
}

impl Numbers {
    /// Room for this many numbers, all of this value.
    fn of(count: usize, value: f32, are_f32: bool) -> std::result::Result<Self, std::collections::TryReserveError> {
        if are_f32 {
            let mut numbers = Vec::new();
            numbers.try_reserve_exact(count)?;
            numbers.resize(count, value);
            Ok(Numbers::F32(numbers))
        } else {
            let mut numbers = Vec::new();
            numbers.try_reserve_exact(count)?;
            numbers.resize(count, f64::from(value));
            Ok(Numbers::F64(numbers))
        }
    }

    /// Copies numbers from the `first` on.
    pub(super) fn copy_to(&self, first: usize, values: &mut [f64]) {
        let some = first..first + values.len();
        match self {
            Numbers::F32(numbers) => {
                values.iter_mut().zip(&numbers[some]).for_each(|(value, n)| *value = f64::from(*n))
            }
            Numbers::F64(numbers) => values.copy_from_slice(&numbers[some]),
        }
    }
}

/// A place, or the nearest one from 0 to `most`.
fn within(place: i64, most: usize) -> usize {
    usize::try_from(place).unwrap_or(0).min(most)
}

/// Reads some bands, [band, row, column]; NaN outside of the data window.
pub(super) fn read(
    path: &Path,
    (rows, columns): (usize, usize),
    channels: &Channels,
    bands: Range<usize>,
) -> Result<Numbers> {
    let failed = |e| exr_cube::failed(path, e);
    let file = input::open(path).map_err(|e| Error::io(path, "reading", e))?;
    let reader = exr::block::read(BufReader::with_capacity(1 << 20, file), false).map_err(failed)?;
    let mut of_channel: Vec<Vec<Option<usize>>> =
        reader.headers().iter().map(|header| vec![None; header.channels.list.len()]).collect();
    for (band, channel) in channels.list[bands.clone()].iter().enumerate() {
        if let Some(of) = of_channel.get_mut(channel.part).and_then(|part| part.get_mut(channel.index)) {
            *of = Some(band);
        }
    }
    let are_wanted: Vec<bool> = of_channel.iter().map(|of| of.iter().any(Option::is_some)).collect();
    let fill = if channels.has_margin { f32::NAN } else { 0.0 };
    let mut numbers = Numbers::of(bands.len() * rows * columns, fill, channels.are_f32())
        .map_err(|e| Error::io(path, "reading", e.into()))?;
    // Of each line of the image in each band, the numbers that have come, those beside the image as well.
    let heights: Vec<usize> = reader.headers().iter().map(|header| header.layer_size.height()).collect();
    let widths: Vec<usize> = reader.headers().iter().map(|header| header.layer_size.width()).collect();
    let of_band = |band: usize| channels.list[bands.start + band].part;
    let mut there: Vec<Vec<u32>> = vec![vec![0; rows]; bands.len()];
    let mut is_outside = false;
    let mut chunks = reader
        .filter_chunks(false, |_, _, block| are_wanted[block.layer] && block.level == Vec2(0, 0))
        .map_err(failed)?;
    let meta = chunks.meta_data().clone();
    let ahead = AHEAD * rayon::current_num_threads();
    loop {
        let some: Vec<Chunk> = chunks.by_ref().take(ahead).collect::<exr::error::Result<_>>().map_err(failed)?;
        if some.is_empty() {
            break;
        }
        let blocks: Vec<UncompressedBlock> = some
            .into_par_iter()
            .map(|chunk| UncompressedBlock::decompress_chunk(chunk, &meta, false))
            .collect::<exr::error::Result<_>>()
            .map_err(failed)?;
        for block in &blocks {
            let part = block.index.layer;
            for line in block.lines(&meta.headers[part].channels) {
                let Some(band) = of_channel[part].get(line.location.channel).copied().flatten() else { continue };
                let (x, y, count) =
                    (line.location.position.x(), line.location.position.y(), line.location.sample_count);
                if y >= heights[part] || x + count > widths[part] {
                    is_outside = true;
                    continue;
                }
                let [left, above] = channels.corners[part];
                let Some(row) = usize::try_from(y as i64 + above).ok().filter(|row| *row < rows) else { continue };
                let come = &mut there[band][row];
                *come = come.saturating_add(index_u32(count));
                // Of the line, what lies in the image.
                let first = within(-left - x as i64, count);
                let last = within(columns as i64 - left - x as i64, count);
                if first >= last {
                    continue;
                }
                let column = within(x as i64 + left + first as i64, columns);
                let start = (band * rows + row) * columns + column;
                let range = start..start + last - first;
                let sample = channels.list[bands.start + band].sample;
                put(&mut numbers, range, line.value, first, sample);
            }
        }
    }
    let is_short = (0..bands.len()).any(|band| {
        let part = of_band(band);
        let above = channels.corners[part][1];
        let of_part = within(above, rows)..within(above + heights[part] as i64, rows);
        there[band].get(of_part).is_some_and(|lines| lines.iter().any(|n| (*n as usize) < widths[part]))
    });
    if is_outside || is_short {
        let message = if is_outside { "a block lies outside the image" } else { "lines are missing" };
        return Err(Error::syntax(Location::file(path), message));
    }
    Ok(numbers)
}

/// Puts the samples of a line, from the `first` on, where they belong.
fn put(numbers: &mut Numbers, range: Range<usize>, line: &[u8], first: usize, sample: SampleType) {
    fn decode<const N: usize, T>(line: &[u8], first: usize, number: impl Fn([u8; N]) -> T) -> impl Iterator<Item = T> {
        line.as_chunks::<N>().0.iter().skip(first).map(move |bytes| number(*bytes))
    }
    // The reader has put the bytes in the machine's own order.
    let of_f16 = |bytes| f16::from_ne_bytes(bytes).to_f32();
    match (numbers, sample) {
        (Numbers::F32(all), SampleType::F16) => set(&mut all[range], decode(line, first, of_f16)),
        (Numbers::F32(all), SampleType::F32) => set(&mut all[range], decode(line, first, f32::from_ne_bytes)),
        (Numbers::F32(all), SampleType::U32) => {
            set(&mut all[range], decode(line, first, |b| u32::from_ne_bytes(b) as f32))
        }
        (Numbers::F64(all), SampleType::F16) => set(&mut all[range], decode(line, first, |b| f64::from(of_f16(b)))),
        (Numbers::F64(all), SampleType::F32) => {
            set(&mut all[range], decode(line, first, |b| f64::from(f32::from_ne_bytes(b))))
        }
        (Numbers::F64(all), SampleType::U32) => {
            set(&mut all[range], decode(line, first, |b| f64::from(u32::from_ne_bytes(b))))
        }
    }
}

fn set<T>(values: &mut [T], numbers: impl Iterator<Item = T>) {
    values.iter_mut().zip(numbers).for_each(|(value, number)| *value = number);
}
