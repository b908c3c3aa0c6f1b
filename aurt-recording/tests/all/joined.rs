//! Recordings in several files, joined by time.

use std::path::{Path, PathBuf};

use aurt_recording::{
    AngleUnit, CurrentUnit, JoinedFile, LongRecording, Quantity, ReadOptions, RecordedAs, Recording,
    RecordingError, TimeUnit, read_recording,
};
use tempfile::TempDir;

const JOINTS: usize = 2;

/// What the robot does at `t`: smooth, and not linear.
fn position(joint: usize, t: f64) -> f64 {
    (1.0 + joint as f64) * (0.7 * t).sin()
}

fn current(joint: usize, t: f64) -> f64 {
    3.0 * (1.1 * t + joint as f64).cos()
}

/// A quantity that is written as a column for each joint.
type Family<'a> = (&'a str, &'a dyn Fn(usize, f64) -> f64);

const Q: &[Family<'_>] = &[("q", &position)];
const I: &[Family<'_>] = &[("current", &current)];

fn write(folder: &TempDir, name: &str, stamps: &[f64], families: &[Family<'_>]) -> PathBuf {
    write_shown(folder, name, stamps, |t| format!("{t:.6}"), families)
}

fn write_shown(
    folder: &TempDir,
    name: &str,
    stamps: &[f64],
    shown: impl Fn(f64) -> String,
    families: &[Family<'_>],
) -> PathBuf {
    let columns = families.iter().flat_map(|(f, _)| (0..JOINTS).map(move |j| format!(",{f}_{j}")));
    let mut text = format!("time{}\n", columns.collect::<String>());
    for t in stamps {
        text.push_str(&shown(*t));
        for (_, value) in families {
            (0..JOINTS).for_each(|joint| text.push_str(&format!(",{:?}", value(joint, *t))));
        }
        text.push('\n');
    }
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn stamps(from_s: f64, rate_hz: f64, rows: usize) -> Vec<f64> {
    (0..rows).map(|k| from_s + k as f64 / rate_hz).collect()
}

fn with(other: &Path, change: impl FnOnce(&mut JoinedFile)) -> ReadOptions {
    let mut joined = JoinedFile {
        file: other.to_owned(),
        unit: None,
        columns: Default::default(),
        recorded: RecordedAs::default(),
        clock_offset_s: 0.0,
    };
    change(&mut joined);
    let recorded = RecordedAs { joined: vec![joined], ..RecordedAs::default() };
    ReadOptions { joints: Some(JOINTS.into()), recorded, ..ReadOptions::default() }
}

fn joined_of(one: &Path, other: &Path) -> Result<Recording, RecordingError> {
    read_recording(one, &with(other, |_| ()))
}

/// All series of a recording: stamps, positions, measurements.
fn numbers(recording: &Recording) -> Vec<&Vec<f64>> {
    let measured = recording.measurement.iter().flatten();
    std::iter::once(&recording.time_s).chain(&recording.position_rad).chain(measured).collect()
}

fn remarks(recording: &Recording) -> String {
    recording.report.notes().join("\n")
}

#[test]
fn a_recording_split_in_two_is_the_same_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let mut times = stamps(12.0, 500.0, 400);
    times[100] = times[99];
    let whole = write(&folder, "a.csv", &times, &[("q", &position), ("current", &current)]);
    let q = write(&folder, "q.csv", &times, Q);
    let i = write(&folder, "i.csv", &times, I);
    let one = read_recording(&whole, &ReadOptions { joints: Some(JOINTS.into()), ..ReadOptions::default() })
        .unwrap();
    let two = joined_of(&q, &i).unwrap();
    assert!(numbers(&one) == numbers(&two), "{}", remarks(&two));
    assert_eq!(one.unit, two.unit);
    assert!(remarks(&two).contains("joined by equal stamps: 399 rows"), "{}", remarks(&two));
}

#[test]
fn only_the_common_time_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let q = write(&folder, "q.csv", &stamps(0.0, 100.0, 300), Q);
    let i = write(&folder, "i.csv", &stamps(1.0, 100.0, 300), I);
    let joined = joined_of(&q, &i).unwrap();
    assert_eq!((joined.samples(), joined.time_s[0]), (200, 1.0));
    let expected = current(1, joined.time_s[7]);
    assert!((joined.measurement.unwrap()[1][7] - expected).abs() < 1e-6);
}

#[test]
fn of_a_clock_with_every_fifth_stamp_nothing_is_interpolated() {
    let folder = tempfile::tempdir().unwrap();
    let q = write(&folder, "q.csv", &stamps(0.0, 500.0, 1000), Q);
    let i = write(&folder, "i.csv", &stamps(0.0, 100.0, 200), I);
    let joined = joined_of(&q, &i).unwrap();
    let alone =
        read_recording(&q, &ReadOptions { needs_measurement: false, ..ReadOptions::default() }).unwrap();
    assert_eq!(joined.samples(), 200);
    for (row, q) in joined.position_rad[0].iter().enumerate() {
        assert_eq!(*q, alone.position_rad[0][5 * row]);
    }
}

#[test]
fn other_stamps_are_those_of_the_slower_file_and_the_faster_is_interpolated() {
    let folder = tempfile::tempdir().unwrap();
    let slow = write(&folder, "q.csv", &stamps(0.0013, 125.0, 300), Q);
    let fast = write(&folder, "i.csv", &stamps(0.0, 1000.0, 2500), I);
    let joined = joined_of(&slow, &fast).unwrap();
    assert_eq!(joined.samples(), 300);
    let measured = joined.measurement.as_ref().unwrap();
    for joint in 0..JOINTS {
        for (t, value) in joined.time_s.iter().zip(&measured[joint]) {
            // |error| ≤ h²/8 · max|x″| = 1e-6/8 · 3 · 1.21.
            assert!((value - current(joint, *t)).abs() < 5e-7, "{t}");
        }
    }
    let text = remarks(&joined);
    assert!(text.contains("those of q.csv, the slower one, are kept"), "{text}");
    assert!(text.contains("what is in i.csv is interpolated linearly"), "{text}");
    // The slower file may as well be the joined one.
    let fast = write(&folder, "fast.csv", &stamps(0.0, 1000.0, 2500), Q);
    let slow = write(&folder, "slow.csv", &stamps(0.0013, 125.0, 300), I);
    let joined = joined_of(&fast, &slow).unwrap();
    assert_eq!(joined.samples(), 300);
    assert!((joined.position_rad[1][40] - position(1, joined.time_s[40])).abs() < 5e-7);
}

#[test]
fn no_row_is_made_up_in_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let mut broken = stamps(0.0, 1000.0, 2500);
    broken.drain(500..700);
    let q = write(&folder, "q.csv", &stamps(0.0013, 125.0, 300), Q);
    let i = write(&folder, "i.csv", &broken, I);
    let joined = joined_of(&q, &i).unwrap();
    assert!(joined.time_s.iter().all(|t| *t <= 0.4995 || *t >= 0.6995), "a row lies in the gap");
    assert_eq!(joined.samples(), 275);
    assert!(remarks(&joined).contains("25 rows are left out"), "{}", remarks(&joined));
}

#[test]
fn a_clock_of_its_own_is_told_and_put_right_by_its_offset() {
    let folder = tempfile::tempdir().unwrap();
    let times = stamps(5.0, 100.0, 300);
    let elsewhere: Vec<f64> = times.iter().map(|t| t + 1000.25).collect();
    let shifted = |joint, t: f64| current(joint, t - 1000.25);
    let q = write(&folder, "q.csv", &times, Q);
    let i = write(&folder, "i.csv", &elsewhere, &[("current", &shifted)]);
    let error = joined_of(&q, &i).unwrap_err();
    assert!(matches!(error, RecordingError::Joined { .. }));
    let text = error.to_string();
    assert!(text.contains("do not overlap") && text.contains("clock_offset_s = -1000.25"), "{text}");
    let joined = read_recording(&q, &with(&i, |j| j.clock_offset_s = -1000.25)).unwrap();
    assert_eq!(joined.samples(), 300);
    assert!((joined.measurement.unwrap()[0][50] - current(0, times[50])).abs() < 1e-9);
}

#[test]
fn stamps_in_another_unit_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let times = stamps(0.0, 100.0, 300);
    let ms = |t: f64| format!("{:.3}", 1e3 * t);
    let q = write(&folder, "q.csv", &times, Q);
    let i = write_shown(&folder, "i.csv", &times, ms, I);
    let text = joined_of(&q, &i).unwrap_err().to_string();
    assert!(text.contains("i.csv lasts 1e3 times as long") && text.contains("time = \"ms\""), "{text}");
    let joined = read_recording(&q, &with(&i, |j| j.recorded.time = Some(TimeUnit::Millisecond))).unwrap();
    assert_eq!(joined.samples(), 300);
}

#[test]
fn a_quantity_in_two_files_has_to_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let times = stamps(0.0, 100.0, 300);
    let other = |joint, t| 2.0 * current(joint, t);
    let a = write(&folder, "a.csv", &times, &[("q", &position), ("current", &current)]);
    let b = write(&folder, "b.csv", &times, &[("q", &position), ("current", &other)]);
    let text = joined_of(&a, &b).unwrap_err().to_string();
    assert!(
        text.contains("both have joint positions") && text.contains("take = [\"measurement\"]"),
        "{text}"
    );
    let measurement = |j: &mut JoinedFile| j.recorded.take = Some(vec![Quantity::Measurement]);
    let text = read_recording(&a, &with(&b, measurement)).unwrap_err().to_string();
    assert!(text.contains("both have a measurement"), "{text}");
    let mut options = with(&b, measurement);
    options.recorded.take = Some(vec![Quantity::Position]);
    let joined = read_recording(&a, &options).unwrap();
    assert_eq!(joined.measurement.unwrap()[0][10], other(0, times[10]));
}

#[test]
fn a_file_without_anything_to_join_and_recordings_longer_than_memory_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let times = stamps(0.0, 100.0, 300);
    let q = write(&folder, "q.csv", &times, Q);
    let n = write(&folder, "n.csv", &times, &[("lamp", &current)]);
    let error = joined_of(&q, &n).unwrap_err();
    assert!(matches!(error, RecordingError::MissingColumn { .. }), "{error}");
    let i = write(&folder, "i.csv", &times, I);
    let error = LongRecording::read(&q, &with(&i, |_| ())).unwrap_err().to_string();
    assert!(error.contains("--stream-above"), "{error}");
    let missing = joined_of(&q, &folder.path().join("none.csv")).unwrap_err();
    assert!(missing.to_string().contains("none.csv: no such file"), "{missing}");
}

#[test]
#[cfg(feature = "parquet")]
fn formats_mix_and_clocks_since_1970_agree() {
    // The MCAP file counts from its first whole second, the text does not.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats");
    let read = |file: &str| {
        let options =
            ReadOptions { unit: Some(aurt_traits::MeasurementUnit::Ampere), ..ReadOptions::default() };
        read_recording(&folder.join(file), &options).unwrap()
    };
    let (moments, text) = (read("moments.parquet"), read("recording.csv"));
    assert!(moments.report.origin_s > 1e9, "the stamps of moments.parquet are since 1970");
    let scratch = tempfile::tempdir().unwrap();
    let first = text.time_s[0];
    let mut lines = String::from("time");
    (0..6).for_each(|joint| lines.push_str(&format!(",current_{joint}")));
    for (row, t) in text.time_s.iter().enumerate() {
        let since_1970 = moments.report.origin_s + moments.time_s[0] + (t - first);
        lines.push_str(&format!("\n{since_1970:.6}"));
        text.measurement.as_ref().unwrap().iter().for_each(|i| lines.push_str(&format!(",{:?}", i[row])));
    }
    let currents = scratch.path().join("currents.csv");
    std::fs::write(&currents, lines + "\n").unwrap();
    let mut options = with(&currents, |_| ());
    options.joints = None;
    options.recorded.take = Some(vec![Quantity::Position]);
    let joined = read_recording(&folder.join("moments.parquet"), &options).unwrap();
    assert!(joined.position_rad == moments.position_rad && joined.measurement == text.measurement);
}

/// What is said of angles, gears and currents concerns the columns that are such, in whichever file they lie.
#[test]
fn units_are_those_of_the_quantity() {
    let folder = tempfile::tempdir().unwrap();
    let times = stamps(0.0, 100.0, 300);
    let whole = write(&folder, "a.csv", &times, &[("q", &position), ("current", &current)]);
    let q = write(&folder, "q.csv", &times, Q);
    let i = write(&folder, "i.csv", &times, I);
    let recorded = RecordedAs {
        angle: Some(AngleUnit::Degree),
        gear_ratio: Some(vec![100.0, -80.0]),
        current: Some(CurrentUnit::Milliampere),
        ..RecordedAs::default()
    };
    let one =
        ReadOptions { joints: Some(JOINTS.into()), recorded: recorded.clone(), ..ReadOptions::default() };
    let one = read_recording(&whole, &one).unwrap();
    let mut two = with(&i, |joined| joined.recorded = recorded.of_quantities());
    two.recorded = RecordedAs { joined: two.recorded.joined, ..recorded };
    assert!(numbers(&one) == numbers(&read_recording(&q, &two).unwrap()));
    let measured = &one.measurement.as_ref().unwrap()[1][50];
    assert!((measured - 1e-3 * current(1, 0.5)).abs() < 1e-9, "{measured}");
    assert!((one.position_rad[1][50] + position(1, 0.5).to_radians() / 80.0).abs() < 1e-9);
}
