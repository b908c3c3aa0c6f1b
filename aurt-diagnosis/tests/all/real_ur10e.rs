//! Recordings of a real UR10e (Mamedov and Mikhel 2020; the folder is named by `AURT_DATA`): nothing touched it.

#![expect(clippy::type_complexity, reason = "a test says what failed by panicking")]

use std::path::{Path, PathBuf};

use aurt_calibration::{Calibration, CalibrationOptions, NamedRecording, calibrate};
use aurt_diagnosis::{
    Contact, ContactOptions, ContactRows, Fit, ForceColumns, RecordingRows, Role, find_contacts,
    force_columns,
};
use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, ReadOptions, preprocess, read_recording};
use aurt_traits::{MeasurementUnit, RobotModel};

/// 2.5 Hz: the robot was recorded at 94 Hz and moves below 1 Hz.
const F_DYN_HZ: f64 = 2.5;

/// Torque constants of the drives, Nm/A.
const GAINS: [f64; 6] = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763];

const UNLOADED: [&str; 5] =
    ["unloaded_50s", "excitation_20s", "excitation_30s", "excitation_50s", "point_to_point"];

fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("AURT_DATA").map(|f| PathBuf::from(f).join("ur10e")).filter(|f| f.is_dir());
    if folder.is_none() {
        eprintln!("skipped: AURT_DATA names no folder with recordings of a UR10e");
    }
    folder
}

fn model(folder: &Path) -> RobotModel {
    let text = format!(
        "schema = 1\n[robot]\nmdh = {:?}\ngravity_m_s2 = [0.0, 0.0, -9.81]\n[joint_dynamics]\n\
         coulomb = {{ model = \"absolute\" }}\nhysteresis = {{ model = \"sign\" }}\n\
         viscous = {{ model = \"polynomial\", powers = [1] }}\n[preprocess]\nf_dyn_hz = 2.5\n\
         [recordings]\ncalibration = [{:?}]\n",
        folder.join("mdh.csv"),
        folder.join("unloaded_50s.csv"),
    );
    let mut registry = Registry::linked().unwrap();
    Experiment::parse(&text, Path::new("experiment.toml"), &mut registry).unwrap().robot_model().unwrap()
}

fn recording(folder: &Path, name: &str) -> NamedRecording {
    let raw = read_recording(&folder.join(format!("{name}.csv")), &ReadOptions::default()).unwrap();
    let options = PreprocessOptions { gains: Some(GAINS.to_vec()), ..PreprocessOptions::new(F_DYN_HZ) };
    NamedRecording { name: name.into(), data: preprocess(&raw, &options).unwrap() }
}

/// Rows, residuals and force columns of a recording under a fit.
fn prepared(
    model: &RobotModel,
    fit: &Calibration,
    recording: &NamedRecording,
) -> (RecordingRows, Vec<Vec<f64>>, Vec<ForceColumns>) {
    let coefficients = fit.coefficients();
    let fitted = Fit { model, load: &fit.load, coefficients: &coefficients };
    let rows =
        RecordingRows::evaluate(&recording.name, Role::Target, &recording.data, model, &fit.load, &fitted)
            .unwrap();
    let residual = rows
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| joint.residual(model.row_columns(j).iter().map(|c| coefficients[*c])))
        .collect();
    let forces = force_columns(model.rigid_body().as_ref(), &rows).unwrap();
    (rows, residual, forces)
}

fn search(inputs: &[(RecordingRows, Vec<Vec<f64>>, Vec<ForceColumns>)]) -> Vec<Contact> {
    let views: Vec<ContactRows<'_>> = inputs
        .iter()
        .map(|(rows, residual, forces)| ContactRows { rows, origin_s: 0.0, residual, forces, left_out: &[] })
        .collect();
    find_contacts(&views, &ContactOptions::new(F_DYN_HZ))
}

#[test]
fn nothing_touched_the_unloaded_robot_and_a_push_that_is_added_is_found() {
    let Some(folder) = data() else { return };
    let model = model(&folder);
    let recordings: Vec<NamedRecording> = UNLOADED.iter().map(|name| recording(&folder, name)).collect();
    for left_out in 0..recordings.len() {
        let fitted: Vec<NamedRecording> =
            recordings.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, r)| r.clone()).collect();
        let fit = calibrate(
            &model,
            &fitted,
            MeasurementUnit::NewtonMetre,
            F_DYN_HZ,
            &CalibrationOptions::default(),
        )
        .unwrap();
        let mut inputs: Vec<_> = recordings.iter().map(|r| prepared(&model, &fit, r)).collect();
        assert_eq!(search(&inputs), [], "fitted without {}", UNLOADED[left_out]);

        let (rows, residual, forces) = &mut inputs[left_out];
        let middle = rows.time_s[rows.rows() * 2 / 5];
        let force = [50.0, -30.0, 40.0];
        for (j, series) in residual.iter_mut().enumerate().take(4) {
            for (k, value) in series.iter_mut().enumerate() {
                if (middle..middle + 2.0).contains(&rows.time_s[k]) {
                    *value += (0..3).map(|a| force[a] * forces[4].axes[a][j][k]).sum::<f64>();
                }
            }
        }
        let found = search(&inputs);
        let contact = found.first().unwrap_or_else(|| panic!("no push in {}", UNLOADED[left_out]));
        let [from, to] = contact.window_s;
        let overlap = (to.min(middle + 2.0) - from.max(middle)) / (to.max(middle + 2.0) - from.min(middle));
        assert!(found.len() == 1 && contact.recording == left_out && overlap > 0.8, "{found:?}, {middle}");
    }
}
