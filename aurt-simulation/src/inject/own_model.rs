//! What an experiment's own structure leaves of the recordings as they are, or a simulated robot's of its own: a least squares
//! of base parameters and friction. Nothing of it is reported but residuals; effects take its rigid-body torque and friction.

use std::sync::Arc;

use aurt_recording::{Preprocessed, Segment};

use super::columns::StructureColumns;
use super::gram::{Gram, mean_square};
use super::real::RealExperiment;
use crate::error::SimulationError;

/// A structure fitted to recordings after the usual filters.
#[derive(Debug, Clone)]
pub struct OwnModel {
    pub(super) columns: StructureColumns,
    coefficients: Vec<f64>,
    /// Fitted Coulomb and viscous friction, per joint; 0 where the structure has none.
    pub(super) coulomb: Vec<f64>,
    pub(super) viscous: Vec<f64>,
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
        let columns = StructureColumns::new(Arc::clone(&real.bodies), real.structure.clone())?;
        let mut model = Self::unfitted(columns);
        let recordings: Vec<&Preprocessed> = recordings.iter().collect();
        for _ in 0..PASSES {
            let rows = model.rows_of_all(&recordings)?;
            model.fit(&rows);
            model.take_apart();
        }
        Ok(model)
    }

    /// A structure whose load is known, fitted to recordings: once for the weights, once with them.
    ///
    /// # Errors
    /// [`SimulationError::Preprocessing`].
    pub fn of_columns(
        columns: StructureColumns,
        recordings: &[&Preprocessed],
    ) -> Result<Self, SimulationError> {
        let mut model = Self::unfitted(columns);
        let rows = model.rows_of_all(recordings)?;
        model.fit(&rows);
        model.fit(&rows);
        Ok(model)
    }

    fn unfitted(columns: StructureColumns) -> Self {
        let joints = columns.joints();
        Self {
            coulomb: vec![0.0; joints],
            viscous: vec![0.0; joints],
            left_rms: vec![1.0; joints],
            coefficients: vec![0.0; columns.coefficients()],
            columns,
        }
    }

    fn rows_of_all(&self, recordings: &[&Preprocessed]) -> Result<Vec<Rows>, SimulationError> {
        recordings.iter().map(|r| self.rows_of(r)).collect()
    }

    fn fit(&mut self, recordings: &[Rows]) {
        let all: Vec<&Rows> = recordings.iter().collect();
        self.coefficients = self.fitted(&all, |r, j| &all[r].measured[j]);
        let left = |j: usize| -> Vec<f64> {
            all.iter().flat_map(|r| self.left_over(r, &r.measured[j], j, &self.coefficients)).collect()
        };
        self.left_rms = (0..self.columns.joints()).map(|j| mean_square(&left(j)).sqrt()).collect();
    }

    /// What the fit leaves of a recording, joint by joint, in Nm on the decimated rows.
    ///
    /// # Errors
    /// [`SimulationError::Preprocessing`].
    pub fn residuals(&self, recording: &Preprocessed) -> Result<Vec<Vec<f64>>, SimulationError> {
        let rows = self.rows_of(recording)?;
        let left = |(j, measured): (usize, &Vec<f64>)| self.left_over(&rows, measured, j, &self.coefficients);
        Ok(rows.measured.iter().enumerate().map(left).collect())
    }

    /// Root mean square of what the structure leaves of all recordings after the usual filters, per joint: the unit of
    /// an injected effect's strength.
    pub fn left_rms(&self) -> &[f64] {
        &self.left_rms
    }

    pub fn rows_of(&self, recording: &Preprocessed) -> Result<Rows, SimulationError> {
        let joints = self.columns.joints();
        let mut rows = Rows {
            columns: (0..joints).map(|j| vec![Vec::new(); self.columns.row(j).len()]).collect(),
            measured: vec![Vec::new(); joints],
        };
        for segment in &recording.segments {
            let kept = segment.rows();
            for (j, row) in self.columns.evaluate(segment.motion.view()).into_iter().enumerate() {
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
    pub fn fitted<'a>(
        &self,
        recordings: &[&Rows],
        measured: impl Fn(usize, usize) -> &'a Vec<f64>,
    ) -> Vec<f64> {
        let mut gram = Gram::new(self.coefficients.len());
        for (r, rows) in recordings.iter().enumerate() {
            for (j, columns) in rows.columns.iter().enumerate() {
                let weight = 1.0 / (self.left_rms[j] * self.left_rms[j]).max(1e-18);
                gram.add(self.columns.row(j), columns, measured(r, j), weight);
            }
        }
        gram.solve()
    }

    /// Residual of a joint's measurement.
    pub fn left_over(&self, rows: &Rows, measured: &[f64], joint: usize, coefficients: &[f64]) -> Vec<f64> {
        self.columns.left_over(joint, &rows.columns[joint], measured, coefficients)
    }

    /// Rigid bodies and friction from the coefficients.
    fn take_apart(&mut self) {
        self.columns.set_load(&self.coefficients);
        for j in 0..self.columns.joints() {
            [self.coulomb[j], self.viscous[j]] = self.columns.friction(j, &self.coefficients);
        }
    }
}

/// Columns after the filter that the measurement has passed, decimated as it was.
fn filtered(segment: &Segment, columns: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, SimulationError> {
    segment.filtered(columns).map_err(|error| SimulationError::Preprocessing { reason: error.to_string() })
}
