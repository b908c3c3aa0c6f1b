use aurt_recording::Segment;
use aurt_traits::{ArmSeries, ColumnGroup, Columns, LoadTorque, RobotModel};

use super::rigid::RigidRows;
use crate::{CalibrationError, rows::TILE_SAMPLES};

/// The load torque τ_J of every joint over a segment, unfiltered.
#[derive(Debug, Clone)]
pub(crate) struct LoadSeries {
    values: Vec<f64>,
    samples: usize,
}

impl LoadSeries {
    pub(crate) fn zero(joints: usize, samples: usize) -> Self {
        Self { values: vec![0.0; joints * samples], samples }
    }

    /// All joints, `stride` apart, from sample `first` on.
    pub(crate) fn from(&self, first: usize) -> &[f64] {
        &self.values[first..]
    }

    /// Distance between the first samples of two joints.
    pub(crate) const fn stride(&self) -> usize {
        self.samples
    }

    pub(crate) fn joint(&self, joint: usize) -> &[f64] {
        &self.values[joint * self.samples..(joint + 1) * self.samples]
    }
}

impl RigidRows<'_> {
    /// τ_J over a segment, as [`RobotModel::evaluate`] forms it.
    pub(crate) fn load_series(
        &self,
        model: &RobotModel,
        segment: &Segment,
        load: &LoadTorque,
    ) -> Result<LoadSeries, CalibrationError> {
        let motion = segment.motion.view();
        let mut series = LoadSeries::zero(self.joints(), motion.samples());
        let weights = match load {
            LoadTorque::Literal => vec![1.0; model.base().len()],
            LoadTorque::Fitted(weights) => weights.clone(),
        };
        if weights.iter().all(|w| *w == 0.0) {
            return Ok(series);
        }
        self.torque(motion, &weights, &mut series.values);
        if let LoadTorque::Fitted(weights) = load {
            self.add_load_terms(model, segment, weights, &mut series)?;
        }
        Ok(series)
    }

    /// Adds the torque of arm terms that joints transmit; they see no load themselves.
    fn add_load_terms(
        &self,
        model: &RobotModel,
        segment: &Segment,
        weights: &[f64],
        series: &mut LoadSeries,
    ) -> Result<(), CalibrationError> {
        let motion = segment.motion.view();
        let joints = self.joints();
        let no_load = vec![0.0; joints * TILE_SAMPLES];
        for (k, term) in model.arm_terms().iter().enumerate().filter(|(_, t)| t.is_load()) {
            let columns = model.group(ColumnGroup::ArmTerm(k));
            let acting = term.joints(joints);
            let count = acting.len() * columns.len();
            let mut scratch = vec![0.0; count * TILE_SAMPLES];
            let mut state = None;
            for first in (0..motion.samples()).step_by(TILE_SAMPLES) {
                let end = (first + TILE_SAMPLES).min(motion.samples());
                let now = |range| ArmSeries {
                    motion: motion.slice(range),
                    load_torque: &no_load,
                    load_stride: TILE_SAMPLES,
                    rigid_body: &**model.rigid_body(),
                };
                let state = state.get_or_insert_with(|| term.initial_state(&now(first..first + 1)));
                let mut out = Columns::new(&mut scratch, count, end - first, TILE_SAMPLES);
                term.evaluate(&now(first..end), state, &mut out)?;
                for (i, joint) in acting.iter().enumerate() {
                    let start = joint * series.samples + first;
                    let sum = &mut series.values[start..start + end - first];
                    for column in columns.clone().filter(|c| term.acts_on(c - columns.start, *joint, joints))
                    {
                        let values = out.column(i * columns.len() + column - columns.start);
                        for (s, v) in sum.iter_mut().zip(values) {
                            *s += weights[column] * v;
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
