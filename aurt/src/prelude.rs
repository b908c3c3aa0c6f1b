//! What most programs need: `use aurt::prelude::*;`.

pub use aurt_calibration::{CalibrationOptions, Estimator, LoadTorqueChoice, Prediction};
pub use aurt_diagnosis::{Answer, Verdict};
pub use aurt_friction::arm_terms::{
    counterbalance::Counterbalance, coupling::Coupling, current_offset::CurrentOffset,
    joint_selection::JointSelection, payload::Payload, rotor_inertia::RotorInertia, spring::Spring,
};
pub use aurt_plugins::model::{Friction, ModelBuilder, Robot};
pub use aurt_recording::{PreprocessOptions, Recording};
pub use aurt_traits::{MeasurementUnit, MotionView, RobotModel};

pub use crate::{
    calibrated_file::CalibratedModel,
    calibrating::{Calibrator, Settings},
    data::Instrument,
    diagnoser::{Diagnoser, Diagnosis, Explanation},
    effects::{Effect, EffectKind, Estimate, Presence},
    fitting::Outcome,
    predictor::Predictor,
    progress::Progress,
};
