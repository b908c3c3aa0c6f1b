//! What a verdict says of registered models.

use crate::investigation::{Fitted, Investigation};
use crate::parameters::{ParameterValue, Parameters};
use crate::request::Question;
use crate::verdict::RegisteredFinding;
use crate::verdict::findings::present_in;

/// The registered models that selection took, strongest first.
pub(crate) fn findings(
    question: &Question<'_>,
    investigation: &Investigation,
    fitted: &Fitted,
) -> Vec<RegisteredFinding> {
    let mut found = Vec::new();
    for chosen in &investigation.selection.chosen {
        let group = &investigation.groups[chosen.group];
        let candidate = &investigation.candidates[group.candidate];
        let Some(model) = &candidate.registered else { continue };
        let mut parameters: Parameters = candidate.proposal.fixed_parameters();
        let columns = fitted.columns(candidate, group.target_only());
        parameters
            .extend(columns.into_iter().map(|(name, value, std)| (name, ParameterValue::new(value, std))));
        let present_in = present_in(question, investigation, group.target_only());
        let loss = group.joints.iter().map(|j| chosen.joint_loss[*j]).fold(0.0, f64::max);
        let predicted_share = 1.0 - (-loss).exp();
        let changed = present_in == ["target"];
        let sentence = format!(
            "the registered {} model `{}` predicts {:.0} % of the residual of {}{}",
            model.slot.name(),
            model.name,
            100.0 * predicted_share,
            question.names().joint_list(&group.joints),
            if changed { ", in the target recordings only" } else { "" },
        );
        found.push(RegisteredFinding {
            model: model.name.clone(),
            slot: model.slot,
            origin: model.origin.to_string(),
            joints: group.joints.clone(),
            present_in,
            predicted_share,
            parameters,
            evidence: chosen.into(),
            sentence,
        });
    }
    found.sort_by(|a, b| b.evidence.score.total_cmp(&a.evidence.score));
    found
}
