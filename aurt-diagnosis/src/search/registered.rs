//! When a registered model is taken: the vocabulary comes first.

use crate::evidence::account::has_structure;
use crate::hypotheses::group::Group;
use crate::search::selection::{Selection, Selector};

/// Selection with the vocabulary's groups, and then with those of registered models, which follow them in `groups`.
///
/// Where what the vocabulary finds leaves more than noise, everything is tried together from the beginning, since several
/// effects imitate a law that none of them is. A registered model has to beat the vocabulary by more than a tie, and the
/// result to be better on held-out blocks than without it.
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
    let mut left = named.after.iter().zip(selector.floor);
    if !named.chosen.is_empty() && !left.any(|(after, floor)| has_structure(*after, *floor)) {
        return named;
    }
    progress("fitting registered models");
    let together = selector.asking(baseline, groups).run(progress);
    let registered = together.chosen.iter().any(|c| c.group >= known);
    if registered && better(selector, &named, &together) { together } else { named }
}

/// Whether a selection beats another on held-out blocks: by what an effect must bring on some joint, and on the whole.
fn better(selector: &Selector<'_>, named: &Selection, together: &Selection) -> bool {
    let scoring = selector.scoring();
    let gains: Vec<f64> =
        (0..named.after.len()).map(|j| scoring.log_ratio(j, named.after[j], together.after[j])).collect();
    let shares = scoring.fit(&[]).shares;
    let least = |j: usize| selector.options.least_log_error(shares[j] * selector.ground.rows_per_s());
    gains.iter().enumerate().any(|(j, gain)| *gain > least(j)) && gains.iter().sum::<f64>() > 0.0
}
