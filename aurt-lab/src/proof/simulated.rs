//! The worlds of our own simulator.

use std::path::Path;

use crate::{
    case::{Plan, World},
    product::Failure,
};

use super::source::{Ingredients, Planned, Source};

#[derive(Debug)]
pub struct Simulated {
    world: World,
    plan: Plan,
    seed: u64,
    planned: Vec<Planned>,
}

impl Simulated {
    pub fn new(world: World, ingredients: &Ingredients) -> Result<Self, Failure> {
        let (plan, seed) = (ingredients.plan.clone(), ingredients.seed);
        let planned = plan.requests_of(world, seed)?.iter().map(Planned::from).collect();
        Ok(Self { world, plan, seed, planned })
    }
}

impl Source for Simulated {
    fn planned(&self) -> &[Planned] {
        &self.planned
    }

    fn write(&self, index: usize, cases: &Path, sealed: &Path) -> Result<(), String> {
        let write = || self.plan.make(self.world, self.seed, index)?.write(cases, sealed);
        write().map_err(|error| error.to_string())
    }
}
