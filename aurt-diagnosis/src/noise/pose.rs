//! What depends on the pose alone, along a motion.

use aurt_traits::{Motion, MotionView, RigidBodyRegressor};

use crate::error::DiagnosisError;

/// Changes of torque with each joint's motion, at every `step`-th sample: columns of the inertia matrix M(q) e_j, kg m², or
/// gradients of gravity ∂g_i/∂q_j, Nm/rad.
#[derive(Debug, Clone)]
pub struct PoseColumns {
    step: usize,
    /// `[motion of joint j][torque of joint i][sample]`.
    columns: Vec<Vec<Vec<f64>>>,
}

/// Half the distance of the two poses of a central difference, rad: gravity is a sum of sines of angles, of which the
/// difference loses δ²/6.
const DELTA_RAD: f64 = 1e-3;

impl PoseColumns {
    /// M(q) e_j from inertial parameters: (index among the standard parameters, value). In the fitted base parameters of a
    /// robot M is complete, up to the parameters that its motion did not excite.
    ///
    /// # Errors
    /// If the motion's series do not fit together.
    pub fn inertia(
        body: &dyn RigidBodyRegressor,
        inertial: &[(usize, f64)],
        motion: MotionView<'_>,
        step: usize,
    ) -> Result<Self, DiagnosisError> {
        let weightless = body.with_gravity([0.0; 3]);
        Self::of(&*weightless, inertial, motion, step, |torque, j| torque(None, Some(j)))
    }

    /// ∂g_i/∂q_j from inertial parameters, by central differences.
    pub(crate) fn gravity_gradients(
        body: &dyn RigidBodyRegressor,
        inertial: &[(usize, f64)],
        motion: MotionView<'_>,
        step: usize,
    ) -> Result<Self, DiagnosisError> {
        Self::of(body, inertial, motion, step, |torque, j| {
            let [mut ahead, behind] =
                [torque(Some((j, DELTA_RAD)), None)?, torque(Some((j, -DELTA_RAD)), None)?];
            for (a, b) in ahead.iter_mut().flatten().zip(behind.iter().flatten()) {
                *a = (*a - b) / (2.0 * DELTA_RAD);
            }
            Ok(ahead)
        })
    }

    /// `column` gets what evaluates the torque in each pose, with one joint turned by an angle, or accelerated by 1 rad/s².
    fn of(
        body: &dyn RigidBodyRegressor,
        inertial: &[(usize, f64)],
        motion: MotionView<'_>,
        step: usize,
        column: impl Fn(&Torque<'_>, usize) -> Result<Vec<Vec<f64>>, DiagnosisError>,
    ) -> Result<Self, DiagnosisError> {
        let joints = body.joints();
        let mut standard = vec![0.0; body.standard_parameters().len()];
        inertial.iter().for_each(|(parameter, value)| standard[*parameter] = *value);
        let picked = |series: &[f64]| series.iter().step_by(step).copied().collect::<Vec<_>>();
        let time = picked(motion.time_s());
        let count = time.len();
        let position: Vec<f64> = (0..joints).flat_map(|j| picked(motion.position_rad(j))).collect();
        let torque = |turned: Option<(usize, f64)>, accelerated: Option<usize>| {
            let (mut position, still) = (position.clone(), vec![0.0; joints * count]);
            let mut acceleration = still.clone();
            if let Some((j, by_rad)) = turned {
                position[j * count..(j + 1) * count].iter_mut().for_each(|q| *q += by_rad);
            }
            if let Some(j) = accelerated {
                acceleration[j * count..(j + 1) * count].fill(1.0);
            }
            let poses = Motion::new(joints, time.clone(), position, still, acceleration)?;
            Ok(torques(body, poses.view(), &standard))
        };
        let columns = (0..joints).map(|j| column(&torque, j)).collect::<Result<_, _>>()?;
        Ok(Self { step, columns })
    }

    /// An arm whose columns are the same in every pose, `[j][i]`.
    #[cfg(test)]
    pub(crate) fn constant(columns: &[Vec<f64>]) -> Self {
        let columns = columns.iter().map(|c| c.iter().map(|m| vec![*m]).collect()).collect();
        Self { step: 1, columns }
    }

    /// Every how many samples of the motion they are evaluated.
    pub const fn step(&self) -> usize {
        self.step
    }

    /// The torque of a joint for the motion of one, at a sample of the motion.
    pub fn at(&self, moved: usize, joint: usize, sample: usize) -> f64 {
        let series = &self.columns[moved][joint];
        series[(sample / self.step).min(series.len() - 1)]
    }
}

/// τ with a joint turned by an angle, rad, and one accelerated, `[joint][sample]`.
type Torque<'a> = dyn Fn(Option<(usize, f64)>, Option<usize>) -> Result<Vec<Vec<f64>>, DiagnosisError> + 'a;

/// τ of bodies with the given standard parameters, `[joint][sample]`.
fn torques(body: &dyn RigidBodyRegressor, motion: MotionView<'_>, standard: &[f64]) -> Vec<Vec<f64>> {
    let count = motion.samples();
    let mut torque = vec![0.0; body.joints() * count];
    body.torque(motion, standard, &mut torque, count);
    torque.chunks(count.max(1)).map(<[f64]>::to_vec).collect()
}
