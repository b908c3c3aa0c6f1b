//! The world of real recordings to which effects are added.

use std::path::Path;

use crate::case::{Case, Plan};
use crate::injected::{InjectedRequest, InjectedWorld};
use crate::product::Failure;
use aurt_plugins::Registry;
use aurt_simulation::{Random, SimulationError};

use super::source::{Ingredients, Planned, Source};

/// Cases of all experiments, one after the other.
struct Injected {
    sets: Vec<InjectedWorld>,
    /// The set of each case, and what is asked of it.
    requests: Vec<(usize, InjectedRequest)>,
    planned: Vec<Planned>,
    remarks: Vec<String>,
    seed: u64,
}

/// The cases of all experiments, one after the other, or why there are none.
pub fn source(
    ingredients: &Ingredients,
    registry: &mut Registry,
) -> Result<Result<Box<dyn Source>, String>, Failure> {
    if ingredients.into.is_empty() {
        return Ok(Err("no recordings: name experiments with --into".into()));
    }
    let mut sets = Vec::new();
    let (mut requests, mut remarks) = (Vec::new(), Vec::new());
    for path in &ingredients.into {
        let set = InjectedWorld::read(path, registry)?;
        requests
            .extend(set.requests(&ingredients.plan, ingredients.seed)?.into_iter().map(|r| (sets.len(), r)));
        remarks.extend(set.missing_nulls(&ingredients.plan));
        sets.push(set);
    }
    let planned = requests.iter().map(|(_, request)| Planned::from(&request.case)).collect();
    Ok(Ok(Box::new(Injected { sets, requests, planned, remarks, seed: ingredients.seed })))
}

impl Source for Injected {
    fn planned(&self) -> &[Planned] {
        &self.planned
    }

    fn write(&self, index: usize, cases: &Path, sealed: &Path) -> Result<(), SimulationError> {
        let (set, request) = &self.requests[index];
        let seed = Random::labelled(self.seed, &format!("injected {index}")).bits();
        self.sets[*set].make(request, seed, &Plan::case_name(index))?.write(cases, sealed)
    }

    fn remarks(&self) -> &[String] {
        &self.remarks
    }

    fn references(&self) -> Vec<String> {
        self.sets.iter().flat_map(InjectedWorld::references).collect()
    }

    fn reference(&self, name: &str) -> Result<Case, SimulationError> {
        let of = |set: &&InjectedWorld| set.references().iter().any(|known| known == name);
        self.sets.iter().find(of).map_or_else(
            || {
                Err(SimulationError::Unreadable {
                    path: name.into(),
                    reason: "there is no such reference".into(),
                })
            },
            |set| set.reference(name),
        )
    }
}
