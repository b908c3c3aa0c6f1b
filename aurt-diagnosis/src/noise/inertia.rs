//! The inertia matrix along a motion.

use aurt_traits::{Motion, MotionView, RigidBodyRegressor};

use crate::error::DiagnosisError;

/// Columns of the inertia matrix along a motion, M(q) e_j, at every `step`-th sample.
#[derive(Debug, Clone)]
pub struct InertiaColumns {
    step: usize,
    /// `[acceleration of joint j][torque of joint i][sample]`, kg m².
    columns: Vec<Vec<Vec<f64>>>,
}

impl InertiaColumns {
    /// Evaluates them from inertial parameters: (index among the standard parameters, value). In the fitted base
    /// parameters of a robot M is complete, up to the parameters that its motion did not excite.
    ///
    /// # Errors
    /// If the motion's series do not fit together.
    pub fn evaluate(
        body: &dyn RigidBodyRegressor,
        inertial: &[(usize, f64)],
        motion: MotionView<'_>,
        step: usize,
    ) -> Result<Self, DiagnosisError> {
        let joints = body.joints();
        let weightless = body.with_gravity([0.0; 3]);
        let parameters = weightless.standard_parameters().len();
        let picked = |series: &[f64]| series.iter().step_by(step).copied().collect::<Vec<_>>();
        let time = picked(motion.time_s());
        let count = time.len();
        let position: Vec<f64> = (0..joints).flat_map(|j| picked(motion.position_rad(j))).collect();
        let mut standard = vec![0.0; parameters];
        inertial.iter().for_each(|(parameter, value)| standard[*parameter] = *value);
        let columns = (0..joints)
            .map(|accelerated| {
                let mut acceleration = vec![0.0; joints * count];
                acceleration[accelerated * count..(accelerated + 1) * count].fill(1.0);
                let still = vec![0.0; joints * count];
                let unit = Motion::new(joints, time.clone(), position.clone(), still, acceleration)?;
                Ok(torques(&*weightless, unit.view(), &standard))
            })
            .collect::<Result<Vec<Vec<Vec<f64>>>, DiagnosisError>>()?;
        Ok(Self { step, columns })
    }

    /// An arm whose inertia is the same in every pose, `[j][i]`.
    #[cfg(test)]
    pub(crate) fn constant(columns: &[Vec<f64>]) -> Self {
        let columns = columns.iter().map(|c| c.iter().map(|m| vec![*m]).collect()).collect();
        Self { step: 1, columns }
    }

    /// Every how many samples of the motion it is evaluated.
    #[must_use]
    pub const fn step(&self) -> usize {
        self.step
    }

    /// M_ij at a sample of the motion, kg m².
    #[must_use]
    pub fn at(&self, accelerated: usize, joint: usize, sample: usize) -> f64 {
        let series = &self.columns[accelerated][joint];
        series[(sample / self.step).min(series.len() - 1)]
    }
}

/// τ of bodies with the given standard parameters, `[joint][sample]`.
pub(crate) fn torques(
    body: &dyn RigidBodyRegressor,
    motion: MotionView<'_>,
    standard: &[f64],
) -> Vec<Vec<f64>> {
    let count = motion.samples();
    let mut torque = vec![0.0; body.joints() * count];
    body.torque(motion, standard, &mut torque, count);
    torque.chunks(count.max(1)).map(<[f64]>::to_vec).collect()
}
