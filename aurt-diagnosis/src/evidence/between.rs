//! By how much calibration recordings differ among themselves in what a change is made of.
//!
//! Friction is another every day and drifts within a recording, so that a machine that nobody has touched differs from one recording to the
//! next by more than noise explains. Let C be a hypothesis' columns on one calibration recording alone, X the model that is fitted to all
//! of them, and e what that leaves. The statistic sᵀ I⁻¹ s with s = CᵀW e and I = CᵀWC − CᵀWX (XᵀWX)⁻¹ XᵀWC is χ² of as many degrees of
//! freedom as there are columns, times the memory of e, where no recording differs from the others.

use aurt_traits::{ColumnGroup, JointStack, RobotModel};
use nalgebra::DMatrix;

use crate::evidence::deviations::memory;
use crate::evidence::gram::dot;
use crate::evidence::linear::Cholesky;
use crate::evidence::refit::series;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::rows::{Layout, RecordingRows, Role};

/// Share by which friction differs between recordings of a robot that nobody has touched (standard deviation): that of five of a
/// UR10e at 1 rad/s, root mean square over its joints (`examples/ur10e-friction-levels.py`).
pub(crate) const BETWEEN_RECORDINGS: f64 = 0.06;

/// The share by which dry friction differs, over that by which the rest does: of the same recordings, that at 0.3 rad/s over that at 1 rad/s.
pub(crate) const DRY: f64 = 0.022 / BETWEEN_RECORDINGS;

/// Calibration recordings beside the model that is fitted to them.
pub(crate) struct Between<'a> {
    recordings: Vec<&'a RecordingRows>,
    layout: &'a Layout,
    columns: Vec<usize>,
    weights: &'a [f64],
    memory: f64,
    gram: Cholesky,
    /// Residuals of the model, `[recording][joint]`.
    left: Vec<Vec<Vec<f64>>>,
}

impl<'a> Between<'a> {
    /// Fits the coefficients of all recordings among some to the calibration recordings; `None` with less than two of these.
    pub(crate) fn new(
        rows: &'a [RecordingRows],
        layout: &'a Layout,
        switches: &[Switch],
        weights: &'a [f64],
        independent_share: f64,
    ) -> Option<Self> {
        let recordings: Vec<_> =
            rows.iter().filter(|r| r.role == Role::Calibration && r.rows() > 0).collect();
        if recordings.len() < 2 {
            return None;
        }
        let columns: Vec<usize> = switches.iter().filter(|s| !s.target_only).map(|s| s.column).collect();
        let n = columns.len();
        let (mut gram, mut right) = (vec![0.0; n * n], vec![0.0; n]);
        for recording in &recordings {
            for ((series, joint), w) in
                series(recording, layout, &columns).iter().zip(&recording.joints).zip(weights)
            {
                for (a, x) in series {
                    right[*a] += w * dot(x, &joint.measurement);
                    series.iter().for_each(|(b, y)| gram[b * n + a] += w * dot(x, y));
                }
            }
        }
        let gram = Cholesky::new(&gram, n);
        let coefficients = gram.solve(&right);
        let value =
            |column: &usize| columns.iter().position(|c| c == column).map_or(0.0, |k| coefficients[k]);
        let left = recordings.iter().map(|recording| {
            let of_joint =
                |(j, row): (usize, &Vec<usize>)| recording.joints[j].residual(row.iter().map(value));
            layout.rows.iter().enumerate().map(of_joint).collect()
        });
        let left = left.collect();
        Some(Self { recordings, layout, columns, weights, memory: memory(independent_share), gram, left })
    }

    /// The factor by which the deviations of a change exceed those that the noise of rows gives it: the mean square of what is no change,
    /// half of it from the hypothesis itself and half from the same effect on other joints, as far as either tells; degrees of freedom by
    /// Satterthwaite (*Biometrics Bulletin* 2, 1946).
    pub(crate) fn inflation(&self, group: &Group, groups: &[Group]) -> Option<Inflation> {
        let is_alike = |g: &&Group| g.effect == group.effect && g.target_only() && g.joints != group.joints;
        let alike = groups.iter().filter(is_alike).filter_map(|g| self.statistic(g));
        let [others, freedom] =
            alike.fold([0.0; 2], |[sum, all], s| [sum + s.mean_square * s.freedom, all + s.freedom]);
        let own = self.statistic(group).map(|s| [s.mean_square, s.freedom]);
        let parts = [own, (freedom > 0.0).then(|| [others / freedom, freedom])];
        let shares: Vec<[f64; 2]> = parts.into_iter().flatten().collect();
        let share = (shares.len() as f64).recip();
        let square: f64 = shares.iter().map(|[square, _]| share * square).sum();
        let spread: f64 = shares.iter().map(|[square, freedom]| (share * square).powi(2) / freedom).sum();
        (square > 0.0).then(|| Inflation { factor: square.sqrt(), freedom: square * square / spread })
    }

    /// The share by which friction differs between the recordings, from changes of its level, with what each coefficient differs by where
    /// the share is one; `None` where noise hides it.
    ///
    /// If the coefficients of a joint differ by variances s² f_k², its statistic has the mean 1 + s² U with U = Σ_k f_k² I_kk, where
    /// I is the information of a recording whose mean with the others is not taken off. All joints tell of one s, each by its degrees of
    /// freedom times (s² U/(1 + s² U))², which is taken at the usual share.
    pub(crate) fn friction_share<'g>(
        &self,
        levels: impl Iterator<Item = (&'g Group, Vec<f64>)>,
    ) -> Option<Share> {
        let [mut sum, mut freedom] = [0.0; 2];
        for (group, friction) in levels {
            let Some(of) = self.statistic(group) else { continue };
            let told: f64 = of.information.iter().zip(&friction).map(|(i, f)| i * f * f).sum();
            if told > 0.0 {
                let usual = BETWEEN_RECORDINGS.powi(2) * told;
                let by_friction = usual / (1.0 + usual);
                let weight = of.freedom * by_friction * by_friction;
                sum += weight * (of.mean_square - 1.0) / told;
                freedom += weight;
            }
        }
        let recordings = self.recordings.len() as f64;
        (freedom >= 1.0).then(|| Share { std: (sum / freedom).max(0.0).sqrt(), freedom, recordings })
    }

    /// The statistic of a group; `None` where the model takes up all.
    fn statistic(&self, group: &Group) -> Option<Statistic> {
        let columns: Vec<usize> = group.switches.iter().map(|s| s.column).collect();
        let (d, n) = (columns.len(), self.columns.len());
        // s of each recording, CᵀWC, and what the model takes of C: L⁻¹XᵀWC.
        let mut parts = Vec::new();
        for (recording, left) in self.recordings.iter().zip(&self.left) {
            let (mut score, mut own, mut cross) =
                (vec![0.0; d], DMatrix::zeros(d, d), DMatrix::<f64>::zeros(n, d));
            let of_group = series(recording, self.layout, &columns);
            let of_model = series(recording, self.layout, &self.columns);
            for (((of_group, of_model), left), w) in
                of_group.iter().zip(&of_model).zip(left).zip(self.weights)
            {
                for (a, x) in of_group {
                    score[*a] += w * dot(x, left);
                    of_group.iter().for_each(|(b, y)| own[(*b, *a)] += w * dot(x, y));
                    of_model.iter().for_each(|(k, y)| cross[(*k, *a)] += w * dot(x, y));
                }
            }
            cross.column_iter_mut().for_each(|mut column| self.gram.forward(column.as_mut_slice()));
            parts.push((score, own, cross));
        }
        // What all have alike is no difference, be it in the model or not.
        let taken: DMatrix<f64> = parts.iter().map(|(.., cross)| cross).sum();
        let alike: Vec<DMatrix<f64>> =
            parts.iter().map(|(_, own, cross)| own - taken.tr_mul(cross)).collect();
        let in_all = Cholesky::new(alike.iter().sum::<DMatrix<f64>>().as_slice(), d);
        let sums: Vec<f64> = (0..d).map(|a| parts.iter().map(|(score, ..)| score[a]).sum()).collect();
        let common = in_all.solve(&sums);
        let (mut sum, mut count) = (0.0, 0.0);
        let mut diagonal = vec![0.0; d];
        for ((score, own, cross), alike) in parts.iter().zip(&alike) {
            let columns = || alike.as_slice().chunks_exact(d.max(1));
            let score: Vec<f64> = score.iter().zip(columns()).map(|(s, of)| s - dot(of, &common)).collect();
            let solved: Vec<f64> = columns().flat_map(|column| in_all.solve(column)).collect();
            let free = own - cross.tr_mul(cross) - alike.tr_mul(&DMatrix::from_vec(d, d, solved));
            diagonal.iter_mut().enumerate().for_each(|(k, sum)| *sum += free[(k, k)].max(0.0));
            let information = Cholesky::new(free.as_slice(), d);
            sum += dot(&score, &information.solve(&score));
            count += information.used().iter().filter(|used| **used).count() as f64;
        }
        // What all have alike takes what one of them would tell.
        let freedom = count * (1.0 - (self.recordings.len() as f64).recip());
        let per = count * self.memory;
        let apart = freedom / count;
        let information = diagonal.iter().map(|sum| sum / per / apart).collect();
        (count > 0.0).then(|| Statistic { mean_square: sum / per, freedom, information })
    }
}

/// By how much recordings differ in a group.
struct Statistic {
    /// Mean over recordings and coefficients, over its expectation from noise.
    mean_square: f64,
    freedom: f64,
    /// Information of each coefficient, which adds it to the mean square where its size is one.
    information: Vec<f64>,
}

/// The share by which friction differs from one recording to the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    pub(crate) std: f64,
    /// Degrees of freedom of its square.
    pub(crate) freedom: f64,
    /// Recordings that friction at calibration is the mean of.
    pub(crate) recordings: f64,
}

impl Share {
    /// The share of a robot of which one calibration recording does not tell; F of so many degrees of freedom is χ² to 10⁻⁶ of itself.
    pub(crate) const USUAL: Self = Self { std: BETWEEN_RECORDINGS, freedom: 1e6, recordings: 1.0 };

    /// Changes of a model's friction, joint by joint, and the deviations of their coefficients on an unchanged robot.
    pub(crate) fn changes(&self, model: &RobotModel, own: &[f64]) -> Vec<Vec<(Switch, f64)>> {
        let std = (1.0 + self.recordings.recip()).sqrt() * self.std;
        let of_stack = |(j, stack): (usize, &JointStack)| {
            let dry = stack.coulomb().columns().len() * stack.hysteresis().columns().len();
            let columns = model.group(ColumnGroup::JointDynamics(j)).enumerate();
            let change = |(k, column): (usize, usize)| {
                let deviation = own[column].abs() * std * if k < dry { DRY } else { 1.0 };
                (Switch { column, target_only: true, nonnegative: false }, deviation)
            };
            columns.map(change).filter(|(_, deviation)| *deviation > 0.0).collect()
        };
        model.stacks().iter().enumerate().map(of_stack).collect()
    }
}

/// Squared error that coefficients of given deviations d take of a residual r: with their columns C and the variance v of r they are b = (CᵀC +
/// v D⁻²)⁻¹ Cᵀr, all as much smaller as none exceeds [`MOST`] deviations, and take 2bᵀCᵀr − bᵀCᵀCb.
pub(crate) fn taken(gram: &[f64], right: &[f64], variance: f64, deviations: &[f64]) -> f64 {
    let n = deviations.len();
    let mut penalised = gram.to_vec();
    for (k, deviation) in deviations.iter().enumerate() {
        penalised[k * (n + 1)] += variance / deviation.powi(2);
    }
    let b = Cholesky::new(&penalised, n).solve(right);
    let most = b.iter().zip(deviations).map(|(b, d)| (b / (MOST * d)).abs()).fold(1.0, f64::max);
    let b: Vec<f64> = b.iter().map(|b| b / most).collect();
    let squares = gram.chunks_exact(n.max(1)).zip(&b).map(|(column, b_k)| b_k * dot(column, &b));
    2.0 * dot(&b, right) - squares.sum::<f64>()
}

/// Deviations within which 95 of 100 numbers lie.
const MOST: f64 = 2.0;

/// The factor by which recordings of a machine that nobody has touched differ more than noise explains.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inflation {
    pub(crate) factor: f64,
    /// Degrees of freedom of its square.
    pub(crate) freedom: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::friction_level_changed::EFFECT;
    use crate::recordings::rows::JointRows;

    /// Recordings of a joint that turns to and fro against friction of some levels, with errors ±1.
    fn recordings(levels: &[f64]) -> Vec<RecordingRows> {
        let recording = |level: &f64| {
            let sign: Vec<f64> = (0..400).map(|k| if k / 50 % 2 == 0 { 1.0 } else { -1.0 }).collect();
            let measured = |(k, sign): (usize, &f64)| level * sign + if k % 2 == 0 { 1.0 } else { -1.0 };
            let measurement = sign.iter().enumerate().map(measured).collect();
            let joint = JointRows { data: sign, measurement, ..JointRows::default() };
            RecordingRows {
                name: "a motion".into(),
                role: Role::Calibration,
                rate_hz: 20.0,
                time_s: (0..400).map(|k| f64::from(k) * 0.05).collect(),
                segment_starts: vec![0, 400],
                joints: vec![joint],
            }
        };
        levels.iter().map(recording).collect()
    }

    const fn switch(target_only: bool) -> Switch {
        Switch { column: 0, target_only, nonnegative: false }
    }

    fn level() -> Group {
        Group {
            effect: &EFFECT,
            joints: vec![0],
            candidate: 0,
            switches: vec![switch(true)],
            accessory: Vec::new(),
            shapes: 0,
        }
    }

    /// Something of recordings of some levels, whose rows have a weight.
    fn of<T>(levels: &[f64], weight: f64, ask: impl Fn(&Between<'_>) -> Option<T>) -> Option<T> {
        let rows = recordings(levels);
        let layout = Layout { coefficients: 1, rows: vec![vec![0]], first_instrument: 1 };
        ask(&Between::new(&rows, &layout, &[switch(false), switch(true)], &[weight], 1.0)?)
    }

    /// Two levels that differ by d leave ± d/2, of which each of n rows tells half: χ² is n d²/2.
    #[test]
    fn recordings_that_differ_widen_the_deviations_of_changes() {
        let groups = [level()];
        let inflation = |levels: &[f64]| of(levels, 1.0, |b| Some(b.inflation(&groups[0], &groups)?.factor));
        assert!(inflation(&[5.0, 5.0]).is_none_or(|factor| factor < 1e-6));
        assert!((inflation(&[5.0, 6.0]).unwrap() - 200.0_f64.sqrt()).abs() < 1e-9);
        assert!(inflation(&[5.0]).is_none());
    }

    /// One column of a hundred ones and a residual of a level; a level that is far from usual leaves more than all that is usual.
    #[test]
    fn no_more_is_taken_than_is_usual() {
        let left = |level: f64| 100.0 * level * level - taken(&[100.0], &[100.0 * level], 1e-6, &[0.1]);
        assert!(left(0.15) < 1e-6 && (left(0.5) - 100.0 * 0.3_f64.powi(2)).abs() < 1e-6);
    }

    /// Levels of the mean 5 whose variance among recordings is known; a friction that noise hides tells nothing.
    #[test]
    fn the_share_of_friction_is_that_of_its_levels() {
        let group = level();
        let share = |levels: &[f64], weight: f64| {
            of(levels, weight, |b| b.friction_share([(&group, vec![5.0])].into_iter()))
        };
        for deviations in [[-0.5, 0.5, 0.0, 0.0], [-1.0, 1.0, -1.0, 1.0]] {
            let variance = deviations.iter().map(|d| d * d).sum::<f64>() / 3.0;
            let found = share(&deviations.map(|d| 5.0 + d), 1.0).unwrap();
            assert!((found.std / (variance.sqrt() / 5.0) - 1.0).abs() < 0.1, "{found:?} {variance}");
            assert_eq!(found.recordings, 4.0);
        }
        assert!(share(&[5.0, 5.1, 4.9], 1e-6).is_none());
    }
}
