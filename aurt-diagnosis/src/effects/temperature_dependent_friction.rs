//! `temperature_dependent_friction`: friction that drifts along the recording.
//!
//! # What it is
//! τ = (F_T sgn q̇ + F_Tv q̇) ln(1 + t/T), t the time since the recording began. Lubricant warms up as the
//! robot works and becomes thinner. Its temperature is rarely logged; the logarithm of the uptime replaces it.
//!
//! - `coulomb_per_efold_nm`, `viscous_per_efold_nm_s`: F_T and F_Tv; `warming_time_s`: T;
//! - `rate_per_efold`: relative change of friction at a typical speed, `typical_velocity_rad_s`, each time the uptime grows by the factor
//!   e; −0.01 to −0.04 was measured on a robot that was already warm;
//! - `change_at_end`: the same change at the end of the longest recording, ln(1 + t/T) e-folds after its beginning;
//! - `duration_s`: how long the longest recording lasts.
//!
//! # How it shows
//! The same motion needs less torque late in the recording than early in it, by the same share everywhere;
//! plotted against time, the residual times sgn q̇ drifts.
//!
//! # Easily confused with
//! - another level of friction between recordings (`friction_level_changed`): that is constant within each.
//! - `viscous`, `coulomb`: an average level is always absorbed; only the drift counts.
//! - `viscous_nonlinear`, if the motion becomes faster or slower along the recording.
//!
//! # What to record to be sure
//! Half an hour of one repeated motion from a cold start, or the temperature of the joints beside the currents.
//! A recording of 20 s cannot show it.
//!
//! # References
//! - A. C. Bittencourt, S. Gunnarsson (2012), *Static friction in a robot joint – modeling and identification
//!   of load and temperature effects*.

use aurt_calibration::with_deviation;
use serde_json::json;

use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::vocabulary::shape::Shape;
use crate::vocabulary::{Context, Effect, Family, OwnFriction, Parameter, Proposal, Unit};

/// Times from which the drift is logarithmic; the search begins at the middle of what is reported of warming drives.
const WARMING_TIME: Shape = Shape::logarithmic("warming_time_s", "/warming_time_s", [3.0, 3000.0], 1.0);
/// Where it begins, s.
const USUAL_WARMING_TIME_S: f64 = 60.0;

/// The parameter in which a proposal notes the joint's root mean square speed.
const TYPICAL_VELOCITY: &str = "typical_velocity_rad_s";
/// The parameter in which a proposal notes how long the longest recording lasts.
const DURATION: &str = "duration_s";

pub static EFFECT: Effect = Effect {
    id: "temperature_dependent_friction",
    family: Family::V,
    title: "friction that drifts along the recording, as with warming lubricant",
    decider: "a long recording of one repeated motion from a cold start",
    source: include_str!("temperature_dependent_friction.rs"),
    parameters: &[
        Parameter::new("coulomb_per_efold_nm", Unit::Torque),
        Parameter::new("viscous_per_efold_nm_s", Unit::Damping),
        Parameter::new(TYPICAL_VELOCITY, Unit::Velocity),
        Parameter::new("warming_time_s", Unit::Time),
        Parameter::new("rate_per_efold", Unit::One),
        Parameter::new("change_at_end", Unit::One),
        Parameter::new(DURATION, Unit::Time),
    ],
    propose,
    estimate: Some(estimate),
    excludes: |parameters, _| {
        // Friction that falls by all of itself would drive the joint.
        let [change, std] = parameters.get("change_at_end")?.number()?;
        (change + 2.0 * std < -1.0)
            .then(|| format!("change_at_end is {}: no friction would be left", with_deviation(change, std)))
    },
    ..Effect::FRICTION
};

/// Friction rises or falls; both signs are physical.
fn propose(context: &Context<'_>) -> Vec<Proposal> {
    let ends = context.recordings.iter().filter_map(|r| Some(r.time_s.last()? - r.time_s[0]));
    let duration_s = ends.fold(0.0, f64::max);
    let on = |j: usize| {
        let term = json!({"model": "temperature", "joints": [j], "warming_time_s": USUAL_WARMING_TIME_S});
        Proposal::term(vec![j], term)
            .shaped(WARMING_TIME)
            .with(TYPICAL_VELOCITY, typical_velocity_rad_s(context, j))
            .with(DURATION, duration_s)
    };
    (0..context.joints).map(on).collect()
}

fn estimate(proposal: &Proposal, fitted: &[FittedColumn], own: &OwnFriction) -> Parameters {
    let mut parameters = EFFECT.named(proposal, fitted);
    let speed = proposal.fixed.get(TYPICAL_VELOCITY).copied().unwrap_or(0.0);
    let level = own.coulomb_nm + own.viscous_nm_s * speed;
    if let [dry, wet, ..] = fitted
        && level > 0.0
    {
        let rate = (dry.1 + wet.1 * speed) / level;
        let std = dry.2.hypot(wet.2 * speed) / level;
        parameters.insert("rate_per_efold".to_owned(), ParameterValue::new(rate, std));
        let [duration_s, warming_time_s] = [DURATION, WARMING_TIME.name].map(|name| proposal.fixed.get(name));
        if let (Some(duration_s), Some(warming_time_s)) = (duration_s, warming_time_s) {
            let efolds = (duration_s / warming_time_s).ln_1p();
            parameters.insert("change_at_end".to_owned(), ParameterValue::new(rate * efolds, std * efolds));
        }
    }
    parameters
}

/// Root mean square speed of a joint over all recordings.
fn typical_velocity_rad_s(context: &Context<'_>, joint: usize) -> f64 {
    let speeds = context.recordings.iter().flat_map(|r| &r.joints[joint].velocity_rad_s);
    let (sum, count) = speeds.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}
