//! `viscous`: friction in proportion to velocity.
//!
//! # What it is
//! τ = F_v q̇: lubricant that is sheared resists in proportion to the speed; iron losses of the motor act in the
//! same way.
//!
//! - `viscous_nm_s`: F_v ≥ 0, Nm s/rad. Joints of a UR10 have 2.6–14 Nm s/rad behind the gear.
//!
//! # How it shows
//! Plotted against velocity, the residual is a straight line through the origin.
//!
//! # Easily confused with
//! - `coulomb`, where the motion hardly changes its speed.
//! - `viscous_nonlinear`: the same within a small range of speed.
//! - `temperature_dependent_friction`: a slope that drifts looks like two slopes if only two stretches are
//!   compared.
//! - `time_delay` acting on gravity torque: a delayed gravity torque has a part in proportion to velocity.
//!
//! # What to record to be sure
//! Constant velocities over the whole range of the joint, in both directions, at constant temperature.
//!
//! # References
//! - W. Khalil, E. Dombre (2002), *Modeling, Identification and Control of Robots*.
//! - B. Armstrong-Hélouvry (1991), *Control of Machines with Friction*.

use crate::vocabulary::{Effect, Family, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "viscous",
    family: Family::V,
    title: "viscous friction",
    decider: "constant velocities over the whole range",
    source: include_str!("viscous.rs"),
    parameters: &[Parameter::new("viscous_nm_s", Unit::Damping).never_negative()],
    propose: |context| {
        Proposal::frictions(context.joints, "absent", &[1]).map(|p| p.bound(&[true])).collect()
    },
    ..Effect::FRICTION
};
