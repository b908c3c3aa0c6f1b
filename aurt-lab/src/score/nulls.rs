//! What counts against a null.

use aurt_simulation::effects::Family;

use super::claim::{Answer, Claim, is_change};
use super::claim_set::ClaimSet;
use super::news::{News, distinct};
use crate::case::{CaseType, Truth, World};

/// Whether the truth of a null is known for changes alone: of real recordings nobody knows which structure is missing.
pub(super) fn is_of_change_alone(truth: &Truth) -> bool {
    truth.world == World::Injected && truth.case_type == CaseType::Null
}

/// Claims and verdicts that say that something is missing, which are news, and not the reference's. Where an undeclared background is
/// in all recordings, something is missing there: saying so is neither right nor wrong, with its name or without.
pub(super) fn flagged_by(
    truth: &Truth,
    claim: &Claim,
    news: &[News<'_>],
    reference: Option<&Claim>,
) -> Vec<String> {
    let of_structure = claim.structure.unwrap_or(claim.verdict);
    if [claim.verdict, of_structure].iter().all(|w| *w == Answer::NoMismatch) {
        return Vec::new();
    }
    let names = names(news);
    if !names.is_empty() {
        return names;
    }
    let lacks = truth.background.iter().any(|b| b.family != Family::Q && !is_change(&b.present_in));
    let is_excused = |w: &Answer| lacks && !matches!(w, Answer::Failed | Answer::HeldOutDiffers);
    let said_before =
        |verdict: &Answer| reference.is_some_and(|r| r.verdict == *verdict || r.structure == Some(*verdict));
    // A single verdict answers for the structure as well.
    let of_change = claim.structure.map(|_| claim.verdict);
    let verdict = of_change.into_iter().chain(Some(of_structure).filter(|w| !is_excused(w)));
    verdict
        .filter(|w| *w != Answer::NoMismatch && !said_before(w))
        .find(|w| claim.effects.is_empty() || *w == Answer::Failed)
        .map(|w| vec![w.name().to_owned()])
        .unwrap_or_default()
}

/// Claims of a change, or a verdict that there is one; `news` are the claims of a change.
pub(super) fn flagged_by_change(claim: &Claim, news: &[News<'_>]) -> Vec<String> {
    let names = names(news);
    if !names.is_empty() {
        return names;
    }
    // One verdict for both questions, on claims of the structure alone, is none on the change.
    let of_structure = claim.structure.is_none() && !claim.effects.is_empty();
    let is_change = claim.verdict != Answer::NoMismatch && !of_structure;
    if is_change { vec![claim.verdict.name().to_owned()] } else { Vec::new() }
}

/// Whether a null's structural claims are those of the same robot in other recordings, its reference.
pub(super) fn agreement(truth: &Truth, claim: &Claim, reference: Option<&Claim>) -> Option<bool> {
    let reference = reference.filter(|_| is_of_change_alone(truth))?;
    let structure = |claim: &Claim| ClaimSet::of(claim).structure();
    Some(structure(claim).difference(&structure(reference)).is_none())
}

fn names(news: &[News<'_>]) -> Vec<String> {
    distinct(news.iter()).iter().map(|n| n.effect.to_owned()).collect()
}
