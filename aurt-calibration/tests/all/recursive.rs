//! Recursive least squares against the batch.

use crate::workload;

use aurt_calibration::{
    CalibrationOptions, Estimator, NamedRecording, TermScopes, Tracker, accumulate, estimate,
    for_each_row_block,
};
use aurt_recording::{PreprocessOptions, preprocess};
use aurt_traits::LoadTorque;

#[test]
fn row_by_row_gives_the_estimate_of_the_batch() {
    let model = workload::model(4);
    let data = preprocess(&workload::recording(4, 6000), &PreprocessOptions::new(10.0)).unwrap();
    let recordings = [NamedRecording { name: "benchmark.csv".into(), data }];
    let (load, options) = (LoadTorque::Literal, CalibrationOptions::default());
    let system = accumulate(&model, &recordings, &TermScopes::everywhere(), &load, &options).unwrap();
    let batch = estimate(&system, Estimator::Wls).unwrap();

    let columns = (0..model.joints()).map(|j| model.row_columns(j).to_vec()).collect();
    let mut tracker = Tracker::new(model.parameters().len(), columns, &batch.sigma);
    for segment in &recordings[0].data.segments {
        let measurement = segment.measurement.as_ref().unwrap();
        for_each_row_block(&model, segment, &load, |block| {
            for row in 0..block.rows {
                for (joint, measured) in measurement.iter().enumerate() {
                    let values: Vec<f64> = model.row_slots(joint).map(|s| block.column(s)[row]).collect();
                    let measured = measured[block.first_row + row];
                    assert!(tracker.push(joint, &values, measured).unwrap());
                }
                tracker.forget(&vec![1.0; model.parameters().len()]).unwrap();
            }
        })
        .unwrap();
    }
    let recursive = tracker.estimate().unwrap();
    assert_eq!(recursive.excited, batch.solution.excited);
    let rows: Vec<f64> = system.factors().iter().map(|f| f.rows() as f64).collect();
    assert_eq!(tracker.rows(), rows);
    let n = recursive.coefficients.len();
    for k in 0..n {
        let (a, b) = (recursive.coefficients[k], batch.solution.coefficients[k]);
        assert!((a - b).abs() <= 1e-9 * b.abs(), "{}: {a} {b}", model.parameters()[k].name);
        let (a, b) = (recursive.covariance[k * n + k], batch.solution.covariance[k * n + k]);
        assert!((a - b).abs() <= 1e-9 * b, "{}: {a} {b}", model.parameters()[k].name);
    }
}
