//! A gear of known stiffness, noise of known size, and what is found of them.

use std::f64::consts::TAU;

use aurt_recording::{PositionNoise, PreprocessOptions, ReadReport, Recording, preprocess};
use aurt_traits::MeasurementUnit;

use super::claim::{Among, Found, JointRows, Level};
use super::pieces::KindRows;
use super::rows::Kind;
use super::series::{FullRate, Piece};
use super::shape::Shape;
use crate::dice::Dice;
use crate::noise::pose::PoseColumns;

const SECONDS: f64 = 30.0;
/// M of two joints, kg m².
const INERTIA: [[f64; 2]; 2] = [[2.0, 0.4], [0.4, 0.5]];
const TORQUE_NOISE_NM: f64 = 0.2;

/// Sines of a motor, Hz and rad: slow ones, and the small fast motion of a servo.
const SINES: [(f64, f64); 7] =
    [(0.31, 0.5), (0.83, 0.2), (1.7, 0.06), (5.3, 2e-3), (8.9, 6e-4), (11.7, 4e-4), (17.1, 1e-4)];

/// Motion and recording of two motors.
#[derive(Clone, Copy)]
struct Motors {
    rate_hz: f64,
    encoder_noise_rad: [f64; 2],
    /// The resonance of the link of joint 0, or a rigid gear.
    hz: Option<f64>,
    /// Half the play of a gear that resonates, rad, whose flanks catch the link.
    half_gap_rad: f64,
    f_dyn_hz: f64,
    /// Number of sines, from the slowest.
    sines: usize,
}

const MOTORS: Motors = Motors {
    rate_hz: 500.0,
    encoder_noise_rad: [1e-6; 2],
    hz: None,
    half_gap_rad: 0.0,
    f_dyn_hz: 10.0,
    sines: SINES.len(),
};

/// The motors' angles and accelerations.
fn motion(sines: usize, joint: usize, t: f64) -> [f64; 2] {
    SINES[..sines].iter().enumerate().fold([0.0; 2], |[q, a], (k, (hz, amplitude))| {
        let omega = TAU * hz * if joint == 0 { 1.0 } else { 1.13 };
        let value = amplitude * (omega * t + k as f64).sin();
        [q + value, a - omega * omega * value]
    })
}

/// The gear of joint 0 as it is found. Its link on a spring is integrated ten times finer than it is recorded.
fn searched(motors: Motors) -> Option<Found> {
    let Motors { rate_hz, encoder_noise_rad, hz, half_gap_rad, f_dyn_hz, sines } = motors;
    let samples = (SECONDS * rate_hz) as usize;
    let mut dice = Dice(3);
    let (mut x, mut v) = (0.0_f64, 0.0);
    let mut recording = Recording {
        file: "made".into(),
        time_s: (0..samples).map(|k| k as f64 / rate_hz).collect(),
        position_rad: vec![Vec::new(); 2],
        velocity_rad_s: None,
        measurement: Some(vec![Vec::new(); 2]),
        unit: MeasurementUnit::NewtonMetre,
        joints: aurt_recording::RecordedJoints::Unnamed,
        report: ReadReport::default(),
    };
    let mut measured = vec![Vec::new(); 2];
    for k in 0..samples {
        let t = k as f64 / rate_hz;
        let acceleration = [0, 1].map(|j| motion(sines, j, t)[1]);
        let mut link = 0.0;
        if let Some(hz) = hz {
            let ratio = if half_gap_rad > 0.0 { 0.7 } else { 0.03 };
            let (stiffness, damping) =
                (INERTIA[0][0] * (TAU * hz).powi(2), 2.0 * ratio * INERTIA[0][0] * TAU * hz);
            let h = 0.1 / rate_hz;
            for step in 0..10 {
                let at = t + h * f64::from(step);
                let load: f64 = (0..2).map(|i| INERTIA[0][i] * motion(sines, i, at)[1]).sum();
                let pressed: f64 = x - x.clamp(-half_gap_rad, half_gap_rad);
                let push = stiffness * pressed + damping * v;
                let touches = half_gap_rad == 0.0 || push * pressed > 0.0;
                link = (-load - if touches { push } else { 0.0 }) / INERTIA[0][0];
                v += h * link;
                x += h * v;
            }
        }
        for j in 0..2 {
            recording.position_rad[j].push(motion(sines, j, t)[0] + encoder_noise_rad[j] * dice.normal());
            let torque = INERTIA[j][0] * (acceleration[0] + link) + INERTIA[j][1] * acceleration[1];
            measured[j].push(torque + TORQUE_NOISE_NM * dice.normal());
        }
    }
    recording.measurement = Some(measured);
    let options = PreprocessOptions { trim_rest: false, ..PreprocessOptions::new(f_dyn_hz) };
    let data = preprocess(&recording, &options).unwrap();
    let segment = &data.segments[0];
    let motion = segment.motion.view();
    let load: Vec<Vec<f64>> = (0..2)
        .map(|j| {
            let [a, b] = [0, 1].map(|i| motion.acceleration_rad_s2(i));
            a.iter().zip(b).map(|(a, b)| INERTIA[j][0] * a + INERTIA[j][1] * b).collect()
        })
        .collect();
    let raw = segment.raw_measurement.as_ref().unwrap();
    let left = |j: usize| raw[j].iter().zip(&load[j]).map(|(y, l)| y - l).collect();
    let full = FullRate {
        rate_hz: segment.rate_hz,
        time_s: motion.time_s().to_vec(),
        residual: (0..2).map(left).collect(),
        acceleration_rad_s2: (0..2).map(|j| motion.acceleration_rad_s2(j).to_vec()).collect(),
        calm: vec![vec![true; motion.samples()]; 2],
        inertia: PoseColumns::constant(&INERTIA.map(|c| c.to_vec())),
        load,
    };
    let pieces = [Piece {
        recording: 0,
        target: false,
        segment,
        full,
        gradients: PoseColumns::constant(&[vec![0.0; 2], vec![0.0; 2]]),
        position_cutoff_hz: options.effective_position_cutoff_hz(),
        noise: recording.position_rad.iter().map(|q| PositionNoise::of(&recording.time_s, q)).collect(),
    }];
    let of_kind = KindRows::new(&pieces, Kind::of(half_gap_rad)).unwrap();
    let rows = JointRows::new(&of_kind, 0).unwrap().unwrap();
    let [elastic, play]: [Vec<Shape>; 2] = rows.starts();
    let starts = if half_gap_rad > 0.0 { play } else { elastic };
    rows.search(&rows.scan(&starts), Among::All, Level { level: 0.05, trials: 2.0 }).unwrap()
}

#[test]
fn a_gear_of_known_stiffness_is_found_with_it() {
    for hz in [4.0, 9.0, 14.0] {
        let found = searched(Motors { hz: Some(hz), ..MOTORS }).unwrap();
        assert!(found.confirmed(), "{hz} Hz: {:?}", found.fails);
        assert!((found.shape.hz / hz - 1.0).abs() < 0.03, "{hz} Hz: {:?}", found.shape);
        assert!((found.amplitude - 1.0).abs() < 0.15, "{hz} Hz: {}", found.amplitude);
    }
}

#[test]
fn play_of_known_width_is_found_with_it() {
    for half_gap_rad in [5e-4, 5e-3, 0.03] {
        let found = searched(Motors { hz: Some(50.0), half_gap_rad, sines: 3, ..MOTORS }).unwrap();
        assert!(found.confirmed(), "{half_gap_rad} rad: {:?}", found.fails);
        let ratio = found.shape.half_gap_rad / half_gap_rad;
        assert!((ratio - 1.0).abs() < 0.1, "{half_gap_rad} rad: {:?}", found.shape);
        assert!((found.amplitude - 1.0).abs() < 0.15, "{half_gap_rad} rad: {}", found.amplitude);
    }
}

#[test]
fn noise_of_encoders_is_no_gear() {
    for noise_rad in [1e-6, 1e-5, 1e-4] {
        let found = searched(Motors { encoder_noise_rad: [noise_rad; 2], ..MOTORS });
        assert!(found.as_ref().is_none_or(|f| !f.confirmed()), "{noise_rad} rad: {found:?}");
    }
}

#[test]
fn noise_of_another_joints_encoder_is_no_gear() {
    // Slow motions, as at a low band: what the other joint's encoder adds to the load of this link is louder than what moves it.
    for (f_dyn_hz, noise_rad) in [(3.0, 1e-4), (3.0, 3e-4), (5.0, 3e-5), (10.0, 1e-4)] {
        let motors = Motors { encoder_noise_rad: [1e-7, noise_rad], f_dyn_hz, sines: 3, ..MOTORS };
        let found = searched(motors);
        assert!(found.as_ref().is_none_or(|f| !f.confirmed()), "{f_dyn_hz} Hz, {noise_rad} rad: {found:?}");
    }
}

#[test]
fn a_gear_is_found_beneath_the_noise_of_encoders() {
    let found = searched(Motors { encoder_noise_rad: [1e-5; 2], hz: Some(9.0), ..MOTORS }).unwrap();
    assert!(found.confirmed(), "{:?}", found.fails);
    assert!((found.shape.hz / 9.0 - 1.0).abs() < 0.04, "{:?}", found.shape);
}

#[test]
fn the_size_of_a_gears_torque_is_free_of_the_encoders_noise() {
    for noise_rad in [1e-5, 2e-5, 3e-5] {
        let found = searched(Motors { encoder_noise_rad: [noise_rad; 2], hz: Some(9.0), ..MOTORS }).unwrap();
        assert!(
            (found.amplitude - 1.0).abs() < 0.1,
            "{noise_rad} rad: {} ± {}",
            found.amplitude,
            found.amplitude_std
        );
    }
}

/// Differences of few samples a second are too small where motions are fast: a gear shows, and its frequency is up to a quarter too high.
#[test]
fn a_gear_is_found_at_a_low_rate() {
    let slow = Motors { rate_hz: 95.0, f_dyn_hz: 5.0, ..MOTORS };
    let found = searched(Motors { hz: Some(9.0), sines: 6, ..slow }).unwrap();
    assert!(found.confirmed(), "{:?}", found.fails);
    assert!((0.95..1.25).contains(&(found.shape.hz / 9.0)), "{:?}", found.shape);
    for rate_hz in [super::LEAST_RATE_HZ, 95.0] {
        for noise_rad in [1e-6, 1e-5, 1e-4] {
            let found = searched(Motors { rate_hz, encoder_noise_rad: [noise_rad; 2], ..slow });
            assert!(
                found.as_ref().is_none_or(|f| !f.confirmed()),
                "{rate_hz} Hz, {noise_rad} rad: {found:?}"
            );
        }
    }
}
