//! How long work tells its caller how far it is, and learns that it should stop.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

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

/// How far work is, for a host that asks instead of being called, and stops the work by a flag: from any thread, as often as it likes.
///
/// `&|progress| gauge.watch(progress)` is its [`Watch`].
#[derive(Debug, Default)]
pub struct Gauge {
    // One value: stage and steps belong together.
    now: Mutex<Option<Progress>>,
    is_stopped: AtomicBool,
}

impl Gauge {
    /// Notes how far the work is; `false` once it should stop.
    pub fn watch(&self, progress: Progress) -> bool {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
        !self.is_stopped.load(Relaxed)
    }

    /// How far the work was when it last said so; `None` before it has begun.
    pub fn progress(&self) -> Option<Progress> {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes the work end, with [`Error::Interrupted`], when it next says how far it is.
    pub fn stop(&self) {
        self.is_stopped.store(true, Relaxed);
    }
}

/// Asks a [`Watch`] in the middle of a step too, so that it is heard however long a step takes.
pub struct Pulse<'a> {
    watch: Watch<'a>,
    stage: &'static str,
    done: &'a AtomicU64,
    total: u64,
    work: usize,
}

/// So many pieces of work, of some 100 ns, are done between two questions.
const WORK: usize = 1 << 14;

impl<'a> Pulse<'a> {
    /// Of a stage of which others count in `done` how many of `total` steps are done.
    pub fn new(watch: Watch<'a>, stage: &'static str, done: &'a AtomicU64, total: u64) -> Self {
        Pulse { watch, stage, done, total, work: 0 }
    }

    /// Says that some pieces of work have been done.
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
