//! Writes an archive of ours: a header and columns, each piece by piece.

use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::{FacetsSeen, Field, Header, ReflectedBy};
use crate::error::{Error, Result};
use crate::formats::npy;
use crate::product::Sampling;
use crate::scene::Models;
use crate::visibility::Shown;

/// An array about to be written.
pub(super) struct Column<'a> {
    name: String,
    unit: &'static str,
    meaning: String,
    values: Values<'a>,
}

impl<'a> Column<'a> {
    pub(super) fn new(
        name: impl Into<String>,
        unit: &'static str,
        meaning: impl Into<String>,
        values: Values<'a>,
    ) -> Self {
        Column { name: name.into(), unit, meaning: meaning.into(), values }
    }
}

pub(super) enum Values<'a> {
    F64(&'a [f64]),
    /// In single precision.
    F32(&'a [f64]),
    U32(&'a [u32]),
    /// Ends of lists, ascending: `<u4` if the last fits, else `<u8`.
    Ends(&'a [usize]),
    Shown(&'a [Shown]),
    Uv(&'a [[f64; 2]]),
    Vector([f64; 3]),
    /// So many lines of so many columns, made as they are written.
    Lines([usize; 2], &'a dyn Fn(Range<usize>) -> Vec<f64>),
}

/// Numbers of [`Values::Lines`] that are made at a time.
const MADE: usize = 1 << 20;

/// What a header says of a file, besides its format and its arrays.
#[derive(Default)]
pub(super) struct About<'a> {
    pub(super) sources: &'a [String],
    pub(super) models: Option<Models>,
    pub(super) sampling: Option<Sampling>,
    pub(super) reflected: Vec<ReflectedBy>,
    pub(super) seen: Option<FacetsSeen>,
}

/// Writes columns, and a header before them, which says this name and version of a format.
pub(super) fn write(
    path: &Path,
    (format, format_version): (&str, u32),
    scene: &str,
    about: About<'_>,
    columns: &[Column<'_>],
) -> Result<()> {
    let About { sources, models, sampling, reflected, seen } = about;
    let fields = columns
        .iter()
        .map(|c| (c.name.clone(), Field { unit: c.unit.to_owned(), meaning: c.meaning.clone() }))
        .collect();
    let header = Header {
        format: format.to_owned(),
        format_version,
        mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
        scene: scene.to_owned(),
        sources: sources.to_vec(),
        models,
        sampling,
        reflected,
        seen,
        fields,
    };
    let io = |e| Error::io(path, "writing", e);
    let text = serde_json::to_string(&header).map_err(|e| io(e.into()))?;
    let mut file = KeepError {
        file: BufWriter::with_capacity(1 << 20, File::create(path).map_err(io)?),
        at: 0,
        end: 0,
        error: None,
    };
    let done: std::io::Result<()> = (|| {
        let mut zip = ZipWriter::new(&mut file);
        // NumPy's text is UTF-32.
        let utf32: Vec<u8> = text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        start(&mut zip, "header", &format!("<U{}", utf32.len() / 4), "()", utf32.len())?;
        zip.write_all(&utf32)?;
        for column in columns {
            column.write(&mut zip)?;
        }
        zip.finish()?;
        Ok(())
    })();
    // The file's own error says more than what the zip writer made of it.
    file.error.map_or(done, Err).and_then(|()| file.file.flush()).map_err(io)
}

/// A file that keeps its first error and reports success, because `ZipWriter` prints, when dropped, what it
/// could not write.
struct KeepError {
    file: BufWriter<File>,
    at: u64,
    end: u64,
    error: Option<std::io::Error>,
}

impl KeepError {
    fn attempt(&mut self, act: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) {
        if self.error.is_none() {
            self.error = act(&mut self.file).err();
        }
    }
}

impl Write for KeepError {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.attempt(|file| file.write_all(bytes));
        self.at += bytes.len() as u64;
        self.end = self.end.max(self.at);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.attempt(Write::flush);
        Ok(())
    }
}

impl Seek for KeepError {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        // Positions are tracked here, without asking the file, which may have failed.
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(offset) => self.at.saturating_add_signed(offset),
            SeekFrom::End(offset) => self.end.saturating_add_signed(offset),
        };
        let at = self.at;
        self.attempt(
            |file| if file.stream_position()? == at { Ok(()) } else { file.seek(SeekFrom::Start(at)).map(drop) },
        );
        Ok(self.at)
    }
}

/// Starts a member: its entry in the zip file, and NumPy's preamble.
fn start<W: Write + Seek>(
    zip: &mut ZipWriter<W>,
    name: &str,
    descr: &str,
    shape: &str,
    bytes: usize,
) -> std::io::Result<()> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(bytes as u64 >= u64::from(u32::MAX) - 1024);
    zip.start_file(format!("{name}.npy"), options)?;
    zip.write_all(&npy::written(descr, shape))
}

#[expect(clippy::cast_possible_truncation, reason = "single precision is what is asked for")]
fn single(x: f64) -> f32 {
    x as f32
}

/// Whether ends, the last of which is the largest, fit into 32 bits.
fn fits(ends: &[usize]) -> bool {
    ends.last().is_none_or(|last| u32::try_from(*last).is_ok())
}

/// The low four of an end's bytes, which are all if it [`fits`].
fn short(end: &usize) -> [u8; 4] {
    let [a, b, c, d, ..] = (*end as u64).to_le_bytes();
    [a, b, c, d]
}

impl Column<'_> {
    fn write<W: Write + Seek>(&self, zip: &mut ZipWriter<W>) -> std::io::Result<()> {
        let (descr, shape, bytes) = match &self.values {
            Values::F64(v) => ("<f8", format!("({},)", v.len()), 8 * v.len()),
            Values::F32(v) => ("<f4", format!("({},)", v.len()), 4 * v.len()),
            Values::U32(v) => ("<u4", format!("({},)", v.len()), 4 * v.len()),
            Values::Ends(v) if fits(v) => ("<u4", format!("({},)", v.len()), 4 * v.len()),
            Values::Ends(v) => ("<u8", format!("({},)", v.len()), 8 * v.len()),
            Values::Shown(v) => ("|u1", format!("({},)", v.len()), v.len()),
            Values::Uv(v) => ("<f8", format!("({}, 2)", v.len()), 16 * v.len()),
            Values::Vector(_) => ("<f8", "(3,)".to_owned(), 24),
            Values::Lines([lines, columns], _) => ("<f8", format!("({lines}, {columns})"), 8 * lines * columns),
        };
        start(zip, &self.name, descr, &shape, bytes)?;
        match &self.values {
            Values::F64(v) => pieces(zip, v, |x| x.to_le_bytes()),
            Values::F32(v) => pieces(zip, v, |x| single(*x).to_le_bytes()),
            Values::U32(v) => pieces(zip, v, |x| x.to_le_bytes()),
            Values::Ends(v) if fits(v) => pieces(zip, v, short),
            Values::Ends(v) => pieces(zip, v, |x| (*x as u64).to_le_bytes()),
            Values::Shown(v) => pieces(zip, v, |x| [*x as u8]),
            Values::Uv(v) => pieces(zip, v.as_flattened(), |x| x.to_le_bytes()),
            Values::Vector(v) => pieces(zip, v, |x| x.to_le_bytes()),
            Values::Lines([lines, columns], make) => {
                let at_once = (MADE / columns.max(&1)).max(1);
                (0..*lines)
                    .step_by(at_once)
                    .try_for_each(|from| pieces(zip, &make(from..(from + at_once).min(*lines)), |x| x.to_le_bytes()))
            }
        }
    }
}

/// Writes values as bytes, a few thousand at a time.
fn pieces<T, const N: usize>(out: &mut impl Write, values: &[T], bytes: impl Fn(&T) -> [u8; N]) -> std::io::Result<()> {
    values.chunks(8192).try_for_each(|piece| out.write_all(&piece.iter().flat_map(&bytes).collect::<Vec<u8>>()))
}
