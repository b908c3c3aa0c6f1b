//! A point's result, from the rows that its family shares.

use crate::Experiment;
use aurt_calibration::{FitRows, JudgedRow, TermScopes, calibrate_shapes_rows};
use aurt_traits::RobotModel;
use rayon::prelude::*;

use crate::sweep::family::{SharedRows, point_model};
use crate::sweep::loading::Settings;
use crate::sweep::result::{Evaluation, Fold, JointErrors, Judged};
use crate::sweep::{Point, PointError};

/// Fits a point's model and judges it.
pub(crate) fn evaluate(point: &Point, rows: &SharedRows<'_>, block_s: f64) -> Result<Evaluation, PointError> {
    let Experiment { arm_term_recordings, preprocess, .. } = &point.experiment;
    let model = point_model(&point.experiment, rows.bodies)?;
    let work = Work {
        model: &model,
        scopes: TermScopes::new(arm_term_recordings.clone()),
        settings: Settings::of(&point.experiment),
        f_dyn_hz: preprocess.f_dyn_hz,
        block_s,
        rows,
    };
    let folds = rows
        .folds
        .par_iter()
        .map(|(fitted, judged)| work.fold(fitted, judged))
        .collect::<Result<Vec<Fold>, PointError>>()?;
    let shapes = folds.first().and_then(|f| f.shape_fit.as_ref()).map_or(0, |r| r.shapes.len());
    Ok(Evaluation { unit: rows.unit, coefficients: model.parameters().len(), shapes, folds })
}

struct Work<'a> {
    model: &'a RobotModel,
    scopes: TermScopes,
    settings: Settings,
    f_dyn_hz: f64,
    block_s: f64,
    rows: &'a SharedRows<'a>,
}

impl Work<'_> {
    fn fold(&self, fitted: &FitRows<'_>, held_out: &[usize]) -> Result<Fold, PointError> {
        let Settings { calibration: options, shapes, rows } = &self.settings;
        let (model, mut calibration) = calibrate_shapes_rows(
            self.model,
            fitted,
            &self.scopes,
            self.rows.unit,
            self.f_dyn_hz,
            options,
            shapes,
        )?;
        calibration.warnings.extend(self.rows.warnings.iter().cloned());
        let joints = model.joints();
        let mut judged = Vec::new();
        for recording in held_out {
            let mut all = vec![JointErrors::default(); joints];
            let mut moving = vec![JointErrors::default(); joints];
            let mut blocks = Blocks::new(self.block_s);
            self.rows.judged.judge(&model, &calibration, &self.scopes, *recording, *rows, |row| {
                let block = blocks.of(&row);
                all[row.joint].add(block, row.measured, row.predicted);
                if row.moving {
                    moving[row.joint].add(block, row.measured, row.predicted);
                }
            })?;
            all.iter_mut().chain(&mut moving).for_each(|e| e.extend_to(blocks.next));
            if all.iter().all(|e| e.rows == 0) {
                return Err(PointError::NothingJudged);
            }
            if all.iter().any(|e| !e.squared_error.is_finite()) {
                return Err(aurt_calibration::CalibrationError::NotFinite.into());
            }
            let recording = self.rows.judged.recordings()[*recording].name.clone();
            judged.push(Judged { recording, all, moving });
        }
        Ok(Fold {
            calibrated_on: calibration.recordings,
            parameters: calibration.parameters,
            shape_fit: calibration.shape_fit,
            condition_number: Some(calibration.condition_number).filter(|c| c.is_finite()),
            warnings: calibration.warnings,
            judged,
        })
    }
}

/// Blocks of equal time within each segment, counted through a recording.
struct Blocks {
    length_s: f64,
    segment: usize,
    start_s: f64,
    first: usize,
    next: usize,
    joint: usize,
}

impl Blocks {
    const fn new(length_s: f64) -> Self {
        Self { length_s, segment: usize::MAX, start_s: 0.0, first: 0, next: 0, joint: 0 }
    }

    /// The block of a row; rows come segment after segment, joint after joint, in order of time.
    fn of(&mut self, row: &JudgedRow) -> usize {
        if row.segment != self.segment {
            *self = Self { segment: row.segment, start_s: row.time_s, first: self.next, ..*self };
        } else if row.joint != self.joint {
            self.start_s = self.start_s.min(row.time_s);
        }
        self.joint = row.joint;
        let block = self.first + ((row.time_s - self.start_s) / self.length_s).max(0.0) as usize;
        self.next = self.next.max(block + 1);
        block
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_counted_through_segments_and_alike_for_all_joints() {
        let row = |segment, joint, time_s| JudgedRow {
            segment,
            time_s,
            joint,
            moving: true,
            measured: 0.0,
            predicted: 0.0,
        };
        let mut blocks = Blocks::new(1.0);
        let mut seen = Vec::new();
        for (segment, times) in [(0, [5.0, 5.9, 7.5]), (1, [20.0, 20.5, 21.5])] {
            for joint in 0..2 {
                seen.extend(times.map(|t| blocks.of(&row(segment, joint, t))));
            }
        }
        assert_eq!(seen, [0, 0, 2, 0, 0, 2, 3, 3, 4, 3, 3, 4]);
    }
}
