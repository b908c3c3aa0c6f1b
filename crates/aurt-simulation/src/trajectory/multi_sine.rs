use serde::{Deserialize, Serialize};

use super::{Path, Trajectory, check_options, smooth_step};
use crate::error::Complaints;
use crate::random::Random;
use crate::{Robot, SimulationError};

/// What a multi-sine is to be like.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MultiSineOptions {
    /// Duration in s, ramps and rests included.
    pub duration_s: f64,
    /// Number of harmonics, 1–40.
    pub harmonics: usize,
    /// Frequency of the highest harmonic, Hz.
    pub top_hz: f64,
    /// Share of the position, velocity and acceleration limits that may be used, (0, 1].
    pub share: f64,
}

/// No joint swings farther from its home than this, rad, however wide its limits.
const LARGEST_SWING_RAD: f64 = 1.5;
/// Rest before and after the motion, s.
const REST_S: f64 = 0.4;

/// q_j(t) = centre_j + w(t) Σ_k (a_jk sin kωt + b_jk cos kωt), with a smooth window w that is 0 at both ends.
#[derive(Debug, Clone)]
pub(crate) struct MultiSine {
    centre_rad: Vec<f64>,
    /// Joint after joint, harmonic after harmonic: (sine, cosine) amplitudes in rad.
    amplitude_rad: Vec<[f64; 2]>,
    harmonics: usize,
    fundamental_rad_s: f64,
    duration_s: f64,
    ramp_s: f64,
}

/// A multi-sine with random amplitudes and phases that uses the allowed share of the limits.
pub(crate) fn draw(
    robot: &Robot,
    options: &MultiSineOptions,
    random: &mut Random,
) -> Result<Trajectory, SimulationError> {
    let amplitudes = draw_amplitudes(robot, options, random);
    Ok(Trajectory::new(MultiSine::fitted(robot, options, &amplitudes)?))
}

/// Random amplitudes and phases, falling with the harmonic so that velocities rather than accelerations
/// are spread evenly.
pub(crate) fn draw_amplitudes(
    robot: &Robot,
    options: &MultiSineOptions,
    random: &mut Random,
) -> Vec<[f64; 2]> {
    (0..robot.joints() * options.harmonics)
        .map(|i| {
            let harmonic = (i % options.harmonics.max(1) + 1) as f64;
            let size = random.between(0.3, 1.0) / harmonic.sqrt();
            let phase = random.between(0.0, std::f64::consts::TAU);
            [size * libm::cos(phase), size * libm::sin(phase)]
        })
        .collect()
}

impl MultiSine {
    /// The multi-sine of the given shape, scaled and centred joint by joint to use the allowed share of
    /// the limits.
    pub fn fitted(
        robot: &Robot,
        options: &MultiSineOptions,
        shape: &[[f64; 2]],
    ) -> Result<Self, SimulationError> {
        check_options(options.duration_s, options.share)?;
        let mut complaints = Complaints::default();
        complaints.within("number of harmonics", options.harmonics as f64, 1.0, 40.0);
        complaints.within("highest frequency of the trajectory in Hz", options.top_hz, 1e-3, 50.0);
        complaints.finish()?;
        let joints = robot.joints();
        let fundamental_rad_s = std::f64::consts::TAU * options.top_hz / options.harmonics as f64;
        let mut path = Self {
            centre_rad: vec![0.0; joints],
            amplitude_rad: shape.to_vec(),
            harmonics: options.harmonics,
            fundamental_rad_s,
            duration_s: options.duration_s,
            ramp_s: (0.2 * options.duration_s).min(2.0),
        };
        let mut low = vec![0.0_f64; joints];
        let mut high = vec![0.0_f64; joints];
        let mut peak_velocity = vec![1e-12_f64; joints];
        let mut peak_acceleration = vec![1e-12_f64; joints];
        let (mut q, mut qd, mut qdd) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
        let samples = (options.duration_s * 200.0) as usize;
        for k in 0..=samples {
            path.at(k as f64 / 200.0, &mut q, &mut qd, &mut qdd);
            for j in 0..joints {
                low[j] = low[j].min(q[j]);
                high[j] = high[j].max(q[j]);
                peak_velocity[j] = peak_velocity[j].max(qd[j].abs());
                peak_acceleration[j] = peak_acceleration[j].max(qdd[j].abs());
            }
        }
        for (j, drive) in robot.drives.iter().enumerate() {
            let [lower, upper] = drive.position_limit_rad;
            let allowed = options.share * (0.5 * (upper - lower)).min(LARGEST_SWING_RAD);
            let scale = (allowed / (0.5 * (high[j] - low[j])).max(1e-12))
                .min(options.share * drive.velocity_limit_rad_s / peak_velocity[j])
                .min(options.share * drive.acceleration_limit_rad_s2 / peak_acceleration[j]);
            // The window pulls towards the centre, so the centre itself has to lie within the limits too.
            let (below, above) = (scale * low[j], scale * high[j]);
            path.centre_rad[j] = drive.home_rad.clamp(lower - below, (upper - above).max(lower - below));
            for amplitude in &mut path.amplitude_rad[j * options.harmonics..(j + 1) * options.harmonics] {
                *amplitude = amplitude.map(|a| a * scale);
            }
        }
        Ok(path)
    }

    /// The window w and its first two derivatives.
    fn window(&self, time_s: f64) -> [f64; 3] {
        let (ramp, end) = (self.ramp_s, self.duration_s - REST_S);
        let (x, slope) = if time_s < 0.5 * self.duration_s {
            ((time_s - REST_S) / ramp, 1.0 / ramp)
        } else {
            ((end - time_s) / ramp, -1.0 / ramp)
        };
        let [w, wd, wdd] = smooth_step(x);
        [w, wd * slope, wdd * slope * slope]
    }
}

impl Path for MultiSine {
    fn joints(&self) -> usize {
        self.centre_rad.len()
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        let [w, wd, wdd] = self.window(time_s);
        let omega = self.fundamental_rad_s;
        let (sine, cosine) = (libm::sin(omega * time_s), libm::cos(omega * time_s));
        for (j, amplitudes) in self.amplitude_rad.chunks_exact(self.harmonics).enumerate() {
            let (mut s, mut sd, mut sdd) = (0.0, 0.0, 0.0);
            // sin kωt and cos kωt by turning once more for each harmonic.
            let (mut sk, mut ck) = (sine, cosine);
            for (k, [a, b]) in amplitudes.iter().enumerate() {
                let rate = (k + 1) as f64 * omega;
                let value = a * sk + b * ck;
                s += value;
                sd += rate * (a * ck - b * sk);
                sdd -= rate * rate * value;
                (sk, ck) = (sk * cosine + ck * sine, ck * cosine - sk * sine);
            }
            q_rad[j] = self.centre_rad[j] + w * s;
            qd_rad_s[j] = w * sd + wd * s;
            qdd_rad_s2[j] = w * sdd + 2.0 * wd * sd + wdd * s;
        }
    }
}
