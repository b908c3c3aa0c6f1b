use crate::error::RecordingError;
use crate::preprocess::butterworth::{Butterworth, Section};

/// Series that are filtered side by side, one in each lane.
const LANES: usize = 8;

/// Lowest and highest cut-off as shares of the Nyquist frequency. At the ends the poles come so close to 1 and −1
/// that about eight digits of the filtered series are left.
pub(crate) const CUTOFF_RANGE: [f64; 2] = [1e-4, 1.0 - 1e-4];

/// A Butterworth low-pass run forward and then backward over a whole series, so that nothing lags: the gain
/// is the filter's squared, the phase zero.
///
/// Equal to `scipy.signal.sosfiltfilt` with its defaults: the series is continued at both ends by
/// [`Self::padding`] samples mirrored through the end points (`padtype="odd"`), and both passes start in the
/// steady state of their first sample.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroPhase {
    design: Butterworth,
    cutoff_hz: f64,
    rate_hz: f64,
}

impl ZeroPhase {
    /// Forward–backward Butterworth low-pass; `order` counts one pass.
    ///
    /// # Errors
    /// [`RecordingError::Cutoff`] unless 1e-4 ≤ `cutoff_hz` / (`rate_hz`/2) ≤ 1 − 1e-4 (beyond, rounding drowns the
    /// filter);
    /// [`RecordingError::FilterOrder`] unless 1 ≤ `order` ≤ 12 (above, second-order sections lose digits).
    pub fn butterworth(order: usize, cutoff_hz: f64, rate_hz: f64) -> Result<Self, RecordingError> {
        if !(1..=12).contains(&order) {
            return Err(RecordingError::FilterOrder { order });
        }
        let normalized = 2.0 * cutoff_hz / rate_hz;
        let [lowest, highest] = CUTOFF_RANGE;
        if !(lowest..=highest).contains(&normalized) || !rate_hz.is_finite() {
            return Err(RecordingError::Cutoff { cutoff_hz, rate_hz });
        }
        Ok(Self { design: Butterworth::low_pass(order, normalized), cutoff_hz, rate_hz })
    }

    /// Frequency at which one pass has the gain 1/√2, in Hz.
    #[must_use]
    pub const fn cutoff_hz(&self) -> f64 {
        self.cutoff_hz
    }

    /// Sampling rate of the series it is made for, in Hz.
    #[must_use]
    pub const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Order of one pass.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.design.order
    }

    /// The second-order sections, in the order in which they are applied.
    #[must_use]
    pub fn sections(&self) -> &[Section] {
        &self.design.sections
    }

    /// Samples by which a series is continued at each end; a series must be longer than this.
    #[must_use]
    pub fn padding(&self) -> usize {
        self.design.padding()
    }

    /// The gain |H(f)|² that forward and backward pass have together at a frequency.
    #[must_use]
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * frequency_hz / self.rate_hz);
        let (sin2, cos2) = (2.0 * sin * cos, cos * cos - sin * sin);
        let power = |c: [f64; 3]| {
            let (re, im) = (c[0] + c[1] * cos + c[2] * cos2, c[1] * sin + c[2] * sin2);
            re * re + im * im
        };
        self.design.sections.iter().map(|s| power(s.b) / power([1.0, s.a[0], s.a[1]])).product()
    }

    pub(crate) const fn design(&self) -> &Butterworth {
        &self.design
    }

    /// The filtered series, of the same length.
    ///
    /// # Errors
    /// [`RecordingError::TooShortToFilter`] unless the series is longer than [`Self::padding`].
    pub fn filter(&self, series: &[f64]) -> Result<Vec<f64>, RecordingError> {
        let mut out = self.filter_all(&[series])?;
        Ok(out.pop().unwrap_or_default())
    }

    /// Several series of one length, each filtered by itself; eight cost about as much as one.
    ///
    /// # Errors
    /// [`RecordingError::TooShortToFilter`] unless the series are longer than [`Self::padding`];
    /// [`RecordingError::Count`] if their lengths differ.
    pub fn filter_all<S: AsRef<[f64]>>(&self, series: &[S]) -> Result<Vec<Vec<f64>>, RecordingError> {
        let samples = series.first().map_or(0, |s| s.as_ref().len());
        if let Some(other) = series.iter().find(|s| s.as_ref().len() != samples) {
            return Err(RecordingError::Count {
                what: "samples of a series to filter".into(),
                expected: samples,
                found: other.as_ref().len(),
            });
        }
        let padding = self.padding();
        if !series.is_empty() && samples <= padding {
            return Err(RecordingError::TooShortToFilter { samples, needed: padding + 1 });
        }
        let mut extended = vec![[0.0; LANES]; samples + 2 * padding];
        let mut out = Vec::with_capacity(series.len());
        for group in series.chunks(LANES) {
            for (lane, s) in group.iter().enumerate() {
                extend_oddly(s.as_ref(), padding, |k, value| extended[k][lane] = value);
            }
            run(&self.design.sections, extended.iter_mut());
            run(&self.design.sections, extended.iter_mut().rev());
            for lane in 0..group.len() {
                out.push(extended[padding..padding + samples].iter().map(|row| row[lane]).collect());
            }
        }
        Ok(out)
    }
}

/// Writes `series`, continued by `padding` samples mirrored through its first and last point.
fn extend_oddly(series: &[f64], padding: usize, mut write: impl FnMut(usize, f64)) {
    let (first, last) = (series[0], series[series.len() - 1]);
    for k in 0..padding {
        write(k, 2.0 * first - series[padding - k]);
    }
    for (k, value) in series.iter().enumerate() {
        write(padding + k, *value);
    }
    for k in 0..padding {
        write(padding + series.len() + k, 2.0 * last - series[series.len() - 2 - k]);
    }
}

/// State of a section (transposed direct form II) that answers the constant input 1, and its output then.
pub(crate) fn steady_state(section: &Section) -> ([f64; 2], f64) {
    let [b0, b1, b2] = section.b;
    let [a1, a2] = section.a;
    let gain = (b0 + b1 + b2) / (1.0 + a1 + a2);
    let z2 = b2 - a2 * gain;
    ([b1 - a1 * gain + z2, z2], gain)
}

/// One pass over the lanes, in place, started in the steady state of the first sample. All sections are
/// applied to a sample before the next one is touched.
fn run<'a>(sections: &[Section], samples: impl Iterator<Item = &'a mut [f64; LANES]>) {
    let mut samples = samples.peekable();
    let Some(first) = samples.peek().map(|s| **s) else { return };
    let mut states = Vec::with_capacity(sections.len());
    let mut level = 1.0;
    for section in sections {
        let ([z1, z2], gain) = steady_state(section);
        states.push((*section, first.map(|x| z1 * level * x), first.map(|x| z2 * level * x)));
        level *= gain;
    }
    for sample in samples {
        let mut x = *sample;
        for (section, z1, z2) in &mut states {
            let [b0, b1, b2] = section.b;
            let [a1, a2] = section.a;
            for lane in 0..LANES {
                let y = b0 * x[lane] + z1[lane];
                z1[lane] = b1 * x[lane] - a1 * y + z2[lane];
                z2[lane] = b2 * x[lane] - a2 * y;
                x[lane] = y;
            }
        }
        *sample = x;
    }
}
