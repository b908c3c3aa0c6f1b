//! What most programs need: `use aurt::prelude::*;`.

pub use aurt_calibration::{CalibrationOptions, Estimator, LoadTorqueChoice, Prediction};
pub use aurt_diagnosis::{Answer, Verdict};
pub use aurt_experiment::{Experiment, Registry};
pub use aurt_rbd::{MdhRows, MdhTable, RobotDescription};
pub use aurt_recording::{PreprocessOptions, Recording};
pub use aurt_report::Page as Report;
pub use aurt_simulation::{Motion, Scenario, effects, robots};
pub use aurt_traits::{MeasurementUnit, MotionView, RobotModel};

pub use crate::{
    CalibratedModel, Calibrator, Diagnoser, ModelBuilder, Outcome, Predictor, Progress, Robot, Settings,
    calibrate, data::Instrument, diagnose, report, simulate,
};
