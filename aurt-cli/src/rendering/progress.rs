//! The progress of a command on standard error: a bar on a terminal, else a line from time to time.

use std::io::{IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use aurt::Progress;
use aurt::progress::Observer;
use aurt_files::harmless;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Time between two lines where standard error is no terminal: in the log of a job, and in a pipe.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// A bar, or lines, over so many steps.
pub fn shown(steps: usize, template: &str) -> Progress {
    if !std::io::stderr().is_terminal() {
        return Progress::observed(Lines::new(steps, BETWEEN_LINES, std::io::stderr()));
    }
    let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    Progress::observed(Bar { bar })
}

#[derive(Debug)]
struct Bar {
    bar: ProgressBar,
}

impl Observer for Bar {
    fn step(&self, what: &str) {
        self.bar.set_message(harmless(what).into_owned());
        self.advance();
    }

    fn skip(&self, steps: usize) {
        self.bar.set_position(steps as u64);
        self.bar.reset_eta();
    }

    fn advance(&self) {
        self.bar.inc(1);
        // The number of steps is an estimate.
        if self.bar.length().is_some_and(|steps| self.bar.position() > steps) {
            self.bar.set_length(self.bar.position());
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[derive(Debug, Default)]
struct Step {
    number: usize,
    name: String,
}

/// A line about the step that is being done, at even intervals.
#[derive(Debug)]
struct Lines {
    step: Arc<Mutex<Step>>,
    /// Dropped at the end, which ends the thread.
    ended: Option<Sender<()>>,
    writer: Option<JoinHandle<()>>,
}

impl Lines {
    fn new(steps: usize, between: Duration, mut out: impl Write + Send + 'static) -> Self {
        let step = Arc::new(Mutex::new(Step::default()));
        let (ended, waiting) = channel();
        let shared = Arc::clone(&step);
        let begin = Instant::now();
        let lines = move || {
            while waiting.recv_timeout(between) == Err(RecvTimeoutError::Timeout) {
                let line = {
                    let Step { number, name } = &*shared.lock().unwrap_or_else(PoisonError::into_inner);
                    let name = if name.is_empty() { String::new() } else { format!(": {name}") };
                    // The number of steps is an estimate: beyond it the end is not known.
                    let of = if *number <= steps { format!(" of {steps}") } else { String::new() };
                    format!("step {number}{of} after {} s{name}\n", begin.elapsed().as_secs())
                };
                // Nothing is left to do where standard error is closed.
                let _ = out.write_all(harmless(&line).as_bytes()).and_then(|()| out.flush());
            }
        };
        // Without a thread there are no lines; the command goes on all the same.
        let writer = std::thread::Builder::new().name("progress".into()).spawn(lines).ok();
        Self { step, ended: Some(ended), writer }
    }

    fn change(&self, change: impl FnOnce(&mut Step)) {
        change(&mut self.step.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Observer for Lines {
    fn step(&self, what: &str) {
        self.change(|step| *step = Step { number: step.number + 1, name: what.to_owned() });
    }

    fn skip(&self, steps: usize) {
        self.change(|step| step.number = steps);
    }

    fn advance(&self) {
        self.change(|step| step.number += 1);
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        self.ended = None;
        if let Some(writer) = self.writer.take() {
            // A writer that panicked has nothing more to say.
            let _ = writer.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A writer whose lines arrive in a channel.
    struct Arriving(Sender<String>);

    impl Write for Arriving {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let _ = self.0.send(String::from_utf8_lossy(bytes).into_owned());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_step_that_lasts_is_told_from_time_to_time_and_nothing_after_the_end() {
        let (sender, lines) = channel();
        let observer = Lines::new(24, Duration::from_millis(5), Arriving(sender));
        observer.step("reading a\u{1b}[8m.csv");
        let patience = Duration::from_secs(20);
        let told = |what: &str| {
            let mut all = std::iter::from_fn(|| lines.recv_timeout(patience).ok());
            all.find(|line| line.contains(what)).unwrap_or_default()
        };
        let line = told("step 1 of 24 after ");
        assert!(line.contains(" s: reading a") && line.ends_with(".csv\n"), "{line:?}");
        assert!(!line.contains('\u{1b}'), "{line:?}");
        observer.advance();
        assert!(told("step 2").ends_with(".csv\n"));
        observer.skip(20);
        observer.step("selecting");
        assert!(told("step 21 of 24 after ").ends_with(" s: selecting\n"));
        observer.skip(95);
        observer.step("more than were expected");
        assert!(told("step 96 ").starts_with("step 96 after "));
        drop(observer);
        assert!(lines.iter().all(|line| line.starts_with("step 96 after")), "the writer has ended");
    }

    #[test]
    fn a_command_that_is_done_before_says_nothing() {
        let (sender, lines) = channel();
        let observer = Lines::new(3, BETWEEN_LINES, Arriving(sender));
        observer.step("all of it");
        drop(observer);
        assert_eq!(lines.iter().count(), 0);
    }
}
