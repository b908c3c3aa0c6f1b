//! Errors on held-out rows, and whether these are another state of the robot.

use aurt_traits::ColumnGroup;

use crate::evidence::account::has_structure;
use crate::evidence::between::BETWEEN_RECORDINGS;
use crate::evidence::residuals::residuals;
use crate::evidence::total::TotalFit;
use crate::hypotheses::group::Switch;
use crate::investigation::{Fitted, Investigation};
use crate::recordings::rows::{RecordingRows, Role};
use crate::verdict::{HeldOut, HeldOutDifference, JointResidual};

/// Improvement on the held-out rows. Before: the baseline as fitted to the calibration recordings (or given).
pub(super) fn errors(investigation: &Investigation, all: &[Switch], fit: &TotalFit) -> HeldOut {
    let joints = investigation.layout.rows.len();
    let own = &investigation.base_switches;
    let (mut before, mut after, mut floor) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
    for (r, rows) in judging(investigation) {
        let base = residuals(rows, &investigation.layout, own, &investigation.baseline.coefficients);
        let full = residuals(rows, &investigation.layout, all, &fit.coefficients);
        for j in 0..joints {
            before[j] += squares(&base[j]);
            after[j] += squares(&full[j]);
            floor[j] += investigation.floors[r][j] * rows.joints[j].counted(0, rows.rows());
        }
    }
    let counts = counts(investigation);
    let rms = |sums: Vec<f64>| sums.into_iter().zip(&counts).map(|(s, n)| (s / n).sqrt()).collect();
    HeldOut {
        recordings: investigation.partition.held_out_names.clone(),
        rms_before: rms(before),
        rms_after: rms(after),
        rms_floor: rms(floor),
    }
}

/// The joints, but for those of `apart`, whose held-out error is beyond the expected one,
///
/// e² = max(noise², (torque ratio · residual of the fitted rows)²) + (B − 1)/B Σ_b mean (X_h (β_b − β̄))² + (0.06 · friction)²
///
/// with X_h the held-out rows and β_b the fit without block b of B. A wrong structure errs in proportion to the torque, and friction
/// is not the same in two recordings ([`BETWEEN_RECORDINGS`]). A model whose error is larger than the measurement itself predicts
/// nothing, whatever its uncertainty.
pub(super) fn differences(
    (investigation, fitted): (&Investigation, &Fitted),
    uncertain: &[f64],
    residual: &[JointResidual],
    held_out: &HeldOut,
    apart: &[usize],
) -> Vec<HeldOutDifference> {
    let (measured, friction) = (measured(investigation), friction(investigation, fitted));
    let power = |joint: usize| {
        let kinds = investigation.problem.total().each_ref().map(|kind| &kind[joint]);
        let rows: f64 = kinds.iter().map(|m| m.rows).sum();
        kinds.iter().map(|m| m.square).sum::<f64>() / rows.max(1.0)
    };
    let difference =
        |joint: &JointResidual| {
            let j = joint.joint;
            let rms = held_out.rms_after[j];
            // What a given model leaves is no measure of the torque.
            let louder = if investigation.baseline.frozen || power(j) <= 0.0 {
                1.0
            } else {
                (measured[j] / power(j)).max(1.0)
            };
            let expected = held_out.rms_floor[j].powi(2).max(louder * joint.unexplained_rms.powi(2))
                + uncertain[j]
                + BETWEEN_RECORDINGS.powi(2) * friction[j];
            let is_judged = rms.is_finite() && power(j) > 0.0 && !apart.contains(&j);
            let predicts_nothing = !investigation.baseline.frozen
                && rms * rms > measured[j]
                && has_structure(rms * rms, held_out.rms_floor[j].powi(2));
            (is_judged && (has_structure(rms * rms, expected) || predicts_nothing))
                .then(|| HeldOutDifference { joint: j, rms, expected_rms: expected.sqrt() })
        };
    residual.iter().filter_map(difference).collect()
}

/// The joints, but for those of `apart`, whose held-out error is more than noise and what else is expected leave: that of
/// the fitted rows may be taken for noise that is louder than their floor, and noise is as loud in the others.
pub(super) fn beyond_noise(
    expected: &[f64],
    residual: &[JointResidual],
    held_out: &HeldOut,
    apart: &[usize],
) -> Vec<usize> {
    let is_beyond = |joint: &JointResidual| {
        let (rms, floor) = (held_out.rms_after[joint.joint], held_out.rms_floor[joint.joint]);
        let louder = (joint.unexplained_rms / joint.floor_rms.max(f64::MIN_POSITIVE)).max(1.0);
        rms.is_finite() && has_structure(rms * rms, (louder * floor).powi(2) + expected[joint.joint])
    };
    residual.iter().filter(|r| !apart.contains(&r.joint) && is_beyond(r)).map(|r| r.joint).collect()
}

/// Mean square of what an unchanged robot's friction adds to the held-out rows, joint by joint: where these are recordings of their own,
/// it differs from that of the others.
pub(super) fn usual_friction(investigation: &Investigation, fitted: &Fitted) -> Vec<f64> {
    let is_other = judging(investigation).any(|(_, rows)| rows.role == Role::Validation);
    let share = if is_other { BETWEEN_RECORDINGS.powi(2) } else { 0.0 };
    friction(investigation, fitted).into_iter().map(|square| share * square).collect()
}

/// The held-out recordings that have rows, with their numbers.
fn judging(investigation: &Investigation) -> impl Iterator<Item = (usize, &RecordingRows)> {
    investigation.confirm.to_judge().iter().enumerate().filter(|(_, r)| r.rows() > 0)
}

fn squares(series: &[f64]) -> f64 {
    series.iter().map(|v| v * v).sum()
}

/// Held-out rows that count, joint by joint; one where there are none.
fn counts(investigation: &Investigation) -> Vec<f64> {
    let of_joint = |j: usize| {
        judging(investigation).map(|(_, rows)| rows.joints[j].counted(0, rows.rows())).sum::<f64>().max(1.0)
    };
    (0..investigation.layout.rows.len()).map(of_joint).collect()
}

/// Mean square of the measurement over the held-out rows, joint by joint; of what a given model leaves of it, where one is given.
fn measured(investigation: &Investigation) -> Vec<f64> {
    let of_joint = |(j, count): (usize, &f64)| {
        let series = judging(investigation).map(|(_, rows)| {
            let joint = &rows.joints[j];
            let counted = joint.measurement.iter().zip(&joint.counts).filter(|(_, counts)| **counts);
            counted.map(|(value, _)| value * value).sum::<f64>()
        });
        series.sum::<f64>() / count
    };
    counts(investigation).iter().enumerate().map(of_joint).collect()
}

/// Mean square of the prediction's uncertainty over the held-out rows, joint by joint, Nm².
pub(super) fn uncertainty(investigation: &Investigation, fitted: &Fitted) -> Vec<f64> {
    let refits = fitted.resampled.deviating(&fitted.fit.coefficients);
    let mut sums = vec![0.0; investigation.layout.rows.len()];
    for (deviating, share) in &refits {
        let difference = difference(investigation, fitted, deviating);
        sums.iter_mut().zip(difference).for_each(|(sum, of_one)| *sum += share * of_one);
    }
    sums
}

/// Mean square of the difference that other coefficients make over the held-out rows, joint by joint.
fn difference(investigation: &Investigation, fitted: &Fitted, others: &[f64]) -> Vec<f64> {
    let left = |rows, beta| residuals(rows, &investigation.layout, &fitted.switches, beta);
    let mut sums = vec![0.0; investigation.layout.rows.len()];
    for (_, rows) in judging(investigation) {
        let both = left(rows, &fitted.fit.coefficients).into_iter().zip(left(rows, others));
        for (sum, (whole, other)) in sums.iter_mut().zip(both) {
            *sum += whole.iter().zip(&other).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        }
    }
    sums.iter().zip(counts(investigation)).map(|(sum, count)| sum / count).collect()
}

/// Mean square of friction over the held-out rows, joint by joint, Nm²: of the joints' own laws, unless the model is given, and of
/// those that were found.
fn friction(investigation: &Investigation, fitted: &Fitted) -> Vec<f64> {
    let Investigation { layout, model, groups, selection, base_switches, .. } = investigation;
    let found = selection.chosen.iter().map(|c| &groups[c.group]).filter(|g| g.effect.is_friction);
    let found: Vec<Switch> = found.flat_map(|g| g.switches.iter().copied()).collect();
    let own = |switch: &Switch| {
        let is_of_joints = |column| {
            (0..layout.rows.len()).any(|j| model.group(ColumnGroup::JointDynamics(j)).contains(&column))
        };
        base_switches.iter().any(|s| s.column == switch.column) && is_of_joints(switch.column)
    };
    let is_friction =
        |s: &Switch| own(s) || found.iter().any(|f| f.column == s.column && f.target_only == s.target_only);
    let coefficients = fitted.switches.iter().zip(&fitted.fit.coefficients);
    let others: Vec<f64> = coefficients.map(|(s, value)| if is_friction(s) { 0.0 } else { *value }).collect();
    difference(investigation, fitted, &others)
}

#[cfg(test)]
mod tests {
    use super::beyond_noise;
    use crate::verdict::{HeldOut, JointResidual};

    #[test]
    fn noise_is_as_loud_in_held_out_rows_as_in_fitted_ones() {
        let joint = |joint, unexplained_rms, floor_rms| JointResidual {
            joint,
            baseline_rms: unexplained_rms,
            unexplained_rms,
            floor_rms,
            structure_left: false,
            follows: None,
            follows_share: 0.0,
            windows_s: Vec::new(),
        };
        // A disturbance in all fitted rows, noise that is louder than its floor everywhere, and rows that nothing was measured in.
        let residual = [joint(0, 6.9, 4.7), joint(1, 1.5, 1.0), joint(2, 1.0, 1.0)];
        let held_out = HeldOut {
            recordings: Vec::new(),
            rms_before: vec![5.4, 2.3, f64::NAN],
            rms_after: vec![5.4, 2.3, f64::NAN],
            rms_floor: vec![0.9, 1.0, 1.0],
        };
        let beyond =
            |uncertain: &[f64], apart: &[usize]| beyond_noise(uncertain, &residual, &held_out, apart);
        assert_eq!(beyond(&[0.0; 3], &[]), [0]);
        assert!(beyond(&[0.0; 3], &[0]).is_empty());
        assert!(beyond(&[20.0, 0.0, 0.0], &[]).is_empty(), "uncertain coefficients explain it");
    }
}
