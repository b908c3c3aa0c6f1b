//! Selection once more, without what was selected and failed a test.
//!
//! What fails a test may have taken the place of what would pass it: an effect that describes the fitted rows best and
//! contradicts the held-out ones hides the one that describes both. So what failed is barred, and the search goes on from what
//! passed. What failed for want of rows that confirm it, and describes the fitted ones as well as what then took its place, is an
//! alternative to that.

use aurt_plugins::Registry;

use crate::error::DiagnosisError;
use crate::hypotheses::group::Group;
use crate::investigation::delay_scan::is_delay;
use crate::investigation::earned::Indicated;
use crate::investigation::reshaped::reshape;
use crate::investigation::{Investigation, earn};
use crate::request::Question;
use crate::search::ground::Recorded;
use crate::search::scoring::Loss;
use crate::search::selection::{Chosen, Selection, Selector};

/// Searches after the first. Each bars what failed before it; two suffice for a chain of an effect and its two neighbours.
const SEARCHES: usize = 2;

/// Searches again while something that was selected fails a test, from what passed all of them. A search that finds nothing more
/// that passes changes no claim.
pub(super) fn reselect(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
    mut progress: impl FnMut(&str),
) -> Result<(), DiagnosisError> {
    let mut barred: Vec<usize> = investigation.indicated.iter().map(|i| i.chosen.group).collect();
    for _ in 0..SEARCHES {
        if barred.is_empty() {
            return Ok(());
        }
        let Investigation { selection, candidates, problem, .. } = &*investigation;
        let passed = (selection.clone(), candidates.clone(), problem.clone());
        let failed = std::mem::take(&mut investigation.indicated);
        progress("searching again without what failed a test");
        investigation.selection = search(question, registry, investigation, &barred, &mut progress);
        let Investigation { selection, confirm, candidates, groups, layout, partition, .. } =
            &mut *investigation;
        for chosen in &selection.chosen {
            let candidate = &candidates[groups[chosen.group].candidate];
            reshape((None, confirm), candidate, question, registry, layout, partition)?;
        }
        investigation.confirm_chosen(question);
        earn(question, investigation)?;
        let failed_now = std::mem::replace(&mut investigation.indicated, failed);
        let before = barred.len();
        // The search was among those that are not barred.
        barred.extend(failed_now.iter().map(|i| i.chosen.group));
        let score = |selection: &Selection| selection.chosen.iter().map(|c| c.score).sum::<f64>();
        if score(&investigation.selection) > score(&passed.0) {
            let Investigation { selection, indicated, .. } = investigation;
            indicated.retain(|i| selection.chosen.iter().all(|c| c.group != i.chosen.group));
            let failed: Vec<usize> =
                indicated.iter().filter(|i| i.lacks_confirmation).map(|i| i.chosen.group).collect();
            let is_new = |i: &Indicated| indicated.iter().all(|old| old.chosen.group != i.chosen.group);
            let new: Vec<Indicated> = failed_now.into_iter().filter(is_new).collect();
            indicated.extend(new);
            add_rivals(question, registry, investigation, &failed, &passed.0);
        } else {
            let now = std::mem::replace(&mut investigation.candidates, passed.1);
            (investigation.selection, investigation.problem) = (passed.0, passed.2);
            let Investigation { rows, confirm, candidates, layout, partition, .. } = investigation;
            let changed =
                candidates.iter().zip(now).filter(|(c, now)| c.proposal.addition != now.proposal.addition);
            for (candidate, _) in changed {
                reshape((Some(rows), confirm), candidate, question, registry, layout, partition)?;
            }
        }
        if barred.len() == before {
            return Ok(());
        }
    }
    Ok(())
}

/// Adds to the rivals of what is new those of the failed groups that could stand in its place.
fn add_rivals(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
    failed: &[usize],
    before: &Selection,
) {
    if failed.is_empty() {
        return;
    }
    let mut chosen = std::mem::take(&mut investigation.selection.chosen);
    let groups: Vec<usize> = chosen.iter().map(|c| c.group).collect();
    let all = investigation.groups.clone();
    selecting(question, registry, investigation, &all, |selector| {
        let scoring = selector.scoring();
        let full = scoring.fit(&groups);
        let is_new = |one: &Chosen| before.chosen.iter().all(|c| c.group != one.group);
        for (i, one) in chosen.iter_mut().enumerate().filter(|(_, one)| is_new(one)) {
            let Loss { score, without, .. } = scoring.loss(&groups, i, &full);
            let rivals = scoring.rivals(&groups, i, score, &without);
            one.rivals.extend(rivals.into_iter().filter(|rival| failed.contains(&rival.group)));
            one.rivals.sort_by(|a, b| b.score.total_cmp(&a.score));
        }
    });
    investigation.selection.chosen = chosen;
}

/// Selection from what passed, among all that did not fail.
fn search(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
    barred: &[usize],
    progress: &mut impl FnMut(&str),
) -> Selection {
    // The column of a delay says where to look; none is there after the look.
    let is_open =
        |group: &usize| !barred.contains(group) && !is_delay(investigation, &investigation.groups[*group]);
    let open: Vec<usize> = (0..investigation.groups.len()).filter(is_open).collect();
    let groups: Vec<_> = open.iter().map(|group| investigation.groups[*group].clone()).collect();
    let passed = &investigation.selection.chosen;
    let start = passed.iter().filter_map(|c| open.iter().position(|group| *group == c.group)).collect();
    let mut selection =
        selecting(question, registry, investigation, &groups, |selector| selector.run_from(start, progress));
    for chosen in &mut selection.chosen {
        chosen.group = open[chosen.group];
        chosen.rivals.iter_mut().for_each(|rival| rival.group = open[rival.group]);
    }
    selection
}

/// A selector among some groups on the recordings of an investigation, for one use.
fn selecting<T>(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
    groups: &[Group],
    use_of_it: impl FnOnce(&mut Selector<'_>) -> T,
) -> T {
    let mut ground = Recorded {
        problem: investigation.problem.clone(),
        rows: &mut investigation.rows,
        candidates: &mut investigation.candidates,
        partition: &investigation.partition,
        layout: &investigation.layout,
        question,
        registry,
    };
    let found = use_of_it(&mut Selector {
        ground: &mut ground,
        baseline: &investigation.base_switches,
        groups,
        floor: &investigation.floor,
        options: &question.selection,
    });
    investigation.problem = ground.problem;
    found
}
