use crate::error::RecordingError;
use crate::preprocess::butterworth::{Butterworth, Section};

/// Series that are filtered side by side, one in each lane.
const LANES: usize = 8;

/// Share of a step that is left of it beyond the filter's [memory](ZeroPhase::memory).
const SETTLED: f64 = 1e-3;

/// Order of both Butterworth filters of preprocessing, one way (paper, section IV).
pub(crate) const FILTER_ORDER: usize = 4;

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
    pub const fn cutoff_hz(&self) -> f64 {
        self.cutoff_hz
    }

    /// Sampling rate of the series it is made for, in Hz.
    pub const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Order of one pass.
    pub const fn order(&self) -> usize {
        self.design.order
    }

    /// The second-order sections, in the order in which they are applied.
    pub fn sections(&self) -> &[Section] {
        &self.design.sections
    }

    /// Samples by which a series is continued at each end; a series must be longer than this.
    pub fn padding(&self) -> usize {
        self.design.padding()
    }

    /// For how many samples the filter remembers: after these its step response stays within 1e-3 of the step, on either
    /// side. An output this far from the ends of its series is what a longer series would give, to that share of the difference
    /// between the true series and the one by which the filter continues it.
    pub fn memory(&self) -> usize {
        let reach = self.design.decay_samples(SETTLED * SETTLED) + self.padding();
        let mut impulse = vec![0.0; 2 * reach + 1];
        impulse[reach] = 1.0;
        let Ok(response) = self.filter(&impulse) else { return reach };
        let mut step = 0.0;
        let settled = |h: &&f64| {
            step += **h;
            f64::abs(step) <= SETTLED
        };
        reach - response.iter().take_while(settled).count().min(reach)
    }

    /// The gain |H(f)|² that forward and backward pass have together at a frequency.
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
            return Err(RecordingError::count(
                "samples of a series to filter",
                samples,
                other.as_ref().len(),
            ));
        }
        let padding = self.padding();
        if !series.is_empty() && samples <= padding {
            return Err(RecordingError::TooShortToFilter { samples, needed: padding + 1 });
        }
        Ok(self.run(series, padding, mirrored_through))
    }

    /// Positions of a robot that may move at the ends, filtered: they are continued with the velocity that they have there,
    /// and with their acceleration, for twice the [memory](Self::memory).
    pub(crate) fn filter_positions(&self, positions: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, RecordingError> {
        let (padding, samples) = (self.padding(), positions.first().map_or(0, Vec::len));
        if samples <= padding {
            return self.filter_all(positions);
        }
        let fitted = self.memory().max(padding).min(samples - 1);
        let continued = (2 * fitted).min(samples - 1);
        Ok(self.run(positions, continued, |q: &dyn Fn(usize) -> f64| {
            let slope = slope_at_start(fitted, q);
            Box::new(move |k| q(k) - 2.0 * slope * k as f64)
        }))
    }

    /// Each series, continued at both ends by `padding` samples, forward and backward. `continued` says what a series is k
    /// samples before its first; of the reversed series it says what comes after the last.
    fn run<S: AsRef<[f64]>>(
        &self,
        series: &[S],
        padding: usize,
        continued: impl for<'a> Fn(&'a dyn Fn(usize) -> f64) -> Box<dyn Fn(usize) -> f64 + 'a>,
    ) -> Vec<Vec<f64>> {
        let samples = series.first().map_or(0, |s| s.as_ref().len());
        let mut extended = vec![[0.0; LANES]; samples + 2 * padding];
        let mut out = Vec::with_capacity(series.len());
        for group in series.chunks(LANES) {
            for (lane, s) in group.iter().enumerate() {
                let s = s.as_ref();
                let (ahead, reversed) = (|k: usize| s[k], |k: usize| s[samples - 1 - k]);
                let (before, after) = (continued(&ahead), continued(&reversed));
                for k in 1..=padding {
                    extended[padding - k][lane] = before(k);
                    extended[padding + samples - 1 + k][lane] = after(k);
                }
                for (row, value) in extended[padding..].iter_mut().zip(s) {
                    row[lane] = *value;
                }
            }
            run(&self.design.sections, extended.iter_mut());
            run(&self.design.sections, extended.iter_mut().rev());
            for lane in 0..group.len() {
                out.push(extended[padding..padding + samples].iter().map(|row| row[lane]).collect());
            }
        }
        out
    }
}

fn mirrored_through<'a>(series: &'a dyn Fn(usize) -> f64) -> Box<dyn Fn(usize) -> f64 + 'a> {
    Box::new(move |k| 2.0 * series(0) - series(k))
}

/// The slope per sample, at sample 0, of the cubic that fits samples 0 to `last` best.
///
/// In x = 2k/`last` − 1 it is Σ c_n P_n with orthogonal polynomials P_n of the samples (Gram), made by their recursion; the
/// slope follows from the same recursion differentiated.
fn slope_at_start(last: usize, series: &dyn Fn(usize) -> f64) -> f64 {
    let x = |k: usize| 2.0 * k as f64 / last as f64 - 1.0;
    let n = last + 1;
    let (mut before, mut now) = (vec![0.0; n], vec![1.0; n]);
    let (mut slope_before, mut slope_now) = (0.0, 0.0);
    let (mut power_before, mut slope) = (1.0, 0.0);
    for order in 0..=3.min(last) {
        let power: f64 = now.iter().map(|p| p * p).sum();
        let along: f64 = now.iter().enumerate().map(|(k, p)| p * series(k)).sum();
        slope += along / power * slope_now;
        // x P_n less its part along P_(n−1); its part along P_n vanishes, since the samples lie evenly around 0.
        let back = if order == 0 { 0.0 } else { power / power_before };
        let next: Vec<f64> = (0..n).map(|k| x(k) * now[k] - back * before[k]).collect();
        let slope_next = now[0] + x(0) * slope_now - back * slope_before;
        (before, now) = (now, next);
        (slope_before, slope_now) = (slope_now, slope_next);
        power_before = power;
    }
    slope * 2.0 / last as f64
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
