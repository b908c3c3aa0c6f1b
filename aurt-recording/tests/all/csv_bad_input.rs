//! What is wrong with a file is said with file, line, column and remedy; nothing panics.

use aurt_recording::{
    AngleUnit, ColumnRef, ColumnSelection, ColumnsRef, DroppedRows, ReadOptions, RecordedAs, Recording,
    RecordingError, RobotJoints, read_recording,
};
use proptest::prelude::*;

fn read_bytes(bytes: impl AsRef<[u8]>, options: &ReadOptions) -> Result<Recording, RecordingError> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    let result = read_recording(file.path(), options);
    if let Err(error) = &result {
        let needs_no_file = matches!(error, RecordingError::InvalidOption { .. });
        let named = error.to_string().contains(&file.path().display().to_string());
        assert!(named || needs_no_file, "no file named in: {error}");
    }
    result
}

fn read(bytes: impl AsRef<[u8]>) -> Result<Recording, RecordingError> {
    read_bytes(bytes, &ReadOptions::default())
}

fn error(text: &str) -> RecordingError {
    read(text).unwrap_err()
}

/// A smooth recording of two joints (t, q_0, q_1, tau_0, tau_1; row k in line k + 2); `change` may alter a row.
fn made(rows: usize, change: impl Fn(usize, &mut Vec<String>)) -> String {
    let mut text = String::from("t,q_0,q_1,tau_0,tau_1\n");
    for k in 0..rows {
        let t = k as f64 * 0.01;
        let values = [t, t.sin(), t.cos(), 5.0 * t.sin(), 3.0];
        let mut cells: Vec<String> = values.iter().map(|v| format!("{v:.4}")).collect();
        change(k, &mut cells);
        text += &(cells.join(",") + "\n");
    }
    text
}

/// The same with `cell` in a column of the rows that `chosen` picks.
fn altered(rows: usize, column: usize, cell: &str, chosen: impl Fn(usize) -> bool) -> String {
    made(rows, |k, cells| {
        if chosen(k) {
            cells[column] = cell.into();
        }
    })
}

#[test]
fn files_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let missing = read_recording(&folder.path().join("none.csv"), &ReadOptions::default()).unwrap_err();
    assert!(matches!(&missing, RecordingError::Unreadable { .. }), "{missing}");
    assert!(missing.to_string().contains("none.csv"));
    let directory = read_recording(folder.path(), &ReadOptions::default()).unwrap_err();
    assert!(matches!(directory, RecordingError::Directory { .. }), "{directory}");
    assert!(directory.to_string().contains("name a file in it"), "{directory}");
    // The folder of a bag is named by those who recorded it.
    for (name, said) in
        [("bag_0.mcap", "name the recording in it: "), ("bag_1.mcap", "one of the 2 recordings")]
    {
        std::fs::write(folder.path().join("metadata.yaml"), "").unwrap();
        std::fs::write(folder.path().join(name), "").unwrap();
        let error = read_recording(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("bag_0.mcap"), "{error}");
    }
}

#[test]
fn files_without_rows() {
    for (text, part) in [
        ("", "empty"),
        ("\n\n# nothing\n", "comments"),
        ("t,q_0,tau_0\n", "no row follows"),
        ("t,q_0,tau_0", "no row follows"),
        ("t,q_0,tau_0\r0,1,2\r", "carriage"),
        ("GIF8\0\u{1}", "binary"),
    ] {
        let error = error(text);
        assert!(matches!(error, RecordingError::NoRows { .. }), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    let wide = read(b"\xff\xfet\0,\0").unwrap_err();
    assert!(wide.to_string().contains("UTF-16"), "{wide}");
}

#[test]
fn missing_columns_name_what_there_is_and_what_was_meant() {
    let message = error("t,q_0,q_1,foo\n0,1,2,3\n").to_string();
    assert!(
        message.contains("line 1") && message.contains("foo") && message.contains("measurement"),
        "{message}"
    );
    let message = error("t,tau_0\n0,1\n").to_string();
    assert!(message.contains("joint positions") && message.contains("`actual_q`"), "{message}");
    let message = error("q_0,tau_0\n0,1\n").to_string();
    assert!(message.contains("time stamps") && message.contains("`timestamp`"), "{message}");
    let message = error("t,target_q_0,tau_0\n0,1,2\n").to_string();
    assert!(message.contains("`target_q`") && message.contains("commanded"), "{message}");

    let text = "t,shoulder,tau_0\n0,1,2\n";
    let select = |column: ColumnRef| ReadOptions {
        columns: ColumnSelection {
            position: Some(ColumnsRef::List(vec![column])),
            ..ColumnSelection::default()
        },
        ..ReadOptions::default()
    };
    let named = select(ColumnRef::Name("sholder".into()));
    let message = read_bytes(text, &named).unwrap_err().to_string();
    assert!(message.contains("did you mean `shoulder`"), "{message}");
    let beyond = read_bytes(text, &select(ColumnRef::Index(7))).unwrap_err();
    assert!(matches!(beyond, RecordingError::ColumnIndex { index: 7, columns: 3, .. }), "{beyond}");
    let twice = read_bytes(text, &select(ColumnRef::Index(2))).unwrap_err();
    assert!(twice.to_string().contains("two quantities"), "{twice}");
}

#[test]
fn numbering_and_counts() {
    for (header, part) in [
        ("t,q_0,q_2,tau_0,tau_1", "number 1 is missing"),
        ("t,q_2,q_3,tau_0,tau_1", "numbered from 2"),
        ("t,q_0,q_0,tau_0,tau_1", "two columns `q`"),
        ("t,q_0,q_1,tau_0,t", "two columns named `t`"),
        ("t,q_0,q_1,tau_0,x", "1 columns for the measurement"),
        ("t,q_0 [deg],q_1 [deg],tau_0,tau_1", "`deg`"),
        ("t [ms],q_0,q_1,tau_0,tau_1", "`ms`"),
        ("t,q_0,q_1,tau_0 [mNm],tau_1 [mNm]", "`mnm`"),
    ] {
        let error = error(&format!("{header}\n0,1,2,3,4\n"));
        assert!(matches!(error, RecordingError::Columns { line: 1, .. }), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    let options = ReadOptions { joints: Some(3.into()), ..ReadOptions::default() };
    let error = read_bytes(b"t,q_0,q_1,tau_0,tau_1\n0,1,2,3,4\n", &options).unwrap_err();
    assert!(error.to_string().contains("3 joints"), "{error}");
}

#[test]
fn cells_that_are_no_numbers() {
    for (cell, part) in [
        ("nan", "drop = \"nan\""),
        ("-inf", "drop = \"nan\""),
        ("", "drop = \"nan\""),
        ("abc", "correct"),
        ("1.2.3", "garbled"),
    ] {
        let error = error(&altered(50, 1, cell, |k| k == 30));
        assert!(
            matches!(&error, RecordingError::Cell { line: 32, column: 2, name: Some(name), .. } if name == "q_0"),
            "{cell}: {error}"
        );
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn ragged_and_broken_off_lines() {
    let short = error(&made(50, |k, cells| cells.truncate(if k == 10 { 2 } else { 5 })));
    assert!(matches!(short, RecordingError::Ragged { line: 12, expected: 5, found: 2, .. }), "{short}");
    let long = error(&made(50, |k, cells| {
        if k == 10 {
            cells.extend(["1".into(), "2".into()]);
        }
    }));
    assert!(matches!(long, RecordingError::Ragged { line: 12, expected: 5, found: 7, .. }), "{long}");

    let whole = made(50, |_, _| {});
    let whole = whole.trim_end();
    assert!(read(whole).is_ok());
    // Wherever in its last line the file breaks off, it is noticed: in the last number by its missing decimals.
    let last_line = whole.rfind('\n').unwrap() + 1;
    for end in last_line + 1..whole.len() {
        let cut = error(&whole[..end]);
        let noticed = matches!(cut, RecordingError::TruncatedLastLine { line: 51, .. });
        assert!(noticed, "{}: {cut}", &whole[last_line..end]);
    }
}

#[test]
fn corrupt_rows_are_dropped_up_to_a_share_and_reported() {
    let corrupt = |rows: &[usize]| altered(500, 1, "1e150", |k| rows.contains(&k));
    let text = corrupt(&[100, 200, 201]);
    let recording = read(&text).unwrap();
    assert_eq!(recording.samples(), 497);
    let report = &recording.report;
    assert_eq!((report.rows, report.dropped_rows), (500, 3));
    assert_eq!(report.dropped.iter().map(|d| d.line).collect::<Vec<_>>(), [102, 202, 203]);
    assert!(report.dropped[0].reason.contains("q_0") && report.dropped[0].reason.contains("1e150"));
    let notes = report.notes();
    let named = |n: &String| n.contains("dropped 3 corrupt rows (0.60 %)") && n.contains("line 102");
    assert!(notes.iter().any(named), "{notes:?}");

    let many = corrupt(&[1, 2, 3, 4, 5, 6]);
    let refused = error(&many);
    let expected = matches!(
        refused,
        RecordingError::CorruptRows { line: 3, column: 2, rows: 6, total: 500, allowed: 5, .. }
    );
    assert!(expected, "{refused}");
    let none = ReadOptions { max_corrupt_share: 0.0, ..ReadOptions::default() };
    assert!(read_bytes(&text, &none).is_err());
    let more = ReadOptions { max_corrupt_share: 0.02, ..ReadOptions::default() };
    assert_eq!(read_bytes(&many, &more).unwrap().samples(), 494);
    for share in [-0.1, 1.1, f64::NAN] {
        let options = ReadOptions { max_corrupt_share: share, ..ReadOptions::default() };
        let error = read_bytes(&text, &options).unwrap_err();
        assert!(matches!(error, RecordingError::InvalidOption { .. }), "{error}");
    }
}

#[test]
fn rows_that_their_neighbours_contradict_are_dropped() {
    // Moderate values that no limit catches: a first row from before the start, one position off, one torque off.
    let text = made(500, |k, cells| match k {
        0 => cells[1] = "9.0000".into(),
        100 => cells[1] = "12.8415".into(),
        300 => cells[4] = "900000".into(),
        _ => {}
    });
    let recording = read(&text).unwrap();
    let lines: Vec<usize> = recording.report.dropped.iter().map(|d| d.line).collect();
    assert_eq!(lines, [2, 102, 302], "{:?}", recording.report.dropped);
}

#[test]
fn whole_turns_are_unwrapped_and_other_jumps_reported() {
    let wrapped = made(500, |k, cells| {
        let q = (k as f64 * 0.01).sin();
        let turn = if (100..250).contains(&k) { std::f64::consts::TAU } else { 0.0 };
        cells[1] = format!("{:.6}", q - turn);
    });
    let recording = read(&wrapped).unwrap();
    for (k, q) in recording.position_rad[0].iter().enumerate() {
        assert!((q - (k as f64 * 0.01).sin()).abs() < 1e-5);
    }
    let remark = &recording.report.remarks[0];
    assert!(remark.contains("2 times") && remark.contains("line 102"), "{remark}");

    let jump = altered(500, 1, "9.0000", |k| k >= 250);
    let recording = read(&jump).unwrap();
    assert!(recording.report.irregularities[0].contains("line 252"), "{:?}", recording.report.irregularities);
    assert_eq!(recording.report.dropped_rows, 0);
}

#[test]
fn time_that_goes_back() {
    for (stamp, line, part) in [("1.5000", 202, "goes back"), ("3.5000", 202, "leaps ahead")] {
        let text = altered(500, 0, stamp, |k| k == 200);
        let recording = read(&text).unwrap();
        assert_eq!(recording.samples(), 499);
        let dropped = &recording.report.dropped[0];
        assert_eq!(dropped.line, line);
        assert!(dropped.reason.contains(part), "{dropped:?}");
        assert!(recording.time_s.windows(2).all(|w| w[0] <= w[1]));
    }
}

#[test]
fn a_clock_that_is_set_back_splits_the_recording() {
    let once = made(900, |k, cells| {
        let back = [0.0, 0.3, 4.0, 1e3][k / 200 % 4];
        cells[0] = format!("{:.4}", cells[0].parse::<f64>().unwrap() - back);
    });
    let recording = read(&once).unwrap();
    let report = &recording.report;
    assert_eq!((recording.samples(), report.dropped_rows, report.set_back_s.len()), (900, 0, 3));
    assert!(report.remarks[0].starts_with("the clock was set back from 1.99"), "{:?}", report.remarks);
    let options =
        aurt_recording::PreprocessOptions { max_gap_s: Some(100.0), f_dyn_hz: 5.0, ..Default::default() };
    let gaps = aurt_recording::preprocess(&recording, &options).unwrap().report.clock.gaps_s;
    assert_eq!(gaps.len(), 4, "three steps back and one ahead: {gaps:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&bytes);
    }

    #[test]
    fn arbitrary_tables_never_panic(
        text in "([tq0-9_,; \t\r\n\"'#.eE+\\-naif\\[\\]()]|q_0|tau_0|timestamp|1e150|\u{feff}|°){0,120}",
        first in 0_usize..4,
        last in 0_usize..6,
    ) {
        let selected = ReadOptions {
            columns: ColumnSelection {
                time: Some(ColumnRef::Index(first)),
                position: Some(ColumnsRef::Range { first: last, last: last + first }),
                ..ColumnSelection::default()
            },
            needs_measurement: false,
            max_corrupt_share: 1.0,
            ..ReadOptions::default()
        };
        let _ = read_bytes(&text, &selected);
        let _ = read(format!("t,q_0,tau_0\n{text}"));
    }

    #[test]
    fn what_is_written_is_read(
        rows in prop::collection::vec((-1e3_f64..1e3, -1e5_f64..1e5), 2..40),
        delimiter in prop::sample::select(vec![",", ";", "\t", " ", ", "]),
        carriage_return in any::<bool>(),
    ) {
        let end = if carriage_return { "\r\n" } else { "\n" };
        let mut text = ["t", "q_0", "tau_0"].join(delimiter) + end;
        for (k, (q, tau)) in rows.iter().enumerate() {
            // Seconds apart, so that no step is too fast for a joint.
            text += &format!("{}{delimiter}{q}{delimiter}{tau:e}{end}", 100 * k);
        }
        let recording = read(&text).unwrap();
        let expected: (Vec<f64>, Vec<f64>) = rows.into_iter().unzip();
        prop_assert_eq!(&recording.position_rad[0], &expected.0);
        prop_assert_eq!(&recording.measurement.as_ref().unwrap()[0], &expected.1);
    }
}

/// All rows that lack a number are counted, and left out where that is asked for, however many there are.
#[test]
fn rows_that_lack_a_number_are_counted_and_left_out_on_request() {
    let text = made(300, |k, cells| match k % 10 {
        3 => cells[1] = String::new(),
        7 => cells[3] = "NaN".into(),
        _ => {}
    });
    let told = error(&text).to_string();
    for words in ["line 5, column 2 (q_0)", "59 more rows", "drop = \"nan\""] {
        assert!(told.contains(words), "{told}");
    }
    let recorded = RecordedAs { drop: Some(DroppedRows::NotANumber), ..RecordedAs::default() };
    let options = ReadOptions { recorded, ..ReadOptions::default() };
    let recording = read_bytes(&text, &options).unwrap();
    let report = &recording.report;
    assert_eq!((recording.samples(), report.rows, report.rows_without_numbers), (240, 300, 60));
    assert_eq!((report.dropped_rows, report.absent.len(), report.absent[0]), (0, 60, 5));
    assert!(report.notes().join("; ").contains("left out 60 rows (20.00 %)"), "{:?}", report.notes());
    // A garbled cell is an error all the same.
    let garbled = altered(300, 1, "1.2.3", |k| k == 9);
    assert!(read_bytes(&garbled, &options).is_err());
}

/// Rows that a logger wrote twice, at once or later, are one row; neighbours with the stamp alone in common are two.
#[test]
fn rows_written_twice_are_one() {
    let once = made(300, |_, _| {});
    let lines: Vec<&str> = once.lines().collect();
    let twice: String =
        lines.iter().enumerate().flat_map(|(k, l)| vec![format!("{l}\n"); 1 + usize::from(k > 0)]).collect();
    let again = format!("{once}{}\n", lines[1..].join("\n"));
    let one = read(&once).unwrap();
    for text in [twice, again] {
        let read = read(&text).unwrap();
        assert_eq!((&read.time_s, &read.position_rad), (&one.time_s, &one.position_rad));
        assert_eq!(read.measurement, one.measurement);
        assert_eq!((read.report.repeated_rows, read.report.dropped_rows, read.report.rows), (300, 0, 600));
    }
    let two = made(300, |k, cells| {
        if k % 2 == 1 {
            cells[0] = format!("{:.4}", (k - 1) as f64 * 0.01)
        }
    });
    assert_eq!(read(&two).unwrap().samples(), 300);
}

/// A joint that slides is in metres: no unit of angles scales it, and 2 π m are no turn.
#[test]
fn joints_that_slide_have_no_angles() {
    let text = made(300, |k, cells| {
        if k >= 100 {
            cells[1] = format!("{:.4}", (k as f64 * 0.01).sin() + std::f64::consts::TAU);
        }
    });
    let read = |sliding: Vec<bool>| {
        let recorded = RecordedAs { angle: Some(AngleUnit::Degree), ..RecordedAs::default() };
        let joints = Some(RobotJoints { sliding, ..2.into() });
        read_bytes(&text, &ReadOptions { joints, recorded, ..ReadOptions::default() }).unwrap()
    };
    let (turning, sliding) = (read(vec![false; 2]), read(vec![true, false]));
    let at = |recording: &Recording, k: usize| recording.position_rad[0][k];
    assert!((at(&turning, 50) - at(&sliding, 50).to_radians()).abs() < 1e-12);
    assert!((at(&sliding, 50) - 0.5_f64.sin()).abs() < 1e-4);
    assert!(
        (at(&sliding, 250) - at(&sliding, 50) - 2.5_f64.sin() + 0.5_f64.sin() - std::f64::consts::TAU).abs()
            < 1e-3
    );
    assert_eq!(turning.position_rad[1], sliding.position_rad[1]);
}
