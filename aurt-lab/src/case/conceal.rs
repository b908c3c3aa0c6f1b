use std::path::Path;

use aurt_files::output::{write_file, write_folder};
use rayon::prelude::*;

use super::make::{Case, make_case};
use super::plan::Plan;
use super::request::CaseRequest;
use super::world::World;
use super::{servo, servo_requests};
use aurt_simulation::{Random, SimulationError};

/// Makes the cases of a plan: folders `cases/case_0001` … with an experiment, its geometry and recordings, and
/// `sealed/case_0001.json` … with the truth; says how many. The same plan and seed give the same bytes, on any number of
/// threads.
pub fn conceal(
    plan: &Plan,
    world: World,
    seed: u64,
    cases: impl AsRef<Path>,
    sealed: impl AsRef<Path>,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<usize, SimulationError> {
    let (cases, sealed) = (cases.as_ref(), sealed.as_ref());
    let all = plan.requests_of(world, seed)?.len();
    for folder in [cases, sealed] {
        std::fs::create_dir_all(folder)
            .map_err(|source| SimulationError::Io { path: folder.into(), source })?;
    }
    (0..all).into_par_iter().try_for_each(|index| {
        let case = plan.make(world, seed, index)?;
        case.write(cases, sealed)?;
        progress(&case.name);
        Ok::<(), SimulationError>(())
    })?;
    Ok(all)
}

impl Plan {
    /// The cases in a world of our own simulators: the effects of servo arms are their own.
    pub fn requests_of(&self, world: World, seed: u64) -> Result<Vec<CaseRequest>, SimulationError> {
        if world == World::Servo { Ok(servo_requests::requests(self, seed)) } else { self.requests(seed) }
    }

    /// One case of a plan in a world of our own simulators. The rough world draws lengths, rates and motions of its own; of the
    /// plan it takes robots, effects and strengths.
    pub fn make(&self, world: World, seed: u64, index: usize) -> Result<Case, SimulationError> {
        let requests = self.requests_of(world, seed)?;
        let request = requests.get(index).ok_or_else(|| {
            SimulationError::unreadable(
                "plan",
                format!("has {} cases, number {} was asked for", requests.len(), index + 1),
            )
        })?;
        if world == World::Servo {
            let seed = Random::labelled(seed, &format!("servo {index}")).bits();
            return servo::make(&Self::case_name(index), request, seed);
        }
        again(|attempt| {
            let seed = case_seed(seed, index, attempt);
            make_case(world, &Self::case_name(index), request, &self.recordings, seed)
        })
    }

    /// The name of a case; `index` counts from 0.
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
    Random::labelled(seed, &label).bits()
}

impl Case {
    /// Writes the case's folder into `cases` and its truth into `sealed`.
    pub fn write(&self, cases: &Path, sealed: &Path) -> Result<(), SimulationError> {
        // The truth first: a case folder that is there has one.
        write_file(&sealed.join(format!("{}.json", self.name)), self.truth.json()?.as_bytes())?;
        Ok(write_folder(&cases.join(&self.name), &self.files)?)
    }

    /// Writes the case's folder alone into `cases`: for references, which have no truth to be sealed.
    pub fn write_folder(&self, cases: &Path) -> Result<(), SimulationError> {
        Ok(write_folder(&cases.join(&self.name), &self.files)?)
    }
}
