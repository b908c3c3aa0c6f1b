use aurt_traits::RobotModel;

use super::problem::Problem;
use crate::row_cache::{Fitted, fit};
use crate::system::weights;
use crate::{CalibrationError, CalibrationOptions, Estimator, FitRows, TermScopes};

/// A model with some shapes, its linear fit, and what the search keeps fixed.
pub(super) struct Shaped<'a> {
    pub(super) model: RobotModel,
    pub(super) rows: &'a FitRows<'a>,
    acting: Vec<Vec<bool>>,
    pub(super) fitted: Fitted,
    estimator: Estimator,
}

impl<'a> Shaped<'a> {
    pub(super) fn begin(
        model: &RobotModel,
        rows: &'a FitRows<'a>,
        scopes: &TermScopes,
        options: &CalibrationOptions,
    ) -> Result<Self, CalibrationError> {
        Ok(Self {
            model: model.clone(),
            rows,
            acting: rows.acting(model, scopes),
            fitted: fit(model, rows, scopes, options)?,
            estimator: options.estimator,
        })
    }

    pub(super) fn problem(&self) -> Result<Problem<'_>, CalibrationError> {
        Problem::new(&self.model, self.rows, &self.acting, &self.fitted.loads, self.weights())
    }

    pub(super) fn weights(&self) -> Vec<f64> {
        let sigma = &self.fitted.estimate.sigma;
        if self.estimator.is_weighted() { weights(sigma) } else { vec![1.0; sigma.len()] }
    }
}
