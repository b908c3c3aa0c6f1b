//! Motion of joints beside the chain, as recordings have it.

use std::fmt;

use serde::Serialize;

use crate::noise::PositionNoise;

/// Samples from which the noise of positions is told; more tell nothing new of an encoder.
pub(crate) const NOISE_SAMPLES: usize = 20_000;

/// Motion of a joint beside the chain, which the model carries as fixed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BranchMotion {
    /// The joint.
    pub joint: String,
    /// Smallest and largest position, rad; m of a joint that slides.
    pub range_rad: [f64; 2],
    /// Whether it slides.
    pub slides: bool,
    /// The joints of the chain whose measurement contains its motion.
    pub upstream: Vec<usize>,
}

impl fmt::Display for BranchMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.range_rad;
        let unit = if self.slides { "m" } else { "rad" };
        let numbers: Vec<String> = self.upstream.iter().map(ToString::to_string).collect();
        write!(
            f,
            "the joint {} beside the chain moves by {:.3} {unit}, and the model carries it as fixed: the measurement of joint {} \
             contains its motion, of which nothing is predicted. Record with it at rest, or model a chain through it",
            self.joint,
            high - low,
            numbers.join(", ")
        )
    }
}

/// Positions of a joint beside the chain, row after row.
#[derive(Debug, Clone)]
pub(crate) struct BranchTrack {
    pub(crate) joint: String,
    time_s: Vec<f64>,
    position_rad: Vec<f64>,
    range_rad: [f64; 2],
    samples: usize,
}

impl BranchTrack {
    pub(crate) const fn new(joint: String) -> Self {
        let range_rad = [f64::INFINITY, f64::NEG_INFINITY];
        Self { joint, time_s: Vec::new(), position_rad: Vec::new(), range_rad, samples: 0 }
    }

    /// Takes a sample; numbers that are not finite are none.
    pub(crate) fn add(&mut self, time_s: f64, position_rad: f64) {
        if !position_rad.is_finite() {
            return;
        }
        let [low, high] = self.range_rad;
        self.range_rad = [low.min(position_rad), high.max(position_rad)];
        self.samples += 1;
        if self.time_s.len() < NOISE_SAMPLES && self.time_s.last().is_none_or(|last| *last < time_s) {
            self.time_s.push(time_s);
            self.position_rad.push(position_rad);
        }
    }

    /// The motion, if there is any: a range beyond a step of the encoder and beyond what white noise σ reaches.
    ///
    /// Of n normal values none is beyond 2 σ √ln n but with a probability below 1/n (Pr(|x| > u) < e^{−u²/2σ²}).
    pub(crate) fn motion(self) -> Option<BranchMotion> {
        let noise = PositionNoise::of(&self.time_s, &self.position_rad);
        let [low, high] = self.range_rad;
        let by_noise = 4.0 * noise.white_rad * (self.samples.max(1) as f64).ln().sqrt();
        let beyond = high - low - by_noise;
        let steps = noise.step_rad.map_or(f64::INFINITY, |step| (beyond / step).round());
        (beyond > 0.0 && steps > 1.0).then_some(BranchMotion {
            joint: self.joint,
            range_rad: self.range_rad,
            slides: false,
            upstream: Vec::new(),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Nearly normal numbers of unit variance.
    fn normal(state: &Cell<u64>) -> f64 {
        let uniform = |_| {
            let next =
                state.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state.set(next);
            (next >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(uniform).sum::<f64>() - 6.0
    }

    fn moves(position: impl Fn(f64) -> f64) -> Option<BranchMotion> {
        let mut track = BranchTrack::new("wrist".to_owned());
        (0..3000).map(|k| 0.01 * f64::from(k)).for_each(|t| track.add(t, position(t)));
        track.motion()
    }

    #[test]
    fn noise_and_steps_of_a_resting_joint_are_no_motion() {
        for (seed, noise) in [(1, 1e-5), (2, 1e-4), (3, 1e-3)] {
            for step in [0.0, 1e-4] {
                let state = Cell::new(seed);
                let shown = |q: f64| {
                    let q = q + noise * normal(&state);
                    if step > 0.0 { (q / step).round() * step } else { q }
                };
                assert_eq!(moves(|_| shown(0.300_049)), None, "{noise} {step}");
                let moving = moves(|t| shown(0.3 + 0.05 * (0.5 * t).sin())).unwrap();
                assert!((moving.range_rad[1] - moving.range_rad[0] - 0.1).abs() < 0.01);
            }
        }
        assert_eq!(moves(|_| 0.4), None);
        assert_eq!(moves(|t| if t < 10.0 { 0.4 } else { 0.400_1 }), None, "one count");
        assert!(moves(|t| 0.4 + 1e-3 * t).is_some(), "slow");
    }
}
