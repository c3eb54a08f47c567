//! What the numbers of each band are like.

use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::{Header, Interleave};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::input;

/// What the numbers of one band are like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandStatistics {
    /// Numbers that count: not NaN and not the ignored value.
    pub count: u64,
    /// Smallest of them.
    pub min: f64,
    /// Largest of them.
    pub max: f64,
    /// Their mean.
    pub mean: f64,
}

/// Reads the data file once and says what each band is like.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] if the file is shorter than the header says.
pub fn statistics(header: &Header, data: &Path) -> Result<Vec<BandStatistics>> {
    let io = |e| Error::io(data, "reading", e);
    let size = std::fs::metadata(data).map_err(io)?.len();
    let wanted = header.data_bytes().and_then(|b| b.checked_add(header.header_offset));
    if wanted.is_none_or(|wanted| size < wanted) {
        let message = format!(
            "{size} bytes, but its header asks for {} x {} x {} numbers of {} bytes after {}",
            header.samples,
            header.lines,
            header.bands,
            header.data_type.bytes(),
            header.header_offset
        );
        let problem =
            Problem::new(Location::file(data), message).with_help("it is cut short, or the header is another file's");
        return Err(Error::Invalid(vec![problem]));
    }
    let mut file = BufReader::with_capacity(1 << 20, input::open(data).map_err(io)?);
    file.seek(SeekFrom::Start(header.header_offset)).map_err(io)?;
    let empty = BandStatistics { count: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0 };
    let mut statistics = vec![empty; header.bands];
    // A run is what one band has in one piece.
    let (run, runs) = match header.interleave {
        Interleave::Bsq => (header.samples, header.lines * header.bands),
        Interleave::Bil => (header.samples, header.lines * header.bands),
        Interleave::Bip => (1, header.lines * header.samples * header.bands),
    };
    let bytes_each = header.data_type.bytes();
    let (mut bytes, mut values) = (vec![0; run * bytes_each], vec![0.0; run]);
    for i in 0..runs {
        file.read_exact(&mut bytes).map_err(io)?;
        let band = &mut statistics[match header.interleave {
            Interleave::Bsq => i / header.lines,
            Interleave::Bil | Interleave::Bip => i % header.bands,
        }];
        header.data_type.decode(header.big_endian, &bytes, &mut values);
        for &value in &values {
            if !value.is_nan() && header.ignore != Some(value) {
                band.count += 1;
                band.min = band.min.min(value);
                band.max = band.max.max(value);
                band.mean += value;
            }
        }
    }
    for band in &mut statistics {
        if band.count > 0 {
            band.mean /= band.count as f64;
        } else {
            *band = BandStatistics { count: 0, min: f64::NAN, max: f64::NAN, mean: f64::NAN };
        }
    }
    Ok(statistics)
}
