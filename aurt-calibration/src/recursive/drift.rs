use aurt_recording::Segment;
use aurt_traits::{ColumnGroup, LoadTorque, RobotModel};
use serde::Serialize;

use crate::{
    CalibrationError, CalibrationOptions, JointFactor, NamedRecording, Rest, System, for_each_row_block,
};

/// What a drift parameter is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DriftGroup {
    /// A joint's friction, relative to the calibrated friction.
    Friction,
    /// A joint's whole measurement, relative to the prediction.
    Gain,
    /// A body on the last link.
    Load,
}

/// A column of the drift's regressor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DriftParameter {
    /// What it is of.
    pub group: DriftGroup,
    /// The joint; none for the load.
    pub joint: Option<usize>,
    /// Name, such as `friction_2` or `payload.m_5`.
    pub name: String,
    /// Unit; 1 for relative changes.
    pub unit: String,
}

/// The machine as it was calibrated.
///
/// The drift of joint j's rows is e_j = y_j − ŷ_j = φ_j f_j + γ_j ŷ_j + P_j m, where ŷ = W ζ₀ is the prediction of the
/// calibrated coefficients, f_j the part of the joint's friction stack in it, and P the columns of a load.
#[derive(Debug, Clone, Copy)]
pub struct DriftReference<'a> {
    /// The calibrated model; columns beyond the calibrated coefficients are those of a load.
    pub model: &'a RobotModel,
    /// ζ₀.
    pub coefficients: &'a [f64],
    /// Load torque, with a weight for every column of the model.
    pub load: &'a LoadTorque,
    /// Which rows count.
    pub options: &'a CalibrationOptions,
}

/// What some seconds of a recording say of the drift.
#[derive(Debug, Clone)]
pub struct DriftWindow {
    /// From the first stamp of the recording, s.
    pub start_s: f64,
    /// How long it is, s.
    pub duration_s: f64,
    /// Whether it is as long as windows should be; a segment that is too short for one is a shorter window.
    pub whole: bool,
    /// One factor per joint over the drift parameters.
    pub system: System,
}

impl DriftReference<'_> {
    /// The columns: friction of each joint, gain of each joint, load.
    pub fn parameters(&self) -> Vec<DriftParameter> {
        let joints = self.model.joints();
        let relative = |group, what: &str, joint: usize| DriftParameter {
            group,
            joint: Some(joint),
            name: format!("{what}_{joint}"),
            unit: "1".into(),
        };
        let load = self.model.parameters()[self.coefficients.len()..].iter().map(|p| DriftParameter {
            group: DriftGroup::Load,
            joint: None,
            name: p.name.clone(),
            unit: p.unit.clone(),
        });
        (0..joints)
            .map(|j| relative(DriftGroup::Friction, "friction", j))
            .chain((0..joints).map(|j| relative(DriftGroup::Gain, "gain", j)))
            .chain(load)
            .collect()
    }

    /// The drift parameters in each joint's rows.
    pub fn columns(&self) -> Vec<Vec<usize>> {
        let (joints, known) = (self.model.joints(), self.coefficients.len());
        let load = |joint: usize| self.model.row_columns(joint).iter().filter(move |c| **c >= known);
        (0..joints)
            .map(|j| [j, joints + j].into_iter().chain(load(j).map(|c| c - known + 2 * joints)).collect())
            .collect()
    }
}

/// How recordings are cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Length of a window, about, s.
    pub window_s: f64,
    /// Only what lies between these stamps, s; the second does not belong to it. What lies around is there for the
    /// filters to settle.
    pub span_s: [f64; 2],
    /// The stamp from which the starts of windows count, s; none: the first of the recording.
    pub origin_s: Option<f64>,
}

impl Cut {
    /// Whole recordings.
    pub const fn whole(window_s: f64) -> Self {
        Self { window_s, span_s: [f64::NEG_INFINITY, f64::INFINITY], origin_s: None }
    }
}

/// A recording in windows of about `cut.window_s` seconds, which divide each segment evenly, as triangles over the drift
/// parameters, of the rows of all joints but `left_out`.
///
/// # Errors
/// [`CalibrationError::Joints`], [`CalibrationError::NoMeasurement`], and what models report.
pub fn drift_windows(
    reference: &DriftReference<'_>,
    recording: &NamedRecording,
    left_out: &[usize],
    cut: Cut,
) -> Result<Vec<DriftWindow>, CalibrationError> {
    crate::rows::check(reference.model, std::slice::from_ref(recording))?;
    let start_s = |segment: &Segment| segment.motion.view().time_s().first().copied();
    let first_s = recording.data.segments.first().and_then(start_s).unwrap_or(0.0);
    let cut = Cut { origin_s: cut.origin_s.or(Some(first_s)), ..cut };
    let mut windows = Vec::new();
    for segment in &recording.data.segments {
        windows_of_segment(reference, segment, left_out, cut, &mut windows)?;
    }
    Ok(windows)
}

fn windows_of_segment(
    reference: &DriftReference<'_>,
    segment: &Segment,
    left_out: &[usize],
    cut: Cut,
    windows: &mut Vec<DriftWindow>,
) -> Result<(), CalibrationError> {
    let (model, known, options) = (reference.model, reference.coefficients, reference.options);
    let (time_s, Some(measurement)) = (segment.motion.view().time_s(), &segment.measurement) else {
        return Ok(());
    };
    let (parameters, columns) = (reference.parameters().len(), reference.columns());
    if segment.rows() == 0 || time_s.is_empty() {
        return Ok(());
    }
    let at = |row: usize| time_s[segment.sample(row)];
    let row_s = if segment.rows() > 1 { at(1) - at(0) } else { 0.0 };
    let mut inside = 0..segment.rows();
    while !inside.is_empty() && at(inside.start) < cut.span_s[0] {
        inside.start += 1;
    }
    while !inside.is_empty() && at(inside.end - 1) >= cut.span_s[1] {
        inside.end -= 1;
    }
    if inside.is_empty() {
        return Ok(());
    }
    let start_s = at(inside.start);
    let segment_s = at(inside.end - 1) + row_s - start_s;
    let fitting = ((segment_s / cut.window_s + 0.25) as usize).min(inside.len());
    let duration_s = segment_s / fitting.max(1) as f64;
    let window_of = |row: usize| ((row - inside.start) * fitting.max(1)) / inside.len();
    let first = windows.len();
    for window in 0..fitting.max(1) {
        windows.push(DriftWindow {
            start_s: start_s - cut.origin_s.unwrap_or(0.0) + window as f64 * duration_s,
            duration_s,
            whole: fitting > 0,
            system: System::new(parameters, columns.iter().cloned().map(JointFactor::new).collect()),
        });
    }
    for_each_row_block(model, segment, reference.load, |block| {
        for joint in (0..model.joints()).filter(|joint| !left_out.contains(joint)) {
            let friction = model.group(ColumnGroup::JointDynamics(joint));
            let mut left = block.measurement(&measurement[joint]).to_vec();
            let (mut rubbed, mut predicted) = (vec![0.0; block.rows], vec![0.0; block.rows]);
            let mut load = Vec::new();
            for (slot, column) in model.row_slots(joint).zip(model.row_columns(joint)) {
                let values = block.column(slot);
                let Some(coefficient) = known.get(*column) else {
                    load.push(values);
                    continue;
                };
                let is_friction = friction.contains(column);
                for (row, value) in values.iter().enumerate() {
                    let part = coefficient * value;
                    predicted[row] += part;
                    if is_friction {
                        rubbed[row] += part;
                    }
                }
            }
            left.iter_mut().zip(&predicted).for_each(|(y, p)| *y -= p);
            let column = |k: usize| match k {
                0 => rubbed.as_slice(),
                1 => predicted.as_slice(),
                _ => load[k - 2],
            };
            let own = block.first_row.max(inside.start)..(block.first_row + block.rows).min(inside.end);
            if own.is_empty() {
                continue;
            }
            let rest = options.rest_velocity(&**model.rigid_body(), joint);
            for window in window_of(own.start)..=window_of(own.end - 1) {
                windows[first + window].system.factors_mut()[joint].push(column, &left, |row| {
                    let at = block.first_row + row;
                    own.contains(&at)
                        && window_of(at) == window
                        && (options.rest == Rest::Keep || block.speed(segment, joint, row) > rest)
                });
            }
        }
    })
}
