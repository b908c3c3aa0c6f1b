//! One recording in every format: the numbers are the same, bit for bit.
//!
//! The files in `formats/` were written by NumPy, SciPy, mcap-ros2-support and PyArrow (`formats/make_formats.py`) from the first rows
//! of a simulated UR10e. Where Python has these packages they are written anew and read again.

use std::path::{Path, PathBuf};
use std::process::Command;

use aurt_recording::{
    AngleUnit, ColumnRef, ColumnSelection, ColumnsRef, CurrentUnit, LongRecording, ReadOptions, RecordedAs,
    Recording, RecordingError, TimeUnit, read_recording,
};
use aurt_traits::MeasurementUnit::Ampere;

const JOINTS: [&str; 6] = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
const FILES: [&str; 16] = [
    "stored.npz",
    "compressed.npz",
    "transposed.npz",
    "single.npy",
    "version_6.mat",
    "version_7.mat",
    "zstd.mcap",
    "lz4.mcap",
    "plain.mcap",
    "packed_file_bag/packed_file_bag.db3.zstd",
    "packed_messages_bag/metadata.yaml",
    "split_bag",
    "snappy.parquet",
    "zstd.parquet",
    "split.parquet",
    "moments.parquet",
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats")
}

fn options(name: &str) -> ReadOptions {
    let mut options = ReadOptions { joints: Some(6.into()), unit: Some(Ampere), ..ReadOptions::default() };
    if name.ends_with("npy") {
        let range = |first, last| Some(ColumnsRef::Range { first, last });
        let time = Some(ColumnRef::Index(0));
        options.columns =
            ColumnSelection { time, position: range(1, 6), velocity: None, measurement: range(7, 12) };
    }
    if name.ends_with("mcap") || name.contains("bag") {
        options.recorded.joint_names = Some(JOINTS.map(str::to_owned).to_vec());
    }
    options
}

fn bits(recording: &Recording) -> Vec<Vec<u64>> {
    let measured = recording.measurement.iter().flatten();
    let series = std::iter::once(&recording.time_s).chain(&recording.position_rad).chain(measured);
    series.map(|s| s.iter().map(|v| v.to_bits()).collect()).collect()
}

fn assert_same(folder: &Path, source: &Path) {
    let text = read_recording(source, &options("csv")).unwrap();
    assert_eq!((text.joints(), text.samples()), (6, 120));
    for name in FILES {
        let path = folder.join(name);
        let read = read_recording(&path, &options(name)).unwrap();
        assert_eq!(bits(&read), bits(&text), "{name}");
        assert_eq!(read.unit, Ampere, "{name}");
        let long = LongRecording::read(&path, &options(name)).unwrap();
        assert_eq!(long.samples(), 120, "{name}");
    }
}

#[test]
fn every_format_gives_the_same_numbers() {
    assert_same(&folder(), &folder().join("recording.csv"));
}

#[test]
fn files_that_python_writes_now_give_the_same_numbers() {
    let python = std::env::var("AURT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import numpy, scipy, mcap_ros2, pyarrow"]).output();
    if !has.is_ok_and(|output| output.status.success()) {
        println!("skipped: {python} lacks numpy, scipy, mcap-ros2-support or pyarrow");
        return;
    }
    let made = tempfile::tempdir().unwrap();
    let source = folder().join("recording.csv");
    let status =
        Command::new(python).arg(folder().join("make_formats.py")).arg(&source).arg(made.path()).status();
    assert!(status.unwrap().success());
    assert_same(made.path(), &source);
}

#[test]
fn content_decides_before_the_name() {
    let made = tempfile::tempdir().unwrap();
    for (name, format) in [
        ("stored.npz", "NumPy"),
        ("version_7.mat", "MATLAB"),
        ("zstd.mcap", "MCAP"),
        ("zstd.parquet", "Parquet"),
    ] {
        let path = made.path().join("log.csv");
        std::fs::copy(folder().join(name), &path).unwrap();
        let report = read_recording(&path, &options(name)).unwrap().report;
        assert!(report.format.starts_with(format), "{}", report.format);
    }
}

#[test]
fn a_bag_that_breaks_off_is_read_as_far_as_it_goes() {
    let read = |path: &Path, format: &str| read_recording(path, &options(format)).unwrap();
    let table = read(&folder().join("recording.csv"), "csv");
    let database = "split_bag/split_bag_1.db3";
    let split = read(&folder().join(database), "bag");
    let made = tempfile::tempdir().unwrap();
    for (name, format, whole, share, rows) in [
        ("zstd.mcap", "zstd.mcap", &table, 0.5, 10..120),
        ("lz4.mcap", "lz4.mcap", &table, 0.5, 10..120),
        ("plain.mcap", "plain.mcap", &table, 0.5, 10..120),
        (database, "bag", &split, 0.75, 20..80),
    ] {
        let bytes = std::fs::read(folder().join(name)).unwrap();
        let path = made.path().join(Path::new(name).file_name().unwrap());
        std::fs::write(&path, &bytes[..(bytes.len() as f64 * share) as usize]).unwrap();
        let cut = read(&path, format);
        assert!(rows.contains(&cut.samples()), "{name}: {}", cut.samples());
        assert_eq!(cut.time_s, whole.time_s[..cut.samples()], "{name}");
        assert_eq!(cut.position_rad[5], whole.position_rad[5][..cut.samples()], "{name}");
        let remarks = &cut.report.irregularities;
        assert!(remarks.iter().any(|r| r.contains("truncated")), "{remarks:?}");
    }
}

#[test]
fn a_database_whose_last_messages_are_in_a_journal_is_refused() {
    let made = tempfile::tempdir().unwrap();
    let path = made.path().join("log.db3");
    std::fs::copy(folder().join("split_bag/split_bag_1.db3"), &path).unwrap();
    assert_eq!(read_recording(&path, &options("bag")).unwrap().samples(), 80);
    std::fs::write(made.path().join("log.db3-wal"), [0; 32]).unwrap();
    let text = read_recording(&path, &options("bag")).unwrap_err().to_string();
    assert!(text.contains("log.db3-wal") && text.contains("PRAGMA journal_mode=DELETE"), "{text}");
}

/// Files cut anywhere and with any byte changed are read or refused, never a panic, never a number that is not finite.
#[test]
fn damaged_files_are_refused_or_read() {
    let made = tempfile::tempdir().unwrap();
    let mut refused = 0;
    let databases = ["split_bag/split_bag_1.db3", "packed_messages_bag/packed_messages_bag.db3"];
    for name in FILES.into_iter().chain(databases) {
        let source = folder().join(name);
        if source.is_dir() {
            continue;
        }
        let bytes = std::fs::read(source).unwrap();
        let path = made.path().join(Path::new(name).file_name().unwrap());
        let shown = path.file_name().unwrap().to_str().unwrap().to_owned();
        for k in 0..60 {
            let at = k * bytes.len() / 60;
            let mut changed = bytes.clone();
            changed[at] ^= 0xff;
            for damaged in [&bytes[..at], &changed] {
                std::fs::write(&path, damaged).unwrap();
                match read_recording(&path, &options(name)) {
                    Ok(recording) => recording.validate().unwrap(),
                    Err(error) => {
                        refused += 1;
                        assert!(error.to_string().contains(&shown) || shown == "metadata.yaml", "{error}");
                    }
                }
            }
        }
    }
    assert!(refused > 300, "{refused}");
}

fn error(name: &str, change: impl FnOnce(&mut ReadOptions)) -> String {
    let mut options = options(name);
    change(&mut options);
    read_recording(&folder().join(name), &options).unwrap_err().to_string()
}

#[test]
fn topics_and_joints_that_are_not_there_are_told_with_those_that_are() {
    let text = error("zstd.mcap", |o| o.recorded.topic = Some("/arm/joint_state".into()));
    assert!(text.contains("did you mean `/arm/joint_states`"), "{text}");
    let text = error("zstd.mcap", |o| o.recorded.topic = Some("/remarks".into()));
    assert!(text.contains("std_msgs/msg/String"), "{text}");
    let text = error("zstd.mcap", |o| {
        o.recorded.joint_names = Some(["shoulder_pan", "elbo"].map(str::to_owned).to_vec());
    });
    assert!(text.contains("did you mean `elbow`"), "{text}");
    let text = error("zstd.mcap", |o| {
        o.recorded.joint_names = None;
        o.joints = Some(7.into());
    });
    assert!(text.contains("joint_names"), "{text}");
}

fn record(kind: u8, parts: &[&[u8]]) -> Vec<u8> {
    let body = parts.concat();
    [&[kind], (body.len() as u64).to_le_bytes().as_slice(), &body].concat()
}

/// A text as MCAP and CDR write its length.
fn text(value: &str) -> Vec<u8> {
    [(value.len() as u32).to_le_bytes().as_slice(), value.as_bytes()].concat()
}

/// A message of one joint with position `second` / 8 and these efforts.
fn joint_state(second: u32, name: &str, efforts: &[f64]) -> Vec<u8> {
    let words = |values: &[u32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let position = (f64::from(second) / 8.0).to_le_bytes();
    // Stamp, empty frame, one name; each list of numbers begins at a multiple of 8 after its length.
    let name = [name.as_bytes(), b"\0\0"].concat();
    let begin = [&[0, 1, 0, 0], words(&[second, 0, 1, 0, 1, 3]).as_slice(), &name, &words(&[1])].concat();
    let efforts = [words(&[0, efforts.len() as u32]), efforts.iter().flat_map(|v| v.to_le_bytes()).collect()];
    [begin.as_slice(), &position, &efforts.concat()].concat()
}

/// A bag with channels of these topics and types, numbered from 1, and these messages.
fn bag(channels: &[(&str, &str)], messages: &[(u16, Vec<u8>)]) -> tempfile::NamedTempFile {
    let number = |n: u16| n.to_le_bytes();
    let mut file = b"\x89MCAP0\r\n".to_vec();
    for (id, (topic, name)) in (1..).zip(channels) {
        file.extend(record(3, &[&number(id), &text(name), &text("ros2msg"), &text("")]));
        let parts = [&number(id), &number(id), &*text(topic), &text("cdr"), &0_u32.to_le_bytes()];
        file.extend(record(4, &parts));
    }
    for (id, data) in messages {
        file.extend(record(5, &[&number(*id), &[0; 20], data]));
    }
    file.extend(record(2, &[&[0; 20]]));
    let made = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(made.path(), file).unwrap();
    made
}

const JOINT_STATE: &str = "sensor_msgs/msg/JointState";

#[test]
fn messages_of_another_type_under_the_same_name_are_passed_over() {
    let messages =
        (1..=3).flat_map(|k| [(1, joint_state(k, "a1", &[2.0])), (2, b"\0\x01\0\0words".to_vec())]);
    let made =
        bag(&[("/joints", JOINT_STATE), ("/joints", "std_msgs/msg/String")], &messages.collect::<Vec<_>>());
    let read = read_recording(made.path(), &ReadOptions::default()).unwrap();
    assert_eq!((read.time_s, read.position_rad), (vec![1.0, 2.0, 3.0], vec![vec![0.125, 0.25, 0.375]]));
    let remarks = read.report.remarks.join("; ");
    assert!(remarks.contains("other types"), "{remarks}");
}

#[test]
fn messages_without_efforts_or_with_none_that_is_a_number_are_skipped() {
    let efforts: [&[f64]; 5] = [&[], &[2.0], &[f64::NAN], &[], &[3.0]];
    let messages: Vec<_> = (1..).zip(efforts).map(|(k, e)| (1, joint_state(k, "a1", e))).collect();
    let made = bag(&[("/joint_states", JOINT_STATE)], &messages);
    let read = read_recording(made.path(), &ReadOptions::default()).unwrap();
    assert_eq!((read.time_s, read.measurement), (vec![2.0, 5.0], Some(vec![vec![2.0, 3.0]])));
    let said = read.report.irregularities.join("; ");
    assert!(
        said.contains("2 messages were skipped: they lack") && said.contains("the effort of a1"),
        "{said}"
    );
    let made = bag(&[("/joint_states", JOINT_STATE)], &messages[2..3]);
    let said = read_recording(made.path(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(said.contains("the effort of a1 is NaN"), "{said}");
}

#[test]
fn joints_on_several_topics_or_messages_are_listed() {
    let messages = [(1, joint_state(1, "a1", &[2.0])), (2, joint_state(1, "b1", &[2.0]))];
    let wanted = |topic: &str| ReadOptions {
        recorded: RecordedAs {
            joint_names: Some(vec!["a1".into(), "b1".into()]),
            topic: Some(topic.into()),
            ..RecordedAs::default()
        },
        ..ReadOptions::default()
    };
    for topics in [["/upper", "/lower"], ["/upper", "/upper"]] {
        let made = bag(&topics.map(|topic| (topic, JOINT_STATE)), &messages);
        let said = read_recording(made.path(), &wanted("/upper")).unwrap_err().to_string();
        assert!(said.contains("no message has all joints: /upper has a1"), "{said}");
        assert!(said.contains("b1") && said.contains("source_list"), "{said}");
    }
}

#[test]
fn a_mat_file_of_version_7_3_and_arrays_that_do_not_fit_say_what_to_do() {
    let made = tempfile::tempdir().unwrap();
    let path = made.path().join("new.mat");
    std::fs::write(&path, [b"MATLAB 7.3 MAT-file".as_slice(), &[b' '; 500]].concat()).unwrap();
    let text = read_recording(&path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(text.contains("7.3") && text.contains("-v7"), "{text}");
    let text = error("single.npy", |o| o.columns = ColumnSelection::default());
    assert!(text.contains("say which is which") && !text.contains("line "), "{text}");
    let text = error("stored.npz", |o| {
        o.columns.position = Some(ColumnsRef::Prefix("joint".into()));
    });
    assert!(text.contains("joint positions"), "{text}");
}

/// Rows of files that are no text are told by their number, never by a line and a column of their bytes.
#[test]
fn rows_that_cannot_be_true_are_told_by_their_number() {
    let text = error("snappy.parquet", |o| o.position_limit_rad = 1e-6);
    assert!(text.contains("row 1: q_0 = ") && !text.contains("line "), "{text}");
}

fn text_of(header: &str, scale: [f64; 3]) -> Recording {
    let made = tempfile::NamedTempFile::new().unwrap();
    let rows: String = (0..50)
        .map(|k| {
            let t = f64::from(k) * 0.008;
            format!("{},{},{}\n", t * scale[0], t.sin() * scale[1], t.cos() * scale[2])
        })
        .collect();
    std::fs::write(made.path(), format!("{header}\n{rows}")).unwrap();
    let recorded = RecordedAs {
        angle: header.contains("deg").then_some(AngleUnit::Degree),
        time: header.contains("ms").then_some(TimeUnit::Millisecond),
        current: header.contains("mA").then_some(CurrentUnit::Milliampere),
        ..RecordedAs::default()
    };
    read_recording(made.path(), &ReadOptions { recorded, ..ReadOptions::default() }).unwrap()
}

#[test]
fn degrees_milliseconds_and_milliamperes_become_si() {
    let si = text_of("t,q_0,current_0", [1.0, 1.0, 1.0]);
    let other = text_of("t [ms],q_0 [deg],current_0 [mA]", [1e3, 180.0 / std::f64::consts::PI, 1e3]);
    let pairs = [
        (&si.time_s, &other.time_s),
        (&si.position_rad[0], &other.position_rad[0]),
        (&si.measurement.as_ref().unwrap()[0], &other.measurement.as_ref().unwrap()[0]),
    ];
    for (a, b) in pairs {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14), "{a:?} {b:?}");
    }
}

fn counted(recorded: RecordedAs) -> Result<Recording, RecordingError> {
    let made = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(made.path(), "q_0,q_1,tau_0,tau_1\n0,0,1,2\n10,-4,1,2\n20,-8,1,2\n").unwrap();
    read_recording(made.path(), &ReadOptions { recorded, ..ReadOptions::default() })
}

#[test]
fn encoder_counts_gears_and_a_rate_take_the_place_of_angles_and_a_clock() {
    let recorded = RecordedAs {
        rate_hz: Some(250.0),
        counts_per_revolution: Some(vec![1000.0]),
        gear_ratio: Some(vec![100.0, -50.0]),
        ..RecordedAs::default()
    };
    let read = counted(recorded.clone()).unwrap();
    assert_eq!(read.time_s, [0.0, 0.004, 0.008]);
    let turn = std::f64::consts::TAU;
    assert!((read.position_rad[0][2] - 20.0 / 1000.0 * turn / 100.0).abs() < 1e-15);
    assert!((read.position_rad[1][1] - 4.0 / 1000.0 * turn / 50.0).abs() < 1e-15);
    assert_eq!(read.measurement.unwrap()[1], [2.0; 3]);
    let three = counted(RecordedAs { gear_ratio: Some(vec![1.0; 3]), ..recorded.clone() }).unwrap_err();
    assert!(three.to_string().contains("gear_ratio"), "{three}");
    let zero = counted(RecordedAs { rate_hz: Some(0.0), ..recorded }).unwrap_err();
    assert!(zero.to_string().contains("rate_hz"), "{zero}");
    let clock = counted(RecordedAs::default()).unwrap_err();
    assert!(clock.to_string().contains("time stamps"), "{clock}");
}
