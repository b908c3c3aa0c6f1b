use std::path::{Path, PathBuf};

use aurt_recording::{ReadOptions, ReadReport, Recording, read_recording};
use aurt_traits::MeasurementUnit;
use proptest::prelude::*;

use super::*;
use crate::dice::Dice;

fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// Three joints: two that swing, with a rest of 2 s in the middle, and one that never moves and whose drive shows
/// nothing. Encoder steps of 1e-4 rad, measurement steps of `step`, stamps alternating by `jitter_s`.
fn recording(seed: u64, rate_hz: f64, jitter_s: f64, noise: f64, step: f64) -> Recording {
    let mut dice = Dice(seed);
    let n = (20.0 * rate_hz) as usize;
    let mut time_s = Vec::new();
    let mut q = vec![Vec::new(), Vec::new(), Vec::new()];
    let mut y = vec![Vec::new(), Vec::new(), Vec::new()];
    for k in 0..n {
        let t = k as f64 / rate_hz + if k % 2 == 0 { 0.0 } else { jitter_s };
        let phase = if t < 9.0 { t } else { (t - 2.0).max(9.0) };
        time_s.push(t);
        for j in 0..2 {
            let w = 1.7 + 0.6 * j as f64;
            let angle = (w * phase).sin() + 0.3 * (2.3 * w * phase).cos();
            let torque = 30.0 * (w * phase).sin() + 8.0 * (3.1 * w * phase + 0.4).cos();
            q[j].push(rounded(angle, 1e-4));
            y[j].push(rounded(torque + noise * dice.normal(), step));
        }
        q[2].push(0.7);
        y[2].push(0.0);
    }
    Recording {
        file: PathBuf::from("made.csv"),
        time_s,
        position_rad: q,
        velocity_rad_s: None,
        measurement: Some(y),
        unit: MeasurementUnit::NewtonMetre,
        joints: aurt_recording::RecordedJoints::Unnamed,
        report: ReadReport::default(),
    }
}

fn effects(found: &RecordingFaults) -> Vec<&'static str> {
    found.faults.iter().map(|f| f.effect.id).collect()
}

fn number(fault: &Fault, name: &str) -> f64 {
    fault.parameters[name].value.as_f64().unwrap()
}

#[test]
fn what_was_left_out_on_purpose_is_not_missing() {
    let made = recording(1, 250.0, 0.0, 0.05, 1e-4);
    let order: Vec<usize> = (0..made.samples()).filter(|k| !(500..700).contains(k)).collect();
    let mut shorter = made.clone();
    shorter.time_s = picked(&order, &made.time_s);
    shorter.position_rad = made.position_rad.iter().map(|s| picked(&order, s)).collect();
    shorter.measurement = made.measurement.as_ref().map(|m| m.iter().map(|s| picked(&order, s)).collect());
    let found = RecordingFaults::find("made", &shorter);
    assert_eq!(number(&found.faults[0], "missing"), 200.0);
    shorter.report.left_out_s.push([made.time_s[499], made.time_s[700]]);
    assert!(RecordingFaults::find("made", &shorter).faults.is_empty());
}

/// A third of the recording in which measurements stay what they were, or are zero, of one joint or of all.
#[test]
fn stuck_measurements_are_left_out() {
    let made = recording(3, 250.0, 0.0, 0.05, 1e-3);
    let rows = 500..2000;
    for joints in [vec![1], vec![0, 1]] {
        for value in [None, Some(0.0)] {
            let mut bad = made.clone();
            for joint in &joints {
                let series = &mut bad.measurement.as_mut().unwrap()[*joint];
                let value = value.unwrap_or(series[rows.start]);
                series[rows.clone()].fill(value);
            }
            let found = RecordingFaults::find("made", &bad);
            assert_eq!(effects(&found), vec!["dropped_samples"]);
            assert!(found.spoilt[rows.clone()].iter().all(|b| *b), "{joints:?}");
            assert!(found.spoilt.iter().filter(|b| **b).count() <= rows.len() + 2);
            let sentence = &found.faults[0].sentence;
            for joint in &joints {
                assert!(sentence.contains(&format!("of joint {joint} is constantly")), "{sentence}");
            }
            assert!(sentence.contains("from 2.00 to 8.00 s"), "{sentence}");
            assert_eq!(
                without_unusable_rows(&bad).unwrap().samples(),
                found.repaired(&bad).unwrap().samples()
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nothing_is_found_on_clean_recordings(
        seed in any::<u64>(),
        rate in prop::sample::select(vec![90.0, 250.0, 1000.0]),
        jitter in 0.0_f64..0.2,
        noise in prop::sample::select(vec![0.0, 0.01, 0.3]),
        step in prop::sample::select(vec![1e-5, 1e-3, 0.05, 1.0]),
    ) {
        let made = recording(seed, rate, jitter / rate, noise, step);
        let found = RecordingFaults::find("made", &made);
        prop_assert_eq!(effects(&found), Vec::<&str>::new());
        prop_assert!(found.repaired(&made).is_none());
    }

    #[test]
    fn a_limit_is_found_on_its_joint(seed in any::<u64>(), share_of_peak in 0.6_f64..0.9, noise in 0.0_f64..0.5) {
        let mut made = recording(seed, 250.0, 0.0, noise, 1e-4);
        let series = &mut made.measurement.as_mut().unwrap()[1];
        let limit = rounded(share_of_peak * series.iter().fold(0.0_f64, |m, v| m.max(v.abs())), 1e-4);
        series.iter_mut().for_each(|v| *v = v.clamp(-limit, limit));
        let clipped = series.iter().filter(|v| v.abs() == limit).count();
        let found = RecordingFaults::find("made", &made);
        prop_assert_eq!(effects(&found), vec!["saturation"]);
        let fault = &found.faults[0];
        prop_assert_eq!(&fault.joints, &vec![1]);
        prop_assert!((number(fault, "limit") - limit).abs() < 1e-9);
        let counted = found.clipped[1].iter().filter(|c| **c).count();
        prop_assert_eq!(counted, clipped);
        prop_assert!(found.clipped[0].iter().all(|c| !c));
    }

    #[test]
    fn faulty_rows_are_counted_and_left_out(
        seed in any::<u64>(),
        missing in 0_usize..30,
        repeated in 0_usize..30,
        held in 0_usize..30,
    ) {
        let made = recording(seed, 250.0, 0.0, 0.05, 1e-4);
        // Places are some seconds long and apart, so that no two faults meet, and outside the rest.
        let places = |from: f64, count: usize| -> Vec<usize> {
            (0..count).map(|k| (250.0 * from) as usize + 7 * k).filter(|k| moves_fast(&made, *k)).collect()
        };
        let (lost, twice, old) = (places(0.5, missing), places(2.5, repeated), places(5.0, held));
        let mut broken = made.clone();
        for k in &old {
            for s in broken.position_rad.iter_mut().chain(broken.measurement.iter_mut().flatten()) {
                s[*k] = s[*k - 1];
            }
        }
        let order: Vec<usize> = (0..made.samples())
            .filter(|k| !lost.contains(k))
            .flat_map(|k| std::iter::repeat_n(k, 1 + usize::from(twice.contains(&k))))
            .collect();
        broken.time_s = picked(&order, &broken.time_s);
        broken.position_rad = broken.position_rad.iter().map(|s| picked(&order, s)).collect();
        broken.measurement = broken.measurement.map(|m| m.iter().map(|s| picked(&order, s)).collect());
        let found = RecordingFaults::find("made", &broken);
        let wanted = [("missing", lost.len()), ("repeated", twice.len()), ("held", old.len())];
        if wanted.iter().map(|w| w.1).sum::<usize>() < 3 {
            prop_assert!(found.faults.is_empty());
        } else {
            prop_assert_eq!(effects(&found), vec!["dropped_samples"]);
            for (kind, count) in wanted {
                prop_assert_eq!(number(&found.faults[0], kind), count as f64, "{}", kind);
            }
        }
        if twice.len() + old.len() > 0 {
            let repaired = found.repaired(&broken).unwrap();
            prop_assert_eq!(repaired.samples(), made.samples() - lost.len() - old.len());
            for (k, t) in repaired.time_s.iter().enumerate() {
                let original = made.time_s.iter().position(|x| x == t).unwrap();
                prop_assert_eq!(repaired.position_rad[1][k], made.position_rad[1][original]);
            }
        }
    }
}

fn picked(order: &[usize], series: &[f64]) -> Vec<f64> {
    order.iter().map(|k| series[*k]).collect()
}

/// Whether joint 0 or 1 makes at least three encoder steps per row around row `k`.
fn moves_fast(made: &Recording, k: usize) -> bool {
    (0..2).any(|j| {
        let q = &made.position_rad[j];
        let steps =
            [-5_isize, 0].map(|d| (q[k.saturating_add_signed(d) + 5] - q[k.saturating_add_signed(d)]) / 5e-4);
        steps[0] * steps[1] > 0.0 && steps.iter().all(|s| s.abs() > 3.0)
    })
}

#[test]
fn a_spike_is_found_and_a_step_is_not() {
    let mut made = recording(3, 250.0, 0.0, 0.05, 1e-4);
    let series = &mut made.measurement.as_mut().unwrap()[0];
    for k in [400, 900, 1500, 4000] {
        series[k] = 3.2e4;
    }
    series[3000..].iter_mut().for_each(|v| *v += 50.0);
    let found = RecordingFaults::find("made", &made);
    assert_eq!(number(&found.faults[0], "corrupt"), 4.0);
    assert_eq!(found.repaired(&made).unwrap().samples(), made.samples() - 4);

    // Many spikes of one height are no limit.
    let series = &mut made.measurement.as_mut().unwrap()[0];
    (0..12).for_each(|k| series[500 + 100 * k] = 3.2e4);
    assert_eq!(effects(&RecordingFaults::find("made", &made)), ["dropped_samples"]);
}

/// Rows that have the values of a lost one repeat nothing; their angles lag.
#[test]
fn old_rows_behind_lost_ones_are_left_out() {
    let mut made = recording(3, 250.0, 0.0, 0.05, 1e-4);
    let step = |k: usize| made.position_rad[1][k + 1] - made.position_rad[1][k];
    let lost: Vec<usize> =
        (100..4900).step_by(50).filter(|k| step(*k).abs().min(step(k - 1).abs()) > 5e-3).collect();
    assert!(lost.len() > 20, "{}", lost.len());
    for k in &lost {
        for s in made.position_rad.iter_mut().chain(made.measurement.iter_mut().flatten()) {
            s[*k + 1] = s[*k];
        }
    }
    let rows: Vec<usize> = (0..made.samples()).filter(|k| !lost.contains(k)).collect();
    made.time_s = picked(&rows, &made.time_s);
    made.position_rad = made.position_rad.iter().map(|s| picked(&rows, s)).collect();
    made.measurement = made.measurement.map(|m| m.iter().map(|s| picked(&rows, s)).collect());
    // A row without measurements, far from the others.
    let silent = rows.iter().position(|k| *k == 4950).unwrap();
    made.measurement.iter_mut().flatten().for_each(|s| s[silent] = 0.0);
    let mut found = RecordingFaults::find("made", &made);
    for (kind, more) in [("missing", 0.0), ("corrupt", 1.0)] {
        assert_eq!(number(&found.faults[0], kind), lost.len() as f64 + more, "{kind}");
    }
    assert!(std::mem::take(&mut found.spoilt[silent]));
    let old: Vec<usize> = (0..rows.len()).filter(|k| found.spoilt[*k]).map(|k| rows[k] - 1).collect();
    assert_eq!(old, lost);
    assert_eq!(without_unusable_rows(&made).unwrap().samples(), rows.len() - lost.len() - 1);
}

#[test]
fn rows_near_clipped_samples_are_marked() {
    let mut clipped = vec![vec![false; 1000]; 2];
    clipped[1][300..320].fill(true);
    let faults = RecordingFaults {
        faults: vec![],
        clipped,
        spoilt: vec![false; 1000],
        gaps_s: vec![[5.0, 6.0], [8.0, 8.02]],
    };
    let mut made = recording(1, 100.0, 0.0, 0.1, 1e-4);
    for series in made.position_rad.iter_mut().chain(made.measurement.iter_mut().flatten()) {
        series.truncate(1000);
    }
    made.time_s.truncate(1000);
    let time_s: Vec<f64> = (0..250).map(|k| 0.04 * f64::from(k)).collect();
    let rows = RecordingRows {
        name: "made".into(),
        role: crate::recordings::rows::Role::Target,
        rate_hz: 25.0,
        segment_starts: vec![0, time_s.len()],
        joints: vec![crate::recordings::rows::JointRows::default(); 2],
        time_s,
    };
    let faulty = faults.faulty_rows(&made, &rows, 5.0);
    let marked = |joint: usize, t: f64| faulty[joint][(t / 0.04).round() as usize];
    assert!(marked(1, 3.0) && marked(1, 2.92) && marked(1, 3.28) && !marked(1, 2.8) && !marked(1, 3.4));
    assert!(!marked(0, 3.0), "joint 0 is not clipped");
    assert!(marked(0, 5.4) && marked(1, 5.4), "a long gap concerns all joints");
    assert!(!marked(0, 8.0), "a short gap is bridged");
}

#[test]
fn poisson_tail_agrees_with_its_sum() {
    for (mean, count) in [(0.1, 3), (2.0, 9), (5.0, 25)] {
        let term = |n: usize| {
            let log: f64 = (1..=n).map(|k| (k as f64).ln()).sum();
            (n as f64 * f64::ln(mean) - mean - log).exp()
        };
        let exact: f64 = (count..count + 60).map(term).sum();
        let bound = 10.0_f64.powf(log10_poisson_tail(mean, count));
        assert!(bound >= exact && bound < 1.3 * exact, "{mean} {count}: {bound:e} {exact:e}");
    }
}

/// Real recordings: nothing but what is truly there.
#[test]
fn real_recordings_have_the_faults_that_they_have() {
    let Some(folder) = std::env::var_os("AURT_DATA").map(PathBuf::from).filter(|f| f.is_dir()) else {
        eprintln!("skipped: AURT_DATA names no folder of recordings");
        return;
    };
    let files = [
        ("ur10e/excitation_20s.csv", None),
        ("ur10e/excitation_30s.csv", None),
        ("ur10e/excitation_50s.csv", None),
        ("ur10e/unloaded_50s.csv", None),
        ("ur10e/payload_50s.csv", None),
        ("ur10e/point_to_point.csv", None),
        ("ur10e/joint_1_only.csv", None),
        ("ur10e_500hz/calibration.csv", None),
        ("ur10e_500hz/validation_8harm.csv", None),
        ("ur10e_500hz/validation_point_to_point.csv", None),
        ("tx40/excitation_1khz.csv", None),
        // 60 distances of two periods and 13 of three.
        ("ur3e/wave_joint_1.csv", Some(("missing", 86.0, 86.0))),
        // Written by a program that read the same packet twice now and then.
        ("panda/excitation.csv", Some(("held", 1100.0, 1400.0))),
    ];
    for (file, wanted) in files {
        let path = folder.join(file);
        if !Path::exists(&path) {
            eprintln!("skipped: {file} is not there");
            continue;
        }
        let recording = read_recording(&path, &ReadOptions::default()).unwrap();
        let found = RecordingFaults::find(file, &recording);
        let sentences: Vec<&String> = found.faults.iter().map(|f| &f.sentence).collect();
        match wanted {
            None => assert!(found.faults.is_empty(), "{file}: {sentences:?}"),
            Some((kind, least, most)) => {
                assert_eq!(effects(&found), ["dropped_samples"], "{file}: {sentences:?}");
                let count = number(&found.faults[0], kind);
                assert!((least..=most).contains(&count), "{file}: {sentences:?}");
            }
        }
    }
}

/// The values between clippings are no spikes.
#[test]
fn a_clipped_measurement_has_no_spikes() {
    let mut made = recording(5, 500.0, 0.0, 0.3, 1e-4);
    let series = &mut made.measurement.as_mut().unwrap()[1];
    series.iter_mut().for_each(|v| *v = v.clamp(-4.0, 4.0));
    let found = RecordingFaults::find("made", &made);
    assert_eq!(effects(&found), vec!["saturation"]);
}
