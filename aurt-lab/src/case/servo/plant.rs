//! Servo arms simulated from commands.

use aurt_rbd::RbdError;
use aurt_simulation::Random;

use super::arm::{Servo, ServoArm};
use super::motion::STREAM_S;

const STEP_S: f64 = 2.5e-4;
/// Steps between two runs of the firmware, 1 ms.
const FIRMWARE: usize = 4;
/// Mean wait of a command for the firmware, half of that time, from the step on in which it is logged.
pub(super) const WAITS_S: f64 = 0.5 * (FIRMWARE - 1) as f64 * STEP_S;
const TICK_RAD: f64 = std::f64::consts::TAU / 4096.0;
/// How much the host's clock jitters, and how wrong its stamps are, in s.
const JITTER_S: (f64, f64) = (0.001, 1e-4);
const NOISE_TICKS: f64 = 0.3;
/// How far bristles bend before a joint slides, in rad.
const BEND_RAD: f64 = 5e-4;

/// What the logger writes, row by row.
#[derive(Debug, Clone, Default)]
pub(super) struct Recorded {
    pub time_s: Vec<f64>,
    pub command_rad: Vec<Vec<f64>>,
    pub position_rad: Vec<Vec<f64>>,
    pub true_rad: Vec<Vec<f64>>,
}

/// A joint while it is simulated.
#[derive(Debug, Clone, Copy, Default)]
struct Moving {
    q: f64,
    qd: f64,
    bristle: f64,
    encoder: f64,
    reference: f64,
    duty: f64,
}

impl Servo {
    /// What the firmware asks for: once a millisecond, from encoder ticks.
    fn firmware(&self, joint: &mut Moving, command: f64) {
        let most = self.speed_limit_rad_s * STEP_S * FIRMWARE as f64;
        joint.reference += (command - joint.reference).clamp(-most, most);
        let error = joint.reference - (joint.encoder / TICK_RAD).round() * TICK_RAD;
        let beyond = error - error.clamp(-self.dead_band_rad, self.dead_band_rad);
        joint.duty = (self.gain_nm_per_rad * beyond).clamp(-self.torque_limit_nm, self.torque_limit_nm);
    }

    /// Dry friction of bristles that bend and then slide.
    fn friction_nm(&self, joint: &mut Moving, load_nm: f64) -> f64 {
        let slow = joint.qd / self.stribeck_velocity_rad_s;
        let slides = self.coulomb_nm
            + self.coulomb_per_load * load_nm.abs()
            + self.static_nm * libm::exp(-slow * slow);
        let stiffness = (slides / BEND_RAD).max(1.0);
        let most = slides / stiffness;
        joint.bristle = (joint.bristle + joint.qd * STEP_S).clamp(-most, most);
        let sticks = joint.bristle.abs() < most;
        let damping = (stiffness * self.rotor_inertia_kg_m2).sqrt();
        stiffness * joint.bristle + if sticks { damping * joint.qd } else { 0.0 }
    }
}

/// Simulates an arm from streams of commands, one for each joint; it starts at rest at the first of them.
pub(super) fn simulate(arm: &ServoArm, streams: &[Vec<f64>], seed: u64) -> Result<Recorded, RbdError> {
    let mut random = Random::labelled(seed, "logger");
    let mut dynamics = arm.dynamics()?;
    let n = arm.servos.len();
    let begin = |stream: &Vec<f64>| Moving {
        q: stream[0],
        encoder: stream[0],
        reference: stream[0],
        ..Moving::default()
    };
    let mut joints: Vec<Moving> = streams.iter().map(begin).collect();
    // When the host sends, logs and reads.
    let rows = streams.iter().map(Vec::len).min().unwrap_or(0);
    let sends_s: Vec<f64> = (0..rows)
        .map(|k| {
            k as f64 * STREAM_S + if k > 0 { (JITTER_S.0 * random.normal()).clamp(-5e-3, 5e-3) } else { 0.0 }
        })
        .collect();
    let sent = |joint: usize, t: f64| streams[joint][sends_s.partition_point(|s| *s <= t).max(1) - 1];
    let series = || vec![Vec::new(); n];
    let mut recorded =
        Recorded { command_rad: series(), position_rad: series(), true_rad: series(), ..Recorded::default() };
    let (mut bias, mut torque, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let steps = (rows as f64 * STREAM_S / STEP_S) as usize;
    for k in 0..steps {
        let t = k as f64 * STEP_S;
        for (joint, servo) in joints.iter_mut().zip(&arm.servos) {
            joint.encoder = joint.encoder.clamp(joint.q - servo.play_rad, joint.q + servo.play_rad);
        }
        let row = recorded.time_s.len();
        if row < rows && t >= sends_s[row] {
            recorded.time_s.push(t + JITTER_S.1 * random.normal());
            for (j, joint) in joints.iter().enumerate() {
                let ticks = (joint.encoder / TICK_RAD + NOISE_TICKS * random.normal()).round();
                recorded.command_rad[j].push(streams[j][row]);
                recorded.position_rad[j].push(ticks * TICK_RAD);
                recorded.true_rad[j].push(joint.encoder);
            }
        }
        if k % FIRMWARE == 0 {
            for (j, (joint, servo)) in joints.iter_mut().zip(&arm.servos).enumerate() {
                servo.firmware(joint, sent(j, t - servo.delay_s));
            }
        }
        let drawn: f64 = joints.iter().map(|j| j.duty.abs()).sum();
        let supply = (1.0 - arm.sag_per_nm * drawn).max(0.1);
        let q: Vec<f64> = joints.iter().map(|j| j.q).collect();
        let qd: Vec<f64> = joints.iter().map(|j| j.qd).collect();
        dynamics.bias_torque(&q, &qd, &mut bias);
        for (j, (joint, servo)) in joints.iter_mut().zip(&arm.servos).enumerate() {
            let braked = supply * joint.duty - servo.damping_nm_s_per_rad * joint.qd;
            torque[j] = braked - servo.friction_nm(joint, bias[j]);
        }
        dynamics.forward_dynamics(&q, &qd, &torque, &mut qdd);
        for (joint, qdd) in joints.iter_mut().zip(&qdd) {
            joint.qd += qdd * STEP_S;
            joint.q += joint.qd * STEP_S;
        }
    }
    Ok(recorded)
}
