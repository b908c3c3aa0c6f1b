use super::claim::{Answer, is_change};
use super::news::{News, Sameness, whole_arm};
use crate::case::TrueEffect;

/// What the claims on effects of the vocabulary come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Compared {
    /// The first labels are the true ones, whatever the verdict.
    pub first_label: bool,
    /// They, or declared alternatives of theirs.
    pub with_alternatives: bool,
    /// Every true label stands somewhere.
    pub anywhere: bool,
    /// Exactly the true joints, of all effects that have joints of their own; false for a label that is missing.
    pub joints: bool,
    /// The right kinds of recordings; false for a label that is missing.
    pub presence: bool,
    /// Claims that are not true.
    pub beside: usize,
    /// All of it under a verdict that names an effect.
    pub right: bool,
}

/// Compares claims that are news with the truth. `order` is what the labels are taken from, in the verdict's order.
pub(super) fn compare(
    truth: &[TrueEffect],
    news: &[News<'_>],
    order: &[&News<'_>],
    answer: Answer,
    sameness: Sameness,
) -> Compared {
    // Declared alternatives are part of a claim.
    let class = answer.names();
    let first = &order[..order.len().min(truth.len())];
    let among = |list: &[&News<'_>], alternatives: bool| {
        !truth.is_empty()
            && truth.iter().all(|e| list.iter().any(|n| n.is(&e.effect, alternatives, sameness)))
    };
    let mut taken = vec![false; news.len()];
    let (mut joints, mut presence, mut beside) = (true, true, 0);
    for effect in truth {
        let mine = claims_on(effect, news, &taken, class, sameness);
        let claimed: Vec<usize> =
            mine.iter().flat_map(|k| news[*k].joints_as(&effect.effect, sameness).iter().copied()).collect();
        presence &= mine.iter().any(|k| news[*k].change == is_change(&effect.present_in));
        if whole_arm(&effect.effect) {
            joints &= !mine.is_empty();
            beside += mine.len().saturating_sub(1);
        } else {
            let covered = effect.joints.iter().all(|j| claimed.contains(j));
            joints &= !mine.is_empty() && covered && claimed.iter().all(|j| effect.joints.contains(j));
            beside += claimed.iter().filter(|j| !effect.joints.contains(j)).count();
        }
        for k in mine {
            taken[k] = true;
        }
    }
    beside += news.iter().zip(&taken).filter(|(_, taken)| !**taken).map(|(n, _)| n.count()).sum::<usize>();
    let labels = among(first, class);
    Compared {
        first_label: among(first, false),
        with_alternatives: among(first, true),
        anywhere: among(&news.iter().collect::<Vec<_>>(), class),
        joints,
        presence,
        beside,
        right: answer.names() && labels && joints && presence && beside == 0,
    }
}

/// The claims that are of an effect: those of the right presence if there are any, else those of the other. Further
/// claims of the same effect are beside it.
fn claims_on(
    effect: &TrueEffect,
    news: &[News<'_>],
    taken: &[bool],
    class: bool,
    sameness: Sameness,
) -> Vec<usize> {
    let free = |k: &usize| !taken[*k];
    let of = |alternatives: bool, change: bool| -> Vec<usize> {
        let is = |k: &usize| news[*k].change == change && news[*k].is(&effect.effect, alternatives, sameness);
        (0..news.len()).filter(free).filter(is).collect()
    };
    let change = is_change(&effect.present_in);
    let choices = [(false, change), (class, change), (false, !change), (class, !change)];
    choices
        .into_iter()
        .map(|(alternatives, change)| of(alternatives, change))
        .find(|m| !m.is_empty())
        .unwrap_or_default()
}
