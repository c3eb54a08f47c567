//! Shapes of bodies as SPICE has them: digital shape kernels (DSK) of type 2, triangular plates. In km.
//!
//! A DSK is a DAS file (direct access, segregated): characters, f64 and whole numbers have addresses of their own, which directories assign to records of 1024 bytes.
//! In it, a doubly linked list has a segment after the other. Sources: NAIF's required reading on DAS and DSK, and the parameters of `dsk02.inc`.

use std::path::Path;

use glam::DVec3;

use super::{KM_M, LIMIT, plain};
use crate::error::{Error, Location, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::input::{self, InputFile};
use crate::formats::mesh_file::{MOST, MeshFile};
use crate::geometry::index_u32;
use crate::report::{Fate, Note};

/// Digital shape kernels.
pub(in crate::formats) static DSK: Format = Format {
    name: "dsk",
    extensions: &["bds"],
    reads: "shape of a body: SPICE kernels of type 2, km",
    writes: "",
    mark: b"DAS/DSK",
    told: None,
    holds: Holds::Mesh { read: |path, _| read(path) },
};

/// Bytes of a record.
const RECORD: usize = 1024;
/// Numbers in a record.
const INTEGERS: usize = 256;
const DOUBLES: usize = 128;

/// The file, and where its numbers are: the first address and the first record of each run of records.
struct Das<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    is_big: bool,
    doubles: Vec<(usize, usize)>,
    integers: Vec<(usize, usize)>,
}

impl<'a> Das<'a> {
    fn open(path: &'a Path, bytes: &'a [u8]) -> Result<Self> {
        let mut das = Das { path, bytes, is_big: false, doubles: vec![], integers: vec![] };
        das.is_big = match bytes.get(84..92) {
            Some(b"LTL-IEEE") => false,
            Some(b"BIG-IEEE") => true,
            _ => return Err(das.wrong("its numbers are stored as neither LTL-IEEE nor BIG-IEEE")),
        };
        let at = |place: usize| das.integer_at(place).and_then(|n| usize::try_from(n).ok());
        let (Some(reserved), Some(comments)) = (at(68), at(76)) else {
            return Err(das.wrong("its first record is damaged"));
        };
        let mut directory = 1 + reserved.saturating_add(comments);
        let [mut next_double, mut next_integer] = [1, 1];
        let mut seen = 0;
        // A directory says which kind of numbers the next runs of records have: each run's kind is the one after, or before, that of the run before it.
        loop {
            let entry = |k: usize| das.integer_at(directory.checked_mul(RECORD)?.checked_add(4 * k)?);
            let entries: Vec<i32> = (0..INTEGERS).map_while(entry).collect();
            if entries.len() < INTEGERS {
                return Err(das.wrong("a directory of it is not there: the file may be cut off"));
            }
            let (forward, mut kind) = (entries[1], i64::from(entries[8]));
            let mut record = directory + 1;
            for (k, count) in entries.iter().enumerate().skip(9).take_while(|(_, count)| **count != 0) {
                if k > 9 {
                    // 1 characters, 2 f64, 3 whole numbers.
                    kind = (kind - 1 + if *count > 0 { 1 } else { -1 }).rem_euclid(3) + 1;
                }
                let records = count.unsigned_abs() as usize;
                match kind {
                    2 => {
                        das.doubles.push((next_double, record));
                        next_double += records * DOUBLES;
                    }
                    3 => {
                        das.integers.push((next_integer, record));
                        next_integer += records * INTEGERS;
                    }
                    _ => {}
                }
                record = record.saturating_add(records);
            }
            seen += 1;
            match usize::try_from(forward) {
                Ok(next) if next > 0 && seen <= bytes.len() / RECORD => directory = next - 1,
                Ok(0) => return Ok(das),
                _ => return Err(das.wrong("its directories go round in a ring")),
            }
        }
    }

    fn wrong(&self, message: &str) -> Error {
        Error::invalid(Location::file(self.path), message.to_owned())
    }

    fn integer_at(&self, place: usize) -> Option<i32> {
        let bytes: [u8; 4] = self.bytes.get(place..place.checked_add(4)?)?.try_into().ok()?;
        Some(if self.is_big { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) })
    }

    /// Where the number at an address is in the file, if there are so many in a record, of so many bytes.
    fn place(runs: &[(usize, usize)], address: usize, in_record: usize) -> Option<usize> {
        let run = runs.partition_point(|(first, _)| *first <= address).checked_sub(1)?;
        let (first, record) = runs[run];
        let beyond = address - first;
        let record = record.checked_add(beyond / in_record)?;
        record.checked_mul(RECORD)?.checked_add(beyond % in_record * (RECORD / in_record))
    }

    /// The whole number at an address, from 1.
    fn integer(&self, address: usize) -> Result<i32> {
        let found = Self::place(&self.integers, address, INTEGERS).and_then(|place| self.integer_at(place));
        found.ok_or_else(|| self.wrong("a whole number of it is not there: the file may be cut off"))
    }

    /// The f64 at an address, from 1.
    fn double(&self, address: usize) -> Result<f64> {
        let place = Self::place(&self.doubles, address, DOUBLES);
        let bytes = place.and_then(|place| self.bytes.get(place..place.checked_add(8)?)?.try_into().ok());
        let bytes: [u8; 8] = bytes.ok_or_else(|| self.wrong("a number of it is not there: the file may be cut off"))?;
        Ok(if self.is_big { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) })
    }
}

/// Reads a kernel: the plates of all its segments.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for a kernel that contradicts itself, or is cut off; [`Error::Unsupported`] for a segment of another type than 2.
pub(crate) fn read(path: &Path) -> Result<MeshFile> {
    let bytes = input::bytes(path, LIMIT)?;
    let input = InputFile::of(path, &bytes);
    let das = Das::open(path, &bytes)?;
    let (mut vertices, mut facets) = (Vec::new(), Vec::new());
    let mut bodies = Vec::new();
    let unsigned = |address: usize| das.integer(address).map(|n| usize::try_from(n).unwrap_or(0));
    // The list's own three numbers: a version, its first entry, and its last.
    let mut entry = unsigned(2)?;
    let mut segments = 0;
    while entry != 0 {
        segments += 1;
        if segments > bytes.len() / RECORD {
            return Err(das.wrong("its segments go round in a ring"));
        }
        // Backwards, forwards, and where its whole numbers and f64 begin, after so many others, and how many there are.
        let [next, integers, doubles] = [entry + 1, entry + 2, entry + 4].map(unsigned);
        let (next, integers, doubles) = (next?, integers?, doubles?);
        let (body, kind) = (das.double(doubles + 2)?, das.double(doubles + 4)?);
        if kind != 2.0 {
            let feature = format!("a segment of type {kind}: plates are type 2");
            return Err(Error::Unsupported {
                at: Location::file(path).with_item(format!("segment {segments}")),
                feature,
            });
        }
        let [count, plates] = [unsigned(integers + 1)?, unsigned(integers + 2)?];
        let fits = |n: usize, size: usize| n > 0 && n <= MOST && n.saturating_mul(3 * size) <= bytes.len();
        if !fits(count, 8) || !fits(plates, 4) {
            return Err(das.wrong(&format!(
                "segment {segments} has {count} vertices and {plates} plates, more than the file holds"
            )));
        }
        // Extents of voxels, of voxels' pointers, of pointers of vertices: before the plates are ten numbers, before the vertices 34.
        let base = vertices.len();
        for i in 0..count {
            let of = |k: usize| das.double(doubles + 35 + 3 * i + k);
            let vertex = DVec3::new(of(0)?, of(1)?, of(2)?);
            if !vertex.is_finite() {
                return Err(das.wrong(&format!("vertex {} of segment {segments} is not finite", i + 1)));
            }
            vertices.push(vertex);
        }
        for i in 0..plates {
            let corner = |k: usize| -> Result<u32> {
                let n = unsigned(integers + 11 + 3 * i + k)?;
                if (1..=count).contains(&n) {
                    return Ok(index_u32(base + n - 1));
                }
                Err(das.wrong(&format!("plate {} of segment {segments} has vertex {n} of {count}", i + 1)))
            };
            facets.push([corner(0)?, corner(1)?, corner(2)?]);
        }
        if !bodies.contains(&body) {
            bodies.push(body);
        }
        entry = next;
    }
    if facets.is_empty() {
        return Err(das.wrong("has no segments"));
    }
    let said = |message: String| Note { fate: Fate::Defaulted, at: Location::file(path), message };
    let mut doubts = vec![said("unit: km, as kernels have".to_owned())];
    if bodies.len() > 1 {
        doubts.push(said(format!("shapes of {} bodies, which are taken together", bodies.len())));
    }
    Ok(plain(vertices, facets, KM_M, input, doubts))
}
