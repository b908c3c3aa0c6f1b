use super::level::{row_variance_ratios, scaled};
use crate::system::weights;
use crate::{CalibrationError, System};

/// Times that residuals are looked at to weight recordings.
const REWEIGHTED: usize = 3;

/// The coefficients of recordings of the unchanged machine: of all of them, and for each of the others alone.
///
/// A calibration errs less on the motions that it saw: its residual there has lost what the coefficients could take up. Judged by
/// the others' coefficients, each recording shows what one that is not among them will show.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// ζ of all recordings.
    pub all: Vec<f64>,
    /// For each recording, ζ of the others; of all where these do not determine as much, or where there are none.
    pub others: Vec<Vec<f64>>,
}

impl LeftOut {
    /// Weighted least squares over the coefficients that `is_fitted`; the others are zero. Row variances are σ_j², and where a
    /// recording's residual under the fit to all of them is larger, that: a motion on which the model fails says less.
    ///
    /// # Errors
    /// [`CalibrationError::NothingToCalibrateOn`], [`CalibrationError::Columns`] if the recordings' models differ, and
    /// [`CalibrationError::NotFinite`].
    pub fn of(
        recordings: &[System],
        sigma: &[f64],
        is_fitted: impl Fn(usize) -> bool,
    ) -> Result<Self, CalibrationError> {
        let weights = weights(sigma);
        let mut weighted = recordings.to_vec();
        let mut all = merged(&weighted, None)?.solve(&weights, &is_fitted)?;
        for _ in 0..REWEIGHTED {
            let scaled =
                |system: &System| scaled(system, &row_variance_ratios(system, &all.coefficients, sigma));
            weighted = recordings.iter().map(scaled).collect();
            all = merged(&weighted, None)?.solve(&weights, &is_fitted)?;
        }
        let mut others = Vec::new();
        for left_out in 0..recordings.len() {
            let found = if recordings.len() < 2 {
                None
            } else {
                Some(merged(&weighted, Some(left_out))?.solve(&weights, &is_fitted)?)
            };
            let found = found.filter(|f| f.excited == all.excited);
            others.push(found.map_or_else(|| all.coefficients.clone(), |f| f.coefficients));
        }
        Ok(Self { all: all.coefficients, others })
    }
}

fn merged(recordings: &[System], without: Option<usize>) -> Result<System, CalibrationError> {
    let mut kept = recordings.iter().enumerate().filter(|(r, _)| Some(*r) != without).map(|(_, s)| s);
    let mut sum = kept.next().ok_or(CalibrationError::NothingToCalibrateOn)?.clone();
    kept.try_for_each(|system| sum.merge(system))?;
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::JointFactor;

    fn recording(slope: f64, scatter: f64) -> System {
        let x: Vec<f64> = (1..=50).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| slope * x + scatter * (x % 2.0 - 0.5)).collect();
        let mut factor = JointFactor::new(vec![0]);
        factor.push(|_| &x, &y, |_| true);
        System::new(1, vec![factor])
    }

    #[test]
    fn each_recording_is_judged_by_the_others() {
        let recordings = [recording(1.0, 0.0), recording(2.0, 0.0), recording(3.0, 0.0)];
        let found = LeftOut::of(&recordings, &[100.0], |_| true).unwrap();
        assert!((found.all[0] - 2.0).abs() < 1e-12);
        for (others, expected) in found.others.iter().zip([2.5, 2.0, 1.5]) {
            assert!((others[0] - expected).abs() < 1e-12, "{others:?}");
        }
        let alone = LeftOut::of(&recordings[..1], &[100.0], |_| true).unwrap();
        assert_eq!(alone.others, std::slice::from_ref(&alone.all));
        assert!(LeftOut::of(&[], &[1.0], |_| true).is_err());
    }

    #[test]
    fn a_motion_on_which_the_model_fails_says_little() {
        let recordings = [recording(1.0, 1.0), recording(1.0, 1.0), recording(1.5, 400.0)];
        let found = LeftOut::of(&recordings, &[0.5], |_| true).unwrap();
        assert!((found.all[0] - 1.0).abs() < 0.01, "{:?}", found.all);
        // As many rows weighted alike would give 1.25.
        assert!((found.others[0][0] - 1.0).abs() < 0.02, "{:?}", found.others);
    }
}
