//! What the fitted model leaves at full rate, where nothing jolts.

use std::ops::Range;

use aurt_calibration::{for_each_tile, predict_tile};
use aurt_recording::{MedianSpectrum, Segment};

use crate::error::DiagnosisError;
use crate::recordings::rows::Fit;

/// A joint rests below this speed, rad/s.
const REST_RAD_S: f64 = 0.01;
/// Time before and after a start, stop or reversal that does not count, s: dry friction jumps there.
const JOLT_S: f64 = 0.1;
/// Lengths of pieces, in periods of f_dyn: the first resolves a quarter of it; where the joint turns too often for these,
/// shorter ones see what lies above f_dyn.
const PIECE_PERIODS: [f64; 3] = [LONGEST, 2.0, 1.0];
const LONGEST: f64 = 4.0;
/// Fewer pieces than this say nothing. Where so few are calm, those with some jolts are taken, less the steps at them; where
/// these are few as well, all.
const FEWEST_PIECES: usize = 8;

/// Spectra of the unfiltered residual of each joint, over the calm pieces of all segments where there are enough; `None` where
/// a segment has no measurement at full rate.
pub(super) fn spectra(
    segments: &[Segment],
    fit: &Fit<'_>,
    f_dyn_hz: f64,
) -> Result<Option<Vec<MedianSpectrum>>, DiagnosisError> {
    let Some(rate_hz) = segments.first().map(|s| s.rate_hz) else { return Ok(None) };
    let mut left = Vec::new();
    for segment in segments {
        let Some(residual) = full_rate(segment, fit)? else { return Ok(None) };
        left.push(residual);
    }
    let of = |joint: usize, (pieces, periods): (Pieces, f64)| {
        let mut spectrum = MedianSpectrum::new(rate_hz, periods / f_dyn_hz);
        for (segment, left) in segments.iter().zip(&left) {
            let (left, calm) = (&left[joint], calm_samples(segment, joint));
            match pieces {
                Pieces::Calm => spectrum.push(left, |k| calm[k]),
                Pieces::Between => spectrum.push_between(left, &spans(&calm)),
                Pieces::All => spectrum.push(left, |_| true),
            }
        }
        spectrum
    };
    let enough = |spectrum: &MedianSpectrum| spectrum.pieces() >= FEWEST_PIECES;
    let of_joint = |joint: usize| {
        let calm = PIECE_PERIODS.map(|periods| (Pieces::Calm, periods));
        let few = calm.into_iter().chain([(Pieces::Between, LONGEST)]);
        few.map(|kind| of(joint, kind)).find(enough).unwrap_or_else(|| of(joint, (Pieces::All, LONGEST)))
    };
    Ok(Some((0..fit.model.joints()).map(of_joint).collect()))
}

/// Which pieces of a residual make its spectrum.
#[derive(Clone, Copy)]
enum Pieces {
    /// Those in which the joint is calm throughout.
    Calm,
    /// All of them, the jolts at the turns of the joint taken off.
    Between,
    /// All of them as they are.
    All,
}

/// The spans of samples that are not calm.
fn spans(calm: &[bool]) -> Vec<Range<usize>> {
    let mut spans: Vec<Range<usize>> = Vec::new();
    for k in (0..calm.len()).filter(|k| !calm[*k]) {
        match spans.last_mut().filter(|last| last.end == k) {
            Some(last) => last.end = k + 1,
            None => spans.push(k..k + 1),
        }
    }
    spans
}

/// Measured less predicted, `[joint][sample]`.
fn full_rate(segment: &Segment, fit: &Fit<'_>) -> Result<Option<Vec<Vec<f64>>>, DiagnosisError> {
    let Some(measured) = &segment.raw_measurement else { return Ok(None) };
    let samples = segment.motion.samples();
    let mut residual: Vec<Vec<f64>> = measured.iter().map(|m| m[..samples].to_vec()).collect();
    let mut predicted = Vec::new();
    for_each_tile(fit.model, segment, fit.load, |start, tile| {
        let count = tile.samples();
        predicted.resize(residual.len() * count, 0.0);
        predict_tile(fit.model, tile, fit.coefficients, count, &mut predicted);
        for (joint, series) in residual.iter_mut().enumerate() {
            let left = &mut series[start..start + count];
            for (r, p) in left.iter_mut().zip(&predicted[joint * count..]) {
                *r -= p;
            }
        }
    })?;
    Ok(Some(residual))
}

fn calm_samples(segment: &Segment, joint: usize) -> Vec<bool> {
    let motion = segment.motion.view();
    let velocity = motion.velocity_rad_s(joint);
    let reach = (JOLT_S * segment.rate_hz).ceil() as usize;
    let mut calm = vec![true; velocity.len()];
    let rests = |k: usize| velocity[k].abs() < REST_RAD_S;
    for k in 0..velocity.len() {
        if rests(k) || k > 0 && velocity[k] * velocity[k - 1] < 0.0 {
            calm[k.saturating_sub(reach)..(k + reach + 1).min(velocity.len())].fill(false);
        }
    }
    calm
}
