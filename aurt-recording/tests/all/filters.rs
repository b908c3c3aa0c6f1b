//! Filters, splines and derivatives against numpy and scipy (`reference/make_reference.py`), and the blockwise
//! bank against the filter over whole series.

use aurt_recording::{RecordingError, ZeroPhase, ZeroPhaseBank};
use proptest::prelude::*;
use serde_json::Value;

/// The series of `make_reference.py`.
pub fn series(samples: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    (0..samples)
        .map(|k| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let noise = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            let k = k as f64;
            (0.05 * k).sin() + 0.3 * (0.7 * k + seed as f64).sin() + 0.01 * k + noise
        })
        .collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn reference(name: &str) -> Value {
    let path = format!("{}/tests/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, v| m.max(v.abs()))
}

#[test]
fn sections_and_filtered_series_equal_those_of_scipy() {
    for case in reference("filters").as_array().unwrap() {
        let order = case["order"].as_u64().unwrap() as usize;
        let (cutoff, rate) = (case["cutoff_hz"].as_f64().unwrap(), case["rate_hz"].as_f64().unwrap());
        let filter = ZeroPhase::butterworth(order, cutoff, rate).unwrap();
        let expected: Vec<f64> = case["sos"].as_array().unwrap().iter().flat_map(numbers).collect();
        let own: Vec<f64> =
            filter.sections().iter().flat_map(|s| [s.b[0], s.b[1], s.b[2], 1.0, s.a[0], s.a[1]]).collect();
        // Numerators shrink with the cut-off and are compared relatively; denominators are of order one, and
        // some of their coefficients are zero but for rounding.
        let relative: Vec<f64> = own
            .iter()
            .zip(&expected)
            .enumerate()
            .map(|(k, (o, e))| if k % 6 < 3 && *e != 0.0 { (o - e) / e } else { o - e })
            .collect();
        println!("order {order}, {cutoff} of {rate} Hz: sections differ by {:.1e}", largest(&relative));
        assert!(largest(&relative) < 2e-15, "order {order}, {cutoff} Hz of {rate} Hz: {own:?} {expected:?}");

        let x = series(case["samples"].as_u64().unwrap() as usize, case["seed"].as_u64().unwrap());
        let y = filter.filter(&x).unwrap();
        let kept: Vec<f64> =
            case["at"].as_array().unwrap().iter().map(|k| y[k.as_u64().unwrap() as usize]).collect();
        let difference = largest_difference(&kept, &numbers(&case["filtered"])) / largest(&x);
        println!("    filtered series differ by {difference:.1e}");
        assert!(difference < 1e-12, "order {order}, {cutoff} Hz of {rate} Hz: {difference:e}");
    }
}

/// Feeds `columns` to a bank in tiles of the given lengths (repeated) and collects the rows.
fn through_bank(
    filter: &ZeroPhase,
    columns: &[Vec<f64>],
    decimation: usize,
    tiles: &[usize],
) -> Result<Vec<Vec<f64>>, RecordingError> {
    let mut bank = ZeroPhaseBank::new(filter, columns.len(), decimation);
    let mut rows = vec![Vec::new(); columns.len()];
    let mut sink = |tile: aurt_recording::DecimatedTile<'_>| {
        for (column, rows) in rows.iter_mut().enumerate() {
            assert_eq!(rows.len(), tile.first_row());
            rows.extend_from_slice(tile.column(column));
        }
    };
    let samples = columns[0].len();
    let mut at = 0;
    for length in tiles.iter().cycle() {
        let now = (*length).min(samples - at);
        let stride = now + 3;
        let mut tile = vec![f64::NAN; stride * columns.len()];
        for (column, x) in columns.iter().enumerate() {
            tile[column * stride..column * stride + now].copy_from_slice(&x[at..at + now]);
        }
        bank.push(&tile, stride, now, &mut sink);
        at += now;
        if at == samples {
            break;
        }
    }
    bank.finish(&mut sink)?;
    Ok(rows)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 80, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bank_equals_whole_series(
        order in 1_usize..=8,
        normalized in 0.01_f64..0.98,
        decimation in 1_usize..40,
        samples in 40_usize..3000,
        columns in 1_usize..12,
        tiles in prop::collection::vec(1_usize..700, 1..6),
    ) {
        let filter = ZeroPhase::butterworth(order, normalized * 50.0, 100.0).unwrap();
        let data: Vec<Vec<f64>> = (0..columns).map(|c| series(samples, c as u64)).collect();
        let rows = through_bank(&filter, &data, decimation, &tiles).unwrap();
        for (x, rows) in data.iter().zip(&rows) {
            let whole: Vec<f64> = filter.filter(x).unwrap().into_iter().step_by(decimation).collect();
            let difference = largest_difference(rows, &whole) / largest(x);
            // The recursion over a whole series loses digits as the cut-off falls; the bank does not.
            let allowed = 1e-13 + 1e-16 / (normalized * normalized);
            prop_assert!(difference < allowed, "{difference:e}");
        }
    }
}
