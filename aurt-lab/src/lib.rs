//! The laboratory of AURT: recordings with physics that is known and concealed, and how often a diagnosis is right on them.
//!
//! ```text
//! plan ─► cases (what a diagnosis may see) ─► aurt diagnose, a process of its own per case ─► verdicts ─┐
//!   └───► truths, sealed ─────────────────────────────────────────────────────────────────────────────┴─► scores
//! ```
//!
//! Nothing here is linked into the product, and nothing here knows how the diagnosis works: it is asked as a user asks it.

#![expect(missing_docs, reason = "nothing imports it; names that say all need no sentence")]

#[macro_use]
mod word;

pub mod case;
pub mod commands;
pub mod effects;
pub mod fit;
pub mod injected;
mod json_file;
mod product;
pub mod proof;
pub mod score;
pub mod setups;
mod strength;

pub use strength::Strength;
