//! What `[sweep]` makes of an experiment, and what it refuses.

use aurt_experiment::sweep::SweepError;

use super::bench::Bench;

fn names(sweep: &str) -> Vec<String> {
    Bench::new(sweep).read().unwrap().points.into_iter().map(|p| p.name).collect()
}

fn refused(sweep: &str) -> Vec<String> {
    let error = Bench::new(sweep).read().unwrap_err();
    let SweepError::Definition(errors) = error else { panic!("{error}") };
    let lead = super::bench::BASE.matches('\n').count();
    errors
        .problems
        .iter()
        .map(|p| {
            let help = p.help.as_ref().map_or(String::new(), |h| format!("; {h}"));
            format!("{}:{}: {}{help}", p.line - lead, p.column, p.message)
        })
        .collect()
}

#[test]
fn grids_zips_and_variants_are_combined() {
    let grid = r#"
[sweep.grid]
"joint_dynamics.coulomb.model" = ["constant", "square"]
joint_dynamics.viscous.powers = [[1], [1, 2]]
"#;
    let expected = [
        "coulomb.model=constant, viscous.powers=[1]",
        "coulomb.model=constant, viscous.powers=[1,2]",
        "coulomb.model=square, viscous.powers=[1]",
        "coulomb.model=square, viscous.powers=[1,2]",
    ];
    assert_eq!(names(grid), expected);
    let zip = r#"
[sweep.zip]
"preprocess.f_dyn_hz" = [5.0, 10.0]
"preprocess.trim_rest" = [true, false]
[[sweep.variant]]
name = "plain"
[[sweep.variant]]
name = "with memory"
set = { "joint_dynamics.hysteresis" = { model = "dahl" }, "calibration.fit_shapes" = false }
"#;
    let expected = [
        "preprocess.f_dyn_hz=5.0, preprocess.trim_rest=true, plain",
        "preprocess.f_dyn_hz=5.0, preprocess.trim_rest=true, with memory",
        "preprocess.f_dyn_hz=10.0, preprocess.trim_rest=false, plain",
        "preprocess.f_dyn_hz=10.0, preprocess.trim_rest=false, with memory",
    ];
    assert_eq!(names(zip), expected);
}

#[test]
fn a_point_is_an_experiment_with_its_values_and_absolute_paths() {
    let bench = Bench::new(
        "[[sweep.variant]]\nname = \"x\"\nset = { \"joint_dynamics.hysteresis\" = { model = \"maxwell_slip\", elements = 3 }, \
         arm_terms = [{ model = \"rotor_inertia\" }] }\n",
    );
    let sweep = bench.read().unwrap();
    let point = &sweep.points[0];
    assert_eq!(point.experiment.joint_dynamics.hysteresis.columns().len(), 3);
    assert_eq!(point.experiment.arm_terms.len(), 1);
    assert!(!point.text.contains("[sweep"));
    let folder = bench.folder.path().canonicalize().unwrap();
    assert!(point.text.contains(&*folder.join("mdh.csv").to_string_lossy()), "{}", point.text);
    assert!(point.text.contains(&*folder.join("d.csv").to_string_lossy()));
}

#[test]
fn keys_and_values_that_cannot_be_are_refused_where_they_stand() {
    let keys = r#""preprocess.f_dyn" = [5.0, 10.0]
"calibration.estimater" = ["ols"]"#;
    let values = r#""joint_dynamics.coulomb.model" = ["constant", "sqare"]
"joint_dynamics.viscous" = [{ model = "polynomial", powers = [1] }, { model = "polynomial", power = [1] }]"#;
    let of_key = "2:1: the experiment has no key `joint_dynamic`";
    for (grid, expected) in [
        (
            "\"joint_dynamic.coulomb.model\" = [\"constant\"]",
            &[&[of_key, "did you mean `joint_dynamics`"][..]][..],
        ),
        (
            keys,
            &[
                &["2:1: [preprocess] has no key `f_dyn`", "did you mean `f_dyn_hz`"],
                &["3:1: [calibration] has no key `estimater`", "did you mean `estimator`"],
            ],
        ),
        (
            values,
            &[
                &["2:47: there is no coulomb model `sqare`", "did you mean `square`"],
                &["3:93: ", "`power`", "did you mean `powers`"],
            ],
        ),
    ] {
        let complaints = refused(&format!("[sweep.grid]\n{grid}\n"));
        assert_eq!(complaints.len(), expected.len(), "{complaints:#?}");
        for (complaint, words) in complaints.iter().zip(expected) {
            let has = complaint.starts_with(words[0]) && words.iter().all(|word| complaint.contains(word));
            assert!(has, "{complaints:#?}");
        }
    }
}

#[test]
fn sweep_itself_is_checked() {
    for (sweep, expected) in [
        ("[sweep]\nvalidat = \"held_out\"\n", "2:1: [sweep] has no key `validat`; did you mean `validate`"),
        ("[sweep]\nvalidate = \"loo\"\n", "2:12: `validate` cannot be this; known values"),
        ("[sweep]\n", "1:1: [sweep] varies nothing"),
        ("[sweep.grid]\n\"preprocess.f_dyn_hz\" = 5.0\n", "2:25: `preprocess.f_dyn_hz` expects a list"),
        (
            "[sweep.zip]\n\"preprocess.f_dyn_hz\" = [5, 6]\n\"preprocess.trim_rest\" = [true]\n",
            "3:1: the lists",
        ),
        ("[[sweep.variant]]\nset = {}\n", "1:1: a variant needs a `name`"),
        (
            "[[sweep.variant]]\nname = \"a\"\n[[sweep.variant]]\nname = \"a\"\n",
            "4:8: there is a variant \"a\"",
        ),
        ("[[sweep.variant]]\nname = \"a\"\nsets = {}\n", "3:1: [[sweep.variant]] has no key `sets`"),
        (
            "[sweep]\nreference = \"b\"\n[[sweep.variant]]\nname = \"a\"\n",
            "2:13: there is no point \"b\"; known points",
        ),
        ("[sweep.grid]\n\"preprocess.f_dyn_hz\" = [5.0, 5.0]\n", "2:31: two points are"),
        ("[sweep.grid]\n\"sweep.block_s\" = [1]\n", "2:1: `sweep.block_s`: a sweep cannot change"),
        (
            "[sweep.grid]\n\"joint_dynamics.coulomb.model.x\" = [1]\n",
            "2:1: `joint_dynamics.coulomb.model.x`: `model` is a string",
        ),
        ("[sweep]\nblock_s = 0\n[sweep.grid]\n\"preprocess.f_dyn_hz\" = [5]\n", "2:11: `block_s` expects"),
    ] {
        let complaints = refused(sweep);
        assert!(complaints.iter().any(|c| c.starts_with(expected)), "{sweep}{complaints:#?}");
    }
}

#[test]
fn there_has_to_be_something_to_judge_by() {
    let bench = Bench::new("");
    assert!(matches!(bench.read(), Err(SweepError::NoSweep { .. })));
    bench.write("[sweep.grid]\n\"recordings.validation\" = [[]]\n");
    assert!(matches!(bench.read(), Err(SweepError::NothingHeldOut { .. })));
    bench.write(
        "[sweep]\nvalidate = \"leave_one_out\"\n[sweep.grid]\n\"recordings.calibration\" = [[\"a.csv\"]]\n",
    );
    assert!(matches!(bench.read(), Err(SweepError::NothingHeldOut { .. })));
}
