//! `backlash`: play between the teeth.
//!
//! # What it is
//! Motor and link are not in contact while |θ − q| < b: whenever the load changes its sign, the link crosses the
//! gap 2b free of its motor and strikes the other flank.
//!
//! - `gap_rad`: b, half the play;
//! - `stiffness_nm_rad`, `damping_nm_s`: of the flanks, as far as the band of the recording shows them.
//!
//! # How it shows
//! Where the transmitted torque changes its sign, the link's weight and inertia are missing from the drive's
//! torque for a moment, and come back as an impact. The link is simulated, driven by the measured motion of the
//! motor; backlash is claimed if the predicted torque is found in held-out blocks of time.
//!
//! # Easily confused with
//! - `joint_elasticity`: the same link without a gap; the gap must predict more.
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

use crate::vocabulary::{Effect, Family, Means, Parameter, Unit};

/// Its torque is not linear in the gap, so no column of a regressor describes it. The gear is simulated at the recording's
/// own rate (`transmission/`).
pub static EFFECT: Effect = Effect {
    id: "backlash",
    family: Family::P,
    title: "backlash (play between the teeth)",
    decider: "slow motion through the pose where gravity changes its sign, at 500 Hz or more",
    source: include_str!("backlash.rs"),
    parameters: &[
        Parameter::new("stiffness_nm_rad", Unit::Stiffness).never_negative(),
        Parameter::new("damping_nm_s", Unit::Damping),
        Parameter::new("gap_rad", Unit::Angle),
    ],
    means: Means::FullRate,
    ..Effect::BASE
};
