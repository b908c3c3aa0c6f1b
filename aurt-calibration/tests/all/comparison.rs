//! The rows that reports draw are those that metrics are means over.

use crate::arm;

use arm::{Friction, RICH, model, named, recording};
use aurt_calibration::{
    CalibrationOptions, JointMetrics, Metrics, TermScopes, ValidatedRows, calibrate_scoped, compare, validate,
};
use aurt_traits::MeasurementUnit;
use serde_json::json;

#[test]
fn metrics_can_be_had_from_the_rows() {
    let friction = [1.0, 0.6].map(|scale| -> Friction {
        Box::new(move |[_, v, _], load| scale * ((2.0 + 0.1 * load.abs()) * (v / 1e-3).tanh() + 3.0 * v))
    });
    let recording = recording("a.csv", RICH, (0.0, 14.0), friction, 0.05);
    let linear = json!({ "model": "polynomial", "powers": [1] });
    let model = model(named("absolute"), named("sign"), linear, &[]);
    let recordings = [recording];
    let calibration = calibrate_scoped(
        &model,
        &recordings,
        &TermScopes::everywhere(),
        MeasurementUnit::NewtonMetre,
        10.0,
        &CalibrationOptions::default(),
    )
    .unwrap();
    for rows in [ValidatedRows::All, ValidatedRows::WhileInMotion] {
        let judged = validate(&model, &calibration, &recordings[0], rows).unwrap();
        let rows = compare(&model, &calibration, &recordings[0], rows).unwrap();
        assert_eq!(rows.time_s.len(), judged.samples);
        let metrics: Metrics = rows
            .joints
            .iter()
            .map(|joint| {
                assert_eq!(joint.rigid_body.len(), judged.samples);
                let mut sums = JointMetrics::default();
                joint.measured.iter().zip(&joint.predicted).for_each(|(y, p)| sums.add(*y, *p));
                sums
            })
            .collect();
        assert_eq!(metrics, judged.all);
    }
}
