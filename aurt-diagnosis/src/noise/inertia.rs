//! The inertia matrix along a motion.

use aurt_traits::{Motion, MotionView, RegressorTile, RigidBodyRegressor};

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
        let mut destination = vec![RegressorTile::UNWANTED; joints * parameters];
        for joint in 0..joints {
            for (k, (parameter, _)) in inertial.iter().enumerate() {
                destination[joint * parameters + parameter] = (joint * inertial.len() + k) as u32;
            }
        }
        let mut data = vec![0.0; joints * inertial.len() * count];
        let columns = (0..joints)
            .map(|accelerated| {
                let mut acceleration = vec![0.0; joints * count];
                acceleration[accelerated * count..(accelerated + 1) * count].fill(1.0);
                let still = vec![0.0; joints * count];
                let unit = Motion::new(joints, time.clone(), position.clone(), still, acceleration)?;
                data.fill(0.0);
                let mut tile = RegressorTile::new(&destination, parameters, count, count, &mut data);
                weightless.evaluate(unit.view(), &mut tile);
                Ok((0..joints)
                    .map(|joint| {
                        let mut torque = vec![0.0; count];
                        for (k, (parameter, value)) in inertial.iter().enumerate() {
                            if !body.loads(*parameter, joint) {
                                continue;
                            }
                            let start = (joint * inertial.len() + k) * count;
                            for (t, y) in torque.iter_mut().zip(&data[start..start + count]) {
                                *t += value * y;
                            }
                        }
                        torque
                    })
                    .collect())
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
