//! Files that are written are read again, with the same numbers.

use std::path::Path;

use aurt_recording::{
    ColumnSelection, ColumnsRef, JointTopic, ReadOptions, RecordedAs, Recording, RecordingError, mcap,
    parquet, read_recording,
};
use aurt_traits::MeasurementUnit;

const SAMPLES: usize = 30_000;

/// Stamps every 2 ms, positions and torques of two joints that no short decimal can say.
fn series() -> (Vec<f64>, Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let stamps: Vec<f64> = (0..SAMPLES).map(|n| 0.002 * n as f64).collect();
    let of = |size: f64| -> Vec<Vec<f64>> {
        (0..2).map(|j| stamps.iter().map(|t| size * (1.3 * t + f64::from(j)).sin() / 3.0).collect()).collect()
    };
    let (position, torque) = (of(1.0), of(-40.0));
    (stamps, position, torque)
}

fn read(bytes: &[u8], name: &str, options: &ReadOptions) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    read_recording(&folder.path().join(name), options).unwrap()
}

#[test]
fn parquet_gives_back_every_bit() {
    let (stamps, position, torque) = series();
    let mut columns = vec![("timestamp".to_owned(), stamps.as_slice())];
    for j in 0..2 {
        columns.push((format!("q_{j}"), &position[j]));
        columns.push((format!("predicted_torque_{j}"), &torque[j]));
    }
    // More than fourteen columns: longer heads of lists.
    for k in 0..20 {
        columns.push((format!("other_{k}"), &stamps));
    }
    let bytes = parquet(Path::new("a.parquet"), &columns, &[("model", "rd_calibrated.json".into())]).unwrap();
    let columns = ColumnSelection {
        measurement: Some(ColumnsRef::Prefix("predicted_torque".into())),
        ..ColumnSelection::default()
    };
    let options = ReadOptions { columns, unit: Some(MeasurementUnit::NewtonMetre), ..ReadOptions::default() };
    let back = read(&bytes, "a.parquet", &options);
    assert_eq!(back.time_s, stamps);
    assert_eq!(back.position_rad, position);
    assert_eq!(back.measurement, Some(torque));
    assert!(bytes.len() < 8 * 25 * SAMPLES + 10_000);
}

#[test]
fn mcap_gives_back_every_bit_of_every_topic() {
    let (stamps, position, torque) = series();
    let residual: Vec<Vec<f64>> = torque.iter().map(|s| s.iter().map(|v| 0.1 * v).collect()).collect();
    let joints = ["shoulder", "elbow_joint"].map(str::to_owned);
    let topic = |name, effort| JointTopic { name, position: &position, velocity: &[], effort };
    let topics = [topic("/predicted", &torque), topic("/residual", &residual)];
    let facts = [("model", "rd_calibrated.json".to_owned())];
    let path = Path::new("a.mcap");
    for origin_s in [0.0, 1_700_000_000.0] {
        let bytes = mcap(path, &stamps, origin_s, &joints, &topics, &facts).unwrap();
        for (name, effort) in [("/predicted", &torque), ("/residual", &residual)] {
            let recorded = RecordedAs { topic: Some(name.into()), ..RecordedAs::default() };
            let back = read(&bytes, "a.mcap", &ReadOptions { recorded, ..ReadOptions::default() });
            assert_eq!(back.report.origin_s, origin_s);
            for (found, wanted) in back.time_s.iter().zip(&stamps) {
                assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
            }
            assert_eq!(back.position_rad, position);
            assert_eq!(back.measurement.as_ref(), Some(effort));
        }
    }
    let error = mcap(path, &[-1.0], 0.0, &joints, &topics, &facts).unwrap_err();
    assert!(matches!(error, RecordingError::Clock { .. }), "{error}");
}
