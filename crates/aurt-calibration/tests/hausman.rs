//! The test of Durbin, Wu and Hausman as a calibration tells it.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../examples/known_robot/mod.rs"]
#[expect(dead_code, reason = "examples use the rest")]
mod known_robot;

use aurt_calibration::{Calibration, CalibrationOptions, calibrate};
use aurt_traits::MeasurementUnit;
use known_robot::{F_DYN_HZ, KnownRobot, Noise, measured};

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

/// However many bits are missing: where noise is too much for its bias to be told, too, the test and the cure are.
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
