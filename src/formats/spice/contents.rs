//! The contents of a kernel, read without the other kernels needed to use it.

use std::collections::BTreeMap;
use std::path::Path;

use super::daf::Daf;
use super::frames::{Frames, rotating_bodies};
use super::{Kind, ck, furnish_text, listed, meta, pck, spk, text};
use crate::error::Result;
use crate::flight::{Almanac, Epoch};

/// What a kernel holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Contents {
    /// What it is.
    pub kind: &'static str,
    /// Segments of a binary kernel, in file order: later ones override earlier ones.
    pub segments: Vec<SegmentFacts>,
    /// Coverage gaps: name, start, end.
    pub gaps: Vec<[String; 3]>,
    /// Bodies whose rotation it has.
    pub rotations: Vec<String>,
    /// Bodies whose radii it has.
    pub radii: Vec<String>,
    /// Body names it defines, each with the number.
    pub names: Vec<String>,
    /// Frames that it defines.
    pub frames: Vec<String>,
    /// Clocks it defines, by spacecraft number.
    pub clocks: Vec<String>,
    /// Number of leap-second entries, and the last TAI - UTC, s.
    pub leap_seconds: Option<(usize, f64)>,
    /// Kernels that it names.
    pub kernels: Vec<String>,
}

/// A segment of a binary kernel.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentFacts {
    /// Its name in the file.
    pub name: String,
    /// Its subject: "PHOBOS about MARS BARYCENTER", "CK -999000".
    pub of: String,
    /// Its frame (SPK) or base frame (CK, PCK).
    pub frame: String,
    /// Its type, and whether that is read.
    pub data_type: (i32, bool),
    /// Start and end: TDB, or clock ticks.
    pub span: [String; 2],
}

/// Looks into a kernel.
///
/// # Errors
/// Whatever is wrong with it; [`Error::Unsupported`](crate::Error::Unsupported) for a kernel of a kind that is not read.
pub fn contents(path: &Path) -> Result<Contents> {
    let kernel = listed(path, false)?;
    match kernel.kind {
        Kind::Text => of_text(&kernel.text, path),
        Kind::Spk => binary(path, "SPK: where bodies are", spk::SUMMARY, |names, of| {
            let [target, centre, frame, kind] = *of.first_chunk()?;
            let body = |id: i32| names.names.body(&id.to_string());
            Some((format!("{} about {}", body(target), body(centre)), frame, (kind, spk::is_read(kind)), true))
        }),
        Kind::Ck => binary(path, "CK: how things are turned, in ticks of their clocks", ck::SUMMARY, |_, of| {
            let [instrument, frame, kind] = *of.first_chunk()?;
            Some((format!("CK {instrument}"), frame, (kind, ck::is_read(kind)), false))
        }),
        Kind::Pck => binary(path, "PCK: how bodies are turned", pck::SUMMARY, |_, of| {
            let [class, frame, kind] = *of.first_chunk()?;
            Some((format!("PCK {class}"), frame, (kind, pck::is_read(kind)), true))
        }),
        Kind::Other(what) => Err(super::not_read(path, what)),
    }
}

/// What a summary says: subject, frame number, type and whether it is read, and whether its times are TDB.
type Told = (String, i32, (i32, bool), bool);

fn binary(
    path: &Path,
    kind: &'static str,
    summary: (usize, usize),
    told: impl Fn(&Almanac, &[i32]) -> Option<Told>,
) -> Result<Contents> {
    let daf = Daf::open(path, summary.0, summary.1)?;
    let almanac = Almanac::default();
    let frames = Frames::of(&almanac)?;
    let (mut segments, mut spans) = (Vec::new(), BTreeMap::<String, (bool, Vec<[f64; 2]>)>::new());
    let moment = |is_tdb: bool, at: f64| match Epoch::from_tdb_s(at).filter(|_| is_tdb) {
        Some(epoch) => epoch.to_string(),
        None => format!("{at}"),
    };
    for array in &daf.arrays {
        let Some((of, frame, data_type, is_tdb)) = told(&almanac, &array.integers) else { continue };
        let span = [array.doubles[0], array.doubles[1]];
        spans.entry(of.clone()).or_insert((is_tdb, vec![])).1.push(span);
        segments.push(SegmentFacts {
            name: array.name.clone(),
            of,
            frame: frames.of_id(frame),
            data_type,
            span: span.map(|at| moment(is_tdb, at)),
        });
    }
    let mut gaps = Vec::new();
    for (of, (is_tdb, mut spans)) in spans {
        spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut known = spans[0][1];
        for [start, end] in spans {
            if start > known {
                gaps.push([of.clone(), moment(is_tdb, known), moment(is_tdb, start)]);
            }
            known = known.max(end);
        }
    }
    Ok(Contents { kind, segments, gaps, ..Contents::default() })
}

fn of_text(text: &str, path: &Path) -> Result<Contents> {
    let kernels = meta::kernels(&text::parse(text, path)?, text, path)?;
    let mut almanac = Almanac::default();
    furnish_text(text, path, &mut almanac)?;
    let pool = &almanac.pool;
    let with = |start: &str, end: &str| -> Vec<String> {
        let inner = |(name, _)| Some(str::strip_suffix(str::strip_prefix(name, start)?, end)?.to_owned());
        pool.iter().filter_map(inner).collect()
    };
    let body = |id: &String| almanac.names.body(id);
    let codes = pool.numbers("NAIF_BODY_CODE")?.unwrap_or_default();
    let names = pool.texts("NAIF_BODY_NAME")?.unwrap_or_default();
    let leap_seconds = pool.has("DELTET/DELTA_AT").then(|| almanac.leap.last_step());
    Ok(Contents {
        kind: if kernels.is_empty() { "text kernel" } else { "meta-kernel: a list of kernels" },
        rotations: rotating_bodies(pool).into_iter().map(|id| body(&id.to_string())).collect(),
        radii: with("BODY", "_RADII").iter().map(body).collect(),
        names: names.iter().zip(codes).map(|(name, code)| format!("{name} {code}")).collect(),
        frames: Frames::of(&almanac)?.names(),
        clocks: with("SCLK_DATA_TYPE_", "").iter().map(|id| format!("-{id}")).collect(),
        leap_seconds: leap_seconds.and_then(|(count, last)| Some((count, last?.1))),
        kernels: kernels.iter().map(|(path, _)| path.display().to_string()).collect(),
        ..Contents::default()
    })
}
