//! Long work: in a thread of its own, while Python's own thread tells of its progress and listens for Ctrl-C.

use std::sync::Mutex;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use mmxrt::progress::{Gauge, Progress, Watch};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::errors;

/// This often progress is told and signals are asked for.
const BEAT: Duration = Duration::from_millis(50);
/// As main threads have: those of others have a quarter of it.
const STACK_BYTES: usize = 8 << 20;

/// Does work without Python's lock, and tells `tell(stage, done, total)` of its progress, if it is not `None`.
///
/// # Errors
/// What the work says; [`errors::panicked`]; what a signal's handler or `tell` raise, after the work has stopped and cleaned up.
pub(crate) fn work<T: Send>(
    py: Python<'_>,
    tell: &Bound<'_, PyAny>,
    job: impl FnOnce(Watch<'_>) -> mmxrt::Result<T> + Send,
) -> PyResult<T> {
    let gauge = Gauge::default();
    std::thread::scope(|scope| {
        let (running, ended) = mpsc::channel::<()>();
        // What waits for it without the lock has to be shared.
        let ended = Mutex::new(ended);
        let gauge = &gauge;
        let worker = std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, move || {
            // Dropped at the end of the work, and if it panics.
            let _running = running;
            job(&|progress| gauge.watch(progress))
        });
        let worker = worker.map_err(|e| PyRuntimeError::new_err(format!("no thread could be started: {e}")))?;
        let has_ended = || match ended.lock() {
            Ok(ended) => ended.recv_timeout(BEAT) != Err(RecvTimeoutError::Timeout),
            Err(_) => true,
        };
        let (mut refusal, mut told) = (None, None);
        while !py.detach(has_ended) {
            if refusal.is_some() {
                continue;
            }
            if let Err(error) = py.check_signals().and_then(|()| report(tell, gauge.progress(), &mut told)) {
                gauge.stop();
                refusal = Some(error);
            }
        }
        match (py.detach(|| worker.join()), refusal) {
            (Err(panic), _) => Err(errors::panicked(py, panic.as_ref())),
            (Ok(_), Some(refusal)) => Err(refusal),
            (Ok(done), None) => done.map_err(|error| errors::raised(py, &error)),
        }
    })
}

/// Tells of progress that has not been told yet.
fn report(tell: &Bound<'_, PyAny>, now: Option<Progress>, told: &mut Option<Progress>) -> PyResult<()> {
    if let Some(Progress { stage, done, total }) = now.filter(|now| !tell.is_none() && *told != Some(*now)) {
        *told = now;
        tell.call1((stage, done, total))?;
    }
    Ok(())
}
