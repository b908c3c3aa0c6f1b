use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use aurt_output::{write_file, write_folder};
use rayon::prelude::*;

use super::make::{Case, make_case, make_case_in};
use super::plan::Plan;
use super::truth::Truth;
use super::world::World;
use aurt_simulation::SimulationError;

/// How far the making of cases has come.
#[derive(Debug, Clone)]
pub struct Progress<'a> {
    /// Cases that are done.
    pub done: usize,
    /// All cases.
    pub all: usize,
    /// The case that was done last.
    pub last: &'a str,
}

/// What was concealed.
#[derive(Debug, Clone)]
pub struct Concealed {
    /// The truths, case after case.
    pub truths: Vec<Truth>,
}

/// Makes the cases of a plan: folders `cases/case_0001` … with an experiment, its geometry and recordings, and
/// `sealed/case_0001.json` … with the truth. The same plan and seed give the same bytes, on any number of
/// threads.
///
/// # Errors
/// The first case that cannot be made, or a file that cannot be written.
pub fn conceal(
    plan: &Plan,
    seed: u64,
    cases: impl AsRef<Path>,
    sealed: impl AsRef<Path>,
    progress: &(dyn Fn(Progress<'_>) + Sync),
) -> Result<Concealed, SimulationError> {
    let (cases, sealed) = (cases.as_ref(), sealed.as_ref());
    let all = plan.requests(seed)?.len();
    for folder in [cases, sealed] {
        std::fs::create_dir_all(folder)
            .map_err(|source| SimulationError::Io { path: folder.into(), source })?;
    }
    let done = AtomicUsize::new(0);
    let truths = (0..all)
        .into_par_iter()
        .map(|index| {
            let name = Plan::case_name(index);
            let case = plan.make(seed, index)?;
            case.write(cases, sealed)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(Progress { done, all, last: &name });
            Ok(case.truth)
        })
        .collect::<Result<Vec<_>, SimulationError>>()?;
    Ok(Concealed { truths })
}

impl Plan {
    /// The cases of a plan one by one, without writing them: name, and the case or why it cannot be made.
    ///
    /// # Errors
    /// As [`Plan::requests`].
    pub fn cases(
        &self,
        seed: u64,
    ) -> Result<impl Iterator<Item = (String, Result<Case, SimulationError>)>, SimulationError> {
        let settings = self.recordings;
        Ok(self.requests(seed)?.into_iter().enumerate().map(move |(index, request)| {
            let name = Self::case_name(index);
            let make = |attempt| make_case(&name, &request, &settings, case_seed(seed, index, attempt));
            let case = again(make);
            (name, case)
        }))
    }

    /// One case of a plan in the clean world; `index` counts from 0 along [`Plan::requests`].
    ///
    /// # Errors
    /// As [`Plan::requests`]; [`SimulationError::Unreadable`] if there is no such case; what making it reports.
    pub fn make(&self, seed: u64, index: usize) -> Result<Case, SimulationError> {
        self.make_in(World::Clean, seed, index)
    }

    /// One case of a plan in a world of this simulator. The rough world draws lengths, rates and motions of its own; of the
    /// plan it takes robots, effects and strengths.
    ///
    /// # Errors
    /// As [`Plan::make`], and [`SimulationError::Unreadable`] for worlds that this simulator does not make.
    pub fn make_in(&self, world: World, seed: u64, index: usize) -> Result<Case, SimulationError> {
        let requests = self.requests(seed)?;
        let request = requests.get(index).ok_or_else(|| SimulationError::Unreadable {
            path: "plan".into(),
            reason: format!("has {} cases, number {} was asked for", requests.len(), index + 1),
        })?;
        again(|attempt| {
            let seed = case_seed(seed, index, attempt);
            make_case_in(world, &Self::case_name(index), request, &self.recordings, seed)
        })
    }

    /// The name of a case; `index` counts from 0.
    #[must_use]
    pub fn case_name(index: usize) -> String {
        format!("case_{:04}", index + 1)
    }
}

/// Draws after which a case is given up: now and then an effect is stronger than the robot's controller can bear.
const MOST_DRAWS: usize = 4;

/// The first draw that can be made, or why the last one could not.
fn again(make: impl Fn(usize) -> Result<Case, SimulationError>) -> Result<Case, SimulationError> {
    let mut draw = make(0);
    for attempt in 1..MOST_DRAWS {
        if draw.is_ok() {
            break;
        }
        draw = make(attempt);
    }
    draw
}

fn case_seed(seed: u64, index: usize, attempt: usize) -> u64 {
    let label = if attempt == 0 { format!("case {index}") } else { format!("case {index} again {attempt}") };
    aurt_simulation::Random::labelled(seed, &label).bits()
}

impl Case {
    /// Writes the case's folder into `cases` and its truth into `sealed`.
    ///
    /// # Errors
    /// [`SimulationError::Io`].
    pub fn write(&self, cases: &Path, sealed: &Path) -> Result<(), SimulationError> {
        // The truth first: a case folder that is there has one.
        write_file(&sealed.join(format!("{}.json", self.name)), self.truth.json()?.as_bytes())?;
        Ok(write_folder(&cases.join(&self.name), &self.files)?)
    }

    /// Writes the case's folder alone into `cases`: for references, which have no truth to be sealed.
    ///
    /// # Errors
    /// [`SimulationError::Io`].
    pub fn write_folder(&self, cases: &Path) -> Result<(), SimulationError> {
        Ok(write_folder(&cases.join(&self.name), &self.files)?)
    }
}
