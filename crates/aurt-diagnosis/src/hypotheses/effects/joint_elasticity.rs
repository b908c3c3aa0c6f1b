//! `joint_elasticity`: a transmission that gives way like a spring.
//!
//! # What it is
//! Motor and link are joined by τ_J = K (θ − q) + D (θ̇ − q̇). The link then lags behind or runs ahead of the
//! motor and the two of them ring. Well below the resonance, the torque of the rigid model is only off by a
//! multiple of its second derivative, τ̈.
//!
//! - `stiffness_nm_rad`: K, 10³–10⁵ Nm/rad, from the frequency of the ringing (`frequency_hz`) and the inertia of
//!   the joint, where the recording rings;
//! - what a slow motion determines is the ratio of the inertia that swings to the stiffness,
//!   `inertia_over_stiffness_s2`: 1/ω² of the resonance ω.
//!
//! # How it shows
//! Residuals at reversals and starts of fast motion that follow τ̈, and a peak in the spectrum, at 5–50 Hz,
//! that every jolt sets off. Above the cut-off of the filters only the raw recording shows it.
//!
//! # Easily confused with
//! - `time_delay`: follows τ̇; a resonance well above the motion delays, too.
//! - `rotor_inertia`: follows q̈, which τ̈ resembles for a single sine.
//! - noise of the acceleration: a low-pass is an elasticity of the wrong sign, which is why the sign is held.
//! - `backlash`: also rings, after impacts.
//!
//! # What to record to be sure
//! Fast reversals at a rate of 500 Hz or more, in poses of small and large inertia: the resonance moves with
//! the inertia. A sensor on the link's side shows it directly.
//!
//! # References
//! - M. W. Spong (1987), *Modeling and control of elastic joint robots*.
//! - A. De Luca, W. Book, *Robots with flexible elements*, in: Springer Handbook of Robotics.

use super::{Context, Effect, Family, FittedColumn, Kind, Parameters, Proposal, named};
use crate::recordings::rows::Instrument;

pub(super) struct JointElasticity;

impl Effect for JointElasticity {
    fn id(&self) -> &'static str {
        "joint_elasticity"
    }

    fn family(&self) -> Family {
        Family::P
    }

    fn kind(&self) -> Kind {
        Kind::Acceleration
    }

    fn is_common_when_equal(&self) -> bool {
        true
    }

    fn title(&self) -> &'static str {
        "an elastic transmission"
    }

    fn decider(&self) -> &'static str {
        "fast reversals at a rate of 500 Hz or more, with a link-side sensor if there is one"
    }

    fn source(&self) -> &'static str {
        include_str!("joint_elasticity.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints).map(|j| Proposal::instrument(j, Instrument::Jerk, true)).collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        named(&["inertia_over_stiffness_s2"], fitted)
    }
}
