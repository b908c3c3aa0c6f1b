//! What a calibration tells of noise in the positions: a bias that intervals hold.

use crate::known_robot;

use aurt_calibration::{
    Calibration, CalibrationOptions, Deviations, Estimator, ShapeOptions, TermScopes, calibrate_shapes,
};
use aurt_recording::PreprocessOptions;
use aurt_traits::MeasurementUnit;
use known_robot::{F_DYN_HZ, KnownRobot, Noise, Positions, Stribeck, measured, measured_and};

fn calibrated(positions: impl Into<Positions>) -> (KnownRobot, Calibration) {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(0, 20.0);
    let recordings = [measured(&clean, "known", 3, Noise::White, 1.0, positions)];
    let found = robot.calibrated(&recordings, Estimator::Wls, Deviations::Memory);
    (robot, found)
}

/// However many bits are missing.
#[test]
fn coarse_encoders_are_called_biased_and_the_cure_is_told() {
    for (bits, is_coarse) in [(None, false), (Some(12), true), (Some(11), true), (Some(10), true)] {
        let (_, found) = calibrated(bits);
        let told = found.warnings.iter().find(|w| w.contains("position noise biases"));
        assert_eq!(told.is_some(), is_coarse, "{bits:?} {:?}", found.warnings);
        assert!(told.is_none_or(|w| w.contains("; use ")), "{bits:?} {told:?}");
    }
}

/// Coefficients are biased by noise of the positions, and their deviations are wider by it: they hold the truth.
#[test]
fn intervals_hold_the_bias() {
    let (robot, found) = calibrated(Positions::White(1e-3));
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

/// Of the shapes of a law, too: b is part of their deviations, a warning names them where it is most of these, and estimators
/// that do not tell the bias have none.
#[test]
fn intervals_of_shapes_hold_the_bias() {
    let law = Stribeck { joint: 1, rise_nm: 7.0, velocity_rad_s: 0.1, exponent: 2.0 };
    let mut robot = KnownRobot::with_stribeck(None, vec![law]);
    let clean = robot.clean_at_ends(0, 20.0);
    let found = |bits, estimator, deviations| {
        let preprocess = PreprocessOptions::new(F_DYN_HZ);
        let recordings =
            [measured_and(&clean, "known", 5, Noise::White, 1.0, Positions::Bits(bits), &preprocess)];
        let options = CalibrationOptions { estimator, deviations, ..CalibrationOptions::default() };
        let unit = MeasurementUnit::NewtonMetre;
        let everywhere = TermScopes::everywhere();
        let search = ShapeOptions::default();
        calibrate_shapes(&robot.model, &recordings, &everywhere, unit, F_DYN_HZ, &options, &search).unwrap().1
    };
    let mut warned = Vec::new();
    for bits in [17, 13] {
        let with = found(bits, Estimator::Wls, Deviations::Memory);
        let shape = &with.shape_fit.as_ref().unwrap().shapes[0];
        let (b, deviation) = (shape.shift_by_position_noise.unwrap(), shape.std_dev.unwrap());
        assert!(b < deviation, "{bits} {shape:?}");
        let warning = format!("{} = ", shape.label());
        let is_named = with.warnings.iter().any(|w| w.contains("may have shifted") && w.contains(&warning));
        assert_eq!(is_named, 2.0 * b * b > deviation * deviation, "{bits} {shape:?} {:?}", with.warnings);
        warned.push(is_named);
        assert!(!with.position_bias.as_ref().unwrap().parameters.is_empty());
        let [low, high] = shape.interval_95.unwrap();
        assert!((low..=high).contains(&law.velocity_rad_s), "{shape:?}");
    }
    assert_eq!(warned, [false, true]);
    for (estimator, deviations) in [
        (Estimator::Irls, Deviations::Memory),
        (Estimator::Essential, Deviations::Memory),
        (Estimator::Wls, Deviations::White),
    ] {
        let without = found(13, estimator, deviations);
        let shape = &without.shape_fit.as_ref().unwrap().shapes[0];
        assert!(shape.shift_by_position_noise.is_none() && without.position_bias.is_none());
    }
}
