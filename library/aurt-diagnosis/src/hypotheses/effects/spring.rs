//! `spring`: a spring that acts on the joint.
//!
//! # What it is
//! τ = k (q − q_0). Cables and hoses that twist with a joint act so, and balancers of heavy arms, whose lever
//! makes it k · lever(q).
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

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Kind, Parameters, Proposal, named};

pub(super) struct Spring;

impl Effect for Spring {
    fn id(&self) -> &'static str {
        "spring"
    }

    fn family(&self) -> Family {
        Family::P
    }

    fn kind(&self) -> Kind {
        Kind::Position
    }

    fn title(&self) -> &'static str {
        "a spring that acts on the joint"
    }

    fn decider(&self) -> &'static str {
        "static poses over the whole range of the joint"
    }

    fn source(&self) -> &'static str {
        include_str!("spring.rs")
    }

    /// The moment k q₀ alone is a constant.
    fn is_essential(&self, coefficient: usize) -> bool {
        coefficient == 0
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model": "spring", "joints": [j]}), vec![true, false]))
            .collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        let mut parameters = named(&["stiffness_nm_rad"], fitted);
        // The second coefficient is k q_0; it is unknown where an offset of the model has absorbed it.
        if let [(_, stiffness, _), (_, moment, std), ..] = fitted
            && *stiffness > 0.0
            && std.is_finite()
        {
            let rest = (json!(moment / stiffness), json!(std / stiffness));
            parameters.insert("rest_rad".to_owned(), rest);
        }
        parameters
    }
}
