//! The rows that reports draw are those that a verdict's figures are means over.

use std::path::{Path, PathBuf};

use aurt_calibration::CalibrationOptions;
use aurt_diagnosis::{
    Question, QuestionedRecording, Role, SelectionOptions, investigate, series, write_verdict,
};
use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, ReadOptions, read_recording};
use aurt_traits::{MeasurementUnit, RobotModel};

const F_DYN_HZ: f64 = 2.5;

fn questioned(folder: &Path, name: &str, role: Role) -> QuestionedRecording {
    let raw = read_recording(&folder.join(name), &ReadOptions::default()).unwrap();
    let options = PreprocessOptions { trim_rest: true, ..PreprocessOptions::new(F_DYN_HZ) };
    QuestionedRecording::new(role, name.into(), raw, options).unwrap()
}

/// Root mean square of the rows that count.
fn rms<'a>(rows: impl Iterator<Item = &'a f64>) -> f64 {
    let (sum, count) =
        rows.filter(|r| r.is_finite()).fold((0.0, 0.0), |(sum, count), r| (sum + r * r, count + 1.0));
    f64::sqrt(sum / count)
}

fn assert_close(a: f64, b: f64, what: &str) {
    assert!((a - b).abs() < 1e-9 * b.abs(), "{what}: {a} and {b}");
}

/// Recordings of a UR10e, the model and the registry; none where there are no recordings.
fn ur10e() -> Option<(PathBuf, RobotModel, Registry)> {
    let folder = std::env::var_os("AURT_DATA").map(|f| PathBuf::from(f).join("ur10e"));
    let Some(folder) = folder.filter(|f| f.is_dir()) else {
        println!("skipped: AURT_DATA names no folder with recordings of a UR10e");
        return None;
    };
    let text = format!(
        "schema = 1\n[robot]\nmdh = {:?}\ngravity_m_s2 = [0.0, 0.0, -9.81]\n[preprocess]\nf_dyn_hz = 2.5\n\
         [recordings]\ncalibration = [{:?}]\n",
        folder.join("mdh.csv"),
        folder.join("unloaded_50s.csv"),
    );
    let mut registry = Registry::linked().unwrap();
    let experiment = Experiment::parse(&text, Path::new("experiment.toml"), &mut registry).unwrap();
    let model = experiment.robot_model().unwrap();
    Some((folder, model, registry))
}

fn question<'a>(model: &'a RobotModel, recordings: &'a [QuestionedRecording]) -> Question<'a> {
    Question {
        model,
        frozen: None,
        recordings,
        unit: MeasurementUnit::Ampere,
        f_dyn_hz: F_DYN_HZ,
        calibration: CalibrationOptions::default(),
        selection: SelectionOptions::default(),
        without: &[],
        scale: None,
    }
}

#[test]
fn figures_of_a_verdict_can_be_had_from_its_rows() {
    let Some((folder, model, registry)) = ur10e() else { return };
    let recordings = [
        questioned(&folder, "unloaded_50s.csv", Role::Calibration),
        questioned(&folder, "excitation_20s.csv", Role::Validation),
    ];
    let question = question(&model, &recordings);
    let investigation = investigate(&question, &registry, |_| ()).unwrap();
    let verdict = write_verdict(&question, &investigation);
    let series = series(&question, &investigation);
    let [fitted, held_out] = &series[..] else { panic!("{} recordings", series.len()) };
    assert_eq!((held_out.held_out_from, fitted.held_out_from), (0, fitted.time_s.len()));
    for j in 0..6 {
        let residual = &verdict.residual[j];
        assert_close(rms(fitted.joints[j].before.iter()), residual.baseline_rms, "before");
        assert_close(rms(fitted.joints[j].after.iter()), residual.unexplained_rms, "after");
        assert_close(rms(held_out.joints[j].before.iter()), verdict.held_out.rms_before[j], "held out");
        assert_close(rms(held_out.joints[j].after.iter()), verdict.held_out.rms_after[j], "held out, after");
        let measured = held_out.joints[j].measured.as_ref().unwrap();
        assert_eq!(measured.len(), held_out.time_s.len());
    }
}

#[test]
fn rows_of_a_repaired_recording_have_their_measurement() {
    let Some((folder, model, registry)) = ur10e() else { return };
    let mut recordings = [questioned(&folder, "unloaded_50s.csv", Role::Calibration)];
    let mut raw = (*recordings[0].raw).clone();
    // What a logger writes that repeats its last values: their repair leaves gaps.
    let rows = raw.time_s.len();
    for series in raw.position_rad.iter_mut().chain(raw.measurement.iter_mut().flatten()) {
        for first in (500..rows - 500).step_by(400) {
            let held = series[first];
            series[first..first + 60].fill(held);
        }
    }
    let options = recordings[0].options.clone();
    recordings[0] = QuestionedRecording::new(Role::Calibration, "held.csv".into(), raw, options).unwrap();
    let question = question(&model, &recordings);
    let investigation = investigate(&question, &registry, |_| ()).unwrap();
    assert!(!investigation.faults.is_empty());
    let [held] = &series(&question, &investigation)[..] else { panic!("one recording") };
    let as_recorded: usize = recordings[0].data.data.segments.iter().map(|s| s.rows()).sum();
    assert_ne!(held.time_s.len(), as_recorded, "the repair changes which rows there are");
    for joint in &held.joints {
        assert_eq!(joint.measured.as_ref().unwrap().len(), held.time_s.len());
        assert!(rms(joint.before.iter()) < rms(joint.measured.as_ref().unwrap().iter()));
    }
}
