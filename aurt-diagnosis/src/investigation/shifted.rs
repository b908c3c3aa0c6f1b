//! Measurements of a later time.

use aurt_recording::Segment;

use crate::evidence::gram::{Moments, dot};
use crate::evidence::residuals::{LONGEST_MEMORY, residuals};
use crate::hypotheses::group::Switch;
use crate::investigation::Investigation;
use crate::recordings::rows::{Role, independent_share};
use crate::request::Question;

/// Puts the products of the model's columns with the measurement of a later time into moments.
pub(super) fn shift(
    question: &Question<'_>,
    investigation: &Investigation,
    used: &[Vec<usize>],
    target_only: bool,
    delay_s: f64,
    moments: &mut [Vec<Moments>; 2],
) {
    for (joint, used) in used.iter().enumerate() {
        for of_kind in moments.iter_mut() {
            used.iter().for_each(|k| of_kind[joint].right[*k] = 0.0);
            of_kind[joint].square = 0.0;
        }
    }
    for (r, rows) in investigation.rows.iter().enumerate().filter(|(_, r)| r.role != Role::Validation) {
        let kind = usize::from(rows.role == Role::Target);
        let by_s = if target_only && kind == 0 { 0.0 } else { delay_s };
        for (joint, own) in rows.joints.iter().enumerate() {
            let later = later(&question.recordings[r].data.data.segments, joint, by_s);
            let y: Vec<f64> = own
                .measurement
                .iter()
                .zip(&own.counts)
                .zip(later)
                .map(|((y, counts), change)| if *counts { y + change } else { 0.0 })
                .collect();
            let sums = &mut moments[kind][joint];
            for (_, start, end) in investigation.partition.fitted().filter(|p| p.0 == r) {
                let y = &y[start..end];
                used[joint].iter().for_each(|k| sums.right[*k] += dot(&own.column(*k)[start..end], y));
                sums.square += dot(y, y);
            }
        }
    }
}

/// Squared errors of a fit against the measurement of a later time over the rows that confirm: their sum for each joint, and its number
/// of independent rows.
pub(super) fn confirming_errors(
    question: &Question<'_>,
    investigation: &Investigation,
    (switches, coefficients): (&[Switch], &[f64]),
    target_only: bool,
    delay_s: f64,
) -> Vec<[f64; 2]> {
    let Investigation { confirm, partition, layout, .. } = investigation;
    let mut sums = vec![[0.0; 2]; layout.rows.len()];
    for (r, rows) in confirm.to_judge().iter().enumerate().filter(|(_, rows)| rows.rows() > 0) {
        let by_s = if target_only && rows.role == Role::Calibration { 0.0 } else { delay_s };
        let left = residuals(rows, layout, switches, coefficients);
        for (joint, (sum, left)) in sums.iter_mut().zip(&left).enumerate() {
            let later = later(&question.recordings[r].data.data.segments, joint, by_s);
            let errors = left.iter().zip(&later[partition.end_of_fit[r]..]).zip(&rows.joints[joint].counts);
            let errors: Vec<f64> =
                errors.filter(|(_, c)| **c).map(|((left, change), _)| left + change).collect();
            sum[0] += errors.iter().map(|e| e * e).sum::<f64>();
            sum[1] += independent_share(&errors, LONGEST_MEMORY) * errors.len() as f64;
        }
    }
    sums
}

/// By how much the measurement of a joint differs some time after each row, over all segments. Samples that are left out are
/// so before and after.
fn later(segments: &[Segment], joint: usize, by_s: f64) -> Vec<f64> {
    let mut change = Vec::new();
    for segment in segments {
        let count = segment.rows();
        let by_rows = by_s * segment.rate_hz / segment.decimation as f64;
        let left_out = segment.left_out.as_ref().is_some_and(|samples| samples[joint].contains(&true));
        if let Some(raw) = segment.raw_measurement.as_ref().filter(|_| left_out && by_rows != 0.0) {
            let mut changes: Vec<f64> = shifted(&raw[joint], by_s * segment.rate_hz)
                .iter()
                .zip(&raw[joint])
                .map(|(l, n)| l - n)
                .collect();
            segment.silence(joint, 0, &mut changes);
            let filtered = segment.parallel_filter.filter(&changes).unwrap_or(changes);
            change.extend(segment.at_rows(&filtered));
            continue;
        }
        match &segment.measurement {
            Some(measurement) if by_rows != 0.0 => {
                let y = &measurement[joint][..count];
                change.extend(shifted(y, by_rows).iter().zip(y).map(|(later, now)| later - now));
            }
            _ => change.extend(std::iter::repeat_n(0.0, count)),
        }
    }
    change
}

/// Rows on each side that a value between rows is made of.
const REACH: usize = 10;

/// A series some rows later, by the sinc with Lanczos' window; beyond the ends the last value. Rows are a few to a period of
/// the filter's cut-off: a polynomial through four of them is off by per cents there, and that moves the minimum.
fn shifted(y: &[f64], by: f64) -> Vec<f64> {
    let sinc = |x: f64| {
        let x = std::f64::consts::PI * x;
        if x == 0.0 { 1.0 } else { libm::sin(x) / x }
    };
    let (whole, part) = (by.floor(), by - by.floor());
    let reach = REACH as isize;
    let taps: Vec<(isize, f64)> = (1 - reach..=reach)
        .map(|k| {
            let x = part - k as f64;
            (whole as isize + k, sinc(x) * sinc(x / reach as f64))
        })
        .collect();
    let sum: f64 = taps.iter().map(|(_, weight)| weight).sum();
    let last = y.len().saturating_sub(1);
    let of = |row: usize, offset: isize| {
        y.get(row.saturating_add_signed(offset).min(last)).copied().unwrap_or(0.0)
    };
    (0..y.len())
        .map(|row| taps.iter().map(|(offset, weight)| weight * of(row, *offset)).sum::<f64>() / sum)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_limited_series_is_met_between_its_rows() {
        // Two tones below half of the Nyquist frequency.
        let at = |t: f64| (0.5 * t).sin() + 0.3 * (1.4 * t + 0.4).cos();
        let y: Vec<f64> = (0..80).map(|k| at(f64::from(k))).collect();
        for by in [0.5, -0.3, 2.7] {
            let later = shifted(&y, by);
            for row in 2 * REACH..60 {
                assert!((later[row] - at(row as f64 + by)).abs() < 2e-3, "{by} {row}");
            }
        }
        assert_eq!(shifted(&y, 500.0)[3].to_bits(), y[79].to_bits());
    }
}
