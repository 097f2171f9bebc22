//! Long work alongside the interpreter: the lock is released, progress is reported, and Ctrl-C ends the work at once.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use archrock::studies::Progress;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::panicked;

/// Interval at which signals are looked for and progress is reported.
const TICK: Duration = Duration::from_millis(50);
/// Time that a cancelled study gets to close its files. Cases under way may take longer: they are finished in the
/// background, and their results are discarded.
const PATIENCE: Duration = Duration::from_millis(500);

/// Receives the progress of the work ten times a second; a break cancels the work.
pub type Watch<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

/// Does the work on a thread of its own, while this thread waits for signals and calls `progress(done, all)`.
/// An exception of `progress`, or a signal, cancels the work.
pub fn watch_work<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&mut Watch<'_>) -> PyResult<T> + Send + 'static,
) -> PyResult<T> {
    let cancelled = Arc::new(AtomicBool::new(false));
    let latest: Arc<Mutex<Option<Progress>>> = Arc::default();
    let (sender, receiver) = mpsc::channel();
    let receiver = Mutex::new(receiver);
    let of_work = (Arc::clone(&cancelled), Arc::clone(&latest));
    let working = thread::Builder::new().spawn(move || {
        let (cancelled, latest) = of_work;
        let mut watch = |progress: Progress| {
            *latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
            if cancelled.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let done = catch_unwind(AssertUnwindSafe(|| work(&mut watch)));
        // Nobody listens to cancelled work.
        let _ = sender.send(done);
    });
    working.map_err(|error| {
        PyRuntimeError::new_err(format!("cannot start a thread to work on: {error}"))
    })?;
    let wait = |time: Duration| {
        py.detach(|| {
            let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
            receiver.recv_timeout(time)
        })
    };
    let mut reported = None;
    let mut report = || {
        let now = *latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some(progress), Some(Progress { done, all, .. })) = (&progress, now)
            && reported != now
        {
            reported = now;
            progress.call1(py, (done, all))?;
        }
        py.check_signals()
    };
    loop {
        match wait(TICK) {
            Ok(Ok(done)) => {
                let done = done?;
                report()?;
                return Ok(done);
            }
            Ok(Err(panic)) => return Err(panicked(&*panic)),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the work ended without a result"));
            }
            Err(RecvTimeoutError::Timeout) => {
                if let Err(error) = report() {
                    cancelled.store(true, Ordering::Relaxed);
                    let _ = wait(PATIENCE);
                    return Err(error);
                }
            }
        }
    }
}
