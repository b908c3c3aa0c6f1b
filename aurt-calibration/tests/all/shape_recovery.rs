//! Shape parameters are recovered from recordings whose friction is integrated here, by other formulas and in finer
//! steps than the models'.

use crate::arm;

use arm::{FINE, Friction, RATE_HZ, RICH, Sines, linear, model, named, recording};
use aurt_calibration::{
    Calibration, CalibrationOptions, FittedShape, NamedRecording, ShapeOptions, TermScopes, calibrate_shapes,
};
use aurt_traits::{MeasurementUnit, RobotModel};
use serde_json::{Value, json};

const NOISE_NM: f64 = 0.02;

fn fit(model: &RobotModel, recordings: &[NamedRecording]) -> (RobotModel, Calibration) {
    calibrate_shapes(
        model,
        recordings,
        &TermScopes::everywhere(),
        MeasurementUnit::NewtonMetre,
        10.0,
        &CalibrationOptions::default(),
        &ShapeOptions::default(),
    )
    .unwrap()
}

fn both(friction: impl Fn() -> Friction) -> [Friction; 2] {
    [friction(), friction()]
}

fn record(friction: impl Fn() -> Friction) -> Vec<NamedRecording> {
    let one = |name, start_s| recording(name, RICH, (start_s, 25.0), both(&friction), NOISE_NM);
    vec![one("a.csv", 0.0), one("b.csv", 40.0)]
}

fn shapes(calibration: &Calibration) -> &[FittedShape] {
    &calibration.shape_fit.as_ref().unwrap().shapes
}

/// The shape's estimate is within `tolerance` of the truth, relative, and its interval is neither empty nor absurd.
fn recovered(shape: &FittedShape, truth: f64, tolerance: f64) {
    let label = shape.label();
    assert!((shape.value / truth - 1.0).abs() < tolerance, "{label}: {} for {truth}", shape.value);
    let deviation = shape.std_dev.unwrap_or_else(|| panic!("{label} is not determined"));
    assert!(deviation > 0.0 && deviation < 0.2 * truth, "{label}: standard deviation {deviation}");
    let [low, high] = shape.interval_95.unwrap();
    assert!(low < shape.value && shape.value < high, "{label}: {low} … {high}");
    assert!(!shape.at_bound);
}

/// Fits recordings of a friction from other shapes; those of every joint, or of the term, are recovered: (truth, tolerance) of each.
fn recovers(
    friction: impl Fn() -> Friction,
    begin: &RobotModel,
    truths: &[(f64, f64)],
) -> (RobotModel, Calibration) {
    let (fitted, calibration) = fit(begin, &record(friction));
    let owners = if begin.arm_terms().is_empty() { 2 } else { 1 };
    assert_eq!(shapes(&calibration).len(), owners * truths.len());
    for (shape, (truth, tolerance)) in shapes(&calibration).iter().zip(truths.iter().cycle()) {
        recovered(shape, *truth, *tolerance);
    }
    (fitted, calibration)
}

const STEP_S: f64 = 1.0 / (RATE_HZ * FINE as f64);

#[test]
fn a_stribeck_velocity_is_recovered() {
    // Slow motion, so that the recording holds what the model needs.
    const SLOW: [Sines; 2] =
        [&[(0.3, 0.05, 0.3), (0.05, 0.17, 1.1)], &[(0.25, 0.06, 1.9), (0.06, 0.15, 0.2)]];
    let friction = || -> Friction {
        Box::new(|[_, v, _], _| {
            let level = 2.0 + 1.5 * (-(v / 0.03) * (v / 0.03)).exp();
            level * v.signum() + 4.0 * v
        })
    };
    let recordings: Vec<NamedRecording> = [("a.csv", 0.0), ("b.csv", 47.0)]
        .map(|(name, start)| recording(name, SLOW, (start, 40.0), both(friction), NOISE_NM))
        .into();
    let level = json!({ "model": "stribeck", "stribeck_velocity_rad_s": 0.2, "stribeck_exponent": 1.0 });
    let begin = model(level, named("sign"), linear(), &[]);
    let (fitted, calibration) = fit(&begin, &recordings);
    let found = shapes(&calibration);
    assert_eq!(found.len(), 4);
    for joint in 0..2 {
        recovered(&found[2 * joint], 0.03, 0.05);
        recovered(&found[2 * joint + 1], 2.0, 0.15);
        let kept = fitted.stacks()[joint].shape_parameters();
        assert_eq!([kept[0].value, kept[1].value], [found[2 * joint].value, found[2 * joint + 1].value]);
    }
    assert!(calibration.shape_fit.unwrap().converged);
}

/// Dahl's model in time, by small explicit steps.
fn dahl(presliding_rad: f64) -> Friction {
    let mut h: f64 = 0.0;
    Box::new(move |[_, v, _], _| {
        h += STEP_S * v / presliding_rad * (1.0 - h * v.signum());
        3.0 * h.clamp(-1.0, 1.0) + 2.0 * v
    })
}

#[test]
fn a_dahl_distance_is_recovered() {
    let hysteresis = json!({ "model": "dahl", "presliding_rad": 0.2 });
    let begin = model(named("constant"), hysteresis, linear(), &[]);
    let (_, calibration) = recovers(|| dahl(0.012), &begin, &[(0.012, 0.03)]);
    let level = calibration.parameters.iter().find(|p| p.name.starts_with("F_C0")).unwrap();
    assert!((level.value - 3.0).abs() < 0.03, "{level:?}");
}

#[test]
fn a_shape_parameter_of_an_arm_term_is_found_too() {
    let term = json!({ "model": "joint_friction", "hysteresis": { "model": "dahl", "presliding_rad": 0.1 } });
    let begin = model(named("absent"), named("sign"), linear(), &[term]);
    let (fitted, calibration) = recovers(|| dahl(0.012), &begin, &[(0.012, 0.03)]);
    assert_eq!(fitted.arm_terms()[0].shape_parameters()[0].value, shapes(&calibration)[0].value);
}

#[test]
fn lugre_shapes_are_recovered() {
    let friction = || -> Friction {
        let mut z = 0.0_f64;
        // σ0 = 400 Nm/rad, F_C = 2.4, F_S = 4 Nm, v_S = 0.06 rad/s.
        Box::new(move |[_, v, _], _| {
            let level = 2.4 + 1.6 * (-(v / 0.06) * (v / 0.06)).exp();
            // Implicit in z, for the bristle is stiff.
            z = (z + STEP_S * v) / (1.0 + STEP_S * 400.0 * v.abs() / level);
            400.0 * z + 3.0 * v
        })
    };
    let hysteresis = json!({
        "model": "lugre", "presliding_rad": 0.1, "stribeck_velocity_rad_s": 0.5, "coulomb_ratio": 0.95
    });
    let begin = model(named("constant"), hysteresis, linear(), &[]);
    recovers(friction, &begin, &[(0.01, 0.05), (0.06, 0.08), (0.6, 0.05)]);
}

/// Slip elements with stops: each follows its position until its spring is stretched by the threshold.
fn slip_elements(thresholds_rad: [f64; 3]) -> Friction {
    let mut anchors: Option<[f64; 3]> = None;
    Box::new(move |[q, v, _], _| {
        let anchors = anchors.get_or_insert([q; 3]);
        let mut torque = 2.0 * v;
        for ((anchor, threshold), level) in anchors.iter_mut().zip(thresholds_rad).zip([0.8, 1.2, 1.5]) {
            if q - *anchor > threshold {
                *anchor = q - threshold;
            } else if q - *anchor < -threshold {
                *anchor = q + threshold;
            }
            torque += level * (q - *anchor) / threshold;
        }
        torque
    })
}

#[test]
fn the_ends_of_a_grid_of_slip_thresholds_are_recovered() {
    let hysteresis = json!({
        "model": "maxwell_slip", "elements": 3, "smallest_rad": 1e-4, "largest_rad": 0.4, "fit_thresholds": true
    });
    let begin = model(named("constant"), hysteresis, linear(), &[]);
    recovers(|| slip_elements([0.002, 0.01, 0.05]), &begin, &[(0.002, 0.05), (0.05, 0.03)]);
}

/// tanh by exponentials; v_s = 0.6 rad/s.
fn levelling_off() -> Friction {
    Box::new(|[_, v, _], _| {
        let e = (2.0 * v / 0.6).exp();
        6.0 * (e - 1.0) / (e + 1.0)
    })
}

fn saturating(velocity_rad_s: f64) -> Value {
    json!({ "model": "saturating", "saturation_velocity_rad_s": velocity_rad_s })
}

#[test]
fn a_saturation_velocity_is_recovered() {
    recovers(levelling_off, &model(named("absent"), named("sign"), saturating(8.0), &[]), &[(0.6, 0.02)]);
}

#[test]
fn a_search_that_begins_elsewhere_ends_at_the_same_place_and_intervals_cover_the_truth() {
    let recordings = record(levelling_off);
    let mut estimates = Vec::new();
    for begin in [0.06, 0.6, 19.0] {
        let (_, calibration) =
            fit(&model(named("absent"), named("sign"), saturating(begin), &[]), &recordings);
        let report = calibration.shape_fit.clone().unwrap();
        assert!(report.converged && report.cost_after <= report.cost_before && report.evaluations > 0);
        assert!((0.5..1.5).contains(&report.cost_after), "cost per row {}", report.cost_after);
        for shape in &report.shapes {
            let [low, high] = shape.interval_95.unwrap();
            // Four standard deviations: the seed of the noise is fixed, this is no lottery.
            let margin = (high - low) / 2.0;
            assert!((low - margin..high + margin).contains(&0.6), "{low} … {high}");
        }
        estimates.push(report.shapes.iter().map(|s| s.value).collect::<Vec<_>>());
    }
    for other in &estimates[1..] {
        for (a, b) in estimates[0].iter().zip(other) {
            assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
        }
    }
}

#[test]
fn a_shape_that_the_recording_denies_ends_at_its_bound_and_says_so() {
    // Friction is linear, so the saturation velocity wants to be infinite.
    let recordings = record(|| Box::new(|[_, v, _], _| 3.0 * v));
    let begin = model(named("absent"), named("sign"), saturating(1.0), &[]);
    let (_, calibration) = fit(&begin, &recordings);
    let found = shapes(&calibration);
    assert!(found.iter().all(|s| s.value > 5.0), "{found:?}");
    let bounded: Vec<_> = found.iter().filter(|s| s.at_bound).collect();
    assert!(bounded.iter().all(|s| s.std_dev.is_none() && s.value == 20.0));
    assert_eq!(bounded.is_empty(), calibration.about_physics.is_empty(), "{:?}", calibration.about_physics);
    assert!(calibration.about_physics.iter().all(|w| calibration.warnings.contains(w)));
}

#[test]
fn a_model_without_shapes_is_calibrated_as_ever() {
    let recordings = record(levelling_off);
    let plain = model(named("constant"), named("sign"), linear(), &[]);
    let (same, calibration) = fit(&plain, &recordings);
    assert!(calibration.shape_fit.is_none());
    assert_eq!(same.parameters(), plain.parameters());
}
