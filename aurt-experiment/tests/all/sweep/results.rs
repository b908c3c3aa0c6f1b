//! Results are those of the plain way, and they are ranked and marked as they deserve.

use aurt_calibration::{Metrics, TermScopes, calibrate_shapes, validate};
use aurt_experiment::sweep::{Data, Folder, JointErrors, Point, Ranking, Rows, Settings, Validate};

use super::bench::{Bench, judged};

const VARIANTS: &str = include_str!("variants.toml");

/// Fits to some recordings and judges on another, without anything shared.
fn plainly(point: &Point, by: Validate, chosen: &[usize], out: usize) -> (Vec<f64>, Metrics, Metrics) {
    let experiment = &point.experiment;
    let (data, settings) = (Data::read(experiment, by).unwrap(), Settings::of(experiment));
    let (model, calibration) = calibrate_shapes(
        &experiment.robot_model().unwrap(),
        &chosen.iter().map(|k| data.calibration[*k].clone()).collect::<Vec<_>>(),
        &TermScopes::everywhere(),
        data.unit,
        experiment.preprocess.f_dyn_hz,
        &settings.calibration,
        &settings.shapes,
    )
    .unwrap();
    let validation = validate(&model, &calibration, &data.judged[out], settings.rows).unwrap();
    (calibration.coefficients(), validation.all, validation.moving)
}

fn same(found: &[JointErrors], expected: &Metrics) {
    for (joint, errors) in found.iter().enumerate() {
        assert_eq!(errors.rows, expected.samples[joint]);
        let pairs = [
            (errors.mse(), expected.mse[joint]),
            (errors.nmse(), expected.nmse[joint]),
            (errors.nrmse(), expected.nrmse[joint]),
        ];
        for (a, b) in pairs {
            assert!((a / b - 1.0).abs() < 1e-9, "joint {joint}: {a} {b}");
        }
        assert_eq!(errors.block_rows.iter().sum::<usize>(), errors.rows);
        let blocks: f64 = errors.block_squared_error.iter().sum();
        assert!((blocks / errors.squared_error - 1.0).abs() < 1e-12);
    }
}

#[test]
fn results_are_those_of_a_plain_run() {
    let bench = Bench::new(VARIANTS);
    let (plan, summary) = bench.run("out");
    assert_eq!((summary.run, summary.present, summary.failed, summary.families), (3, 0, 0, 1));
    let sweep = bench.read().unwrap();
    for (point, result) in sweep.points.iter().zip(bench.results("out", &plan)) {
        let fold = &judged(&result).unwrap().folds[0];
        let (coefficients, all, moving) = plainly(point, Validate::HeldOut, &[0, 1, 2], 0);
        for (found, expected) in fold.parameters.iter().zip(&coefficients) {
            let scale = expected.abs() + found.std_dev.unwrap_or(f64::MIN_POSITIVE);
            assert!(
                (found.value - expected).abs() < 1e-7 * scale,
                "{}: {} {expected}",
                found.name,
                found.value
            );
        }
        same(&fold.judged[0].all, &all);
        same(&fold.judged[0].moving, &moving);
        assert_eq!(fold.shape_fit.is_some(), point.name == "searched");
    }
}

#[test]
fn leave_one_out_judges_each_recording_by_a_fit_to_the_others() {
    let bench = Bench::new(&format!("[sweep]\nvalidate = \"leave_one_out\"\n{VARIANTS}"));
    let (plan, _) = bench.run("out");
    let sweep = bench.read().unwrap();
    let results = bench.results("out", &plan);
    for (point, result) in sweep.points.iter().zip(&results).take(2) {
        let folds = &judged(result).unwrap().folds;
        assert_eq!(folds.len(), 3);
        for (out, fold) in folds.iter().enumerate() {
            let others: Vec<usize> = (0..3).filter(|k| *k != out).collect();
            assert_eq!(fold.calibrated_on.len(), 2);
            assert_eq!(fold.judged.len(), 1);
            let (_, all, moving) = plainly(point, Validate::LeaveOneOut, &others, out);
            same(&fold.judged[0].all, &all);
            same(&fold.judged[0].moving, &moving);
        }
    }
}

#[test]
fn points_of_other_preprocessing_are_families_of_their_own() {
    let bench = Bench::new(
        "[sweep.grid]\n\"preprocess.f_dyn_hz\" = [5.0, 10.0]\n\"joint_dynamics.coulomb.model\" = [\"none\", \"square\"]\n",
    );
    let (plan, summary) = bench.run("out");
    assert_eq!((summary.run, summary.families), (4, 2));
    let sweep = bench.read().unwrap();
    for (point, result) in sweep.points.iter().zip(bench.results("out", &plan)) {
        let (_, all, _) = plainly(point, Validate::HeldOut, &[0, 1, 2], 0);
        same(&judged(&result).unwrap().folds[0].judged[0].all, &all);
    }
}

#[test]
fn the_model_that_made_the_data_wins_and_differences_are_marked() {
    let bench = Bench::new(VARIANTS);
    let (plan, _) = bench.run("out");
    let folder = Folder::planned(&bench.path("out")).unwrap();
    let ranking = Ranking::of(&folder, &plan, Rows::All);
    assert_eq!(ranking.reference.as_deref(), Some("constant"));
    assert_eq!(ranking.ranked[0].name, "with load");
    assert!(ranking.ranked[0].score.unwrap() < 0.5);
    assert!(ranking.ranked[0].joints.iter().all(|j| j.beyond_noise && j.change_percent.unwrap() < -40.0));
    let constant = ranking.ranked.iter().find(|r| r.name == "constant").unwrap();
    assert!(!constant.tied_with_best);
    assert_eq!(constant.score, Some(1.0));
    assert!(constant.joints.iter().all(|j| !j.beyond_noise && j.change_percent == Some(0.0)));
    let csv = ranking.to_csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 4);
    assert!(lines[0].starts_with("rank,point,name,coefficients,shapes,score,tied_with_best,mse_0,mse_1,"));
    assert!(lines.iter().all(|l| l.matches(',').count() == lines[0].matches(',').count()));
}
