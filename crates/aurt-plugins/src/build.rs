//! From a table `{ model = "…", … }` to a model.

use std::cell::RefCell;

use aurt_traits::{ArmTerm, CoulombModel, HysteresisModel, JointModel, ModelError, Slot, ViscousBasis};
use serde::{Deserialize, de::value::Error as SerdeError};

use crate::{
    Node, Registry,
    configuration::NodeKind,
    error::BuildError,
    place::{self, Place, Tracked},
};

mod sealed {
    use aurt_traits::ModelError;
    use serde::de::value::Error;

    use crate::place::Tracked;

    /// What building needs of a model trait; private, so that nobody else fills a slot.
    pub trait Construct {
        /// A statically linked model.
        fn from_linked(table: Tracked<'_>) -> Result<Box<Self>, Error>;

        /// What the model's own validation says, without a robot.
        fn complaints(&self) -> Vec<ModelError>;
    }
}

/// The model traits that a slot of an experiment can be filled with: `dyn` [`CoulombModel`],
/// [`HysteresisModel`], [`ViscousBasis`], [`ArmTerm`].
pub trait SlotModel: sealed::Construct {
    /// The slot.
    const SLOT: Slot;
}

macro_rules! slot_model {
    ($model:ty, $slot:ident, $complaints:expr) => {
        impl SlotModel for $model {
            const SLOT: Slot = Slot::$slot;
        }

        impl sealed::Construct for $model {
            fn from_linked(table: Tracked<'_>) -> Result<Box<Self>, SerdeError> {
                Box::<Self>::deserialize(table)
            }

            fn complaints(&self) -> Vec<ModelError> {
                let complaints: fn(&Self) -> Vec<ModelError> = $complaints;
                complaints(self)
            }
        }
    };
}

slot_model!(dyn CoulombModel, Coulomb, |m| JointModel::validate(m).err().unwrap_or_default());
slot_model!(dyn HysteresisModel, Hysteresis, |m| JointModel::validate(m).err().unwrap_or_default());
slot_model!(dyn ViscousBasis, Viscous, |m| JointModel::validate(m).err().unwrap_or_default());
// Whether an arm term fits depends on the robot; that is asked when the number of joints is known.
slot_model!(dyn ArmTerm, ArmTerm, |_| Vec::new());

pub(crate) fn build<M: SlotModel + ?Sized>(
    registry: &Registry,
    table: &Node,
) -> Result<Box<M>, Vec<BuildError>> {
    let slot = M::SLOT;
    let NodeKind::Table(_) = table.kind else {
        return Err(vec![BuildError::NoTable { slot, found: table.kind_name(), span: table.span.clone() }]);
    };
    let Some((name, span)) = table.get("model").and_then(|n| Some((n.as_str()?, n.span.clone()))) else {
        let span = table.get("model").map_or_else(|| table.span.clone(), |n| n.span.clone());
        return Err(vec![BuildError::NoModelKey { slot, known: registry.names(slot), span }]);
    };
    let listing = registry.locate(slot, name, span).map_err(|e| vec![e])?;
    let refuse = |place: Place, reason: String| BuildError::Configuration {
        model: name.to_owned(),
        key: place.key,
        reason,
        example: listing.example.clone(),
        span: place.span,
    };
    let not_finite: Vec<BuildError> = table
        .entries()
        .iter()
        .flat_map(|e| e.value.not_finite().into_iter().map(|span| Place { span, key: Some(e.key.clone()) }))
        .map(|place| refuse(place, "is not a finite number".to_owned()))
        .collect();
    if !not_finite.is_empty() {
        return Err(not_finite);
    }
    let place = RefCell::new(place::whole(table));
    let model = M::from_linked(Tracked::new(table, &place))
        .map_err(|e| vec![refuse(place.take(), in_terms_of_keys(&e.to_string()))])?;
    let complaints = invalid(table, model.complaints());
    if complaints.is_empty() { Ok(model) } else { Err(complaints) }
}

/// A model's complaints about its configuration, each with the place of the key that it names.
pub(crate) fn invalid(table: &Node, complaints: Vec<ModelError>) -> Vec<BuildError> {
    complaints
        .into_iter()
        .map(|error| {
            let place = match &error {
                ModelError::InvalidParameter { parameter, .. } => place::of_key(table, parameter),
                other => place::of_message(table, &other.to_string()),
            };
            BuildError::Invalid { error, span: place.span }
        })
        .collect()
}

/// Serde speaks of fields; who writes an experiment knows keys.
fn in_terms_of_keys(message: &str) -> String {
    [
        ("unknown field", "unknown key"),
        ("missing field", "missing key"),
        ("there are no fields", "it has no keys"),
    ]
    .iter()
    .fold(message.to_owned(), |text, (field, key)| text.replace(field, key))
}
