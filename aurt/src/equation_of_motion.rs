//! The mass matrix and the torque of gravity in the equation of motion of a calibrated model.

use aurt_traits::{ModelError, Motion, RigidBodyRegressor};

use crate::calibrated_file::CalibratedModel;
use crate::torque::TorqueSeries;

/// Positions that are evaluated together.
const AT_ONCE: usize = 256;

/// M(q) and g(q) of τ = M(q) q̈ + c(q, q̇) + g(q) + friction for a calibrated model, of many positions at once.
///
/// Both are of the rigid bodies and of the arm terms without memory (rotors, coupled motors, payload, a tilted base), in the
/// unit of the model's predictions: M per rad/s² (m/s² of joints that slide). For Nm that is kg m² (kg m where a joint that
/// turns meets one that slides, kg between two that slide). Springs, offsets and friction are in neither.
///
/// ```
/// use aurt::{EquationOfMotion, prelude::*};
/// # use aurt::{simulate, simulation::{Motion, Scenario, robots}};
///
/// # let machine = robots::two_link();
/// # let motion = Motion::MultiSine { duration_s: 5.0, harmonics: 5, top_hz: 1.0, share: 0.6 };
/// # let recording = simulate(&Scenario::new(machine.clone(), motion.plan(&machine, 1)?, 1))?;
/// # let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
/// # let model = Calibrator::new(robot.model().build()?).calibration(&recording).calibrate()?.calibrated;
/// let mut equation = EquationOfMotion::new(&model)?;
/// // Two positions of two joints, joint after joint.
/// let mass = equation.mass_matrices(2, &[0.1, 0.2, 0.3, 0.4])?;
/// assert!(mass.len() == 8 && (mass[1] - mass[2]).abs() < 1e-12, "position after position, row after row");
/// let gravity = equation.gravity(2, &[0.1, 0.2, 0.3, 0.4])?;
/// assert_eq!(gravity.len(), 4, "position after position");
/// # Ok::<(), aurt::Error>(())
/// ```
#[derive(Debug)]
pub struct EquationOfMotion<'m> {
    series: TorqueSeries<'m>,
    bodies: &'m dyn RigidBodyRegressor,
    weightless: Box<dyn RigidBodyRegressor>,
}

impl<'m> EquationOfMotion<'m> {
    /// The equation of a model.
    ///
    /// # Errors
    /// [`ModelError::Count`] if the coefficients are not the model's.
    pub fn new(calibrated: &'m CalibratedModel) -> Result<Self, ModelError> {
        let bodies = &**calibrated.model.rigid_body();
        let weightless = bodies.with_gravity([0.0; 3]);
        Ok(Self { series: TorqueSeries::new(calibrated)?, bodies, weightless })
    }

    /// M(q) at `positions`, N × N each, position after position and row after row. `position_rad` holds the N joints' angles,
    /// joint after joint.
    ///
    /// Column k is ∂τ/∂q̈_k at rest: the torque of a unit acceleration of joint k less that of none.
    ///
    /// # Errors
    /// [`ModelError::Count`] unless there are N angles for each position; whatever an arm term reports.
    pub fn mass_matrices(&mut self, positions: usize, position_rad: &[f64]) -> Result<Vec<f64>, ModelError> {
        let joints = self.bodies.joints();
        let mut mass = vec![0.0; positions * joints * joints];
        for_each_stretch(joints, positions, position_rad, |first, angles, samples| {
            let mut at = |acceleration| {
                let motion = at_rest(joints, angles.clone(), acceleration)?;
                self.series
                    .without_friction(motion.view(), &*self.weightless)
                    .map(|(torque, _)| torque.to_vec())
            };
            let still = at(vec![0.0; joints * samples])?;
            for column in 0..joints {
                let mut unit = vec![0.0; joints * samples];
                unit[column * samples..(column + 1) * samples].fill(1.0);
                let torque = at(unit)?;
                for (k, (moved, still)) in torque.iter().zip(&still).enumerate() {
                    let (row, sample) = (k / samples, first + k % samples);
                    mass[(sample * joints + row) * joints + column] = moved - still;
                }
            }
            Ok(())
        })?;
        Ok(mass)
    }

    /// g(q) at `positions`, N each, position after position: the torque at rest less that of the same machine without gravity.
    /// `position_rad` as for [`Self::mass_matrices`].
    ///
    /// # Errors
    /// As [`Self::mass_matrices`].
    pub fn gravity(&mut self, positions: usize, position_rad: &[f64]) -> Result<Vec<f64>, ModelError> {
        let joints = self.bodies.joints();
        let mut gravity = vec![0.0; positions * joints];
        for_each_stretch(joints, positions, position_rad, |first, angles, samples| {
            let motion = at_rest(joints, angles, vec![0.0; joints * samples])?;
            for (bodies, sign) in [(self.bodies, 1.0), (&*self.weightless, -1.0)] {
                let (torque, _) = self.series.without_friction(motion.view(), bodies)?;
                for (k, torque) in torque.iter().enumerate() {
                    gravity[(first + k % samples) * joints + k / samples] += sign * torque;
                }
            }
            Ok(())
        })?;
        Ok(gravity)
    }
}

/// Calls `work` with the first position of every stretch, its angles, joint after joint, and the number of its positions.
fn for_each_stretch(
    joints: usize,
    positions: usize,
    position_rad: &[f64],
    mut work: impl FnMut(usize, Vec<f64>, usize) -> Result<(), ModelError>,
) -> Result<(), ModelError> {
    let (expected, found) = (joints * positions, position_rad.len());
    if found != expected {
        return Err(ModelError::Count { what: "angles".into(), expected, found });
    }
    for first in (0..positions).step_by(AT_ONCE) {
        let end = (first + AT_ONCE).min(positions);
        let of_joint = |j: usize| position_rad[j * positions + first..j * positions + end].iter().copied();
        work(first, (0..joints).flat_map(of_joint).collect(), end - first)?;
    }
    Ok(())
}

fn at_rest(joints: usize, angles: Vec<f64>, acceleration: Vec<f64>) -> Result<Motion, ModelError> {
    let samples = angles.len() / joints.max(1);
    Motion::new(joints, vec![0.0; samples], angles, vec![0.0; joints * samples], acceleration)
}
