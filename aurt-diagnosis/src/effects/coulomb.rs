//! `coulomb`: dry friction whose size does not depend on velocity.
//!
//! # What it is
//! τ = F_C sgn q̇: surfaces in contact resist motion with the same torque at every velocity, against the
//! motion.
//!
//! - `coulomb_nm`, F_C ≥ 0, Nm. Behind the gears of a TX40 1.8–8 Nm, of a UR10 3–17 Nm, on the link side of a
//!   Panda 0.15–0.65 Nm.
//!
//! # How it shows
//! The residual is a square wave in the sign of velocity: it steps by 2 F_C wherever the joint reverses and is
//! flat in between. It depends neither on speed nor on pose nor on time.
//!
//! # Easily confused with
//! - `presliding_hysteresis`: the same force far from reversals, but it builds up over 10⁻³–10⁻¹ rad instead of
//!   stepping. Filters smear the step, too, so only travel after the reversal tells the two apart.
//! - `stribeck`: adds a hump at low speed. Without slow motion, F_C alone fits as well.
//! - `viscous`, where a motion hardly changes its speed: both are then constant for each direction.
//! - `load_dependent_friction`, where the load hardly changes.
//!
//! # What to record to be sure
//! Constant slow velocities (0.05–0.3 rad/s) in both directions, one joint at a time, over the same range of
//! angles. Half the difference of the torque between the directions at the same angle is the friction, free of
//! gravity.
//!
//! # References
//! - C.-A. Coulomb (1785), *Théorie des machines simples*.
//! - B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit (1994), *A survey of models, analysis tools and
//!   compensation methods for the control of machines with friction*, Automatica.

use crate::vocabulary::{Effect, Family, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "coulomb",
    family: Family::F,
    title: "Coulomb friction",
    decider: "slow motion in both directions",
    source: include_str!("coulomb.rs"),
    parameters: &[Parameter::new("coulomb_nm", Unit::Torque).never_negative()],
    propose: |context| {
        Proposal::frictions(context.joints, "constant", &[]).map(|p| p.bound(&[true])).collect()
    },
    ..Effect::FRICTION
};
