//! The examples run and find what they say.

#[path = "../examples/calibrate_from_arrays.rs"]
mod calibrate_from_arrays;
#[path = "../examples/diagnose_two_recordings.rs"]
mod diagnose_two_recordings;
#[path = "../examples/own_friction_model.rs"]
mod own_friction_model;
#[path = "../examples/predict_in_a_control_loop.rs"]
mod predict_in_a_control_loop;

#[test]
fn a_model_is_calibrated_from_arrays() {
    calibrate_from_arrays::main().unwrap();
}

#[test]
fn a_control_loop_gets_its_torques() {
    predict_in_a_control_loop::main().unwrap();
}

#[test]
fn a_load_is_found_between_two_recordings() {
    diagnose_two_recordings::main().unwrap();
}

#[test]
fn a_model_of_ones_own_is_found_by_its_name() {
    own_friction_model::main().unwrap();
}
