//! Real recordings, read and preprocessed. They are no part of the repository: the folder that holds them is named
//! by the environment variable `AURT_DATA`.

use std::path::PathBuf;

use aurt_recording::{
    ColumnRef, ColumnSelection, ColumnsRef, PreprocessOptions, ReadOptions, preprocess, read_recording,
};
use aurt_traits::MeasurementUnit;

/// The folder of real recordings, or a word on why the test is skipped.
fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("AURT_DATA").map(PathBuf::from).filter(|f| f.is_dir());
    if folder.is_none() {
        println!("skipped: AURT_DATA does not name the folder of real recordings");
    }
    folder
}

fn as_in_the_paper() -> PreprocessOptions {
    PreprocessOptions { count_ends: true, ..PreprocessOptions::new(10.0) }
}

#[test]
fn the_original_tool_s_sample_counts() {
    let Some(folder) = folder() else { return };
    let folder = folder.join("ur10e_500hz");
    let recording = read_recording(&folder.join("calibration.csv"), &ReadOptions::default()).unwrap();
    let done = preprocess(&recording, &as_in_the_paper()).unwrap();
    for note in done.report.notes() {
        println!("{note}");
    }
    assert_eq!(done.segments.len(), 1);
    let segment = &done.segments[0];
    assert!(!done.report.resampled);
    assert_eq!(segment.decimation, 10);
    assert_eq!(segment.rows(), 2586);
    assert!(segment.measurement.as_ref().unwrap().iter().all(|m| m.len() == 2586));

    for file in ["validation_8harm.csv", "validation_point_to_point.csv"] {
        let recording = read_recording(&folder.join(file), &ReadOptions::default()).unwrap();
        let options = PreprocessOptions { trim_rest: false, ..as_in_the_paper() };
        let done = preprocess(&recording, &options).unwrap();
        let segment = &done.segments[0];
        assert_eq!(segment.motion.samples(), recording.samples() - 2);
        assert_eq!(segment.rows(), (recording.samples() - 2).div_ceil(10));
    }
}

#[test]
fn irregular_recordings_are_put_on_the_grid_that_the_robot_ran_at() {
    let Some(folder) = folder() else { return };
    for (file, joints, f_dyn_hz, rate_hz, resampled) in [
        ("ur10e/excitation_20s.csv", 6, 2.5, 100.0, true),
        ("ur10e/excitation_30s.csv", 6, 2.5, 100.0, true),
        ("ur10e/excitation_50s.csv", 6, 2.5, 100.0, true),
        ("ur10e/unloaded_50s.csv", 6, 2.5, 100.0, true),
        ("ur10e/payload_50s.csv", 6, 2.5, 100.0, true),
        ("ur10e/point_to_point.csv", 6, 2.5, 100.0, true),
        ("ur10e/joint_1_only.csv", 6, 2.5, 100.0, true),
        ("tx40/excitation_1khz.csv", 6, 10.0, 1000.0, false),
        ("panda/excitation.csv", 7, 10.0, 1000.0, true),
        ("ur3e/wave_joint_1.csv", 6, 5.0, 125.0, true),
    ] {
        let recording = read_recording(&folder.join(file), &ReadOptions::default()).unwrap();
        let done = preprocess(&recording, &PreprocessOptions::new(f_dyn_hz)).unwrap();
        println!("{file}");
        for note in recording.report.notes().iter().chain(&done.report.notes()) {
            println!("    {note}");
        }
        assert_eq!(recording.joints(), joints, "{file}");
        assert_eq!(recording.report.dropped_rows, 0, "{file}");
        assert_eq!(recording.report.remarks, Vec::<String>::new(), "{file}");
        assert_eq!(done.report.resampled, resampled, "{file}");
        assert!((done.report.rate_hz / rate_hz - 1.0).abs() < 1e-9, "{file}: {} Hz", done.report.rate_hz);
        assert_eq!(done.segments.len(), 1, "{file}");
    }
}

#[test]
fn a_headerless_log_equals_the_same_log_with_a_header() {
    let Some(folder) = folder() else { return };
    let named = read_recording(&folder.join("ur10e/excitation_20s.csv"), &ReadOptions::default()).unwrap();
    let columns = ColumnSelection {
        time: Some(ColumnRef::Index(0)),
        position: Some(ColumnsRef::Range { first: 1, last: 6 }),
        velocity: Some(ColumnsRef::Range { first: 7, last: 12 }),
        measurement: Some(ColumnsRef::Range { first: 13, last: 18 }),
    };
    let options = ReadOptions { columns, unit: Some(MeasurementUnit::Ampere), ..ReadOptions::default() };
    let file = folder.join("ur10e/as_recorded_headerless.csv");
    let bare = read_recording(&file, &options).unwrap();
    assert_eq!(bare.position_rad, named.position_rad);
    assert_eq!(bare.velocity_rad_s, named.velocity_rad_s);
    assert_eq!(bare.measurement, named.measurement);
    println!("{}", read_recording(&file, &ReadOptions::default()).unwrap_err());
}
