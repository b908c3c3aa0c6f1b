//! `torque_constant`: an error of a drive gain.
//!
//! # What it is
//! The real torque per current of joint j is (1 + e_j) times the one that was used, so y = τ/(1 + e_j). Data
//! sheets give the motor's constant without tolerances, magnets age, and gear ratios are mistyped.
//!
//! - `gain_error`: e_j, some per cent; positive where the drive is stronger than assumed, so that the measurement
//!   is too small.
//!
//! # How it shows
//! The residual of one joint follows its own total torque: gravity, inertia and friction have the same relative
//! error.
//!
//! # Easily confused with
//! - the parameters themselves: a gain error common to all joints scales every parameter and is *exactly*
//!   absorbed without a known load. Only the ratios of the joints' gains follow from unloaded motion, through
//!   the links that they share.
//! - `payload`: its mass scales with the gains.
//! - `drive_efficiency`: its odd part is exactly a gain error.
//! - `load_dependent_friction`, in motion against the load only.
//!
//! # What to record to be sure
//! A known load, held and moved; or a static torque measured with a balance at the joint.
//!
//! # References
//! - M. Gautier, S. Briot (2014), *Global identification of joint drive gains and dynamic parameters of
//!   robots*.

use crate::parameters::{ParameterValue, Parameters};
use crate::recordings::rows::Instrument;
use crate::vocabulary::{Effect, Family, Kind, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "torque_constant",
    family: Family::D,
    kind: Kind::Load,
    title: "a torque constant (drive gain) that is off",
    decider: "a known load",
    source: include_str!("torque_constant.rs"),
    parameters: &[Parameter::new("gain_error", Unit::One)],
    reads_model: true,
    propose: |context| {
        (0..context.joints).map(|j| Proposal::instrument(vec![j], j, Instrument::Gain)).collect()
    },
    estimate: Some(|_, fitted, _| {
        // The column's coefficient is that of y = (1 + slope) ŷ.
        let of = |(_, slope, std): &(String, f64, f64)| {
            let gain = 1.0 / (1.0 + slope);
            ("gain_error".to_owned(), ParameterValue::new(gain - 1.0, std * gain * gain))
        };
        fitted.first().map(of).into_iter().collect::<Parameters>()
    }),
    excludes: |parameters, _| {
        // A drive with a gain error of −1 has no torque, with a lower one it pushes the other way.
        let [error, _] = parameters.get("gain_error")?.number()?;
        (error <= -1.0).then(|| format!("gain_error is {error:.2}: the drive would push the other way"))
    },
    ..Effect::BASE
};
