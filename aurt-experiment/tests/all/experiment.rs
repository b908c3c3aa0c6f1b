//! Reading experiments: what the struct holds, and what people read when something is wrong.

#![expect(clippy::expect_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;

use aurt::data::Source;
use aurt_calibration::{Estimator, LoadTorqueChoice, Rest};
use aurt_experiment::{Error, Experiment};
use aurt_plugins::Registry;
use aurt_recording::{AngleUnit, ColumnRef, ColumnsRef, CurrentUnit, DroppedRows, TimeUnit};
use aurt_traits::MeasurementUnit;
use tempfile::TempDir;

/// A folder with a two-joint robot and recordings (whose contents nobody reads here).
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mdh.csv"), "alpha,a,d\n0,0.5,0\n0,0.4,0\n").unwrap();
    for name in ["a.csv", "b.csv", "c.csv"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    folder
}

fn read(folder: &Path, text: &str) -> Result<Experiment, String> {
    let path = folder.join("e.toml");
    fs::write(&path, text).unwrap();
    let mut registry = Registry::linked().unwrap();
    Experiment::read(&path, &mut registry)
        .map_err(|e| e.to_string().replace(&format!("{}/", folder.display()), ""))
}

fn problems(text: &str) -> String {
    read(folder().path(), text).expect_err("this experiment is wrong")
}

const WHOLE: &str = include_str!("experiments/whole.toml");

#[test]
fn every_key_of_the_contract_is_read() {
    let folder = folder();
    let e = read(folder.path(), WHOLE).unwrap();
    assert_eq!(e.joints(), 2);
    assert_eq!(e.robot.geometry.path().unwrap(), folder.path().join("mdh.csv"));
    assert_eq!(e.robot.gravity_m_s2, [0.0, 0.0, -9.81]);
    assert_eq!(e.instrument.torque_constants_nm_per_a.as_deref(), Some(&[11.976, 9.839][..]));
    let stacks = e.joint_dynamics.stacks(2).unwrap();
    let names =
        |j: usize| (stacks[j].coulomb().name(), stacks[j].hysteresis().name(), stacks[j].viscous().name());
    assert_eq!(names(0), ("square", "sign", "polynomial"));
    assert_eq!(names(1), ("absolute", "sign", "polynomial"));
    assert_eq!(stacks[1].viscous().columns().len(), 3);
    assert_eq!(e.instrument.gains.as_deref(), Some(&[1.0, 1.02][..]));
    assert_eq!(e.instrument.delay_s.as_deref(), Some(&[0.0, 0.002][..]));
    assert_eq!(e.recordings.calibration[0].label, "a.csv");
    assert_eq!(e.recordings.calibration[1].window_s, Some([0.0, 30.0]));
    let validation = &e.recordings.validation[0];
    assert_eq!(validation.unit, Some(MeasurementUnit::Ampere));
    let columns = validation.columns.as_ref().unwrap();
    assert_eq!(columns.time, Some(ColumnRef::Index(0)));
    assert_eq!(columns.position, Some(ColumnsRef::Range { first: 1, last: 2 }));
    assert_eq!(columns.velocity, None);
    let names = ["i0", "i1"].map(|name| ColumnRef::Name(name.into()));
    assert_eq!(columns.measurement, Some(ColumnsRef::List(names.into())));
    assert_eq!(e.recordings.target[0].file, folder.path().join("b.csv"));
    assert_eq!((e.preprocess.f_dyn_hz, e.preprocess.sample_rate_hz), (2.5, Some(100.0)));
    assert!(!e.preprocess.trim_rest);
    assert_eq!(e.calibration.estimator, Estimator::Ols);
    assert_eq!(e.calibration.load_torque, LoadTorqueChoice::Literal);
    assert_eq!(e.calibration.rest, Rest::Exclude);
    assert!(!e.calibration.fit_shapes);
    assert!(e.sweep.unwrap().get("grid").is_some());
}

const SHORT: &str = r#"
schema = 1
[robot]
mdh = "mdh.csv"
gravity_m_s2 = [0.0, 0.0, -9.81]
[recordings]
calibration = ["a.csv"]
"#;

#[test]
fn what_is_left_out_has_its_default() {
    let e = read(folder().path(), SHORT).unwrap();
    let stack = &e.joint_dynamics.stacks(2).unwrap()[0];
    assert_eq!((stack.coulomb().name(), stack.hysteresis().name()), ("constant", "sign"));
    assert_eq!((stack.viscous().name(), stack.viscous().columns().len()), ("polynomial", 1));
    assert_eq!(e.preprocess.f_dyn_hz, 10.0);
    assert_eq!(e.calibration.estimator, Estimator::Wls);
    assert!(e.calibration.fit_shapes);
    assert_eq!(e.calibration.load_torque, LoadTorqueChoice::Fitted);
}

#[test]
fn dotted_inline_and_headed_tables_are_the_same() {
    let dotted = r#"
        schema = 1
        robot = { mdh = "mdh.csv", gravity_m_s2 = [0.0, 0.0, -9.81] }
        joint_dynamics.coulomb.model = "square"
        joint_dynamics.viscous = { powers = [1, 3], model = "polynomial" }
        joint_dynamics.override = [{ joints = [0], coulomb.model = "absolute" }]
        recordings.calibration = [{ file = "a.csv" }]
        calibration.estimator = "ols"
    "#;
    let e = read(folder().path(), dotted).unwrap();
    let stacks = e.joint_dynamics.stacks(2).unwrap();
    assert_eq!((stacks[0].coulomb().name(), stacks[1].coulomb().name()), ("absolute", "square"));
    assert_eq!(stacks[1].viscous().columns().len(), 2);
    assert_eq!(e.calibration.estimator, Estimator::Ols);
}

#[test]
fn all_problems_are_reported_at_once_each_at_its_place() {
    let text = r#"schema = 1
[robot]
mdh = "mdh.csv"
mdh_rows = "nxet"
gravity = [0, 0, -9.81]
torque_constants_nm_per_a = [11.976, 9.839, 9.839]
[joint_dynamics]
coulomb = { model = "sqare" }
viscous = { model = "polynomial", powers = "1" }
[[joint_dynamics.override]]
joints = [1, 7]
hysteresis = { model = "square" }
coulomb = { model = "absolute", level = 2 }
[recordings]
calibration = ["a.csv", "missing.csv"]
validation = [{ file = "c.csv", unit = "mA", windw_s = [0, 1] }]
[preprocess]
f_dyn_hz = -1
[calibration]
estimator = 3
[plot]
"#;
    let expected = r#"e.toml:4:12: `mdh_rows` cannot be "nxet"; did you mean `next`? known values: `next`, `previous`
e.toml:5:1: [robot] has no key `gravity`; did you mean `gravity_m_s2`? known keys: `base`, `gravity_m_s2`, `joint_names`, `joints`, `mdh`, `mdh_rows`, `mjcf`, `name`, `tip`, `tips`, `torque_constants_nm_per_a`, `urdf`
e.toml:6:29: `torque_constants_nm_per_a` expects one entry per joint, so 2, found 3
e.toml:8:21: there is no coulomb model `sqare`; did you mean `square`? known coulomb models: COULOMB
e.toml:9:44: model `polynomial`, key `powers`: invalid type: string "1", expected a sequence; a working example: POLYNOMIAL
e.toml:11:14: there is no joint 7; joints count from 0; the robot has 2: 0 to 1
e.toml:12:24: there is no hysteresis model `square`; `square` is a model for `coulomb`; known hysteresis models: HYSTERESIS
e.toml:13:33: model `absolute`, key `level`: unknown key `level`, it has no keys; a working example: ABSOLUTE
e.toml:15:25: `calibration` names the file missing.csv, which does not exist; relative paths start at the experiment's folder
e.toml:16:40: `unit` cannot be "mA"; known values: `A`, `Nm`
e.toml:16:46: a recording of `validation` has no key `windw_s`; did you mean `window_s`? known keys: `angle`, `columns`, `counts_per_revolution`, `current`, `drop`, `file`, `gear_ratio`, `joined`, `joint_names`, `rate_hz`, `take`, `time`, `topic`, `unit`, `window_s`
e.toml:18:12: `f_dyn_hz` must be above zero, is -1
e.toml:20:13: `estimator` expects a string, found an integer
e.toml:21:2: the experiment has no key `plot`; known keys: `arm_terms`, `calibration`, `diagnosis`, `drive`, `instrument`, `joint_dynamics`, `plugins`, `preprocess`, `recordings`, `robot`, `schema`, `sweep`"#;
    let registry = Registry::linked().unwrap();
    let list = |slot| registry.names(slot).iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
    let example = |slot, name| registry.model(slot, name).unwrap().example.clone();
    use aurt_traits::Slot::{Coulomb, Hysteresis, Viscous};
    let expected = expected
        .replace("COULOMB", &list(Coulomb))
        .replace("HYSTERESIS", &list(Hysteresis))
        .replace("POLYNOMIAL", &example(Viscous, "polynomial"))
        .replace("ABSOLUTE", &example(Coulomb, "absolute"));
    let found = problems(text);
    for (found, expected) in found.lines().zip(expected.lines()) {
        assert_eq!(found, expected);
    }
    assert_eq!(found, expected);
}

#[test]
fn a_model_that_is_no_table_or_has_no_name_is_refused() {
    let shown = |coulomb: &str| problems(&format!("{SHORT}[joint_dynamics]\ncoulomb = {coulomb}\n"));
    assert_eq!(
        shown("\"square\""),
        "e.toml:9:11: expected a table such as { model = \"…\" }, found a string; write coulomb = { model = \"…\" }"
    );
    assert!(shown("{ name = \"square\" }").starts_with(
        "e.toml:9:11: the table lacks `model`, the name of the coulomb model; known coulomb models: `absent`"
    ));
    assert!(
        shown("{ model = 3 }")
            .starts_with("e.toml:9:21: the table lacks `model`, the name of the coulomb model")
    );
    assert_eq!(
        shown("{ model = \"square\", x = inf }").split("; ").next().unwrap(),
        "e.toml:9:35: model `square`, key `x`: is not a finite number"
    );
}

#[test]
fn everything_wrong_is_named_with_its_place_and_remedy() {
    let lengths = SHORT.replace("[0.0, 0.0, -9.81]", "[0.0, -9.81]\ntorque_constants_nm_per_a = [1.0, nan]")
        + "[instrument]\ngains = [1.0]\noffsets = [0.0, \"x\"]\n";
    let overrides = format!(
        "{SHORT}[[joint_dynamics.override]]\njoints = [0, 1, 0]\ncoulomb = {{ model = \"square\" }}\n\
         [[joint_dynamics.override]]\njoints = [1]\ncoulomb = {{ model = \"absolute\" }}\n\
         [[joint_dynamics.override]]\njoints = [0]\n"
    );
    for (text, expected) in [
        (
            "# nothing\n",
            "e.toml:1:1: the experiment lacks the key `schema`; for example: schema = 1\n\
             e.toml:1:1: the experiment lacks the key `robot`; for example: [robot] with `mdh` (or `urdf`, `mjcf`, `name`) and `gravity_m_s2`\n\
             e.toml:1:1: the experiment lacks the key `recordings`; for example: [recordings] with `calibration`",
        ),
        (
            "schema = 2\n[robot]\n[recordings]\ncalibration = []\n",
            "e.toml:1:10: `schema` is 2, another version of the experiment file; this program reads schema 1\n\
             e.toml:2:1: [robot] lacks the key `mdh`; for example: mdh = \"mdh.csv\", urdf = \"robot.urdf\", mjcf = \"robot.xml\" or name = \"ur10e\"\n\
             e.toml:2:1: [robot] lacks the key `gravity_m_s2`; for example: gravity_m_s2 = [0.0, 0.0, -9.81]\n\
             e.toml:4:15: `calibration` needs at least one recording",
        ),
        (
            "schema = = 1\n[robot\n",
            "e.toml:1:10: this is not TOML: extra `=`, expected nothing\n\
             e.toml:2:7: this is not TOML: unclosed table, expected `]`",
        ),
        (
            &lengths,
            "e.toml:5:16: `gravity_m_s2` expects 3 numbers (x, y, z in m/s² in the base frame), found 2\n\
             e.toml:6:35: `torque_constants_nm_per_a` must be finite, is NaN\n\
             e.toml:10:9: `gains` expects one entry per joint, so 2, found 1\n\
             e.toml:11:17: `offsets` expects a number, found a string",
        ),
        (
            &overrides,
            "e.toml:9:10: `joints` names joint 0 twice\n\
             e.toml:13:11: an override above already gives the coulomb model of joint 1\n\
             e.toml:14:1: the override changes nothing; give it at least one of `coulomb`, `hysteresis`, `viscous`",
        ),
        (
            &SHORT.replace("a.csv", "${AURT_SURELY_UNSET}/a.csv"),
            "e.toml:7:16: `calibration` needs the environment variable `AURT_SURELY_UNSET`, which is not set; \
             set it to the folder that is meant: AURT_SURELY_UNSET=/path/to/folder aurt …",
        ),
    ] {
        assert_eq!(problems(text), expected);
    }
}

#[test]
fn problems_of_the_mdh_file_name_that_file() {
    let folder = folder();
    fs::write(folder.path().join("mdh.csv"), "alpha,a,d\n0,zero,0\n").unwrap();
    let problems = read(folder.path(), SHORT).unwrap_err();
    assert!(problems.starts_with("e.toml:4:7: `mdh`: mdh.csv:2: `zero` in column 2 (a)"), "{problems}");
}

#[test]
fn spans_cover_the_value() {
    let folder = folder();
    let path = folder.path().join("e.toml");
    let text = SHORT.replace("-9.81", "-9,81").replace("a.csv", "ä.csv");
    fs::write(&path, &text).unwrap();
    let error = Experiment::read(&path, &mut Registry::linked().unwrap()).unwrap_err();
    let Error::Experiment(errors) = error else { panic!("{error}") };
    let underlined: Vec<&str> = errors.problems.iter().map(|p| &errors.source_text[p.span.clone()]).collect();
    assert_eq!(underlined, ["[0.0, 0.0, -9,81]", "\"ä.csv\""]);
    assert_eq!((errors.problems[1].line, errors.problems[1].column), (7, 16));
}

#[test]
fn the_ur10e_experiment_gives_36_base_and_66_parameters() {
    let Ok(data) = std::env::var("AURT_DATA") else {
        println!("skipped: AURT_DATA names no folder of recordings");
        return;
    };
    let text = r#"
schema = 1
[robot]
mdh = "${AURT_DATA}/ur10e/mdh.csv"
gravity_m_s2 = [0.0, 0.0, -9.81]
torque_constants_nm_per_a = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
[joint_dynamics]
coulomb    = { model = "square" }
hysteresis = { model = "sign" }
viscous    = { model = "polynomial", powers = [1, 2, 3] }
[[joint_dynamics.override]]
joints = [1, 2]
coulomb = { model = "absolute" }
[recordings]
calibration = ["$AURT_DATA/ur10e/unloaded_50s.csv", { file = "${AURT_DATA}/ur10e/excitation_50s.csv", window_s = [0.0, 30.0] }]
validation  = ["${AURT_DATA}/ur10e/excitation_20s.csv", { file = "${AURT_DATA}/ur10e/as_recorded_headerless.csv", unit = "A", columns = { time = 0, position = [1, 6], measurement = [13, 18] } }]
"#;
    let experiment = read(folder().path(), text).unwrap();
    assert_eq!(experiment.recordings.calibration[0].file, Path::new(&data).join("ur10e/unloaded_50s.csv"));
    let model = experiment.robot_model().unwrap();
    assert_eq!((model.base().len(), model.parameters().len()), (36, 66));
}

/// An experiment whose `[robot]` begins with these lines.
fn of_robot(lines: &str) -> String {
    SHORT.replacen("mdh = \"mdh.csv\"", lines, 1)
}

/// An arm on a rail whose hand has two fingers.
const RAIL: &str = r#"<robot name="rail">
<link name="floor"/><link name="cart"/><link name="arm"/><link name="left"/><link name="right"/>
<joint name="x" type="prismatic"><parent link="floor"/><child link="cart"/><axis xyz="1 0 0"/></joint>
<joint name="turn" type="revolute"><parent link="cart"/><child link="arm"/><axis xyz="0 1 0"/></joint>
<joint name="l" type="prismatic"><parent link="arm"/><child link="left"/><axis xyz="0 1 0"/></joint>
<joint name="r" type="prismatic"><parent link="arm"/><child link="right"/><axis xyz="0 1 0"/></joint>
</robot>"#;

#[test]
fn geometry_comes_from_a_urdf_or_a_name_as_well() {
    let folder = folder();
    fs::write(folder.path().join("rail.urdf"), RAIL).unwrap();
    let e = read(folder.path(), &of_robot("urdf = \"rail.urdf\"\ntip = \"arm\"")).unwrap();
    assert_eq!(e.joints(), 2);
    assert_eq!(e.robot.geometry.path().unwrap(), folder.path().join("rail.urdf"));
    // Both masses together, and of the arm its inertia about the axis and two first moments.
    assert_eq!(e.rigid_body_dynamics().unwrap().base.len(), 4);
    // Without a tip it is the whole tree; or what is named, the rest of which is fixed.
    let joints = |lines: &str| read(folder.path(), &of_robot(lines)).unwrap().robot.joint_names;
    assert_eq!(joints("urdf = \"rail.urdf\""), ["x", "turn", "l", "r"]);
    assert_eq!(joints("urdf = \"rail.urdf\"\ntips = [\"right\", \"arm\"]"), ["x", "turn", "r"]);
    assert_eq!(joints("urdf = \"rail.urdf\"\njoints = [\"l\", \"x\"]"), ["x", "l"]);
    assert_eq!(joints("urdf = \"rail.urdf\"\ntips = [\"right\", \"left\"]"), ["x", "turn", "r", "l"]);
    let e = read(folder.path(), &of_robot("name = \"UR10e\"")).unwrap();
    assert_eq!((e.joints(), e.robot.geometry.path()), (6, None));
    assert_eq!(e.rigid_body_dynamics().unwrap().base.len(), 36);

    for (lines, part) in [
        ("urdf = \"rail.urdf\"\ntip = \"hand\"", "there is no link `hand` for the tip"),
        (
            "urdf = \"rail.urdf\"\njoints = [\"x\", \"tunr\"]",
            "`urdf`: rail.urdf: there is no joint `tunr` for `joints`, did you mean `turn`?; joints: x, turn, l, r",
        ),
        ("urdf = \"rail.urdf\"\ntip = \"arm\"\ntips = [\"left\"]", "`tips` is a second choice beside `tip`"),
        ("urdf = \"rail.urdf\"\njoints = []", "`joints` names nothing; leave it out for all joints"),
        ("mdh = \"mdh.csv\"\njoints = [\"x\"]", "`joints` chooses a part of a `urdf` or `mjcf`"),
        ("urdf = \"no.urdf\"", "`urdf` names the file no.urdf, which does not exist"),
        ("name = \"ur11e\"", "`name` names no known robot, is \"ur11e\""),
        ("name = \"ur11e\"", "`aurt robots` lists those that are known"),
        ("name = \"ur-10e\"", "did you mean \"ur10e\"?"),
        ("mdh = \"mdh.csv\"\nname = \"ur10e\"", "`name` is a second geometry beside `mdh`; remove one"),
        (
            "mdh = \"mdh.csv\"\ntip = \"arm\"",
            "`tip` chooses a link of a `urdf` or `mjcf`, which is not given",
        ),
    ] {
        let all = read(folder.path(), &of_robot(lines)).expect_err("this experiment is wrong");
        assert!(all.contains(part), "{part}\n---\n{all}");
    }
}

/// What is said of all recordings holds for each that does not say otherwise, and what is said of a recording's quantities holds
/// in all of its files; stamps and columns are a file's own.
#[test]
fn keys_of_recordings_hold_below_unless_said_otherwise() {
    let recordings = "[recordings]\ncolumns = { time = 0, position = [1, 2] }\ndrop = \"nan\"\nunit = \"A\"\ncurrent = \"A\"\ntime = \"s\"\n\
                      calibration = [\"a.csv\", { file = \"b.csv\", joined = [\"c.csv\", { file = \"a.csv\", current = \"A\" }], \
                      unit = \"Nm\", current = \"mA\", angle = \"deg\", time = \"ms\", columns = { time = 3, position = [4, 5] } }]\n";
    let text = format!("schema = 1\n[robot]\nmdh = \"mdh.csv\"\ngravity_m_s2 = [0, 0, -9.81]\n{recordings}");
    let e = read(folder().path(), &text).unwrap();
    let [plain, own] = &e.recordings.calibration[..] else { panic!("{:?}", e.recordings) };
    let first = |source: &Source| match &source.columns.as_ref().unwrap().position {
        Some(ColumnsRef::Range { first, .. }) => *first,
        _ => panic!("{source:?}"),
    };
    assert_eq!((first(plain), first(own)), (1, 4));
    assert!([plain, own].iter().all(|s| s.recorded.drop == Some(DroppedRows::NotANumber)));
    assert_eq!((plain.unit, own.unit), (Some(MeasurementUnit::Ampere), Some(MeasurementUnit::NewtonMetre)));
    let joined = |k: usize| {
        let r = &own.recorded.joined[k].recorded;
        (r.current, r.angle, r.time)
    };
    let (degree, second) = (Some(AngleUnit::Degree), Some(TimeUnit::Second));
    assert_eq!(joined(0), (Some(CurrentUnit::Milliampere), degree, second));
    assert_eq!(joined(1), (Some(CurrentUnit::Ampere), degree, second));
    let wrong = text.replace("drop = \"nan\"", "drop = \"empty\"");
    assert!(read(folder().path(), &wrong).unwrap_err().contains("`drop`"));
}

const DRIVEN: &str = include_str!("experiments/driven.toml");

/// Every number of an experiment, replaced by one that no robot has: an error that names it, at the latest where the number is
/// used, and nothing is allocated for it.
#[test]
fn numbers_that_no_robot_has_are_refused() {
    let folder = folder();
    let path = folder.path().join("e.toml");
    let mut registry = Registry::linked().unwrap();
    for whole in [WHOLE, DRIVEN] {
        let problems = Experiment::parse(whole, &path, &mut registry).err().map(|e| e.to_string());
        assert_eq!(problems, None);
        let mut at = 0;
        let mut tried = 0;
        while let Some(begin) = whole[at..].find(|c: char| c.is_ascii_digit()).map(|k| at + k) {
            let is_part = |c: char| c.is_ascii_digit() || "._e".contains(c);
            let end = begin + whole[begin..].find(|c| !is_part(c)).unwrap_or(whole.len() - begin);
            at = end;
            let before = whole[..begin].chars().next_back().unwrap_or(' ');
            if !" [-".contains(before) {
                continue;
            }
            for number in ["5e-324", "1e-200", "1e40", "1e308", "nan", "inf"] {
                let text = format!("{}{number}{}", &whole[..begin], &whole[end..]);
                let line = text[..begin].rsplit('\n').next().unwrap_or_default().to_owned() + number;
                let refused = Experiment::parse(&text, &path, &mut registry);
                let is_late = line.starts_with("level") || line.starts_with("reduction");
                assert!(refused.is_err() || (is_late && !number.contains("e")), "{line} is accepted");
            }
            let text = format!("{}-0.0{}", &whole[..begin], &whole[end..]).replace("--0.0", "-0.0");
            let _ = Experiment::parse(&text, &path, &mut registry);
            tried += 1;
        }
        assert!(tried > 20, "{tried}");
    }
}
