use serde::{Deserialize, Serialize};

use super::{Path, Trajectory, check_options};
use crate::error::{Complaints, SimulationError};
use crate::random::Random;
use crate::robots::Robot;

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
/// Duration of the ways into and out of the periodic motion, s.
const LEAD_S: f64 = 0.8;
/// How much earlier than it could the periodic motion may end, s.
const MOST_SLACK_S: f64 = 4.0;
/// Phases of the period that are tried as its beginning.
const PHASES: usize = 400;

/// q_j(t) = centre_j + Σ_k (a_jk sin kωt + b_jk cos kωt), entered from rest and left into rest along cubic
/// velocities. The motion begins at a phase at which, there and at its end, no joint is slow: a joint that
/// creeps while others move would only record how it sticks.
#[derive(Debug, Clone)]
pub(crate) struct MultiSine {
    centre_rad: Vec<f64>,
    /// Joint after joint, harmonic after harmonic: (sine, cosine) amplitudes in rad.
    amplitude_rad: Vec<[f64; 2]>,
    harmonics: usize,
    fundamental_rad_s: f64,
    duration_s: f64,
    phase_s: f64,
    body_s: f64,
    /// Joint after joint: angle, velocity, acceleration where the periodic motion begins and ends.
    begin: Vec<[f64; 3]>,
    end: Vec<[f64; 3]>,
}

/// A multi-sine with random amplitudes and phases that uses the allowed share of the limits.
pub(crate) fn draw(
    robot: &Robot,
    options: &MultiSineOptions,
    random: &mut Random,
) -> Result<Trajectory, SimulationError> {
    options.validate()?;
    let amplitudes = draw_amplitudes(robot, options, random);
    Ok(Trajectory::new(MultiSine::fitted(robot, options, &amplitudes)?))
}

impl MultiSineOptions {
    /// Refuses values that no multi-sine has, before anything is made as large as they say.
    pub(crate) fn validate(&self) -> Result<(), SimulationError> {
        check_options(self.duration_s, self.share)?;
        let mut complaints = Complaints::default();
        complaints.within("number of harmonics", self.harmonics as f64, 1.0, 40.0);
        complaints.within("highest frequency of the trajectory in Hz", self.top_hz, 1e-3, 50.0);
        complaints.within("duration of a multi-sine in s", self.duration_s, 3.0, 3600.0);
        complaints.finish()
    }
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
        options.validate()?;
        let joints = robot.joints();
        let fundamental_rad_s = std::f64::consts::TAU * options.top_hz / options.harmonics as f64;
        let mut path = Self {
            centre_rad: vec![0.0; joints],
            amplitude_rad: shape.to_vec(),
            harmonics: options.harmonics,
            fundamental_rad_s,
            duration_s: options.duration_s,
            phase_s: 0.0,
            body_s: options.duration_s - 2.0 * (REST_S + LEAD_S),
            begin: Vec::new(),
            end: Vec::new(),
        };
        path.choose_edges();
        path.note_edges();
        let (mut low, mut high) = (vec![f64::INFINITY; joints], vec![f64::NEG_INFINITY; joints]);
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
            let (below, above) = (scale * low[j], scale * high[j]);
            let middle = drive.home_rad - 0.5 * (below + above);
            path.centre_rad[j] = middle.clamp(lower - below, (upper - above).max(lower - below));
            for amplitude in &mut path.amplitude_rad[j * options.harmonics..(j + 1) * options.harmonics] {
                *amplitude = amplitude.map(|a| a * scale);
            }
        }
        path.note_edges();
        Ok(path)
    }

    /// Begins and ends the periodic motion where the slowest joint is fastest relative to its peak and
    /// accelerates least; the end may come a little early, and is followed by rest.
    fn choose_edges(&mut self) {
        let period_s = std::f64::consts::TAU / self.fundamental_rad_s;
        let joints = self.centre_rad.len();
        let phases = |length_s: f64| (0..PHASES).map(move |k| k as f64 * length_s / PHASES as f64);
        let at = |time_s: f64| (0..joints).map(|j| self.periodic(time_s, j)).collect::<Vec<_>>();
        let mut peak = vec![1e-12_f64; joints];
        for phase in phases(period_s) {
            for (p, [_, v, _]) in peak.iter_mut().zip(at(phase)) {
                *p = p.max(v.abs());
            }
        }
        // The cubic leaves rest as x² (3 v − a T) on the way in and as x² (3 v + a T) on the way out.
        let liveliness = |time_s: f64, way: f64| {
            at(time_s)
                .iter()
                .zip(&peak)
                .map(|([_, v, a], p)| (v.abs() - way * v.signum() * a * LEAD_S / 3.0).min(v.abs()) / p)
                .fold(f64::INFINITY, f64::min)
        };
        let liveliest = |way: f64, candidates: &mut dyn Iterator<Item = f64>| {
            candidates
                .map(|time_s| (liveliness(time_s, way), time_s))
                .fold((f64::NEG_INFINITY, 0.0), |a, b| if b.0 > a.0 { b } else { a })
                .1
        };
        let phase_s = liveliest(1.0, &mut phases(period_s));
        let latest_s = phase_s + self.body_s;
        let slack_s = period_s.min(MOST_SLACK_S).min(0.3 * self.body_s);
        let end_s = liveliest(-1.0, &mut phases(slack_s).map(|early| latest_s - early));
        (self.phase_s, self.body_s) = (phase_s, end_s - phase_s);
    }

    fn note_edges(&mut self) {
        let joints = self.centre_rad.len();
        self.begin = (0..joints).map(|j| self.periodic(self.phase_s, j)).collect();
        self.end = (0..joints).map(|j| self.periodic(self.phase_s + self.body_s, j)).collect();
    }

    /// Angle, velocity and acceleration of a joint in the periodic motion.
    fn periodic(&self, time_s: f64, joint: usize) -> [f64; 3] {
        let omega = self.fundamental_rad_s;
        self.sum(joint, libm::sin(omega * time_s), libm::cos(omega * time_s))
    }

    fn sum(&self, joint: usize, sine: f64, cosine: f64) -> [f64; 3] {
        let amplitudes = &self.amplitude_rad[joint * self.harmonics..(joint + 1) * self.harmonics];
        let (mut q, mut qd, mut qdd) = (self.centre_rad[joint], 0.0, 0.0);
        // sin kωt and cos kωt by turning once more for each harmonic.
        let (mut sk, mut ck) = (sine, cosine);
        for (k, [a, b]) in amplitudes.iter().enumerate() {
            let rate = (k + 1) as f64 * self.fundamental_rad_s;
            let value = a * sk + b * ck;
            q += value;
            qd += rate * (a * ck - b * sk);
            qdd -= rate * rate * value;
            (sk, ck) = (sk * cosine + ck * sine, ck * cosine - sk * sine);
        }
        [q, qd, qdd]
    }
}

/// The way into motion at the share x of its duration: the velocity is the cubic from rest to (v, a).
fn lead_in([q, v, a]: [f64; 3], x: f64) -> [f64; 3] {
    let (x2, rise) = (x * x, a * LEAD_S);
    let x3 = x2 * x;
    let travelled = |x: f64, x3: f64| v * x3 * (1.0 - 0.5 * x) + rise * x3 * (0.25 * x - 1.0 / 3.0);
    [
        q + LEAD_S * (travelled(x, x3) - travelled(1.0, 1.0)),
        v * x2 * (3.0 - 2.0 * x) + rise * x2 * (x - 1.0),
        (6.0 * v * x * (1.0 - x) + rise * x * (3.0 * x - 2.0)) / LEAD_S,
    ]
}

/// The way out of motion, the mirror image of [`lead_in`].
fn lead_out([q, v, a]: [f64; 3], x: f64) -> [f64; 3] {
    let [back_q, back_v, back_a] = lead_in([q, -v, a], 1.0 - x);
    [back_q, -back_v, back_a]
}

impl Path for MultiSine {
    fn joints(&self) -> usize {
        self.centre_rad.len()
    }

    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        let body = time_s - REST_S - LEAD_S;
        let left = REST_S + LEAD_S + self.body_s;
        let angle = self.fundamental_rad_s * (body + self.phase_s);
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        for j in 0..q_rad.len() {
            [q_rad[j], qd_rad_s[j], qdd_rad_s2[j]] = if body < 0.0 {
                lead_in(self.begin[j], ((time_s - REST_S) / LEAD_S).max(0.0))
            } else if time_s > left {
                lead_out(self.end[j], ((time_s - left) / LEAD_S).min(1.0))
            } else {
                self.sum(j, sine, cosine)
            };
        }
    }
}
