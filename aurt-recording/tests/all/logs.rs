//! Logs of robots, with the column names that their makers document.

use std::f64::consts::PI;
use std::fmt::Write as _;

use aurt_recording::{AngleUnit, ReadOptions, RecordedAs, Recording, RecordingError, read_recording};
use aurt_traits::MeasurementUnit::{Ampere, NewtonMetre};

const DEGREE: f64 = PI / 180.0;

/// Three rows under a header; the numbers of row k are k + 1, k + 2, …, the first column `stamps[k]`.
fn log(header: &str, stamps: [&str; 3], options: &ReadOptions) -> Result<Recording, RecordingError> {
    let file = tempfile::NamedTempFile::new().unwrap();
    let columns = header.split(',').count();
    let mut text = format!("{header}\n");
    for (k, stamp) in stamps.iter().enumerate() {
        let numbers: String = (stamp.split(',').count()..columns).fold(String::new(), |mut all, n| {
            let _ = write!(all, ",{}", (k + n) as f64 / 8.0);
            all
        });
        let _ = writeln!(text, "{stamp}{numbers}");
    }
    std::fs::write(file.path(), text).unwrap();
    read_recording(file.path(), options)
}

fn read(header: &str, stamps: [&str; 3]) -> Recording {
    log(header, stamps, &ReadOptions::default()).unwrap()
}

fn remarks(recording: &Recording) -> String {
    recording.report.remarks.join("; ")
}

#[test]
fn libfranka_logs_milliseconds() {
    let header = "time,success_rate,state.q[0],state.q[1],state.q_d[0],state.q_d[1],state.dq[0],state.dq[1],state.dq_d[0],\
                  state.dq_d[1],state.tau_J[0],state.tau_J[1],state.tau_ext_hat_filtered[0],state.tau_ext_hat_filtered[1],\
                  cmd.q_d[0],cmd.q_d[1],cmd.tau_J_d[0],cmd.tau_J_d[1]";
    let read = read(header, ["7", "8", "9"]);
    assert_eq!(read.time_s, [0.007, 0.008, 0.009]);
    assert_eq!(read.position_rad[1], [3.0 / 8.0, 0.5, 5.0 / 8.0]);
    assert_eq!(read.velocity_rad_s.as_ref().unwrap()[0][0], 6.0 / 8.0);
    assert_eq!(read.measurement.as_ref().unwrap()[0][0], 10.0 / 8.0);
    assert_eq!(read.unit, NewtonMetre);
    assert!(remarks(&read).contains("`time` is in ms"), "{}", remarks(&read));
}

#[test]
fn kortex_logs_degrees() {
    let header = "timestamp,actuators[0].position,actuators[0].velocity,actuators[0].torque,actuators[0].current_motor,\
                  actuators[1].position,actuators[1].velocity,actuators[1].torque,actuators[1].current_motor";
    let options = ReadOptions { unit: Some(Ampere), ..ReadOptions::default() };
    let read = log(header, ["0", "0.5", "1"], &options).unwrap();
    assert_eq!(read.position_rad[1][0], 5.0 / 8.0 * PI / 180.0);
    assert_eq!(read.velocity_rad_s.as_ref().unwrap()[1][0], 6.0 / 8.0 * PI / 180.0);
    assert_eq!(read.measurement.as_ref().unwrap()[1][0], 1.0);
    assert!(remarks(&read).contains("degrees"), "{}", remarks(&read));
    let recorded = RecordedAs { angle: Some(AngleUnit::Radian), ..RecordedAs::default() };
    let stated = log(header, ["0", "0.5", "1"], &ReadOptions { recorded, ..options }).unwrap();
    assert_eq!(stated.position_rad[1][0], 5.0 / 8.0);
}

#[test]
fn kuka_rsi_logs_degrees_and_milliseconds() {
    let header = "IPOC,AIPos.A1,AIPos.A2,ASPos.A1,ASPos.A2,MACur.A1,MACur.A2";
    let read = read(header, ["400", "404", "408"]);
    assert_eq!(read.time_s, [0.4, 0.404, 0.408]);
    assert!((read.position_rad[0][0] - DEGREE / 8.0).abs() < 1e-16);
    assert_eq!((read.unit, read.measurement.as_ref().unwrap()[1][0]), (Ampere, 6.0 / 8.0));
    assert!(remarks(&read).contains("drive's own unit"), "{}", remarks(&read));
}

#[test]
fn kuka_sunrise_logs_seconds_and_nanoseconds() {
    let header = "ZeitInSec,ZeitInNanoSec,axisQMsr_LBR_iiwa_7_R800_1[0],axisQMsr_LBR_iiwa_7_R800_1[1],\
                  axisTauMsr_LBR_iiwa_7_R800_1[0],axisTauMsr_LBR_iiwa_7_R800_1[1]";
    let stamps = ["1700000000,998000000", "1700000001,0", "1700000001,2000000"];
    let read = read(header, stamps);
    assert_eq!(read.time_s, [0.998, 1.0, 1.002]);
    assert_eq!((read.joints(), read.unit), (2, NewtonMetre));
    assert_eq!(read.measurement.as_ref().unwrap()[1][2], 7.0 / 8.0);
}

#[test]
fn topics_of_plot_juggler_and_joints_before_quantities_are_understood() {
    let header = "__time,/joint_states/position[0],/joint_states/position[1],/joint_states/effort[0],/joint_states/effort[1]";
    let plotted = read(header, ["0", "0.5", "1"]);
    assert_eq!((plotted.joints(), plotted.unit), (2, NewtonMetre));
    let before = read("t,joint_1_pos,joint_1_torque,joint_2_pos,joint_2_torque", ["0", "0.5", "1"]);
    assert_eq!(before.position_rad[1][0], 3.0 / 8.0);
    assert_eq!(before.measurement.as_ref().unwrap()[0][0], 0.25);
    let stamps = ["5,0", "5,500000000", "6,0"];
    let ros = read("header.stamp.sec,header.stamp.nanosec,position[0],velocity[0],effort[0]", stamps);
    assert_eq!(ros.time_s, [0.0, 0.5, 1.0]);
}

#[test]
fn x_arm_logs_degrees() {
    let read = read(
        "time,angles_0,angles_1,realtime_joint_speeds_0,realtime_joint_speeds_1,currents_0,currents_1",
        ["0", "0.5", "1"],
    );
    assert!((read.position_rad[1][0] - 2.0 * DEGREE / 8.0).abs() < 1e-16);
    assert!((read.velocity_rad_s.as_ref().unwrap()[1][0] - 4.0 * DEGREE / 8.0).abs() < 1e-16);
    assert_eq!(read.unit, Ampere);
}

#[test]
fn dynamixel_counts_need_their_number_in_a_turn() {
    let header = "time_ms,present_position_1,present_position_2,present_current_1,present_current_2";
    let error = log(header, ["0", "5", "10"], &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("counts_per_revolution = 4096"), "{error}");
    let recorded = RecordedAs { counts_per_revolution: Some(vec![4096.0]), ..RecordedAs::default() };
    let read = log(header, ["0", "5", "10"], &ReadOptions { recorded, ..ReadOptions::default() }).unwrap();
    assert_eq!(read.time_s, [0.0, 0.005, 0.01]);
    assert!((read.position_rad[0][0] - PI / 4096.0 / 4.0).abs() < 1e-18);
    assert!(remarks(&read).contains("drive's own unit"), "{}", remarks(&read));
}

#[test]
fn velocities_in_another_unit_than_positions_are_not_read() {
    let read = read("time,AIPos_A1,AIPos_A2,velocity_1,velocity_2,tau_1,tau_2", ["0", "0.5", "1"]);
    assert!(read.velocity_rad_s.is_none());
    assert!(remarks(&read).contains("velocities were not read"), "{}", remarks(&read));
}

#[cfg(feature = "parquet")]
/// Two episodes of three frames, each from 0 s on, as LeRobot stores them.
#[test]
fn episodes_of_lerobot_follow_each_other() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/lerobot.parquet");
    let options = ReadOptions { needs_measurement: false, ..ReadOptions::default() };
    let read = read_recording(&path, &options).unwrap();
    assert_eq!(read.time_s, [0.0, 0.25, 0.5, 10.5, 10.75, 11.0]);
    assert_eq!(read.position_rad, [[0.0, 2.0, 4.0, 6.0, 8.0, 10.0], [1.0, 3.0, 5.0, 7.0, 9.0, 11.0]]);
    assert!(remarks(&read).contains("10 s"), "{}", remarks(&read));
}

#[test]
fn formats_that_are_not_read_say_how_to_convert() {
    let folder = tempfile::tempdir().unwrap();
    let marks: &[(&[u8], &str)] = &[
        (b"#ROSBAG V2.0\n", "rosbags-convert"),
        (b"ARROW1\0\0", "to_parquet"),
        (b"\x89HDF\r\n\x1a\n", ".npz"),
        #[cfg(feature = "parquet")]
        (b"PAR1 and no more", "copy or write the file again"),
    ];
    for (mark, remedy) in marks.iter().copied() {
        let path = folder.path().join("log.csv");
        std::fs::write(&path, [mark, &[0; 64]].concat()).unwrap();
        let error = read_recording(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(remedy) && error.contains("log.csv"), "{error}");
    }
}
