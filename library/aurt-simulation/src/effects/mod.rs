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
mod external_contact;
mod friction_level_changed;
mod joint_coupling_friction;
mod joint_elasticity;
pub mod kind;
mod load_dependent_friction;
mod payload;
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

pub use backlash::Backlash;
pub use base_tilt::BaseTilt;
pub use catalogue::{catalogue, kind, kind_among, read_effect};
pub use coulomb::Coulomb;
pub use coulomb_asymmetry::CoulombAsymmetry;
pub use current_offset::CurrentOffset;
pub use drive_efficiency::DriveEfficiency;
pub use dropped_samples::DroppedSamples;
pub use effect::{Effect, Factor, Hidden, Setup, check_joints, check_values, conflict, fields};
pub use external_contact::ExternalContact;
pub use friction_level_changed::FrictionLevelChanged;
pub use joint_coupling_friction::JointCouplingFriction;
pub use joint_elasticity::JointElasticity;
pub use kind::{Draw, EffectKind, Family, Presence, Shapes};
pub use load_dependent_friction::LoadDependentFriction;
pub use payload::Payload;
pub use presliding_hysteresis::{BristleModel, PreslidingHysteresis};
pub use rotor_inertia::RotorInertia;
pub use saturation::Saturation;
pub use spring::Spring;
pub use stribeck::{Curve, Stribeck};
pub use temperature_dependent_friction::TemperatureDependentFriction;
pub use time_delay::TimeDelay;
pub use torque_constant::TorqueConstant;
pub use torque_ripple::TorqueRipple;
pub use viscous::Viscous;
pub use viscous_asymmetry::ViscousAsymmetry;
pub use viscous_nonlinear::ViscousNonlinear;
