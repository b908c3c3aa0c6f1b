use aurt_recording::{PreprocessOptions, Preprocessed, Recording, RecordingError, preprocess};

use aurt_simulation::SimulationError;
use aurt_simulation::robots::Robot;
use aurt_simulation::sensors::SimulatedRecording;

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
