//! How long work tells its caller how far it is, and learns that it should stop.

use crate::error::{Error, Result};

/// How far a stage is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, as in "sunlight".
    pub stage: &'static str,
    /// Steps done.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
}

impl Progress {
    /// A stage that knows its share done (0 to 1), in steps of a thousandth.
    pub fn of_share(stage: &'static str, share: f64) -> Self {
        Progress { stage, done: (share * 1000.0) as u64, total: 1000 }
    }
}

/// Called between steps, from any thread; `false` asks to stop.
pub type Watch<'a> = &'a (dyn Fn(Progress) -> bool + Sync);

/// A [`Watch`] for those who do not want to know: never stops anything.
pub fn unwatched(_: Progress) -> bool {
    true
}

/// Tells the caller.
///
/// # Errors
/// [`Error::Interrupted`] if it asks to stop.
pub fn tell(watch: Watch<'_>, stage: &'static str, done: u64, total: u64) -> Result<()> {
    if done == 0 || done == total {
        tracing::debug!(done, total, "{stage}");
    }
    if watch(Progress { stage, done, total }) { Ok(()) } else { Err(Error::Interrupted) }
}
