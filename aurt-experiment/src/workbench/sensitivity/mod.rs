//! From which size on an effect would have been found in a user's own recordings.
//!
//! Every effect is added to the recordings as in the world `injected`, at growing strength, and diagnosed. The strength is in
//! units of what the model leaves of the recordings as they are; what is reported is the size in the effect's own unit.

mod check;
mod claims;
mod ladder;
mod probe;
mod search;
mod subject;
mod trials;

pub use check::{Check, check};
pub use ladder::{LEVELS, Limit};
pub use search::{DRAWS, NAMED_IN, Row, Status, search, tasks};
pub use subject::Subject;
pub use trials::Trials;
