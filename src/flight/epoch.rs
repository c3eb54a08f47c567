//! Epochs and time scales.

use std::fmt;

use crate::units::{DAY_S, TT_TAI_S};

/// TAI - GPS time, s, by definition.
const TAI_GPS_S: f64 = 19.0;
/// Days from 1970-01-01 to 2000-01-01.
const DAYS_1970_2000: i64 = 10_957;

/// An epoch: seconds of barycentric dynamical time (TDB) since J2000, which is 2000-01-01 12:00:00 TDB.
///
/// In 2026 the resolution is 0.12 us, in which Phobos moves 0.25 mm.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Epoch(f64);

/// A time scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Coordinated universal time, with leap seconds; from 1972.
    Utc,
    /// International atomic time.
    Tai,
    /// Terrestrial time: TAI + 32.184 s.
    Tt,
    /// Barycentric dynamical time (ET in SPICE): within 1.7 ms of TT.
    Tdb,
    /// Time of the GPS: TAI - 19 s.
    Gps,
}

impl Scale {
    /// By its name in files; TDT is TT, and ET is TDB.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name.to_ascii_uppercase().as_str() {
            "UTC" | "Z" => Scale::Utc,
            "TAI" => Scale::Tai,
            "TT" | "TDT" => Scale::Tt,
            "TDB" | "ET" => Scale::Tdb,
            "GPS" => Scale::Gps,
            _ => return None,
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Scale::Utc => "UTC",
            Scale::Tai => "TAI",
            Scale::Tt => "TT",
            Scale::Tdb => "TDB",
            Scale::Gps => "GPS",
        }
    }
}

/// UTC and TDB from TAI: the contents of a leapseconds kernel.
#[derive(Debug, Clone, PartialEq)]
pub struct LeapSeconds {
    /// (first day, counted from 2000-01-01; TAI - UTC, s), ascending.
    steps: Vec<(i64, f64)>,
    /// Amplitude of TDB - TT, s.
    amplitude_s: f64,
    /// Eccentricity of the Earth's orbit.
    eccentricity: f64,
    /// Mean anomaly of the Earth at J2000, rad, and its rate, rad/s.
    anomaly: [f64; 2],
}

impl Default for LeapSeconds {
    /// All leap seconds up to 2026: TAI - UTC has been 37 s since 2017 (IERS bulletin C). TDB as in NAIF's kernel naif0012.
    fn default() -> Self {
        #[rustfmt::skip]
        const SINCE: [(i64, i64); 28] = [
            (1972, 1), (1972, 7), (1973, 1), (1974, 1), (1975, 1), (1976, 1), (1977, 1), (1978, 1), (1979, 1), (1980, 1), (1981, 7),
            (1982, 7), (1983, 7), (1985, 7), (1988, 1), (1990, 1), (1991, 1), (1992, 7), (1993, 7), (1994, 7), (1996, 1), (1997, 7),
            (1999, 1), (2006, 1), (2009, 1), (2012, 7), (2015, 7), (2017, 1),
        ];
        let offsets = (10..).map(f64::from);
        let steps = SINCE
            .iter()
            .zip(offsets)
            .map(|((year, month), offset_s)| (day_number(*year, *month, 1), offset_s))
            .collect();
        LeapSeconds { steps, amplitude_s: 1.657e-3, eccentricity: 1.671e-2, anomaly: [6.239_996, 1.990_968_71e-7] }
    }
}

impl LeapSeconds {
    /// From (first day, counted from 2000-01-01; TAI - UTC, s), ascending, and NAIF's constants of TDB: K, EB, M0 and
    /// M1.
    ///
    /// # Errors
    /// What is wrong with them, as a sentence.
    pub fn new(steps: Vec<(i64, f64)>, [k, eb, m0, m1]: [f64; 4]) -> Result<Self, String> {
        if steps.is_empty() || !steps.windows(2).all(|two| two[0].0 < two[1].0) {
            return Err("leap seconds are not in the order of time".into());
        }
        if ![k, eb, m0, m1].iter().chain(steps.iter().map(|(_, offset_s)| offset_s)).all(|v| v.is_finite()) {
            return Err("a number of the leap seconds is not finite".into());
        }
        Ok(LeapSeconds { steps, amplitude_s: k, eccentricity: eb, anomaly: [m0, m1] })
    }

    /// The number of steps, and the last: (day counted from 2000-01-01, TAI - UTC in s).
    pub fn last_step(&self) -> (usize, Option<(i64, f64)>) {
        (self.steps.len(), self.steps.last().copied())
    }

    /// Seconds of TDB since J2000, from seconds of TT since J2000.
    pub fn tdb_of_tt_s(&self, tt_s: f64) -> f64 {
        tt_s + self.periodic_s(tt_s)
    }

    /// TAI - UTC on a day, s; `None` before 1972.
    fn offset_s(&self, day: i64) -> Option<f64> {
        let after = self.steps.partition_point(|(since, _)| *since <= day);
        Some(self.steps[after.checked_sub(1)?].1)
    }

    /// Seconds in a day of UTC: one more before a leap.
    fn day_s(&self, day: i64) -> f64 {
        match (self.offset_s(day), self.offset_s(day + 1)) {
            (Some(now_s), Some(then_s)) => DAY_S + (then_s - now_s),
            _ => DAY_S,
        }
    }

    /// TDB - TT, s, this many seconds after J2000 in either.
    fn periodic_s(&self, since_j2000_s: f64) -> f64 {
        let mean = self.anomaly[0] + self.anomaly[1] * since_j2000_s;
        self.amplitude_s * (mean + self.eccentricity * mean.sin()).sin()
    }
}

impl Epoch {
    /// 2000-01-01 12:00:00 TDB.
    pub const J2000: Epoch = Epoch(0.0);
    /// The earliest there is.
    pub const FIRST: Epoch = Epoch(-Self::MOST_S);
    /// The latest there is.
    pub const LAST: Epoch = Epoch(Self::MOST_S);
    /// Limit of accepted epochs, s: 100,000 years from J2000.
    const MOST_S: f64 = 3.2e12;

    /// From seconds of TDB after J2000; `None` if not finite, or more than 100,000 years away.
    pub fn from_tdb_s(tdb_s: f64) -> Option<Self> {
        (tdb_s.abs() <= Self::MOST_S).then_some(Epoch(tdb_s))
    }

    /// Seconds of TDB since J2000.
    pub fn tdb_s(self) -> f64 {
        self.0
    }

    /// Centuries (36525 days) of TDB since J2000.
    pub fn centuries(self) -> f64 {
        self.0 / (36_525.0 * DAY_S)
    }

    /// Days of TDB since J2000.
    pub fn days(self) -> f64 {
        self.0 / DAY_S
    }

    /// Later by some seconds of TDB (or earlier), clamped to 100,000 years from J2000.
    #[must_use]
    pub fn after_s(self, seconds: f64) -> Self {
        Epoch((self.0 + seconds).clamp(-Self::MOST_S, Self::MOST_S))
    }

    /// The same, if it is within 100,000 years of J2000.
    pub fn checked_after_s(self, seconds: f64) -> Option<Self> {
        Self::from_tdb_s(self.0 + seconds)
    }

    /// Later by some seconds of TT (and of UTC between leap seconds), against which TDB varies periodically.
    #[must_use]
    pub fn after_tt_s(self, seconds: f64, leap: &LeapSeconds) -> Self {
        Epoch(leap.tdb_of_tt_s(self.tt_s(leap) + seconds).clamp(-Self::MOST_S, Self::MOST_S))
    }

    /// Seconds of terrestrial time since J2000.
    pub fn tt_s(self, leap: &LeapSeconds) -> f64 {
        // TDB - TT changes by less than 4e-10 s while it passes.
        self.0 - leap.periodic_s(self.0 - leap.periodic_s(self.0))
    }

    /// Seconds from another moment to this one.
    pub fn since_s(self, other: Epoch) -> f64 {
        self.0 - other.0
    }

    /// Reads `2026-01-31T12:00:00.5`, `2026-031T12:00:00.5` or `2026-01-31`; a space may replace `T`. A scale suffix
    /// (`Z`, ` UTC`, ` TDB`) overrides `scale`.
    ///
    /// # Errors
    /// What is wrong with it, as a sentence.
    pub fn parse(text: &str, scale: Option<Scale>, leap: &LeapSeconds) -> Result<Self, String> {
        let (clock, named) = split_scale(text.trim());
        let scale = match (named, scale) {
            (Some(name), _) => {
                Scale::named(name).ok_or_else(|| format!("{name:?}: time scales are UTC, TAI, TT, TDB and GPS"))?
            }
            (None, Some(scale)) => scale,
            (None, None) => return Err(format!("{text:?} has no time scale: write {text} UTC, or TDB")),
        };
        let (day, second_s) = parse_clock(clock).ok_or_else(|| {
            format!("{text:?} is not a time: expected e.g. 2026-01-31T12:00:00.5 or 2026-031T12:00:00.5")
        })?;
        Self::of_clock(day, second_s, scale, leap).map_err(|why| format!("{text:?}: {why}"))
    }

    /// From a day, counted from 2000-01-01, and seconds of that day.
    fn of_clock(day: i64, second_s: f64, scale: Scale, leap: &LeapSeconds) -> Result<Self, String> {
        let day_s = if scale == Scale::Utc { leap.day_s(day) } else { DAY_S };
        if second_s >= day_s {
            let has = "this day has no such second";
            return Err(match scale {
                Scale::Utc if second_s < DAY_S + 1.0 => format!(
                    "{has}: no leap second is known at its end; if there is one, give a newer leapseconds kernel"
                ),
                _ => has.into(),
            });
        }
        // Whole numbers first: their sum is exact.
        #[allow(clippy::cast_precision_loss, reason = "days of 100,000 years are whole numbers of an f64")]
        let since_noon_s = (day as f64 - 0.5) * DAY_S + second_s;
        let tt_s = match scale {
            Scale::Utc => {
                let offset_s = leap.offset_s(day).ok_or("UTC is known from 1972 on: use TAI, TT or TDB")?;
                since_noon_s + (offset_s + TT_TAI_S)
            }
            Scale::Tai => since_noon_s + TT_TAI_S,
            Scale::Gps => since_noon_s + (TAI_GPS_S + TT_TAI_S),
            Scale::Tt | Scale::Tdb => since_noon_s,
        };
        let tdb_s = if scale == Scale::Tdb { tt_s } else { tt_s + leap.periodic_s(tt_s) };
        Epoch::from_tdb_s(tdb_s).ok_or_else(|| "is more than 100,000 years away".into())
    }

    /// The day, counted from 2000-01-01, and seconds of that day.
    fn clock(self, scale: Scale, leap: &LeapSeconds) -> (i64, f64) {
        let tdb_s = self.0;
        let tt_s = self.tt_s(leap);
        let split = |since_noon_s: f64| {
            let day = (since_noon_s / DAY_S + 0.5).floor();
            #[allow(clippy::cast_possible_truncation, reason = "within 100,000 years")]
            let whole = day as i64;
            (whole, since_noon_s - (day - 0.5) * DAY_S)
        };
        match scale {
            Scale::Tdb => split(tdb_s),
            Scale::Tt => split(tt_s),
            Scale::Tai => split(tt_s - TT_TAI_S),
            Scale::Gps => split(tt_s - TT_TAI_S - TAI_GPS_S),
            Scale::Utc => {
                let (day, _) = split(tt_s - TT_TAI_S);
                // The UTC day begins after that of TAI: at first it may still be the day before.
                let at = |day: i64| {
                    leap.offset_s(day).or_else(|| leap.steps.first().map(|(_, offset_s)| *offset_s)).unwrap_or(0.0)
                };
                #[allow(clippy::cast_precision_loss, reason = "within 100,000 years")]
                let in_day = |day: i64| tt_s - TT_TAI_S - at(day) - (day as f64 - 0.5) * DAY_S;
                if in_day(day) >= 0.0 { (day, in_day(day)) } else { (day - 1, in_day(day - 1)) }
            }
        }
    }

    /// As `2026-01-31T12:00:00.500000`, to this many digits of a second, without the name of the scale. UTC before 1972 is counted with the
    /// first known leap seconds.
    pub fn to_text(self, scale: Scale, digits: usize, leap: &LeapSeconds) -> String {
        let digits = digits.min(9);
        let (mut day, mut second_s) = self.clock(scale, leap);
        // Rounded once, as a whole: 59.9999 must not become 60.
        let unit = 10_f64.powi(i32::try_from(digits).unwrap_or(9));
        second_s = (second_s * unit).round() / unit;
        let day_s = if scale == Scale::Utc { leap.day_s(day) } else { DAY_S };
        if second_s >= day_s {
            (day, second_s) = (day + 1, second_s - day_s);
        }
        let minute = (second_s / 60.0).floor().min(1439.0);
        let rest_s = second_s - 60.0 * minute;
        let (year, month, of_month) = date(day);
        let (hour, minute) = ((minute / 60.0).floor(), minute % 60.0);
        let width = if digits == 0 { 2 } else { 3 + digits };
        format!("{year:04}-{month:02}-{of_month:02}T{hour:02}:{minute:02}:{rest_s:0width$.digits$}")
    }
}

impl fmt::Display for Epoch {
    /// In TDB, to the microsecond.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} TDB", self.to_text(Scale::Tdb, 6, &LeapSeconds::default()))
    }
}

/// Splits a trailing time scale from the text before it.
fn split_scale(text: &str) -> (&str, Option<&str>) {
    if let Some(clock) = text.strip_suffix(['Z', 'z']) {
        return (clock, Some("UTC"));
    }
    match text.rsplit_once(char::is_whitespace) {
        Some((clock, name)) if name.starts_with(|c: char| c.is_ascii_alphabetic()) => (clock.trim_end(), Some(name)),
        _ => (text, None),
    }
}

/// A day, counted from 2000-01-01, and seconds in it; 23:59:60 is 86400 s.
fn parse_clock(text: &str) -> Option<(i64, f64)> {
    let (date, time) = match text.split_once(['T', 't', ' ']) {
        Some((date, time)) => (date, time.trim_start()),
        None => (text, "00:00:00"),
    };
    let whole = |text: &str, lengths: std::ops::RangeInclusive<usize>| -> Option<i64> {
        (lengths.contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
    };
    let mut parts = date.split('-');
    let (year, second, third) = (whole(parts.next()?, 4..=6)?, parts.next()?, parts.next());
    if parts.next().is_some() {
        return None;
    }
    let day = match third {
        Some(of_month) => {
            let (month, of_month) = (whole(second, 1..=2)?, whole(of_month, 1..=2)?);
            is_date(year, month, of_month).then(|| day_number(year, month, of_month))?
        }
        None => {
            let (start, of_year) = (day_number(year, 1, 1), whole(second, 3..=3)?);
            (1..=day_number(year + 1, 1, 1) - start).contains(&of_year).then_some(start + of_year - 1)?
        }
    };
    let mut parts = time.split(':');
    let (hour, minute, seconds) =
        (whole(parts.next()?, 1..=2)?, whole(parts.next()?, 1..=2)?, parts.next().unwrap_or("0"));
    let plain =
        seconds.bytes().all(|b| b.is_ascii_digit() || b == b'.') && seconds.starts_with(|c: char| c.is_ascii_digit());
    if parts.next().is_some() || hour > 23 || minute > 59 || !plain {
        return None;
    }
    let seconds: f64 = seconds.parse().ok()?;
    let is_last = hour == 23 && minute == 59;
    let limit = if is_last { 61.0 } else { 60.0 };
    #[allow(clippy::cast_precision_loss, reason = "at most 1439")]
    (seconds < limit).then(|| (day, (hour * 60 + minute) as f64 * 60.0 + seconds))
}

fn is_leap(year: i64) -> bool {
    year.rem_euclid(4) == 0 && (year.rem_euclid(100) != 0 || year.rem_euclid(400) == 0)
}

fn is_date(year: i64, month: i64, day: i64) -> bool {
    let days = match month {
        4 | 6 | 9 | 11 => 30,
        2 if is_leap(year) => 29,
        2 => 28,
        1..=12 => 31,
        _ => return false,
    };
    (-99_999..=999_999).contains(&year) && (1..=days).contains(&day)
}

/// Seconds from 2000-01-01 12:00 to a date and a time of the day of the Gregorian calendar, without leap seconds; `None` if there is no such date.
pub(crate) fn calendar_s(date: [i64; 3], second_s: f64) -> Option<f64> {
    let [year, month, day] = date;
    #[allow(clippy::cast_precision_loss, reason = "days of a million years are whole numbers of an f64")]
    is_date(year, month, day).then(|| (day_number(year, month, day) as f64 - 0.5) * DAY_S + second_s)
}

/// Days from 2000-01-01 to a date of the Gregorian calendar. Years begin in March, so that a leap day is their last.
fn day_number(year: i64, month: i64, day: i64) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let of_year = (153 * month + 2) / 5 + day - 1;
    // 719468 days from 0000-03-01 to 1970-01-01.
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468 - DAYS_1970_2000
}

/// Year, month and day of a day that is counted from 2000-01-01: the inverse of [`day_number`].
fn date(day: i64) -> (i64, i64, i64) {
    let since_march = day + DAYS_1970_2000 + 719_468;
    let (era, of_era) = (since_march.div_euclid(146_097), since_march.rem_euclid(146_097));
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    (year_of_era + era * 400 + next, month, of_month)
}
