//! What a model's motion takes, one instant at a time.

use aurt_traits::{Motion, RobotState, RobotTile};

use super::{MovingModel, REST_RAD_S};
use crate::error::SimulationError;

/// A model with the memory of its friction at the last completed step.
pub(super) struct Torque<'m> {
    moving: &'m MovingModel<'m>,
    memory: RobotState,
    tile: RobotTile,
    pub evaluations: u64,
}

impl<'m> Torque<'m> {
    pub fn new(moving: &'m MovingModel<'m>) -> Self {
        Self { moving, memory: RobotState::default(), tile: RobotTile::default(), evaluations: 0 }
    }

    pub fn start(&mut self, q: &[f64], v: &[f64], time_s: f64) -> Result<(), SimulationError> {
        self.memory = RobotState::default();
        self.accept(q, v, &vec![0.0; q.len()], time_s)
    }

    /// Moves the memory to a completed step.
    pub fn accept(&mut self, q: &[f64], v: &[f64], a: &[f64], time_s: f64) -> Result<(), SimulationError> {
        let mut memory = std::mem::take(&mut self.memory);
        let result = self.at(&mut memory, q, v, a, time_s);
        self.memory = memory;
        result.map(|_| ())
    }

    /// The torques of a motion that goes on from the last completed step; dry friction is spread over the
    /// velocities that count as rest.
    pub fn near_rest(
        &mut self,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        time_s: f64,
    ) -> Result<Vec<f64>, SimulationError> {
        let rests = |v: &f64| v.abs() < REST_RAD_S;
        if !v.iter().any(rests) {
            let mut memory = self.memory.clone();
            return self.at(&mut memory, q, v, a, time_s);
        }
        let mut side = |sign: f64| {
            let v: Vec<f64> = v.iter().map(|v| if rests(v) { sign * REST_RAD_S } else { *v }).collect();
            let mut memory = self.memory.clone();
            self.at(&mut memory, q, &v, a, time_s)
        };
        let (below, above) = (side(-1.0)?, side(1.0)?);
        Ok((0..v.len())
            .map(|j| {
                let share = if rests(&v[j]) { 0.5 * (1.0 + v[j] / REST_RAD_S) } else { 0.5 };
                below[j] + share * (above[j] - below[j])
            })
            .collect())
    }

    /// What each joint needs for an acceleration of its own, at rest.
    pub fn inertia(&mut self, q: &[f64]) -> Result<Vec<f64>, SimulationError> {
        let rest = vec![0.0; q.len()];
        let mut at = |a: &[f64]| self.at(&mut RobotState::default(), q, &rest, a, 0.0);
        let still = at(&rest)?;
        (0..q.len())
            .map(|j| {
                let mut a = rest.clone();
                a[j] = 1.0;
                Ok(at(&a)?[j] - still[j])
            })
            .collect()
    }

    /// The torques along a whole motion, `[joint][sample]`.
    pub fn along(&mut self, motion: &Motion) -> Result<Vec<Vec<f64>>, SimulationError> {
        let MovingModel { model, load, .. } = self.moving;
        self.evaluations += motion.samples() as u64;
        model.evaluate(motion.view(), load, &mut RobotState::default(), &mut self.tile)?;
        Ok((0..model.joints()).map(|j| self.sum(j, motion.samples())).collect())
    }

    fn at(
        &mut self,
        memory: &mut RobotState,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        time_s: f64,
    ) -> Result<Vec<f64>, SimulationError> {
        let MovingModel { model, load, .. } = self.moving;
        self.evaluations += 1;
        let motion = Motion::new(q.len(), vec![time_s], q.to_vec(), v.to_vec(), a.to_vec())?;
        model.evaluate(motion.view(), load, memory, &mut self.tile)?;
        Ok((0..q.len()).map(|j| self.sum(j, 1)[0]).collect())
    }

    fn sum(&self, joint: usize, samples: usize) -> Vec<f64> {
        let MovingModel { model, coefficients, .. } = self.moving;
        let mut sum = vec![0.0; samples];
        for (slot, column) in model.row_slots(joint).zip(model.row_columns(joint)) {
            for (s, y) in sum.iter_mut().zip(self.tile.slot(slot)) {
                *s += coefficients[*column] * y;
            }
        }
        sum
    }
}
