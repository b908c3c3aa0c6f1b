//! Motion of joints beside the chain, as recordings have it.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::noise::PositionNoise;

/// Samples from which the noise of positions is told; more tell nothing new of an encoder.
pub(crate) const NOISE_SAMPLES: usize = 20_000;

/// Motion of a joint beside the chain, or under its base, which the model takes to be fixed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BranchMotion {
    /// The joint.
    pub joint: String,
    /// Smallest and largest position, rad; m of a joint that slides.
    pub range_rad: [f64; 2],
    /// Whether it moves; otherwise it stands away from zero.
    pub moves: bool,
    /// Whether it slides.
    pub slides: bool,
    /// The joints of the chain whose measurement contains its motion; none of a joint that stands.
    pub upstream: Vec<usize>,
    /// Whether it carries the base of the chain.
    pub carries_base: bool,
}

impl fmt::Display for BranchMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&sentence(&[self]))
    }
}

/// Turns of the base by less than this, rad, change gravity by less than a hundredth.
const SAME_GRAVITY_RAD: f64 = 0.01;

impl BranchMotion {
    /// A joint that carries the base and stands elsewhere in one recording than in another.
    pub fn elsewhere<'a>(of: &'a [Self], than: &'a [Self]) -> Option<&'a Self> {
        let stands = |in_all: &[Self], joint: &str| {
            let found = in_all.iter().find(|b| b.carries_base && !b.slides && b.joint == joint);
            found.map_or(0.0, |b| 0.5 * (b.range_rad[0] + b.range_rad[1]))
        };
        let differs = |b: &&Self| (stands(of, &b.joint) - stands(than, &b.joint)).abs() > SAME_GRAVITY_RAD;
        of.iter().chain(than).filter(|b| b.carries_base && !b.slides).find(differs)
    }

    /// What models lack of motions, a sentence for those that show in the same joints.
    pub(crate) fn sentences(motions: &[Self]) -> Vec<String> {
        let mut alike: Vec<Vec<&Self>> = Vec::new();
        for motion in motions {
            let same = |of: &&mut Vec<&Self>| {
                of[0].upstream == motion.upstream && of[0].carries_base == motion.carries_base
            };
            match alike.iter_mut().find(same) {
                Some(of) => of.push(motion),
                None => alike.push(vec![motion]),
            }
        }
        alike.iter().map(|of| sentence(of)).collect()
    }
}

/// What models lack of motions that show in the same joints.
fn sentence(of: &[&BranchMotion]) -> String {
    let first = of[0];
    let each = |motion: &&BranchMotion| {
        let [low, high] = motion.range_rad;
        let unit = if motion.slides { "m" } else { "rad" };
        let size = if motion.moves { high - low } else { 0.5 * (low + high) };
        let by = if motion.moves { "by" } else { "at" };
        format!("{} {by} {size:.3} {unit}", motion.joint)
    };
    let listed = of.iter().map(each).collect::<Vec<_>>().join(", ");
    if first.carries_base && first.moves {
        return format!(
            "joints that carry the base move ({listed}), and the model takes the base to be at rest: the measurements of all joints \
             contain that motion, of which nothing is predicted. Record with them at rest, or model the robot from its root"
        );
    }
    if first.carries_base {
        return format!(
            "joints that carry the base stand away from zero ({listed}): `gravity_m_s2` has to be gravity in the frame of the base as \
             it stands there, in all recordings alike, or the robot has to be modelled from its root"
        );
    }
    let numbers: Vec<String> = first.upstream.iter().map(ToString::to_string).collect();
    format!(
        "joints beside the chain move ({listed}), and the model carries them as fixed: the measurement of joint {} contains their \
         motion, of which nothing is predicted. Record with them at rest, or model a chain or tree through them",
        numbers.join(", ")
    )
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

    /// Where it goes, and whether it moves: its range is beyond a step of the encoder and beyond what white noise σ reaches.
    /// None for a joint that stands at zero.
    ///
    /// Of n normal values none is beyond 2 σ √ln n but with a probability below 1/n (Pr(|x| > u) < e^{−u²/2σ²}).
    pub(crate) fn motion(self) -> Option<BranchMotion> {
        let noise = PositionNoise::of(&self.time_s, &self.position_rad);
        let [low, high] = self.range_rad;
        let by_noise = 4.0 * noise.white_rad * (self.samples.max(1) as f64).ln().sqrt();
        let is_beyond = |range: f64| {
            let beyond = range - by_noise;
            beyond > 0.0 && noise.step_rad.is_none_or(|step| (beyond / step).round() > 1.0)
        };
        let moves = is_beyond(high - low);
        (moves || is_beyond((low + high).abs())).then_some(BranchMotion {
            joint: self.joint,
            range_rad: self.range_rad,
            moves,
            slides: false,
            upstream: Vec::new(),
            carries_base: false,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Normal;

    fn moves(mut position: impl FnMut(f64) -> f64) -> Option<BranchMotion> {
        let mut track = BranchTrack::new("wrist".to_owned());
        (0..3000).map(|k| 0.01 * f64::from(k)).for_each(|t| track.add(t, position(t)));
        track.motion().filter(|found| found.moves)
    }

    #[test]
    fn noise_and_steps_of_a_resting_joint_are_no_motion() {
        for (seed, noise) in [(1, 1e-5), (2, 1e-4), (3, 1e-3)] {
            for step in [0.0, 1e-4] {
                let mut normal = Normal::new(seed);
                let mut shown = |q: f64| {
                    let q = q + noise * normal.next();
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
