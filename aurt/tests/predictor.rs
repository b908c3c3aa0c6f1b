//! The predictor for single samples gives what the whole series gives, and takes no memory from the heap.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use aurt::friction::hysteresis::dahl::Dahl;
use aurt::plugins::Registry;
use aurt::prelude::*;
use aurt::simulate;
use aurt::simulation::{Motion, Scenario, robots};
use aurt::traits::Motion as Series;
use serde_json::{Value, json};

/// The system's allocator, counting per thread what is taken.
struct Counting;

thread_local! {
    static TAKEN: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = TAKEN.try_with(|taken| taken.set(taken.get() + 1));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

const JOINTS: usize = 6;
const DT_S: f64 = 0.002;

fn calibrated(build: impl FnOnce(ModelBuilder) -> ModelBuilder, choice: LoadTorqueChoice) -> CalibratedModel {
    let machine = robots::ur10e();
    let motion = Motion::MultiSine { duration_s: 6.0, harmonics: 6, top_hz: 1.0, share: 0.6 };
    let recording = simulate(&Scenario::new(machine.clone(), motion.plan(&machine, 1).unwrap(), 1)).unwrap();
    let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2).unwrap();
    let calibration = CalibrationOptions { load_torque: choice, fit_shapes: false, ..Default::default() };
    Calibrator::new(build(robot.model()).build().unwrap())
        .settings(Settings { calibration, ..Settings::default() })
        .calibration(&recording)
        .calibrate()
        .unwrap()
        .calibrated
}

fn named([coulomb, hysteresis, viscous]: [Value; 3]) -> Friction {
    let registry = Registry::linked().unwrap();
    Friction::new(
        registry.build_from_json(&coulomb).unwrap(),
        registry.build_from_json(&hysteresis).unwrap(),
        registry.build_from_json(&viscous).unwrap(),
    )
}

/// A motion of all joints, one value each a sample.
fn sample(k: usize) -> [[f64; JOINTS]; 3] {
    let t = DT_S * k as f64;
    let of = |f: fn(f64, f64) -> f64| std::array::from_fn(|j| f(1.0 + 0.3 * j as f64, t));
    [of(|w, t| (w * t).sin()), of(|w, t| w * (w * t).cos()), of(|w, t| -w * w * (w * t).sin())]
}

/// Predicts the motion sample by sample, and says how often memory was taken after the first sample.
fn by_samples(model: &CalibratedModel, samples: usize) -> (Vec<Vec<f64>>, usize) {
    let mut predictor = model.predictor().unwrap();
    let mut torque = vec![vec![0.0; samples]; JOINTS];
    let mut taken = 0;
    for k in 0..samples {
        let [q, qd, qdd] = sample(k);
        let before = TAKEN.get();
        let now = predictor.torque(DT_S, &q, &qd, &qdd).unwrap();
        if k > 0 {
            taken += TAKEN.get() - before;
        }
        for (series, value) in torque.iter_mut().zip(now) {
            series[k] = *value;
        }
    }
    (torque, taken)
}

fn whole(model: &CalibratedModel, samples: usize) -> Vec<Vec<f64>> {
    let time_s = (0..samples).map(|k| DT_S * k as f64).collect();
    let series = |which: usize| {
        (0..JOINTS).flat_map(|j| (0..samples).map(move |k| sample(k)[which][j])).collect::<Vec<f64>>()
    };
    let motion = Series::new(JOINTS, time_s, series(0), series(1), series(2)).unwrap();
    model.torque(motion.view()).unwrap()
}

#[test]
fn samples_give_what_the_series_gives_without_taking_memory() {
    let friction = ["sign", "tanh", "dahl", "lugre", "maxwell_slip", "bouc_wen", "gms"];
    for (k, hysteresis) in friction.into_iter().enumerate() {
        let coulomb = ["constant", "absolute", "square", "stribeck"][k % 4];
        let viscous = [json!({ "model": "polynomial", "powers": [1, 2] }), json!({ "model": "saturating" })]
            [k % 2]
            .clone();
        let choice = [LoadTorqueChoice::Fitted, LoadTorqueChoice::Literal][k % 2];
        let with_terms = ["maxwell_slip", "gms"].contains(&hysteresis);
        let build = |model: ModelBuilder| {
            let friction =
                named([json!({ "model": coulomb }), json!({ "model": hysteresis }), viscous.clone()]);
            let model = model.friction(friction);
            if with_terms {
                model.arm_term(RotorInertia::default()).arm_term(CurrentOffset::default())
            } else {
                model
            }
        };
        let model = calibrated(build, choice);
        let (samples, taken) = by_samples(&model, 400);
        // Arm terms list their joints anew for every sample, these two models their thresholds.
        assert!(with_terms || taken == 0, "{coulomb}, {hysteresis}, {viscous}: {taken}");
        let series = whole(&model, 400);
        let largest = series.iter().flatten().fold(0.0_f64, |m, t| m.max(t.abs()));
        for (joint, (one, all)) in samples.iter().zip(&series).enumerate() {
            for (a, b) in one.iter().zip(all) {
                assert!((a - b).abs() <= 1e-9 * largest, "{hysteresis}, joint {joint}: {a} {b}");
            }
        }
    }
}

#[test]
fn a_reset_predictor_begins_anew_and_refuses_other_robots() {
    let model =
        calibrated(|m| m.friction(Friction::default().hysteresis(Dahl::default())), LoadTorqueChoice::Fitted);
    let mut predictor = model.predictor().unwrap();
    let [q, qd, qdd] = sample(30);
    let first = predictor.torque(DT_S, &q, &qd, &qdd).unwrap().to_vec();
    for k in 31..60 {
        let [q, qd, qdd] = sample(k);
        predictor.torque(DT_S, &q, &qd, &qdd).unwrap();
    }
    predictor.reset();
    assert_eq!(predictor.torque(DT_S, &q, &qd, &qdd).unwrap(), first);
    assert!(predictor.torque(DT_S, &q[..5], &qd, &qdd).is_err());
}
