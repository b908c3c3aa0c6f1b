//! Running points: on all cores, each result kept as soon as it is there.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::Experiment;
use aurt_plugins::Registry;
use rayon::prelude::*;

use crate::sweep::evaluation::evaluate;
use crate::sweep::family::{SharedRows, common_part, with_shared_rows};
use crate::sweep::result::Outcome;
use crate::sweep::{Folder, Plan, Point, PointError, Sweep, SweepError};

/// What is told while points are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Number of results that are there already.
    Begin {
        present: usize,
    },
    Done,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Summary {
    /// Points whose result was there already.
    pub present: usize,
    pub run: usize,
    /// Of all points, those that could not be judged.
    pub failed: usize,
    pub elapsed: Duration,
    /// Groups of points that share recordings and rigid bodies.
    pub families: usize,
    /// Time to read, preprocess and filter what each family shares, over all families.
    pub preparation: Duration,
    /// Time of the points themselves, over all points and processors.
    pub points: Duration,
}

/// Runs all points of a plan whose result is not there yet; what is wrong with a point is its result.
pub fn run(
    sweep: &Sweep,
    plan: &Plan,
    folder: &Folder,
    watch: &(dyn Fn(Event) + Sync),
) -> Result<Summary, SweepError> {
    let begin = Instant::now();
    let mut families: BTreeMap<String, Vec<(usize, &Point)>> = BTreeMap::new();
    let mut seen = std::collections::HashSet::new();
    let (mut present, mut missing, mut failed) = (0, 0, 0);
    for (k, point) in sweep.points.iter().enumerate() {
        let key = &plan.points[k].key;
        if let Some(result) = folder.result(key) {
            present += 1;
            failed += usize::from(matches!(result.outcome, Outcome::Failed(_)));
        } else if seen.insert(key) {
            missing += 1;
            families.entry(common_part(&point.text)).or_default().push((k, point));
        }
    }
    watch(Event::Begin { present });
    let summary = Summary { present, run: missing, failed, families: families.len(), ..Summary::default() };
    let work = Runner { plan, folder, watch, summary: Mutex::new(summary) };
    families.values().collect::<Vec<_>>().par_iter().try_for_each(|points| work.family(points))?;
    Ok(Summary { elapsed: begin.elapsed(), ..work.finished() })
}

/// Runs one point of a planned sweep, counted from 1; one that has its result already is left alone. Returns whether it
/// could be judged.
pub fn run_point(folder: &Folder, number: usize, registry: &mut Registry) -> Result<bool, SweepError> {
    let plan = folder.plan()?;
    let path = folder.path().to_owned();
    let index = number.checked_sub(1).filter(|k| *k < plan.points.len()).ok_or(SweepError::NoPoint {
        path: path.clone(),
        index: number,
        points: plan.points.len(),
    })?;
    let point = read_point(&folder.point_file(number), &plan.points[index].name, registry)?;
    if !plan.is_current(index, &point.text, &point.experiment, registry)? {
        return Err(SweepError::Stale { path, index: number });
    }
    if let Some(result) = folder.result(&plan.points[index].key) {
        return Ok(matches!(result.outcome, Outcome::Judged(_)));
    }
    let runner = Runner { plan: &plan, folder, watch: &|_| (), summary: Mutex::default() };
    runner.family(&[(index, &point)])?;
    Ok(runner.finished().failed == 0)
}

/// A point's resolved experiment, as the plan wrote it.
fn read_point(path: &Path, name: &str, registry: &mut Registry) -> Result<Point, SweepError> {
    let written = aurt_files::read_text(path, aurt_files::MOST_TEXT_BYTES)
        .map_err(|source| SweepError::Read { path: path.to_owned(), source })?;
    let experiment = Experiment::parse(&written, path, registry).map_err(SweepError::Definition)?;
    // Without the comment at its head, the text is the one that the key was made of.
    let text = toml::from_str::<toml::Table>(&written).map_or(written, |document| document.to_string());
    Ok(Point { name: name.to_owned(), text, experiment })
}

struct Runner<'a> {
    plan: &'a Plan,
    folder: &'a Folder,
    watch: &'a (dyn Fn(Event) + Sync),
    summary: Mutex<Summary>,
}

impl Runner<'_> {
    fn finished(self) -> Summary {
        self.summary.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn summary(&self) -> MutexGuard<'_, Summary> {
        self.summary.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn family(&self, points: &[(usize, &Point)]) -> Result<(), SweepError> {
        let Some((_, first)) = points.first() else { return Ok(()) };
        let begin = Instant::now();
        let run = |rows: &SharedRows<'_>| {
            self.summary().preparation += begin.elapsed();
            points.par_iter().try_for_each(|(k, point)| self.point(*k, point, rows))
        };
        match caught(|| with_shared_rows(first, self.plan.validate, run)) {
            Ok(result) => result,
            // What they share cannot be had, so none of them can be judged.
            Err(error) => {
                points.iter().try_for_each(|(k, _)| self.keep(*k, Outcome::Failed(error.to_string())))
            }
        }
    }

    fn point(&self, k: usize, point: &Point, rows: &SharedRows<'_>) -> Result<(), SweepError> {
        let begin = Instant::now();
        let outcome = match caught(|| evaluate(point, rows, self.plan.block_s)) {
            Ok(evaluation) => Outcome::Judged(evaluation),
            Err(error) => Outcome::Failed(error.to_string()),
        };
        self.summary().points += begin.elapsed();
        self.keep(k, outcome)
    }

    fn keep(&self, k: usize, outcome: Outcome) -> Result<(), SweepError> {
        self.summary().failed += usize::from(matches!(outcome, Outcome::Failed(_)));
        self.folder.keep(&self.plan.points[k].key, outcome)?;
        (self.watch)(Event::Done);
        Ok(())
    }
}

/// The result of some work; a panic is an error.
fn caught<R>(work: impl FnOnce() -> Result<R, PointError>) -> Result<R, PointError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Err(PointError::Panic(text.unwrap_or_else(|| "without a message".into())))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_with_its_message() {
        let panics = |formatted: bool| {
            let caught: Result<(), _> =
                caught(|| if formatted { panic!("out of {}", "cheese") } else { panic!("out of cheese") });
            caught.unwrap_err().to_string()
        };
        assert_eq!(panics(false), "the program failed on this point: out of cheese");
        assert_eq!(panics(true), panics(false));
    }
}
