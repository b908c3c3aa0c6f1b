//! Joint friction models and arm terms for AURT, one model a file.
//!
//! Equation (6) of Madsen et al. (2022), *AURT: A Tool for Dynamics Calibration of Robot Manipulators*,
//! τ_JD = f_C(τ_J)·H(z, q̇) + f_v(q̇), has three slots, and a model's folder is the slot that it fits: [`coulomb`] for
//! f_C, [`hysteresis`] for H, [`viscous`] for f_v. What lacks a slot's invariants, or acts on several joints, is
//! physics outside that equation and lives in [`arm_terms`].
//!
//! [`drives`] holds drives, from the command of a joint to its torque.
//!
//! Linking the crate (`use aurt_friction as _;`) registers every model with [`aurt_traits::ModelEntry`] and with
//! `typetag`, so that experiments and saved models find it by its name. Each file's documentation holds equation,
//! parameters, use and source; columns and invariants where more is to be said than what the file declares.
//!
//! Adding a model is one file in the folder of its slot: every file there is a module, and the tests find its model by
//! the registration.

#[macro_use]
mod declare;

pub mod conformance;
pub mod drives;
mod known_bodies;
mod path_step;
mod shape;
mod stribeck_curve;
mod thresholds;

pub mod coulomb {
    //! Coulomb levels f_C(τ_J): even in the load torque, strictly positive.

    automod::dir!(pub "src/coulomb");
}

pub mod hysteresis {
    //! Generalised hysteresis H(z, q̇): bounded by one in magnitude, with or without memory.

    automod::dir!(pub "src/hysteresis");
}

pub mod viscous {
    //! Viscous friction f_v(q̇): odd, continuous and of the sign of velocity.

    automod::dir!(pub "src/viscous");
}

pub mod arm_terms {
    //! Physics outside equation (6): several joints' rows, loads, and friction that lacks a slot's invariants.

    automod::dir!(pub "src/arm_terms");
}
