//! The spectrum of noise in the residual of a right model.

use aurt_recording::{
    Interpolation, Interpolator, PositionNoise, PreprocessOptions, Preprocessed, Recording, Segment,
    WhiteAndMarkov, ZeroPhase, acceleration_gain, velocity_gain, white_level_at,
};

use super::residual;
use super::sensitivity::Sensitivity;
use crate::error::DiagnosisError;
use crate::recordings::rows::Fit;

/// Ratio of the edges of the bands in which the residual's spectrum is fitted.
const BAND: f64 = 1.25;
/// Share of an acceleration's power that is motion, at least: beyond, nothing is known of the inertia.
const LEAST_MOTION: f64 = 0.1;
/// Points of an integral over a band of frequencies.
const POINTS: usize = 256;

/// The noise of one recording: of its instruments, and of each of its segments.
#[derive(Debug, Clone)]
pub struct RecordingNoise {
    /// The positions' noise as recorded, joint by joint.
    pub positions: Vec<PositionNoise>,
    /// The measurement's noise on the recording's grid, in the unit of the model, joint by joint.
    pub measurement: Vec<WhiteAndMarkov>,
    /// The segments, in the order of the preprocessed recording.
    pub segments: Vec<SegmentNoise>,
}

/// The noise in a segment's residual at full rate: measured less predicted, before the parallel filter.
///
/// S_j(f) = S_e,j(f) + Σ_k |P(f)|² S_n,k(f) [⟨(∂τ_j/∂q_k − A(f) ∂τ_j/∂q̈_k)²⟩ + V(f)² ⟨(∂τ_j/∂q̇_k)²⟩], with the
/// measurement's noise S_e, the positions' S_n, the position filter's gain P, and the gains A ≈ (2πf)² and V ≈ 2πf of
/// the stencils that differentiate; means along the motion, of the fitted model's own prediction.
#[derive(Debug, Clone)]
pub struct SegmentNoise {
    /// Samples per second.
    pub rate_hz: f64,
    measurement: Vec<WhiteAndMarkov>,
    positions: Vec<PositionNoise>,
    position_filter: ZeroPhase,
    position_grid: Interpolation,
    measurement_grid: Interpolation,
    pub(super) sensitivity: Sensitivity,
}

impl RecordingNoise {
    /// The noise of a recording as it was preprocessed with `options`, under a fitted model.
    ///
    /// The positions' levels come from differences on the recording's own stamps; the measurement's from the spectrum of
    /// what the model leaves in calm pieces, above `f_dyn_hz`, where the motion has nothing; below, the fitted form
    /// stands, and never above what is left.
    ///
    /// # Errors
    /// What the model and the filters report.
    pub fn evaluate(
        recording: &Recording,
        data: &Preprocessed,
        options: &PreprocessOptions,
        fit: &Fit<'_>,
    ) -> Result<Self, DiagnosisError> {
        let stamps_s = stamps_in_use(recording, data);
        let positions: Vec<PositionNoise> =
            recording.position_rad.iter().map(|q| PositionNoise::of(&stamps_s, q)).collect();
        let gain = |j: usize| options.gains.as_ref().map_or(1.0, |g| g[j].abs());
        let white: Vec<f64> = recording.measurement.as_ref().map_or_else(Vec::new, |m| {
            m.iter().enumerate().map(|(j, m)| gain(j) * white_level_at(&stamps_s, m)).collect()
        });
        let delayed = options.delay_s.as_ref().is_some_and(|d| d.iter().any(|d| *d != 0.0));
        let segment = |segment: &Segment| -> Result<SegmentNoise, DiagnosisError> {
            let motion = segment.motion.view();
            let native_hz = positions.first().map_or(segment.rate_hz, |p| p.rate_hz);
            let interpolated = Interpolation::between(&recording.time_s, motion.time_s(), native_hz);
            let none = Interpolation::none(native_hz);
            Ok(SegmentNoise {
                rate_hz: segment.rate_hz,
                measurement: white
                    .iter()
                    .map(|std| WhiteAndMarkov::white(*std, native_hz.min(segment.rate_hz)))
                    .collect(),
                positions: positions.clone(),
                position_filter: ZeroPhase::butterworth(
                    segment.parallel_filter.order(),
                    options.effective_position_cutoff_hz(),
                    segment.rate_hz,
                )?,
                position_grid: if data.report.resampled { interpolated.clone() } else { none.clone() },
                measurement_grid: if data.report.resampled || delayed { interpolated } else { none },
                sensitivity: Sensitivity::evaluate(segment, fit)?,
            })
        };
        let mut segments = data.segments.iter().map(segment).collect::<Result<Vec<_>, _>>()?;
        let mut measurement: Vec<WhiteAndMarkov> =
            segments.first().map_or_else(Vec::new, |s| s.measurement.clone());
        let spectra = residual::spectra(&data.segments, fit, options.f_dyn_hz)?;
        if let (Some(spectra), Some(first)) = (spectra, segments.first()) {
            for (j, (noise, spectrum)) in measurement.iter_mut().zip(&spectra).enumerate() {
                let fitted = WhiteAndMarkov::fit(
                    &spectrum.bands(BAND),
                    options.f_dyn_hz,
                    noise.rate_hz,
                    |f| first.measurement_grid.power_gain(f, Interpolator::Linear),
                    |f| first.position_psd(j, f),
                );
                *noise = fitted.unwrap_or(*noise);
            }
        }
        for segment in &mut segments {
            segment.measurement.clone_from(&measurement);
        }
        Ok(Self { positions, measurement, segments })
    }

    /// The same noise under another model, which multiplies that of the positions with other torques.
    pub(crate) fn under(&self, data: &Preprocessed, fit: &Fit<'_>) -> Result<Self, DiagnosisError> {
        let segment = |(segment, noise): (&Segment, &SegmentNoise)| {
            Ok(SegmentNoise { sensitivity: Sensitivity::evaluate(segment, fit)?, ..noise.clone() })
        };
        let segments = data.segments.iter().zip(&self.segments).map(segment);
        Ok(Self { segments: segments.collect::<Result<_, DiagnosisError>>()?, ..self.clone() })
    }

    /// Mean square that noise leaves of a joint over all rows of a recording.
    pub(crate) fn mean_left(&self, joint: usize, data: &Preprocessed) -> Result<f64, DiagnosisError> {
        let rows: usize = data.segments.iter().map(Segment::rows).sum();
        let segments = data.segments.iter().zip(&self.segments);
        let of_segment = |(segment, noise): (&Segment, &SegmentNoise)| {
            Ok(noise.power_left(joint, segment)? * segment.rows() as f64 / rows.max(1) as f64)
        };
        segments.map(of_segment).sum()
    }

    /// Replaces the measurement's noise of a joint.
    pub(super) fn set_measurement(&mut self, joint: usize, noise: WhiteAndMarkov) {
        self.measurement[joint] = noise;
        for segment in &mut self.segments {
            segment.measurement[joint] = noise;
        }
    }
}

/// The stamps that preprocessing goes by: the recording's own, or those of the uniform grid that it took them for; what
/// they are off the grid then is position noise.
pub(crate) fn stamps_in_use(recording: &Recording, data: &Preprocessed) -> Vec<f64> {
    let rate_hz = data.report.rate_hz;
    let Some(first_s) = recording.time_s.first().filter(|_| !data.report.resampled) else {
        return recording.time_s.clone();
    };
    recording.time_s.iter().map(|t| first_s + ((t - first_s) * rate_hz).round() / rate_hz).collect()
}

impl SegmentNoise {
    /// One-sided power spectrum of a joint's noise at full rate, Nm²/Hz (A²/Hz for a model of currents).
    pub fn psd(&self, joint: usize, frequency_hz: f64) -> f64 {
        self.measurement_psd(joint, frequency_hz) + self.position_psd(joint, frequency_hz)
    }

    /// The measurement's part of [`Self::psd`].
    pub fn measurement_psd(&self, joint: usize, frequency_hz: f64) -> f64 {
        let noise = &self.measurement[joint];
        noise.psd(frequency_hz) * self.measurement_grid.power_gain(frequency_hz, Interpolator::Linear)
    }

    /// The positions' part of [`Self::psd`].
    pub fn position_psd(&self, joint: usize, frequency_hz: f64) -> f64 {
        let acceleration = acceleration_gain(frequency_hz, self.rate_hz);
        let velocity = velocity_gain(frequency_hz, self.rate_hz);
        self.sensitivity.slopes[joint]
            .iter()
            .enumerate()
            .map(|(k, slopes)| {
                let by_motion = slopes.position - 2.0 * acceleration * slopes.cross
                    + acceleration * acceleration * slopes.acceleration
                    + velocity * velocity * slopes.velocity;
                by_motion * self.filtered_position_psd(k, frequency_hz)
            })
            .sum()
    }

    /// One-sided power spectrum of the noise of a joint's filtered position, rad²/Hz.
    pub fn filtered_position_psd(&self, joint: usize, frequency_hz: f64) -> f64 {
        let noise = &self.positions[joint];
        let gain = self.position_filter.gain(frequency_hz);
        // A grid coarser than the recording folds what lies above it; it keeps the power.
        let folded = (noise.rate_hz / self.rate_hz).max(1.0);
        gain * gain
            * folded
            * noise.psd(frequency_hz)
            * self.position_grid.power_gain(frequency_hz, Interpolator::Spline)
    }

    /// Mean square of a joint's noise behind a filter.
    pub fn power_behind(&self, joint: usize, filter: &ZeroPhase) -> f64 {
        integral(0.0, 0.5 * self.rate_hz, |f| self.psd(joint, f) * filter.gain(f).powi(2))
    }

    /// The measurement's part of [`Self::power_behind`].
    pub(super) fn measured_power_behind(&self, joint: usize, filter: &ZeroPhase) -> f64 {
        integral(0.0, 0.5 * self.rate_hz, |f| self.measurement_psd(joint, f) * filter.gain(f).powi(2))
    }

    /// Mean square of a joint's noise behind the segment's parallel filter in the residual of a *fitted* model: beside
    /// [`Self::power_behind`], what the noise in the accelerations has taken from the fitted inertias. Where of the power of
    /// the filtered acceleration q̈_k the share λ_k is motion and the rest noise, least squares finds λ M in place of M, and
    /// leaves M²λ⟨noise²⟩ = ⟨noise²⟩ M̂²/λ (Fuller 1987, ch. 1).
    ///
    /// # Errors
    /// What the filter reports.
    pub fn power_left(&self, joint: usize, segment: &Segment) -> Result<f64, DiagnosisError> {
        let filter = &segment.parallel_filter;
        let motion = segment.motion.view();
        let mut power = self.power_behind(joint, filter);
        for (k, slopes) in self.sensitivity.slopes[joint].iter().enumerate() {
            let noise = integral(0.0, 0.5 * self.rate_hz, |f| {
                let gain = acceleration_gain(f, self.rate_hz) * filter.gain(f);
                gain * gain * self.filtered_position_psd(k, f)
            });
            if noise == 0.0 {
                continue;
            }
            let seen = filter.filter(motion.acceleration_rad_s2(k))?;
            let all = seen.iter().map(|a| a * a).sum::<f64>() / seen.len() as f64;
            let share = (1.0 - noise / all.max(f64::MIN_POSITIVE)).max(LEAST_MOTION);
            power += (1.0 / share - 1.0) * slopes.acceleration * noise;
        }
        Ok(power)
    }
}

/// ∫ psd df, by midpoints that lie denser at low frequencies, where memory is.
pub(super) fn integral(low_hz: f64, high_hz: f64, psd: impl Fn(f64) -> f64) -> f64 {
    if high_hz <= low_hz {
        return 0.0;
    }
    let span_hz = high_hz - low_hz;
    (0..POINTS)
        .map(|k| {
            let (a, b) = (k as f64 / POINTS as f64, (k + 1) as f64 / POINTS as f64);
            let middle = 0.5 * (a + b);
            psd(low_hz + span_hz * middle * middle) * span_hz * (b * b - a * a)
        })
        .sum()
}
