//! Of long recordings stretches are kept that lie evenly over them; short ones are as they are when read whole.

use std::fmt::Write;
use std::fs;

use aurt_recording::{ReadOptions, Recording, Stretches, read_recording};
use proptest::prelude::*;
use tempfile::TempDir;

/// A table of that many rows at 1 kHz, whose position tells its row.
fn table(rows: usize) -> (TempDir, std::path::PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("long.csv");
    let mut text = String::from("timestamp,q_0,torque_0\n");
    for k in 0..rows {
        writeln!(text, "{:.3},{:.6},{}", k as f64 / 1000.0, k as f64 * 1e-6, k % 7).unwrap();
    }
    fs::write(&path, text).unwrap();
    (folder, path)
}

fn read(rows: usize, most: usize) -> (Recording, Recording) {
    let (_folder, path) = table(rows);
    let options = ReadOptions::default();
    (
        Stretches::read(&path, &options, most).unwrap().into_recording(),
        read_recording(&path, &options).unwrap(),
    )
}

#[test]
fn what_is_kept_can_be_thinned_further_and_a_whole_recording_cannot() {
    let (_folder, path) = table(150_000);
    let options = ReadOptions::default();
    let once = Stretches::read(&path, &options, 40_000).unwrap().into_recording();
    for most in [150_000, 80_000] {
        let thinned = Stretches::read(&path, &options, most).unwrap().at_most(40_000);
        assert!(thinned.rows() <= 40_000);
        let thinned = thinned.into_recording();
        assert!((thinned.samples() as f64 / once.samples() as f64 - 1.0).abs() < 0.3);
        assert_eq!(thinned.report.left_out_s.len(), once.report.left_out_s.len());
        assert_eq!(thinned.time_s[0], once.time_s[0]);
    }
    let whole = Stretches::whole(read_recording(&path, &options).unwrap()).at_most(10);
    assert_eq!(whole.rows(), 150_000);
    assert!(whole.into_recording().report.left_out_s.is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn no_more_than_asked_for_is_kept_and_the_whole_length_is_covered(rows in 1..200_000_usize, most in 1..150_000_usize) {
        let (spread, whole) = read(rows, most);
        const STRETCH: usize = 1 << 14;
        prop_assert!(spread.samples() <= most.max(STRETCH * 3 / 2));
        if rows <= most {
            prop_assert_eq!(spread, whole);
            return Ok(());
        }
        // Where something was left out there is half of what was asked for, or one stretch; rows are those of the file.
        prop_assert!(spread.samples() + STRETCH > most / 2);
        for (t, (q, torque)) in
            spread.time_s.iter().zip(spread.position_rad[0].iter().zip(&spread.measurement.as_ref().unwrap()[0]))
        {
            let row = (t * 1000.0).round() as usize;
            prop_assert_eq!(*t, whole.time_s[row]);
            prop_assert_eq!(*q, whole.position_rad[0][row]);
            prop_assert_eq!(*torque, whole.measurement.as_ref().unwrap()[0][row]);
        }
        let gaps: Vec<[f64; 2]> = spread.time_s.windows(2).map(|w| [w[0], w[1]]).filter(|w| w[1] - w[0] > 0.0015).collect();
        prop_assert_eq!(&gaps, &spread.report.left_out_s);
        // Of one recording all gaps are alike, but where the file ends or a piece of it was cut otherwise.
        prop_assert!(gaps.windows(2).all(|w| (w[0][1] - w[0][0] - (w[1][1] - w[1][0])).abs() < 0.6 * (w[0][1] - w[0][0])), "{gaps:?}");
        if spread.samples() < rows {
            prop_assert!(spread.report.remarks.iter().any(|r| r.contains("were looked at")), "{:?}", spread.report);
        }
        prop_assert_eq!(spread.report.rows, rows);
    }
}
