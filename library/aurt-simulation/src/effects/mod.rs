//! Physics beyond a robot's own, one effect a file.
//!
//! Each effect is a piece of a machine, a sensor or a logger, not a regressor column: rotors, gears and heat
//! stores with states of their own, hysteresis as a path, laws of friction in other forms than those that a
//! calibration fits. [`catalogue`] lists those of the common vocabulary, [`strangers`] others that no vocabulary
//! has.

mod backlash;
mod base_tilt;
mod coulomb;
mod coulomb_asymmetry;
mod current_offset;
mod drive_efficiency;
mod dropped_samples;
mod external_contact;
mod friction_level_changed;
mod joint_coupling_friction;
mod joint_elasticity;
mod kind;
mod load_dependent_friction;
mod payload;
mod presliding_hysteresis;
mod rotor_inertia;
mod saturation;
mod spring;
mod stranger;
mod stribeck;
mod temperature_dependent_friction;
mod time_delay;
mod torque_constant;
mod torque_ripple;
mod undeclared;
mod viscous;
mod viscous_asymmetry;
mod viscous_nonlinear;

pub use backlash::Backlash;
pub use base_tilt::BaseTilt;
pub use coulomb::Coulomb;
pub use coulomb_asymmetry::CoulombAsymmetry;
pub use current_offset::CurrentOffset;
pub use drive_efficiency::DriveEfficiency;
pub use dropped_samples::DroppedSamples;
pub use external_contact::ExternalContact;
pub use friction_level_changed::FrictionLevelChanged;
pub use joint_coupling_friction::JointCouplingFriction;
pub use joint_elasticity::JointElasticity;
pub use kind::{Draw, EffectKind, Family, Presence, Shapes, catalogue, kind, read_effect, strangers};
pub use load_dependent_friction::LoadDependentFriction;
pub use payload::Payload;
pub use presliding_hysteresis::{BristleModel, PreslidingHysteresis};
pub use rotor_inertia::RotorInertia;
pub use saturation::Saturation;
pub use spring::Spring;
pub use stranger::{
    AccelerationFriction, CableDrag, CrossDrag, LeakingSpring, PeriodicDisturbance, PositionDamper,
    StickingWindow,
};
pub use stribeck::Stribeck;
pub use temperature_dependent_friction::TemperatureDependentFriction;
pub use time_delay::TimeDelay;
pub use torque_constant::TorqueConstant;
pub use torque_ripple::TorqueRipple;
pub(crate) use undeclared::PRESLIDING_RAD;
pub use undeclared::{Lacks, NamedLack, Undeclared};
pub use viscous::Viscous;
pub use viscous_asymmetry::ViscousAsymmetry;
pub use viscous_nonlinear::ViscousNonlinear;

use std::fmt::Debug;

use serde::Serialize;
use serde_json::Value;

use crate::error::Complaints;
use crate::plant::Machine;
use crate::sensors::{ClockFaults, Instrument};
use crate::{Robot, SimulationError};

/// What effects change.
#[derive(Debug)]
pub struct Setup {
    /// Bodies, drives and what acts on them.
    pub machine: Machine,
    /// Sensors.
    pub instrument: Instrument,
    /// What goes wrong with the recording's rows.
    pub faults: ClockFaults,
}

/// Physics beyond a robot's own.
pub trait Effect: Debug + Send + Sync {
    /// Identifier, snake_case.
    fn identifier(&self) -> &'static str;

    /// The joints that the effect names; for effects of the whole arm, all.
    fn joints(&self) -> Vec<usize>;

    /// Its parameters by their canonical names: one value, or one for each of [`Self::joints`].
    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)>;

    /// When it acts, if it does not always.
    fn window_s(&self) -> Option<[f64; 2]> {
        None
    }

    /// Terms of the robot's own friction that the effect stands for, so that an experiment that is not to know
    /// of it has to leave them out.
    fn hidden(&self) -> Hidden {
        Hidden::Nothing
    }

    /// Makes the effect stronger or weaker, about in proportion, within what a real machine could have.
    fn scale(&mut self, factor: Factor<'_>, robot: &Robot);

    /// Checks that the effect can be on this robot.
    ///
    /// # Errors
    /// Every complaint.
    fn validate(&self, robot: &Robot) -> Result<(), SimulationError>;

    /// Puts the effect into the machine, its sensors or its logger.
    ///
    /// # Errors
    /// [`SimulationError::Conflict`] with an effect that is there already.
    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError>;

    /// All its fields, readable by [`read_effect`].
    fn fields(&self) -> Value;
}

/// By how much effects are to change their size.
#[derive(Debug, Clone, Copy)]
pub enum Factor<'a> {
    /// By the same factor on all joints.
    Uniform(f64),
    /// By a factor for each of the robot's joints.
    PerJoint(&'a [f64]),
}

impl Factor<'_> {
    /// The factor for a joint.
    #[must_use]
    pub fn on(&self, joint: usize) -> f64 {
        match self {
            Self::Uniform(factor) => *factor,
            Self::PerJoint(factors) => factors.get(joint).copied().unwrap_or(1.0),
        }
    }
}

/// A term of equation (6) that an effect stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hidden {
    /// None.
    Nothing,
    /// Coulomb friction.
    Coulomb,
    /// Viscous friction.
    Viscous,
}

fn fields(effect: &impl Serialize) -> Value {
    serde_json::to_value(effect).unwrap_or(Value::Null)
}

/// Complains about joints that the robot does not have, none at all, or one named twice.
fn check_joints(complaints: &mut Complaints, effect: &str, joints: &[usize], robot: &Robot) {
    for (i, joint) in joints.iter().enumerate() {
        complaints.joint(format!("`{effect}`"), *joint, &robot.name, robot.joints());
        if joints[..i].contains(joint) {
            let reason = "it is named twice";
            complaints.0.push(SimulationError::value(
                format!("a joint of `{effect}`"),
                *joint as f64,
                reason,
            ));
        }
    }
    if joints.is_empty() {
        let what = format!("joints of `{effect}`");
        complaints.0.push(SimulationError::Count { what, expected: 1, found: 0 });
    }
}

/// Complains unless there is one value per joint, each between `low` and `high`.
fn check_values(
    complaints: &mut Complaints,
    effect: &str,
    name: &str,
    joints: &[usize],
    values: &[f64],
    (low, high): (f64, f64),
) {
    if values.len() != joints.len() {
        let what = format!("`{name}` of `{effect}`");
        complaints.0.push(SimulationError::Count { what, expected: joints.len(), found: values.len() });
    }
    for (joint, value) in joints.iter().zip(values) {
        complaints.within(format!("`{name}` of `{effect}` on joint {joint}"), *value, low, high);
    }
}

fn conflict(first: &str, second: &str, joint: usize, reason: &str) -> SimulationError {
    SimulationError::Conflict { first: first.into(), second: second.into(), joint, reason: reason.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{Motion, Rotors, Scenario, robots, simulate};

    fn all_kinds() -> Vec<&'static EffectKind> {
        catalogue().iter().chain(strangers()).collect()
    }

    fn drawn(kind: &EffectKind, robot: &Robot, seed: u64) -> Box<dyn Effect> {
        drawn_of(kind, robot, seed, Shapes::Usual)
    }

    fn drawn_of(kind: &EffectKind, robot: &Robot, seed: u64, shapes: Shapes) -> Box<dyn Effect> {
        let mut random = Random::labelled(seed, kind.identifier);
        let joints = kind.choose_joints(robot, &mut random);
        let peak: Vec<f64> = robot.drives.iter().map(|d| 0.3 * d.torque_limit_nm).collect();
        let draw = Draw { robot, joints: &joints, peak_torque_nm: &peak, duration_s: 10.0, shapes };
        kind.draw(&draw, &mut random)
    }

    fn robot_for(kind: &EffectKind) -> Robot {
        robots::ur10e().with_rotors(kind.rotors.unwrap_or(Rotors::Geared))
    }

    /// Every effect that is drawn is valid, names itself as its kind does, survives its fields and scaling.
    #[test]
    fn every_kind_draws_valid_effects() {
        for kind in all_kinds() {
            for seed in 0..24 {
                let robot = robot_for(kind);
                let shapes = if seed % 2 == 0 { Shapes::Usual } else { Shapes::Continuum };
                let mut effect = drawn_of(kind, &robot, seed, shapes);
                assert_eq!(effect.identifier(), kind.identifier);
                effect.validate(&robot).unwrap();
                let copy = read_effect(kind.identifier, effect.fields()).unwrap();
                assert_eq!(copy.fields(), effect.fields());
                for factor in [0.1, 1e3, 1e-6, 1e9] {
                    effect.scale(Factor::Uniform(factor), &robot);
                    effect.validate(&robot).unwrap_or_else(|e| panic!("{} × {factor}: {e}", kind.identifier));
                }
            }
        }
    }

    #[test]
    fn every_kind_can_be_simulated_and_changes_the_recording() {
        let motion = Motion::MultiSine { duration_s: 6.0, harmonics: 5, top_hz: 1.0, share: 0.5 };
        for kind in all_kinds() {
            let robot = robot_for(kind);
            let trajectory = motion.plan(&robot, 1).unwrap();
            let mut scenario = Scenario::new(robot.clone(), trajectory, 1);
            let without = simulate(&scenario).unwrap();
            scenario.effects.push(drawn(kind, &robot, 5));
            let with = simulate(&scenario).unwrap_or_else(|e| panic!("{}: {e}", kind.identifier));
            assert_ne!(with.csv(), without.csv(), "{}", kind.identifier);
            assert!(with.measurement.iter().all(|m| m.is_finite()));
        }
    }

    #[test]
    fn joints_that_are_not_there_are_refused() {
        for kind in all_kinds() {
            let robot = robot_for(kind);
            let mut fields = drawn(kind, &robot, 5).fields();
            let Some(object) = fields.as_object_mut() else { panic!("no object") };
            let mut changed = false;
            for key in ["joints", "joint", "partner", "link", "other"] {
                if let Some(value) = object.get_mut(key) {
                    changed = true;
                    if let Some(first) = value.as_array_mut().and_then(|a| a.first_mut()) {
                        *first = 9.into();
                    } else {
                        *value = 9.into();
                    }
                    break;
                }
            }
            if changed {
                let effect = read_effect(kind.identifier, fields).unwrap();
                let text = effect.validate(&robot).unwrap_err().to_string();
                assert!(text.contains(" 9"), "{text}");
            }
        }
    }

    /// Shapes of the continuum lie on no grid, and fill their ranges.
    #[test]
    fn continuous_shapes_are_off_every_grid() {
        let robot = robots::ur10e();
        let shapes = |identifier: &str, field: &str| -> Vec<f64> {
            let kind = kind(identifier).unwrap();
            (0..60)
                .filter_map(|seed| drawn_of(kind, &robot, seed, Shapes::Continuum).fields()[field].as_f64())
                .collect()
        };
        for (identifier, field, [low, high]) in [
            ("stribeck", "exponent", [0.5, 2.0]),
            ("stribeck", "stribeck_velocity_rad_s", [0.01, 0.15]),
            ("joint_coupling_friction", "ratio", [-3.0, 3.0]),
            ("torque_ripple", "order", [1.0, 250.0]),
            ("viscous_nonlinear", "onset", [0.03, 0.6]),
        ] {
            let mut values = shapes(identifier, field);
            assert_eq!(values.len(), 60);
            assert!(values.iter().all(|v| (low..=high).contains(v)), "{identifier} {field}: {values:?}");
            values.sort_by(f64::total_cmp);
            values.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
            assert!(values.len() >= 40, "{identifier} {field} comes from a grid: {values:?}");
            assert!(values[values.len() - 1] - values[0] > 0.5 * (high - low), "{identifier} {field}");
        }
        assert!(shapes("joint_coupling_friction", "ratio").iter().all(|r| r.abs() >= 0.2));
        let orders = shapes("torque_ripple", "order");
        let whole = orders.iter().filter(|o| o.fract() == 0.0).count();
        assert!((10..50).contains(&whole), "{whole} of 60 orders are whole");
    }

    #[test]
    fn unknown_effects_and_fields_are_refused() {
        let text = read_effect("stribek", Value::Null).unwrap_err().to_string();
        assert!(text.contains("did you mean `stribeck`"), "{text}");
        let wrong = serde_json::json!({ "joints": [1], "offset_nm": [1.0], "offsett": 1 });
        assert!(read_effect("current_offset", wrong).unwrap_err().to_string().contains("offsett"));
    }
}
