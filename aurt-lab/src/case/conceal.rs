use std::path::Path;

use aurt_files::output::{write_file, write_folder};

use super::make::{Case, make_case};
use super::plan::Plan;
use super::world::World;
use aurt_simulation::SimulationError;

impl Plan {
    /// One case of a plan in a world of this simulator. The rough world draws lengths, rates and motions of its own; of the
    /// plan it takes robots, effects and strengths.
    pub fn make(&self, world: World, seed: u64, index: usize) -> Result<Case, SimulationError> {
        let requests = self.requests(seed)?;
        let request = requests.get(index).ok_or_else(|| {
            SimulationError::unreadable(
                "plan",
                format!("has {} cases, number {} was asked for", requests.len(), index + 1),
            )
        })?;
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
    aurt_simulation::Random::labelled(seed, &label).bits()
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
