use std::path::{Path, PathBuf};

use crate::case::{Case, CaseRequest, CaseType, Plan, World};
use aurt_simulation::SimulationError;
use serde::Deserialize;

/// A case that is to be made: what a proof has to know of it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Planned {
    pub case_type: CaseType,
    pub effects: Vec<String>,
}

impl From<&CaseRequest> for Planned {
    fn from(request: &CaseRequest) -> Self {
        Self { case_type: request.case_type, effects: request.effects.clone() }
    }
}

pub trait Source: Sync {
    /// The cases, in an order that reveals nothing.
    fn planned(&self) -> &[Planned];

    /// Writes the folder of a case into `cases` and its truth into `sealed`; or says why it cannot be made.
    fn write(&self, index: usize, cases: &Path, sealed: &Path) -> Result<(), SimulationError>;

    /// Lines on cases that the plan asks for and the world does not have.
    fn remarks(&self) -> &[String] {
        &[]
    }

    /// Names of the same recordings without effects, which are diagnosed once.
    fn references(&self) -> Vec<String> {
        Vec::new()
    }

    fn reference(&self, name: &str) -> Result<Case, SimulationError> {
        Err(SimulationError::Unreadable { path: name.into(), reason: "this world has no references".into() })
    }
}

#[derive(Debug, Clone)]
pub struct Ingredients {
    pub plan: Plan,
    pub seed: u64,
    /// Experiments whose recordings effects are added to.
    pub into: Vec<PathBuf>,
}

impl Ingredients {
    /// What identifies the experiments that effects are added to: their names.
    pub fn set_names(&self, world: World) -> Vec<String> {
        let stem = |path: &PathBuf| path.file_stem().map(|s| s.to_string_lossy().into_owned());
        if world == World::Injected { self.into.iter().filter_map(stem).collect() } else { Vec::new() }
    }
}
