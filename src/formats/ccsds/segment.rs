//! What segments of orbits and attitudes share: subject, span and interpolation.

use super::message::{Block, Column, Place, Reading, shown};
use crate::flight::interpolation::{DEFAULT_DEGREE, MOST_NODES, hermite_nodes};
use crate::flight::{Epoch, Scale, Span};
use crate::formats::flight_file::{Object, time_text};
use crate::report::Fate;

/// The subject of a segment.
pub(super) fn object<'a>(block: &Block<'a>, reading: &mut Reading<'a>) -> Option<Object> {
    let name = reading.needed(block, "OBJECT_NAME")?.value.to_owned();
    let id = block.entry("OBJECT_ID").filter(|entry| !entry.value.is_empty());
    Some(Object { id: id.map_or(name.clone(), |id| id.value.to_owned()), name })
}

/// The rows of a segment, in order of time.
#[derive(Default)]
pub(super) struct Rows<'a> {
    pub(super) at: Vec<Place<'a>>,
    pub(super) epochs: Vec<Epoch>,
    /// Of each its numbers.
    pub(super) values: Vec<Vec<f64>>,
}

/// Reads the rows; `None` if any cannot be used.
pub(super) fn rows<'a>(
    block: &Block<'a>,
    columns: &[Column],
    allowed: &[usize],
    scale: Scale,
    reading: &mut Reading<'a>,
) -> Option<Rows<'a>> {
    let mut rows = Rows::default();
    for at in &block.rows {
        let Some((epoch, values)) = reading.row(*at, columns, allowed, scale) else { continue };
        match rows.epochs.last() {
            Some(last) if *last == epoch => reading.wrong(*at, "has the same time as the previous row"),
            Some(last) if *last > epoch => {
                reading.wrong_with(*at, "is earlier than the previous row", "sort the rows of a segment by time");
            }
            _ => {}
        }
        rows.at.push(*at);
        rows.epochs.push(epoch);
        rows.values.push(values);
    }
    if block.rows.is_empty() {
        reading.wrong(block.at, "has no rows after its metadata");
    }
    let is_ascending = rows.epochs.windows(2).all(|two| two[0] < two[1]);
    (is_ascending && !rows.epochs.is_empty() && rows.epochs.len() == block.rows.len()).then_some(rows)
}

/// The span of a segment: as declared, but not beyond its rows.
pub(super) fn span<'a>(block: &Block<'a>, rows: &Rows<'a>, scale: Scale, reading: &mut Reading<'a>) -> Option<Span> {
    let (first, last) = (*rows.epochs.first()?, *rows.epochs.last()?);
    let mut bound = |key: &str| {
        let entry = block.entry(key)?;
        let epoch = reading.epoch(entry.value, scale, entry.at);
        Some((epoch, entry.at))
    };
    let [start, stop, from, to] =
        ["START_TIME", "STOP_TIME", "USEABLE_START_TIME", "USEABLE_STOP_TIME"].map(&mut bound);
    // Unreadable ones have been reported.
    let all_read = [start, stop, from, to].iter().flatten().all(|(epoch, _)| epoch.is_some());
    if !all_read {
        return None;
    }
    let read = |found: Option<(Option<Epoch>, Place<'a>)>| found.and_then(|(epoch, _)| epoch);
    for (found, key, row) in [(start, "START_TIME", first), (stop, "STOP_TIME", last)] {
        if found.is_none() {
            let row = time_text(row, scale, reading.leap);
            reading.note(Fate::Defaulted, block.at, format!("{key}, which is missing: that of its rows, {row}"));
        }
    }
    let total = Span { start: read(start).unwrap_or(first), end: read(stop).unwrap_or(last) };
    for (at, epoch) in rows.at.iter().zip(&rows.epochs) {
        if !total.contains(*epoch) {
            let side = if *epoch < total.start { "before START_TIME" } else { "after STOP_TIME" };
            reading.wrong(*at, format!("lies {side} of this segment"));
        }
    }
    let useable = Span { start: read(from).unwrap_or(total.start), end: read(to).unwrap_or(total.end) };
    for (found, key) in [(from, "USEABLE_START_TIME"), (to, "USEABLE_STOP_TIME")] {
        if let Some((Some(epoch), at)) = found
            && !total.contains(epoch)
        {
            reading.wrong(at, format!("{key} does not lie between START_TIME and STOP_TIME"));
        }
    }
    let span = Span {
        start: if useable.start < first { first } else { useable.start },
        end: if useable.end > last { last } else { useable.end },
    };
    if useable.start > useable.end {
        reading.wrong(block.at, "stops before it starts");
    } else if span.start > span.end {
        reading.wrong(block.at, "has no rows within its start and stop");
    } else if span != useable {
        let text = |epoch| time_text(epoch, scale, reading.leap);
        let message = format!(
            "it declares {} to {}, but its rows cover {} to {}: nothing is extrapolated",
            text(useable.start),
            text(useable.end),
            text(first),
            text(last)
        );
        reading.note(Fate::Approximated, block.at, message);
    }
    Some(span)
}

/// The interpolation method, with its number of rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Method {
    Linear,
    Lagrange(usize),
    Hermite(usize),
}

/// The interpolation that a segment declares. `slopes` are the derivatives a Hermite polynomial needs: their name, and
/// whether the rows have them.
pub(super) fn method<'a>(
    block: &Block<'a>,
    key: &str,
    (slopes, has_slopes): (&str, bool),
    otherwise: Method,
    reading: &mut Reading<'a>,
) -> Option<Method> {
    let degree = match block.entry("INTERPOLATION_DEGREE") {
        None => None,
        Some(entry) => match entry.value.parse::<usize>() {
            Ok(degree) if degree > 0 => Some((degree, entry.at)),
            _ => {
                let message = format!("`{}` is not a degree of polynomials: 1, 2, 3 ...", shown(entry.value));
                reading.wrong(entry.at, message);
                return None;
            }
        },
    };
    let Some(entry) = block.entry(key) else {
        let taken = match otherwise {
            Method::Linear => "linear interpolation".to_owned(),
            Method::Lagrange(_) => format!("Lagrange polynomials of degree {DEFAULT_DEGREE}"),
            Method::Hermite(_) => format!("Hermite polynomials of degree {DEFAULT_DEGREE}"),
        };
        reading.note(Fate::Defaulted, block.at, format!("{key}, which is missing: {taken}"));
        return Some(within(otherwise, block.at, block, reading));
    };
    let name = entry.value.to_ascii_uppercase();
    if name == "LINEAR" {
        return Some(within(Method::Linear, entry.at, block, reading));
    }
    if !["LAGRANGE", "HERMITE"].contains(&name.as_str()) {
        let message = format!("`{}` is not an interpolation method: LINEAR, LAGRANGE or HERMITE", shown(entry.value));
        reading.wrong(entry.at, message);
        return None;
    }
    let (degree, at) = degree.unwrap_or_else(|| {
        let message = format!("INTERPOLATION_DEGREE, which is missing: {DEFAULT_DEGREE}");
        reading.note(Fate::Defaulted, entry.at, message);
        (DEFAULT_DEGREE, entry.at)
    });
    let method = match name.as_str() {
        "HERMITE" if has_slopes => Method::Hermite(hermite_nodes(degree)),
        "HERMITE" => {
            let message =
                format!("Hermite polynomials need {slopes}, which the rows do not have: Lagrange is used instead");
            reading.note(Fate::Approximated, entry.at, message);
            Method::Lagrange(degree.saturating_add(1))
        }
        _ => Method::Lagrange(degree.saturating_add(1)),
    };
    Some(within(method, at, block, reading))
}

/// The method, limited to useful numbers of rows.
fn within<'a>(method: Method, at: Place<'a>, block: &Block<'a>, reading: &mut Reading<'a>) -> Method {
    let (Method::Lagrange(wanted) | Method::Hermite(wanted)) = method else { return method };
    let rows = block.rows.len();
    if wanted > rows {
        let message = format!("its polynomials need {wanted} rows, but there are {rows}: all are used");
        reading.note(Fate::Approximated, at, message);
    } else if wanted > MOST_NODES {
        let message = format!("its polynomials need {wanted} rows: {MOST_NODES} are used, because more lose digits");
        reading.note(Fate::Approximated, at, message);
    }
    let nodes = wanted.min(MOST_NODES);
    match method {
        Method::Hermite(_) => Method::Hermite(nodes),
        _ => Method::Lagrange(nodes),
    }
}

impl Method {
    /// The default polynomials: Hermite through positions and velocities, or Lagrange.
    pub(super) fn by_default(has_slopes: bool) -> Self {
        if has_slopes { Method::Hermite(hermite_nodes(DEFAULT_DEGREE)) } else { Method::Lagrange(DEFAULT_DEGREE + 1) }
    }
}
