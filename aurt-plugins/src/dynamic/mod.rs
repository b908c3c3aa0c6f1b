//! Models of dynamic libraries, by the C ABI of [`aurt_traits::abi`].
//!
//! [`load`] opens a library and checks that it is one of ours; its models then stand in the registry with the linked
//! ones, and what is built from them implements the same traits. Libraries stay loaded until the process ends, because
//! code and constants of a library may be in use anywhere.

mod arm_term;
mod description;
mod file;
mod guarded;
mod instance;
mod joint_model;
mod library;
mod model;

pub(crate) use self::file::LibraryFile;
pub(crate) use self::instance::{Fault, PLUGIN_KEY};
pub(crate) use self::library::{LibraryModel, load};
pub(crate) use self::model::LibraryTerm;
