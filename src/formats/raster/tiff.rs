//! TIFF and GeoTIFF: its first image, in strips or tiles, as it is or packed by Deflate, LZW or PackBits.
//!
//! Sources: TIFF 6.0 (Adobe, 1992) and its Technical Note 3 (the predictor of real numbers), the BigTIFF proposal, OGC GeoTIFF 1.1 (OGC
//! 19-008r4), and for `GDAL_NODATA` and `GDAL_METADATA` GDAL's description of its driver. Colours are numbers as they are stored.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::envi::Scale;
use crate::formats::format::{Format, Holds};
use crate::formats::input;
use crate::formats::number::DataType;
use crate::formats::xml;
use crate::report::{Fate, Report};

use super::geo_keys;
use super::mask::{Alpha, HELP};
use super::tiff_packing::{Packing, Predictor};
use super::{BandReader, Raster, RasterBand, check_size, resize};

/// An image.
pub(in crate::formats) static TIFF: Format = Format {
    name: "tiff",
    extensions: &["tif", "tiff"],
    reads: "TIFF and GeoTIFF: integers and real numbers as stored, strips or tiles, Deflate, LZW; GDAL's no data, scale, names",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| MARKS.iter().any(|mark| beginning.starts_with(mark)).then(|| path.to_owned())),
    holds: Holds::Image {
        kind: "TIFF",
        open,
        target: Err("write .img; `gdal_translate IN.img OUT.tif` makes one of it"),
    },
};

/// Little and big end first; and the same of files beyond 4 GiB.
const MARKS: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];
/// No directory has more entries.
const MOST_ENTRIES: u64 = 4096;
/// No file has more directories that are looked at.
const MOST_DIRECTORIES: usize = 4096;
/// An image without most of its tiles may be as large as this in a small file, bytes.
const SPARSE: u64 = 64 << 20;
/// Numbers that a packed byte can stand for: a code of LZW has 12 bits at the most and gives fewer bytes than there are codes.
const MOST_PACKED: u64 = 4096;

/// An open file and how it says numbers.
struct Tags<'a> {
    file: File,
    path: &'a Path,
    length: u64,
    big_endian: bool,
    is_big: bool,
    /// Tag, type, count, and the bytes in which the values or their place stand.
    entries: Vec<(u16, u16, u64, [u8; 8])>,
    next: u64,
}

fn unsigned(big_endian: bool, bytes: &[u8]) -> u64 {
    let push = |n: u64, byte: &u8| n << 8 | u64::from(*byte);
    if big_endian { bytes.iter().fold(0, push) } else { bytes.iter().rev().fold(0, push) }
}

impl<'a> Tags<'a> {
    fn open(path: &'a Path) -> Result<Self> {
        let reading = |e| Error::io(path, "reading", e);
        let file = input::open(path).map_err(reading)?;
        let length = file.metadata().map_err(reading)?.len();
        let mut tags = Tags { file, path, length, big_endian: false, is_big: false, entries: vec![], next: 0 };
        let head = tags.bytes(0, length.min(16))?;
        if !MARKS.iter().any(|mark| head.starts_with(mark)) {
            let first: String = head.iter().take(8).flat_map(|b| b.escape_ascii()).map(char::from).collect();
            let message =
                format!("begins with \"{first}\", as no whole .tif file does: damaged, or something else by that name");
            return Err(Error::invalid(Location::file(path), message));
        }
        tags.big_endian = head[0] == b'M';
        tags.is_big = head[2] == b'+' || head[3] == b'+';
        let at = if tags.is_big { 8..16 } else { 4..8 };
        let at = head.get(at).map(|bytes| unsigned(tags.big_endian, bytes)).ok_or_else(|| tags.short())?;
        tags.directory(at)?;
        Ok(tags)
    }

    /// The directory at this place.
    fn directory(&mut self, at: u64) -> Result<()> {
        let (head, entry) = if self.is_big { (8, 20) } else { (2, 12) };
        let count = unsigned(self.big_endian, &self.bytes(at, head)?);
        if count > MOST_ENTRIES {
            return Err(self.broken(format!("a directory of {count} entries")));
        }
        let all = self.bytes(at.saturating_add(head), count * entry)?;
        let number = |bytes: &[u8]| unsigned(self.big_endian, bytes);
        let of = |e: &[u8]| {
            let (count, value) = if self.is_big { (&e[4..12], &e[12..20]) } else { (&e[4..8], &e[8..12]) };
            let mut bytes = [0; 8];
            bytes[..value.len()].copy_from_slice(value);
            #[expect(clippy::cast_possible_truncation, reason = "of two bytes")]
            let short = |bytes: &[u8]| number(bytes) as u16;
            (short(&e[0..2]), short(&e[2..4]), number(count), bytes)
        };
        self.entries = all.chunks_exact(usize::try_from(entry).unwrap_or(12)).map(of).collect();
        let behind = at.saturating_add(head + count * entry);
        let size = if self.is_big { 8 } else { 4 };
        // That no further image follows, some leave out.
        self.next = self.bytes(behind, size).map_or(0, |bytes| unsigned(self.big_endian, &bytes));
        Ok(())
    }

    fn short(&self) -> Error {
        self.broken("it is cut short".into())
    }

    fn broken(&self, what: String) -> Error {
        Error::syntax(Location::file(self.path), format!("not a complete TIFF: {what}"))
    }

    /// Bytes of the file, all of which are there.
    fn bytes(&mut self, at: u64, count: u64) -> Result<Vec<u8>> {
        let reading = |e| Error::io(self.path, "reading", e);
        let size = usize::try_from(count).ok().filter(|_| at.checked_add(count).is_some_and(|end| end <= self.length));
        let Some(size) = size else { return Err(self.short()) };
        let mut bytes = vec![0; size];
        self.file.seek(SeekFrom::Start(at)).map_err(reading)?;
        self.file.read_exact(&mut bytes).map_err(reading)?;
        Ok(bytes)
    }

    /// The bytes of a tag's values, and the size of one; none if the tag is not there.
    fn raw(&mut self, tag: u16) -> Result<Option<(u16, usize, Vec<u8>)>> {
        let Some((_, kind, count, value)) = self.entries.iter().find(|entry| entry.0 == tag).copied() else {
            return Ok(None);
        };
        let size: usize = match kind {
            1 | 2 | 6 | 7 => 1,
            3 | 8 => 2,
            4 | 9 | 11 | 13 => 4,
            5 | 10 | 12 | 16..=18 => 8,
            _ => return Err(self.broken(format!("tag {tag} is of the type {kind}"))),
        };
        let bytes = count.checked_mul(size as u64).ok_or_else(|| self.short())?;
        let inline = if self.is_big { 8 } else { 4 };
        let all = if bytes <= inline {
            value[..usize::try_from(bytes).unwrap_or(0)].to_vec()
        } else {
            let at = unsigned(self.big_endian, &value[..usize::try_from(inline).unwrap_or(4)]);
            self.bytes(at, bytes)?
        };
        Ok(Some((kind, size, all)))
    }

    /// A tag's whole numbers; none if it is not there.
    fn whole(&mut self, tag: u16) -> Result<Vec<u64>> {
        let Some((kind, size, bytes)) = self.raw(tag)? else { return Ok(vec![]) };
        if !matches!(kind, 1 | 3 | 4 | 13 | 16 | 18) {
            return Err(self.broken(format!("tag {tag} is no whole number")));
        }
        Ok(bytes.chunks_exact(size).map(|bytes| unsigned(self.big_endian, bytes)).collect())
    }

    /// The first of them, or this.
    fn one(&mut self, tag: u16, default: u64) -> Result<u64> {
        Ok(self.whole(tag)?.first().copied().unwrap_or(default))
    }

    /// A tag's real numbers; none if it is not there.
    fn real(&mut self, tag: u16) -> Result<Vec<f64>> {
        let Some((kind, size, bytes)) = self.raw(tag)? else { return Ok(vec![]) };
        let data_type = match kind {
            11 => DataType::F32,
            12 => DataType::F64,
            _ => return Err(self.broken(format!("tag {tag} is no real number"))),
        };
        let mut numbers = vec![0.0; bytes.len() / size];
        data_type.decode(self.big_endian, &bytes, &mut numbers);
        Ok(numbers)
    }

    fn text(&mut self, tag: u16) -> Result<Option<String>> {
        let bytes = self.raw(tag)?.map(|(_, _, bytes)| bytes);
        Ok(bytes.map(|bytes| String::from_utf8_lossy(&bytes).trim_matches(['\0', ' ']).to_owned()))
    }
}

/// Where the numbers are.
#[derive(Debug, Clone)]
pub(super) struct Chunks {
    rows: usize,
    columns: usize,
    /// Rows and columns of a strip or tile.
    size: [usize; 2],
    /// Samples of a pixel, or 1 where each has chunks of its own.
    together: usize,
    data_type: DataType,
    /// Whether a number is a bit; lines begin with a byte. Else it is of the type above.
    are_bits: bool,
    big_endian: bool,
    packing: Packing,
    predictor: Predictor,
    /// First byte and number of bytes of each; none of a tile that is left out.
    places: Vec<(u64, u64)>,
    /// What is in a tile that is left out, as it is stored.
    empty: f64,
}

impl Chunks {
    /// Whether a band is in one piece.
    pub(super) fn is_banded(&self) -> bool {
        self.together == 1
    }

    /// Bands that are in the file together.
    pub(super) fn together(&self) -> usize {
        self.together
    }

    /// Whether numbers are of single precision.
    pub(super) fn are_f32(&self) -> bool {
        self.data_type == DataType::F32
    }

    /// Bytes of so many numbers of a line.
    fn bytes_of(&self, numbers: usize) -> Option<usize> {
        if self.are_bits { Some(numbers.div_ceil(8)) } else { numbers.checked_mul(self.data_type.bytes()) }
    }

    /// Chunks below one another, and side by side.
    fn counts(&self) -> [usize; 2] {
        [self.rows.div_ceil(self.size[0]), self.columns.div_ceil(self.size[1])]
    }

    /// Reads some bands, [band, row, column].
    pub(super) fn read(&self, path: &Path, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
        let reading = |e| Error::io(path, "reading", e);
        let mut file = input::open(path).map_err(reading)?;
        let [down, across] = self.counts();
        let (rows, columns) = (self.rows, self.columns);
        let mut numbers = Vec::new();
        // Of interleaved samples one pass gives all; else each band has its own chunks.
        let passes = if self.together > 1 { vec![(0, bands)] } else { bands.map(|b| (b, b..b + 1)).collect() };
        let mut planes = values.chunks_exact_mut(rows * columns);
        for (plane, bands) in passes {
            let mut of_pass: Vec<&mut [f64]> = planes.by_ref().take(bands.len()).collect();
            for (i, j) in (0..down).flat_map(|i| (0..across).map(move |j| (i, j))) {
                let first = [i * self.size[0], j * self.size[1]];
                // A last strip is shorter; tiles are whole.
                let height = if across == 1 && self.size[1] == columns {
                    self.size[0].min(rows - first[0])
                } else {
                    self.size[0]
                };
                let chunk = (plane * down + i) * across + j;
                self.chunk(&mut file, path, chunk, height, &mut numbers)?;
                let width = self.size[1].min(columns - first[1]);
                for (row, line) in (first[0]..rows).zip(numbers.chunks_exact(self.size[1] * self.together)) {
                    for (band, plane) in bands.clone().zip(&mut of_pass) {
                        let band = if self.together > 1 { band } else { 0 };
                        let samples = line[band..].iter().step_by(self.together);
                        let target = &mut plane[row * columns + first[1]..][..width];
                        target.iter_mut().zip(samples).for_each(|(value, number)| *value = *number);
                    }
                }
            }
        }
        Ok(())
    }

    /// The numbers of a strip or tile of this height.
    fn chunk(&self, file: &mut File, path: &Path, chunk: usize, height: usize, numbers: &mut Vec<f64>) -> Result<()> {
        let reading = |e| Error::io(path, "reading", e);
        let line = self.size[1] * self.together;
        resize(numbers, height * line, path)?;
        let (at, length) = self.places.get(chunk).copied().unwrap_or_default();
        if length == 0 {
            numbers.fill(self.empty);
            return Ok(());
        }
        // That it is within the file, and what it may hold, was checked when it was opened.
        let mut packed = Vec::new();
        let size = usize::try_from(length).map_err(|_| reading(std::io::ErrorKind::OutOfMemory.into()))?;
        packed.try_reserve_exact(size).map_err(|e| reading(e.into()))?;
        packed.resize(size, 0);
        file.seek(SeekFrom::Start(at)).map_err(reading)?;
        file.read_exact(&mut packed).map_err(reading)?;
        let of_line = self.bytes_of(line).unwrap_or(usize::MAX);
        let wanted = height.saturating_mul(of_line);
        let mut bytes = self.packing.unpacked(packed, wanted).map_err(|what| {
            Error::syntax(Location::file(path), format!("not a complete TIFF: strip or tile {}: {what}", chunk + 1))
        })?;
        if self.are_bits {
            for (numbers, bytes) in numbers.chunks_exact_mut(line).zip(bytes.chunks_exact(of_line)) {
                let bit = |i: usize| f64::from(bytes[i / 8] >> (7 - i % 8) & 1);
                numbers.iter_mut().enumerate().for_each(|(i, number)| *number = bit(i));
            }
            return Ok(());
        }
        let big_endian = self.predictor.undo(&mut bytes, line, self.together, self.data_type, self.big_endian);
        self.data_type.decode(big_endian, &bytes, numbers);
        Ok(())
    }
}

/// Where the numbers of the image of this directory are, and how many a pixel has. `unsupported` tells of what is not read.
fn layout(tags: &mut Tags<'_>, unsupported: &dyn Fn(String) -> Error) -> Result<(Chunks, usize)> {
    let path = tags.path;
    let at = || Location::file(path);
    let size = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
    let (columns, rows) = (size(tags.one(256, 0)?), size(tags.one(257, 0)?));
    let samples = size(tags.one(277, 1)?);
    check_size(at(), rows, columns, samples)?;
    let bits = tags.whole(258)?;
    let formats = tags.whole(339)?;
    let is_mixed = |list: &[u64]| list.windows(2).any(|pair| pair[0] != pair[1]);
    if is_mixed(&bits) || is_mixed(&formats) {
        return Err(unsupported("a TIFF whose samples are of different types".into()));
    }
    let (bits, format) = (bits.first().copied().unwrap_or(1), formats.first().copied().unwrap_or(1));
    let data_type = match (format, bits) {
        (1, 1) => DataType::U8,
        (1 | 4, 8) => DataType::U8,
        (1 | 4, 16) => DataType::U16,
        (1 | 4, 32) => DataType::U32,
        (1 | 4, 64) => DataType::U64,
        (2, 8) => DataType::I8,
        (2, 16) => DataType::I16,
        (2, 32) => DataType::I32,
        (2, 64) => DataType::I64,
        (3, 32) => DataType::F32,
        (3, 64) => DataType::F64,
        (3, _) => return Err(unsupported(format!("a TIFF of real numbers of {bits} bits"))),
        (5 | 6, _) => return Err(unsupported("a TIFF of complex numbers".into())),
        _ => return Err(unsupported(format!("a TIFF of integers of {bits} bits"))),
    };
    let compression = tags.one(259, 1)?;
    let packing = Packing::of(compression).map_err(|what| unsupported(format!("a TIFF packed by {what}")))?;
    let predictor = tags.one(317, 1)?;
    let are_bits = bits == 1;
    if are_bits && (predictor != 1 || tags.one(266, 1)? != 1) {
        return Err(unsupported("a TIFF of bits in another order".into()));
    }
    let predictor = Predictor::of(predictor, data_type).ok_or_else(|| {
        unsupported(format!("a TIFF with the predictor {predictor} for numbers of type {}", data_type.name()))
    })?;
    if tags.one(262, 1)? == 6 {
        return Err(unsupported("a TIFF in the colours YCbCr".into()));
    }
    let is_planar = tags.one(284, 1)? == 2 && samples > 1;
    let tile = [tags.one(323, 0)?, tags.one(322, 0)?];
    let (is_tiled, strip) = (tile[0] > 0 && tile[1] > 0, tags.one(278, rows as u64)?);
    let of_chunk = if is_tiled { tile.map(size) } else { [size(strip).clamp(1, rows), columns] };
    let (offsets, lengths) = if is_tiled { (324, 325) } else { (273, 279) };
    let (offsets, lengths) = (tags.whole(offsets)?, tags.whole(lengths)?);
    check_size(at().with_item("tile"), of_chunk[0], of_chunk[1], 1)?;
    let together = if is_planar { 1 } else { samples };
    let chunks = Chunks {
        rows,
        columns,
        size: of_chunk,
        together,
        data_type,
        are_bits,
        big_endian: tags.big_endian,
        packing,
        predictor,
        places: offsets.iter().copied().zip(lengths.iter().copied()).collect(),
        empty: 0.0,
    };
    let [down, across] = chunks.counts();
    let wanted = (down * across).saturating_mul(if is_planar { samples } else { 1 });
    if offsets.len() != wanted || lengths.len() != wanted {
        let message = format!("{} places and {} lengths of {wanted} strips or tiles", offsets.len(), lengths.len());
        return Err(tags.broken(message));
    }
    check_places(tags, &chunks, is_tiled)?;
    Ok((chunks, samples))
}

/// Opens the first image of a file.
pub(in crate::formats) fn open(path: &Path) -> Result<Raster> {
    let mut tags = Tags::open(path)?;
    let at = || Location::file(path);
    let unsupported = |what: String| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let feature = format!("{what} (`gdal_translate -of ENVI {name} {stem}_envi.img` makes a file that is read)");
        Error::Unsupported { at: at(), feature }
    };
    let (mut chunks, samples) = layout(&mut tags, &unsupported)?;
    let (rows, columns, data_type) = (chunks.rows, chunks.columns, chunks.data_type);
    let colours = tags.one(262, 1)?;
    let mut report = Report::default();
    let ignore = match tags.text(42113)? {
        Some(text) => match text.trim().parse::<f64>() {
            Ok(number) => Some(number),
            Err(_) => {
                let message = format!("{:?} is not a number", text.chars().take(40).collect::<String>());
                report.note(Fate::Dropped, at().with_item("GDAL_NODATA"), message);
                None
            }
        },
        None => None,
    };
    chunks.empty = ignore.filter(|n| !n.is_nan()).unwrap_or(0.0);
    if colours == 3 {
        let message = "numbers of a palette, as they are stored: its colours are not taken";
        report.note(Fate::Defaulted, at().with_item("palette"), message);
    }
    let (mask, has_further) = further(path, tags.next)?;
    if has_further {
        report.note(Fate::Dropped, at(), "further images: this is the first");
    }
    let alpha = alpha(&mut tags, samples, data_type)?;
    let mut bands = vec![RasterBand::default(); samples];
    if colours == 2 && samples >= 3 {
        bands.iter_mut().zip(["red", "green", "blue"]).for_each(|(band, name)| band.name = name.to_owned());
    }
    let mut about = Metadata { scales: vec![Scale { gain: 1.0, offset: 0.0, divisor: 1.0 }; samples], unit: None };
    if let Some(text) = tags.text(42112)? {
        match xml::parse(&text, path) {
            Ok(root) => about.read(&root, &mut bands),
            Err(_) => report.note(Fate::Dropped, at().with_item("GDAL_METADATA"), "is no XML"),
        }
    }
    let is_scaled = about.scales.iter().any(|scale| scale.gain != 1.0 || scale.offset != 0.0);
    let geo = geo_keys::Tags {
        scale: tags.real(33550)?,
        tie: tags.real(33922)?,
        matrix: tags.real(34264)?,
        keys: tags.whole(34735)?,
        numbers: tags.real(34736)?,
    };
    let (georeference, mirrored) = geo.place(path, [rows, columns], &mut report).unzip();
    let is_changed = is_scaled || alpha.is_some_and(|alpha| alpha.is_multiplied);
    let mut raster = Raster {
        ignore,
        unit: about.unit,
        scale: if is_scaled { about.scales } else { vec![] },
        georeference,
        mirrored: mirrored.unwrap_or_default(),
        ..Raster::of(
            path,
            (rows, columns),
            bands,
            if is_changed { DataType::F64 } else { data_type },
            BandReader::Tiff(chunks),
        )
    };
    if let Some(alpha) = alpha {
        raster.bands.remove(alpha.band);
        raster.in_file.remove(alpha.band);
        let what = if alpha.is_multiplied { "coverage, by which the others are divided" } else { "coverage" };
        let message = format!("{what}: where it is 0 there is no data");
        report.note(Fate::Defaulted, at().with_item(format!("band {}", alpha.band + 1)), message);
        raster.alpha = Some(alpha);
    }
    raster.report = report;
    if let Some(mask) = mask {
        raster.take_mask(mask, at().with_item("mask"))?;
    }
    Ok(raster)
}

/// The mask that goes with the first image, as the directories behind it say, and whether further images follow.
fn further(path: &Path, mut next: u64) -> Result<(Option<Raster>, bool)> {
    let (mut mask, mut tags): (Option<Raster>, _) = (None, Tags::open(path)?);
    let at = || Location::file(path).with_item("mask");
    let refused = |message: String| Error::Invalid(vec![Problem::new(at(), message).with_help(HELP)]);
    for _ in 0..MOST_DIRECTORIES {
        if next == 0 {
            return Ok((mask, false));
        }
        // It may be the mask's.
        tags.directory(next).map_err(|e| refused(format!("the directory of a further image or mask: {e}")))?;
        next = tags.next;
        // Bit 0: a smaller copy, or the mask of one. Bit 2: a mask.
        let kind = tags.one(254, 0).unwrap_or(0);
        let is_mask = kind & 4 != 0 || tags.one(262, 1).unwrap_or(1) == 4;
        if !is_mask && kind & 1 == 0 {
            return Ok((mask, true));
        }
        if !is_mask || kind & 1 != 0 {
            continue;
        }
        if mask.is_some() {
            return Err(refused("a second mask: which of them counts is not said".into()));
        }
        let (chunks, samples) = layout(&mut tags, &|what| refused(format!("is not read: it is {what}")))?;
        let bands = vec![RasterBand::default(); samples];
        let size = (chunks.rows, chunks.columns);
        mask = Some(Raster::of(path, size, bands, chunks.data_type, BandReader::Tiff(chunks)));
    }
    Ok((mask, true))
}

/// The samples of a pixel that are coverage.
fn alpha(tags: &mut Tags<'_>, samples: usize, data_type: DataType) -> Result<Option<Alpha>> {
    let extra = tags.whole(338)?;
    let first = samples.saturating_sub(extra.len());
    // 1: the others have been multiplied by it; 2: they have not.
    let all: Vec<Alpha> = (first..samples)
        .zip(&extra)
        .filter(|(_, kind)| matches!(kind, 1 | 2))
        .map(|(band, kind)| Alpha { band, whole: whole_of(data_type), is_multiplied: *kind == 1 })
        .collect();
    match all[..] {
        [] => Ok(None),
        // A lone band is what the image is of.
        [_] if samples == 1 => Ok(None),
        [one] => Ok(Some(one)),
        _ => {
            let message = format!("{} of {samples} bands are said to be coverage (ExtraSamples)", all.len());
            let help = "`gdal_translate -b 1 IN.tif OUT.tif` keeps the first band alone";
            Err(Error::Invalid(vec![Problem::new(Location::file(tags.path), message).with_help(help)]))
        }
    }
}

/// The number that stands for all of a pixel: the largest of integers, 1 of real numbers.
fn whole_of(data_type: DataType) -> f64 {
    match data_type {
        DataType::F32 | DataType::F64 => 1.0,
        DataType::I8 => f64::from(i8::MAX),
        DataType::I16 => f64::from(i16::MAX),
        DataType::I32 => f64::from(i32::MAX),
        DataType::I64 => i64::MAX as f64,
        _ => (8.0 * data_type.bytes() as f64).exp2() - 1.0,
    }
}

/// Refuses strips and tiles that are not in the file, or hold more than their bytes can.
fn check_places(tags: &Tags<'_>, chunks: &Chunks, is_tiled: bool) -> Result<()> {
    let bytes = |height: usize| {
        let line = chunks.size[1].checked_mul(chunks.together).and_then(|line| chunks.bytes_of(line));
        line.and_then(|line| (line as u64).checked_mul(height as u64))
    };
    let expansion = if chunks.packing == Packing::None { 1 } else { MOST_PACKED };
    let [down, across] = chunks.counts();
    for (i, (at, length)) in chunks.places.iter().enumerate().filter(|(_, place)| place.1 > 0) {
        if at.checked_add(*length).is_none_or(|end| end > tags.length) {
            return Err(tags.broken(format!("strip or tile {} ends beyond the file: it is cut short", i + 1)));
        }
        let row = i / across % down * chunks.size[0];
        let height = if is_tiled { chunks.size[0] } else { chunks.size[0].min(chunks.rows - row) };
        if bytes(height).is_none_or(|wanted| wanted > length.saturating_mul(expansion)) {
            return Err(tags.broken(format!("{length} bytes cannot hold strip or tile {}", i + 1)));
        }
    }
    let all = (chunks.rows as u64 * chunks.columns as u64)
        .saturating_mul((chunks.together * chunks.data_type.bytes()) as u64);
    let is_sparse = chunks.places.iter().any(|place| place.1 == 0);
    if is_sparse
        && all.max(bytes(chunks.size[0]).unwrap_or(u64::MAX)) > tags.length.saturating_mul(MOST_PACKED).max(SPARSE)
    {
        let message = format!("most of its {} x {} pixels are left out", chunks.columns, chunks.rows);
        let help = "`gdal_translate -co SPARSE_OK=FALSE IN.tif OUT.tif` writes all of them";
        return Err(Error::Invalid(vec![Problem::new(Location::file(tags.path), message).with_help(help)]));
    }
    Ok(())
}

/// What GDAL says of bands.
struct Metadata {
    scales: Vec<Scale>,
    unit: Option<String>,
}

impl Metadata {
    /// `<Item name="SCALE" sample="0" role="scale">2</Item>`.
    fn read(&mut self, root: &xml::Element, bands: &mut [RasterBand]) {
        for item in root.all("Item") {
            let sample: usize = item.get("sample").and_then(|sample| sample.parse().ok()).unwrap_or(usize::MAX);
            let (Some(scale), Some(band)) = (self.scales.get_mut(sample), bands.get_mut(sample)) else { continue };
            let number = item.text.parse::<f64>().ok().filter(|n| n.is_finite());
            match (item.get("role"), number) {
                (Some("scale"), Some(number)) => scale.gain = number,
                (Some("offset"), Some(number)) => scale.offset = number,
                (Some("description"), _) => band.name = item.text.clone(),
                (Some("unittype"), _) if self.unit.is_none() => self.unit = Some(item.text.clone()),
                _ => {}
            }
        }
    }
}
