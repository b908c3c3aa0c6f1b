//! What a calibration tells of noise in the positions: the test of Durbin, Wu and Hausman, and a bias that intervals hold.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../examples/known_robot/mod.rs"]
#[expect(dead_code, reason = "examples use the rest")]
mod known_robot;

use aurt_calibration::{Calibration, CalibrationOptions, calibrate};
use aurt_traits::MeasurementUnit;
use known_robot::{F_DYN_HZ, KnownRobot, Noise, Positions, measured};

fn calibrated(bits: Option<u32>) -> Calibration {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(0, 20.0);
    let recordings = [measured(&clean, "known", 3, Noise::White, 1.0, bits)];
    let options = CalibrationOptions::default();
    calibrate(&robot.model, &recordings, MeasurementUnit::NewtonMetre, F_DYN_HZ, &options).unwrap()
}

#[test]
fn exact_and_fine_encoders_are_not_called_biased() {
    for bits in [None, Some(19), Some(16)] {
        let found = calibrated(bits);
        let bias = found.position_bias.unwrap();
        assert!(bias.hausman.is_none_or(|test| !test.is_biased()), "{bits:?}");
        assert!(!found.warnings.iter().any(|w| w.contains("do not agree")), "{bits:?} {:?}", found.warnings);
    }
}

/// However many bits are missing.
#[test]
fn coarse_encoders_are_and_the_cure_is_told() {
    for bits in [12, 11, 10] {
        let found = calibrated(Some(bits));
        let bias = found.position_bias.as_ref().unwrap();
        let test = bias.hausman.as_ref().unwrap();
        assert!(test.is_biased() && test.freedom > 10, "{bits} {test:?}");
        let cure = "instrumental variables do not agree with them; lower f_dyn, for which `aurt check` knows a value";
        assert!(found.warnings.iter().any(|w| w.contains(cure)), "{bits} {:?}", found.warnings);
    }
}

/// Coefficients are biased by noise of the positions, and their deviations are wider by it: they hold the truth.
#[test]
fn intervals_hold_the_bias() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(0, 20.0);
    let recordings = [measured(&clean, "known", 3, Noise::White, 1.0, Positions::White(1e-3))];
    let options = CalibrationOptions::default();
    let unit = MeasurementUnit::NewtonMetre;
    let found = calibrate(&robot.model, &recordings, unit, F_DYN_HZ, &options).unwrap();
    let bias = found.position_bias.as_ref().unwrap();
    assert_eq!(bias.parameters.len(), found.parameters.len());
    let (mut held, mut without) = (0, 0);
    for ((parameter, bias), truth) in found.parameters.iter().zip(&bias.parameters).zip(&robot.truth) {
        let deviation = parameter.std_dev.unwrap();
        let other = bias.bias / bias.deviations;
        assert!((deviation - other.hypot(bias.bias)).abs() < 1e-9 * deviation, "{parameter:?} {bias:?}");
        held += usize::from((parameter.value - truth).abs() < 1.96 * deviation);
        without += usize::from((parameter.value - truth).abs() < 1.96 * other.abs());
    }
    let all = found.parameters.len();
    assert!(held >= all - 3, "{held} of {all}");
    assert!(without < held, "{without} {held}");
}
