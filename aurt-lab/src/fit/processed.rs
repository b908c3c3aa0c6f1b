use std::sync::Arc;

use aurt_recording::{PreprocessOptions, Preprocessed, Recording, RecordingError, Segment, preprocess};

use aurt_simulation::{
    SimulationError,
    inject::{Gram, Structure, StructureColumns, mean_square},
    robots::Robot,
    sensors::SimulatedRecording,
};

/// A structure fitted to recordings after the usual preprocessing (filtered, differentiated, decimated).
#[derive(Debug)]
pub struct ProcessedFit {
    columns: Arc<StructureColumns>,
    coefficients: Vec<f64>,
    weights: Vec<f64>,
}

/// A recording after the usual preprocessing for dynamics up to `f_dyn_hz`, torques in Nm, rest trimmed.
pub fn processed_motion(
    recording: &SimulatedRecording,
    robot: &Robot,
    f_dyn_hz: f64,
) -> Result<Preprocessed, SimulationError> {
    let n = recording.joints;
    let by_joint =
        |series: &[f64]| (0..n).map(|j| series.iter().skip(j).step_by(n).copied().collect()).collect();
    let input = Recording::from_arrays(recording.time_s.clone(), by_joint(&recording.position_rad))
        .and_then(|input| input.with_measurement(by_joint(&recording.measurement), recording.unit))
        .map_err(refused)?;
    let mut options = PreprocessOptions::new(f_dyn_hz);
    if recording.unit == aurt_traits::MeasurementUnit::Ampere {
        options.gains = Some(robot.drives.iter().map(|d| d.torque_constant_nm_per_a).collect());
    }
    preprocess(&input, &options).map_err(refused)
}

fn refused(error: RecordingError) -> SimulationError {
    SimulationError::Preprocessing { reason: error.to_string() }
}

impl ProcessedFit {
    /// Fits the structure to recordings, joints weighted by the inverse variance of what a first fit leaves.
    pub fn new(
        robot: &Robot,
        structure: &Structure,
        recordings: &[&Preprocessed],
    ) -> Result<Self, SimulationError> {
        Self::of_columns(Arc::new(StructureColumns::of_robot(robot, structure)?), recordings)
    }

    pub(crate) fn of_columns(
        columns: Arc<StructureColumns>,
        recordings: &[&Preprocessed],
    ) -> Result<Self, SimulationError> {
        let joints = columns.joints();
        let weights = vec![1.0; joints];
        let coefficients = vec![0.0; columns.coefficients()];
        let mut fit = Self { columns, coefficients, weights };
        let rows: Vec<Filtered> = recordings
            .iter()
            .flat_map(|r| &r.segments)
            .map(|segment| fit.filtered(segment))
            .collect::<Result<_, _>>()?;
        for _ in 0..2 {
            let mut gram = Gram::new(fit.columns.coefficients());
            for filtered in &rows {
                for (j, weight) in fit.weights.iter().enumerate() {
                    gram.add(fit.columns.row(j), &filtered.rows[j], &filtered.measured[j], *weight);
                }
            }
            fit.coefficients = gram.solve();
            for j in 0..joints {
                let left: Vec<f64> = rows.iter().flat_map(|f| fit.left_over(f, j)).collect();
                fit.weights[j] = 1.0 / mean_square(&left).max(1e-18);
            }
        }
        Ok(fit)
    }

    /// What the fit leaves of a recording, joint by joint, in Nm on the decimated rows.
    pub fn residuals(&self, recording: &Preprocessed) -> Result<Vec<Vec<f64>>, SimulationError> {
        let mut residuals = vec![Vec::new(); self.weights.len()];
        for segment in &recording.segments {
            let filtered = self.filtered(segment)?;
            for (j, all) in residuals.iter_mut().enumerate() {
                all.extend(self.left_over(&filtered, j));
            }
        }
        Ok(residuals)
    }

    /// Root mean square of [`Self::residuals`], Nm per joint.
    pub fn residual_rms_nm(&self, recording: &Preprocessed) -> Result<Vec<f64>, SimulationError> {
        Ok(self.residuals(recording)?.iter().map(|r| mean_square(r).sqrt()).collect())
    }

    fn filtered(&self, segment: &Segment) -> Result<Filtered, SimulationError> {
        let rows = self
            .columns
            .evaluate(segment.motion.view())
            .into_iter()
            .map(|row| segment.filtered(&row))
            .collect::<Result<Vec<Vec<Vec<f64>>>, _>>()
            .map_err(refused)?;
        Ok(Filtered { rows, measured: segment.measurement.clone().unwrap_or_default() })
    }

    fn left_over(&self, filtered: &Filtered, joint: usize) -> Vec<f64> {
        let (entries, measured) = (&filtered.rows[joint], &filtered.measured[joint]);
        self.columns.left_over(joint, entries, measured, &self.coefficients)
    }
}

/// Filtered and decimated rows of a segment, `[joint][entry][row]`, and its measurement.
struct Filtered {
    rows: Vec<Vec<Vec<f64>>>,
    measured: Vec<Vec<f64>>,
}
