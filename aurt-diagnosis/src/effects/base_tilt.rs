//! `base_tilt`: a base that is not mounted as the gravity vector says.
//!
//! # What it is
//! Gravity in the base frame is turned about its x and y axes: to first order, τ = ρ Y(q; −x × g) π + ϑ Y(q; −y × g) π, with Y the
//! rigid-body regressor at rest and π the fitted inertial parameters; around the angles that were found it is exact. Floors
//! slope, brackets bend, and mounting angles are entered incorrectly.
//!
//! - `roll_rad`, `pitch_rad`: ρ and ϑ, rad; usually some degrees (1° = 0.017 rad).
//!
//! # How it shows
//! All joints that carry gravity show residuals that depend on pose alone and are tied to each other. On a robot
//! with a vertical first axis, joint 0 carries gravity in proportion to sin q_0 and cos q_0.
//!
//! # Easily confused with
//! - `payload`: also a pattern of gravity over all joints, but it never loads a vertical first axis, and it
//!   brings inertia.
//! - `torque_constant` of a joint that mainly holds gravity.
//! - `spring`: depends on the joint's own angle alone.
//! - first moments of the links, which a refit bends to take up part of the tilt.
//!
//! # What to record to be sure
//! A spirit level on the base. Without one: static poses with joint 0 in several directions; a tilt turns with
//! q_0, a load does not.
//!
//! # References
//! - W. Khalil, E. Dombre (2002), *Modeling, Identification and Control of Robots*.

use serde_json::json;

use crate::vocabulary::{Context, Effect, Family, Kind, Parameter, Proposal, Unit};

/// Proposed twice: with the first link's moments as they were fitted, and with free ones, which a vertical first axis hides and a tilt
/// alone loads. Their columns without roll and pitch are no tilt.
pub static EFFECT: Effect = Effect {
    id: "base_tilt",
    family: Family::I,
    kind: Kind::Position,
    title: "a base that is not mounted as the gravity vector says",
    decider: "a spirit level on the base",
    source: include_str!("base_tilt.rs"),
    parameters: &[Parameter::new("roll_rad", Unit::Angle), Parameter::new("pitch_rad", Unit::Angle)],
    is_whole_arm: true,
    is_essential: |coefficient| coefficient < 2,
    reads_model: true,
    generalises: &[&EFFECT],
    propose,
    ..Effect::BASE
};

fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let (columns, values): (Vec<usize>, Vec<f64>) = context.inertial.iter().copied().unzip();
    let term = |first_axis: bool| {
        json!({
            "model": "base_tilt", "around_rad": [0.0, 0.0], "inertial_columns": columns, "inertial_values": values,
            "first_axis": first_axis,
        })
    };
    [false, true].map(|first_axis| Proposal::term((0..context.joints).collect(), term(first_axis))).to_vec()
}
