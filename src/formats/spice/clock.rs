//! SCLK: clocks of spacecraft, type 1, as in NAIF's SCLK Required Reading.

use crate::error::Result;
use crate::flight::{Almanac, LeapSeconds, Pool};

/// A clock of a spacecraft.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Clock {
    /// (ticks since the first partition began; time in the parallel time scale, s since J2000; seconds per count of the
    /// first field).
    pieces: Vec<[f64; 3]>,
    /// Ticks per count of the first field.
    ticks: f64,
    /// Ticks of all partitions.
    last: f64,
    /// The parallel time scale is TT, by these leap seconds; else TDB.
    tt: Option<LeapSeconds>,
}

impl Clock {
    /// The number of the clock that times an instrument, and that clock if its kernel is loaded.
    pub(super) fn of_instrument(instrument: i32, almanac: &Almanac) -> Result<(i32, Option<Self>)> {
        let named = almanac.pool.integer(&format!("CK_{instrument}_SCLK"))?;
        let number = named.unwrap_or(instrument / 1000);
        Ok((number, Self::of(number, &almanac.pool, &almanac.leap)?))
    }

    /// A clock by its number.
    fn of(number: i32, pool: &Pool, leap: &LeapSeconds) -> Result<Option<Self>> {
        let number = -i64::from(number);
        let name = |of: &str| format!("{of}_{number}");
        let kind = name("SCLK_DATA_TYPE");
        match pool.integer(&kind)? {
            None => return Ok(None),
            Some(1) => {}
            Some(_) => return Err(pool.wrong(&kind, "only clocks of type 1 are read")),
        }
        let numbers = |of: &str| -> Result<&[f64]> {
            let name = name(of);
            pool.numbers(&name)?.ok_or_else(|| pool.wrong(&kind, &format!("this clock needs {name} too")))
        };
        let scale = pool.integer(&name("SCLK01_TIME_SYSTEM"))?;
        let tt = match scale {
            None | Some(1) => None,
            Some(2) => Some(leap.clone()),
            Some(_) => return Err(pool.wrong(&name("SCLK01_TIME_SYSTEM"), "must be 1 (TDB) or 2 (TT)")),
        };
        let moduli = numbers("SCLK01_MODULI")?;
        let fields = pool.integer(&name("SCLK01_N_FIELDS"))?;
        if fields.is_some_and(|fields| usize::try_from(fields).ok() != Some(moduli.len())) {
            return Err(pool.wrong(
                &name("SCLK01_MODULI"),
                &format!("must have {} numbers, as {} says", fields.unwrap_or_default(), name("SCLK01_N_FIELDS")),
            ));
        }
        let ticks: f64 = moduli.iter().skip(1).product();
        if !(ticks >= 1.0 && ticks.is_finite()) {
            return Err(pool.wrong(&name("SCLK01_MODULI"), "moduli must be 1 or more"));
        }
        let (starts, ends) = (numbers("SCLK_PARTITION_START")?, numbers("SCLK_PARTITION_END")?);
        if starts.len() != ends.len() || starts.iter().zip(ends).any(|(start, end)| start >= end) {
            return Err(pool.wrong(&name("SCLK_PARTITION_START"), "each partition must start before it ends"));
        }
        let (triples, rest) = numbers("SCLK01_COEFFICIENTS")?.as_chunks::<3>();
        let ascend = |i: usize| triples.is_sorted_by(|a, b| a[i] < b[i]);
        if triples.is_empty() || !rest.is_empty() || !ascend(0) || triples.iter().any(|of| of[2] <= 0.0) {
            let message = "must be triples: ascending ticks, time, rate above 0";
            return Err(pool.wrong(&name("SCLK01_COEFFICIENTS"), message));
        }
        let last = starts.iter().zip(ends).map(|(start, end)| (end - start).round()).sum();
        Ok(Some(Clock { pieces: triples.to_vec(), ticks, last, tt }))
    }

    /// TDB since J2000, s, at a tick counted through all partitions.
    ///
    /// # Errors
    /// That there is no such tick, as a sentence.
    pub(super) fn tdb_s(&self, ticks: f64) -> std::result::Result<f64, String> {
        let first = self.pieces[0][0];
        if ticks < first || ticks > self.last {
            return Err(format!("tick {ticks} is outside the clock's range {first} to {}", self.last));
        }
        self.tdb_s_near(ticks)
    }

    /// The same, up to half a tick beyond the clock's range.
    pub(super) fn tdb_s_near(&self, ticks: f64) -> std::result::Result<f64, String> {
        if ticks < self.pieces[0][0] - 0.5 || ticks > self.last + 0.5 {
            return self.tdb_s(ticks);
        }
        let piece = self.pieces.partition_point(|piece| piece[0] <= ticks).saturating_sub(1);
        let [since, time_s, rate] = self.pieces[piece];
        let time_s = time_s + (ticks - since) * (rate / self.ticks);
        Ok(self.tt.as_ref().map_or(time_s, |leap| leap.tdb_of_tt_s(time_s)))
    }
}
