//! Joint friction models and arm terms for AURT, one model a file.
//!
//! Equation (6) of Madsen et al. (2022), τ_JD = f_C(τ_J)·H(z, q̇) + f_v(q̇), has three slots, and a model's folder
//! is the slot that it fits: [`coulomb`] for f_C, [`hysteresis`] for H, [`viscous`] for f_v. What lacks a slot's
//! invariants, or acts on several joints, is physics outside that equation and lives in [`arm_terms`].
//!
//! Linking the crate (`use aurt_friction as _;`) registers every model with [`aurt_traits::ModelEntry`] and with
//! `typetag`, so that experiments and saved models find it by its name.
//!
//! Adding a model is one file and its `mod` line below.

pub mod coulomb {
    //! Coulomb levels f_C(τ_J): even in the load torque, strictly positive.

    pub mod absent;
    pub mod absolute;
    pub mod none;
    pub mod square;
}

pub mod hysteresis {
    //! Generalised hysteresis H(z, q̇): bounded by one in magnitude, with or without memory.

    pub mod sign;
}

pub mod viscous {
    //! Viscous friction f_v(q̇): odd, continuous and of the sign of velocity.

    pub mod polynomial;
}
