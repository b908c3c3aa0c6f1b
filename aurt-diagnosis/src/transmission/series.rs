use aurt_calibration::for_each_tile;
use aurt_recording::{PositionNoise, Segment};
use aurt_traits::{ColumnGroup, MotionView};

use crate::error::DiagnosisError;
use crate::noise::pose::PoseColumns;
use crate::recordings::rows::Fit;

/// What a fitted model leaves of a segment at the recording's own rate, before any filter, joint by joint.
#[derive(Debug, Clone)]
pub struct FullRate {
    /// Samples per second.
    pub rate_hz: f64,
    /// Stamps, s.
    pub time_s: Vec<f64>,
    /// Measured less predicted.
    pub residual: Vec<Vec<f64>>,
    /// The part of the prediction that the rigid bodies need: the torque that the gear transmits.
    pub load: Vec<Vec<f64>>,
    /// Acceleration of the motors, rad/s².
    pub acceleration_rad_s2: Vec<Vec<f64>>,
    /// Whether a joint moves, and neither it has just reversed, started or stopped nor is about to.
    pub calm: Vec<Vec<bool>>,
    /// Inertia along the motion.
    pub inertia: PoseColumns,
}

/// A segment at full rate, with the recording that it belongs to.
#[derive(Debug, Clone)]
pub(super) struct Piece<'a> {
    pub recording: usize,
    pub target: bool,
    pub segment: &'a Segment,
    pub full: FullRate,
    pub gradients: PoseColumns,
    pub position_cutoff_hz: f64,
    /// The positions' noise as recorded, joint by joint.
    pub noise: Vec<PositionNoise>,
}

/// A joint rests below this speed, rad/s.
const REST_RAD_S: f64 = 0.01;
/// Dry friction that changes its sign shakes its own joint for this time before (the filtered motion is not exact)
/// and after, s …
const OWN_S: f64 = 0.07;
/// … and other joints for this time, s.
const OTHERS_S: f64 = 0.04;
/// The inertia matrix is evaluated this often, s.
const INERTIA_STEP_S: f64 = 0.02;

impl FullRate {
    /// Evaluates a model over a segment; `None` if it has no measurement of its own rate.
    ///
    /// # Errors
    /// What the model reports.
    pub fn evaluate(
        segment: &Segment,
        fit: &Fit<'_>,
        inertial: &[(usize, f64)],
    ) -> Result<Option<Self>, DiagnosisError> {
        let Some(measured) = &segment.raw_measurement else { return Ok(None) };
        let motion = segment.motion.view();
        let (samples, joints) = (motion.samples(), fit.model.joints());
        let rigid = fit.model.group(ColumnGroup::RigidBody);
        let mut residual: Vec<Vec<f64>> = measured.iter().map(|m| m[..samples].to_vec()).collect();
        let mut load = vec![vec![0.0; samples]; joints];
        for_each_tile(fit.model, segment, fit.load, |start, tile| {
            for joint in 0..joints {
                let span = start..start + tile.samples();
                let (left, transmitted) = (&mut residual[joint][span.clone()], &mut load[joint][span]);
                for (slot, column) in fit.model.row_slots(joint).zip(fit.model.row_columns(joint)) {
                    let coefficient = fit.coefficients[*column];
                    if coefficient == 0.0 {
                        continue;
                    }
                    for (l, value) in left.iter_mut().zip(tile.slot(slot)) {
                        *l -= coefficient * value;
                    }
                    if rigid.contains(column) {
                        for (t, value) in transmitted.iter_mut().zip(tile.slot(slot)) {
                            *t += coefficient * value;
                        }
                    }
                }
            }
        })?;
        let step = ((INERTIA_STEP_S * segment.rate_hz).round() as usize).max(1);
        Ok(Some(Self {
            rate_hz: segment.rate_hz,
            time_s: motion.time_s().to_vec(),
            residual,
            load,
            acceleration_rad_s2: (0..joints).map(|j| motion.acceleration_rad_s2(j).to_vec()).collect(),
            calm: calm(motion, segment.rate_hz),
            inertia: PoseColumns::inertia(&**fit.model.rigid_body(), inertial, motion, step)?,
        }))
    }

    /// The same with a noise of accelerations beside the motion, `[joint][sample]`, times a factor.
    pub(super) fn beside(&self, noise: &[Vec<f64>], factor: f64) -> Self {
        let mut beside = self.clone();
        for (j, noise) in noise.iter().enumerate() {
            beside.acceleration_rad_s2[j].iter_mut().zip(noise).for_each(|(a, n)| *a += factor * n);
            for i in 0..self.joints() {
                for (k, n) in noise.iter().enumerate() {
                    let torque = factor * self.inertia.at(j, i, k) * n;
                    beside.load[i][k] += torque;
                    beside.residual[i][k] -= torque;
                }
            }
        }
        beside
    }

    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.residual.len()
    }
}

fn calm(motion: MotionView<'_>, rate_hz: f64) -> Vec<Vec<bool>> {
    let (samples, joints) = (motion.samples(), motion.joints());
    let mut calm = vec![vec![true; samples]; joints];
    let reach = |seconds: f64| (seconds * rate_hz).ceil() as usize;
    for joint in 0..joints {
        let velocity = motion.velocity_rad_s(joint);
        let rests = |k: usize| velocity[k].abs() < REST_RAD_S;
        (0..samples).filter(|k| rests(*k)).for_each(|k| calm[joint][k] = false);
        for k in jolts(velocity) {
            for (other, series) in calm.iter_mut().enumerate() {
                let reach = reach(if other == joint { OWN_S } else { OTHERS_S });
                series[k.saturating_sub(reach)..(k + reach).min(samples)].fill(false);
            }
        }
    }
    calm
}

/// Samples at which the dry friction of a joint jumps: it starts, stops or turns. While a joint rests, noise changes the sign of its
/// velocity, and no friction with it; where it moves on in the other direction, it has turned at the last of these changes.
fn jolts(velocity: &[f64]) -> Vec<usize> {
    let rests = |k: usize| velocity[k].abs() < REST_RAD_S;
    let mut found = Vec::new();
    let mut crossing = None;
    let mut direction = 0.0;
    for k in 0..velocity.len() {
        if k > 0 && velocity[k] * velocity[k - 1] < 0.0 {
            crossing = Some(k);
        }
        if !rests(k) {
            if direction * velocity[k] < 0.0 {
                found.extend(crossing);
            }
            direction = velocity[k];
        }
        if k > 0 && rests(k) != rests(k - 1) {
            found.push(k);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_traits::Motion;

    #[test]
    fn friction_jumps_where_a_joint_starts_stops_or_turns_and_not_where_its_velocity_is_noise() {
        let noise = |n: usize| (0..n).map(|k| [2e-3, -2e-3][k % 2]);
        let of = |parts: &[&[f64]]| jolts(&parts.concat());
        let (rest, on, back) = (noise(40).collect::<Vec<_>>(), vec![0.1; 20], vec![-0.1; 20]);
        assert_eq!(of(&[&rest]), [0; 0]);
        assert_eq!(of(&[&rest, &on, &back]), [40, 60]);
        assert_eq!(of(&[&on, &rest, &on]), [20, 60]);
        // A slow turn is in the middle of its rest.
        let slow: Vec<f64> = (0..=40).map(|k| 0.0099 - 0.0005 * f64::from(k)).collect();
        assert_eq!(of(&[&on, &slow, &back]), [20, 40, 60]);
        assert_eq!(of(&[&on, &rest, &back]), [20, 59, 60]);
    }

    #[test]
    fn noise_of_a_joint_at_rest_shakes_no_other_joint() {
        let samples = 500;
        let time_s: Vec<f64> = (0..samples).map(|k| k as f64 / 500.0).collect();
        // Joint 0 moves on; joint 1 rests until it starts at sample 400.
        let of_second = |k: usize| if k < 400 { [2e-3, -2e-3][k % 2] } else { 0.1 };
        let velocity = (0..samples).map(|_| 0.5).chain((0..samples).map(of_second)).collect();
        let still = vec![0.0; 2 * samples];
        let motion = Motion::new(2, time_s, still.clone(), velocity, still).unwrap();
        let calm = calm(motion.view(), 500.0);
        assert!(calm[0][..380].iter().chain(&calm[0][420..]).all(|c| *c));
        assert!(calm[0][380..420].iter().all(|c| !c));
    }
}
