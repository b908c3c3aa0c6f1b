use aurt_recording::Segment;
use aurt_traits::{LoadTorque, RobotModel};

use super::dynamics::{Source, add_sums};
use super::rigid::RigidRows;
use super::series::LoadSeries;
use crate::CalibrationError;

impl RigidRows<'_> {
    /// τ_J over a segment, as [`RobotModel::evaluate`] forms it.
    pub(crate) fn load_series(
        &self,
        model: &RobotModel,
        segment: &Segment,
        load: &LoadTorque,
    ) -> Result<LoadSeries, CalibrationError> {
        let motion = segment.motion.view();
        let mut series = LoadSeries::zero(self.joints(), motion.samples());
        let weights = match load {
            LoadTorque::Literal => vec![1.0; model.base().len()],
            LoadTorque::Fitted(weights) => weights.clone(),
        };
        if weights.iter().all(|w| *w == 0.0) {
            return Ok(series);
        }
        self.torque(motion, &weights, &mut series.values);
        if let LoadTorque::Fitted(weights) = load {
            let terms: Vec<Source<'_>> = Source::all(model).into_iter().filter(Source::is_load).collect();
            let unloaded = LoadSeries::zero(0, 0);
            add_sums(&terms, segment, &unloaded, |column| weights[column], &mut series.values)?;
        }
        Ok(series)
    }
}
