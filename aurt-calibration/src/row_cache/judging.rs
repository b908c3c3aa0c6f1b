use aurt_traits::RobotModel;

use super::dynamics::{Source, add_sums};
use super::parts::{StackSums, add};
use super::rigid::RigidRows;
use super::series::{LoadSeries, filtered};
use crate::validation::validated;
use crate::{Calibration, CalibrationError, TermScopes, ValidatedRows};

/// A measured row beside its prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JudgedRow {
    /// Index of the segment within the recording.
    pub segment: usize,
    /// Its time stamp, s.
    pub time_s: f64,
    /// The joint.
    pub joint: usize,
    /// Whether the joint moves (|q̇_j| above the rest velocity).
    pub moving: bool,
    /// y, filtered and decimated.
    pub measured: f64,
    /// ŷ, filtered and decimated.
    pub predicted: f64,
}

impl RigidRows<'_> {
    /// Compares the predictions of a calibrated model with the measurement of a recording, row by row: segment after
    /// segment, joint after joint, in order of time.
    ///
    /// # Errors
    /// What models report; [`CalibrationError::Columns`] for a model of other rigid bodies.
    pub fn judge(
        &self,
        model: &RobotModel,
        calibration: &Calibration,
        scopes: &TermScopes,
        recording: usize,
        rows: ValidatedRows,
        mut visit: impl FnMut(JudgedRow),
    ) -> Result<(), CalibrationError> {
        self.fits(model)?;
        let named = &self.recordings()[recording];
        let coefficients = calibration.coefficients();
        let acting = scopes.acting(model, &named.name);
        let rest = calibration.options.rest_velocities(&**model.rigid_body());
        let sources = Source::all(model);
        for (s, segment) in named.data.segments.iter().enumerate() {
            let Some(measurement) = &segment.measurement else { continue };
            let (joints, samples) = (self.joints(), segment.motion.samples());
            let load = if sources.iter().any(Source::reads_load) {
                self.load_series(model, segment, &calibration.load)?
            } else {
                LoadSeries::zero(joints, samples)
            };
            let others: Vec<Source<'_>> = sources.iter().filter(|s| !s.separable()).copied().collect();
            let of = |column: usize| if acting[column] { coefficients[column] } else { 0.0 };
            let mut predictions = vec![vec![0.0; segment.rows()]; joints];
            let mut unfiltered = StackSums::new(joints, samples);
            for source in sources.iter().filter(|s| s.separable()) {
                let Source::Stack { joint, stack, first_column } = *source else { continue };
                let own = &coefficients[first_column..first_column + stack.columns().len()];
                let place = (recording, s, joint);
                self.add_stack(place, stack, &load, own, &mut predictions[joint], &mut unfiltered)?;
            }
            if unfiltered.any || !others.is_empty() {
                add_sums(&others, segment, &load, of, &mut unfiltered.sums)?;
                let sums = filtered(segment, &unfiltered.sums, joints)?;
                predictions.iter_mut().zip(&sums).for_each(|(predicted, sum)| add(predicted, 1.0, sum));
            }
            let motion = segment.motion.view();
            for (joint, mut predicted) in predictions.into_iter().enumerate() {
                for (k, column) in self.columns(joint).iter().enumerate() {
                    add(&mut predicted, coefficients[*column], self.column(recording, s, joint, k));
                }
                for row in validated(segment, rows, &rest) {
                    let sample = segment.sample(row);
                    visit(JudgedRow {
                        segment: s,
                        time_s: motion.time_s()[sample],
                        joint,
                        moving: motion.velocity_rad_s(joint)[sample].abs() > rest[joint],
                        measured: measurement[joint][row],
                        predicted: predicted[row],
                    });
                }
            }
        }
        Ok(())
    }
}
