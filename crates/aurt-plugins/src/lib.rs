//! Finding models by name, reading experiments, composing robot models.
//!
//! - [`Registry`] knows every model that can be named and builds one from its table;
//! - [`Experiment`] is an experiment's TOML file, checked;
//! - [`RigidBodyDynamics`] and [`Experiment::robot_model`] compose the robot model;
//! - [`model_file`] writes and reads models as JSON;
//! - [`Registry::load_library`] adds the models of a dynamic library, [`new_plugin`] writes a new one to start from.
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

mod assemble;
mod build;
mod builtin;
mod configuration;
mod describe;
mod dynamic;
mod error;
pub mod experiment;
mod inner;
pub mod model_file;
mod new_plugin;
mod place;
mod registry;
pub mod suggestion;

pub use assemble::{BASE_PARAMETER_SEED, RigidBodyDynamics};
pub use build::SlotModel;
pub use configuration::{Entry, Node, NodeKind, Span};
pub use describe::ModelDescription;
pub use dynamic::{LibraryListing, LibraryProblem, Told, longest_call, watch_calls};
pub use error::{BuildError, Error};
pub use experiment::{Experiment, ExperimentErrors, Problem};
pub use new_plugin::{NewPlugin, PluginLanguage, new_plugin};
pub use registry::{ModelListing, Origin, Registry};
