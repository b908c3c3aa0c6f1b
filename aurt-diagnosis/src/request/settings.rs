use std::collections::BTreeMap;

use aurt_plugins::suggestion;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// What an effect must bring to be accepted. Scores are in nats: Σ_j ½ n_eff log(MSE_before / MSE_after) on held-out
/// blocks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SelectionOptions {
    /// Highest frequency of the dynamics that are looked at, Hz, as far as noise allows. `None` takes the one that suits the motion
    /// ([`suitable_f_dyn_hz`](aurt_recording::suitable_f_dyn_hz)); the settings of a verdict have the one that was taken.
    pub f_dyn_hz: Option<f64>,
    /// Least score: odds of e⁸ = 3000 to one, against some hundred hypotheses that are tried.
    pub score: f64,
    /// Least share by which the effect lowers the held-out mean squared error of some joint. Two stretches of one
    /// recording differ by as much. Of errors in a wider band than usual, less (`least_log_error`).
    pub reduction: f64,
    /// Least share of a joint's log-MSE gain that is lost without the effect (set on nulls of the clean world, seeds 11 to
    /// 202, where it keeps imitations out).
    pub share: f64,
    /// The same for a further effect of the same kind on the same joint.
    pub share_same_kind: f64,
    /// Largest number of effects: four on each of six joints.
    pub most: usize,
    /// Rounds of forward selection, replacement and removal; the third changes nothing in nineteen of twenty.
    pub rounds: usize,
    /// Candidates whose score is within this share of the best …
    pub tie: f64,
    /// … or within so many nats compete by parameter count, where blocks of time leave open which is better: a likelihood ratio
    /// of seven.
    pub tie_nats: f64,
    /// Another effect that reaches this share of the best score has its shapes estimated, too, before one is taken:
    /// shapes between two starts cost a law less than half of its score.
    pub contender: f64,
    /// A change of a joint's friction that reaches this share of the score of another change on the same joint is
    /// taken instead of it, where blocks of time leave open which is better.
    pub everyday: f64,
    /// Shifts of the residual that show what chance does: the mean and the scale of three dozen best scores are known to a
    /// sixth of their spread.
    pub null_shifts: usize,
    /// Expected share of the claims that chance alone makes (false discovery rate).
    pub level: f64,
    /// A group of which the baseline absorbs all but this share of torque is not decidable.
    pub free_share: f64,
}

/// Independent samples per second of white noise at the usual f_dyn, 10 Hz: two for each Hz up to the parallel filter's cut-off at
/// 2 f_dyn.
const USUAL_INDEPENDENT_HZ: f64 = 40.0;

/// Settings that are no shares: they may exceed one.
const NO_SHARES: [&str; 6] = ["f_dyn_hz", "score", "most", "rounds", "tie_nats", "null_shifts"];

impl SelectionOptions {
    /// The log-MSE that an effect must bring on some joint, whose error has so many independent samples per second: −ln(1 −
    /// `reduction`), and where there are more than at the usual f_dyn as much evidence a second as there. White noise of a
    /// wider band hides no effect of the motion's.
    pub(crate) fn least_log_error(&self, independent_hz: f64) -> f64 {
        -(1.0 - self.reduction).ln() * (USUAL_INDEPENDENT_HZ / independent_hz).min(1.0)
    }

    /// The settings' names and values.
    pub fn named(&self) -> BTreeMap<String, Value> {
        serde_json::to_value(self).ok().and_then(|all| serde_json::from_value(all).ok()).unwrap_or_default()
    }

    /// The same with another value of one setting.
    ///
    /// # Errors
    /// Why a setting cannot have the value: there is none of that name, it is a share or a whole number.
    pub fn with(&self, name: &str, value: f64) -> Result<Self, String> {
        let mut named = self.named();
        let Some(own) = named.get_mut(name) else {
            return Err(suggestion::help(
                name,
                "settings",
                Self::default().named().keys().map(String::as_str),
            ));
        };
        let most = if NO_SHARES.contains(&name) { f64::INFINITY } else { 1.0 };
        if !(value >= 0.0 && value <= most && value.is_finite()) {
            let range = if most == 1.0 { "a share, from 0 to 1" } else { "a number from 0" };
            return Err(format!("it is {range}, and {value} is none"));
        }
        *own = if own.is_u64() { json!(value as u64) } else { json!(value) };
        if own.as_f64() != Some(value) {
            return Err(format!("it is a whole number, and {value} is none"));
        }
        serde_json::from_value(json!(named)).map_err(|error| error.to_string())
    }
}

impl Default for SelectionOptions {
    fn default() -> Self {
        Self {
            f_dyn_hz: None,
            score: 8.0,
            reduction: 0.05,
            share: 0.12,
            share_same_kind: 0.15,
            most: 24,
            rounds: 3,
            tie: 0.03,
            tie_nats: 2.0,
            contender: 0.5,
            everyday: 0.8,
            null_shifts: 36,
            level: 0.05,
            free_share: 0.02,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::SelectionOptions;

    #[test]
    fn a_wider_band_of_noise_asks_for_no_more_evidence() {
        let options = SelectionOptions::default();
        let [slow, usual, wide] = [10.0, 40.0, 80.0].map(|hz| options.least_log_error(hz));
        assert_eq!((slow, usual), (-0.95_f64.ln(), -0.95_f64.ln()));
        assert!((80.0 * wide - 40.0 * usual).abs() < 1e-12);
    }

    #[test]
    fn settings_are_set_by_name_within_their_ranges() {
        let options = SelectionOptions::default();
        assert_eq!(options.named().len(), 14);
        assert_eq!(options.with("level", 0.01).unwrap(), SelectionOptions { level: 0.01, ..options });
        assert_eq!(options.with("rounds", 2.0).unwrap(), SelectionOptions { rounds: 2, ..options });
        assert_eq!(
            options.with("f_dyn_hz", 4.5).unwrap(),
            SelectionOptions { f_dyn_hz: Some(4.5), ..options }
        );
        for (name, value, said) in [
            ("score", -1.0, "from 0"),
            ("level", 1.5, "share"),
            ("rounds", 2.5, "whole"),
            ("scor", 9.0, "`score`"),
        ] {
            let refused = options.with(name, value).unwrap_err();
            assert!(refused.contains(said), "{name}: {refused}");
        }
    }
}
