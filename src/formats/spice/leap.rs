//! LSK: leap seconds, and how TDB differs from TT.

use crate::error::Result;
use crate::flight::{LeapSeconds, Pool, whole};
use crate::units::{DAY_S, TT_TAI_S};

/// The variable with the list of leap seconds.
const STEPS: &str = "DELTET/DELTA_AT";
/// TT - TAI, s: by definition 32.184.
const TT_TAI: &str = "DELTET/DELTA_T_A";

/// The leap seconds of the variables, if there are any.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) for variables that are not what they should be.
pub(super) fn seconds(pool: &Pool) -> Result<Option<LeapSeconds>> {
    let Some(list) = pool.numbers(STEPS)? else { return Ok(None) };
    let (pairs, rest) = list.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(pool.wrong(STEPS, "must be pairs: TAI - UTC, date from which it holds"));
    }
    if pool.number(TT_TAI)?.is_some_and(|offset_s| offset_s != TT_TAI_S) {
        return Err(pool.wrong(TT_TAI, "must be 32.184 (s, by definition)"));
    }
    let day = |date_s: f64| whole(date_s / DAY_S + 0.5).map(i64::from);
    let steps: Option<Vec<(i64, f64)>> =
        pairs.iter().map(|[offset_s, date_s]| Some((day(*date_s)?, *offset_s))).collect();
    let steps = steps.ok_or_else(|| pool.wrong(STEPS, "has a date that is not a whole day, e.g. @1972-JAN-1"))?;
    let needed = |name: &str| pool.number(name)?.ok_or_else(|| pool.wrong(STEPS, &format!("needs {name} too")));
    let (k, eb) = (needed("DELTET/K")?, needed("DELTET/EB")?);
    let Some([m0, m1]) = pool.numbers("DELTET/M")? else {
        return Err(pool.wrong(STEPS, "needs DELTET/M, two numbers, too"));
    };
    LeapSeconds::new(steps, [k, eb, *m0, *m1]).map(Some).map_err(|message| pool.wrong(STEPS, &message))
}
