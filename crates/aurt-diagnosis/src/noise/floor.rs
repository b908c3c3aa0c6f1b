//! The noise floor: the residual that a perfect model would leave, from the recording alone.

use aurt_calibration::for_each_predicted_block;
use aurt_recording::{PreprocessOptions, Preprocessed, Recording, Segment, preprocess, white_level};

use crate::error::DiagnosisError;
use crate::recordings::rows::{Fit, RecordingRows};

/// Residual variance of each joint that measurement noise alone would leave after filter and decimation:
/// the white part of the measurement, and the white part of the positions propagated through differentiation,
/// model and filter (a second pass over positions with as much noise again).
///
/// # Errors
/// What preprocessing and models report.
pub fn noise_floor(
    recording: &Recording,
    data: &Preprocessed,
    options: &PreprocessOptions,
    fit: &Fit<'_>,
    rows: &RecordingRows,
) -> Result<Vec<f64>, DiagnosisError> {
    let joints = fit.model.joints();
    let mut disturbed = recording.clone();
    let mut random = Normal::new(0x5eed);
    for series in &mut disturbed.position_rad {
        let level = white_level(series);
        series.iter_mut().for_each(|q| *q += level * random.next());
    }
    let disturbed = preprocess(&disturbed, options)?;
    let mut propagated = vec![0.0; joints];
    let mut first = 0;
    for (clean, noisy) in data.segments.iter().zip(&disturbed.segments) {
        let count = clean.rows().min(noisy.rows());
        let a = predicted_rows(clean, fit, count)?;
        let b = predicted_rows(noisy, fit, count)?;
        for (joint, sum) in propagated.iter_mut().enumerate() {
            let counts = &rows.joints[joint].counts[first..];
            *sum += a[joint]
                .iter()
                .zip(&b[joint])
                .zip(counts)
                .filter(|(_, counts)| **counts)
                .map(|((x, y), _)| (x - y).powi(2))
                .sum::<f64>();
        }
        first += clean.rows();
    }
    let gains = options.gains.clone().unwrap_or_else(|| vec![1.0; joints]);
    let filter_power = data.segments.first().map_or(1.0, |s| {
        1.0 / (s.decimation as f64
            * aurt_calibration::noise_bandwidth_factor(&s.parallel_filter, s.decimation))
    });
    Ok((0..joints)
        .map(|j| {
            let measured = recording.measurement.as_ref().map_or(0.0, |m| white_level(&m[j]) * gains[j]);
            measured * measured * filter_power
                + propagated[j] / rows.joints[j].counted(0, rows.rows()).max(1.0)
        })
        .collect())
}

fn predicted_rows(segment: &Segment, fit: &Fit<'_>, count: usize) -> Result<Vec<Vec<f64>>, DiagnosisError> {
    let mut rows = vec![Vec::with_capacity(count); fit.model.joints()];
    for_each_predicted_block(fit.model, segment, fit.load, fit.coefficients, |block| {
        for (joint, series) in rows.iter_mut().enumerate() {
            series.extend_from_slice(block.column(joint));
        }
    })?;
    rows.iter_mut().for_each(|series| series.truncate(count));
    Ok(rows)
}

/// Normal deviates from a fixed linear congruential sequence: the sum of twelve uniforms, which is all that a
/// noise power needs.
struct Normal(u64);

impl Normal {
    const fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> f64 {
        let sum: f64 = (0..12)
            .map(|_| {
                self.0 =
                    self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            })
            .sum();
        sum - 6.0
    }
}
