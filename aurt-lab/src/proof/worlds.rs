//! Which source makes the cases of which world.

use aurt_plugins::Registry;

use super::place::Place;
use super::source::{Ingredients, Source};
use super::{injected, mujoco, simulated};
use crate::case::World;
use crate::product::Failure;

/// The source of a world's cases, or why there is none on this machine.
pub fn source(
    world: World,
    ingredients: &Ingredients,
    place: &Place,
    registry: &mut Registry,
) -> Result<Result<Box<dyn Source>, String>, Failure> {
    Ok(match world {
        World::Clean | World::Rough | World::Servo => {
            Ok(Box::new(simulated::Simulated::new(world, ingredients)?))
        }
        World::Mujoco => mujoco::Mujoco::new(ingredients, place)?.map(|m| Box::new(m) as Box<dyn Source>),
        World::Injected => injected::source(ingredients, registry)?,
    })
}
