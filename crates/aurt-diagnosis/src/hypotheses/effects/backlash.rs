//! `backlash`: play between the teeth.
//!
//! # What it is
//! Motor and link are not in touch while |θ − q| < b: whenever the load changes its sign, the motor crosses the
//! gap 2b free of load and strikes the other flank.
//!
//! - `load_reversals`: how often the load changed its sign; `energy_ratio`: how much louder it was there.
//!
//! # How it shows
//! Short bursts of residual, an impact and some ringing, each time the transmitted torque changes sign, and
//! nothing in between. They lie above the cut-off of the filters, so they are looked for in the raw recording:
//! the energy along the joint's column of the inertia matrix is higher where its load changes sign than beside it.
//! The gap itself is not estimated.
//!
//! # Easily confused with
//! - `joint_elasticity`: rings as well, but after every jolt, not at changes of the load's sign.
//! - `presliding_hysteresis`: acts after changes of the *velocity's* sign, smoothly, without impacts. A joint
//!   whose load changes sign with its velocity (no gravity) shows both at the same instants.
//! - `external_contact`: does not repeat with the motion.
//!
//! # What to record to be sure
//! Slow motion of the joint through the pose where gravity changes its sign, at 500 Hz or more; by hand, the
//! play can be felt with the brake set.
//!
//! # References
//! - M. Nordin, P.-O. Gutman (2002), *Controlling mechanical systems with backlash – a survey*, Automatica.

use super::{Context, Effect, Family, FittedColumn, Parameters, Proposal};

pub(super) struct Backlash;

impl Effect for Backlash {
    fn id(&self) -> &'static str {
        "backlash"
    }

    fn family(&self) -> Family {
        Family::P
    }

    fn title(&self) -> &'static str {
        "backlash (play between the teeth)"
    }

    fn decider(&self) -> &'static str {
        "slow motion through the pose where gravity changes its sign, at 500 Hz or more"
    }

    fn source(&self) -> &'static str {
        include_str!("backlash.rs")
    }

    /// None: impacts cannot be predicted from the motion, so no column of a regressor describes them. They are found in
    /// the raw recording, by their statistics.
    fn proposals(&self, _context: &Context<'_>) -> Vec<Proposal> {
        Vec::new()
    }

    fn parameters(&self, proposal: &Proposal, _fitted: &[FittedColumn]) -> Parameters {
        proposal.fixed_parameters()
    }
}
