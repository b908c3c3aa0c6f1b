//! Separable least squares: shape parameters by a search, coefficients by least squares at every step of it.
//!
//! A model is linear in its coefficients ζ and not in its shape parameters θ (presliding distance, Stribeck velocity).
//! For given θ the coefficients follow by weighted least squares, so that only
//! V(θ) = min_ζ Σ_j ‖y_j − W_j(θ) ζ‖²/σ_j² is searched (Golub and Pereyra 1973). Models say themselves what they are
//! not linear in; the search asks [`JointStack::shape_parameters`](aurt_traits::JointStack::shape_parameters) and
//! [`ArmTerm::shape_parameters`](aurt_traits::ArmTerm::shape_parameters) and knows no model.
//!
//! 1. Every joint's stack (and every arm term) by itself: V at points spread over its box, the best of them refined.
//! 2. All shapes at once, by a damped Gauss–Newton method on the projected residual (Kaufman's Jacobian
//!    −P⊥ (∂W/∂θ) ζ), within the bounds.
//! 3. Steps along each shape look for something better beside the minimum; if there is, 2 follows again.
//!
//! σ_j and the load torque are those of the fit before; the whole is repeated until the shapes stay.
//!
//! Standard deviations are those of the least-squares problem with the columns (∂W/∂θ) ζ appended, so that shapes and
//! coefficients are uncertain together. What noise of the positions is taken to have shifted of either is one more error.

mod damped;
mod fitting;
mod owner;
mod problem;
mod report;
mod search;
mod shaped;
mod shifted;
mod uncertainty;

pub use damped::ShapeOptions;
pub use fitting::{calibrate_shapes, calibrate_shapes_rows};
pub use owner::shapes_of;
pub use report::{FittedShape, ShapeReport};
