//! `load_dependent_friction`: friction that grows with the load the joint carries.
//!
//! # What it is
//! τ = F_1 |τ_J| sgn q̇, or F_1 τ_J² sgn q̇: the teeth of a gear are pressed together by the torque τ_J that
//! they transmit, and rub in proportion.
//!
//! - `load_coefficient`: F_1 ≥ 0, 0.06–0.15 Nm/Nm on harmonic drives (1/Nm for the square);
//! - `power`: 1 for |τ_J|, 2 for its square.
//!
//! # How it shows
//! The step of the residual at a reversal is large in stretched poses and small in upright ones. Joints without
//! gravity load show little of it.
//!
//! # Easily confused with
//! - `drive_efficiency`: the same with another coefficient for each sign of power.
//! - `torque_constant`: |τ_J| sgn q̇ and a gain error τ_J agree while the joint drives its load and differ in
//!   sign while the load drives the joint; motion against gravity alone cannot tell them apart.
//! - `coulomb`, where the load hardly changes.
//!
//! # What to record to be sure
//! The same motion with and without a known payload, lifting and lowering.
//!
//! # References
//! - P. Hamon, M. Gautier, P. Garrec (2010), *Dynamic identification of robots with a dry friction model
//!   depending on load and velocity*.
//! - A. C. Bittencourt, S. Gunnarsson (2012), *Static friction in a robot joint – modeling and identification
//!   of load and temperature effects*.

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Kind, Parameters, Proposal, joint_friction};

/// Coulomb models with the power of the load that they contain.
const MODELS: [(&str, f64); 2] = [("absolute", 1.0), ("square", 2.0)];

pub(super) struct LoadDependentFriction;

impl Effect for LoadDependentFriction {
    fn id(&self) -> &'static str {
        "load_dependent_friction"
    }

    fn family(&self) -> Family {
        Family::L
    }

    fn kind(&self) -> Kind {
        Kind::Load
    }

    fn everyday(&self) -> bool {
        true
    }

    fn generalises(&self) -> &'static [&'static str] {
        &["coulomb"]
    }

    fn title(&self) -> &'static str {
        "friction that grows with the load the joint carries"
    }

    fn decider(&self) -> &'static str {
        "the same motion with and without a known payload"
    }

    fn source(&self) -> &'static str {
        include_str!("load_dependent_friction.rs")
    }

    fn reads_model(&self) -> bool {
        true
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        let proposal = |j: usize, (model, power): (&str, f64)| {
            let term = joint_friction(j, json!({"model": model}), json!({"model": "sign"}), &[]);
            // The first column is a plain Coulomb level, of which the model may have too much.
            Proposal::on_joint(j, term, vec![false, true]).with("power", power)
        };
        (0..context.joints).flat_map(|j| MODELS.map(|model| proposal(j, model))).collect()
    }

    fn parameters(&self, proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        let mut parameters = proposal.fixed_parameters();
        if let Some((_, value, std)) = fitted.last() {
            parameters.insert("load_coefficient".to_owned(), (json!(value), json!(std)));
        }
        parameters
    }
}
