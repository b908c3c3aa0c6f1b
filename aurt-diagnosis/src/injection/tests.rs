//! Trials against whole diagnoses, on a planar arm of two links that lacks nothing.

use std::path::Path;

use aurt_calibration::CalibrationOptions;
use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, ReadReport, Recording};
use aurt_traits::{MeasurementUnit, Motion, RegressorTile, RobotModel};

use super::{AddedRows, Prepared};
use crate::dice::Dice;
use crate::investigation::investigate;
use crate::recordings::rows::Role;
use crate::request::{Question, QuestionedRecording, SelectionOptions};
use crate::verdict::{Answer, Verdict, write_verdict};

const RATE_HZ: f64 = 100.0;
const F_DYN_HZ: f64 = 2.0;
const NOISE_NM: f64 = 0.2;

fn model() -> RobotModel {
    let folder = tempfile::tempdir().unwrap();
    let (mdh, unread) = (folder.path().join("mdh.csv"), folder.path().join("unread.csv"));
    std::fs::write(&mdh, "alpha,a,d\n0,0.5,0\n0,0.4,0\n").unwrap();
    std::fs::write(&unread, "").unwrap();
    let text = format!(
        "schema = 1\n[robot]\nmdh = {mdh:?}\ngravity_m_s2 = [0.0, -9.81, 0.0]\n[joint_dynamics]\ncoulomb = {{ model = \"none\" }}\n\
         hysteresis = {{ model = \"sign\" }}\nviscous = {{ model = \"polynomial\", powers = [1] }}\n[preprocess]\n\
         f_dyn_hz = {F_DYN_HZ:?}\n[recordings]\ncalibration = [{unread:?}]\n"
    );
    let mut registry = Registry::linked().unwrap();
    Experiment::parse(&text, Path::new("experiment.toml"), &mut registry).unwrap().robot_model().unwrap()
}

/// Two joints on sums of sines, with friction and white noise.
fn recording(model: &RobotModel, seed: u64, seconds: f64) -> Recording {
    let count = (seconds * RATE_HZ) as usize;
    let time: Vec<f64> = (0..count).map(|k| k as f64 / RATE_HZ).collect();
    let mut series = [const { Vec::new() }; 3];
    for j in 0..2 {
        let rates = [0.61, 1.13, 1.97].map(|w| w * (1.0 + 0.13 * f64::from(j) + 0.017 * seed as f64));
        for t in &time {
            let of = |derivative: fn(f64, f64) -> f64| -> f64 {
                rates.iter().map(|w| derivative(*w, *t) / w).sum::<f64>()
            };
            series[0].push(0.6 * of(|w, t| (w * t).sin()));
            series[1].push(0.6 * of(|w, t| w * (w * t).cos()));
            series[2].push(0.6 * of(|w, t| -w * w * (w * t).sin()));
        }
    }
    let [position, velocity, acceleration] = series;
    let motion = Motion::new(2, time.clone(), position.clone(), velocity.clone(), acceleration).unwrap();
    let body = model.rigid_body();
    let parameters: Vec<f64> = body
        .standard_parameters()
        .iter()
        .map(|p| match p.name.get(..2) {
            Some("m_") => 4.0,
            Some("mX") => 1.0,
            Some("ZZ") => 0.3,
            _ => 0.0,
        })
        .collect();
    let n = parameters.len();
    let destination: Vec<u32> = (0..2 * n).map(|k| k as u32).collect();
    let mut data = vec![0.0; 2 * n * count];
    body.evaluate(motion.view(), &mut RegressorTile::new(&destination, n, count, count, &mut data));
    let mut dice = Dice(seed.wrapping_mul(7919).wrapping_add(13));
    let measurement = (0..2)
        .map(|j| {
            (0..count)
                .map(|k| {
                    let links: f64 = (0..n).map(|p| parameters[p] * data[(j * n + p) * count + k]).sum();
                    let v = velocity[j * count + k];
                    links + 2.0 * v.signum() + 1.5 * v + NOISE_NM * dice.normal()
                })
                .collect()
        })
        .collect();
    Recording {
        file: "made.csv".into(),
        time_s: time,
        position_rad: position.chunks(count).map(<[f64]>::to_vec).collect(),
        velocity_rad_s: None,
        measurement: Some(measurement),
        unit: MeasurementUnit::NewtonMetre,
        joints: aurt_recording::RecordedJoints::Unnamed,
        report: ReadReport::default(),
    }
}

fn questioned(role: Role, raw: Recording) -> QuestionedRecording {
    QuestionedRecording::new(role, format!("{role:?}"), raw, PreprocessOptions::new(F_DYN_HZ)).unwrap()
}

fn recordings(model: &RobotModel) -> Vec<QuestionedRecording> {
    let one = |role, seed| questioned(role, recording(model, seed, 40.0));
    vec![one(Role::Calibration, 1), one(Role::Target, 2), one(Role::Validation, 3)]
}

fn question<'a>(model: &'a RobotModel, recordings: &'a [QuestionedRecording]) -> Question<'a> {
    Question {
        model,
        frozen: None,
        recordings,
        unit: MeasurementUnit::NewtonMetre,
        f_dyn_hz: F_DYN_HZ,
        calibration: CalibrationOptions::default(),
        selection: SelectionOptions::default(),
        without: &[],
        scale: None,
    }
}

/// A spring on joint 1 in a recording, `[joint][sample]`.
fn spring(raw: &Recording, nm_rad: f64) -> Vec<Vec<f64>> {
    vec![vec![0.0; raw.samples()], raw.position_rad[1].iter().map(|q| nm_rad * (q - 0.2)).collect()]
}

fn with_spring(recording: &QuestionedRecording, nm_rad: f64) -> QuestionedRecording {
    let mut raw = (*recording.raw).clone();
    let added = spring(&raw, nm_rad);
    for (series, added) in raw.measurement.iter_mut().flatten().zip(added) {
        series.iter_mut().zip(added).for_each(|(y, e)| *y += e);
    }
    questioned(recording.role, raw)
}

fn rows(prepared: &Prepared<'_>, recordings: &[QuestionedRecording], nm_rad: f64) -> AddedRows {
    let mut rows = prepared.nothing();
    for r in [1, 2] {
        rows[r] = prepared.rows_of(r, spring(&recordings[r].raw, nm_rad)).unwrap();
    }
    rows
}

fn claims(verdict: &Verdict) -> Vec<(&str, &[usize])> {
    verdict.effects.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

#[test]
fn moments_of_a_trial_are_those_of_recordings_with_the_effect() {
    let model = model();
    let plain = recordings(&model);
    let registry = Registry::linked().unwrap();
    let asked = question(&model, &plain);
    let prepared = Prepared::new(&asked, &registry, |_| {}).unwrap();
    let anew = prepared.anew(&rows(&prepared, &plain, 3.0), 0.0);
    let sprung = [plain[0].clone(), with_spring(&plain[1], 3.0), with_spring(&plain[2], 3.0)];
    let whole = investigate(&question(&model, &sprung), &registry, |_| {}).unwrap();
    let own = model.parameters().len();
    let close = |a: f64, b: f64, size: f64| (a - b).abs() < 1e-9 * size;
    for block in 0..whole.problem.blocks() {
        let (here, there) = (anew.problem.fold(block), whole.problem.fold(block));
        for (a, b) in [(here.0, there.0), (here.1, there.1)] {
            for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
                assert!(close(a.square, b.square, b.square.max(1.0)), "{} {}", a.square, b.square);
                for k in 0..model.row_columns(0).len().min(own).min(5) {
                    let size = (b.square * b.gram[k * b.columns + k]).sqrt().max(1.0);
                    assert!(close(a.right[k], b.right[k], size), "{k}: {} {}", a.right[k], b.right[k]);
                }
            }
        }
    }
    let largest = whole.baseline.coefficients.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    for (a, b) in anew.coefficients.iter().zip(&whole.baseline.coefficients) {
        assert!((a - b).abs() < 1e-6 * largest, "{a} {b}");
    }
}

#[test]
fn a_trial_says_what_a_whole_diagnosis_says() {
    let model = model();
    let plain = recordings(&model);
    let registry = Registry::linked().unwrap();
    let asked = question(&model, &plain);
    let prepared = Prepared::new(&asked, &registry, |_| {}).unwrap();
    assert_eq!(prepared.verdict().verdict, Answer::NoMismatch, "{:#?}", prepared.verdict().effects);
    for nm_rad in [0.0, 0.02, 5.0] {
        let said = prepared.said_with("spring", &rows(&prepared, &plain, nm_rad), 0.0).unwrap().unwrap();
        let sprung = [plain[0].clone(), with_spring(&plain[1], nm_rad), with_spring(&plain[2], nm_rad)];
        let asked = question(&model, &sprung);
        let whole = write_verdict(&asked, &investigate(&asked, &registry, |_| {}).unwrap());
        assert_eq!((said.verdict, claims(&said)), (whole.verdict, claims(&whole)), "{nm_rad} Nm/rad");
        let named = if nm_rad > 1.0 { vec![("spring", &[1_usize][..])] } else { vec![] };
        assert_eq!(claims(&said), named);
    }
    // Noise of the same memory and size, drawn by turning it, changes nothing of this.
    for turn in [0.3, 0.6] {
        let said = prepared.said_with("spring", &rows(&prepared, &plain, 5.0), turn).unwrap().unwrap();
        assert_eq!(claims(&said), [("spring", &[1_usize][..])]);
        assert_eq!(prepared.said_with("spring", &prepared.nothing(), turn).unwrap().unwrap().effects, []);
    }
}

/// Five faulty rows of 4000 are claimed if their repair improves the fit, and else are a note.
#[test]
fn a_fault_of_few_rows_is_claimed_if_its_repair_matters() {
    const FAULTY: [usize; 5] = [2900, 2300, 1700, 1100, 500];
    let model = model();
    let registry = Registry::linked().unwrap();
    let said = |spoil: &dyn Fn(&mut Recording)| {
        let mut recordings = recordings(&model);
        let mut raw = (*recordings[0].raw).clone();
        spoil(&mut raw);
        recordings[0] = questioned(Role::Calibration, raw);
        let asked = question(&model, &recordings);
        let verdict = write_verdict(&asked, &investigate(&asked, &registry, |_| {}).unwrap());
        let noted = verdict.notes.iter().any(|note| note.contains(": 5 "));
        (claims(&verdict).iter().map(|(effect, _)| (*effect).to_owned()).collect::<Vec<_>>(), noted)
    };
    let corrupt = said(&|raw| {
        let series = raw.measurement.iter_mut().flatten();
        series.for_each(|series| FAULTY.iter().for_each(|row| series[*row] += 60.0));
    });
    assert_eq!(corrupt, (vec!["dropped_samples".to_owned()], false));
    let missing = said(&|raw| {
        let series = raw.position_rad.iter_mut().chain(raw.measurement.iter_mut().flatten());
        series.chain([&mut raw.time_s]).for_each(|series| {
            for row in FAULTY {
                series.remove(row);
            }
        });
    });
    assert_eq!(missing, (vec![], true));
}

/// A constant larger than dry friction would be friction that drives the joint one way. No machine has that.
#[test]
fn a_constant_larger_than_dry_friction_is_no_friction() {
    let model = model();
    let registry = Registry::linked().unwrap();
    let mut recordings = recordings(&model);
    for r in [1, 2] {
        let mut raw = (*recordings[r].raw).clone();
        raw.measurement.iter_mut().flatten().nth(1).unwrap().iter_mut().for_each(|y| *y += 6.0);
        recordings[r] = questioned(recordings[r].role, raw);
    }
    let asked = question(&model, &recordings);
    let verdict = write_verdict(&asked, &investigate(&asked, &registry, |_| {}).unwrap());
    assert_eq!(claims(&verdict), [("current_offset", &[1_usize][..])], "{:#?}", verdict.indications);
}
