//! `friction_level_changed`: the same kind of friction at another level than in the calibration recordings.
//!
//! # What it is
//! τ = (F_C' − F_C) sgn q̇ + (F_v' − F_v) q̇ in the target recordings only: the structure of the model holds,
//! its friction coefficients do not. Temperature, grease, wear, another robot of the same type, or simply
//! another day.
//!
//! - `old_coulomb_nm`, `new_coulomb_nm` (Nm) and `old_viscous_nm_s`, `new_viscous_nm_s` (Nm s/rad): both
//!   coefficients in the calibration and in the target recordings.
//!
//! # How it shows
//! Against velocity, the residual of the target recordings is a step and a slope; that of the calibration
//! recordings is flat. Real robots that nobody has touched show it between days; what calibration recordings differ by
//! among themselves, or where there is one alone 2 % of dry and 6 % of other friction, is no claim.
//!
//! # Easily confused with
//! - `payload`, `base_tilt`, `torque_constant`: changes of gravity and inertia. They follow pose; this follows
//!   velocity.
//! - `temperature_dependent_friction`: drifts within a recording.
//! - a friction structure that the model lacks, if calibration and target move differently.
//!
//! # What to record to be sure
//! The calibration motion again, on the same day as the target. If that recording agrees with the target,
//! friction changed; if it agrees with the old calibration, something else did.
//!
//! # References
//! - A. C. Bittencourt, S. Gunnarsson (2012), *Static friction in a robot joint – modeling and identification
//!   of load and temperature effects*.

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::{Effect, Family, OwnFriction, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "friction_level_changed",
    family: Family::F,
    title: "friction at another level",
    decider: "the calibration motion again, on the same day as the target",
    source: include_str!("friction_level_changed.rs"),
    parameters: &[
        Parameter::new("old_coulomb_nm", Unit::Torque),
        Parameter::new("new_coulomb_nm", Unit::Torque).never_negative(),
        Parameter::new("old_viscous_nm_s", Unit::Damping),
        Parameter::new("new_viscous_nm_s", Unit::Damping).never_negative(),
    ],
    propose: |context| {
        Proposal::frictions(context.joints, "constant", &[1]).map(|p| p.of_targets()).collect()
    },
    estimate: Some(estimate),
    ..Effect::FRICTION
};

fn estimate(_: &Proposal, fitted: &[FittedColumn], own: &OwnFriction) -> Parameters {
    let mut parameters = Parameters::new();
    let pairs = [("coulomb_nm", own.coulomb_nm), ("viscous_nm_s", own.viscous_nm_s)];
    for ((name, old), (_, change, std)) in pairs.into_iter().zip(fitted) {
        parameters.insert(format!("old_{name}"), ParameterValue::exact(old));
        parameters.insert(format!("new_{name}"), ParameterValue::new(old + change, *std));
    }
    parameters
}
