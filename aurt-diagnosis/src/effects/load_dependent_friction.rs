//! `load_dependent_friction`: friction that grows with the load the joint carries.
//!
//! # What it is
//! τ = F_1 |τ_J| sgn q̇, or F_1 τ_J² sgn q̇: the teeth of a gear are pressed together by the transmitted torque
//! τ_J, and friction grows in proportion.
//!
//! - `load_coefficient`: F_1 ≥ 0 of |τ_J|, 0.06–0.15 Nm/Nm on harmonic drives;
//! - `load_coefficient_per_nm`: that of τ_J², 1/Nm;
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

use crate::effects::coulomb;
use crate::parameters::ParameterValue;
use crate::vocabulary::{Effect, Family, Kind, Parameter, Proposal, Unit};

/// Coulomb models with the power of the load that they contain.
const MODELS: [(&str, f64); 2] = [("absolute", 1.0), ("square", 2.0)];

pub static EFFECT: Effect = Effect {
    id: "load_dependent_friction",
    family: Family::L,
    kind: Kind::Load,
    title: "friction that grows with the load the joint carries",
    decider: "the same motion with and without a known payload",
    source: include_str!("load_dependent_friction.rs"),
    parameters: &[
        Parameter::new("load_coefficient", Unit::One),
        Parameter::new("load_coefficient_per_nm", Unit::PerTorque),
        Parameter::new("power", Unit::One),
    ],
    generalises: &[&coulomb::EFFECT],
    reads_model: true,
    is_essential: |coefficient| coefficient > 0,
    propose: |context| {
        let proposal = |j: usize, (model, power): (&str, f64)| {
            // The first column is a plain Coulomb level, of which the model may have too much.
            Proposal::friction(j, json!({"model": model}), json!({"model": "sign"}), &[])
                .bound(&[false, true])
                .with("power", power)
        };
        (0..context.joints).flat_map(|j| MODELS.map(|model| proposal(j, model))).collect()
    },
    estimate: Some(|proposal, fitted, _| {
        let mut parameters = proposal.fixed_parameters();
        if let Some((_, value, std)) = fitted.last() {
            let is_square = proposal.fixed.get("power") == Some(&2.0);
            let name = if is_square { "load_coefficient_per_nm" } else { "load_coefficient" };
            parameters.insert(name.to_owned(), ParameterValue::new(*value, *std));
        }
        parameters
    }),
    ..Effect::FRICTION
};
