//! The search for a joint's gear, and what is claimed of it.
//!
//! Shapes are found on one half of the blocks of time and judged on the other, and the other way round: what is counted is the
//! log-likelihood that a prediction gains on held-out rows. Frequency, damping and play are found by variable
//! projection – the amplitude follows from each shape by least squares –, from a grid of starts by a pattern search.

use std::ops::Range;

use aurt_calibration::two_sided;

use super::against::{Against, Moments};
use super::pieces::KindRows;
use super::rows::PARTS;
use super::shape::{Inertia, Shape};
use crate::error::DiagnosisError;

/// Least gain in log-likelihood on held-out rows, nats. The starts are some fifty shapes of each of seven
/// joints: where nothing is there, the best of them gains less than 1 on other rows (it is as likely to lose).
pub(super) const LEAST_GAIN: f64 = 12.0;
/// Fewest parts of blocks that may judge: eight seconds.
const FEWEST_PARTS: usize = 8 * PARTS;
/// A gear's torque is what physics asks: amplitude 1. A load that is biased by what the gear does makes it differ either way, and so do
/// other gears that give way. The bias is gone once the gear's torque is taken out; before, it has no upper bound.
pub(crate) const AMPLITUDE: [f64; 2] = [0.3, 2.0];
/// Shapes found on two halves of the data are one if their frequencies agree to this factor, …
const SAME_HZ: f64 = 1.25;
/// … and the play to this one.
const SAME_GAP: f64 = 2.0;
/// Least share of the power of the joint's own rows that a gear explains.
const LEAST_SHARE: f64 = 0.02;
/// Sum of what the best start of each half gains on that half, on the joint's own rows, below which shapes are not refined, nats. Of 48
/// independent starts the best gains 2.6 by chance on each half, and both together reach this on one joint of 700.
const WORTH_REFINING: f64 = 12.0;
/// First steps of the pattern search in the logarithms of frequency and damping, the rotor's share and the logarithm of the play, and how
/// often they are halved.
const FIRST_STEPS: [f64; 4] = [0.07, 0.5, 0.2, 0.35];
const HALVINGS: Range<i32> = 0..4;
/// The same for play whose shape is known from the halves, or from what was fitted before: down to half a per cent of the gap, on which the
/// instants of impacts depend.
const HALVINGS_OF_KNOWN_PLAY: Range<i32> = 2..7;
/// Steps of the second differences that give deviations.
const CURVATURE_STEPS: [f64; 4] = [0.01, 0.1, 0.05, 0.1];

/// Which recordings a gear is looked for in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Among {
    All,
    Targets,
}

/// The level of the test, and the number of gears that are looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Level {
    pub level: f64,
    pub trials: f64,
}

/// A gear that was found, whether or not it passes all tests.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub joint: usize,
    pub shape: Shape,
    pub inertia: Inertia,
    /// Measured torque over the predicted one, the positions' noise discounted.
    pub amplitude: f64,
    pub amplitude_std: f64,
    /// Standard deviations of the shape's freedoms.
    pub shape_std: [f64; 4],
    /// Gain in log-likelihood on held-out rows: over all, over reference and target recordings.
    pub gain: f64,
    pub gains: [f64; 2],
    /// The probability that chance makes its torque go with the residual as it does in one of all trials.
    pub p: f64,
    /// Share of the power of the joint's own rows that it explains.
    pub share: f64,
    /// Tests that it fails, in words.
    pub fails: Vec<String>,
}

/// What the data could show of a joint's gear.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Visible {
    /// M_jj.
    pub inertia: Option<Inertia>,
    /// Highest frequency of a resonance that would show, Hz.
    pub hz: Option<f64>,
    /// Smallest half play that would show, rad.
    pub half_gap_rad: Option<f64>,
}

/// The rows of all segments, for gears of one joint.
pub(super) struct JointRows<'a> {
    joint: usize,
    own: Vec<Against<'a>>,
    all: Vec<Against<'a>>,
    target: Vec<bool>,
    inertia: Inertia,
    top_hz: f64,
    of_kind: &'a KindRows<'a>,
}

/// Starts, and how their torques go with the residual, segment by segment.
pub(super) struct Scan<'a> {
    starts: &'a [Shape],
    moments: Vec<Vec<Moments>>,
}

/// (segment, part of a block).
type Block = (usize, usize);

impl<'a> JointRows<'a> {
    /// `None` where a joint's rows say nothing in any segment.
    pub fn new(of_kind: &'a KindRows<'a>, joint: usize) -> Result<Option<Self>, DiagnosisError> {
        let (mut own, mut all, mut target) = (Vec::new(), Vec::new(), Vec::new());
        let mut inertia = Inertia { mean_kg_m2: 0.0, least_kg_m2: f64::INFINITY };
        let mut top_hz = f64::INFINITY;
        for segment in of_kind.freed() {
            if let (Some(o), Some(a)) =
                (Against::new(segment, joint, false)?, Against::new(segment, joint, true)?)
            {
                let Some(of_segment) = segment.rows.inertia(joint) else { continue };
                inertia.mean_kg_m2 += of_segment.mean_kg_m2;
                inertia.least_kg_m2 = inertia.least_kg_m2.min(of_segment.least_kg_m2);
                top_hz = segment.rows.top_hz.min(top_hz);
                own.push(o);
                all.push(a);
                target.push(segment.target);
            }
        }
        if own.is_empty() {
            return Ok(None);
        }
        inertia.mean_kg_m2 /= own.len() as f64;
        Ok(Some(Self { joint, own, all, target, inertia, top_hz, of_kind }))
    }

    /// Starts for elastic gears and for gears with play.
    pub fn starts(&self) -> [Vec<Shape>; 2] {
        [Shape::elastic(self.top_hz), Shape::with_play()]
    }

    /// M_jj over the segments.
    pub const fn inertia(&self) -> Inertia {
        self.inertia
    }

    fn moments(&self, of: &[Against<'a>], shape: Shape) -> Vec<Moments> {
        let gear = shape.gear(self.inertia);
        of.iter().map(|against| against.moments(gear)).collect()
    }

    fn blocks(&self, among: Among) -> Vec<Block> {
        let power: Vec<&[f64]> = self.own.iter().map(Against::power).collect();
        (0..self.own.len())
            .filter(|s| among == Among::All || self.target[*s])
            .flat_map(|s| (0..power[s].len()).map(move |b| (s, b)))
            .filter(|(s, b)| power[*s][*b] > 0.0)
            .collect()
    }

    /// What a gear gains in the calibration recordings with the amplitude that suits them, nats: a link that rings for long is soon out of
    /// phase with a simulated one that is a little softer.
    pub fn gain_in_calibration(&self, shape: Shape) -> f64 {
        let blocks = self.blocks(Among::All).into_iter().filter(|(s, _)| !self.target[*s]);
        fitted_gain(sums(&self.moments(&self.all, shape), &blocks.collect::<Vec<_>>()))
    }

    /// How the torques of starts go with the residual of the joint's own rows.
    pub fn scan<'s>(&self, starts: &'s [Shape]) -> Scan<'s> {
        Scan { starts, moments: starts.iter().map(|s| self.moments(&self.own, *s)).collect() }
    }

    /// Gain in log-likelihood of a gear that is there, nats, in the targets where there are some: a gear may have changed. What a single part
    /// shows does not count: chance makes such things.
    pub fn visible(&self, shape: Shape) -> f64 {
        let gear = shape.gear(self.inertia);
        let targets = self.target.contains(&true);
        let asked = self.own.iter().zip(&self.target).filter(|(_, target)| **target == targets);
        let gains: Vec<f64> = asked.flat_map(|(against, _)| against.visible(gear)).collect();
        gains.iter().sum::<f64>() - gains.iter().copied().fold(0.0, f64::max)
    }

    /// Looks for a gear among starts; `None` if nothing is worth a test.
    pub fn search(
        &self,
        scan: &Scan<'_>,
        among: Among,
        level: Level,
    ) -> Result<Option<Found>, DiagnosisError> {
        let Scan { starts, moments: scanned } = scan;
        let blocks = self.blocks(among);
        let halves = halves(&blocks);
        if halves.iter().any(|h| 2 * h.len() < FEWEST_PARTS) {
            return Ok(None);
        }
        let own_gain = |start: &usize, half: &[Block]| fitted_gain(sums(&scanned[*start], half));
        // The start of each kind that gains most on a half, the best kind first.
        let best = |half: &[Block]| {
            let mut best: Vec<usize> = Vec::new();
            let mut order: Vec<usize> = (0..starts.len()).collect();
            order.sort_by(|a, b| own_gain(b, half).total_cmp(&own_gain(a, half)));
            for start in order {
                if best.iter().all(|known| !starts[*known].is_of_a_kind(starts[start])) {
                    best.push(start);
                }
            }
            best
        };
        let best = halves.each_ref().map(|half| best(half));
        // A resonance of little damping lies between two starts. Neither predicts the other half before it is refined.
        let gains =
            best.iter().zip(&halves).map(|(best, half)| best.first().map(|start| own_gain(start, half)));
        if gains.sum::<Option<f64>>().is_none_or(|gain| gain < WORTH_REFINING) {
            return Ok(None);
        }
        let starts = best.map(|best| best.into_iter().map(|start| starts[start]).collect());
        self.tested(&halves, (starts, HALVINGS), &blocks, (level, f64::INFINITY))
    }

    /// A gear of this joint tested from a known shape; `None` where too few blocks judge.
    pub fn anew(&self, shape: Shape, among: Among, level: Level) -> Result<Option<Found>, DiagnosisError> {
        let blocks = self.blocks(among);
        let halves = halves(&blocks);
        if halves.iter().any(|h| 2 * h.len() < FEWEST_PARTS) {
            return Ok(None);
        }
        let starts = [0, 1].map(|_| vec![shape]);
        self.tested(&halves, (starts, halvings_of_known(shape)), &blocks, (level, AMPLITUDE[1]))
    }

    /// A gear refined from starts on each half and judged on the other; `None` without a start.
    fn tested(
        &self,
        halves: &[Vec<Block>; 2],
        (starts, halvings): ([Vec<Shape>; 2], Range<i32>),
        blocks: &[Block],
        (level, most): (Level, f64),
    ) -> Result<Option<Found>, DiagnosisError> {
        let mut gains = [0.0; 2];
        let mut judged = Vec::new();
        let mut shapes = Vec::new();
        let mut amplitudes = Vec::new();
        for (k, starts) in starts.into_iter().enumerate() {
            let (fit, judge) = (&halves[k], &halves[1 - k]);
            let refined = starts.into_iter().map(|start| self.refined(start, fit, halvings.clone()));
            let Some((shape, _)) = refined.max_by(|(_, a), (_, b)| a.total_cmp(b)) else { return Ok(None) };
            let moments = self.moments(&self.all, shape);
            let amplitude = amplitude(sums(&moments, fit));
            for (s, b) in judge {
                gains[usize::from(self.target[*s])] += gain(moments[*s][*b], amplitude);
                judged.push(moments[*s][*b]);
            }
            shapes.push(shape);
            amplitudes.push(amplitude);
        }
        let total = gains[0] + gains[1];
        // A gear that its load topples in the rows that judge it is none.
        if !total.is_finite() {
            return Ok(None);
        }
        let better = usize::from(
            fitted_gain(sums(&self.moments(&self.all, shapes[1]), blocks))
                > fitted_gain(sums(&self.moments(&self.all, shapes[0]), blocks)),
        );
        let known = shapes[better];
        let (shape, _) = self.refined(known, blocks, halvings_of_known(known));
        let own_power: f64 = {
            let power: Vec<&[f64]> = self.own.iter().map(Against::power).collect();
            blocks.iter().map(|(s, b)| power[*s][*b]).sum()
        };
        let p = level.by_chance(&judged);
        let [cc, cr] = sums(&self.moments(&self.all, shape), blocks);
        let mut size = [amplitude([cc, cr]), 1.0 / cc.sqrt()];
        if total >= LEAST_GAIN && p <= level.level {
            let noisier = self.of_kind.noisier(self.joint)?;
            let freed =
                |shape: Shape, blocks: &[Block]| self.amplitude_without_noise(&noisier, shape, blocks);
            size = freed(shape, blocks);
            amplitudes = shapes.iter().zip(halves).map(|(shape, half)| freed(*shape, half)[0]).collect();
        }
        let mut found = Found {
            joint: self.joint,
            shape,
            inertia: self.inertia,
            amplitude: size[0],
            amplitude_std: size[1],
            shape_std: self.shape_std(shape, &shapes, blocks),
            gain: total,
            gains,
            p,
            share: 2.0 * total / own_power.max(f64::MIN_POSITIVE),
            fails: Vec::new(),
        };
        found.test(&shapes, (&amplitudes, most), self.top_hz, level.level);
        Ok(Some(found))
    }

    /// The amplitude of a gear's torque and its standard deviation, if positions had no noise.
    ///
    /// What moves a simulated link are positions, and their noise makes its torque larger than what the drives feel: c·c is too large, and
    /// the amplitude c·r/c·c too small. Both products grow in proportion to the noise's power. With the noise once more they are
    /// ⟨c·c⟩₂ and ⟨c·r⟩₂, means of either sign of it, and without any 2 c·c − ⟨c·c⟩₂ and 2 c·r − ⟨c·r⟩₂ (J. R. Cook and L. A. Stefanski,
    /// *J. American Statistical Association* 89, 1994). A torque that is noise throughout has no known size.
    fn amplitude_without_noise(
        &self,
        noisier: &[Vec<Against<'_>>; 2],
        shape: Shape,
        blocks: &[Block],
    ) -> [f64; 2] {
        let once = sums(&self.moments(&self.all, shape), blocks);
        let twice = noisier.each_ref().map(|of| sums(&self.moments(of, shape), blocks));
        let [cc, cr] = [0, 1].map(|k| 2.0 * once[k] - 0.5 * (twice[0][k] + twice[1][k]));
        if cc > 0.0 { [(cr / cc).max(0.0), once[0].sqrt() / cc] } else { [1.0, f64::INFINITY] }
    }

    /// A pattern search from a start, with steps that have been halved as often, and what the shape gains.
    fn refined(&self, start: Shape, blocks: &[Block], halvings: Range<i32>) -> (Shape, f64) {
        let value = |shape: Shape| fitted_gain(sums(&self.moments(&self.all, shape), blocks));
        let (mut best, mut most) = (start, value(start));
        for halving in halvings {
            let steps = FIRST_STEPS.map(|step| step * 0.5_f64.powi(halving));
            for which in 0..start.freedoms() {
                for sign in [1.0, -1.0] {
                    let mut moves = false;
                    loop {
                        let next = best.moved(which, sign * steps[which], self.top_hz);
                        let gains = if next == best { most } else { value(next) };
                        if gains <= most {
                            break;
                        }
                        (best, most) = (next, gains);
                        moves = true;
                    }
                    if moves {
                        break;
                    }
                }
            }
        }
        (best, most)
    }

    /// Standard deviations of a shape's logarithms, from the curvature of the log-likelihood along each; of play also from what the
    /// halves differ: the curvature knows the noise of rows alone, the halves what the simulated link has wrong from impact to impact. The mean
    /// of two is off by half their difference.
    fn shape_std(&self, shape: Shape, of_halves: &[Shape], blocks: &[Block]) -> [f64; 4] {
        let value = |shape: Shape| fitted_gain(sums(&self.moments(&self.all, shape), blocks));
        let at = value(shape);
        let mut std = [f64::NAN; 4];
        for (which, std) in std.iter_mut().enumerate().take(shape.freedoms()) {
            let step = CURVATURE_STEPS[which];
            let [ahead, behind] = [step, -step].map(|by| value(shape.moved(which, by, self.top_hz)));
            let curvature = (2.0 * at - ahead - behind) / (step * step);
            *std = if curvature > 0.0 { curvature.sqrt().recip() } else { f64::NAN };
        }
        if let [a, b] = of_halves
            && shape.half_gap_rad > 0.0
        {
            std[3] = std[3].hypot(0.5 * (a.half_gap_rad / b.half_gap_rad).ln());
        }
        std
    }
}

impl Level {
    /// The probability that a torque c goes with a residual r as it does, given c·c and c·r of held-out parts, in one of all trials by
    /// chance. The amplitude a = Σ c·r / Σ c·c has the deviation √(Σ (c·r − a c·c)²) / Σ c·c, and as many degrees of freedom as
    /// parts hold the torque's power, (Σ c·c)² / Σ (c·c)² − 1: parts in which little is expected neither speak nor keep silent.
    fn by_chance(self, parts: &[[f64; 2]]) -> f64 {
        let sum = |of: &dyn Fn(&[f64; 2]) -> f64| parts.iter().map(of).sum::<f64>();
        let (square, along) = (sum(&|[cc, _]| *cc), sum(&|[_, cr]| *cr));
        let amplitude = along / square;
        let t = along / sum(&|[cc, cr]| (cr - amplitude * cc).powi(2)).sqrt();
        let freedom = square.powi(2) / sum(&|[cc, _]| cc * cc) - 1.0;
        let above = if t > 0.0 && freedom > 0.0 { 0.5 * two_sided(t, freedom) } else { 1.0 };
        (self.trials * above).min(1.0)
    }
}

impl Found {
    fn test(&mut self, shapes: &[Shape], (amplitudes, most): (&[f64], f64), top_hz: f64, level: f64) {
        let mut fails = Vec::new();
        if self.gain < LEAST_GAIN {
            fails.push(format!(
                "its gain on held-out rows is {:.1} nats, at least {LEAST_GAIN} required",
                self.gain
            ));
        }
        if self.p > level {
            fails.push(format!("chance alone makes such a finding with a probability of {:.2}", self.p));
        }
        if self.share < LEAST_SHARE {
            fails.push(format!("it explains only {:.1} % of the joint's residual", 100.0 * self.share));
        }
        let possible = |a: &f64| (AMPLITUDE[0]..=most).contains(a);
        if !amplitudes.iter().chain([&self.amplitude]).all(possible) {
            let halves: Vec<String> = amplitudes.iter().map(|a| format!("{a:.2}")).collect();
            fails.push(format!(
                "its torque is {:.2} times the value that the link's inertia implies ({} in the halves of the data)",
                self.amplitude,
                halves.join(" and ")
            ));
        }
        let ratio = |a: f64, b: f64| (a / b).max(b / a);
        let [a, b] = [shapes[0], shapes[1]];
        if shapes.iter().any(|s| s.is_at_the_end(top_hz)) {
            fails.push("its resonance is outside the frequency band of the recording".into());
        }
        let same_gap = self.shape.half_gap_rad == 0.0 || ratio(a.half_gap_rad, b.half_gap_rad) <= SAME_GAP;
        let same_hz = self.shape.half_gap_rad > 0.0 || ratio(a.hz, b.hz) <= SAME_HZ;
        if !same_gap || !same_hz {
            fails.push("the two halves of the data give different gears".into());
        }
        self.fails = fails;
    }

    /// True if its torque is as large as physics asks for.
    pub fn is_possible(&self) -> bool {
        self.amplitude >= AMPLITUDE[0]
    }

    /// Whether it passes all tests.
    pub fn confirmed(&self) -> bool {
        self.fails.is_empty()
    }
}

/// Halvings of the steps that refine a known shape.
fn halvings_of_known(shape: Shape) -> Range<i32> {
    if shape.half_gap_rad > 0.0 { HALVINGS_OF_KNOWN_PLAY } else { HALVINGS }
}

/// The blocks of time that fit while the others judge, and those others.
fn halves(blocks: &[Block]) -> [Vec<Block>; 2] {
    [0, 1].map(|half| blocks.iter().copied().filter(|(s, b)| (s + b / PARTS) % 2 == half).collect())
}

fn sums(moments: &[Moments], blocks: &[Block]) -> [f64; 2] {
    blocks.iter().fold([0.0; 2], |[cc, cr], (s, b)| {
        let [c, r] = moments[*s][*b];
        [cc + c, cr + r]
    })
}

/// A gear gives way; it does not stiffen. One that its load topples, with a torque beyond all bounds, explains nothing.
fn amplitude([cc, cr]: [f64; 2]) -> f64 {
    if cc > 0.0 && cc.is_finite() && cr.is_finite() { (cr / cc).max(0.0) } else { 0.0 }
}

/// What an amplitude gains in log-likelihood.
fn gain([cc, cr]: [f64; 2], amplitude: f64) -> f64 {
    if amplitude == 0.0 {
        return 0.0;
    }
    amplitude * cr - 0.5 * amplitude * amplitude * cc
}

fn fitted_gain(moments: [f64; 2]) -> f64 {
    let gain = gain(moments, amplitude(moments));
    if gain.is_finite() { gain } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::{Level, fitted_gain};

    /// Three parts that hold the torque's power are two degrees of freedom, however many there are beside them.
    #[test]
    fn parts_that_hold_the_power_decide() {
        let level = Level { level: 0.05, trials: 1.0 };
        let quiet = |k: i32| [1e-3, if k % 2 == 0 { 0.2 } else { -0.2 }];
        let with = |loud: &[[f64; 2]]| {
            level.by_chance(&(0..60).map(quiet).chain(loud.iter().copied()).collect::<Vec<_>>())
        };
        let [agree, alone] = [
            with(&[[20.0, 19.0], [20.0, 22.0], [20.0, 18.0]]),
            with(&[[20.0, 60.0], [20.0, 1.0], [20.0, 0.0]]),
        ];
        assert!(agree < 0.02 && alone > 0.1, "{agree} {alone}");
        assert_eq!(level.by_chance(&[[1.0, -2.0]; 4]), 1.0);
    }

    #[test]
    fn a_gear_that_its_load_topples_gains_nothing() {
        let topples = [
            [f64::NAN, 1.0],
            [f64::INFINITY, f64::NAN],
            [1.0, f64::INFINITY],
            [0.0, 0.0],
            [4.6e107, 1.6e215],
        ];
        assert!(topples.iter().all(|moments| fitted_gain(*moments) == 0.0));
        assert_eq!(fitted_gain([2.0, 4.0]), 4.0);
    }
}
