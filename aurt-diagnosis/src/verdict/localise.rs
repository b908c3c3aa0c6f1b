//! The windows of time in which a residual stands out.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::recordings::rows::{RecordingRows, independent_share};

/// Length of the bins in which windows are looked for, s.
const BIN_S: f64 = 0.5;

/// Probability that a recording of stationary noise shows a window on a joint.
const BY_CHANCE: f64 = 0.01;

/// Rows before and after a reversal in which its jolt shows: rows are as dense as the filter lets anything be seen.
const JOLT_ROWS: usize = 2;

/// Windows (s from the recording's first row) in which a joint's residual stands out of the rest of its recording, its
/// reversals apart: where it sticks and breaks loose is told by no window of time.
///
/// A bin of ν independent rows has the mean square σ²·χ²_ν/ν. It stands out above the quantile that the largest of all bins
/// exceeds with the probability [`BY_CHANCE`], σ² being the larger of the floor and of what the median bin tells.
pub fn windows(recording: &RecordingRows, joint: usize, residual: &[f64], floor: f64) -> Vec<[f64; 2]> {
    let bin = (BIN_S * recording.rate_hz).max(2.0) as usize;
    let velocity = &recording.joints[joint].velocity_rad_s;
    // Rest before and after a segment is cut: its ends are where the joint breaks loose and sticks.
    let ends = &recording.segment_starts;
    let turns: Vec<usize> = (0..=velocity.len())
        .filter(|k| {
            ends.contains(k) || (1..velocity.len()).contains(k) && velocity[*k] * velocity[*k - 1] <= 0.0
        })
        .collect();
    let jolted = |row: &usize| {
        let after = turns.partition_point(|turn| *turn + JOLT_ROWS <= *row);
        turns.get(after).is_some_and(|turn| row + JOLT_ROWS >= *turn)
    };
    let bins: Vec<Bin> = (0..residual.len())
        .step_by(bin)
        .map(|from| {
            let rows = (from..(from + bin).min(residual.len())).filter(|row| !jolted(row));
            rows.fold(Bin::default(), |b, row| b.with(residual[row]))
        })
        .collect();
    let out = standing_out(&bins, independent_share(residual, 4 * bin), floor);
    let time = |row: usize| recording.time_s[row.min(recording.rows() - 1)] - recording.time_s[0];
    let mut found: Vec<[f64; 2]> = Vec::new();
    for k in out {
        let window = [time(k * bin), time((k + 1) * bin)];
        match found.last_mut() {
            Some(last) if window[0] - last[1] < 1.5 * BIN_S => last[1] = window[1],
            _ => found.push(window),
        }
    }
    found
}

/// Rows of a stretch of time.
#[derive(Debug, Clone, Copy, Default)]
struct Bin {
    squares: f64,
    rows: f64,
}

impl Bin {
    fn with(self, residual: f64) -> Self {
        Self { squares: self.squares + residual * residual, rows: self.rows + 1.0 }
    }
}

/// The bins that stand out; a share of their rows is independent.
fn standing_out(bins: &[Bin], independent_share: f64, floor: f64) -> Vec<usize> {
    let freedom = |bin: &Bin| (bin.rows * independent_share).max(1.0);
    let of = |bin: &Bin| ChiSquared::new(freedom(bin)).ok();
    // The median of χ²_ν is ν (1 − 2/9ν)³ to a few per cent (Wilson and Hilferty 1931).
    let tells = |bin: &Bin| bin.squares / bin.rows / (1.0 - 2.0 / (9.0 * freedom(bin))).powi(3);
    let mut told: Vec<f64> = bins.iter().filter(|bin| bin.squares > 0.0).map(tells).collect();
    told.sort_by(f64::total_cmp);
    let Some(median) = told.get(told.len() / 2) else { return Vec::new() };
    let variance = median.max(floor * floor);
    let chance = BY_CHANCE / told.len() as f64;
    let stands_out = |bin: &Bin| {
        let square = bin.squares / bin.rows * freedom(bin) / variance;
        bin.squares > 0.0 && of(bin).is_some_and(|chi_squared| chi_squared.sf(square) < chance)
    };
    (0..bins.len()).filter(|k| stands_out(&bins[*k])).collect()
}

#[cfg(test)]
mod tests {
    use super::{Bin, independent_share, standing_out};
    use crate::dice::Dice;

    const BIN: usize = 8;

    /// Noise that remembers `memory` of a row, and how many of its bins stand out, with a burst in one of them.
    fn found(seed: u64, memory: f64, burst: f64) -> usize {
        let mut dice = Dice(seed);
        let mut value = 0.0;
        let noise: Vec<f64> = (0..120 * BIN)
            .map(|row| {
                value = memory * value + (1.0 - memory * memory).sqrt() * dice.normal();
                value + if row / BIN == 40 { burst } else { 0.0 }
            })
            .collect();
        // The last bin is cut short.
        let bins: Vec<Bin> = noise[..noise.len() - 5]
            .chunks(BIN)
            .map(|rows| rows.iter().fold(Bin::default(), |b, r| b.with(*r)))
            .collect();
        standing_out(&bins, independent_share(&noise, 4 * BIN), 0.0).len()
    }

    #[test]
    fn noise_with_a_memory_shows_no_windows_and_a_burst_is_one() {
        for memory in [0.0, 0.7, 0.95] {
            let windows = (0..300).filter(|seed| found(*seed, memory, 0.0) > 0).count();
            assert!(windows <= 12, "{windows} of 300 with {memory}: three are expected");
            let bursts = (0..100).filter(|seed| found(*seed, memory, 8.0) == 1).count();
            assert!(bursts >= 90, "{bursts} of 100 with {memory}");
        }
    }
}
