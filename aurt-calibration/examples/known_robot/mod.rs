//! A UR10e whose parameters are known, moved by harmonics: what its recordings would be, by recursive Newton–Euler and the
//! friction laws as written, which share no formula with the regressor.

use std::f64::consts::TAU;

use aurt_calibration::{Calibration, CalibrationOptions, Deviations, Estimator, NamedRecording, calibrate};
use aurt_friction::coulomb;
use aurt_plugins::Registry;
use aurt_plugins::model::{Friction, RigidBodyDynamics};
use aurt_rbd::{ChainDynamics, LinkBody, MdhRows, MdhTable};
use aurt_recording::{PreprocessOptions, Recording, preprocess};
use aurt_simulation::robots::ur10e;
use aurt_traits::{ArmTerm, MeasurementUnit, RobotModel};
use serde_json::json;

pub const RATE_HZ: f64 = 250.0;
/// Frequency of the dynamics that filters follow.
pub const F_DYN_HZ: f64 = 5.0;
const COULOMB_NM: [f64; 6] = [12.0, 14.0, 8.5, 3.6, 3.4, 3.0];
const VISCOUS_NM_S: [f64; 6] = [13.5, 13.0, 8.5, 3.2, 2.8, 2.6];
/// Deviation of the measured torques, Nm.
pub const NOISE_NM: [f64; 6] = [1.6, 1.9, 1.3, 0.32, 0.3, 0.28];

/// How the noise of the torques remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Noise {
    /// Not at all.
    White,
    /// As a Gauss–Markov process of that correlation time, with white noise of half its deviation on top.
    GaussMarkov {
        /// Correlation time, s.
        time_s: f64,
    },
}

/// How the positions are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Positions {
    /// As they are.
    Exact,
    /// By an encoder with so many bits a revolution, whose zero lies anywhere within a step.
    Bits(u32),
    /// With white noise of this deviation, rad.
    White(f64),
}

impl From<Option<u32>> for Positions {
    fn from(bits: Option<u32>) -> Self {
        bits.map_or(Self::Exact, Self::Bits)
    }
}

/// Dry friction of a joint that is higher near rest.
#[derive(Debug, Clone, Copy)]
pub struct Stribeck {
    pub joint: usize,
    /// F_S − F_C, Nm.
    pub rise_nm: f64,
    /// v_S, rad/s.
    pub velocity_rad_s: f64,
    /// δ.
    pub exponent: f64,
}

impl Stribeck {
    fn level_nm(&self, velocity_rad_s: f64) -> f64 {
        self.rise_nm * (-(velocity_rad_s / self.velocity_rad_s).abs().powf(self.exponent)).exp()
    }
}

/// A robot of which everything is known.
pub struct KnownRobot {
    pub model: RobotModel,
    /// The model's coefficients.
    pub truth: Vec<f64>,
    dynamics: ChainDynamics,
    stribeck: Vec<Stribeck>,
}

impl KnownRobot {
    /// The robot; `load` adds a body to its last link, as the arm term `payload` of the model.
    pub fn new(load: Option<&LinkBody>) -> Self {
        Self::with_stribeck(load, Vec::new())
    }

    /// The same with dry friction that is higher near rest on some joints; the model begins with another shape.
    pub fn with_stribeck(load: Option<&LinkBody>, stribeck: Vec<Stribeck>) -> Self {
        let robot = ur10e();
        let mut standard = robot.standard_parameters();
        let table = MdhTable { rows: robot.mdh.clone(), reading: MdhRows::Next };
        let rigid = RigidBodyDynamics::from_mdh(&table, robot.gravity_m_s2, 0).unwrap();
        let mut truth = rigid.base.values(&standard);
        let stacks = (0..6)
            .map(|j| {
                let law = stribeck.iter().find(|law| law.joint == j);
                truth.push(COULOMB_NM[j]);
                truth.extend(law.map(|law| law.rise_nm));
                truth.push(VISCOUS_NM_S[j]);
                let level = coulomb::stribeck::Stribeck { stribeck_exponent: 1.0, ..Default::default() };
                let friction = Friction::default();
                law.map_or(friction.clone(), |_| friction.level(level)).stack().unwrap()
            })
            .collect();
        let terms = load.map(|load| {
            truth.extend(load.standard_parameters());
            let payload = json!({"model": "payload", "link": 5});
            Registry::linked().unwrap().build_from_json::<dyn ArmTerm>(&payload).unwrap()
        });
        let model = rigid.with_joint_dynamics(stacks, terms.into_iter().collect()).unwrap();
        if let Some(load) = load {
            let last = standard.len() - 10;
            standard[last..].iter_mut().zip(load.standard_parameters()).for_each(|(s, l)| *s += l);
        }
        let dynamics = ChainDynamics::new(robot.chain().unwrap(), &standard).unwrap();
        Self { model, truth, dynamics, stribeck }
    }

    /// The calibration of recordings by an estimator.
    pub fn calibrated(
        &self,
        recordings: &[NamedRecording],
        estimator: Estimator,
        deviations: Deviations,
    ) -> Calibration {
        let options = CalibrationOptions { estimator, deviations, ..CalibrationOptions::default() };
        calibrate(&self.model, recordings, MeasurementUnit::NewtonMetre, F_DYN_HZ, &options).unwrap()
    }

    /// True for each coefficient whose interval contains the truth.
    pub fn held(&self, found: &Calibration) -> Vec<bool> {
        let intervals = found.parameters.iter().map(|p| p.interval_95.unwrap());
        intervals.zip(&self.truth).map(|([low, high], truth)| (low..=high).contains(truth)).collect()
    }

    /// Motion and torques without noise; motions of different `kind` have different phases.
    pub fn clean(&mut self, kind: usize, duration_s: f64) -> Recording {
        self.recorded(kind, duration_s, motion, 0.0)
    }

    /// The same of motions whose accelerations, too, are zero at both ends, sampled where no velocity is exactly zero: what is
    /// left of their recordings is noise alone, also at the ends and at reversals, of which shapes are made.
    pub fn clean_at_ends(&mut self, kind: usize, duration_s: f64) -> Recording {
        self.recorded(kind, duration_s, soft_motion, 0.5)
    }

    fn recorded(&mut self, kind: usize, duration_s: f64, motion: Motion, shift: f64) -> Recording {
        let samples = (duration_s * RATE_HZ) as usize;
        let mut position = vec![Vec::new(); 6];
        let mut torque = vec![Vec::new(); 6];
        let time_s: Vec<f64> = (0..samples).map(|k| (k as f64 + shift) / RATE_HZ).collect();
        for t in &time_s {
            let state: Vec<[f64; 3]> = (0..6).map(|j| motion(kind, j, *t, duration_s)).collect();
            let of = |i: usize| state.iter().map(|s| s[i]).collect::<Vec<f64>>();
            let mut tau = [0.0; 6];
            self.dynamics.inverse_dynamics(&of(0), &of(1), &of(2), &mut tau);
            for j in 0..6 {
                position[j].push(state[j][0]);
                let velocity = state[j][1];
                let rise =
                    self.stribeck.iter().find(|law| law.joint == j).map_or(0.0, |l| l.level_nm(velocity));
                let dry = (COULOMB_NM[j] + rise) * velocity.signum();
                torque[j].push(tau[j] + dry + VISCOUS_NM_S[j] * velocity);
            }
        }
        let recording = Recording::from_arrays(time_s, position).unwrap().named(format!("known_{kind}.csv"));
        recording.with_measurement(torque, MeasurementUnit::NewtonMetre).unwrap()
    }
}

/// Angle, velocity and acceleration of a joint: kind, joint, time and length of the motion.
type Motion = fn(usize, usize, f64, f64) -> [f64; 3];

/// Harmonics of the recording's length below 1 Hz, at rest at both ends as excitation is.
fn motion(kind: usize, joint: usize, t: f64, duration_s: f64) -> [f64; 3] {
    harmonics(joint, t, &terms(kind, joint, duration_s))
}

/// The same with a fourth amplitude that makes the acceleration zero at both ends.
fn soft_motion(kind: usize, joint: usize, t: f64, duration_s: f64) -> [f64; 3] {
    let mut terms = terms(kind, joint, duration_s);
    let power = |[amplitude, omega]: [f64; 2]| amplitude * omega * omega;
    let others: f64 = [0, 1, 2, 4].map(|k| power(terms[k])).iter().sum();
    terms[3][0] = -others / (terms[3][1] * terms[3][1]);
    harmonics(joint, t, &terms)
}

/// Amplitude and angular frequency of each harmonic.
fn terms(kind: usize, joint: usize, duration_s: f64) -> [[f64; 2]; 5] {
    const AMPLITUDES: [f64; 5] = [0.45, -0.25, 0.14, -0.09, 0.06];
    std::array::from_fn(|k| {
        let cycles = (2 + 3 * k + (joint * 5 + kind * 3) % 7) as f64;
        let sign = if (joint + kind + k).is_multiple_of(3) { -1.0 } else { 1.0 };
        [sign * AMPLITUDES[k], TAU * cycles / duration_s]
    })
}

fn harmonics(joint: usize, t: f64, terms: &[[f64; 2]]) -> [f64; 3] {
    let mut out = [0.0; 3];
    for [amplitude, omega] in terms {
        let (sin, cos) = (omega * t).sin_cos();
        out[0] += amplitude * (1.0 - cos);
        out[1] += amplitude * omega * sin;
        out[2] += amplitude * omega * omega * cos;
    }
    out[0] += [0.3, -1.2, 1.0, 0.4, 0.8, 0.0][joint];
    out
}

/// A clean recording as it would be measured: torques with noise of `level` times [`NOISE_NM`].
pub fn measured(
    clean: &Recording,
    name: &str,
    seed: u64,
    noise: Noise,
    level: f64,
    positions: impl Into<Positions>,
) -> NamedRecording {
    let options = PreprocessOptions { trim_rest: false, ..PreprocessOptions::new(F_DYN_HZ) };
    measured_and(clean, name, seed, noise, level, positions.into(), &options)
}

/// The same, preprocessed otherwise.
pub fn measured_and(
    clean: &Recording,
    name: &str,
    seed: u64,
    noise: Noise,
    level: f64,
    positions: Positions,
    options: &PreprocessOptions,
) -> NamedRecording {
    let mut random = Normal(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x51_7cc1_b727_220a);
    let mut recording = clean.clone();
    for (series, deviation) in recording.measurement.as_mut().unwrap().iter_mut().zip(NOISE_NM) {
        let mut state = random.next();
        for y in series.iter_mut() {
            let value = match noise {
                Noise::White => random.next(),
                Noise::GaussMarkov { time_s } => {
                    let kept = (-1.0 / (RATE_HZ * time_s)).exp();
                    state = kept * state + (1.0 - kept * kept).sqrt() * random.next();
                    state + 0.5 * random.next()
                }
            };
            *y += level * deviation * value;
        }
    }
    for series in &mut recording.position_rad {
        match positions {
            Positions::Exact => {}
            Positions::Bits(bits) => {
                let (step, zero) = (TAU / f64::from(2_u32.pow(bits)), random.uniform());
                series.iter_mut().for_each(|q| *q = ((*q / step + zero).round() - zero) * step);
            }
            Positions::White(deviation) => {
                series.iter_mut().for_each(|q| *q += deviation * random.next());
            }
        }
    }
    NamedRecording { name: name.into(), data: preprocess(&recording, options).unwrap() }
}

/// Normal deviates by Box and Muller from a 64-bit linear congruential sequence.
pub struct Normal(pub u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub fn next(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}
