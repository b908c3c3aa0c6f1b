//! Random recordings for the checks: rich in reversals, with rest, with irregular time stamps.

use std::f64::consts::TAU;

use aurt_traits::{ArmSeries, JointSeries, Motion, MotionView, RigidBodyRegressor};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// A motion of some joints and the loads that they transmit, joint after joint.
#[derive(Debug, Clone, Default)]
pub struct Recording {
    joints: usize,
    time_s: Vec<f64>,
    position_rad: Vec<f64>,
    velocity_rad_s: Vec<f64>,
    acceleration_rad_s2: Vec<f64>,
    load_torque: Vec<f64>,
}

/// A seeded sequence of numbers between 0 and 1.
#[derive(Debug, Clone)]
pub struct Draw(SplitMix64);

impl Draw {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed))
    }

    /// The next number, uniform between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next whole number below `limit`.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.between(0.0, limit as f64) as usize).min(limit.saturating_sub(1))
    }
}

impl Recording {
    /// Sums of three sines per joint at 0.1–2 Hz, sampled at intervals of 2–6 ms, with a stretch of exact rest and
    /// loads that vary in sign.
    pub fn random(seed: u64, joints: usize, samples: usize) -> Self {
        let mut draw = Draw::new(seed);
        let mut recording = Self { joints, ..Self::default() };
        let mut time = draw.between(-5.0, 5.0);
        for _ in 0..samples {
            recording.time_s.push(time);
            time += draw.between(0.002, 0.006);
        }
        let rest = samples / 3..samples / 3 + samples / 20;
        for _ in 0..joints {
            let waves: [[f64; 3]; 3] = std::array::from_fn(|_| {
                [draw.between(0.05, 0.5), TAU * draw.between(0.1, 2.0), draw.between(0.0, TAU)]
            });
            let [amplitude, frequency, phase] =
                [draw.between(1.0, 30.0), draw.between(0.5, 3.0), draw.between(0.0, TAU)];
            for n in 0..samples {
                let resting = rest.contains(&n);
                let t = recording.time_s[if resting { rest.start } else { n }];
                let (mut q, mut v, mut a) = (0.0, 0.0, 0.0);
                for [size, omega, start] in waves {
                    let (sin, cos) = (omega * t + start).sin_cos();
                    q += size * sin;
                    v += size * omega * cos;
                    a -= size * omega * omega * sin;
                }
                recording.position_rad.push(q);
                recording.velocity_rad_s.push(if resting { 0.0 } else { v });
                recording.acceleration_rad_s2.push(if resting { 0.0 } else { a });
                recording.load_torque.push(amplitude * (frequency * recording.time_s[n] + phase).sin());
            }
        }
        recording
    }

    /// `cycles` turns of q_j = q_0 + A_j (cos(s + φ_j) + ⅓ cos 3(s + φ_j)), which ends where it began; `amplitude_rad`
    /// is the size of A_j, and one turn takes `period_s`.
    pub fn closed(
        seed: u64,
        joints: usize,
        samples: usize,
        cycles: usize,
        amplitude_rad: f64,
        period_s: f64,
    ) -> Self {
        let mut draw = Draw::new(seed);
        let mut recording = Self { joints, ..Self::default() };
        let turns = |n: usize| (cycles * n) as f64 / (samples - 1).max(1) as f64;
        recording.time_s = (0..samples).map(|n| period_s * turns(n)).collect();
        for joint in 0..joints {
            let size = amplitude_rad * draw.between(0.5, 1.0);
            let phase = if joint == 0 { 0.0 } else { draw.between(0.0, TAU) };
            let omega = TAU / period_s;
            for n in 0..samples {
                let s = TAU * turns(n) + phase;
                recording.position_rad.push(0.4 + size * (s.cos() + (3.0 * s).cos() / 3.0));
                recording.velocity_rad_s.push(-size * omega * (s.sin() + (3.0 * s).sin()));
                recording.acceleration_rad_s2.push(-size * omega * omega * (s.cos() + 3.0 * (3.0 * s).cos()));
                recording.load_torque.push(8.0 * (0.7 * s).sin());
            }
        }
        recording
    }

    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Number of samples.
    pub const fn samples(&self) -> usize {
        self.time_s.len()
    }

    /// The series of one joint.
    pub fn joint(&self, joint: usize) -> JointSeries<'_> {
        let range = joint * self.samples()..(joint + 1) * self.samples();
        JointSeries {
            time_s: &self.time_s,
            position_rad: &self.position_rad[range.clone()],
            velocity_rad_s: &self.velocity_rad_s[range.clone()],
            acceleration_rad_s2: &self.acceleration_rad_s2[range.clone()],
            load_torque: &self.load_torque[range],
        }
    }

    /// The motion of all joints.
    pub fn motion(&self) -> Motion {
        Motion::new(
            self.joints,
            self.time_s.clone(),
            self.position_rad.clone(),
            self.velocity_rad_s.clone(),
            self.acceleration_rad_s2.clone(),
        )
        .unwrap_or_default()
    }

    /// What an arm term receives of `view`, which starts at the sample `first` of this recording's motion.
    pub fn arm<'a>(
        &'a self,
        view: MotionView<'a>,
        first: usize,
        rigid_body: &'a dyn RigidBodyRegressor,
    ) -> ArmSeries<'a> {
        ArmSeries {
            motion: view,
            load_torque: &self.load_torque[first..],
            load_stride: self.samples(),
            rigid_body,
        }
    }

    /// The same with the loads reversed.
    #[must_use]
    pub fn with_reversed_load(mut self) -> Self {
        self.load_torque.iter_mut().for_each(|x| *x = -*x);
        self
    }

    /// The same with the velocities reversed, and nothing else.
    #[must_use]
    pub fn with_reversed_velocity(mut self) -> Self {
        self.velocity_rad_s.iter_mut().for_each(|x| *x = -*x);
        self
    }

    /// The same with one velocity everywhere, and nothing else changed.
    #[must_use]
    pub fn with_velocity(mut self, velocity_rad_s: f64) -> Self {
        self.velocity_rad_s.fill(velocity_rad_s);
        self
    }

    /// The same motion mirrored: positions, velocities and accelerations reversed.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        for series in [&mut self.position_rad, &mut self.velocity_rad_s, &mut self.acceleration_rad_s2] {
            series.iter_mut().for_each(|x| *x = -*x);
        }
        self
    }

    /// The same path with the same loads, travelled `factor` times as slowly.
    #[must_use]
    pub fn slowed(mut self, factor: f64) -> Self {
        self.time_s.iter_mut().for_each(|t| *t *= factor);
        self.velocity_rad_s.iter_mut().for_each(|v| *v /= factor);
        self.acceleration_rad_s2.iter_mut().for_each(|a| *a /= factor * factor);
        self
    }
}
