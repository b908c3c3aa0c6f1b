use aurt_recording::Recording;

use super::bodies;
use super::friction;
use super::instrument;
use super::law::{Added, Law};
use super::outside;
use super::scene::Scene;
use crate::error::SimulationError;

impl Added {
    /// What is added to the measured torque (or current), `[joint][sample]`.
    ///
    /// Laws of drives and instruments act on what was measured; what they add is the difference that they make.
    ///
    /// # Errors
    /// If the rigid bodies refuse.
    pub fn torque(&self, scene: &Scene, measured: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, SimulationError> {
        match &self.law {
            Law::RotorInertia
            | Law::Payload { .. }
            | Law::BaseTilt { .. }
            | Law::Spring { .. }
            | Law::TorqueRipple { .. }
            | Law::JointElasticity { .. } => bodies::torque(self, scene),
            Law::TorqueConstant | Law::CurrentOffset | Law::TimeDelay | Law::Saturation { .. } => {
                Ok(instrument::torque(self, scene, measured))
            }
            Law::DroppedSamples { .. } => Ok(scene.nothing()),
            Law::ExternalContact { .. }
            | Law::PeriodicDisturbance { .. }
            | Law::CrossAngleFriction { .. }
            | Law::StickingWindow { .. }
            | Law::PositionDamper { .. } => Ok(outside::torque(self, scene)),
            _ => Ok(friction::torque(self, scene)),
        }
    }

    /// The recording with the effect.
    ///
    /// # Errors
    /// As [`Self::torque`].
    pub fn applied(&self, scene: &Scene, recording: &Recording) -> Result<Recording, SimulationError> {
        let mut altered = recording.clone();
        if let Law::DroppedSamples { seed } = self.law {
            instrument::drop_samples(&mut altered, self.size, seed);
            return Ok(altered);
        }
        let measured = altered.measurement.get_or_insert_default();
        let torque = self.torque(scene, measured)?;
        for (series, added) in measured.iter_mut().zip(&torque) {
            for (m, a) in series.iter_mut().zip(added) {
                *m += a;
            }
        }
        Ok(altered)
    }
}
