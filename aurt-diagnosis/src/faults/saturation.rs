//! Flat tops: measurements that end at a limit.
//!
//! The probability that a recording without a limit shows as many samples at its extreme value is that of a
//! Poisson variable: the density of values just below the extreme, times the resolution. Smooth signals in coarse
//! steps break the independence behind it; but the top step of a parabola holds at most half as many samples as the
//! eight below it, so a limit must hold more.

use super::{Fault, log10_poisson_tail, resolution, windows_s};
use crate::effects::saturation;
use crate::parameters::{ParameterValue, Parameters};
use aurt_recording::Recording;
use aurt_traits::RobotNames;

/// Fewest samples at a limit.
const FEWEST: usize = 5;

/// Decimal logarithm of the probability below which a limit is accepted: with some ten joints and recordings,
/// both sides each, one false alarm in a hundred thousand diagnoses.
pub(super) const LOG10_ACCEPTED: f64 = -7.0;

/// Steps of the resolution below the extreme that are compared with it.
const STEPS_BELOW: f64 = 8.5;

/// Samples at a limit per sample in the steps below it. A parabola in coarse steps reaches 0.5.
const RATIO: f64 = 2.0;

/// A limit is not smaller than this share of the largest magnitude: a constant reading of an idle drive is none.
const LEAST_SHARE_OF_PEAK: f64 = 0.05;

/// Both sides of a symmetric limit agree to this share.
const SYMMETRY: f64 = 0.02;

/// Share of clipped samples from which on a fit is visibly bent.
const SUFFICIENT_SHARE: f64 = 0.002;

/// Rows before and after a sample over which a joint has to move for the sample to count as evidence: a resting
/// joint may hold the same torque for long.
const MOTION_ROWS: usize = 25;

/// One side of a joint's measurement.
struct Side {
    /// Magnitude of the extreme value.
    limit: f64,
    /// Samples at it.
    at: Vec<usize>,
    log10_probability: f64,
}

/// The joints that are clipped, and which of their samples, `[joint][sample]`. Samples that are corrupt anyway do not
/// count.
pub(super) fn find(name: &str, recording: &Recording, spoilt: &[bool]) -> (Vec<Fault>, Vec<Vec<bool>>) {
    let samples = recording.samples();
    let mut clipped = vec![vec![false; samples]; recording.joints()];
    let mut faults = Vec::new();
    let Some(measurement) = &recording.measurement else { return (faults, clipped) };
    for (joint, series) in measurement.iter().enumerate() {
        let moves = moving(&recording.position_rad[joint]);
        let sides = [1.0, -1.0].map(|sign| side(series, sign, &moves, spoilt));
        let certain = |s: &Side| s.log10_probability < LOG10_ACCEPTED;
        let Some(limit) = sides.iter().filter(|s| certain(s)).map(|s| s.limit).max_by(f64::total_cmp) else {
            continue;
        };
        // The other side is clipped by the same limit, however rarely it gets there.
        let same = |s: &&Side| (s.limit - limit).abs() <= SYMMETRY * limit;
        for sample in sides.iter().filter(|s| certain(s) || same(s)).flat_map(|s| &s.at) {
            clipped[joint][*sample] = true;
        }
        let count = clipped[joint].iter().filter(|c| **c).count();
        let share = count as f64 / samples as f64;
        let log10 = sides.iter().map(|s| s.log10_probability).fold(0.0, f64::min);
        let unit = recording.unit.symbol();
        faults.push(Fault {
            effect: &saturation::EFFECT,
            joints: vec![joint],
            recording: name.to_owned(),
            windows_s: windows_s(&recording.time_s, &clipped[joint]),
            parameters: Parameters::from([
                ("limit".to_owned(), ParameterValue::exact(limit)),
                ("share".to_owned(), ParameterValue::exact(share)),
            ]),
            share,
            log10_probability: log10,
            suffices: share >= SUFFICIENT_SHARE,
            sentence: format!(
                "{name}: the measurement of {} is clipped at ±{limit:.4} {unit} in {count} rows \
                 ({:.2} %)",
                RobotNames::of_joints(recording.joints.names()).joint(joint),
                100.0 * share
            ),
        });
    }
    (faults, clipped)
}

/// Samples at the extreme of one side, and how probable they are without a limit.
fn side(series: &[f64], sign: f64, moves: &[bool], spoilt: &[bool]) -> Side {
    let sound = || series.iter().zip(spoilt).filter(|(_, bad)| !**bad).map(|(v, _)| *v);
    let extreme = sound().map(|v| sign * v).fold(f64::NEG_INFINITY, f64::max);
    let peak = sound().fold(0.0_f64, |m, v| m.max(v.abs()));
    let none = Side { limit: extreme, at: Vec::new(), log10_probability: 0.0 };
    let step = resolution(&sound().collect::<Vec<f64>>());
    if step == 0.0 || extreme <= LEAST_SHARE_OF_PEAK * peak {
        return none;
    }
    let below = |v: f64| extreme - sign * v;
    let at: Vec<usize> =
        (0..series.len()).filter(|k| !spoilt[*k] && below(series[*k]) < 0.25 * step).collect();
    let moving = at.iter().filter(|k| moves[**k]).count();
    let near = sound().filter(|v| (0.25 * step..STEPS_BELOW * step).contains(&below(*v))).count();
    if moving < FEWEST || (moving as f64) < RATIO * near as f64 {
        return none;
    }
    // Density of values beneath the extreme: the next hundredth of the samples and the range that they cover.
    let mut distances: Vec<f64> = sound().map(below).filter(|d| *d >= 0.25 * step).collect();
    let wanted = (series.len() / 100).max(10).min(distances.len().saturating_sub(1));
    if wanted == 0 {
        return none;
    }
    let (_, range, _) = distances.select_nth_unstable_by(wanted, f64::total_cmp);
    let expected = wanted as f64 * step / *range;
    Side { limit: extreme, log10_probability: log10_poisson_tail(expected, moving), at }
}

/// Whether the joint moves around each sample, by more than the resolution of its position.
pub(super) fn moving(position: &[f64]) -> Vec<bool> {
    let least = 3.0 * resolution(position);
    let last = position.len().saturating_sub(1);
    (0..position.len())
        .map(|k| {
            let around = &position[k.saturating_sub(MOTION_ROWS)..=(k + MOTION_ROWS).min(last)];
            let low = around.iter().copied().fold(f64::INFINITY, f64::min);
            let high = around.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            high - low > least
        })
        .collect()
}
