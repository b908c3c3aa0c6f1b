//! `position_servo`: a servo that follows a position: Feetech, Dynamixel and model servos.
//!
//! # Equation
//! The firmware plans a reference r towards q*(t − T) within its speed and acceleration limits, |ṙ| ≤ v, |r̈| ≤ a,
//! |ṙ| = √(2 a |q* − r|) near its end, and drives the motor by
//!
//! τ = sat(K_p d(r + b − q) + K_i ∫ d − K_d q̇) − K_e q̇
//!
//! with the dead band d(e) = e − sat_δ(e), the firmware's damping K_d within the saturation, and the braking by the back-EMF
//! behind it, K_e = k_t k_e/R; all as torques on the joint: K_p = (firmware gain) · (supply) · k_t/R. The firmware receives a
//! command with each row of the recording and holds it until the next: q*(t) is a staircase (`command = "hold"`). A command
//! that is sent much more often than recorded is on the line between two rows (`command = "linear"`).
//!
//! # Undetermined
//! K_d (below saturation), K_e and viscous friction are one column. One scale of all torques is free unless a mass, an inertia
//! or a gain is known. The limits show only in motion that reaches them.
//!
//! # Source
//! Feetech STS3215 memory table (goal speed, acceleration, position P, I, D, dead zones); Duclusaud et al. (2025), *Extended
//! Friction Models for the Physics Simulation of Servo Actuators*, for the torque from the duty.

use aurt_traits::{DriveInput, DriveTorque, Jet, UNLIMITED, drive_numbers};

use crate::drives::declare::drive;

drive_numbers! {
    /// A servo that follows a position; equations at the head of its file.
    pub struct PositionServo {
        /// K_p: torque per position error.
        gain_nm_per_rad: "Nm/rad" = 10.0, 5.0, [1e-3, 1e6];
        /// K_e: braking by the back-EMF, outside the saturation.
        #[serde(alias = "damping_nm_s_per_rad")]
        back_emf_nm_s_per_rad: "Nm s/rad" = 0.3, 0.5, [0.0, 1e6];
        /// T: delay of the command.
        delay_s: "s" = 0.02, 0.03, [0.0, 0.5];
        /// v: speed limit of the planned reference.
        speed_limit_rad_s: "rad/s" = UNLIMITED, 2.0, [0.05, UNLIMITED];
        /// a: acceleration limit of the planned reference.
        acceleration_limit_rad_s2: "rad/s^2" = UNLIMITED, 50.0, [0.5, UNLIMITED];
        /// δ: dead band of the position error; firmwares have up to some ten steps of an encoder of 4096.
        dead_band_rad: "rad" = 0.0, 0.02, [0.0, 0.2];
        /// b: zero of the firmware against that of the joint.
        command_offset_rad: "rad" = 0.0, 0.01, [-1.0, 1.0];
        /// K_i: torque per integral of the position error.
        integral_nm_per_rad_s: "Nm/(rad s)" = 0.0, 5.0, [0.0, 1e6];
        /// K_d: damping that the firmware computes, within the saturation.
        firmware_damping_nm_s_per_rad: "Nm s/rad" = 0.0, 0.5, [0.0, 1e6];
        /// sat: largest torque of the firmware, that at rest.
        torque_limit_nm: "Nm" = UNLIMITED, 2.0, [1e-3, UNLIMITED];
    }
}

/// Longest run of a firmware that plans, s: a command that comes within a step of the simulation, 2.5 ms, holds from then on, and a limit of
/// 15 rad/s that is planned once a step is found at 11.
const FIRMWARE_S: f64 = 5e-4;

/// Jumps within this part of a run of its ends are taken as the mean over the run.
const ENDS: f64 = 0.02;

// State: r, ṙ and ∫ d.
drive!(
    PositionServo,
    "position_servo",
    Position,
    Hold,
    |command| vec![Jet::constant(command), Jet::ZERO, Jet::ZERO],
    servo
);

fn servo(p: &[Jet], input: &DriveInput<'_>, state: &mut [Jet]) -> DriveTorque {
    let [gain, back_emf, delay, speed, acceleration, dead_band, offset, integral, firmware_damping, limit] =
        p
    else {
        return DriveTorque { torque: Jet::ZERO, damping: Jet::ZERO };
    };
    let h = input.step_s;
    let sum = reference(input, *delay, [*speed, *acceleration], state);
    let error = (sum * (1.0 / h) + *offset - input.position_rad).beyond(*dead_band);
    state[2] += error * h;
    let firmware = *gain * error + *integral * state[2] - *firmware_damping * input.velocity_rad_s;
    let driven = firmware.clamp(*limit);
    let free = driven == firmware;
    DriveTorque {
        torque: driven - *back_emf * input.velocity_rad_s,
        damping: if free { *back_emf + *firmware_damping } else { *back_emf },
    }
}

/// The integral of the reference over a step, in which the firmware runs several times if its limits are finite.
fn reference(input: &DriveInput<'_>, delay: Jet, limits: [Jet; 2], state: &mut [Jet]) -> Jet {
    let h = input.step_s;
    if limits.iter().all(|l| l.value >= UNLIMITED) {
        return plan(state, (input.command)(-delay + input.time_s, h), limits, Jet::constant(h));
    }
    let runs = (h / FIRMWARE_S).ceil();
    let of_run = h / runs;
    let command =
        |run: f64| (input.command)(-delay + (input.time_s + (run + 0.5) * of_run - 0.5 * h), of_run);
    let (mut before, mut wanted) = (command(-1.0), command(0.0));
    let mut sum = Jet::ZERO;
    for run in 0..runs as usize {
        let after = command(run as f64 + 1.0);
        // A limited reference sets out when the command jumps, not when the run begins: without this it would not tell a delay.
        sum += match jump([before, wanted, after]) {
            Some(share) => {
                let behind = share * of_run;
                plan(state, before, limits, -behind + of_run) + plan(state, after, limits, behind)
            }
            None => plan(state, wanted, limits, Jet::constant(of_run)),
        };
        (before, wanted) = (wanted, after);
    }
    sum
}

/// The part of a run that is behind a jump of the command, of which the means over the run and its neighbours are given.
fn jump([before, wanted, after]: [Jet; 3]) -> Option<Jet> {
    let jump = after - before;
    if jump.value.abs() < 1e-9 {
        return None;
    }
    let share = (wanted - before) / jump;
    // A ramp has its mean in its middle. What is left of a run behind a jump near its ends is too short for a braking speed that has a slope.
    let is_jump = share.value > ENDS && share.value < 1.0 - ENDS && (share.value - 0.5).abs() > 1e-6;
    is_jump.then_some(share)
}

/// Moves the reference on towards a command for a time h; returns its integral over h.
fn plan(state: &mut [Jet], wanted: Jet, [speed, acceleration]: [Jet; 2], h: Jet) -> Jet {
    let left = wanted - state[0];
    state[1] = if acceleration.value < UNLIMITED {
        // The speed from which steps of −a h come to rest at the end.
        let half = acceleration * h * 0.5;
        let braking = ((half * half + acceleration * left.abs() * 2.0).sqrt() - half).clamp(speed);
        let aim = if left.value < 0.0 { -braking } else { braking };
        let aim = if aim.value.abs() * h.value > left.value.abs() { left / h } else { aim };
        state[1] + (aim - state[1]).clamp(acceleration * h)
    } else {
        (left / h).clamp(speed)
    };
    let moved = state[1] * h;
    state[0] += moved;
    // One that arrives within h is where it was sent to: the mean of the command over h.
    let arrives = (state[0] - wanted).value.abs() <= 1e-9 * left.value.abs();
    if arrives { wanted * h } else { (state[0] - moved * 0.5) * h }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_traits::DriveModel;

    /// The reference over time after a step of the command from 0 to 1 rad.
    fn planned(servo: &PositionServo, step_s: f64, steps: usize) -> Vec<f64> {
        let p: Vec<Jet> = servo.parameters().iter().map(|p| Jet::constant(p.value)).collect();
        let command = |_: Jet, _: f64| Jet::constant(1.0);
        let mut state = servo.initial_state(0.0);
        (0..steps)
            .map(|k| {
                let input = DriveInput {
                    time_s: k as f64 * step_s,
                    step_s,
                    command: &command,
                    position_rad: Jet::ZERO,
                    velocity_rad_s: Jet::ZERO,
                };
                servo.torque(&p, &input, &mut state);
                state[0].value
            })
            .collect()
    }

    #[test]
    fn the_reference_keeps_its_limits_and_arrives_without_overshoot() {
        let limited = PositionServo {
            speed_limit_rad_s: 2.0,
            acceleration_limit_rad_s2: 20.0,
            ..PositionServo::default()
        };
        let h = 1e-3;
        let path = planned(&limited, h, 900);
        let speed: Vec<f64> = path.windows(2).map(|w| (w[1] - w[0]) / h).collect();
        assert!(speed.iter().all(|v| *v <= 2.0 + 1e-9 && *v >= -1e-9));
        assert!(speed.windows(2).all(|w| (w[1] - w[0]).abs() <= 20.0 * h * 1.01 + 1e-9));
        // A trapezoid: 1 rad at 2 rad/s and two ramps of 0.1 s last 0.6 s.
        let arrival = path.iter().position(|r| *r > 0.999).unwrap() as f64 * h;
        assert!((arrival - 0.6).abs() < 0.03, "{arrival}");
        assert!(path.iter().all(|r| *r < 1.0 + 2e-3));
        let speed_alone = PositionServo { acceleration_limit_rad_s2: UNLIMITED, ..limited };
        assert!((planned(&speed_alone, h, 100)[99] - 0.2).abs() < 1e-9);
    }
}
