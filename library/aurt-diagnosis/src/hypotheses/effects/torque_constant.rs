//! `torque_constant`: a drive gain that is off.
//!
//! # What it is
//! The real torque per current of joint j is (1 + e_j) times the one that was used, so y = τ/(1 + e_j). Data
//! sheets give the motor's constant without tolerances, magnets age, and gear ratios are mistyped.
//!
//! - `gain_error`: e_j, some per cent; positive where the drive is stronger than was believed and so measures
//!   too little.
//!
//! # How it shows
//! The residual of one joint follows its own total torque: gravity, inertia and friction are all off by the
//! same share.
//!
//! # Easily confused with
//! - the parameters themselves: a gain error common to all joints scales every parameter and is *exactly*
//!   absorbed without a known load. Only the ratios of the joints' gains follow from unloaded motion, through
//!   the links that they share.
//! - `payload`: its mass scales with the gains.
//! - `drive_efficiency`: its odd part is a gain error, to the letter.
//! - `load_dependent_friction`, in motion against the load only.
//!
//! # What to record to be sure
//! A known load, held and moved; or a static torque measured with a balance at the joint.
//!
//! # References
//! - M. Gautier, S. Briot (2014), *Global identification of joint drive gains and dynamic parameters of
//!   robots*.

use serde_json::json;

use super::{Context, Effect, Family, FittedColumn, Kind, Parameters, Proposal};
use crate::recordings::rows::Instrument;

pub(super) struct TorqueConstant;

impl Effect for TorqueConstant {
    fn id(&self) -> &'static str {
        "torque_constant"
    }

    fn family(&self) -> Family {
        Family::D
    }

    fn kind(&self) -> Kind {
        Kind::Load
    }

    fn title(&self) -> &'static str {
        "a torque constant (drive gain) that is off"
    }

    fn decider(&self) -> &'static str {
        "a known load"
    }

    fn source(&self) -> &'static str {
        include_str!("torque_constant.rs")
    }

    fn reads_model(&self) -> bool {
        true
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints).map(|j| Proposal::instrument(j, Instrument::Gain, false)).collect()
    }

    fn parameters(&self, _proposal: &Proposal, fitted: &[FittedColumn]) -> Parameters {
        let mut parameters = Parameters::new();
        // The column's coefficient is that of y = (1 + slope) ŷ.
        if let Some((_, slope, std)) = fitted.first() {
            let gain = 1.0 / (1.0 + slope);
            parameters.insert("gain_error".to_owned(), (json!(gain - 1.0), json!(std * gain * gain)));
        }
        parameters
    }

    /// A drive with a gain error of −1 has no torque, with a lower one it pushes the other way.
    fn impossible(&self, parameters: &Parameters, _reach_m: f64) -> Option<String> {
        let error = parameters.get("gain_error")?.0.as_f64()?;
        (error <= -1.0).then(|| format!("gain_error is {error:.2}: the drive would push the other way"))
    }
}
