use aurt_recording::Recording;
use serde::{Deserialize, Serialize};

use super::bodies;
use super::friction;
use super::instrument;
use super::law::Law;
use super::outside;
use super::scene::Scene;
use crate::error::SimulationError;

/// An effect that is added to recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Added {
    /// Its shape.
    pub law: Law,
    /// The joint that it is on; of effects of the whole arm, any.
    pub joint: usize,
    /// Its size, in the unit that `Self::unit` names; never negative.
    pub size: f64,
    /// 1 or −1: which way it acts, where it can act either way.
    pub sign: f64,
}

impl Added {
    /// The same effect of another size.
    #[must_use]
    pub fn of_size(&self, size: f64) -> Self {
        Self { size, ..self.clone() }
    }

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

    /// Whether what is added is in proportion to the size.
    #[must_use]
    pub const fn is_linear(&self) -> bool {
        !matches!(
            self.law,
            Law::TorqueConstant
                | Law::TimeDelay
                | Law::Saturation { .. }
                | Law::BaseTilt { .. }
                | Law::JointElasticity { .. }
                | Law::DroppedSamples { .. }
        )
    }

    /// Whether it takes rows away and adds no torque.
    #[must_use]
    pub const fn is_loss_of_rows(&self) -> bool {
        matches!(self.law, Law::DroppedSamples { .. })
    }

    /// Whether it is confined to a window of one recording.
    #[must_use]
    pub const fn is_local(&self) -> bool {
        matches!(self.law, Law::ExternalContact { .. })
    }

    /// Size with its sign.
    pub(super) fn signed(&self) -> f64 {
        self.sign * self.size
    }
}
