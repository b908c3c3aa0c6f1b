use aurt_recording::Recording;

use super::law::{Added, Law};
use super::scene::Scene;
use super::{bodies, friction, instrument, outside};
use crate::error::SimulationError;

impl Added {
    /// What is added to the measured torque (or current), `[joint][sample]`.
    ///
    /// Laws of drives and instruments act on what was measured; what they add is the difference that they make.
    pub fn torque(&self, scene: &Scene, measured: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, SimulationError> {
        match &self.law {
            Law::RotorInertia
            | Law::Payload { .. }
            | Law::BaseTilt { .. }
            | Law::EncoderOffset
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
            | Law::PositionDamper { .. } => outside::torque(self, scene),
            _ => Ok(friction::torque(self, scene)),
        }
    }
}

/// The recording with effects; those that take rows out of it come last.
pub fn applied(
    effects: &[&Added],
    scene: &Scene,
    recording: &Recording,
) -> Result<Recording, SimulationError> {
    let mut altered = recording.clone();
    for effect in effects.iter().filter(|e| !matches!(e.law, Law::DroppedSamples { .. })) {
        let measured = altered.measurement.get_or_insert_default();
        let torque = effect.torque(scene, measured)?;
        for (series, added) in measured.iter_mut().zip(&torque) {
            for (m, a) in series.iter_mut().zip(added) {
                *m += a;
            }
        }
    }
    for effect in effects {
        match effect.law {
            Law::TimeDelay => instrument::begin_late(&mut altered, effect.size),
            Law::DroppedSamples { seed } => instrument::drop_samples(&mut altered, effect.size, seed),
            _ => {}
        }
    }
    Ok(altered)
}
