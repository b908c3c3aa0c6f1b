//! Long work beside the interpreter: without its lock, with progress, and stopped by Ctrl-C.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

use aurt::Progress;
use aurt::progress::Observer;
use aurt_experiment::workbench::failure::Failure;
use pyo3::prelude::*;

use crate::error::{raised, refused};

/// How often the interpreter is asked for signals.
const POLLED_EVERY: Duration = Duration::from_millis(50);
/// Stack of the working thread, bytes: as much as a program's first thread usually has.
const STACK_BYTES: usize = 8 << 20;

/// Hands steps to the interpreter's thread, and ends the work where the user has.
struct Messenger {
    said: Sender<String>,
    cancelled: Arc<AtomicBool>,
}

/// What unwinds cancelled work.
struct Cancelled;

impl Observer for Messenger {
    fn step(&self, what: &str) {
        if self.cancelled.load(Ordering::Relaxed) {
            // Unwinds without a message; the thread's result has no reader any more.
            resume_unwind(Box::new(Cancelled));
        }
        // A reader that is gone does not want to know.
        let _ = self.said.send(what.to_owned());
    }
}

/// Runs `work` on a thread of its own and waits for it, without the interpreter's lock. Every step is told to `progress`;
/// a signal of which Python makes an exception (Ctrl-C) ends the waiting at once and the work at its next step.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Progress) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let (said, mut heard) = channel();
    let cancelled = Arc::new(AtomicBool::new(false));
    let messenger = Messenger { said, cancelled: cancelled.clone() };
    let worker = std::thread::Builder::new()
        .name("aurt".into())
        .stack_size(STACK_BYTES)
        .spawn(move || work(&Progress::observed(messenger)))
        .map_err(|error| refused(format!("no thread can be started: {error}")))?;
    let ended = (|| {
        loop {
            let message = py.detach(|| {
                let heard = &mut heard;
                heard.recv_timeout(POLLED_EVERY)
            });
            py.check_signals()?;
            match message {
                Ok(step) => {
                    if let Some(progress) = progress {
                        progress.call1((step,))?;
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
        }
    })();
    if let Err(error) = ended {
        cancelled.store(true, Ordering::Relaxed);
        return Err(error);
    }
    match py.detach(|| worker.join()) {
        Ok(result) => result.map_err(raised),
        // The interpreter makes a `PanicException` of it.
        Err(panic) => resume_unwind(panic),
    }
}
