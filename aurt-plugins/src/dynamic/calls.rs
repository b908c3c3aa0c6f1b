//! Which functions of libraries are running, for whoever has to say which library crashed or does not return.

use std::{
    cell::Cell,
    collections::BTreeMap,
    env,
    sync::{
        Arc, Mutex, OnceLock, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use super::library::LibraryModel;

/// Told the model and its library before the first call from a thread, and whenever a thread goes on to another model.
pub type Told = fn(&str);

/// Seconds that a single call of a library's function may take.
const TIME_LIMIT: &str = "AURT_LIBRARY_TIME_LIMIT_S";
/// Without [`TIME_LIMIT`]: a call evaluates some thousand samples, which takes milliseconds.
const USUAL_TIME: Duration = Duration::from_secs(60);

static TOLD: OnceLock<Told> = OnceLock::new();
static NEXT: AtomicU64 = AtomicU64::new(0);
static RUNNING: Mutex<BTreeMap<u64, (Instant, Arc<LibraryModel>)>> = Mutex::new(BTreeMap::new());

thread_local! {
    /// Address of the model that was called last.
    static LAST: Cell<usize> = const { Cell::new(0) };
}

/// From now on calls are noted, and `told` learns which models are called. Only the first `told` of a process counts.
pub fn watch_calls(told: Told) {
    // A second one is not needed: there is one command in a process.
    let _ = TOLD.set(told);
}

/// The longest time that a call of a library's function may take: `AURT_LIBRARY_TIME_LIMIT_S`, or 60 s.
#[must_use]
pub fn time_limit() -> Duration {
    let wanted = env::var(TIME_LIMIT).ok().and_then(|text| text.parse::<f64>().ok()).filter(|s| *s > 0.0);
    wanted.and_then(|s| Duration::try_from_secs_f64(s).ok()).unwrap_or(USUAL_TIME)
}

/// The call that has been running for the longest time: its model and library, and for how long.
#[must_use]
pub fn longest_call() -> Option<(String, Duration)> {
    let running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    let (begin, model) = running.values().min_by_key(|(begin, _)| *begin)?;
    Some((named(model), begin.elapsed()))
}

fn named(model: &LibraryModel) -> String {
    format!("model `{}` of the library {}", model.name, model.library.path.display())
}

/// A running call, until this is dropped; nothing where calls are not watched.
pub(super) struct Running(Option<u64>);

pub(super) fn enter(model: &Arc<LibraryModel>) -> Running {
    let Some(told) = TOLD.get() else { return Running(None) };
    let address = Arc::as_ptr(model).addr();
    if LAST.replace(address) != address {
        told(&named(model));
    }
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    running.insert(number, (Instant::now(), model.clone()));
    Running(Some(number))
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(number) = self.0 {
            RUNNING.lock().unwrap_or_else(PoisonError::into_inner).remove(&number);
        }
    }
}
