//! What selection stands on: second moments, and the rows from which they come.

use aurt_plugins::Registry;

use crate::evidence::chance::Chance;
use crate::evidence::problem::Problem;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows};
use crate::request::{Question, SelectionOptions};

/// The data of a selection. Laws with shapes are estimated on it, which changes their columns.
pub trait Ground: Sync {
    /// The moments.
    fn problem(&self) -> &Problem;

    /// Share of independent rows of each joint, from the autocorrelation of the residual with the given switches and
    /// coefficients.
    fn independent_shares(&self, switches: &[Switch], coefficients: &[f64]) -> Vec<f64>;

    /// Rows per second.
    fn rows_per_s(&self) -> f64;

    /// The best scores that chance reaches with some groups beside a model; none where there are no rows to tell.
    fn scores_by_chance(
        &self,
        groups: &[Group],
        switches: &[Switch],
        floor: &[f64],
        options: &SelectionOptions,
    ) -> Chance;

    /// Estimates the shapes of a group's law beside the other switches of a model; whether they have moved.
    fn estimate(&mut self, group: &Group, beside: &Beside<'_>) -> bool;
}

/// The model beside which the shapes of a law are estimated.
#[derive(Debug, Clone, Copy)]
pub struct Beside<'a> {
    /// All coefficients but the law's own.
    pub switches: &'a [Switch],
    /// Mean squared error of each joint that noise alone leaves.
    pub floor: &'a [f64],
    /// Share of independent rows of each joint.
    pub shares: &'a [f64],
    /// Whether standard deviations are asked for.
    pub deviations: bool,
}

/// The rows of recordings, and the laws whose columns they are.
pub(crate) struct Recorded<'a> {
    pub(crate) problem: Problem,
    pub(crate) rows: &'a mut [RecordingRows],
    pub(crate) candidates: &'a mut [Candidate],
    pub(crate) partition: &'a Partition,
    pub(crate) layout: &'a Layout,
    pub(crate) question: &'a Question<'a>,
    pub(crate) registry: &'a Registry,
}
