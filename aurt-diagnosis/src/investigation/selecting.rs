//! Selection, and what it is made from.

use std::sync::Arc;

use aurt_plugins::Registry;

use crate::evidence::baseline::weighted_fit;
use crate::evidence::decidable::groups;
use crate::evidence::given::GivenCovariance;
use crate::evidence::gram::BlockMoments;
use crate::evidence::problem::Problem;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::fitted::Fitted;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows, Role};
use crate::request::Question;
use crate::search;
use crate::search::ground::{Ground, Recorded};
use crate::search::selection::{Selection, Selector};

/// What selection works on, beside the rows.
pub(super) struct Parts<'a> {
    pub(super) question: &'a Question<'a>,
    pub(super) registry: &'a Registry,
    pub(super) candidates: &'a mut [Candidate],
    pub(super) partition: &'a Partition,
    pub(super) layout: &'a Layout,
    pub(super) base: &'a [Switch],
    /// The baseline's coefficients.
    pub(super) own: &'a [f64],
    pub(super) floor: &'a [f64],
}

/// A selection and what it was made from.
pub(super) struct Selected {
    pub(super) problem: Problem,
    pub(super) groups: Vec<Group>,
    pub(super) free: Vec<[f64; 2]>,
    pub(super) selection: Selection,
    pub(super) fitted: Fitted,
    pub(super) mean_independent_share: f64,
}

impl Parts<'_> {
    pub(super) fn select(&mut self, rows: &mut [RecordingRows], progress: &mut impl FnMut(&str)) -> Selected {
        let mut problem = Problem::new(self.layout, BlockMoments::accumulate(rows, self.partition));
        problem.given = self.question.frozen.and_then(GivenCovariance::of).map(Arc::new);
        let (_, weights) = weighted_fit(&problem, self.base, self.floor);
        let (mut groups, free) = groups(self.candidates, &problem, self.base, &weights, self.question);
        progress("selecting");
        let mut ground = Recorded {
            problem,
            rows,
            candidates: self.candidates,
            partition: self.partition,
            layout: self.layout,
            question: self.question,
            registry: self.registry,
        };
        let (base, floor, question) = (self.base, self.floor, self.question);
        let (selection, fitted, mean_independent_share) = loop {
            let mut selector = Selector {
                ground: &mut ground,
                baseline: base,
                groups: &groups,
                floor,
                options: &question.selection,
            };
            let selection = search::registered::choose(&mut selector, &groups, &mut *progress);
            let switches = selector.final_switches(&selection);
            let (fit, _) = weighted_fit(&ground.problem, &switches, floor);
            let shares = ground.independent_shares(&switches, &fit.coefficients);
            let independent_share = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
            let fitted = Fitted::of(&ground.problem, floor, independent_share, switches);
            let own = fitted.own(self.own, base);
            let impossible = |group: usize| {
                let group = &groups[group];
                let parameters =
                    fitted.parameters(group, &ground.candidates[group.candidate], question.model, &own);
                group.effect.impossible(&parameters, f64::INFINITY).is_some()
            };
            let refused: Vec<usize> =
                selection.chosen.iter().map(|c| c.group).filter(|g| impossible(*g)).collect();
            if refused.is_empty() {
                break (selection, fitted, independent_share);
            }
            // What it describes may be of another law, one that is possible.
            let mut k = 0..groups.len();
            groups.retain(|_| k.next().is_some_and(|k| !refused.contains(&k)));
        };
        let Recorded { problem, .. } = ground;
        Selected { problem, groups, free, selection, fitted, mean_independent_share }
    }
}

/// Mean noise floor over the fitted rows of recordings whose role counts.
pub(crate) fn mean_floor(
    rows: &[RecordingRows],
    partition: &Partition,
    floors: &[Vec<f64>],
    counts: impl Fn(Role) -> bool,
) -> Vec<f64> {
    let joints = rows.first().map_or(0, |r| r.joints.len());
    (0..joints)
        .map(|j| {
            let fitted = partition.fitted().filter(|(r, ..)| counts(rows[*r].role));
            let (sum, count) = fitted.fold((0.0, 0.0), |(sum, count), (r, start, end)| {
                let counted = rows[r].joints[j].counted(start, end);
                (sum + floors[r][j] * counted, count + counted)
            });
            sum / f64::max(count, 1.0)
        })
        .collect()
}
