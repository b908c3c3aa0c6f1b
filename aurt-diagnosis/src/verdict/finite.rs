//! Every figure of a verdict is a number.

use serde_json::Value;

use crate::error::DiagnosisError;
use crate::verdict::{Finding, Verdict};

impl Verdict {
    /// The verdict, if all its figures are finite. In JSON what is not has no value, and would be read as unknown.
    ///
    /// # Errors
    /// [`DiagnosisError::NotFinite`], with the first figure that is not.
    pub fn checked(self) -> Result<Self, DiagnosisError> {
        match self.not_finite() {
            Some(figure) => Err(DiagnosisError::NotFinite { figure }),
            None => Ok(self),
        }
    }

    fn not_finite(&self) -> Option<String> {
        let indicated = self.indications.iter().map(|i| &i.finding);
        let of_findings = self.effects.iter().chain(indicated).find_map(of_finding);
        let registered = self.registered_models.iter().find_map(|model| {
            let figures = [model.evidence.score, model.predicted_share];
            bad(&figures).then(|| format!("the score of model `{}`", model.model))
        });
        let residual = self.residual.iter().find_map(|r| {
            let figures = [r.baseline_rms, r.unexplained_rms, r.floor_rms, r.follows_share];
            bad(&figures).then(|| format!("the residual of joint {}", r.joint))
        });
        let held = [&self.held_out.rms_before, &self.held_out.rms_after, &self.held_out.rms_floor];
        let held = held.into_iter().find_map(|rms| {
            let joint = rms.iter().position(|v| !v.is_finite())?;
            Some(format!("the held-out error of joint {joint}"))
        });
        let shift = self.shifts.iter().find_map(|s| {
            bad(&[s.before, s.after, s.in_std]).then(|| format!("the shift of `{}`", s.parameter))
        });
        of_findings.or(registered).or(residual).or(held).or(shift)
    }
}

fn bad(figures: &[f64]) -> bool {
    figures.iter().any(|v| !v.is_finite())
}

fn of_finding(finding: &Finding) -> Option<String> {
    let scores = finding.alternatives.iter().map(|a| a.score);
    let figures: Vec<f64> =
        scores.chain([finding.confidence, finding.evidence.score, finding.evidence.threshold]).collect();
    if bad(&figures) {
        return Some(format!("the score of {}", finding.effect));
    }
    // Numbers that are not finite have become null where they were written as JSON.
    let is_null = |value: &Value| match value {
        Value::Array(values) => !values.is_empty() && values.iter().all(Value::is_null),
        value => value.is_null(),
    };
    let parameter = finding.parameters.iter().find(|(_, p)| is_null(&p.value));
    parameter.map(|(name, _)| format!("{name} of {}", finding.effect))
}
