//! From a table `{ model = "…", … }` to a model.

use std::borrow::Cow;
use std::cell::RefCell;
use std::sync::Arc;

use aurt_traits::{
    ArmTerm, CoulombModel, HysteresisModel, InnerModels, JointModel, ModelError, Slot, ViscousBasis,
};
use serde::Deserialize;
use serde::de::value::Error as SerdeError;
use serde_json::{Map, Value};

use self::inner::{Form, Inner};
use crate::configuration::NodeKind;
use crate::dynamic::{Fault, LibraryModel, LibraryTerm, PLUGIN_KEY};
use crate::error::BuildError;
use crate::listing::{LibraryListing, Origin};
use crate::place::{self, Place, Tracked};
use crate::{Node, Registry};

mod inner;

mod sealed {
    use std::sync::Arc;

    use aurt_traits::{InnerModels, ModelError};
    use serde::de::value::Error;
    use serde_json::{Map, Value};

    use crate::dynamic::{Fault, LibraryModel};
    use crate::place::Tracked;

    /// What building needs of a model trait; private, so that nobody else fills a slot.
    pub trait Construct {
        fn from_linked(table: Tracked<'_>) -> Result<Box<Self>, Error>;

        fn from_library(model: Arc<LibraryModel>, config: Map<String, Value>) -> Result<Box<Self>, Fault>;

        /// The models that it is made of, if it is made of such.
        fn inner_models(&mut self) -> Option<InnerModels<'_>>;

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
    ($model:ty, $slot:ident, $inner:expr, $complaints:expr) => {
        impl SlotModel for $model {
            const SLOT: Slot = Slot::$slot;
        }

        impl sealed::Construct for $model {
            fn from_linked(table: Tracked<'_>) -> Result<Box<Self>, SerdeError> {
                Box::<Self>::deserialize(table)
            }

            fn from_library(
                model: Arc<LibraryModel>,
                config: Map<String, Value>,
            ) -> Result<Box<Self>, Fault> {
                Ok(Box::new(LibraryTerm::create(model, config)?))
            }

            fn inner_models(&mut self) -> Option<InnerModels<'_>> {
                let inner: fn(&mut Self) -> Option<InnerModels<'_>> = $inner;
                inner(self)
            }

            fn complaints(&self) -> Vec<ModelError> {
                let complaints: fn(&Self) -> Vec<ModelError> = $complaints;
                complaints(self)
            }
        }
    };
}

fn joint_complaints(model: &(impl JointModel + ?Sized)) -> Vec<ModelError> {
    model.validate().err().unwrap_or_default()
}

slot_model!(dyn CoulombModel, Coulomb, |_| None, joint_complaints);
slot_model!(dyn HysteresisModel, Hysteresis, |_| None, joint_complaints);
slot_model!(dyn ViscousBasis, Viscous, |_| None, joint_complaints);
// Whether an arm term fits depends on the robot; that is asked when the number of joints is known.
slot_model!(dyn ArmTerm, ArmTerm, |m| m.inner_models(), |_| Vec::new());

/// Models by their former names, which old files have.
const RENAMED: [(Slot, &str, &str); 1] = [(Slot::Coulomb, "none", "constant")];

/// The present name of a model where a table gives it by a former one.
fn renamed(slot: Slot, table: &Node) -> Option<(&'static str, &'static str)> {
    let name = table.get("model")?.as_str()?;
    RENAMED.into_iter().find(|(of, old, _)| *of == slot && *old == name).map(|(_, old, new)| (old, new))
}

impl Registry {
    /// The model that a table `{ model = "…", … }` describes, for the slot of the trait `M`:
    /// `registry.build::<dyn CoulombModel>(&table)`.
    ///
    /// # Errors
    /// All complaints about the configuration, each with its place in the text.
    pub fn build<M: SlotModel + ?Sized>(&self, table: &Node) -> Result<Box<M>, Vec<BuildError>> {
        build(self, table, Form::Written)
    }

    /// What to say of a table that names a model by a former name; nothing of others.
    pub fn former_name(slot: Slot, table: &Node) -> Option<String> {
        let (old, new) = renamed(slot, table)?;
        Some(format!("the {} model `{old}` is called `{new}` now; both names mean the same", slot.name()))
    }

    /// The model that a saved table `{"model": "…", …}` describes.
    ///
    /// # Errors
    /// As [`Self::build`], without places; [`BuildError::LibraryNotLoaded`] for a model of a library that is not there.
    pub fn build_from_json<M: SlotModel + ?Sized>(&self, table: &Value) -> Result<Box<M>, Vec<BuildError>> {
        build_saved(self, table)
    }
}

fn build<M: SlotModel + ?Sized>(
    registry: &Registry,
    table: &Node,
    form: Form,
) -> Result<Box<M>, Vec<BuildError>> {
    let slot = M::SLOT;
    let mut table = Cow::Borrowed(table);
    if let Some((_, new)) = renamed(slot, &table)
        && let NodeKind::Table(entries) = &mut table.to_mut().kind
    {
        for entry in entries.iter_mut().filter(|entry| entry.key == "model") {
            entry.value.kind = NodeKind::String(new.to_owned());
        }
    }
    let table = &*table;
    let NodeKind::Table(_) = table.kind else {
        return Err(vec![BuildError::NoTable { slot, found: table.kind_name(), span: table.span.clone() }]);
    };
    let Some((name, span)) = table.get("model").and_then(|n| Some((n.as_str()?, n.span.clone()))) else {
        let span = table.get("model").map_or_else(|| table.span.clone(), |n| n.span.clone());
        return Err(vec![BuildError::NoModelKey { slot, known: registry.names(slot), span }]);
    };
    let registered = registry.locate(slot, name, span).map_err(|e| vec![e])?;
    let refuse = |place: Place, reason: String| BuildError::Configuration {
        model: name.to_owned(),
        key: place.key,
        reason,
        example: registered.listing.example.clone(),
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
    let model = match &registered.library {
        Some(library) => {
            let keys = table.entries().iter().filter(|e| e.key != "model");
            let config: Map<String, Value> = keys.map(|e| (e.key.clone(), e.value.to_json())).collect();
            M::from_library(library.clone(), config.clone()).map_err(|fault| {
                let complaints = fault.complaints(&config).into_iter();
                let place = |key: Option<&str>, reason: &str| match key {
                    Some(key) if reason.starts_with("unknown key") => place::of_name(table, key),
                    Some(key) => place::of_key(table, key),
                    None => place::of_message(table, reason),
                };
                complaints
                    .map(|(key, reason)| (key, in_terms_of_keys(&reason)))
                    .map(|(key, reason)| refuse(place(key.as_deref(), &reason), reason))
                    .collect::<Vec<_>>()
            })?
        }
        None => {
            let linked = |table: &Node| {
                let place = RefCell::new(place::whole(table));
                M::from_linked(Tracked::new(table, &place))
                    .map_err(|e| vec![refuse(place.take(), in_terms_of_keys(&e.to_string()))])
            };
            match inner::outer_table::<M>(registered, table) {
                None => linked(table)?,
                Some(outer) => match (linked(&outer), Inner::build(registry, table, form)) {
                    (Ok(mut model), Ok(inner)) => {
                        if let Some(places) = model.inner_models() {
                            inner.fill(places);
                        }
                        model
                    }
                    (outer, inner) => {
                        return Err(outer.err().into_iter().chain(inner.err()).flatten().collect());
                    }
                },
            }
        }
    };
    let complaints = BuildError::invalid(table, model.complaints());
    if complaints.is_empty() { Ok(model) } else { Err(complaints) }
}

fn saved_library(plugin: &Value) -> LibraryListing {
    let said = |key: &str| plugin.get(key).and_then(Value::as_str).unwrap_or("unknown").to_owned();
    LibraryListing {
        name: said("name"),
        version: said("version"),
        path: said("library").into(),
        blake3: said("blake3"),
    }
}

/// Whether a model that has this origin now can stand for one that was saved from a library: it is of the same library,
/// of a version that by semantic versioning changes nothing that is there. Of a linked crate only the name is known.
fn stands_for(origin: &Origin, saved: &LibraryListing) -> bool {
    match origin {
        Origin::Crate(name) => saved.name == *name,
        Origin::Library(now) => saved.name == now.name && compatible(&saved.version, &now.version),
    }
}

/// Whether two versions have the same first number that is not zero, and the same zeros before it; versions that are
/// not numbers with dots are compatible if they are equal.
fn compatible(a: &str, b: &str) -> bool {
    fn begin(version: &str) -> Option<Vec<u64>> {
        let numbers = version.split(['-', '+']).next()?.split('.');
        let numbers = numbers.map(|part| part.parse().ok()).collect::<Option<Vec<u64>>>()?;
        let end = numbers.iter().position(|n| *n != 0).map_or(numbers.len(), |first| first + 1);
        Some(numbers[..end].to_vec())
    }
    a == b || begin(a).is_some_and(|a| begin(b) == Some(a))
}

/// The model of a saved table, which may say what library it is from.
fn build_saved<M: SlotModel + ?Sized>(registry: &Registry, table: &Value) -> Result<Box<M>, Vec<BuildError>> {
    let mut table = table.clone();
    let plugin = table.as_object_mut().and_then(|keys| keys.remove(PLUGIN_KEY));
    let node = Node::from(&table);
    Registry::former_name(M::SLOT, &node).into_iter().for_each(|note| registry.note(note));
    let built = build::<M>(registry, &node, Form::Saved);
    let Some(saved) = plugin.as_ref().map(saved_library) else { return built };
    let named = table.get("model").and_then(Value::as_str);
    let now = named.and_then(|name| registry.model(M::SLOT, name).ok());
    // Another version may refuse keys that were right for the saved one: that it is another one says more.
    if let Some(other) = now.filter(|now| !stands_for(&now.origin, &saved)) {
        return Err(vec![BuildError::OtherLibrary {
            slot: M::SLOT,
            model: other.name.clone(),
            saved: Box::new(saved),
            found: other.origin.to_string(),
        }]);
    }
    built.map_err(|errors| {
        errors
            .into_iter()
            .map(|error| match error {
                BuildError::UnknownModel { slot, name: model, .. } => BuildError::LibraryNotLoaded {
                    slot,
                    model,
                    name: saved.name.clone(),
                    version: saved.version.clone(),
                    library: saved.path.clone(),
                },
                other => other,
            })
            .collect()
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compatible_as_semantic_versioning_says() {
        for (a, b, expected) in [
            ("1.2.3", "1.4.0", true),
            ("1.2.3", "2.0.0", false),
            ("0.1.0", "0.1.9", true),
            ("0.1.0", "0.2.0", false),
            ("0.1.0", "1.1.0", false),
            ("0.0.1", "0.0.2", false),
            ("0.0.1", "0.0.1", true),
            ("1.0.0-rc.1", "1.0.0", true),
            ("spring", "spring", true),
            ("spring", "autumn", false),
            ("1.0", "unknown", false),
        ] {
            assert_eq!((compatible(a, b), compatible(b, a)), (expected, expected), "{a} {b}");
        }
    }
}
