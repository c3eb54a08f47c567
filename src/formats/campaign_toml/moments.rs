//! The epochs and names of a campaign's acquisitions.

use std::collections::BTreeMap;

use super::types::AcquisitionToml;
use crate::error::{Problem, number};
use crate::flight::{Epoch, LeapSeconds, Scale};
use crate::formats::located::Document;
use crate::geometry::whole;

/// Most acquisitions of a campaign; more is taken as a mistake.
const MOST: usize = 1_000_000;
/// Longest name, bytes: the file system adds to it.
const LONGEST: usize = 150;

/// One acquisition of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Acquisition {
    /// Its name, unique in the campaign.
    pub name: String,
    /// Start of its first exposure.
    pub epoch: Epoch,
    /// Its entry in the file, from 0.
    pub entry: usize,
    /// The item that states its epoch.
    pub item: String,
}

/// Collects problems with items of a campaign.
pub(super) struct Told<'a> {
    pub(super) document: &'a Document,
    pub(super) problems: Vec<Problem>,
}

impl Told<'_> {
    pub(super) fn tell(&mut self, item: &str, message: impl Into<String>, help: &str) {
        let problem = Problem::new(self.document.at(item), message);
        self.problems.push(if help.is_empty() { problem } else { problem.with_help(help) });
    }
}

/// All acquisitions, in the order of the file; `start` is the scene's own moment.
pub(super) fn acquisitions(
    entries: &[AcquisitionToml],
    start: Epoch,
    leap: &LeapSeconds,
    told: &mut Told<'_>,
) -> Vec<Acquisition> {
    let mut all: Vec<Acquisition> = Vec::new();
    for (entry, toml) in entries.iter().enumerate() {
        let item = format!("acquisitions[{entry}]");
        if let Some(why) = no_name(&toml.name) {
            told.tell(
                &format!("{item}.name"),
                format!("{:?} {why}", toml.name),
                "the name becomes a folder: use letters, digits, - and _",
            );
            continue;
        }
        let Some((moments, is_series)) = moments(toml, &item, start, leap, MOST - all.len().min(MOST), told) else {
            continue;
        };
        all.extend(moments.into_iter().map(|(epoch, item)| {
            let moment = || epoch.to_text(Scale::Utc, 3, leap).replace(':', "-");
            let name = if is_series { format!("{}_{}", toml.name, moment()) } else { toml.name.clone() };
            Acquisition { name, epoch, entry, item }
        }));
    }
    // On some systems file names ignore case.
    let mut names: BTreeMap<String, usize> = BTreeMap::new();
    for (i, acquisition) in all.iter().enumerate() {
        if let Some(first) = names.insert(acquisition.name.to_lowercase(), i) {
            let first = &all[first];
            let item = if first.entry == acquisition.entry {
                acquisition.item.clone()
            } else {
                format!("acquisitions[{}].name", acquisition.entry)
            };
            let message = format!("duplicate acquisition name {} (also at {})", acquisition.name, first.item);
            told.tell(
                &item,
                message,
                "names become folders: rename one; times in a series must differ by at least 1 ms",
            );
            break;
        }
    }
    all
}

/// Why a name cannot be a folder's, if so.
fn no_name(name: &str) -> Option<String> {
    let is_plain = |c: char| c.is_alphanumeric() || "-_.+".contains(c);
    match name.chars().find(|c| !is_plain(*c)) {
        _ if name.is_empty() => Some("is not a name".into()),
        _ if name.len() > LONGEST => Some(format!("is longer than {LONGEST} bytes")),
        _ if name.starts_with('.') || name.ends_with('.') => Some("begins or ends with a dot".into()),
        Some(c) => Some(format!("contains {c:?}")),
        None => None,
    }
}

/// The epochs of an entry, each with the item that states it, and whether it is a series.
fn moments(
    toml: &AcquisitionToml,
    item: &str,
    start: Epoch,
    leap: &LeapSeconds,
    most: usize,
    told: &mut Told<'_>,
) -> Option<(Vec<(Epoch, String)>, bool)> {
    let key = |key: &str| format!("{item}.{key}");
    let mut parsed = |item: String, text: &str| match Epoch::parse(text, None, leap) {
        Ok(epoch) => Some((epoch, item)),
        Err(why) => {
            told.tell(&item, why, "");
            None
        }
    };
    match (&toml.epoch, toml.offset_s, &toml.epochs, (&toml.start, &toml.stop, toml.every_s)) {
        (Some(epoch), None, None, (None, None, None)) => Some((vec![parsed(key("epoch"), epoch)?], false)),
        (None, Some(offset_s), None, (None, None, None)) => {
            Some((vec![(start.after_tt_s(offset_s, leap), key("offset_s"))], false))
        }
        (None, None, Some(epochs), (None, None, None)) => {
            let of = |(k, text): (usize, &String)| parsed(format!("{item}.epochs[{k}]"), text);
            let epochs: Vec<(Epoch, String)> = epochs.iter().enumerate().map(of).collect::<Option<_>>()?;
            if let Some(two) = epochs.windows(2).find(|two| two[1].0 <= two[0].0) {
                told.tell(&two[1].1, "is not later than the previous one", "sort by time, without repeats");
                return None;
            }
            Some((epochs, true))
        }
        (None, None, None, (Some(first), Some(last), Some(every_s))) => {
            let (first, last) = (parsed(key("start"), first), parsed(key("stop"), last));
            let ((first, _), (last, _)) = (first?, last?);
            if last < first {
                told.tell(&key("stop"), "is before `start`", "exchange them");
                return None;
            }
            // Counted in TT, as UTC epochs are written; the last one is included despite rounding.
            let [first_s, last_s] = [first, last].map(|epoch| epoch.tt_s(leap));
            let rounding_s = 4.0 * f64::EPSILON * first_s.abs().max(last_s.abs());
            let steps = (last_s - first_s + rounding_s) / every_s;
            if steps >= most as f64 {
                let message =
                    format!("makes {} acquisitions; a campaign has at most {MOST}", number(steps.floor() + 1.0));
                told.tell(&key("every_s"), message, "give a longer step, in seconds");
                return None;
            }
            let at = |i: usize| (first.after_tt_s(i as f64 * every_s, leap), key("start"));
            Some(((0..=whole(steps)).map(at).collect(), true))
        }
        _ => {
            let help = "give one of: `epoch`; `offset_s`; `epochs`; `start`, `stop` and `every_s`";
            told.tell(item, "must give its time in exactly one way", help);
            None
        }
    }
}
