//! Fits and validations from shared rows are those from the recordings.

use crate::arm;

use arm::{RICH, linear, load_dependent_friction, model, named, recording};
use aurt_calibration::{
    Calibration, CalibrationError, CalibrationOptions, Estimator, FitRows, JointMetrics, LoadTorqueChoice,
    Metrics, NamedRecording, Rest, RigidRows, ShapeOptions, TermScopes, ValidatedRows, calibrate,
    calibrate_scoped, calibrate_shapes_rows, compare, validate,
};
use aurt_traits::{MeasurementUnit, RobotModel};
use serde_json::json;

const UNIT: MeasurementUnit = MeasurementUnit::NewtonMetre;

fn recordings() -> Vec<NamedRecording> {
    let make = |name, start_s, duration_s| {
        recording(name, RICH, (start_s, duration_s), load_dependent_friction(), 0.05)
    };
    vec![make("a.csv", 0.0, 14.0), make("b.csv", 31.0, 9.0), make("c.csv", 55.0, 7.0)]
}

/// Models with load dependence, memory, several columns and terms that share coefficients or are loads.
fn models() -> Vec<RobotModel> {
    let absolute = || named("absolute");
    let slip = || json!({ "model": "maxwell_slip", "elements": 4 });
    let cubic = || json!({ "model": "polynomial", "powers": [1, 3] });
    vec![
        model(named("constant"), named("sign"), linear(), &[]),
        model(
            absolute(),
            slip(),
            cubic(),
            &[named("rotor_inertia"), json!({ "model": "payload", "link": 1 })],
        ),
        model(
            absolute(),
            named("sign"),
            linear(),
            &[
                json!({ "model": "coupling", "joint": 1, "partner": 0 }),
                json!({ "model": "joint_friction", "joints": [0], "hysteresis": { "model": "dahl" } }),
            ],
        ),
        // Parts that others have too, and a level that is neither constant nor of the load alone.
        model(named("square"), slip(), cubic(), &[]),
        model(json!({ "model": "stribeck", "load": "absolute" }), named("sign"), linear(), &[]),
        model(named("absent"), named("sign"), linear(), &[]),
    ]
}

/// The fit of a model, its shapes as they are, from shared rows.
fn fitted(
    model: &RobotModel,
    rows: &FitRows<'_>,
    scopes: &TermScopes,
    options: &CalibrationOptions,
) -> Result<Calibration, CalibrationError> {
    let options = CalibrationOptions { fit_shapes: false, ..*options };
    calibrate_shapes_rows(model, rows, scopes, UNIT, 10.0, &options, &ShapeOptions::default())
        .map(|(_, calibration)| calibration)
}

fn close(a: f64, b: f64, scale: f64, what: &str) {
    assert!((a - b).abs() <= 1e-8 * scale.abs().max(1e-12), "{what}: {a} and {b}");
}

fn same(a: &Calibration, b: &Calibration) {
    for (x, y) in a.parameters.iter().zip(&b.parameters) {
        assert_eq!((&x.name, &x.unit, x.excited), (&y.name, &y.unit, y.excited));
        let deviation = y.std_dev.unwrap_or(0.0);
        close(x.value, y.value, y.value.abs() + deviation, &x.name);
        close(x.std_dev.unwrap_or(0.0), deviation, deviation, &x.name);
    }
    close(a.condition_number, b.condition_number, b.condition_number, "condition number");
    assert_eq!(a.samples_per_joint, b.samples_per_joint);
    assert_eq!((&a.recordings, &a.warnings), (&b.recordings, &b.warnings));
    for joint in 0..2 {
        close(a.sigma[joint], b.sigma[joint], b.sigma[joint], "sigma");
        close(a.ranges[joint].velocity_rad_s, b.ranges[joint].velocity_rad_s, 1.0, "velocity");
        let load = |c: &Calibration| c.ranges[joint].load_torque.unwrap_or(0.0);
        close(load(a), load(b), load(b), "load");
    }
}

#[test]
fn a_fit_from_shared_rows_is_the_fit() {
    let recordings = recordings();
    let choices = [
        CalibrationOptions::default(),
        CalibrationOptions { rest: Rest::Exclude, rest_velocity_rad_s: 0.1, ..CalibrationOptions::default() },
        CalibrationOptions {
            estimator: Estimator::Ols,
            load_torque: LoadTorqueChoice::Literal,
            ..CalibrationOptions::default()
        },
    ];
    let everywhere = TermScopes::everywhere();
    let selected = [recordings[0].clone(), recordings[2].clone()];
    for options in &choices {
        for model in models() {
            let rigid = RigidRows::new(&model, &recordings).unwrap();
            let rows = FitRows::new(&rigid, &[0, 2], options).unwrap();
            let shared = fitted(&model, &rows, &everywhere, options).unwrap();
            let streamed = calibrate_scoped(&model, &selected, &everywhere, UNIT, 10.0, options).unwrap();
            same(&shared, &streamed);
        }
    }
}

/// What earlier models left in shared rows must not show in the results of later ones, not even as rounding.
#[test]
fn a_fit_does_not_depend_on_which_models_were_fitted_before() {
    let recordings = recordings();
    let options = CalibrationOptions::default();
    let everywhere = TermScopes::everywhere();
    let fresh: Vec<Calibration> = models()
        .iter()
        .map(|model| {
            let rigid = RigidRows::new(model, &recordings).unwrap();
            let rows = FitRows::new(&rigid, &[0, 2], &options).unwrap();
            fitted(model, &rows, &everywhere, &options).unwrap()
        })
        .collect();
    let rigid = RigidRows::new(&models()[0], &recordings).unwrap();
    let rows = FitRows::new(&rigid, &[0, 2], &options).unwrap();
    for _ in 0..2 {
        for (model, fresh) in models().iter().zip(&fresh).rev() {
            let shared = fitted(model, &rows, &everywhere, &options).unwrap();
            assert_eq!(format!("{shared:?}"), format!("{fresh:?}"));
        }
    }
}

#[test]
fn terms_that_act_in_one_recording_only_do_so_here_too() {
    let recordings = recordings();
    let model = &models()[1];
    let scopes = TermScopes::new(vec![None, Some(vec!["c.csv".into()])]);
    let options = CalibrationOptions::default();
    let rigid = RigidRows::new(model, &recordings).unwrap();
    let rows = FitRows::new(&rigid, &[0, 1, 2], &options).unwrap();
    let shared = fitted(model, &rows, &scopes, &options).unwrap();
    let streamed = calibrate_scoped(model, &recordings, &scopes, UNIT, 10.0, &options).unwrap();
    same(&shared, &streamed);
}

#[test]
fn judging_by_shared_rows_is_validation() {
    let recordings = recordings();
    let options = CalibrationOptions::default();
    for model in models() {
        let everywhere = TermScopes::everywhere();
        let calibration =
            calibrate_scoped(&model, &recordings[..2], &everywhere, UNIT, 10.0, &options).unwrap();
        let expected = validate(&model, &calibration, &recordings[2], ValidatedRows::WhileInMotion).unwrap();
        let rigid = RigidRows::new(&model, &recordings).unwrap();
        let (mut all, mut moving) = (vec![JointMetrics::default(); 2], vec![JointMetrics::default(); 2]);
        rigid
            .judge(&model, &calibration, &everywhere, 2, ValidatedRows::WhileInMotion, |row| {
                all[row.joint].add(row.measured, row.predicted);
                if row.moving {
                    moving[row.joint].add(row.measured, row.predicted);
                }
            })
            .unwrap();
        for (found, expected) in [(all, expected.all), (moving, expected.moving)] {
            let found: Metrics = found.into_iter().collect();
            assert_eq!(found.samples, expected.samples);
            for joint in 0..2 {
                close(found.mse[joint], expected.mse[joint], expected.mse[joint], "mse");
                close(found.nrmse[joint], expected.nrmse[joint], expected.nrmse[joint], "nrmse");
            }
        }
    }
}

#[test]
fn rows_of_another_robot_are_refused() {
    let recordings = recordings();
    let model = &models()[0];
    let rigid = RigidRows::new(model, &recordings).unwrap();
    let options = CalibrationOptions::default();
    let rows = FitRows::new(&rigid, &[0], &options).unwrap();
    let turned = model.rigid_body().with_gravity([0.0, 0.0, -9.81]);
    let other =
        RobotModel::new(turned.into(), model.base().clone(), model.stacks().to_vec(), Vec::new()).unwrap();
    let everywhere = TermScopes::everywhere();
    assert!(fitted(&other, &rows, &everywhere, &options).is_err());
    assert!(FitRows::new(&rigid, &[], &options).is_err());
}

/// The rows that reports draw are those that metrics are means over.
#[test]
fn metrics_can_be_had_from_the_rows() {
    let model = model(named("absolute"), named("sign"), linear(), &[]);
    let recordings = &recordings()[..1];
    let calibration = calibrate(&model, recordings, UNIT, 10.0, &CalibrationOptions::default()).unwrap();
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
