//! `joint_coupling_friction`: friction and inertia of a motor that turns with two joints.
//!
//! # What it is
//! The motor of one joint sits before another joint's axis and is driven through it, so its shaft turns at ω =
//! q̇_j + r q̇_k. What acts on it, f = I ω̇ + F_v ω + F_C sgn ω, loads both joints: τ_j = f and τ_k = r f.
//!
//! - `partner`, `ratio`: the joint k that the motor of j is driven through, and r, often ±1;
//! - `inertia_kg_m2`, `viscous_nm_s`, `coulomb_nm`: I, F_v, F_C ≥ 0. On the wrist of a TX40: 0.011 kg m², 0.64
//!   Nm s/rad, 1.82 Nm.
//!
//! # How it shows
//! A joint that stands still needs torque when its neighbour moves, and its friction changes sign where its own
//! velocity does not.
//!
//! # Easily confused with
//! - `coulomb`, `viscous`, `rotor_inertia` of the two joints alone: they follow each joint's own velocity. In a
//!   motion that moves both in step they are the same.
//! - inertial coupling through the links, which depends on pose and has no friction.
//!
//! # What to record to be sure
//! Each of the two joints moving alone, then both in the same and in opposite directions.
//!
//! # References
//! - M. Gautier, A. Janot, P.-O. Vandanjon (2013), *A new closed-loop output error method for parameter
//!   identification of robot dynamics*.
//! - A. Janot, P.-O. Vandanjon, M. Gautier (2014), *A generic instrumental variable approach for industrial
//!   robot identification*.

use serde_json::json;

use crate::vocabulary::shape::Shape;
use crate::vocabulary::{Context, Effect, Family, Parameter, Proposal, Unit};

/// Ratios from which the search begins: gear trains through a wrist turn a motor as fast as its neighbour, half or twice as fast.
const RATIOS: [f64; 6] = [-2.0, -1.0, -0.5, 0.5, 1.0, 2.0];

/// Where the ratio is sought: a motor that turns twenty times slower or faster with the partner than with its own
/// joint is one of either.
const RATIO: Shape = Shape::logarithmic("ratio", "/ratio", [0.05, 20.0], 0.3).with_usual_starts();

/// The motor's inertia alone is a `rotor_inertia` beside links that turn about parallel axes.
pub static EFFECT: Effect = Effect {
    id: "joint_coupling_friction",
    family: Family::C,
    title: "friction and inertia of a motor that turns with two joints",
    decider: "each of the two joints moving alone",
    source: include_str!("joint_coupling_friction.rs"),
    parameters: &[
        Parameter::new("inertia_kg_m2", Unit::Inertia).never_negative(),
        Parameter::new("viscous_nm_s", Unit::Damping).never_negative(),
        Parameter::new("coulomb_nm", Unit::Torque).never_negative(),
        Parameter::new("partner", Unit::One),
        Parameter::new("ratio", Unit::One),
    ],
    is_essential: |coefficient| coefficient > 0,
    propose,
    ..Effect::BASE
};

fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let coupling = |joint: usize, partner: usize, ratio: f64| {
        let term = json!({"model": "coupling", "joint": joint, "partner": partner, "ratio": ratio});
        Proposal::term(vec![partner, joint], term)
            .bound(&[true; 3])
            .with("partner", partner as f64)
            .shaped(RATIO)
    };
    let pairs = (0..context.joints).flat_map(|j| (j + 1..context.joints).map(move |k| (j, k)));
    // A motor is driven through a joint that carries its own, nearer to the base and not of another arm.
    let pairs = pairs.filter(|(j, k)| !context.apart.contains(&[*j, *k]));
    pairs.flat_map(|(partner, joint)| RATIOS.map(|ratio| coupling(joint, partner, ratio))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_motor_turns_with_joints_of_two_arms() {
        let context = Context {
            joints: 3,
            links: 3,
            apart: &[[1, 2]],
            recordings: &[],
            residual: &[],
            inertial: &[],
            resolution_rad: &[],
        };
        let pairs: std::collections::BTreeSet<Vec<usize>> =
            propose(&context).into_iter().map(|p| p.joints).collect();
        assert_eq!(pairs.into_iter().collect::<Vec<_>>(), [[0, 1], [0, 2]]);
    }
}
