//! Recordings longer than memory against the same recordings in memory.

use crate::workload;

use aurt_calibration::{
    CalibrationError, CalibrationOptions, Deviations, LoadTorqueChoice, NamedRecording, Rest, ValidatedRows,
    calibrate, calibrate_long, validate, validate_long,
};
use aurt_recording::{LongRecording, PreprocessOptions, preprocess};
use aurt_traits::MeasurementUnit;

#[test]
fn long_recordings_give_the_calibration_of_whole_ones() {
    let (joints, unit) = (4, MeasurementUnit::NewtonMetre);
    let model = workload::model(joints);
    // More than two stretches, in two segments; and a short one.
    let mut first = workload::recording(joints, 90_000);
    first.time_s[81_000..].iter_mut().for_each(|t| *t += 2.0);
    let recordings = [first, workload::recording(joints, 3000)];
    let preprocessing = PreprocessOptions::new(10.0);
    let whole: Vec<NamedRecording> = recordings
        .iter()
        .map(|r| NamedRecording {
            name: r.file.display().to_string(),
            data: preprocess(r, &preprocessing).unwrap(),
        })
        .collect();
    let long: Vec<_> = recordings
        .iter()
        .map(|r| {
            let mut long = LongRecording::new(r.file.clone(), joints, true, unit).unwrap();
            long.push(r).unwrap();
            long.prepare(&preprocessing).unwrap()
        })
        .collect();
    for load_torque in [LoadTorqueChoice::Fitted, LoadTorqueChoice::Literal] {
        for rest in [Rest::Keep, Rest::Exclude] {
            let deviations = Deviations::White;
            let options =
                CalibrationOptions { load_torque, rest, deviations, ..CalibrationOptions::default() };
            let expected = calibrate(&model, &whole, unit, 10.0, &options).unwrap();
            let ours = calibrate_long(&model, &long, unit, 10.0, &options).unwrap();
            assert_eq!(ours.samples_per_joint, expected.samples_per_joint);
            assert_eq!(ours.recordings, expected.recordings);
            for (a, b) in ours.parameters.iter().zip(&expected.parameters) {
                assert!(
                    (a.value - b.value).abs() <= 1e-6 * b.std_dev.unwrap(),
                    "{}: {} {}",
                    a.name,
                    a.value,
                    b.value
                );
            }
            for (a, b) in ours.ranges.iter().zip(&expected.ranges) {
                assert!((a.velocity_rad_s - b.velocity_rad_s).abs() < 1e-9 * b.velocity_rad_s);
                assert_eq!(a.load_torque.is_some(), b.load_torque.is_some());
            }
            for (long, whole) in long.iter().zip(&whole) {
                let ours = validate_long(&model, &expected, long).unwrap();
                let theirs = validate(&model, &expected, whole, ValidatedRows::All).unwrap();
                assert_eq!((ours.samples, &ours.warnings), (theirs.samples, &theirs.warnings));
                for (ours, theirs) in [(&ours.all, &theirs.all), (&ours.moving, &theirs.moving)] {
                    assert_eq!(ours.samples, theirs.samples);
                    for (a, b) in
                        ours.mse.iter().chain(&ours.nrmse).zip(theirs.mse.iter().chain(&theirs.nrmse))
                    {
                        assert!((a - b).abs() <= 1e-9 * b, "{a} {b}");
                    }
                }
            }
        }
    }
    let error =
        calibrate_long(&workload::model(3), &long, unit, 10.0, &CalibrationOptions::default()).unwrap_err();
    assert!(matches!(error, CalibrationError::Joints { expected: 3, found: 4, .. }));
    assert!(matches!(
        calibrate_long(&model, &[], unit, 10.0, &CalibrationOptions::default()),
        Err(CalibrationError::NothingToCalibrateOn)
    ));
}
