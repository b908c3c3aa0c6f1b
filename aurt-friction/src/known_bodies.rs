//! Rigid bodies whose inertial parameters are known: the bodies around which a term is linear in an angle.

use aurt_traits::{ArmSeries, ModelError, Motion, MotionView, Result, RigidBodyRegressor};

/// Indices of standard parameters are below this, whatever the robot: a thousand links.
const MOST_STANDARD: usize = 10_000;

/// Standard inertial parameters by their indices; those that are not named are zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownBodies<'a> {
    pub model: &'static str,
    pub columns: &'a [usize],
    pub values: &'a [f64],
}

impl KnownBodies<'_> {
    /// Every complaint but that of an index beyond the rigid body's own, whose number of parameters is not known before it is
    /// evaluated: joints that follow others add links.
    pub fn complaints(self) -> Vec<ModelError> {
        let Self { model, columns, values } = self;
        let mut complaints = Vec::new();
        if values.len() != columns.len() {
            let what = format!("inertial_values of `{model}` (one for each of inertial_columns)");
            complaints.push(ModelError::count(what, columns.len(), values.len()));
        }
        let mut complain = |parameter: &str, reason: String| {
            complaints.push(ModelError::parameter(model, parameter, reason));
        };
        for (k, index) in columns.iter().enumerate() {
            if *index >= MOST_STANDARD {
                complain("inertial_columns", format!("must lie below {MOST_STANDARD}, contain {index}"));
            }
            if columns[..k].contains(index) {
                complain("inertial_columns", format!("must be distinct, contain {index} twice"));
            }
        }
        if let Some(value) = values.iter().find(|v| !v.is_finite()) {
            complain("inertial_values", format!("must be numbers, contain {value}"));
        }
        complaints
    }

    /// Every complaint about the values around which the torque is exact, one for each of so many joints; none may be given.
    pub fn around_complaints(self, key: &str, around: &[f64], joints: usize) -> Vec<ModelError> {
        let model = self.model;
        let mut complaints = Vec::new();
        if !around.is_empty() && around.len() != joints {
            let what = format!("{key} of `{model}` (one a joint)");
            complaints.push(ModelError::count(what, joints, around.len()));
        }
        if let Some(value) = around.iter().find(|v| !v.is_finite()) {
            let reason = format!("must be numbers, contain {value}");
            complaints.push(ModelError::parameter(model, key, reason));
        }
        complaints
    }

    /// All standard parameters of a rigid body that has `standard` of them.
    ///
    /// # Errors
    /// [`ModelError::Evaluation`] for an index that the body does not have.
    pub fn standard(self, standard: usize) -> Result<Vec<f64>> {
        let mut all = vec![0.0; standard];
        for (index, value) in self.columns.iter().zip(self.values) {
            let Some(place) = all.get_mut(*index) else {
                let reason = format!(
                    "`inertial_columns` contain {index}, but the rigid body has {standard} inertial parameters"
                );
                return Err(ModelError::evaluation(self.model, reason));
            };
            *place = *value;
        }
        Ok(all)
    }
}

/// τ of bodies with the given standard parameters, joint after joint, as many samples apart as there are.
pub(crate) fn torque(body: &dyn RigidBodyRegressor, motion: MotionView<'_>, standard: &[f64]) -> Vec<f64> {
    let samples = motion.samples();
    let mut torque = vec![0.0; body.joints() * samples];
    body.torque(motion, standard, &mut torque, samples);
    torque
}

/// Half the step of a central difference in an angle, rad: its error is h²/6 ≈ 2·10⁻⁷ of the torque, above the rounding of
/// ε/h ≈ 2·10⁻¹³.
pub(crate) const STEP_RAD: f64 = 1e-3;

/// τ of bodies as in [`torque`], one of whose joints stands further by `by_rad` of each sample.
pub(crate) fn turned(
    series: &ArmSeries<'_>,
    standard: &[f64],
    joint: usize,
    by_rad: impl Fn(usize) -> f64,
) -> Result<Vec<f64>> {
    let view = series.motion;
    let all = |of: &dyn Fn(usize) -> Vec<f64>| -> Vec<f64> { (0..view.joints()).flat_map(of).collect() };
    let shift = |j: usize, k: usize| if j == joint { by_rad(k) } else { 0.0 };
    let position = all(&|j| view.position_rad(j).iter().enumerate().map(|(k, q)| q + shift(j, k)).collect());
    let velocity = all(&|j| view.velocity_rad_s(j).to_vec());
    let acceleration = all(&|j| view.acceleration_rad_s2(j).to_vec());
    let motion = Motion::new(view.joints(), view.time_s().to_vec(), position, velocity, acceleration)?;
    Ok(torque(series.rigid_body, motion.view(), standard))
}
