use crate::{CalibrationError, System, wls::weights};

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
    /// Weighted least squares with weights 1/σ_j over the coefficients that `is_fitted`; the others are zero.
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
        let but = |without: Option<usize>| -> Result<Option<System>, CalibrationError> {
            let mut sum: Option<System> = None;
            for (_, system) in recordings.iter().enumerate().filter(|(r, _)| Some(*r) != without) {
                match &mut sum {
                    None => sum = Some(system.clone()),
                    Some(sum) => sum.merge(system)?,
                }
            }
            Ok(sum)
        };
        let all = but(None)?.ok_or(CalibrationError::NothingToCalibrateOn)?.solve(&weights, &is_fitted)?;
        let mut others = Vec::new();
        for left_out in 0..recordings.len() {
            let found = but(Some(left_out))?.map(|s| s.solve(&weights, &is_fitted)).transpose()?;
            let found = found.filter(|f| f.excited == all.excited);
            others.push(found.map_or_else(|| all.coefficients.clone(), |f| f.coefficients));
        }
        Ok(Self { all: all.coefficients, others })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::JointFactor;

    fn recording(slope: f64) -> System {
        let x: Vec<f64> = (1..=50).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| slope * x).collect();
        let mut factor = JointFactor::new(vec![0]);
        factor.push(|_| &x, &y, |_| true);
        System::new(1, vec![factor])
    }

    #[test]
    fn each_recording_is_judged_by_the_others() {
        let found = LeftOut::of(&[recording(1.0), recording(2.0), recording(3.0)], &[1.0], |_| true).unwrap();
        assert!((found.all[0] - 2.0).abs() < 1e-12);
        for (others, expected) in found.others.iter().zip([2.5, 2.0, 1.5]) {
            assert!((others[0] - expected).abs() < 1e-12, "{others:?}");
        }
        let alone = LeftOut::of(&[recording(1.0)], &[1.0], |_| true).unwrap();
        assert_eq!(alone.others, std::slice::from_ref(&alone.all));
        assert!(LeftOut::of(&[], &[1.0], |_| true).is_err());
    }
}
