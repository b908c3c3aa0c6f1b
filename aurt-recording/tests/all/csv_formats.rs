//! Text files as people and programs write them.

use aurt_recording::{
    ColumnRef, ColumnSelection, ColumnsRef, ReadOptions, Recording, RecordingError, RobotJoints,
    read_recording,
};
use aurt_traits::MeasurementUnit::{Ampere, NewtonMetre};

fn read_with(text: &str, options: &ReadOptions) -> Result<Recording, RecordingError> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    read_recording(file.path(), options)
}

fn read(text: &str) -> Recording {
    read_with(text, &ReadOptions::default()).unwrap()
}

/// The recording that most texts below mean.
fn check(recording: &Recording) {
    assert_eq!(recording.time_s, [0.0, 0.5, 1.0]);
    assert_eq!(recording.position_rad, [[0.1, 0.2, 0.3], [-1.5, -1.25, -1.0]]);
    assert_eq!(*recording.measurement.as_ref().unwrap(), [[4.0, 5.0, 6.0], [-7.0, 8.0, -0.09]]);
    assert_eq!(recording.unit, NewtonMetre);
    assert_eq!(recording.report.rows, 3);
    assert_eq!((recording.joints(), recording.samples()), (2, 3));
}

const COMMAS: &str = "t,q_0,q_1,tau_0,tau_1\n0,0.1,-1.5,4,-7\n0.5,0.2,-1.25,5,8\n1.0,0.3,-1,6,-9e-2\n";

#[test]
fn delimiters_are_found_out() {
    check(&read(COMMAS));
    check(&read(&COMMAS.replace(',', ";")));
    check(&read(&COMMAS.replace(',', "\t")));
    check(&read(&COMMAS.replace(',', " ")));
    check(&read(&COMMAS.replace(',', "   ").replace('\n', "  \n ")));
    check(&read(&COMMAS.replace(',', ", ")));
    check(&read(&COMMAS.replace(',', " ,\t")));
    check(&read(&COMMAS.replace(',', " \t ").replace("\n", "\t\n")));
}

#[test]
fn decimal_commas_are_read_between_semicolons_and_tabs() {
    for delimiter in [";", "\t"] {
        check(&read(&COMMAS.replace(',', delimiter).replace('.', ",")));
    }
    let mixed = COMMAS.replace(',', ";").replace("0.3", "0,3");
    let error = read_with(&mixed, &ReadOptions::default()).unwrap_err();
    assert!(matches!(&error, RecordingError::Cell { line: 4, column: 2, .. }), "{error}");
    assert!(error.to_string().contains("decimal point"), "{error}");
}

#[test]
fn line_ends_marks_blanks_comments_and_quotes_are_put_up_with() {
    check(&read(&COMMAS.replace('\n', "\r\n")));
    check(&read(&format!("\u{feff}{COMMAS}")));
    check(&read(&COMMAS.replace('\n', "\n\n  \n# a comment, with commas\n")));
    check(&read(COMMAS.trim_end()));
    check(&read(&COMMAS.replace("t,q_0", "\"t\",\"q_0\"")));
    check(&read(&COMMAS.replace("0.5,0.2", "\"0.5\", \"0.2\"")));
    // A delimiter after the last cell.
    check(&read(&COMMAS.replace('\n', ",\n")));
    check(&read(&COMMAS.replace("-7\n", "-7,\n")));
}

#[test]
fn names_are_known_in_many_spellings() {
    let header = "t,q_0,q_1,tau_0,tau_1";
    for other in [
        "timestamp,actual_q_0,actual_q_1,torque_0,torque_1",
        "Time,Q_1,Q_2,Tau_1,Tau_2",
        "time_s,q0,q1,effort0,effort1",
        "t_s,position[0],position[1],joint_torque[0],joint_torque[1]",
        "t [s],pos_1 [rad],pos_2 [rad],tau_1 [Nm],tau_2 [Nm]",
        "t,q(1),q(2),tau(1),tau(2)",
        "t,joint_position_0,joint_position_1,torque_0,torque_1",
    ] {
        check(&read(&COMMAS.replace(header, other)));
    }
    let currents = read(&COMMAS.replace("tau", "actual_current"));
    assert_eq!(currents.unit, Ampere);
    // Columns may stand in any order, with others between them that hold anything.
    let text = "tau_1,mode,q_1,q_0,note,t,tau_0\n-7,auto,-1.5,0.1,\"a, b\",0,4\n8,auto,-1.25,0.2,,0.5,5\n\
                -0.09,nan,-1,0.3,x,1,6\n";
    check(&read(text));
}

#[test]
fn a_header_may_stand_in_a_comment() {
    check(&read(&format!("# made by a script\n# {COMMAS}")));
}

#[test]
fn measured_goes_before_commanded_and_the_report_says_so() {
    let text = COMMAS.replace("t,q_0,q_1", "t,actual_q_0,actual_q_1").replace('\n', ",9,9\n");
    let text = text.replacen(",9,9", ",target_q_0,target_q_1", 1);
    let recording = read(&text);
    check(&recording);
    assert!(recording.report.remarks.iter().any(|r| r.contains("actual_q") && r.contains("target_q")));

    let commanded = ColumnSelection {
        position: Some(ColumnsRef::Prefix("target_q".into())),
        ..ColumnSelection::default()
    };
    let options = ReadOptions { columns: commanded, ..ReadOptions::default() };
    assert_eq!(read_with(&text, &options).unwrap().position_rad, [[9.0; 3], [9.0; 3]]);
}

#[test]
fn the_unit_decides_between_torques_and_currents() {
    let text = COMMAS.replace('\n', ",1,2\n").replacen(",1,2", ",current_0,current_1", 1);
    let ambiguous = read_with(&text, &ReadOptions::default()).unwrap_err();
    assert!(matches!(ambiguous, RecordingError::Unit { .. }), "{ambiguous}");
    check(&read_with(&text, &ReadOptions { unit: Some(NewtonMetre), ..ReadOptions::default() }).unwrap());
    let amperes = read_with(&text, &ReadOptions { unit: Some(Ampere), ..ReadOptions::default() }).unwrap();
    assert_eq!(*amperes.measurement.as_ref().unwrap(), [[1.0; 3], [2.0; 3]]);
    assert_eq!(amperes.unit, Ampere);
    assert!(amperes.report.remarks.iter().any(|r| r.contains("`tau`")));
    let options = ReadOptions { needs_measurement: false, ..ReadOptions::default() };
    let neither = read_with(&text, &options).unwrap();
    assert!(neither.measurement.is_none());
    assert_eq!(neither.report.remarks.len(), 1);
}

#[test]
fn headerless_files_need_a_selection() {
    let text = COMMAS.split_once('\n').unwrap().1;
    let error = read_with(text, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, RecordingError::Headerless { line: 1, columns: 5, .. }), "{error}");
    let columns = ColumnSelection {
        time: Some(ColumnRef::Index(0)),
        position: Some(ColumnsRef::Range { first: 1, last: 2 }),
        velocity: None,
        measurement: Some(ColumnsRef::List(vec![ColumnRef::Index(3), ColumnRef::Index(4)])),
    };
    let options = ReadOptions { columns: columns.clone(), ..ReadOptions::default() };
    let error = read_with(text, &options).unwrap_err();
    assert!(matches!(error, RecordingError::Unit { .. }), "{error}");
    check(
        &read_with(text, &ReadOptions { columns, unit: Some(NewtonMetre), ..ReadOptions::default() })
            .unwrap(),
    );
}

#[test]
fn names_may_be_selected_one_by_one() {
    let text = COMMAS.replace("t,q_0,q_1,tau_0,tau_1", "clock,shoulder,elbow,m a,m b");
    let columns = ColumnSelection {
        time: Some(ColumnRef::Name("Clock".into())),
        position: Some(ColumnsRef::List(vec![
            ColumnRef::Name("shoulder".into()),
            ColumnRef::Name("elbow".into()),
        ])),
        velocity: None,
        measurement: Some(ColumnsRef::List(vec![ColumnRef::Name("m a".into()), ColumnRef::Index(4)])),
    };
    check(
        &read_with(&text, &ReadOptions { columns, unit: Some(NewtonMetre), ..ReadOptions::default() })
            .unwrap(),
    );
}

#[test]
fn a_single_joint_needs_no_number() {
    let recording = read("time,q,qd,current\n0,1,2,3\n1,1.1,2,4\n");
    assert_eq!(recording.position_rad, [[1.0, 1.1]]);
    assert_eq!(recording.velocity_rad_s.unwrap(), [[2.0, 2.0]]);
    assert_eq!(recording.measurement.unwrap(), [[3.0, 4.0]]);
}

#[test]
fn what_nobody_asked_for_may_be_unusable() {
    let partial = "t,q_0,q_1,qd_1,tau_1\n0,1,2,3,4\n1,1,2,3,4\n";
    let options = ReadOptions { needs_measurement: false, ..ReadOptions::default() };
    let recording = read_with(partial, &options).unwrap();
    assert!(recording.velocity_rad_s.is_none() && recording.measurement.is_none());
    assert_eq!(recording.report.remarks.len(), 2);
    let error = read_with(partial, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, RecordingError::Columns { .. }), "{error}");
}

#[test]
fn numbers_are_rounded_correctly() {
    let cells = [
        "0.1",
        "-0.95840000",
        "123456789.123456789",
        "9007199254740993",
        "1e22",
        "1e23",
        "1.7976931348623157e8",
        "4.9406564584124654e-3",
        "0.000000000000000000001",
        "179.76931348623157",
        "3.141592653589793238462643",
        "-0",
        "+7",
        "7.",
        ".5",
        "1E-5",
        "00012.50",
    ];
    for cell in cells {
        let options = ReadOptions {
            measurement_limit: f64::INFINITY,
            needs_measurement: true,
            ..ReadOptions::default()
        };
        let text = format!("t,q,tau\n0,0,{cell}\n1,0,{cell}\n");
        let value = read_with(&text, &options).unwrap().measurement.unwrap()[0][0];
        assert_eq!(value.to_bits(), cell.parse::<f64>().unwrap().to_bits(), "{cell}");
    }
}

#[test]
fn windows_count_from_the_first_stamp() {
    let mut recording = read(COMMAS);
    recording.time_s.iter_mut().for_each(|t| *t += 100.0);
    let window = recording.window([0.5, 1.0]).unwrap();
    assert_eq!(window.time_s, [100.5, 101.0]);
    assert_eq!(window.position_rad, [[0.2, 0.3], [-1.25, -1.0]]);
    assert_eq!(window.measurement.unwrap(), [[5.0, 6.0], [8.0, -0.09]]);
    for bad in [[0.6, 0.7], [1.0, 0.5], [0.0, f64::NAN], [2.0, 3.0]] {
        let error = recording.window(bad).unwrap_err();
        assert!(matches!(error, RecordingError::Window { .. }), "{error}");
    }
}

#[test]
fn columns_are_found_by_the_names_of_the_joints() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("named.csv");
    let names = ["shoulder", "elbow"].map(str::to_owned).to_vec();
    for header in [
        "time,elbow.position,shoulder.position,elbow.effort [Nm],shoulder.effort [Nm]",
        "time,/joint_states/elbow/position,/joint_states/shoulder/position,effort/elbow,effort/shoulder",
        "time,Elbow_position,Shoulder_position,effort_elbow,effort_shoulder",
    ] {
        std::fs::write(&path, format!("{header}\n0,1,2,3,4\n0.1,1,2,3,4\n")).unwrap();
        let joints = Some(RobotJoints { names: names.clone(), ..2.into() });
        let read = read_recording(&path, &ReadOptions { joints, ..ReadOptions::default() }).unwrap();
        assert_eq!(read.position_rad, [[2.0; 2], [1.0; 2]], "{header}");
        assert_eq!(read.measurement.unwrap(), [[4.0; 2], [3.0; 2]], "{header}");
        assert_eq!(read.unit, NewtonMetre);
    }
    // A joint with two columns is not to be told by its name.
    std::fs::write(&path, "time,a.position,b/a.position,effort_0\n0,1,2,3\n").unwrap();
    let joints = Some(RobotJoints { names: vec!["a".to_owned()], ..1.into() });
    assert!(read_recording(&path, &ReadOptions { joints, ..ReadOptions::default() }).is_err());
}
