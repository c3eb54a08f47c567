//! Messages as lines of `KEY = value` (KVN).

use super::message::{Block, Entry, Kind, Message, Place, Reading, is_comment, shown};

/// The part of a message a line belongs to.
#[derive(Clone, Copy, PartialEq)]
enum Part<'a> {
    Header,
    /// Within META_START and META_STOP; the line that began it.
    Meta(&'a str),
    /// Rows that end at the next block.
    Rows,
    /// Rows within DATA_START and DATA_STOP; the line that began them.
    Data(&'a str),
    /// Behind DATA_STOP.
    Closed,
    /// Within COVARIANCE_START and COVARIANCE_STOP; the line that began it.
    Covariance(&'a str),
}

/// Parses a text.
pub(super) fn message<'a>(text: &'a str, kind: Kind, reading: &mut Reading<'a>) -> Message<'a> {
    let beginning = Place::Text(text.trim_start().lines().next().unwrap_or_default());
    let version = Entry { key: "", value: "", at: beginning };
    let mut message = Message { kind, version, header: vec![], comments: vec![], blocks: vec![] };
    let mut part = Part::Header;
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        if is_comment(line) {
            message.comments.push(line["COMMENT".len()..].trim());
            continue;
        }
        part = match (line, part, message.blocks.last_mut()) {
            ("META_START", Part::Meta(_), _) => {
                reading.wrong(Place::Text(line), "begins within metadata: META_STOP is missing before it");
                part
            }
            ("META_START", ..) => {
                let (meta, rows) = (vec![], vec![]);
                message.blocks.push(Block { at: Place::Text(line), meta, rows, covariance: None });
                Part::Meta(line)
            }
            ("META_STOP", Part::Meta(_), _) => Part::Rows,
            ("DATA_START", Part::Rows, _) => Part::Data(line),
            ("DATA_STOP", Part::Data(_), _) => Part::Closed,
            ("COVARIANCE_START", Part::Rows | Part::Closed, Some(block)) => {
                block.covariance.get_or_insert(Place::Text(line));
                Part::Covariance(line)
            }
            ("COVARIANCE_STOP", Part::Covariance(_), _) => Part::Closed,
            (_, Part::Covariance(_), _) => part,
            (_, Part::Header, _) => {
                message.header.extend(entry(line, reading));
                part
            }
            (_, Part::Meta(_), Some(block)) => {
                block.meta.extend(entry(line, reading));
                part
            }
            (_, Part::Rows | Part::Data(_), Some(block)) if line.starts_with(|c: char| c.is_ascii_digit()) => {
                block.rows.push(Place::Text(line));
                part
            }
            _ => {
                let message = format!("`{}` is unexpected here", shown(line));
                let help = "metadata belong between META_START and META_STOP, followed by rows that begin with a time";
                reading.wrong_with(Place::Text(line), message, help);
                part
            }
        };
    }
    if let Part::Meta(begun) | Part::Data(begun) | Part::Covariance(begun) = part {
        let end = begun.replace("START", "STOP");
        reading.wrong(Place::Text(begun), format!("the file ends before {end}: it may be cut off"));
    }
    // The first line has been recognised by its key.
    if let Some(version) = message.header.first() {
        message.version = *version;
    }
    message
}

/// A key and its value, without the unit after a number.
fn entry<'a>(line: &'a str, reading: &mut Reading<'a>) -> Option<Entry<'a>> {
    let Some((key, value)) = line.split_once('=') else {
        reading.wrong(Place::Text(line), format!("`{}` is not of the form KEY = value", shown(line)));
        return None;
    };
    let value = value.trim();
    let value = match value.split_once('[') {
        // A name may have brackets.
        Some((number, unit)) if unit.ends_with(']') && number.trim_end().parse::<f64>().is_ok() => number.trim_end(),
        _ => value,
    };
    Some(Entry { key: key.trim(), value, at: Place::Text(line) })
}
