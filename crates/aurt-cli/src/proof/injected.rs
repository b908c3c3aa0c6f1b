//! The world of real recordings to which effects are added.

use aurt_plugins::Registry;

use super::source::{Ingredients, Source};
use crate::failure::Failure;

/// The cases of all experiments, one after the other, or why there are none.
///
/// # Errors
/// Experiments that are wrong, recordings that cannot be read.
pub fn source(
    ingredients: &Ingredients,
    _registry: &mut Registry,
) -> Result<Result<Box<dyn Source>, String>, Failure> {
    if ingredients.into.is_empty() {
        return Ok(Err("no recordings: name experiments with --into".into()));
    }
    Ok(Err("this build adds no effects to recordings".into()))
}
