//! ENVI: a file of numbers and a text header beside it. Cubes and backplanes are written; any header can be inspected.

mod read_header;
mod write_header;
mod pair;
mod statistics;
mod write;

pub use self::pair::pair;
pub use self::read_header::{Header, parse_header, read_header};
pub use self::statistics::{BandStatistics, statistics};
pub use self::write::{EnviCube, MapPlace, write_backplanes, write_cube, write_map, write_planes};
pub use super::number::DataType;

pub(super) use self::pair::{ENDINGS, header_of};
pub(super) use self::read_header::{KEYS, Scale};
pub(super) use self::write::{SoFar, stream_lines_f32};
pub(super) use self::write_header::{HeaderBand, HeaderText, plain};

/// Order of the numbers in the file, slowest index first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interleave {
    /// Band, line, sample.
    #[default]
    Bsq,
    /// Line, band, sample.
    Bil,
    /// Line, sample, band.
    Bip,
}

impl Interleave {
    /// The name in the header.
    pub fn name(self) -> &'static str {
        match self {
            Interleave::Bsq => "bsq",
            Interleave::Bil => "bil",
            Interleave::Bip => "bip",
        }
    }
}

/// ENVI's codes of real numbers.
const CODES: [(u64, DataType); 9] = [
    (1, DataType::U8),
    (2, DataType::I16),
    (3, DataType::I32),
    (4, DataType::F32),
    (5, DataType::F64),
    (12, DataType::U16),
    (13, DataType::U32),
    (14, DataType::I64),
    (15, DataType::U64),
];

/// The code of a type; 0 for signed bytes, which ENVI does not have.
pub(super) fn code(data_type: DataType) -> u64 {
    CODES.iter().find(|c| c.1 == data_type).map_or(0, |c| c.0)
}

/// The precision of what is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// Single: half the size, rounded once, at the write.
    #[default]
    F32,
    /// Double: as computed.
    F64,
    /// Whole numbers from 0 to 65535.
    U16,
    /// Whole numbers from 0 to 4294967295.
    U32,
}

impl Precision {
    /// The type of the numbers.
    pub(super) fn data_type(self) -> DataType {
        match self {
            Precision::F32 => DataType::F32,
            Precision::F64 => DataType::F64,
            Precision::U16 => DataType::U16,
            Precision::U32 => DataType::U32,
        }
    }
}

/// The file type of a spectral library.
pub(super) const SPECTRAL_LIBRARY: &str = "ENVI Spectral Library";
