//! What the experiment's own structure leaves of the recordings as they are: a least squares of base parameters and
//! the experiment's friction. Nothing of it is reported but residuals; effects take its rigid-body torque and friction.

use std::sync::Arc;

use aurt_rbd::base_parameters;
use aurt_recording::{Preprocessed, Segment};
use aurt_traits::{BaseParameters, MotionView, RegressorTile, RigidBodyRegressor};

use super::gram::{Gram, mean_square};
use super::real::{RealExperiment, Structure};
use crate::error::SimulationError;

/// The experiment's structure fitted to the recordings as they are.
#[derive(Debug, Clone)]
pub struct OwnModel {
    bodies: Arc<dyn RigidBodyRegressor>,
    base: BaseParameters,
    structure: Structure,
    /// Coefficients of each joint's row: base parameters, then Coulomb, viscous, rotor, load.
    rows: Vec<Vec<usize>>,
    coefficients: Vec<f64>,
    standard: Vec<f64>,
    coulomb: Vec<f64>,
    viscous: Vec<f64>,
    /// Root mean square of what is left, per joint.
    left_rms: Vec<f64>,
}

/// Filtered and decimated rows of one recording, `[joint][entry][row]`, and its measurement `[joint][row]`.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// Entries of each joint's row.
    pub columns: Vec<Vec<Vec<f64>>>,
    pub measured: Vec<Vec<f64>>,
}

/// Fits: the first gives load and weights, the second is the one that counts.
const PASSES: usize = 3;

impl OwnModel {
    pub(super) fn new(real: &RealExperiment, recordings: &[Preprocessed]) -> Result<Self, SimulationError> {
        let joints = real.bodies.joints();
        let base = base_parameters(&*real.bodies, 1)?;
        let mut rows: Vec<Vec<usize>> = (0..joints)
            .map(|j| (0..base.len()).filter(|k| real.bodies.loads(base.columns[*k], j)).collect())
            .collect();
        let mut count = base.len();
        for (row, terms) in rows.iter_mut().zip(&real.structure.joints) {
            let own = usize::from(terms.coulomb)
                + usize::from(terms.viscous)
                + usize::from(terms.rotor)
                + usize::from(terms.load);
            row.extend(count..count + own);
            count += own;
        }
        let mut model = Self {
            standard: vec![0.0; real.bodies.standard_parameters().len()],
            coulomb: vec![0.0; joints],
            viscous: vec![0.0; joints],
            left_rms: vec![1.0; joints],
            coefficients: vec![0.0; count],
            structure: real.structure.clone(),
            bodies: Arc::clone(&real.bodies),
            base,
            rows,
        };
        for _ in 0..PASSES {
            let all = recordings.iter().map(|r| model.rows_of(r)).collect::<Result<Vec<_>, _>>()?;
            let refs: Vec<&Rows> = all.iter().collect();
            model.coefficients = model.fitted(&refs, |r, j| &refs[r].measured[j]);
            model.left_rms = (0..joints)
                .map(|j| {
                    let left: Vec<f64> = refs
                        .iter()
                        .flat_map(|r| model.left_over(r, &r.measured[j], j, &model.coefficients))
                        .collect();
                    mean_square(&left).sqrt()
                })
                .collect();
            model.take_apart();
        }
        Ok(model)
    }

    /// The rigid bodies under gravity.
    #[must_use]
    pub const fn bodies(&self) -> &Arc<dyn RigidBodyRegressor> {
        &self.bodies
    }

    /// Standard inertial parameters that give the fitted rigid-body torques: base parameters in the places of the
    /// standard ones that they are named after, nothing elsewhere.
    #[must_use]
    pub fn standard(&self) -> &[f64] {
        &self.standard
    }

    /// Fitted Coulomb friction, per joint; 0 where the structure has none.
    #[must_use]
    pub fn coulomb(&self) -> &[f64] {
        &self.coulomb
    }

    /// Fitted viscous friction, per joint.
    #[must_use]
    pub fn viscous(&self) -> &[f64] {
        &self.viscous
    }

    /// Root mean square of what the structure leaves of all recordings after the usual filters, per joint: the unit of
    /// an injected effect's strength.
    #[must_use]
    pub fn left_rms(&self) -> &[f64] {
        &self.left_rms
    }

    /// The rows of a recording.
    ///
    /// # Errors
    /// If a series cannot be filtered.
    pub fn rows_of(&self, recording: &Preprocessed) -> Result<Rows, SimulationError> {
        let joints = self.rows.len();
        let mut rows = Rows {
            columns: self.rows.iter().map(|row| vec![Vec::new(); row.len()]).collect(),
            measured: vec![Vec::new(); joints],
        };
        for segment in &recording.segments {
            let kept = segment.rows();
            for (j, row) in self.evaluate(segment.motion.view()).into_iter().enumerate() {
                for (all, column) in rows.columns[j].iter_mut().zip(filtered(segment, &row)?) {
                    all.extend(column);
                }
            }
            let measured = segment.measurement.iter().flatten();
            for (all, series) in rows.measured.iter_mut().zip(measured) {
                all.extend(series.iter().take(kept));
            }
        }
        Ok(rows)
    }

    /// Least squares on recordings with the given measurement, `[recording, joint]`, joints weighted by what was left.
    #[must_use]
    pub fn fitted<'a>(
        &self,
        recordings: &[&Rows],
        measured: impl Fn(usize, usize) -> &'a Vec<f64>,
    ) -> Vec<f64> {
        let mut gram = Gram::new(self.coefficients.len());
        for (r, rows) in recordings.iter().enumerate() {
            for (j, columns) in rows.columns.iter().enumerate() {
                let weight = 1.0 / (self.left_rms[j] * self.left_rms[j]).max(1e-18);
                gram.add(&self.rows[j], columns, measured(r, j), weight);
            }
        }
        gram.solve()
    }

    /// What coefficients leave of a joint's measurement.
    #[must_use]
    pub fn left_over(&self, rows: &Rows, measured: &[f64], joint: usize, coefficients: &[f64]) -> Vec<f64> {
        let mut left = measured.to_vec();
        for (k, column) in self.rows[joint].iter().zip(&rows.columns[joint]) {
            for (l, y) in left.iter_mut().zip(column) {
                *l -= coefficients[*k] * y;
            }
        }
        left
    }

    /// Rigid bodies and friction from the coefficients.
    fn take_apart(&mut self) {
        self.standard.fill(0.0);
        for (k, column) in self.base.columns.iter().enumerate() {
            self.standard[*column] = self.coefficients[k];
        }
        for (j, terms) in self.structure.joints.iter().enumerate() {
            let mut own = self.rows[j].iter().filter(|k| **k >= self.base.len());
            let mut next = |there: bool| {
                if there { own.next().map_or(0.0, |k| self.coefficients[*k]) } else { 0.0 }
            };
            self.coulomb[j] = next(terms.coulomb).max(0.0);
            self.viscous[j] = next(terms.viscous).max(0.0);
        }
    }

    fn evaluate(&self, motion: MotionView<'_>) -> Vec<Vec<Vec<f64>>> {
        let (joints, samples) = (self.rows.len(), motion.samples());
        let parameters = self.standard.len();
        let mut destination = vec![RegressorTile::UNWANTED; joints * parameters];
        let mut columns = 0;
        for (j, row) in self.rows.iter().enumerate() {
            for k in row.iter().take_while(|k| **k < self.base.len()) {
                destination[j * parameters + self.base.columns[*k]] = columns;
                columns += 1;
            }
        }
        let mut data = vec![0.0; columns as usize * samples];
        self.bodies
            .evaluate(motion, &mut RegressorTile::new(&destination, parameters, samples, samples, &mut data));
        let mut load = vec![0.0; joints * samples];
        if self.structure.joints.iter().any(|t| t.load) {
            self.bodies.torque(motion, &self.standard, &mut load, samples);
        }
        let mut rigid = data.chunks_exact(samples.max(1));
        (0..joints)
            .map(|j| {
                let count = self.rows[j].iter().take_while(|k| **k < self.base.len()).count();
                let mut row: Vec<Vec<f64>> = rigid.by_ref().take(count).map(<[f64]>::to_vec).collect();
                let terms = self.structure.joints[j];
                let velocity = motion.velocity_rad_s(j);
                let sign = |v: &f64| if *v == 0.0 { 0.0 } else { v.signum() };
                if terms.coulomb {
                    row.push(velocity.iter().map(sign).collect());
                }
                if terms.viscous {
                    row.push(velocity.to_vec());
                }
                if terms.rotor {
                    row.push(motion.acceleration_rad_s2(j).to_vec());
                }
                if terms.load {
                    let load = &load[j * samples..(j + 1) * samples];
                    row.push(load.iter().zip(velocity).map(|(l, v)| l.abs() * sign(v)).collect());
                }
                row
            })
            .collect()
    }
}

/// Columns after the filter that the measurement has passed, decimated as it was.
fn filtered(segment: &Segment, columns: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, SimulationError> {
    segment.filtered(columns).map_err(|error| SimulationError::Preprocessing { reason: error.to_string() })
}
