//! `friction_level_changed`: the same kind of friction at another level than in the calibration recordings.
//!
//! # What it is
//! τ = (F_C' − F_C) sgn q̇ + (F_v' − F_v) q̇ in the target recordings only: the structure of the model holds,
//! its friction coefficients do not. Temperature, grease, wear, another robot of the same type, or simply
//! another day.
//!
//! - `old_coulomb_nm`, `new_coulomb_nm` (Nm) and `old_viscous_nm_s`, `new_viscous_nm_s` (Nm s/rad): both
//!   coefficients in the calibration and in the target recordings. Where the model's own are not known, the
//!   changes stand alone.
//!
//! # How it shows
//! Against velocity, the residual of the target recordings is a step and a slope; that of the calibration
//! recordings is flat. Unchanged real robots show it between days: 18 of 72 pairs of recordings of a UR10e.
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

use serde_json::{Value, json};

use super::{
    Context, Effect, Family, FittedColumn, Kind, OwnFriction, Parameters, Presence, Proposal, joint_friction,
    named,
};

pub(super) struct FrictionLevelChanged;

impl Effect for FrictionLevelChanged {
    fn id(&self) -> &'static str {
        "friction_level_changed"
    }

    fn family(&self) -> Family {
        Family::F
    }

    fn kind(&self) -> Kind {
        Kind::Friction
    }

    fn title(&self) -> &'static str {
        "the same friction at another level than in the calibration recordings"
    }

    fn decider(&self) -> &'static str {
        "the calibration motion again, on the same day as the target"
    }

    fn source(&self) -> &'static str {
        include_str!("friction_level_changed.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| {
                let term = joint_friction(j, json!({"model": "constant"}), json!({"model": "sign"}), &[1]);
                Proposal { presence: Presence::Change, ..Proposal::on_joint(j, term, vec![]) }
            })
            .collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        named(&["coulomb_change_nm", "viscous_change_nm_s"], fitted)
    }

    fn parameters_beside(
        &self,
        _proposal: &Proposal,
        fitted: &[FittedColumn],
        own: &OwnFriction,
    ) -> Parameters {
        let mut parameters = Parameters::new();
        let pairs = [("coulomb_nm", own.coulomb_nm), ("viscous_nm_s", own.viscous_nm_s)];
        for ((name, old), (_, change, std)) in pairs.into_iter().zip(fitted) {
            parameters.insert(format!("old_{name}"), (json!(old), Value::Null));
            parameters.insert(format!("new_{name}"), (json!(old + change), json!(std)));
        }
        parameters
    }
}
