//! What would be said if an effect were added to the measurement.
//!
//! An effect that is added changes the measurement y alone: the motion stays, and so do all columns X that come from it.
//! Of a diagnosis, XᵀX, the hypotheses, the noise of the instruments and what chance reaches are then known from the
//! recordings as they are ([`Prepared`]). Anew for every trial are Xᵀy and yᵀy, the baseline's coefficients, the selection
//! (begun with what is claimed of the recordings as they are, among the hypotheses about the joints that have changed), the
//! shapes of laws, contacts, delays, the tests after selection and the answer. Gears are not looked for in a trial.

mod alone;
mod anew;
mod ground;
mod prepared;
mod ripple;
mod trial;

#[cfg(test)]
mod tests;

pub use alone::SeenFault;
pub use prepared::{AddedRows, Prepared};
