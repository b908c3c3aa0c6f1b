//! What is known of arms whose torques were recorded.

use aurt_diagnosis::Question;

use super::limits::{JointMotion, limits_of};
use super::{NextOptions, PlannedArm, rate_hz};
use crate::workbench::failure::Failure;

pub(super) fn planned_arm<'q>(
    question: &'q Question<'_>,
    options: &NextOptions,
) -> Result<PlannedArm<'q>, Failure> {
    let joints = question.model.joints();
    let segments = || question.recordings.iter().flat_map(|r| &r.data.data.segments);
    let largest = |series: &[f64], most: f64| series.iter().fold(most, |most, v| most.max(v.abs()));
    let of_joint = |j: usize| -> JointMotion {
        let motions = || segments().map(|s| s.motion.view());
        let positions = || motions().flat_map(|m| m.position_rad(j));
        let low = positions().fold(f64::INFINITY, |low, q| low.min(*q));
        let high = positions().fold(f64::NEG_INFINITY, |high, q| high.max(*q));
        let velocity = motions().fold(0.0, |v, m| largest(m.velocity_rad_s(j), v));
        ([low, high], velocity, motions().fold(0.0, |a, m| largest(m.acceleration_rad_s2(j), a)))
    };
    let shown = "positions, speeds, accelerations and torques";
    let motions = (0..joints).map(of_joint).collect();
    let (limits, mut notes) = limits_of(options, motions, question.model.names(), shown)?;
    for recording in question.recordings {
        let of_file = recording.raw.report.warnings();
        notes.extend(of_file.map(|warning| format!("{}: {warning}", recording.data.name)));
    }
    let measured = |j: usize| segments().filter_map(move |s| s.measurement.as_ref()?.get(j));
    Ok(PlannedArm {
        joint_names: question.model.names().joints.to_vec(),
        limits,
        rate_hz: rate_hz(question.recordings.last().map_or(&[][..], |r| &r.raw.time_s)),
        recorded: (0..joints).map(|j| measured(j).fold(0.0, |most, m| largest(m, most))).collect(),
        bodies: &**question.model.rigid_body(),
        unit: question.unit,
        is_of_drives: false,
        notes,
    })
}
