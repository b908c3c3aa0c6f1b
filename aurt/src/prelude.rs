//! What most programs need: `use aurt::prelude::*;`.

pub use aurt_calibration::{CalibrationOptions, Estimator, LoadTorqueChoice, Prediction};
pub use aurt_diagnosis::{Answer, Verdict};
pub use aurt_friction::arm_terms::counterbalance::Counterbalance;
pub use aurt_friction::arm_terms::coupling::Coupling;
pub use aurt_friction::arm_terms::current_offset::CurrentOffset;
pub use aurt_friction::arm_terms::joint_selection::JointSelection;
pub use aurt_friction::arm_terms::payload::Payload;
pub use aurt_friction::arm_terms::rotor_inertia::RotorInertia;
pub use aurt_friction::arm_terms::spring::Spring;
pub use aurt_plugins::model::{Friction, ModelBuilder, Robot};
pub use aurt_recording::{PreprocessOptions, Recording};
pub use aurt_traits::{MeasurementUnit, MotionView, RobotModel};

pub use crate::calibrated_file::CalibratedModel;
pub use crate::calibrating::{Calibrator, Settings};
pub use crate::data::Instrument;
pub use crate::diagnoser::{Diagnoser, Diagnosis, Explanation};
pub use crate::effects::{Effect, EffectKind, Estimate, Presence};
pub use crate::fitting::Outcome;
pub use crate::predictor::Predictor;
pub use crate::progress::Progress;
