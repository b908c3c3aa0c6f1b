//! What noise and the rigid model explain of the rows, and what a gear explains beyond that.
//!
//! The positions' noise, filters, clocks and wrong inertias leave residuals that follow the motion, too. They have one thing
//! in common: at no frequency do they turn the phase sharply. A resonator does. So before a gear is judged, the residual
//! and the gear's torque are freed of
//! - M e_j q̈_j, filtered at zero phase with any gain in each of several bands: noise of the encoder of joint j
//!   (the model answers to it and the drives do not), the positions' filter, an inertia that is wrong;
//! - on each joint i its load τ_i (gain), τ̇_i (delay, a drive's lag), τ̈_i (a second-order filter, inertia behind a gear
//!   whose encoder is at the link), q̇_i and q̈_i (viscous friction, rotor inertia).

use aurt_recording::ZeroPhase;

use super::link::Gear;
use super::rows::Rows;
use crate::error::DiagnosisError;

/// Upper ends of the bands in which the gain along M e_j q̈_j is free, in units of the highest frequency of the rows.
const BANDS: [f64; 5] = [1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0, 0.75];
/// A column of which the others leave less than this share of its length is one of them.
const INDEPENDENT: f64 = 1e-6;

/// Rows of one segment, their residual freed of what each joint's own columns explain.
pub(super) struct OwnFreed {
    pub rows: Rows,
    pub target: bool,
    /// Orthonormal columns, `[joint][column][row]`.
    own: Vec<Vec<Vec<f64>>>,
    /// `[joint][row]`.
    residual: Vec<Vec<f64>>,
}

/// c·c and c·r of a gear's torque c and a residual r, block by block.
pub(super) type Moments = Vec<[f64; 2]>;

/// A segment's rows as far as a gear of one joint is concerned.
pub(super) struct Against<'a> {
    freed: &'a OwnFreed,
    joint: usize,
    /// The joints whose rows take part.
    span: Vec<usize>,
    /// Orthonormal columns over the rows of the span, `[column][place in the span][row]`.
    bands: Vec<Vec<Vec<f64>>>,
    residual: Vec<Vec<f64>>,
}

impl OwnFreed {
    pub fn new(rows: Rows, target: bool) -> Self {
        let joints = rows.white.len();
        let derivative = |series: &[f64]| -> Vec<f64> {
            let mut out = vec![0.0; series.len()];
            for k in 1..series.len().saturating_sub(1) {
                out[k] = 0.5 * rows.rate_hz * (series[k + 1] - series[k - 1]);
            }
            out
        };
        let (mut own, mut residual) = (Vec::with_capacity(joints), Vec::with_capacity(joints));
        for i in 0..joints {
            let load = &rows.load_nm[i];
            let first = derivative(load);
            let second = derivative(&first);
            let columns = [load, &first, &second, &rows.velocity_rad_s[i], &rows.acceleration_rad_s2[i]];
            let white: Vec<Vec<Vec<f64>>> =
                columns.iter().filter_map(|c| Some(vec![rows.whitened(i, c)?])).collect();
            let basis: Vec<Vec<f64>> = orthonormal(white).into_iter().flatten().collect();
            let mut left = rows.white[i].clone();
            rows.silence(i, &mut left);
            free(&mut left, &basis);
            own.push(basis);
            residual.push(left);
        }
        Self { rows, target, own, residual }
    }

    /// A series of joint i, whitened and freed of its own columns.
    fn column(&self, i: usize, series: &[f64]) -> Option<Vec<f64>> {
        let mut column = self.rows.whitened(i, series)?;
        free(&mut column, &self.own[i]);
        Some(column)
    }
}

impl<'a> Against<'a> {
    /// For gears of a joint, judged on the rows of all joints or on its own alone; `None` if its own have no noise to
    /// judge by.
    pub fn new(freed: &'a OwnFreed, joint: usize, all: bool) -> Result<Option<Self>, DiagnosisError> {
        let rows = &freed.rows;
        let judged = |i: &usize| rows.whitened(*i, &[]).is_some();
        if !judged(&joint) || rows.inertia(joint).is_none() {
            return Ok(None);
        }
        let span: Vec<usize> = if all { (0..freed.own.len()).filter(judged).collect() } else { vec![joint] };
        let acceleration = &rows.acceleration_rad_s2[joint];
        let mut filtered = vec![acceleration.clone()];
        for edge in BANDS {
            let low = ZeroPhase::butterworth(4, edge * rows.top_hz, rows.rate_hz)?;
            filtered.push(low.filter(acceleration)?);
        }
        let columns = filtered
            .iter()
            .map(|q| {
                span.iter()
                    .map(|i| freed.column(*i, &rows.along_inertia(joint, *i, q)).unwrap_or_default())
                    .collect::<Vec<_>>()
            })
            .collect();
        let bands = orthonormal(columns);
        let mut residual: Vec<Vec<f64>> = span.iter().map(|i| freed.residual[*i].clone()).collect();
        free_all(&mut residual, &bands);
        Ok(Some(Self { freed, joint, span, bands, residual }))
    }

    /// How a gear's torque goes with the residual.
    pub fn moments(&self, gear: Gear) -> Moments {
        let rows = &self.freed.rows;
        let deflection = rows.deflection(self.joint, gear);
        let mut columns: Vec<Vec<f64>> = self
            .span
            .iter()
            .map(|i| {
                self.freed.column(*i, &rows.torque(self.joint, *i, gear, &deflection)).unwrap_or_default()
            })
            .collect();
        free_all(&mut columns, &self.bands);
        let mut moments = vec![[0.0; 2]; rows.parts];
        for (column, residual) in columns.iter().zip(&self.residual) {
            for ((c, r), block) in column.iter().zip(residual).zip(&rows.block) {
                if let Some([cc, cr]) = block.map(|b| &mut moments[b]) {
                    *cc += c * c;
                    *cr += c * r;
                }
            }
        }
        moments
    }

    /// Power of the joint's own residual, block by block.
    pub fn power(&self) -> Vec<f64> {
        let mut power = vec![0.0; self.freed.rows.parts];
        let own = self.span.iter().position(|i| *i == self.joint).unwrap_or(0);
        for (r, block) in self.residual[own].iter().zip(&self.freed.rows.block) {
            if let Some(sum) = block.map(|b| &mut power[b]) {
                *sum += r * r;
            }
        }
        power
    }
}

/// Columns over several series, made orthonormal (modified Gram–Schmidt); those that the others contain are left out.
fn orthonormal(columns: Vec<Vec<Vec<f64>>>) -> Vec<Vec<Vec<f64>>> {
    let mut basis: Vec<Vec<Vec<f64>>> = Vec::with_capacity(columns.len());
    for mut column in columns {
        let before = dot(&column, &column).sqrt();
        // Twice, since columns are nearly the same at low frequencies.
        free_all(&mut column, &basis);
        free_all(&mut column, &basis);
        let length = dot(&column, &column).sqrt();
        if length > INDEPENDENT * before {
            column.iter_mut().flatten().for_each(|v| *v /= length);
            basis.push(column);
        }
    }
    basis
}

fn dot(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).sum()
}

fn free_all(column: &mut [Vec<f64>], basis: &[Vec<Vec<f64>>]) {
    for unit in basis {
        let along = dot(column, unit);
        for (c, u) in column.iter_mut().zip(unit) {
            c.iter_mut().zip(u).for_each(|(c, u)| *c -= along * u);
        }
    }
}

fn free(column: &mut [f64], basis: &[Vec<f64>]) {
    for unit in basis {
        let along: f64 = column.iter().zip(unit).map(|(c, u)| c * u).sum();
        column.iter_mut().zip(unit).for_each(|(c, u)| *c -= along * u);
    }
}
