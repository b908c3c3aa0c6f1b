//! Consistent estimates are of machines that can exist, whatever the data, and where least squares is one, they are it.

use crate::known_robot;

use std::sync::LazyLock;

use aurt_calibration::{
    Calibration, CalibrationOptions, ConsistentReport, Deviations, Estimator, NamedRecording, possible_body,
};
use aurt_rbd::{LinkBody, inconsistencies};
use aurt_simulation::robots::ur10e;
use aurt_traits::{KnownBodies, MeasurementUnit};
use known_robot::{F_DYN_HZ, KnownRobot, Noise, measured};
use proptest::prelude::*;

const UNIT: MeasurementUnit = MeasurementUnit::NewtonMetre;

fn fit(robot: &KnownRobot, recordings: &[NamedRecording], estimator: Estimator) -> Calibration {
    robot.calibrated(recordings, estimator, Deviations::Memory)
}

fn values(report: &ConsistentReport) -> Vec<f64> {
    report.standard.iter().map(|s| s.value).collect()
}

/// That bodies can exist, that coefficients are theirs, and that nothing is called unphysical.
fn is_machine(robot: &KnownRobot, found: &Calibration) {
    let report = found.consistent.as_ref().unwrap();
    let standard = values(report);
    assert_eq!(inconsistencies(&standard), []);
    let base = robot.model.base().values(&standard);
    for (own, parameter) in base.iter().zip(&found.parameters) {
        assert!(
            (own - parameter.value).abs() <= 1e-6 * own.abs().max(1e-3),
            "{}: {own} {}",
            parameter.name,
            parameter.value
        );
    }
    assert!(found.about_physics.is_empty(), "{:?}", found.about_physics);
    assert!(report.loss >= 0.0 && report.converged, "{report:?}");
}

#[test]
fn where_least_squares_is_a_machine_the_consistent_estimate_is_that() {
    let mut robot = KnownRobot::new(None);
    let recordings = [0, 1, 2].map(|kind| {
        measured(&robot.clean(kind, 16.0), &format!("{kind}"), kind as u64, Noise::White, 1e-3, None)
    });
    let plain = fit(&robot, &recordings, Estimator::Wls);
    let found = fit(&robot, &recordings, Estimator::Consistent);
    is_machine(&robot, &found);
    let report = found.consistent.as_ref().unwrap();
    // The stated loss: 0.001 squared standard deviations.
    assert!(report.loss <= 1e-3 && report.within <= 1e-3, "{} {}", report.loss, report.within);
    for (a, b) in found.parameters.iter().zip(&plain.parameters) {
        assert!(
            (a.value - b.value).abs() <= 0.032 * b.std_dev.unwrap(),
            "{}: {} {}",
            a.name,
            a.value,
            b.value
        );
    }
    assert_eq!(report.moved, []);
    // Some standard parameters never act alone; their values are one choice of many, and no deviation is claimed.
    assert!(report.standard.iter().any(|s| !s.determined && s.std_dev.is_none()));
    assert!(report.standard.iter().all(|s| s.determined == s.std_dev.is_some()));
    println!("{} steps, loss {:.1e}", report.steps, report.loss);
}

#[test]
fn noise_that_makes_least_squares_impossible_does_not_make_the_estimate_so() {
    let mut robot = KnownRobot::new(None);
    let recordings = [measured(&robot.clean(0, 16.0), "0", 7, Noise::White, 1.0, None)];
    let found = fit(&robot, &recordings, Estimator::Consistent);
    is_machine(&robot, &found);
    let report = found.consistent.as_ref().unwrap();
    // Consistency costs no more than noise does: the truth is a machine, too.
    assert!(report.loss > 0.0 && report.loss < 2.0 * report.determined as f64, "{}", report.loss);
    let miss = |c: &Calibration| {
        c.parameters
            .iter()
            .zip(&robot.truth)
            .map(|(p, t)| ((p.value - t) / p.std_dev.unwrap()).powi(2))
            .sum::<f64>()
    };
    let plain = fit(&robot, &recordings, Estimator::Wls);
    assert!(miss(&found) < miss(&plain), "{} {}", miss(&found), miss(&plain));
}

fn masses() -> [f64; 6] {
    std::array::from_fn(|link| ur10e().links[link].mass_kg)
}

/// Masses with a description of the robot as prior, and what is said of them.
fn described(size: f64, factors: [f64; 6], weight: f64) -> (Vec<f64>, Calibration) {
    let mut robot = KnownRobot::new(None);
    let recording = measured(&robot.clean(0, 16.0), "0", 7, Noise::White, size, None);
    let scaled = |(link, factor): (LinkBody, f64)| link.standard_parameters().map(|v| factor * v);
    let standard = ur10e().links.into_iter().zip(factors).flat_map(scaled).collect();
    robot.model = robot.model.with_known_bodies(KnownBodies { standard, weight });
    let found = fit(&robot, &[recording], Estimator::Consistent);
    is_machine(&robot, &found);
    let masses = values(found.consistent.as_ref().unwrap()).into_iter().skip(9).step_by(10).collect();
    (masses, found)
}

#[test]
fn what_the_data_leave_open_stays_at_a_true_description() {
    let truth = masses();
    let furthest =
        |masses: &[f64]| masses.iter().zip(truth).map(|(m, t)| (m / t).ln().abs()).fold(0.0, f64::max).exp();
    let is_told = |found: &Calibration| found.warnings.iter().any(|w| w.contains("more than a factor of 3"));
    for size in [1.0, 4.0] {
        for weight in [0.0, 0.1, 1.0, KnownBodies::USUAL_WEIGHT] {
            let (masses, found) = described(size, [1.0; 6], weight);
            let report = found.consistent.as_ref().unwrap();
            println!(
                "noise {size}, weight {weight}: {masses:.2?}, χ² {:.1}, {} steps",
                report.loss, report.steps
            );
            assert_eq!(is_told(&found), furthest(&masses) > 3.0, "{masses:?} {:?}", found.warnings);
            if weight >= KnownBodies::USUAL_WEIGHT {
                assert!(furthest(&masses) < 1.15, "{masses:?}");
                assert!(report.loss < 2.0 * report.determined as f64, "{}", report.loss);
            }
        }
    }
    // A description that is wrong where the data know better does not hold them.
    let (masses, found) = described(1.0, [1.0, 1.0, 6.0, 1.0, 1.0, 1.0], KnownBodies::USUAL_WEIGHT);
    println!("{masses:.2?} {:?}", found.warnings);
    assert!(masses[2] < 1.5 * truth[2] && is_told(&found), "{masses:?} {:?}", found.warnings);
}

/// A description has bodies and no rotors. Of the first two joints' rotors the model cannot have terms, for they are parts of
/// the links; their inertia is not made of mass.
#[test]
fn rotors_that_no_description_has_leave_masses_as_they_are() {
    let rotor_kg_m2 = [0.95, 0.95, 0.0, 0.0, 0.0, 0.0];
    let truth = masses();
    let standard = ur10e().standard_parameters();
    for weight in [0.1, 1.0, KnownBodies::USUAL_WEIGHT] {
        let mut robot = KnownRobot::new(None);
        let mut clean = robot.clean(0, 16.0);
        for (joint, inertia) in rotor_kg_m2.iter().enumerate() {
            let (q, last) = (&clean.position_rad[joint], clean.time_s.len() - 1);
            for k in 0..=last {
                let at = k.clamp(1, last - 1);
                let acceleration = (q[at + 1] - 2.0 * q[at] + q[at - 1]) * known_robot::RATE_HZ.powi(2);
                clean.measurement.as_mut().unwrap()[joint][k] += inertia * acceleration;
            }
        }
        let recording = measured(&clean, "0", 7, Noise::White, 1.0, None);
        robot.model = robot.model.with_known_bodies(KnownBodies { standard: standard.clone(), weight });
        let found = fit(&robot, &[recording], Estimator::Consistent);
        is_machine(&robot, &found);
        let report = found.consistent.as_ref().unwrap();
        let masses: Vec<f64> = values(report).into_iter().skip(9).step_by(10).collect();
        println!("weight {weight}: {masses:.2?}, χ² {:.1}, {} steps", report.loss, report.steps);
        let furthest = masses.iter().zip(truth).map(|(m, t)| (m / t - 1.0).abs()).fold(0.0, f64::max);
        assert!(furthest < 0.25, "{masses:?}");
        assert!(report.loss < 2.0 * report.determined as f64, "{}", report.loss);
    }
}

#[test]
fn a_load_is_a_body_and_its_mass_no_worse() {
    let side = 2.8 / 12.0 * (0.1_f64.powi(2) + 0.1_f64.powi(2));
    let load = LinkBody {
        mass_kg: 2.8,
        com_m: [0.0, 0.01, 0.07],
        inertia_at_com_kg_m2: [side, 0.0, 0.0, side, 0.0, side],
    };
    let mut robot = KnownRobot::new(Some(&load));
    let mut empty = KnownRobot::new(None);
    let scopes = aurt_calibration::TermScopes::new(vec![Some(vec!["loaded".into()])]);
    let recordings = [
        measured(&empty.clean(0, 16.0), "empty", 1, Noise::White, 1.0, None),
        measured(&robot.clean(1, 16.0), "loaded", 2, Noise::White, 1.0, None),
    ];
    let fit = |estimator| {
        let options = CalibrationOptions { estimator, ..CalibrationOptions::default() };
        aurt_calibration::calibrate_scoped(&robot.model, &recordings, &scopes, UNIT, F_DYN_HZ, &options)
            .unwrap()
    };
    let (plain, found) = (fit(Estimator::Wls), fit(Estimator::Consistent));
    is_machine(&robot, &found);
    let of = |c: &Calibration| c.coefficients()[c.parameters.len() - 10..].to_vec();
    assert_eq!(inconsistencies(&of(&found)), []);
    let error = |c: &Calibration| (of(c)[9] - 2.8).abs();
    let deviation = plain.parameters.last().unwrap().std_dev.unwrap();
    assert!(
        error(&found) <= error(&plain) + 0.2 * deviation,
        "{} {} {deviation}",
        error(&found),
        error(&plain)
    );
}

#[test]
fn a_recording_that_is_listed_twice_says_nothing_new() {
    let mut robot = KnownRobot::new(None);
    let noise = Noise::GaussMarkov { time_s: 0.1 };
    let once = measured(&robot.clean(0, 16.0), "0", 3, noise, 1.0, None);
    let twice = [once.clone(), NamedRecording { name: "a copy".into(), ..once.clone() }];
    let [single, double] = [&twice[..1], &twice].map(|r| fit(&robot, r, Estimator::Wls));
    let mut ratios = Vec::new();
    for (a, b) in single.parameters.iter().zip(&double.parameters) {
        assert!((a.value - b.value).abs() < 1e-3 * a.std_dev.unwrap(), "{}: {} {}", a.name, a.value, b.value);
        ratios.push(b.std_dev.unwrap() / a.std_dev.unwrap());
    }
    // Without a look at the contents the ratio would be 0.71.
    assert!(ratios.iter().all(|r| (0.9..1.1).contains(r)), "{ratios:?}");
    // Another recording does say something new.
    let other = [once, measured(&robot.clean(1, 16.0), "1", 4, noise, 1.0, None)];
    let more = fit(&robot, &other, Estimator::Wls);
    let shorter =
        single.parameters.iter().zip(&more.parameters).filter(|(a, b)| b.std_dev < a.std_dev).count();
    assert!(shorter > 40, "{shorter}");
}

static CLEAN: LazyLock<NamedRecording> =
    LazyLock::new(|| measured(&KnownRobot::new(None).clean(2, 10.0), "any", 5, Noise::White, 1.0, None));

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_data_give_a_machine(
        gains in proptest::collection::vec(prop_oneof![-3.0..-0.2_f64, 0.2..3.0_f64], 6),
        waves in proptest::collection::vec(-40.0..40.0_f64, 6),
        hertz in 0.05..2.0_f64,
    ) {
        let robot = KnownRobot::new(None);
        let mut recording = CLEAN.clone();
        for segment in &mut recording.data.segments {
            for (joint, series) in segment.measurement.as_mut().unwrap().iter_mut().enumerate() {
                for (row, y) in series.iter_mut().enumerate() {
                    *y = gains[joint] * *y + waves[joint] * (hertz * row as f64 / 3.0 + joint as f64).sin();
                }
            }
        }
        let found = fit(&robot, &[recording], Estimator::Consistent);
        let report = found.consistent.as_ref().unwrap();
        prop_assert_eq!(inconsistencies(&values(report)), []);
        // Data of no robot at all may take longer than the search lasts; then that is said.
        let said = found.warnings.iter().any(|w| w.contains("did not converge"));
        prop_assert!(report.converged != said, "{} steps", report.steps);
        prop_assert!(found.about_physics.is_empty(), "{:?}", found.about_physics);
    }

    #[test]
    fn any_estimate_of_a_body_gives_a_body(
        estimate in proptest::collection::vec(-1.0..1.0_f64, 10),
        deviations in proptest::collection::vec(-3.0..1.0_f64, 10),
        mass in prop_oneof![-5.0..-0.1_f64, 0.1..5.0_f64],
    ) {
        let mut standard: [f64; 10] = estimate.try_into().unwrap();
        standard[9] = mass;
        let mut covariance = vec![0.0; 100];
        (0..10).for_each(|k| covariance[11 * k] = 10_f64.powf(2.0 * deviations[k]));
        let found = possible_body(&standard, &covariance).unwrap();
        let positive = found.standard.map(|v| mass.signum() * v);
        prop_assert_eq!(inconsistencies(&positive), []);
        let distance: f64 = (0..10)
            .map(|k| (found.standard[k] - standard[k]).powi(2) / covariance[11 * k])
            .sum();
        prop_assert!((distance - found.loss).abs() <= 1e-6 * (1.0 + distance), "{} {}", distance, found.loss);
    }
}

#[test]
fn a_body_that_can_exist_stays() {
    let body = LinkBody {
        mass_kg: 2.8,
        com_m: [0.01, -0.02, 0.1],
        inertia_at_com_kg_m2: [0.02, 0.001, 0.0, 0.03, 0.002, 0.025],
    };
    let standard = body.standard_parameters();
    let mut covariance = vec![0.0; 100];
    (0..10).for_each(|k| covariance[11 * k] = 1e-6);
    let found = possible_body(&standard, &covariance).unwrap();
    assert!(found.loss <= 1e-3, "{}", found.loss);
    covariance[0] = f64::NAN;
    assert_eq!(possible_body(&standard, &covariance), None);
}
