//! From which size on an effect would have been found in a user's own recordings.
//!
//! Every effect is added to the recordings as in the world `injected`, at growing strength, and the recordings are
//! diagnosed. The strength is in units of what the model leaves of the recordings as they are; what is reported is the
//! size in the effect's own unit.

mod search;
mod subject;

pub use search::{DRAWS, LEVELS, Limit, Row, Status, search, tasks};
pub use subject::Subject;
