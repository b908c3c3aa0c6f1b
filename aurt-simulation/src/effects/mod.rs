//! Physics beyond a robot's own, one effect a file.
//!
//! Each effect is a piece of a machine, a sensor or a logger, not a regressor column: rotors, gears and heat
//! stores with states of their own, hysteresis as a path, laws of friction in other forms than those that a
//! calibration fits. [`catalogue`] lists them.

mod backlash;
mod base_tilt;
mod catalogue;
mod coulomb;
mod coulomb_asymmetry;
mod current_offset;
mod drive_efficiency;
mod dropped_samples;
mod effect;
mod encoder_offset;
mod external_contact;
mod friction_level_changed;
mod joint_coupling_friction;
mod joint_elasticity;
mod kind;
mod load_dependent_friction;
mod payload;
mod physics;
mod presliding_hysteresis;
mod rotor_inertia;
mod saturation;
mod spring;
mod stribeck;
mod temperature_dependent_friction;
mod time_delay;
mod torque_constant;
mod torque_ripple;
mod viscous;
mod viscous_asymmetry;
mod viscous_nonlinear;

pub use catalogue::{catalogue, kind, kind_among, read_effect};
pub use effect::{Effect, Factor, Hidden, Setup, check_joints, check_values, conflict};
pub use kind::{Draw, EffectKind, Family, Presence, Shapes, Takes};
pub use physics::{Checks, Declaration, Physics};
pub use presliding_hysteresis::BristleModel;
pub use stribeck::Curve;

/// The names that the file of an effect needs.
pub mod declaring {
    pub use serde::{Deserialize, Serialize};

    pub(crate) use super::physics::per_joint;

    pub use super::kind::constant_level;
    pub use super::{
        Checks, Declaration, Draw, Factor, Family, Hidden, Physics, Presence, Setup, Takes, conflict,
    };
    pub use crate::error::SimulationError;
    pub use crate::random::Random;
    pub use crate::robots::{Robot, Rotors};
}

/// The types of the effects, and the catalogue of their kinds.
macro_rules! effects {
    ($($file:ident::$effect:ident,)+) => {
        $(pub use $file::$effect;)+

        const CATALOGUE: &[EffectKind] = &[$(EffectKind::of::<$effect>()),+];
    };
}

effects! {
    backlash::Backlash,
    base_tilt::BaseTilt,
    coulomb::Coulomb,
    coulomb_asymmetry::CoulombAsymmetry,
    current_offset::CurrentOffset,
    drive_efficiency::DriveEfficiency,
    dropped_samples::DroppedSamples,
    encoder_offset::EncoderOffset,
    external_contact::ExternalContact,
    friction_level_changed::FrictionLevelChanged,
    joint_coupling_friction::JointCouplingFriction,
    joint_elasticity::JointElasticity,
    load_dependent_friction::LoadDependentFriction,
    payload::Payload,
    presliding_hysteresis::PreslidingHysteresis,
    rotor_inertia::RotorInertia,
    saturation::Saturation,
    spring::Spring,
    stribeck::Stribeck,
    temperature_dependent_friction::TemperatureDependentFriction,
    time_delay::TimeDelay,
    torque_constant::TorqueConstant,
    torque_ripple::TorqueRipple,
    viscous::Viscous,
    viscous_asymmetry::ViscousAsymmetry,
    viscous_nonlinear::ViscousNonlinear,
}
