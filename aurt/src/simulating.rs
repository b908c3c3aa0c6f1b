//! Simulated robots, whose recordings are like those of real ones, and calibrated models that move.

use aurt_recording::Recording;
use aurt_simulation::Scenario;
use aurt_simulation::model::{ModelDrive, MovingModel};

use crate::calibrated_file::CalibratedModel;
use crate::data::{Loaded, Purpose};
use crate::error::Error;
use crate::progress::Progress;

/// What the logger of a simulated robot records.
///
/// # Errors
/// If robot, trajectory, effects, sensors or logger are refused.
pub fn simulate(scenario: &Scenario) -> Result<Recording, Error> {
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

/// What moves a calibrated model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// A controller that knows the model and follows the recorded motion.
    Motion {
        /// Bandwidth of the controller, Hz.
        bandwidth_hz: f64,
    },
    /// What was measured, without controller.
    Measurement,
}

impl CalibratedModel {
    /// How this model moves along the longest stretch without gaps of a recording: q, q̇ and what drives the joints.
    ///
    /// # Errors
    /// What makes the recording unfit; a model whose inertia is not positive, a motion that runs away.
    pub fn moved(
        &self,
        recording: &Recording,
        drive: Drive,
        progress: &Progress,
    ) -> Result<Recording, Error> {
        let purpose = match drive {
            Drive::Motion { .. } => Purpose::Prediction,
            Drive::Measurement => Purpose::Validation,
        };
        let pipeline = self.pipeline();
        let prepared = pipeline.preprocess(&Loaded::of(recording, &pipeline.joints)?, purpose)?;
        let unfit = |reason: &str| Error::Unfit {
            path: recording.file.clone(),
            reason: reason.into(),
            remedy: "use a recording of a second or more, with a measurement if that is to drive the model"
                .into(),
        };
        let longest = prepared.data.segments.into_iter().max_by_key(|segment| segment.motion.samples());
        let segment = longest.ok_or_else(|| unfit("has no stretch without gaps that could be simulated"))?;
        let motion = segment.motion;
        let drive = match drive {
            Drive::Motion { bandwidth_hz } => ModelDrive::Follow { motion, bandwidth_hz },
            Drive::Measurement => {
                let torque = segment.raw_measurement.ok_or_else(|| unfit("has no measurement"))?;
                ModelDrive::Torques { motion, torque }
            }
        };
        let coefficients = self.calibration.coefficients();
        let moving =
            MovingModel { model: &self.model, coefficients: &coefficients, load: &self.calibration.load };
        let moved = moving.run(&drive, &mut |_| progress.step("moving the model"))?;
        Ok(Recording::from_arrays(moved.time_s, moved.position_rad)?
            .with_velocity(moved.velocity_rad_s)?
            .with_measurement(moved.torque, self.calibration.unit)?
            .named("simulated model"))
    }
}
