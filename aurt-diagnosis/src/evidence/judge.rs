//! What a score is worth: the best score that chance reaches, and a test on rows that took no part in the search.

use crate::evidence::baseline::weighted_fit;
use crate::evidence::chance::Chance;
use crate::evidence::gram::dot;
use crate::evidence::null::{ByChance, by_chance};
use crate::evidence::problem::Problem;
use crate::evidence::refit;
use crate::evidence::residuals::residuals;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::divided::ConfirmRows;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{Layout, RecordingRows, mean_rate_hz};
use crate::request::SelectionOptions;

/// What was selected, on the rows that it was selected from.
pub(crate) struct Judge<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) groups: &'a [Group],
    pub(crate) rows: &'a [RecordingRows],
    pub(crate) partition: &'a Partition,
    pub(crate) layout: &'a Layout,
    pub(crate) floor: &'a [f64],
    pub(crate) options: &'a SelectionOptions,
}

impl Judge<'_> {
    /// The best scores that chance reaches beside a model. The score is selection's, Σ_j ½ n_eff log(before / after), both
    /// not below the floor.
    pub(crate) fn scores_by_chance(&self, switches: &[Switch], shares: &[f64]) -> Chance {
        let effective: Vec<f64> =
            (0..shares.len()).map(|j| 0.5 * shares[j] * self.problem.rows(j, false)).collect();
        let score = |before: &[f64], after: &[f64]| -> f64 {
            let of_joint = |j: usize| {
                let floor = self.floor[j].max(f64::MIN_POSITIVE);
                effective[j] * (before[j].max(floor) / after[j].max(floor)).ln()
            };
            (0..before.len()).map(of_joint).sum()
        };
        let best = |c: &ByChance| {
            let mut best = vec![0.0_f64; shares.len()];
            for (group, after) in self.groups.iter().zip(&c.after) {
                let score = score(&c.before, after);
                for joint in group.joints.iter().filter(|_| score.is_finite()) {
                    best[*joint] = best[*joint].max(score);
                }
            }
            best
        };
        Chance::new(self.by_chance(switches).iter().map(best).collect())
    }

    fn by_chance(&self, switches: &[Switch]) -> Vec<ByChance> {
        let (fit, weights) = weighted_fit(self.problem, switches, self.floor);
        let left: Vec<Vec<Vec<f64>>> =
            self.rows.iter().map(|r| residuals(r, self.layout, switches, &fit.coefficients)).collect();
        let residual = (self.rows, self.partition, &left[..]);
        by_chance(self.problem, switches, self.groups, &weights, residual, self.options.null_shifts)
    }

    /// The probability that rows which nothing was fitted to favour a group as much by chance: squared errors without
    /// and with it, in units of what the model leaves, differ from piece to piece of the held-out rows; each difference
    /// could as well have the other sign. Pieces are cut by what the two models predict, whatever was measured: they have equal
    /// sums of their shares of the rows and of the energy of the difference, since where the group does little its rows say
    /// little, and last `shortest_s` or longer where there is time for all. None where there are too few rows to tell.
    ///
    /// With the errors b without the group and b − δ with it, squared errors differ by 2bδ − δ², of the mean E = Σ δ² and the variance 4E times
    /// the `memory` if the group is right. Where E is so small that rows would often not favour a right one, b may follow δ instead: Σ 2bδ
    /// has the mean 0 where nothing is, as long as the errors with the group are not larger.
    ///
    /// A recording that differs from the fitted ones in something else says little of the group through the model's errors.
    /// Then it is judged beside the model with the columns `own` fitted to it anew, if the difference of predictions weighs more there,
    /// in units of what the model with the group leaves.
    pub(crate) fn p_confirm(
        &self,
        confirm: &ConfirmRows,
        (own, all): (&[Switch], &[Switch]),
        group: &Group,
        (shortest_s, memory): (f64, f64),
    ) -> Option<f64> {
        let rest: Vec<Switch> = all.iter().filter(|s| !group.switches.contains(s)).copied().collect();
        let [with, without] =
            [all, &rest].map(|s| (s, weighted_fit(self.problem, s, self.floor).0.coefficients));
        let rows: usize = confirm.to_judge().iter().map(RecordingRows::rows).sum();
        if rows < FEWEST_PIECES {
            return None;
        }
        let shortest = (shortest_s * mean_rate_hz(confirm.to_judge())).ceil() as usize;
        let shortest = shortest.min(rows / PIECES).max(1);
        let columns: Vec<usize> = own.iter().map(|s| s.column).collect();
        let contrasts = confirm.to_judge().iter().flat_map(|rows| {
            let errors = [&with, &without].map(|(s, beta)| residuals(rows, self.layout, s, beta));
            let levels = self.levels(&errors[0]);
            let weights: Vec<f64> = levels.iter().map(|level| level.recip()).collect();
            let mut freed = errors.clone();
            refit::free(&mut freed, rows, self.layout, &columns, &weights);
            let both = [contrasts(&freed, &self.levels(&freed[0])), contrasts(&errors, &levels)];
            let energy = |rows: &Vec<Contrast>| rows.iter().map(|row| row.energy).sum::<f64>();
            both.into_iter().max_by(|a, b| energy(a).total_cmp(&energy(b))).unwrap_or_default()
        });
        let contrasts: Vec<Contrast> = contrasts.collect();
        let sum = |of: fn(&Contrast) -> f64| contrasts.iter().map(of).sum::<f64>();
        let follows = sum(|row| row.energy) < 4.0 * SURE * SURE * memory && sum(|row| row.difference) > 0.0;
        let says = |row: &Contrast| row.difference + if follows { row.energy } else { 0.0 };
        Some(by_sign(&pieces(&contrasts, shortest, says)))
    }

    /// Mean squared errors of a recording, joint by joint, not below the floor.
    fn levels(&self, errors: &[Vec<f64>]) -> Vec<f64> {
        let level = |(errors, floor): (&Vec<f64>, &f64)| {
            (dot(errors, errors) / errors.len().max(1) as f64).max(*floor).max(f64::MIN_POSITIVE)
        };
        errors.iter().zip(self.floor).map(level).collect()
    }
}

/// The rows of a recording under two models.
fn contrasts(errors: &Errors, levels: &[f64]) -> Vec<Contrast> {
    let rows = errors[0].first().map_or(0, Vec::len);
    (0..rows).map(|row| Contrast::new(errors, row, levels)).collect()
}

/// Errors of a recording, with a group and without, `[joint][row]`.
type Errors = [Vec<Vec<f64>>; 2];

/// One row under two models, summed over joints in units of what the model leaves.
#[derive(Debug, Clone, Copy)]
struct Contrast {
    /// By how much the squared error is larger without the group, 2bδ − δ².
    difference: f64,
    /// The square of the difference of predictions, δ².
    energy: f64,
}

impl Contrast {
    fn new([with, without]: &Errors, row: usize, levels: &[f64]) -> Self {
        let mut sums = Self { difference: 0.0, energy: 0.0 };
        for (j, level) in levels.iter().enumerate() {
            let (a, b) = (with[j][row], without[j][row]);
            sums.difference += (b * b - a * a) / level;
            sums.energy += (b - a).powi(2) / level;
        }
        sums
    }
}

/// Evidence for the group of pieces of at least some rows, with equal sums of their shares of the rows and of the energy.
fn pieces(rows: &[Contrast], shortest: usize, says: impl Fn(&Contrast) -> f64) -> Vec<f64> {
    let total: f64 = rows.iter().map(|r| r.energy).sum();
    let share = |row: &Contrast| row.energy / total.max(f64::MIN_POSITIVE) + 1.0 / rows.len() as f64;
    let all: f64 = rows.iter().map(share).sum();
    let (mut pieces, mut begin, mut sum) = (Vec::new(), 0, 0.0);
    for (k, row) in rows.iter().enumerate() {
        sum += share(row);
        let cuts = sum * PIECES as f64 >= all * (pieces.len() + 1) as f64;
        if cuts && k + 1 - begin >= shortest && rows.len() - k > shortest || k + 1 == rows.len() {
            pieces.push(rows[begin..=k].iter().map(&says).sum());
            begin = k + 1;
        }
    }
    pieces
}

/// Deviations of a difference from none at which a test at 5 % finds it in 95 of 100 cases.
const SURE: f64 = 2.0 * 1.645;

/// Held-out rows are contrasts in at most so many pieces: 2¹⁰ ways to give them signs.
const PIECES: usize = 10;
/// With fewer no probability is below one in fifty.
const FEWEST_PIECES: usize = 6;

/// Share of all ways to give differences signs whose sum is at least that of the differences (Fisher's randomisation
/// test of pairs).
fn by_sign(differences: &[f64]) -> f64 {
    let observed: f64 = differences.iter().sum();
    let ways = 1_u32 << differences.len().min(16);
    let slack = 1e-12 * differences.iter().map(|d| d.abs()).sum::<f64>();
    let as_large = (0..ways)
        .filter(|way| {
            let signed = differences.iter().enumerate().map(|(k, d)| if way >> k & 1 == 1 { -d } else { *d });
            signed.sum::<f64>() >= observed - slack
        })
        .count();
    as_large as f64 / f64::from(ways)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_one_sign_are_no_chance() {
        assert_eq!(by_sign(&[1.0, 2.0, 0.5, 1.0, 3.0, 0.1]), 1.0 / 64.0);
        assert!(by_sign(&[1.0, -1.2, 0.5, -0.4, 0.1, -0.3]) > 0.3);
    }

    /// All energy in one tenth of the rows: half of the pieces are there, unless they became too short.
    #[test]
    fn pieces_are_where_the_energy_is() {
        let row = |k: usize| Contrast { difference: 1.0, energy: f64::from(u8::from(k < 100)) };
        let pieces = |rows: &[Contrast], shortest| pieces(rows, shortest, |row| row.difference);
        let rows: Vec<Contrast> = (0..1000).map(row).collect();
        let lengths = pieces(&rows, 4);
        assert_eq!(lengths.len(), PIECES);
        assert_eq!(lengths.iter().sum::<f64>(), 1000.0);
        assert!(lengths[..5].iter().all(|l| (18.0..=19.0).contains(l)), "{lengths:?}");
        assert!(lengths[6..].iter().all(|l| (190.0..=210.0).contains(l)), "{lengths:?}");
        let lengths = pieces(&rows, 40);
        assert!(lengths.iter().all(|l| *l >= 40.0) && lengths.len() <= PIECES, "{lengths:?}");
        let still = [Contrast { difference: 1.0, energy: 0.0 }; 50];
        let even = pieces(&still, 1);
        assert!(even.len() == PIECES && even.iter().all(|l| (4.0..=6.0).contains(l)), "{even:?}");
    }
}
