//! The models of equation (6) inside an arm term such as `joint_friction`.
//!
//! `typetag` would read them with the term, but it knows the linked models alone. Their tables are therefore taken out
//! of the term's and built by the registry, like those of `[joint_dynamics]`: one way for models of crates and of
//! libraries, with the same errors.

use std::cell::RefCell;

use aurt_traits::{CoulombModel, HysteresisModel, InnerModels, Slot, ViscousBasis};

use super::{SlotModel, build, build_saved};
use crate::configuration::{Entry, NodeKind};
use crate::error::BuildError;
use crate::place::{self, Tracked};
use crate::registry::Registered;
use crate::{Node, Registry};

/// How a table was written down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// By a person, in an experiment.
    Written,
    /// By this program, in a model file; models of libraries say there which library they are from.
    Saved,
}

/// The models that the keys of a term's table describe; none where a key is not given.
#[derive(Debug, Default)]
pub(super) struct Inner {
    coulomb: Option<Box<dyn CoulombModel>>,
    hysteresis: Option<Box<dyn HysteresisModel>>,
    viscous: Option<Box<dyn ViscousBasis>>,
}

const SLOTS: [Slot; 3] = [Slot::Coulomb, Slot::Hysteresis, Slot::Viscous];

fn names_inner(entry: &Entry) -> bool {
    SLOTS.iter().any(|slot| entry.key == slot.name())
}

/// A linked model's table without the tables of its inner models; nothing if it has none.
pub(super) fn outer_table<M: SlotModel + ?Sized>(registered: &Registered, table: &Node) -> Option<Node> {
    if !table.entries().iter().any(names_inner) || !is_made_of_models::<M>(registered) {
        return None;
    }
    let mut outer = table.clone();
    if let NodeKind::Table(entries) = &mut outer.kind {
        entries.retain(|e| !names_inner(e));
    }
    Some(outer)
}

/// Whether a linked model has inner models, as its own example says.
fn is_made_of_models<M: SlotModel + ?Sized>(registered: &Registered) -> bool {
    let Ok(example) = registered.listing.example_table() else { return false };
    let place = RefCell::new(place::whole(&example));
    M::from_linked(Tracked::new(&example, &place)).is_ok_and(|mut model| model.inner_models().is_some())
}

impl Inner {
    /// Builds the inner models of a term's table; all that is wrong with any of them is reported.
    pub(super) fn build(registry: &Registry, table: &Node, form: Form) -> Result<Self, Vec<BuildError>> {
        let mut errors = Vec::new();
        let inner = Self {
            coulomb: one(registry, table, form, &mut errors),
            hysteresis: one(registry, table, form, &mut errors),
            viscous: one(registry, table, form, &mut errors),
        };
        if errors.is_empty() { Ok(inner) } else { Err(errors) }
    }

    pub(super) fn fill(self, places: InnerModels<'_>) {
        if let Some(model) = self.coulomb {
            *places.coulomb = model;
        }
        if let Some(model) = self.hysteresis {
            *places.hysteresis = model;
        }
        if let Some(model) = self.viscous {
            *places.viscous = model;
        }
    }
}

fn one<M: SlotModel + ?Sized>(
    registry: &Registry,
    table: &Node,
    form: Form,
    errors: &mut Vec<BuildError>,
) -> Option<Box<M>> {
    let node = table.get(M::SLOT.name())?;
    let built = match form {
        Form::Written => build::<M>(registry, node, form),
        Form::Saved => build_saved::<M>(registry, &node.to_json()),
    };
    built.map_err(|found| errors.extend(found)).ok()
}
