//! How strong an effect came out: the torque that the experiment's own structure cannot absorb, over noise.

use std::sync::Arc;

use aurt_simulation::inject::{Gram, StructureColumns};
use aurt_simulation::plant::{TRACE_STEP_S, Traces};
use aurt_simulation::sensors::{Instrument, linear_at};
use aurt_simulation::{Robot, SimulationError};
use aurt_traits::Motion;

/// Every how many samples of the traces one is used.
const THINNING: usize = 10;
const MOVING_RAD_S: f64 = 0.03;

/// Noise-free samples of one recording, thinned out, from the first to the last motion.
#[derive(Debug)]
pub(crate) struct Samples {
    motion: Motion,
    /// Joint after joint.
    measured_nm: Vec<Vec<f64>>,
}

impl Samples {
    /// The samples of a window of a recording, as its sensors would show them without noise.
    pub fn new(
        traces: &Traces,
        instrument: &Instrument,
        window_s: Option<[f64; 2]>,
    ) -> Result<Self, SimulationError> {
        let n = traces.joints;
        let moves =
            |k: &usize| traces.velocity_rad_s[k * n..(k + 1) * n].iter().any(|v| v.abs() > MOVING_RAD_S);
        let inside = |k: &usize| {
            window_s.is_none_or(|[start, end]| (start..=end).contains(&(*k as f64 * TRACE_STEP_S)))
        };
        let thinned: Vec<usize> = (0..traces.samples).step_by(THINNING).collect();
        let first = thinned.iter().position(moves).unwrap_or(0);
        let last = thinned.iter().rposition(moves).unwrap_or(0);
        let kept: Vec<usize> = thinned[first..=last].iter().copied().filter(inside).collect();
        let series = |all: &[f64]| -> Vec<f64> {
            (0..n).flat_map(|j| kept.iter().map(move |k| all[k * n + j])).collect()
        };
        // As the logger reads it, between samples too.
        let of_joint = |j: usize| {
            let at = |k: &usize| {
                let then_s = traces.time_s(*k) - instrument.torque_delay_s;
                instrument.noise_free_nm(j, linear_at(&traces.torque_nm, traces, then_s, j))
            };
            kept.iter().map(at).collect::<Vec<f64>>()
        };
        let measured_nm = (0..n).map(of_joint).collect();
        let motion = Motion::new(
            n,
            kept.iter().map(|k| traces.time_s(*k)).collect(),
            (0..n)
                .flat_map(|j| {
                    let offset = instrument.channels[j].encoder_offset_rad;
                    kept.iter().map(move |k| traces.position_rad[k * n + j] + offset)
                })
                .collect(),
            series(&traces.velocity_rad_s),
            series(&traces.acceleration_rad_s2),
        )?;
        Ok(Self { motion, measured_nm })
    }
}

#[derive(Debug)]
pub(crate) struct NoiseFreeFit {
    columns: Arc<StructureColumns>,
    coefficients: Vec<f64>,
    noise_nm: Vec<f64>,
    /// Speed at or below which a joint rests: its instants are neither fitted nor counted; `None` fits all and counts those
    /// that are not held.
    rest_rad_s: Option<f64>,
}

impl NoiseFreeFit {
    /// Fits the structure, joints weighted by their noise. Bristles never let a joint rest quite: where the baseline has
    /// them, `rest_rad_s` says what is rest.
    pub fn new(
        robot: &Robot,
        columns: &Arc<StructureColumns>,
        recordings: &[Samples],
        rest_rad_s: Option<f64>,
    ) -> Self {
        let noise_nm: Vec<f64> = robot.drives.iter().map(|d| d.torque_noise_nm.max(1e-9)).collect();
        let mut gram = Gram::new(columns.coefficients());
        for samples in recordings {
            let rows = columns.evaluate(samples.motion.view());
            for (j, row) in rows.iter().enumerate() {
                let weight = 1.0 / (noise_nm[j] * noise_nm[j]);
                let Some(rest) = rest_rad_s else {
                    gram.add(columns.row(j), row, &samples.measured_nm[j], weight);
                    continue;
                };
                let velocity = samples.motion.view().velocity_rad_s(j);
                let moving = |series: &[f64]| -> Vec<f64> {
                    series.iter().zip(velocity).filter(|(_, v)| v.abs() > rest).map(|(x, _)| *x).collect()
                };
                let row: Vec<Vec<f64>> = row.iter().map(|column| moving(column)).collect();
                gram.add(columns.row(j), &row, &moving(&samples.measured_nm[j]), weight);
            }
        }
        Self { coefficients: gram.solve(), columns: Arc::clone(columns), noise_nm, rest_rad_s }
    }

    /// Mean square of what the fit leaves of a recording, over the noise's variance, per joint. Instants at
    /// which a joint is held still do not count: there the torque can be anything up to dry friction.
    pub fn left_over(&self, samples: &Samples) -> Vec<f64> {
        let rows = self.columns.evaluate(samples.motion.view());
        rows.iter()
            .enumerate()
            .map(|(j, row)| {
                let left = self.columns.left_over(j, row, &samples.measured_nm[j], &self.coefficients);
                let velocity = samples.motion.view().velocity_rad_s(j);
                let moving =
                    left.iter().zip(velocity).filter(|(_, v)| v.abs() > self.rest_rad_s.unwrap_or(0.0));
                let (sum, count) = moving.fold((0.0, 0), |(sum, count), (l, _)| (sum + l * l, count + 1));
                sum / f64::from(count.max(1)) / (self.noise_nm[j] * self.noise_nm[j])
            })
            .collect()
    }
}
