//! Which cases the recordings of an experiment can have.

use std::path::Path;

use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_simulation::inject::{Injection, Kind, Presence, Split, injectable, unknown_injectable};
use aurt_simulation::{Random, SimulationError};

use crate::case::{CaseRequest, CaseType, Plan};
use crate::product::{Failure, plain};
use crate::strength::Strength;

/// A case of these recordings that is to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct InjectedRequest {
    /// Type, effects and strength.
    pub case: CaseRequest,
    /// The roles of a null's recordings; where effects are added, the seed draws them.
    pub roles: Option<Split>,
}

/// The world of one experiment's recordings, to which effects are added.
///
/// ```text
/// Injection ─► reference(name): the recordings as they are
///        └───► make(request, seed, name): an effect in the targets, or in all recordings
/// ```
#[derive(Debug, Clone)]
pub struct InjectedWorld {
    pub injection: Injection,
}

impl InjectedWorld {
    /// Reads an experiment and prepares its recordings for effects to be added; the file's stem names the robot.
    pub fn read(path: &Path, registry: &mut Registry) -> Result<Self, Failure> {
        let experiment = Experiment::read(path, registry)?;
        let real = plain(&experiment)?;
        if real.mdh_csv.is_none() {
            return Err(Failure::unfit(
                path,
                "has its geometry from `urdf`, `mjcf` or `name`, and cases carry a table",
                "write the geometry as a table and name it with `mdh`",
            ));
        }
        Ok(Self { injection: Injection::new(real)? })
    }

    pub fn splits(&self) -> Vec<Split> {
        [Presence::Changed, Presence::All]
            .into_iter()
            .flat_map(|presence| Split::all(self.injection.recorded().len(), presence))
            .collect()
    }

    /// Names of the references: the recordings as they are, in the roles of each split.
    pub fn references(&self) -> Vec<String> {
        self.splits().iter().map(|split| split.reference_name(&self.injection.real().name)).collect()
    }

    /// The cases of a plan for these recordings, in an order that reveals nothing; robots of the plan do not matter. An
    /// effect that the recordings cannot have (no joint suits it, or their unit does not do) is left out where the plan
    /// asks for all effects. Nulls are distinct: each assigns the recordings to other roles, and there are at most as many.
    pub fn requests(&self, plan: &Plan, seed: u64) -> Result<Vec<InjectedRequest>, SimulationError> {
        let mut random = Random::labelled(seed, "injected plan");
        let mut requests = Vec::new();
        let known = self.possible(&injectable(self.injection.real().unit))?;
        let lists = [
            (&plan.singles, known.clone(), CaseType::Single),
            (&plan.unknown_effects, self.possible(&unknown_injectable())?, CaseType::UnknownEffect),
        ];
        for (part, all, case_type) in lists {
            let Some(part) = part else { continue };
            let chosen: Vec<String> = if part.effects.is_empty() { all } else { part.effects.clone() };
            for effect in &chosen {
                Kind::named(effect)?;
                for strength in &part.strengths {
                    for _ in 0..part.trials {
                        requests.push(self.request(case_type, std::slice::from_ref(effect), *strength));
                    }
                }
            }
        }
        if let Some(pairs) = &plan.pairs {
            let all = if pairs.effects.is_empty() { known } else { pairs.effects.clone() };
            for _ in 0..pairs.count {
                let mut two = all.clone();
                random.shuffle(&mut two);
                two.truncate(2);
                requests.push(self.request(CaseType::Pair, &two, pairs.strength));
            }
        }
        let mut assignments = Split::assignments(self.injection.recorded().len());
        random.shuffle(&mut assignments);
        for roles in assignments.into_iter().take(nulls(plan)) {
            let null = self.request(CaseType::Null, &[], Strength::Medium);
            requests.push(InjectedRequest { roles: Some(roles), ..null });
        }
        random.shuffle(&mut requests);
        Ok(requests)
    }

    /// The sentence on nulls that a plan asks for and these recordings do not have.
    pub fn missing_nulls(&self, plan: &Plan) -> Option<String> {
        let recordings = self.injection.recorded().len();
        let (asked, distinct) = (nulls(plan), Split::assignments(recordings).len());
        (distinct < asked).then(|| {
            format!(
                "{}: {distinct} nulls instead of {asked}: {recordings} recordings have no more assignments to \
                 calibration, target and validation",
                self.injection.real().name
            )
        })
    }

    fn possible(&self, effects: &[&str]) -> Result<Vec<String>, SimulationError> {
        let mut possible = Vec::new();
        for effect in effects {
            let kind = Kind::named(effect)?;
            if kind.fits(self.injection.real().unit)
                && (0..self.injection.joints()).any(|j| self.injection.suits(&kind, j))
            {
                possible.push((*effect).to_owned());
            }
        }
        Ok(possible)
    }

    fn request(&self, case_type: CaseType, effects: &[String], strength: Strength) -> InjectedRequest {
        let case = CaseRequest {
            robot: self.injection.real().name.clone(),
            case_type,
            effects: effects.to_vec(),
            strength,
        };
        InjectedRequest { case, roles: None }
    }
}

fn nulls(plan: &Plan) -> usize {
    plan.nulls.as_ref().map_or(0, |n| n.count)
}
