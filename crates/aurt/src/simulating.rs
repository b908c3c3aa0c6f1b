//! Simulated robots, whose recordings are like those of real ones.

use aurt_recording::Recording;
use aurt_simulation::Scenario;

use crate::failure::Failure;

/// What the logger of a simulated robot records.
///
/// # Errors
/// If robot, trajectory, effects, sensors or logger are refused.
pub fn simulate(scenario: &Scenario) -> Result<Recording, Failure> {
    let logged = aurt_simulation::simulate(scenario)?;
    let by_joint = |rows: &[f64]| -> Vec<Vec<f64>> {
        (0..logged.joints).map(|j| rows.iter().skip(j).step_by(logged.joints).copied().collect()).collect()
    };
    let mut recording = Recording::from_arrays(logged.time_s.clone(), by_joint(&logged.position_rad))?;
    if !logged.velocity_rad_s.is_empty() {
        recording = recording.with_velocity(by_joint(&logged.velocity_rad_s))?;
    }
    let name = format!("simulated {}", scenario.robot.name);
    Ok(recording.with_measurement(by_joint(&logged.measurement), logged.unit)?.named(name))
}
