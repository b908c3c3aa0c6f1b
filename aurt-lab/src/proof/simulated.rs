//! The worlds of our own simulator.

use std::path::Path;

use crate::case::{CaseRequest, Plan, World, servo};
use crate::product::Failure;

use super::source::{Ingredients, Planned, Source};
use aurt_simulation::{Random, SimulationError};

#[derive(Debug)]
pub struct Simulated {
    world: World,
    plan: Plan,
    seed: u64,
    /// What is asked of servo arms, whose effects are their own.
    servos: Vec<CaseRequest>,
    planned: Vec<Planned>,
}

impl Simulated {
    pub fn new(world: World, ingredients: &Ingredients) -> Result<Self, Failure> {
        let (plan, seed) = (ingredients.plan.clone(), ingredients.seed);
        let is_servo = world == World::Servo;
        let servos = if is_servo { servo::requests(&plan, seed) } else { Vec::new() };
        let planned = if is_servo { servos.clone() } else { plan.requests(seed)? };
        let planned = planned.iter().map(Planned::from).collect();
        Ok(Self { world, plan, seed, servos, planned })
    }
}

impl Source for Simulated {
    fn planned(&self) -> &[Planned] {
        &self.planned
    }

    fn write(&self, index: usize, cases: &Path, sealed: &Path) -> Result<(), SimulationError> {
        let case = match self.servos.get(index) {
            Some(request) => {
                let seed = Random::labelled(self.seed, &format!("servo {index}")).bits();
                servo::make(&Plan::case_name(index), request, seed)?
            }
            None => self.plan.make(self.world, self.seed, index)?,
        };
        case.write(cases, sealed)
    }
}
