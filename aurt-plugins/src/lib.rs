//! Finding models by name.
//!
//! - [`Registry`] knows every model that can be named and builds one from its table;
//! - [`Node`] is such a table, with the place of every key and value;
//! - [`Registry::load_library`] adds the models of a dynamic library, [`new_plugin`] writes a new one to start from;
//! - [`model`] puts robot models together from named models, and reads and writes their files.
//!
//! ```
//! use aurt_plugins::{Node, Registry};
//! use aurt_traits::{CoulombModel, Slot};
//!
//! let registry = Registry::linked()?;
//! let absolute = registry.model(Slot::Coulomb, "absolute")?;
//! let model = registry.build::<dyn CoulombModel>(&absolute.example_table()?).map_err(|e| e[0].clone())?;
//! assert_eq!(model.columns().len(), 2);
//!
//! let unknown = registry.model(Slot::Coulomb, "absolut").unwrap_err();
//! assert!(unknown.help().is_some_and(|help| help.starts_with("did you mean `absolute`?")));
//! # Ok::<(), aurt_plugins::Error>(())
//! ```

mod build;
mod builtin;
mod configuration;
mod describe;
mod dynamic;
mod error;
mod listing;
pub mod model;
mod new_plugin;
mod place;
mod registry;
mod trust;

pub use aurt_files::suggestion;
pub use build::SlotModel;
pub use configuration::{Entry, Node, NodeKind, Span};
pub use describe::ModelDescription;
pub use error::{BuildError, Error, LibraryProblem};
pub use listing::{LibraryListing, ModelListing, Origin};
pub use new_plugin::{NewPlugin, PluginLanguage, new_plugin};
pub use registry::Registry;
pub use trust::Trust;
