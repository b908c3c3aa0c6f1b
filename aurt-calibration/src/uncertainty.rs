use aurt_recording::ZeroPhase;
use aurt_traits::{MeasurementUnit, RobotModel};
use serde::{Deserialize, Serialize};

use crate::Solution;

/// Two-sided 95 % quantile of the normal distribution; rows are counted in thousands, so Student's differs
/// in the third digit at most.
pub(crate) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// `2.764 ± 0.029`: a value with its standard deviation, both to two digits of the latter; without one, to four decimals.
pub fn with_deviation(value: f64, std: f64) -> String {
    if !(std.is_finite() && std > 0.0) {
        return format!("{value:.4}");
    }
    // Beyond nine decimals powers of ten are shorter.
    if std < 1e-8 {
        return format!("{value:.9} ± {std:.1e}");
    }
    let digits = deviation_digits(std);
    format!("{value:.digits$} ± {std:.digits$}")
}

/// The decimals of a standard deviation, and of what it belongs to, for two digits of it.
pub fn deviation_digits(std: f64) -> usize {
    if std > 0.0 { (1.0 - std.log10().floor()).clamp(0.0, 9.0) as usize } else { 4 }
}

/// By how much the variance of low-frequency estimates exceeds what independent rows would give.
///
/// Measurement noise that is white at the recording's rate leaves the zero-phase filter |H|² with the power
/// spectrum |H|⁴. Sampled every `decimation`-th time its rows are not independent: below the cut-off the
/// spectrum is S(0)/S̄ = 1 / (decimation · mean |H|⁴) times that of white noise of the same variance.
pub fn noise_bandwidth_factor(filter: &ZeroPhase, decimation: usize) -> f64 {
    const POINTS: usize = 4096;
    let mean: f64 =
        (0..POINTS).map(|k| gain(filter, 0.5 * (k as f64 + 0.5) / POINTS as f64).powi(2)).sum::<f64>()
            / POINTS as f64;
    (1.0 / (decimation as f64 * mean)).max(1.0)
}

/// |H|² of the zero-phase filter at a frequency in units of the sampling rate.
fn gain(filter: &ZeroPhase, frequency: f64) -> f64 {
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * frequency);
    let (sin2, cos2) = libm::sincos(2.0 * std::f64::consts::TAU * frequency);
    let power = |c: [f64; 3]| {
        let real = c[0] + c[1] * cos + c[2] * cos2;
        let imaginary = c[1] * sin + c[2] * sin2;
        real * real + imaginary * imaginary
    };
    filter.sections().iter().map(|s| power(s.b) / power([1.0, s.a[0], s.a[1]])).product()
}

/// A coefficient with what is known of its precision.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CalibratedParameter {
    /// Name, as in the robot model.
    pub name: String,
    /// Unit, with A in the place of Nm for a current-measuring robot.
    pub unit: String,
    /// Estimate; zero for a parameter that the recordings do not excite.
    pub value: f64,
    /// Standard deviation of the estimate; absent if not excited.
    pub std_dev: Option<f64>,
    /// |standard deviation / estimate| in percent.
    pub relative_std_dev_percent: Option<f64>,
    /// 95 % confidence interval.
    pub interval_95: Option<[f64; 2]>,
    /// Whether the recordings determine the parameter at all.
    pub excited: bool,
}

pub(crate) fn calibrated_parameters(
    model: &RobotModel,
    unit: MeasurementUnit,
    solution: &Solution,
    bandwidth_factor: f64,
) -> Vec<CalibratedParameter> {
    let n = model.parameters().len();
    model
        .parameters()
        .iter()
        .enumerate()
        .map(|(k, parameter)| {
            let (value, excited) = (solution.coefficients[k], solution.excited[k]);
            let std_dev = excited.then(|| (solution.covariance[k * n + k] * bandwidth_factor).sqrt());
            // JSON has no infinity, and a result without one can be read again.
            let std_dev = std_dev.filter(|s| s.is_finite());
            CalibratedParameter {
                name: parameter.name.clone(),
                unit: model.unit(k, unit),
                value,
                std_dev,
                relative_std_dev_percent: std_dev.filter(|_| value != 0.0).map(|s| (100.0 * s / value).abs()),
                interval_95: std_dev.map(|s| [value - NORMAL_95 * s, value + NORMAL_95 * s]),
                excited,
            }
        })
        .collect()
}

/// The lower triangle of the coefficients' covariance, row after row; empty unless all of it is finite.
pub(crate) fn covariance(solution: &Solution, bandwidth_factor: f64) -> Vec<f64> {
    let n = solution.coefficients.len();
    let known = |k: usize| solution.excited[k];
    let entry = |(r, c): (usize, usize)| {
        if known(r) && known(c) { solution.covariance[c * n + r] * bandwidth_factor } else { 0.0 }
    };
    let lower: Vec<f64> = (0..n).flat_map(|r| (0..=r).map(move |c| (r, c))).map(entry).collect();
    if lower.iter().all(|v| v.is_finite()) { lower } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::with_deviation;

    #[test]
    fn values_have_the_digits_that_their_deviation_allows() {
        assert_eq!(with_deviation(2.764_27, 0.029_43), "2.764 ± 0.029");
        assert_eq!(with_deviation(15.809, 1.41), "15.8 ± 1.4");
        assert_eq!(with_deviation(1234.5, 21.0), "1234 ± 21");
        assert_eq!(with_deviation(0.5, f64::INFINITY), "0.5000");
        assert_eq!(with_deviation(0.25, 3.4e-5), "0.250000 ± 0.000034");
        assert_eq!(with_deviation(0.25, 3.44e-12), "0.250000000 ± 3.4e-12");
    }
}
