use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::claim::{Claim, ClaimedEffect};
use crate::case::{TrueEffect, Truth};

/// How far a claimed parameter is off.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterError {
    pub effect: String,
    /// Canonical name.
    pub parameter: String,
    /// |claimed − true| / |true|.
    pub relative: f64,
    /// (claimed − true) / claimed standard deviation, where one is claimed.
    pub in_std: Option<f64>,
}

impl ParameterError {
    /// Whether the truth is within two claimed standard deviations; none where none is claimed.
    pub fn is_covered(&self) -> Option<bool> {
        self.in_std.map(|z| z.abs() <= 2.0)
    }
}

pub(super) fn parameter_errors(truth: &Truth, claim: &Claim) -> Vec<ParameterError> {
    let mut errors = Vec::new();
    for effect in &truth.effects {
        let claims: Vec<&ClaimedEffect> =
            claim.effects.iter().filter(|f| f.effect == effect.effect).collect();
        for (name, values) in &named_as(effect, &claims) {
            for (place, value) in values.iter().enumerate() {
                // Values run along the effect's joints unless there is but one for all of them.
                let joint = (values.len() == effect.joints.len()).then(|| effect.joints[place]);
                let claimed = claims.iter().find_map(|c| claimed_value(c, name, joint));
                if let Some((claimed, std)) = claimed.filter(|_| *value != 0.0 && value.is_finite()) {
                    errors.push(ParameterError {
                        effect: effect.effect.clone(),
                        parameter: name.clone(),
                        relative: (claimed - value).abs() / value.abs(),
                        in_std: std.filter(|s| *s > 0.0 && s.is_finite()).map(|s| (claimed - value) / s),
                    });
                }
            }
        }
    }
    errors
}

/// The parameters of an effect as a claim names it. The motor of a coupling turns with two joints, ω = q̇_j + r q̇_k; with the other
/// one for its own it turns with ω/r, so that the ratio is 1/r, viscous friction and inertia are r² and Coulomb friction |r| times as
/// large.
fn named_as(effect: &TrueEffect, claims: &[&ClaimedEffect]) -> Vec<(String, Vec<f64>)> {
    let of = |name: &str| effect.parameters.iter().find(|(n, _)| n == name).and_then(|(_, v)| v.first());
    let claimed = claims.iter().find_map(|c| claimed_value(c, "partner", None));
    let named = of("partner").zip(claimed).filter(|(partner, (claimed, _))| *partner != claimed);
    let (Some(ratio), Some((_, (claimed, _)))) = (of("ratio"), named) else {
        return effect.parameters.clone();
    };
    let other = |(name, values): &(String, Vec<f64>)| {
        let of_other = |value: &f64| match name.as_str() {
            "partner" => claimed,
            "ratio" => 1.0 / ratio,
            "coulomb_nm" => value * ratio.abs(),
            _ => value * ratio * ratio,
        };
        (name.clone(), values.iter().map(of_other).collect())
    };
    effect.parameters.iter().map(other).collect()
}

/// The claimed value of a parameter and its deviation, at a joint where the claim has one for each.
fn claimed_value(claim: &ClaimedEffect, name: &str, joint: Option<usize>) -> Option<(f64, Option<f64>)> {
    let claimed = claim.parameters.get(name)?;
    match &claimed.value {
        Value::Number(number) if joint.is_none_or(|j| claim.joints.contains(&j)) => {
            Some((number.as_f64()?, claimed.std.as_f64()))
        }
        Value::Array(list) => {
            let place = claim.joints.iter().position(|j| Some(*j) == joint)?;
            Some((list.get(place)?.as_f64()?, claimed.std.get(place).and_then(Value::as_f64)))
        }
        _ => None,
    }
}
