//! `spring`: a spring that acts on the joint.
//!
//! # What it is
//! τ = k (q − q_0). Cables and hoses that twist with a joint act in this way, and balancers of heavy arms, whose
//! lever makes it k · lever(q).
//!
//! - `stiffness_nm_rad`: k ≥ 0, Nm/rad;
//! - `rest_rad`: q_0, the angle at which it is relaxed.
//!
//! # How it shows
//! The residual depends on the joint's angle alone: a straight line against q, the same in both directions and
//! at all speeds.
//!
//! # Easily confused with
//! - first moments of the links: gravity over a small range of angles is a straight line, too, and where the
//!   joint moves little a refit absorbs most of the spring.
//! - `torque_ripple` of a low order; a spring has no second turn.
//! - `base_tilt`, which ties several joints together.
//! - `current_offset`: the same as k q_0.
//!
//! # What to record to be sure
//! Static poses over the whole range of the joint, with the other joints folded so that gravity is small.
//!
//! # References
//! - R. Hooke (1678), *Lectures de potentia restitutiva, or of spring*.
//! - W. Khalil, E. Dombre (2002), *Modeling, Identification and Control of Robots*.

use crate::parameters::ParameterValue;
use crate::vocabulary::{Effect, Family, Kind, Parameter, Proposal, Unit};

/// The moment k q₀ alone is a constant.
pub static EFFECT: Effect = Effect {
    id: "spring",
    family: Family::P,
    kind: Kind::Position,
    title: "a spring that acts on the joint",
    decider: "static poses over the whole range of the joint",
    source: include_str!("spring.rs"),
    parameters: &[
        Parameter::new("stiffness_nm_rad", Unit::Stiffness).never_negative(),
        Parameter::new("rest_rad", Unit::Angle),
    ],
    is_essential: |coefficient| coefficient == 0,
    propose: |context| Proposal::terms(context.joints, "spring").map(|p| p.bound(&[true, false])).collect(),
    estimate: Some(|proposal, fitted, _| {
        let mut parameters = EFFECT.named(proposal, &fitted[..fitted.len().min(1)]);
        // The second coefficient is k q_0; it is unknown where an offset of the model has absorbed it.
        if let [(_, stiffness, _), (_, moment, std), ..] = fitted
            && *stiffness > 0.0
            && std.is_finite()
        {
            let rest_rad = ParameterValue::new(moment / stiffness, std / stiffness);
            parameters.insert("rest_rad".to_owned(), rest_rad);
        }
        parameters
    }),
    ..Effect::BASE
};
