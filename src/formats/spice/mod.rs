//! SPICE kernels: trajectories (SPK), attitudes (CK with SCLK and FK), rotations (text and binary PCK), leap seconds
//! (LSK), and lists of kernels (meta-kernels).
//!
//! | kernel | what is read |
//! |---|---|
//! | SPK | types 2, 3 (Chebyshev), 8, 12 (equal steps), 9, 13 (any steps): Lagrange and Hermite polynomials |
//! | CK | types 1, 2, 3, by clocks of type 1 |
//! | binary PCK | types 2, 3 |
//! | text PCK | pole, prime meridian, periodic terms; radii and GM |
//! | FK | names; frames of PCK and CK; frames at rest in others, by matrix, angles or quaternion |
//! | LSK | leap seconds, and TDB |
//!
//! Segments and frames of other types are registered but not read: asking for one is an error, not data from elsewhere.
//! Either byte order is read. As in SPICE, where kernels overlap the later one is used, and within a binary kernel the
//! later segment.

mod ck;
mod clock;
mod contents;
mod daf;
mod frames;
mod leap;
mod meta;
mod pck;
mod spk;
mod text;

use std::path::{Path, PathBuf};

pub use contents::{Contents, SegmentFacts, contents};

use crate::error::{Error, Location, Result};
use crate::flight::{Almanac, Epoch, Names};
use crate::formats::input;
use frames::Frames;

/// Longest text kernel, bytes.
const LIMIT: u64 = 256 << 20;
/// Length of the beginning by which a file is recognised, bytes.
const BEGINNING: usize = 1 << 16;

/// What a kernel is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Text,
    Spk,
    Ck,
    Pck,
    /// Of a kind that is not read.
    Other(&'static str),
}

/// The kind of a file by its first bytes, if it is a kernel.
fn kind(beginning: &[u8]) -> Option<Kind> {
    let others: [(&[u8], &str); 5] = [
        (b"DAS/DSK", "a kernel of shapes (DSK)"),
        (b"DAS/EK", "a kernel of events (EK)"),
        (b"DAFETF", "a kernel in transfer format (make it binary by SPICE's `tobin`)"),
        (b"DASETF", "a kernel in transfer format (make it binary by SPICE's `tobin`)"),
        (b"NAIF/DA", "a kernel of before 1993 (write it anew by SPICE's `bingo`)"),
    ];
    let begins = |mark: &[u8]| beginning.starts_with(mark);
    let other = || others.iter().find(|(mark, _)| begins(mark)).map(|(_, what)| Kind::Other(what));
    match beginning {
        _ if begins(b"DAF/SPK") => Some(Kind::Spk),
        _ if begins(b"DAF/CK") => Some(Kind::Ck),
        _ if begins(b"DAF/PCK") => Some(Kind::Pck),
        _ if begins(b"DAF/") => Some(Kind::Other("an array file (DAF) of another kind than SPK, CK and PCK")),
        _ if begins(b"DAS/") => Some(Kind::Other("an array file (DAS) of another kind than DSK and EK")),
        _ if begins(b"KPL/") => Some(Kind::Text),
        _ => other().or_else(|| {
            let text = input::with_line_ends(input::decoded(beginning).0.into_owned());
            (!beginning.contains(&0) && text::has_data(&text)).then_some(Kind::Text)
        }),
    }
}

/// Whether a file with these first bytes is a SPICE kernel, supported or not.
pub fn is_kernel(beginning: &[u8]) -> bool {
    kind(beginning).is_some()
}

/// A kernel that is to be read, and where it was named.
struct Listed {
    path: PathBuf,
    kind: Kind,
    /// The text of a text kernel.
    text: String,
    /// Whether a meta-kernel names it.
    is_named: bool,
}

/// Reads kernels into an almanac and returns those read, including those that meta-kernels list; where two overlap, the
/// later one is used.
///
/// Text kernels are read first, whatever their order, because clocks, frames and names are needed to interpret binary
/// kernels. Kernels of shapes or events in a meta-kernel are skipped: they hold no positions.
///
/// # Errors
/// Whatever is wrong with a file; [`Error::Unsupported`] for a kernel of a kind that is not read.
pub fn furnish(paths: &[PathBuf], almanac: &mut Almanac) -> Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in paths {
        let kernel = listed(path, false)?;
        let named = match kernel.kind {
            Kind::Text => meta::kernels(&text::parse(&kernel.text, path)?, &kernel.text, path)?,
            _ => vec![],
        };
        all.push(kernel);
        for (path, at) in named {
            let kernel = listed(&path, true)?;
            if kernel.kind == Kind::Text
                && !meta::kernels(&text::parse(&kernel.text, &path)?, &kernel.text, &path)?.is_empty()
            {
                let message = format!("{} names kernels to load itself: name those here instead", path.display());
                return Err(Error::invalid(at, message));
            }
            all.push(kernel);
        }
    }
    for kernel in &all {
        match kernel.kind {
            Kind::Text => furnish_text(&kernel.text, &kernel.path, almanac)?,
            Kind::Other(what) if !kernel.is_named => {
                return Err(not_read(&kernel.path, what));
            }
            _ => {}
        }
    }
    let frames = Frames::of(almanac)?;
    for kernel in &all {
        match kernel.kind {
            Kind::Spk => spk::furnish(&kernel.path, &frames, almanac)?,
            Kind::Ck => ck::furnish(&kernel.path, &frames, almanac)?,
            Kind::Pck => pck::furnish(&kernel.path, &frames, almanac)?,
            Kind::Text | Kind::Other(_) => {}
        }
    }
    Ok(all.into_iter().map(|kernel| kernel.path).collect())
}

/// The error for a kernel of a kind that is not read.
fn not_read(path: &Path, what: &str) -> Error {
    Error::Unsupported { at: Location::file(path), feature: what.to_owned() }
}

/// Identifies a kernel, and reads it if it is text.
fn listed(path: &Path, is_named: bool) -> Result<Listed> {
    let kind = kind(&input::beginning(path, BEGINNING)?).ok_or_else(|| {
        Error::invalid(Location::file(path), "is not a SPICE kernel: no known file header and no \\begindata")
    })?;
    let text = match kind {
        Kind::Text => input::with_line_ends(input::decoded(&input::bytes(path, LIMIT)?).0.into_owned()),
        _ => String::new(),
    };
    Ok(Listed { path: path.to_owned(), kind, text, is_named })
}

/// Stores the variables of a text kernel, and applies them.
fn furnish_text(text: &str, path: &Path, almanac: &mut Almanac) -> Result<()> {
    let assignments = text::parse(text, path)?;
    let begins = |starts: &[&str]| assignments.iter().any(|of| starts.iter().any(|start| of.name.starts_with(start)));
    let (names, seconds) = (begins(&["NAIF_BODY_"]), begins(&["DELTET/"]));
    let turns = names || begins(&["BODY", "FRAME_", "TKFRAME_"]);
    text::assign(assignments, text, path, &mut almanac.pool)?;
    if seconds && let Some(leap) = leap::seconds(&almanac.pool)? {
        almanac.leap = leap;
    }
    if names {
        rename(almanac)?;
    }
    if turns {
        frames::furnish(&path.display().to_string(), almanac)?;
    }
    Ok(())
}

/// Renames bodies as text kernels say, also in what is already loaded.
fn rename(almanac: &mut Almanac) -> Result<()> {
    const CODES: &str = "NAIF_BODY_CODE";
    let pool = &almanac.pool;
    let names = pool.texts("NAIF_BODY_NAME")?.unwrap_or_default();
    let codes = pool.numbers(CODES)?.unwrap_or_default();
    if names.len() != codes.len() {
        let message =
            format!("must have as many numbers as NAIF_BODY_NAME has names: {}, {}", codes.len(), names.len());
        return Err(pool.wrong(CODES, &message));
    }
    let given = codes.iter().zip(names).map(|(code, name)| {
        let code =
            crate::flight::whole(*code).ok_or_else(|| pool.wrong(CODES, &format!("{code} is not a whole number")))?;
        Ok((code, name.clone()))
    });
    let (before, now) = (almanac.names.clone(), Names::new(given.collect::<Result<Vec<_>>>()?));
    let renamed = |name: &str| before.id(name).map_or_else(|| now.body(name), |id| now.body(&id.to_string()));
    for trajectory in &mut almanac.trajectories {
        trajectory.target = renamed(&trajectory.target);
        trajectory.centre = renamed(&trajectory.centre);
    }
    almanac.names = now;
    Ok(())
}

/// Rows of equal length; an incomplete last row is left out.
fn rows(words: &[f64], size: usize) -> impl Iterator<Item = &[f64]> {
    words.chunks_exact(size)
}

/// A count that is stored as an f64.
fn count(value: f64) -> std::result::Result<usize, String> {
    let whole = crate::flight::whole(value).and_then(|whole| usize::try_from(whole).ok());
    whole.ok_or_else(|| format!("has {value} where a count is expected"))
}

/// A moment that is stored as TDB, s since J2000.
fn epoch(tdb_s: f64) -> std::result::Result<Epoch, String> {
    Epoch::from_tdb_s(tdb_s).ok_or_else(|| format!("has {tdb_s} s where a time is expected"))
}
