//! What links that move against their motors ask of the drives, taken out of the measurement.

use std::sync::Arc;

use super::link::Drive;
use super::series::FullRate;
use super::{PoseColumns, Shaking, pieces};
use crate::error::DiagnosisError;
use crate::recordings::rows::Fit;
use crate::request::{Question, QuestionedRecording};

/// The torque at each joint, at a segment's own rate.
pub(super) fn torque(gear: &Shaking, full: &FullRate, gradients: &PoseColumns) -> Vec<Vec<f64>> {
    let (joint, samples) = (gear.joint, full.time_s.len());
    let (shape, inertia) = gear.simulated;
    let simulated = shape.gear(inertia);
    let rotor = simulated.rotor_kg_m2;
    let of = |at: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..samples).map(at).collect() };
    let least = super::rows::LEAST_INERTIA * inertia.mean_kg_m2;
    let deflection = simulated.deflection(&Drive {
        period_s: 1.0 / full.rate_hz,
        load_nm: &of(&|k| full.load[joint][k] - rotor * full.acceleration_rad_s2[joint][k]),
        inertia_kg_m2: &of(&|k| (full.inertia.at(joint, joint, k) - rotor).max(least)),
        gradient_nm_rad: &of(&|k| gradients.at(joint, joint, k)),
    });
    (0..full.joints())
        .map(|i| {
            of(&|k| {
                let own = if i == joint { rotor } else { 0.0 };
                (full.inertia.at(joint, i, k) - own) * deflection.acceleration_rad_s2[k]
                    + gradients.at(joint, i, k) * deflection.angle_rad[k]
            })
        })
        .collect()
}

/// Subtracts torques from series, joint by joint.
pub(super) fn take_off(torque: &[Vec<f64>], from: &mut [Vec<f64>]) {
    for (series, torque) in from.iter_mut().zip(torque) {
        series.iter_mut().zip(torque).for_each(|(s, t)| *s -= t);
    }
}

/// The recordings without what the confirmed gears among `gears` ask of the drives.
pub(crate) fn undone(
    question: &Question<'_>,
    fit: &Fit<'_>,
    inertial: &[(usize, f64)],
    gears: &[Shaking],
) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
    let mut recordings = question.recordings.to_vec();
    for piece in pieces(question, fit, inertial, |_| true)? {
        let segments = &mut Arc::make_mut(&mut recordings[piece.recording].data).data.segments;
        let same = |s: &&mut aurt_recording::Segment| {
            s.motion.view().time_s().first() == piece.segment.motion.view().time_s().first()
        };
        let Some(segment) = segments.iter_mut().find(same) else { continue };
        for gear in gears.iter().filter(|g| g.confirmed && g.present[usize::from(piece.target)]) {
            let mut torque = torque(gear, &piece.full, &piece.gradients);
            if let Some(raw) = &mut segment.raw_measurement {
                take_off(&torque, raw);
            }
            for (joint, torque) in torque.iter_mut().enumerate() {
                segment.silence(joint, 0, torque);
            }
            let filtered = segment.filtered(&torque)?;
            if let Some(measurement) = &mut segment.measurement {
                take_off(&filtered, measurement);
            }
        }
    }
    Ok(recordings)
}
