//! When a registered model is taken: the vocabulary comes first.

use crate::evidence::account::{Left, STRUCTURE, accounts_for};
use crate::hypotheses::group::Group;
use crate::search::selection::{Chosen, Selection, Selector};

/// Selection with the vocabulary's groups, and then with those of registered models, which follow them in `groups`.
///
/// - What the vocabulary accounts for keeps its name. Registered models are then asked for what is left on joints
///   where that is more than noise, on top of what was named.
/// - Where the vocabulary finds nothing, or what it finds does not account for the mismatch, everything is tried
///   together from the beginning, since several effects imitate a law that none of them is. A registered model has
///   to beat the vocabulary by more than a tie, and the result to be better on held-out blocks than without it.
///
/// Without registered models the selection is that of the vocabulary.
pub(crate) fn choose(
    selector: &mut Selector<'_>,
    groups: &[Group],
    mut progress: impl FnMut(&str),
) -> Selection {
    let known = groups.iter().position(|g| !g.is_named()).unwrap_or(groups.len());
    let baseline = selector.baseline;
    let named = selector.asking(baseline, &groups[..known]).run(&mut progress);
    if known == groups.len() {
        return named;
    }
    if !named.chosen.is_empty() && accounts(selector.floor, &named) {
        progress("testing registered models on the residual");
        return on_top(selector, groups, known, named, progress);
    }
    progress("fitting registered models");
    let together = selector.asking(baseline, groups).run(progress);
    let registered = together.chosen.iter().any(|c| c.group >= known);
    if registered && better(selector, &named, &together) { together } else { named }
}

/// Adds registered models to what was named, on joints where more than noise is left.
fn on_top(
    selector: &mut Selector<'_>,
    groups: &[Group],
    known: usize,
    named: Selection,
    progress: impl FnMut(&str),
) -> Selection {
    let left = |joint: &usize| named.after[*joint] > STRUCTURE * STRUCTURE * selector.floor[*joint];
    let asked: Vec<usize> = (known..groups.len()).filter(|g| groups[*g].joints.iter().all(&left)).collect();
    let registered: Vec<Group> = asked.iter().map(|g| groups[*g].clone()).collect();
    let baseline = selector.baseline;
    let base = selector.asking(baseline, &groups[..known]).final_switches(&named);
    let further = selector.asking(&base, &registered).run(progress);
    let mut both = named;
    if !further.chosen.is_empty() {
        both.after = further.after;
        both.chosen.extend(further.chosen.into_iter().map(|c| Chosen {
            group: asked[c.group],
            rivals: Vec::new(),
            ..c
        }));
    }
    both
}

/// Whether a selection accounts for the mismatch, as the answer judges it, on held-out blocks.
fn accounts(floor: &[f64], selection: &Selection) -> bool {
    let joint = |((before, after), floor): ((&f64, &f64), &f64)| Left {
        before: before.sqrt(),
        after: after.sqrt(),
        floor: floor.sqrt(),
        seen: floor.sqrt(),
    };
    let joints: Vec<Left> = selection.before.iter().zip(&selection.after).zip(floor).map(joint).collect();
    accounts_for(&joints)
}

/// Whether a selection beats another on held-out blocks: by what an effect must bring on some joint, and on the whole.
fn better(selector: &Selector<'_>, named: &Selection, together: &Selection) -> bool {
    let least = -(1.0 - selector.options.reduction).ln();
    let gains: Vec<f64> = (0..named.after.len())
        .map(|j| {
            let floor = selector.floor[j].max(f64::MIN_POSITIVE);
            (named.after[j].max(floor) / together.after[j].max(floor)).ln()
        })
        .collect();
    gains.iter().any(|gain| *gain > least) && gains.iter().sum::<f64>() > 0.0
}
