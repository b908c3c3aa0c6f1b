//! Parameters recovered from recordings of a known robot, as often as their confidence intervals promise.

use std::f64::consts::TAU;

use aurt_calibration::{CalibrationOptions, NamedRecording, calibrate};
use aurt_plugins::model::{Friction, RigidBodyDynamics};
use aurt_rbd::{ChainDynamics, LinkBody, MdhRows, MdhTable, SerialChain};
use aurt_recording::{PreprocessOptions, Recording, preprocess};
use aurt_traits::MeasurementUnit;

const SEEDS: u64 = 150;
const RATE_HZ: f64 = 250.0;
const DURATION_S: f64 = 16.0;
const F_DYN_HZ: f64 = 5.0;
const COULOMB_NM: [f64; 3] = [4.0, 3.0, 1.5];
const VISCOUS_NM_S: [f64; 3] = [6.0, 4.0, 2.0];
const NOISE_NM: [f64; 3] = [0.8, 0.6, 0.3];

/// The first three joints of a UR10e (data sheet geometry).
const MDH: &str = "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\n";

/// Angle, velocity, acceleration of a joint: harmonics of the recording's length below 1 Hz, at rest at both ends as
/// excitation is.
fn motion(joint: usize, t: f64) -> [f64; 3] {
    let mut out = [0.0; 3];
    for k in 0..4 {
        let omega = TAU * (2 + 3 * k + joint) as f64 / DURATION_S;
        let amplitude = [0.4, -0.2, 0.12, -0.08][k];
        let (sin, cos) = (omega * t).sin_cos();
        out[0] += amplitude * (1.0 - cos);
        out[1] += amplitude * omega * sin;
        out[2] += amplitude * omega * omega * cos;
    }
    out
}

/// Normal deviates by Box and Muller from a 64-bit linear congruential sequence.
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

/// Torques by recursive Newton–Euler, which shares no formula with the regressor, and the friction laws as written.
fn clean(dynamics: &mut ChainDynamics) -> Recording {
    let samples = (DURATION_S * RATE_HZ) as usize;
    let mut position = vec![Vec::new(); 3];
    let mut torque = vec![Vec::new(); 3];
    let time_s: Vec<f64> = (0..samples).map(|k| k as f64 / RATE_HZ).collect();
    for t in &time_s {
        let state: Vec<[f64; 3]> = (0..3).map(|j| motion(j, *t)).collect();
        let of = |i: usize| state.iter().map(|s| s[i]).collect::<Vec<f64>>();
        let mut tau = [0.0; 3];
        dynamics.inverse_dynamics(&of(0), &of(1), &of(2), &mut tau);
        for j in 0..3 {
            position[j].push(state[j][0]);
            torque[j].push(tau[j] + COULOMB_NM[j] * state[j][1].signum() + VISCOUS_NM_S[j] * state[j][1]);
        }
    }
    let recording = Recording::from_arrays(time_s, position).unwrap();
    recording.with_measurement(torque, MeasurementUnit::NewtonMetre).unwrap()
}

#[test]
fn intervals_of_95_percent_hold_the_truth_that_often() {
    let table = MdhTable::parse(MDH, "mdh.csv", MdhRows::Next).unwrap();
    let gravity = [0.0, 0.0, -9.81];
    let body = |mass_kg: f64, com_m: [f64; 3]| {
        let own = 0.02 * mass_kg;
        LinkBody { mass_kg, com_m, inertia_at_com_kg_m2: [own, 0.0, 0.0, own, 0.0, own] }
            .standard_parameters()
    };
    let standard: Vec<f64> =
        [body(7.8, [0.02, 0.0, 0.04]), body(12.9, [-0.3, 0.01, 0.15]), body(8.0, [-0.25, 0.02, 0.05])]
            .concat();
    let mut dynamics =
        ChainDynamics::new(SerialChain::from_mdh(&table, gravity).unwrap(), &standard).unwrap();
    let stacks = (0..3).map(|_| Friction::default().stack().unwrap()).collect();
    let rigid = RigidBodyDynamics::from_mdh(&table, gravity, 0).unwrap();
    let mut truth = rigid.base.values(&standard);
    for j in 0..3 {
        truth.extend([COULOMB_NM[j], VISCOUS_NM_S[j]]);
    }
    let model = rigid.with_joint_dynamics(stacks, Vec::new()).unwrap();
    let clean = clean(&mut dynamics);

    let (mut held, mut all) = (vec![0_u64; truth.len()], 0);
    for seed in 1..=SEEDS {
        let mut random = Normal(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mut noisy = clean.clone();
        for (series, noise) in noisy.measurement.as_mut().unwrap().iter_mut().zip(NOISE_NM) {
            series.iter_mut().for_each(|y| *y += noise * random.next());
        }
        let options = PreprocessOptions { trim_rest: false, ..PreprocessOptions::new(F_DYN_HZ) };
        let data = preprocess(&noisy, &options).unwrap();
        let recordings = [NamedRecording { name: "known".into(), data }];
        let unit = MeasurementUnit::NewtonMetre;
        let found = calibrate(&model, &recordings, unit, F_DYN_HZ, &CalibrationOptions::default()).unwrap();
        assert_eq!(found.parameters.len(), truth.len());
        for ((parameter, truth), held) in found.parameters.iter().zip(&truth).zip(&mut held) {
            let [low, high] = parameter.interval_95.unwrap();
            *held += u64::from((low..=high).contains(truth));
        }
        all += truth.len() as u64;
    }
    // 150 seeds × some twenty parameters: the share scatters by half a percent, that of one parameter by 1.8 %.
    let share = held.iter().sum::<u64>() as f64 / all as f64;
    println!("{:.1} % of {all} intervals hold the truth", 100.0 * share);
    assert!((0.93..0.97).contains(&share), "{share}: {held:?} of {SEEDS}");
    assert!(held.iter().all(|h| *h as f64 > 0.87 * SEEDS as f64), "{held:?} of {SEEDS}");
}
