//! How long-running work reports its progress to the caller, and learns that it should stop.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

use crate::error::{Error, Result};

/// The progress of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, as in "sunlight".
    pub stage: &'static str,
    /// Steps done.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
}

/// Called between steps, from any thread; `false` asks to stop.
pub type Watch<'a> = &'a (dyn Fn(Progress) -> bool + Sync);

/// A [`Watch`] that ignores progress and never stops the work.
pub fn unwatched(_: Progress) -> bool {
    true
}

/// Reports progress to the caller.
///
/// # Errors
/// [`Error::Interrupted`] if it asks to stop.
pub fn tell(watch: Watch<'_>, stage: &'static str, done: u64, total: u64) -> Result<()> {
    if done == 0 || done == total {
        tracing::debug!(done, total, "{stage}");
    }
    if watch(Progress { stage, done, total }) { Ok(()) } else { Err(Error::Interrupted) }
}

/// Progress for a host that polls instead of being called back, and stops the work by a flag: from any thread, at any time.
///
/// `&|progress| gauge.watch(progress)` is its [`Watch`].
#[derive(Debug, Default)]
pub struct Gauge {
    // One value, since stage and steps belong together.
    now: Mutex<Option<Progress>>,
    is_stopped: AtomicBool,
}

impl Gauge {
    /// Records the progress; `false` once the work should stop.
    pub fn watch(&self, progress: Progress) -> bool {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
        !self.is_stopped.load(Relaxed)
    }

    /// The progress last reported; `None` before the work has begun.
    pub fn progress(&self) -> Option<Progress> {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes the work end with [`Error::Interrupted`] at its next progress report.
    pub fn stop(&self) {
        self.is_stopped.store(true, Relaxed);
    }
}

/// Asks a [`Watch`] within a step too, so that a request to stop is heard however long the step takes.
pub struct Pulse<'a> {
    watch: Watch<'a>,
    stage: &'static str,
    done: &'a AtomicU64,
    total: u64,
    work: usize,
}

/// This many pieces of work, of some 100 ns each, are done between two questions.
const WORK: usize = 1 << 14;

impl<'a> Pulse<'a> {
    /// For a stage of `total` steps, of which others count in `done` those that are done.
    pub fn new(watch: Watch<'a>, stage: &'static str, done: &'a AtomicU64, total: u64) -> Self {
        Pulse { watch, stage, done, total, work: 0 }
    }

    /// Records that some pieces of work have been done.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if the watch asks to stop.
    #[inline]
    pub fn beat(&mut self, work: usize) -> Result<()> {
        self.work += work;
        if self.work < WORK {
            return Ok(());
        }
        self.work = 0;
        tell(self.watch, self.stage, self.done.load(Relaxed), self.total)
    }
}

impl std::fmt::Debug for Pulse<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pulse").field("stage", &self.stage).finish_non_exhaustive()
    }
}
