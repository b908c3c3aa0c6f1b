use aurt_calibration::{Rest, for_each_row_block, for_each_tile, speed_of};
use aurt_recording::{DecimatedTile, Preprocessed, Segment};
use aurt_traits::{ColumnGroup, LoadTorque, RobotModel};
use serde::{Deserialize, Serialize};

use crate::error::DiagnosisError;

/// What part a recording takes in a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The model's structure is calibrated on it.
    Calibration,
    /// The question is what it shows beyond the model.
    Target,
    /// Takes no part in selection or fitting; supplies the reported improvement.
    Validation,
}

impl Role {
    /// The role as experiments spell it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calibration => "calibration",
            Self::Target => "target",
            Self::Validation => "validation",
        }
    }
}

/// The filtered, decimated rows of one recording, joint by joint, over all columns of a robot model.
#[derive(Debug, Clone)]
pub struct RecordingRows {
    pub name: String,
    /// Its part.
    pub role: Role,
    /// Rows per second.
    pub rate_hz: f64,
    pub time_s: Vec<f64>,
    /// First row of each segment, and the number of rows at the end.
    pub segment_starts: Vec<usize>,
    pub joints: Vec<JointRows>,
}

/// Which columns each joint's rows have: those of the robot model, then instrument columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// Number of coefficients.
    pub coefficients: usize,
    /// The coefficients of each joint's row, in the order of its columns.
    pub rows: Vec<Vec<usize>>,
    /// First instrument coefficient; see [`Layout::instrument`].
    pub first_instrument: usize,
}

/// A column that is made of the baseline's own prediction ŷ_j.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Instrument {
    /// ŷ_j: its coefficient is a gain error.
    Gain,
    /// −dτ_j/dt of the rigid bodies' part τ_j of ŷ_j: its coefficient is a delay of the measurement in s. One clock
    /// stamps all joints, so they share one coefficient. Friction is left out: its step at a reversal is smeared by
    /// filters and by presliding, which looks like a delay.
    Delay,
    /// The same of the whole of ŷ_j.
    DelayOfAll,
}

impl Instrument {
    /// All of them, in column order.
    pub const ALL: [Self; 3] = [Self::Gain, Self::Delay, Self::DelayOfAll];

    /// Those of which each joint has its own coefficient.
    const OWN: usize = 1;
}

impl Layout {
    /// The layout of a model's rows followed by the instrument columns of each joint.
    pub fn new(model: &RobotModel) -> Self {
        let first = model.parameters().len();
        let joints = model.joints();
        let rows = (0..joints)
            .map(|j| {
                let mut row = model.row_columns(j).to_vec();
                row.extend(Instrument::ALL.map(|which| Self::instrument_after(first, joints, j, which)));
                row
            })
            .collect();
        Self { coefficients: first + joints * Instrument::OWN + 2, rows, first_instrument: first }
    }

    /// The coefficient of an instrument column.
    pub const fn instrument(&self, joint: usize, which: Instrument) -> usize {
        Self::instrument_after(self.first_instrument, self.rows.len(), joint, which)
    }

    const fn instrument_after(first: usize, joints: usize, joint: usize, which: Instrument) -> usize {
        match which {
            Instrument::Gain => first + joint * Instrument::OWN,
            Instrument::Delay => first + joints * Instrument::OWN,
            Instrument::DelayOfAll => first + joints * Instrument::OWN + 1,
        }
    }
}

#[derive(Debug, Clone, Default)]
pub struct JointRows {
    /// Row values, column after column in the order of [`Layout::rows`].
    pub data: Vec<f64>,
    /// Measurement (less what a frozen model or another simulator predicts).
    pub measurement: Vec<f64>,
    /// Angle at each row, rad.
    pub position_rad: Vec<f64>,
    pub velocity_rad_s: Vec<f64>,
    pub acceleration_rad_s2: Vec<f64>,
    /// Whether each row counts: it does not while the joint stands, where the sign of its velocity is that of
    /// noise. Rows that do not count are zero.
    pub counts: Vec<bool>,
    /// The joint stands where it stays below this |q̇|, rad/s, or m/s of one that slides.
    pub rest_velocity: f64,
}

impl RecordingRows {
    /// Evaluates `model` over a recording's segments. Rows of a joint that stands do not count.
    ///
    /// # Errors
    /// If a segment has no measurement, or a model fails.
    pub fn evaluate(
        name: &str,
        role: Role,
        data: &Preprocessed,
        model: &RobotModel,
        load: &LoadTorque,
        baseline: &Fit<'_>,
    ) -> Result<Self, DiagnosisError> {
        Ok(Self::evaluate_all(name, role, data, model, load, Some(baseline))?.of_motion())
    }

    /// The rows of a fitted model itself, whose instrument columns are left at zero.
    ///
    /// # Errors
    /// If a segment has no measurement, or a model fails.
    pub fn of_model(
        name: &str,
        role: Role,
        data: &Preprocessed,
        fit: &Fit<'_>,
    ) -> Result<Self, DiagnosisError> {
        Ok(Self::evaluate_all(name, role, data, fit.model, fit.load, None)?.of_motion())
    }

    /// The same as [`Self::evaluate`] of the rows in which a joint stands: these count, and no others do. Of the model's
    /// columns only those of the `wanted` coefficients are made. `None` where the joints never all stand.
    pub(crate) fn evaluate_standing(
        name: &str,
        role: Role,
        data: &Preprocessed,
        (model, load): (&RobotModel, &LoadTorque),
        baseline: &Fit<'_>,
        wanted: &dyn Fn(usize) -> bool,
    ) -> Result<Option<Self>, DiagnosisError> {
        let rest = |j| speed_of(&**model.rigid_body(), j, STANDING_RAD_S);
        let of_joint = |j| stands(&velocity(data, j), rest(j), row_rate_hz(data));
        let stands: Vec<Vec<bool>> = (0..model.joints()).map(of_joint).collect();
        let count = stands.first().map_or(0, Vec::len);
        if !(0..count).any(|k| stands.iter().all(|joint| joint[k])) {
            return Ok(None);
        }
        let mut whole = data.clone();
        for segment in whole.segments.iter_mut().filter(|s| s.left_out.is_some()) {
            segment.leave_out(None)?;
        }
        let mut rows = Self::evaluate_columns(name, role, &whole, (model, load), Some(baseline), wanted)?;
        for (joint, stands) in rows.joints.iter_mut().zip(stands) {
            joint.counts = stands;
        }
        Ok(Some(rows))
    }

    /// Rows of a joint that stands do not count.
    fn of_motion(mut self) -> Self {
        for joint in &mut self.joints {
            let stands = stands(&joint.velocity_rad_s, joint.rest_velocity, self.rate_hz);
            joint.counts = stands.into_iter().map(|stands| !stands).collect();
            joint.silence();
        }
        self
    }

    fn evaluate_all(
        name: &str,
        role: Role,
        data: &Preprocessed,
        model: &RobotModel,
        load: &LoadTorque,
        baseline: Option<&Fit<'_>>,
    ) -> Result<Self, DiagnosisError> {
        Self::evaluate_columns(name, role, data, (model, load), baseline, &|_| true)
    }

    fn evaluate_columns(
        name: &str,
        role: Role,
        data: &Preprocessed,
        (model, load): (&RobotModel, &LoadTorque),
        baseline: Option<&Fit<'_>>,
        wanted: &dyn Fn(usize) -> bool,
    ) -> Result<Self, DiagnosisError> {
        let rows: usize = data.segments.iter().map(Segment::rows).sum();
        let mut joints: Vec<JointRows> = (0..model.joints())
            .map(|j| {
                let columns =
                    model.row_columns(j).iter().filter(|c| wanted(**c)).count() + Instrument::ALL.len();
                let rest_velocity = speed_of(&**model.rigid_body(), j, STANDING_RAD_S);
                JointRows { data: vec![0.0; rows * columns], rest_velocity, ..JointRows::default() }
            })
            .collect();
        let mut time_s = Vec::with_capacity(rows);
        let mut segment_starts = vec![0];
        for segment in &data.segments {
            let first = time_s.len();
            let motion = segment.motion.view();
            time_s.extend(segment.at_rows(motion.time_s()));
            let measurement = segment
                .measurement
                .as_ref()
                .ok_or_else(|| DiagnosisError::NoMeasurement { recording: name.to_owned() })?;
            for (j, joint) in joints.iter_mut().enumerate() {
                joint.measurement.extend_from_slice(&measurement[j]);
                joint.position_rad.extend(segment.at_rows(motion.position_rad(j)));
                joint.velocity_rad_s.extend(segment.at_rows(motion.velocity_rad_s(j)));
                joint.acceleration_rad_s2.extend(segment.at_rows(motion.acceleration_rad_s2(j)));
            }
            for_each_row_block(model, segment, load, |block| {
                for (j, joint) in joints.iter_mut().enumerate() {
                    let slots = model.row_slots(j).zip(model.row_columns(j));
                    for (k, (slot, _)) in slots.filter(|(_, column)| wanted(**column)).enumerate() {
                        let start = k * rows + first + block.first_row;
                        joint.data[start..start + block.rows].copy_from_slice(block.column(slot));
                    }
                }
            })?;
            if let Some(baseline) = baseline {
                let mut columns: Vec<&mut [f64]> = joints
                    .iter_mut()
                    .map(|joint| {
                        let own = joint.data.len() - Instrument::ALL.len() * rows;
                        &mut joint.data[own..]
                    })
                    .collect();
                instrument_rows(segment, baseline, &mut columns, rows, first)?;
            }
            segment_starts.push(time_s.len());
        }
        let rate_hz = row_rate_hz(data);
        Ok(Self { name: name.to_owned(), role, rate_hz, time_s, segment_starts, joints })
    }

    /// Number of rows per joint.
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }
}

/// The model that is questioned, fitted.
#[derive(Debug, Clone, Copy)]
pub struct Fit<'a> {
    /// Its structure.
    pub model: &'a RobotModel,
    pub load: &'a LoadTorque,
    pub coefficients: &'a [f64],
}

/// Rows per second.
fn row_rate_hz(data: &Preprocessed) -> f64 {
    data.segments.last().map_or(1.0, |s| s.rate_hz / s.decimation as f64)
}

/// A joint's velocity at each row, rad/s.
fn velocity(data: &Preprocessed, joint: usize) -> Vec<f64> {
    data.segments.iter().flat_map(|s| s.at_rows(s.motion.view().velocity_rad_s(joint))).collect()
}

/// Where a joint stays below the rest velocity for some time.
fn stands(velocity: &[f64], rest_velocity: f64, rate_hz: f64) -> Vec<bool> {
    let shortest = (STANDING_S * rate_hz).ceil().max(2.0) as usize;
    let slow: Vec<bool> = velocity.iter().map(|v| v.abs() < rest_velocity).collect();
    let mut stands = vec![false; slow.len()];
    let mut start = 0;
    while start < slow.len() {
        let length = slow[start..].iter().take_while(|s| **s).count();
        if length >= shortest {
            stands[start..start + length].fill(true);
        }
        start += length.max(1);
    }
    stands
}

/// Writes the instrument columns of all joints: the prediction and its time derivatives, taken at the
/// recording's own rate and then filtered and decimated like every other column. A joint's columns are `rows` long; the
/// segment's begin at `first`.
fn instrument_rows(
    segment: &Segment,
    fit: &Fit<'_>,
    columns: &mut [&mut [f64]],
    rows: usize,
    first: usize,
) -> Result<(), DiagnosisError> {
    const EACH: usize = Instrument::ALL.len();
    let samples = segment.motion.samples();
    let joints = columns.len();
    let rigid = fit.model.group(ColumnGroup::RigidBody);
    let mut series = vec![0.0; EACH * joints * samples];
    let mut load = vec![0.0; joints * samples];
    for_each_tile(fit.model, segment, fit.load, |start, tile| {
        for joint in 0..joints {
            let at = |series: usize| series * samples + start..series * samples + start + tile.samples();
            for (slot, column) in fit.model.row_slots(joint).zip(fit.model.row_columns(joint)) {
                let coefficient = fit.coefficients[*column];
                if coefficient == 0.0 {
                    continue;
                }
                for (o, value) in series[at(EACH * joint)].iter_mut().zip(tile.slot(slot)) {
                    *o += coefficient * value;
                }
                if rigid.contains(column) {
                    for (o, value) in load[at(joint)].iter_mut().zip(tile.slot(slot)) {
                        *o += coefficient * value;
                    }
                }
            }
        }
    })?;
    for (series, load) in
        series.chunks_exact_mut(EACH * samples.max(1)).zip(load.chunks_exact(samples.max(1)))
    {
        let (prediction, delays) = series.split_at_mut(samples);
        let (delay, delay_of_all) = delays.split_at_mut(samples);
        for k in 1..samples.saturating_sub(1) {
            delay_of_all[k] = -(prediction[k + 1] - prediction[k - 1]) * 0.5 * segment.rate_hz;
            delay[k] = -(load[k + 1] - load[k - 1]) * 0.5 * segment.rate_hz;
        }
    }
    for (column, values) in series.chunks_exact_mut(samples.max(1)).enumerate() {
        segment.silence(column / EACH, 0, values);
    }
    let mut bank = segment.bank(EACH * joints);
    let mut write = |tile: DecimatedTile<'_>| {
        for k in 0..EACH * joints {
            let to = k % EACH * rows + first + tile.first_row();
            columns[k / EACH][to..to + tile.rows()].copy_from_slice(tile.column(k));
        }
    };
    bank.push(&series, samples, samples, &mut write);
    Ok(bank.finish(&mut write)?)
}

/// A joint stands if it stays below this speed ([`speed_of`]), rad/s …
const STANDING_RAD_S: f64 = 0.03;

/// … for at least this time, s. Reversals are shorter.
const STANDING_S: f64 = 0.4;

impl JointRows {
    /// Sets the rows that do not count to zero.
    pub fn silence(&mut self) {
        let rows = self.counts.len();
        for (k, _) in self.counts.iter().enumerate().filter(|(_, c)| !**c) {
            self.measurement[k] = 0.0;
            self.data.iter_mut().skip(k).step_by(rows.max(1)).for_each(|v| *v = 0.0);
        }
    }

    /// Number of rows in `start..end` that count.
    pub fn counted(&self, start: usize, end: usize) -> f64 {
        self.counts[start..end].iter().filter(|c| **c).count() as f64
    }

    /// Share of the rows in which the joint stands, and which do not count therefore.
    pub(crate) fn standing_share(&self) -> f64 {
        let rows = self.counts.iter().zip(&self.velocity_rad_s);
        let stands = rows.filter(|(counts, v)| !**counts && v.abs() < self.rest_velocity).count();
        stands as f64 / self.counts.len().max(1) as f64
    }

    /// True for a joint that moves, and that stands for so many rows that these should not be kept.
    pub(crate) fn stands_long(&self) -> bool {
        self.counts.contains(&true) && self.standing_share() > Rest::MOST_KEPT
    }

    /// Column `k` of the joint's row columns.
    pub fn column(&self, k: usize) -> &[f64] {
        let rows = self.measurement.len();
        &self.data[k * rows..(k + 1) * rows]
    }

    /// y − Σ coefficient · column, `coefficients` in the order of the joint's row columns.
    pub fn residual(&self, coefficients: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut residual = self.measurement.clone();
        for (k, coefficient) in coefficients.enumerate().filter(|(_, c)| *c != 0.0) {
            for (r, value) in residual.iter_mut().zip(self.column(k)) {
                *r -= coefficient * value;
            }
        }
        residual
    }
}

/// Rows per second, mean over the rows of all recordings.
pub(crate) fn mean_rate_hz(recordings: &[RecordingRows]) -> f64 {
    let rows = |r: &RecordingRows| r.rows() as f64;
    let weighted: f64 = recordings.iter().map(|r| rows(r) * r.rate_hz).sum();
    weighted / recordings.iter().map(rows).sum::<f64>().max(1.0)
}

/// Share of independent values in a residual: 1 / (1 + 2 Σ ρ_k), ρ_k its autocorrelation up to where it first
/// falls below 0.05 (at most `longest` lags).
pub fn independent_share(residual: &[f64], longest: usize) -> f64 {
    let n = residual.len();
    if n < 4 {
        return 1.0;
    }
    let mean = residual.iter().sum::<f64>() / n as f64;
    let power: f64 = residual.iter().map(|r| (r - mean).powi(2)).sum();
    if power == 0.0 {
        return 1.0;
    }
    let mut sum = 0.0;
    for lag in 1..longest.min(n / 2) {
        let product: f64 =
            residual[..n - lag].iter().zip(&residual[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum();
        let correlation = product / power;
        if correlation < 0.05 {
            break;
        }
        sum += correlation;
    }
    1.0 / (1.0 + 2.0 * sum)
}
