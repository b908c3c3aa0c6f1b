//! Models of dynamic libraries, by the C ABI of [`aurt_traits::abi`].
//!
//! [`load`] opens a library and checks that it is one of ours ([`load_isolated`] has a process of the library's own do
//! so); its models then stand in the registry beside the linked ones, and what is built from them implements the same
//! traits. Libraries stay loaded until the process ends: code and constants of a library may be in use anywhere.

mod arm_term;
mod calls;
mod description;
mod guarded;
mod instance;
mod isolated;
mod joint_model;
mod library;

pub(crate) use self::{
    arm_term::LibraryArmTerm,
    instance::Fault,
    isolated::load as load_isolated,
    joint_model::LibraryJointModel,
    library::{LibraryModel, load},
};
pub use self::{
    calls::{Told, longest_call, watch_calls},
    isolated::{Worker, serve_if_asked, time_limit},
    library::{LibraryListing, LibraryProblem},
};
