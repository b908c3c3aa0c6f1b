//! Rows whose stamps lie before those of earlier rows: out of order, or of a clock that was set back.

/// Rows out of order are no more than so many in a run.
const MOST: usize = 100;

/// Rows from which the distance of stamps is taken.
const USUAL: usize = 20;

/// Gap that is left where a clock was set back: how long it really is, nobody knows. It splits every recording.
const GAP_S: f64 = 1.0;

#[derive(Default)]
pub(super) struct Late {
    /// Each with its line.
    pub(super) rows: Vec<(Vec<f64>, usize)>,
}

impl Late {
    pub(super) fn ends_before(&self, stamp: f64) -> bool {
        self.rows.len() >= MOST || self.rows.last().is_some_and(|(row, _)| stamp < row[0])
    }

    /// By how much the clock has to be set forward if it was set back: the run goes on at the usual distance of stamps,
    /// up to the `next` row where that is in order again, and does not repeat rows of before.
    pub(super) fn set_back_s(&self, series: &[Vec<f64>], next: Option<f64>) -> Option<f64> {
        let (time, first) = (&series[0], self.rows.first()?.0[0]);
        let before = time.len().saturating_sub(USUAL + 1);
        let (last, from) = (*time.last()?, time[before]);
        let usual_s = (last - from) / (time.len() - 1 - before) as f64;
        let stamps = self.rows.iter().map(|(row, _)| row[0]).chain(next);
        let end = stamps.clone().last()?;
        let mean_s = (end - first) / (stamps.clone().count() - 1) as f64;
        let rejoins = next.is_none_or(|next| next - self.rows[self.rows.len() - 1].0[0] <= 2.0 * usual_s);
        let repeats = self.rows.iter().all(|(row, _)| {
            let at = time.partition_point(|t| *t < row[0]);
            series.iter().zip(row).all(|(series, value)| series[at] == *value)
        });
        let goes_on = (0.5..=2.0).contains(&(mean_s / usual_s)) && rejoins && !repeats;
        goes_on.then(|| last + GAP_S.max(USUAL as f64 * usual_s) - first)
    }
}
