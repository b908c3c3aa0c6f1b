//! The rows of a trial.

use crate::evidence::gram::dot;
use crate::evidence::judged::bound_floors;
use crate::evidence::problem::Problem;
use crate::hypotheses::group::Switch;
use crate::injection::prepared::{AddedRows, Prepared, own_coefficients};
use crate::recordings::divided::{ConfirmRows, FitRows};
use crate::recordings::rows::Instrument;

/// Rows with an effect in the measurement, their moments, and the model in question fitted to them.
pub(super) struct Anew {
    pub(super) rows: FitRows,
    pub(super) confirm: ConfirmRows,
    pub(super) problem: Problem,
    pub(super) coefficients: Vec<f64>,
    pub(super) floors: Vec<Vec<f64>>,
    /// Joints whose measurement has changed.
    pub(super) joints: Vec<usize>,
}

/// Of the largest power on a joint, less than this share on another one is rounding of the filters.
const CHANGED: f64 = 1e-12;

impl Prepared<'_> {
    /// Rows with an effect, in a measurement whose unexplained part is turned by a share of each recording's length: a draw
    /// of noise with the memory and the size that it has.
    pub(super) fn anew(&self, added: &AddedRows, turn: f64) -> Anew {
        let reference = &self.reference;
        let (mut rows, mut confirm) = (reference.rows.clone(), reference.confirm.clone());
        for r in 0..rows.len() {
            let end_of_fit = rows[r].rows();
            for (j, effect) in added[r].iter().enumerate() {
                let own = &mut rows[r].joints[j];
                let (fit, rest) = effect.split_at(end_of_fit.min(effect.len()));
                let left = &self.left[0][r][j];
                let drawn = turned(left, &own.counts, turn);
                for (k, y) in own.measurement.iter_mut().enumerate().filter(|(k, _)| own.counts[*k]) {
                    *y += fit[k] + drawn[k] - left[k];
                }
                let judging = &confirm.to_judge()[r].joints[j];
                let left = &self.left[1][r][j];
                let drawn = turned(left, &judging.counts, turn);
                let measured: Vec<f64> = (0..judging.measurement.len())
                    .map(|k| judging.measurement[k] + rest[k] + drawn[k] - left[k])
                    .collect();
                confirm.set_measurement(r, j, &measured);
            }
        }
        let joints = changed(added);
        let measured: Vec<usize> =
            if turn == 0.0 { joints.clone() } else { (0..rows[0].joints.len()).collect() };
        let problem = reference.problem.measured_anew(&rows, &reference.partition, &measured);
        let mut anew = Anew {
            coefficients: reference.baseline.coefficients.clone(),
            floors: self.floors.clone(),
            rows,
            confirm,
            problem,
            joints,
        };
        self.refit(&mut anew);
        anew
    }

    /// Fits the model in question, takes its predictions anew, and bounds the noise by what it leaves.
    fn refit(&self, anew: &mut Anew) {
        let reference = &self.reference;
        let own: Vec<Switch> = crate::evidence::baseline::own_switches(self.question.model);
        if reference.baseline.frozen {
            let _ = bound_floors(
                &anew.rows,
                &reference.layout,
                &[],
                &[],
                &mut anew.floors,
                self.question.names(),
            );
            return;
        }
        let fitted = own_coefficients(self.question, reference, &anew.problem);
        let change: Vec<f64> = fitted.iter().zip(&self.own).map(|(now, then)| now - then).collect();
        for (coefficient, change) in anew.coefficients.iter_mut().zip(&change) {
            *coefficient += change;
        }
        for j in 0..reference.layout.rows.len() {
            self.predict_anew(anew, j, &change);
        }
        let _ = bound_floors(
            &anew.rows,
            &reference.layout,
            &own,
            &anew.coefficients,
            &mut anew.floors,
            self.question.names(),
        );
    }

    /// Changes the column of a joint's gain, which is the prediction of the model in question.
    fn predict_anew(&self, anew: &mut Anew, j: usize, change: &[f64]) {
        let layout = &self.reference.layout;
        let gain = layout.instrument(j, Instrument::Gain);
        let Some(place) = layout.rows[j].iter().position(|c| *c == gain) else { return };
        let moved: Vec<(usize, f64)> = layout.rows[j]
            .iter()
            .enumerate()
            .filter_map(|(k, column)| Some((k, *change.get(*column)?)))
            .filter(|(_, by)| *by != 0.0)
            .collect();
        if moved.is_empty() {
            return;
        }
        for r in 0..anew.rows.len() {
            for confirming in [false, true] {
                let rows = if confirming { &anew.confirm.to_judge()[r] } else { &anew.rows[r] };
                let joint = &rows.joints[j];
                let length = joint.measurement.len();
                let mut column = joint.column(place).to_vec();
                for (k, by) in &moved {
                    column.iter_mut().zip(joint.column(*k)).for_each(|(o, value)| *o += by * value);
                }
                if confirming {
                    anew.confirm.set_column(r, j, place, &column);
                } else {
                    anew.rows[r].joints[j].data[place * length..(place + 1) * length]
                        .copy_from_slice(&column);
                }
            }
        }
        anew.problem.renew(&anew.rows, &self.reference.partition, j, &[place]);
    }
}

/// Joints on which something is added.
fn changed(added: &AddedRows) -> Vec<usize> {
    let joints = added.first().map_or(0, Vec::len);
    let power: Vec<f64> = (0..joints).map(|j| added.iter().map(|r| dot(&r[j], &r[j])).sum()).collect();
    let largest = power.iter().copied().fold(0.0, f64::max);
    (0..joints).filter(|j| power[*j] > CHANGED * largest).collect()
}

/// A series turned in a circle by a share of its length, of the same power over the rows that count.
pub(super) fn turned(series: &[f64], counts: &[bool], share: f64) -> Vec<f64> {
    let n = series.len();
    let by = (share * n as f64).round() as usize;
    if n == 0 || by.is_multiple_of(n) {
        return series.to_vec();
    }
    let mut turned: Vec<f64> = (0..n).map(|k| if counts[k] { series[(k + by) % n] } else { 0.0 }).collect();
    let factor = (dot(series, series) / dot(&turned, &turned)).sqrt();
    if factor.is_finite() {
        turned.iter_mut().for_each(|v| *v *= factor);
    }
    turned
}
