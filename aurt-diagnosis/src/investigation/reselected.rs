//! Selection once more, without what was selected and failed a test.
//!
//! What fails a test may have taken the place of what would pass it: an effect that describes the fitted rows best and
//! contradicts the held-out ones hides the one that describes both. So what failed is barred, and the search goes on from what
//! passed.

use aurt_plugins::Registry;

use crate::error::DiagnosisError;
use crate::evidence::judge::Judge;
use crate::investigation::earned::Indicated;
use crate::investigation::{Investigation, earn, reshape};
use crate::request::Question;
use crate::search::ground::Recorded;
use crate::search::selection::{Chosen, Selection, Selector};

/// Searches after the first. Each bars what failed before it; two suffice for a chain of an effect and its two neighbours.
const SEARCHES: usize = 2;

/// Searches again while something that was selected fails a test, from what passed all of them. A search that finds nothing more
/// that passes changes no claim.
///
/// # Errors
/// What laws, filters and the tests report.
pub(super) fn reselect(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
    mut progress: impl FnMut(&str),
) -> Result<(), DiagnosisError> {
    for _ in 0..SEARCHES {
        let failed = investigation.indicated.clone();
        let passed = (investigation.selection.clone(), investigation.stability.clone());
        if failed.is_empty() {
            return Ok(());
        }
        progress("searching again without what failed a test");
        investigation.selection = search(question, registry, investigation, &failed, &mut progress);
        confirm(question, registry, investigation)?;
        earn(question, investigation)?;
        let score = |selection: &Selection| selection.chosen.iter().map(|c| c.score).sum::<f64>();
        let found_more = score(&investigation.selection) > score(&passed.0);
        let failed_now = std::mem::replace(&mut investigation.indicated, failed);
        if !found_more {
            (investigation.selection, investigation.stability) = passed;
            // The search has estimated shapes anew.
            return confirm(question, registry, investigation);
        }
        let is_claimed = |group: usize, chosen: &[Chosen]| chosen.iter().any(|c| c.group == group);
        let Investigation { selection, indicated, .. } = investigation;
        indicated.retain(|i| !is_claimed(i.chosen.group, &selection.chosen));
        let new: Vec<Indicated> = failed_now
            .into_iter()
            .filter(|new| indicated.iter().all(|old| old.chosen.group != new.chosen.group))
            .collect();
        indicated.extend(new);
    }
    Ok(())
}

/// Selection from what passed, among all that did not fail.
fn search(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
    failed: &[Indicated],
    progress: &mut impl FnMut(&str),
) -> Selection {
    let open: Vec<usize> = (0..investigation.groups.len())
        .filter(|group| failed.iter().all(|f| f.chosen.group != *group))
        .collect();
    let groups: Vec<_> = open.iter().map(|group| investigation.groups[*group].clone()).collect();
    let passed = &investigation.selection.chosen;
    let start = passed.iter().filter_map(|c| open.iter().position(|group| *group == c.group)).collect();
    let mut ground = Recorded {
        problem: investigation.problem.clone(),
        rows: &mut investigation.rows,
        candidates: &mut investigation.candidates,
        partition: &investigation.partition,
        layout: &investigation.layout,
        question,
        registry,
    };
    let mut selector = Selector {
        ground: &mut ground,
        baseline: &investigation.base_switches,
        groups: &groups,
        floor: &investigation.floor,
        options: &question.selection,
    };
    let mut selection = selector.run_from(start, progress);
    investigation.problem = ground.problem;
    for chosen in &mut selection.chosen {
        chosen.group = open[chosen.group];
        chosen.rivals.iter_mut().for_each(|rival| rival.group = open[rival.group]);
    }
    selection
}

/// Judges what was selected on the rows that confirm.
fn confirm(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
) -> Result<(), DiagnosisError> {
    let switches = investigation.switches();
    let Investigation {
        selection, confirm, candidates, groups, layout, partition, problem, rows, floor, ..
    } = investigation;
    for chosen in &selection.chosen {
        let candidate = &candidates[groups[chosen.group].candidate];
        reshape(confirm, candidate, question, registry, layout, partition)?;
    }
    let judge = Judge { problem, groups, rows, partition, layout, floor, options: &question.selection };
    for chosen in &mut selection.chosen {
        chosen.p_confirm = judge.p_confirm(confirm, &switches, &groups[chosen.group]);
    }
    Ok(())
}
