use aurt_traits::{Motion, MotionView, RigidBodyRegressor};

use crate::error::DiagnosisError;
use crate::noise::inertia::torques;

/// How the torque of gravity changes with each joint's angle along a motion, ∂g_i/∂q_j, at every `step`-th sample.
#[derive(Debug, Clone)]
pub struct GravityGradients {
    step: usize,
    /// `[angle of joint j][torque of joint i][sample]`, Nm/rad.
    columns: Vec<Vec<Vec<f64>>>,
}

/// Half the distance of the two poses of a central difference, rad: gravity is a sum of sines of angles, of which the
/// difference loses δ²/6.
const DELTA_RAD: f64 = 1e-3;

impl GravityGradients {
    /// Evaluates them from inertial parameters, (index among the standard parameters, value), by central differences.
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
        let mut standard = vec![0.0; body.standard_parameters().len()];
        inertial.iter().for_each(|(parameter, value)| standard[*parameter] = *value);
        let picked = |series: &[f64]| series.iter().step_by(step).copied().collect::<Vec<_>>();
        let time = picked(motion.time_s());
        let position: Vec<f64> = (0..joints).flat_map(|j| picked(motion.position_rad(j))).collect();
        let count = time.len();
        let columns = (0..joints)
            .map(|turned| {
                // The torque that holds the arm in each pose, `[joint][sample]`.
                let at = |delta_rad: f64| -> Result<_, DiagnosisError> {
                    let mut position = position.clone();
                    position[turned * count..(turned + 1) * count].iter_mut().for_each(|q| *q += delta_rad);
                    let still = vec![0.0; joints * count];
                    let poses = Motion::new(joints, time.clone(), position, still.clone(), still)?;
                    Ok(torques(body, poses.view(), &standard))
                };
                let (ahead, behind) = (at(DELTA_RAD)?, at(-DELTA_RAD)?);
                let slope = |(a, b): (&Vec<f64>, &Vec<f64>)| {
                    a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * DELTA_RAD)).collect()
                };
                Ok(ahead.iter().zip(&behind).map(slope).collect())
            })
            .collect::<Result<_, DiagnosisError>>()?;
        Ok(Self { step, columns })
    }

    /// An arm without gravity.
    #[cfg(test)]
    pub fn none(joints: usize) -> Self {
        Self { step: 1, columns: vec![vec![vec![0.0]; joints]; joints] }
    }

    /// ∂g_i/∂q_j at a sample of the motion, Nm/rad.
    #[must_use]
    pub fn at(&self, turned: usize, joint: usize, sample: usize) -> f64 {
        let series = &self.columns[turned][joint];
        series[(sample / self.step).min(series.len() - 1)]
    }
}
