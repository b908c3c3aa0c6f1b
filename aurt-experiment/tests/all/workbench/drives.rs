//! Experiments with a `[drive]`, from files to files.

use std::fs;
use std::path::Path;

use aurt::Progress;
use aurt::data::Source;
use aurt_calibration::drives::{DriveRecording, DrivenArm, DrivenJoint, Mechanics};
use aurt_diagnosis::discrimination::{DeviationGoal, Doubt};
use aurt_experiment::Experiment;
use aurt_experiment::workbench::diagnosing::DiagnosisOptions;
use aurt_experiment::workbench::driving::{
    CalibratedDrive, DRIVE_FILE, DriveOutcome, IMPROVED_DRIVE_FILE, check_drives, diagnose_drives, fit_drives,
};
use aurt_experiment::workbench::next::{NextOptions, plan_next};
use aurt_friction::drives::PositionServo;
use aurt_plugins::Registry;
use aurt_rbd::{Joint, Placement, SerialChain};
use aurt_recording::{AngleUnit, RecordedAs};
use aurt_traits::CommandSignal;

pub(super) const EXPERIMENT: &str = include_str!("servo.toml");

fn read(folder: &Path, text: &str) -> Experiment {
    Experiment::parse(text, &folder.join("experiment.toml"), &mut Registry::linked().unwrap()).unwrap()
}

/// A folder with the table of a joint, and recordings that follow their commands.
fn folder_of(recordings: [(&str, &[f64]); 2]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mdh.csv"), "alpha,a,d\n0,0,0\n").unwrap();
    recordings.iter().for_each(|(name, command)| write(&folder.path().join(name), command, command));
    folder
}

/// A recording at 50 Hz.
pub(super) fn write(path: &Path, q: &[f64], command: &[f64]) {
    let rows = q.iter().zip(command).enumerate();
    let rows: String = rows.map(|(k, (q, c))| format!("{},{q},{c}\n", k as f64 * 0.02)).collect();
    fs::write(path, "time,q_0,q_cmd_0\n".to_owned() + &rows).unwrap();
}

/// The positions of an arm of one joint that starts at rest.
pub(super) fn moved(arm: &DrivenArm, command: &[f64]) -> Vec<f64> {
    let still = DriveRecording {
        time_s: (0..command.len()).map(|k| k as f64 * 0.02).collect(),
        command: vec![command.to_vec()],
        position_rad: vec![vec![command[0]; command.len()]],
        ..DriveRecording::default()
    };
    arm.rollout(&still).unwrap().remove(0)
}

fn file_of<'o>(outcome: &'o DriveOutcome, name: &str) -> &'o [u8] {
    &outcome.files.iter().find(|(own, _)| own == name).unwrap().1
}

/// A servo of 10 Nm/rad that turns a rotor, on a vertical axis.
pub(super) fn servo(back_emf_nm_s_per_rad: f64, delay_s: f64, coulomb_nm: f64) -> DrivenArm {
    let drive =
        PositionServo { gain_nm_per_rad: 10.0, back_emf_nm_s_per_rad, delay_s, ..PositionServo::default() };
    let mechanics = Mechanics { rotor_inertia_kg_m2: 0.01, coulomb_nm, ..Mechanics::default() };
    let joint = Joint::revolute(Placement::from_roll_pitch_yaw([0.0; 3], [0.0; 3]));
    DrivenArm {
        chain: SerialChain::new(vec![joint], [0.0, 0.0, -9.81]).unwrap(),
        standard_parameters: vec![0.0; 10],
        joints: vec![DrivenJoint { drive: Box::new(drive), mechanics }],
        command: CommandSignal::Hold,
        floor: None,
    }
}

/// Positions as an encoder of 4096 ticks a turn has them.
pub(super) fn read_out(q: &[f64]) -> Vec<f64> {
    let tick = std::f64::consts::TAU / 4096.0;
    q.iter().map(|q| (q / tick).round() * tick).collect()
}

#[test]
fn a_servo_is_calibrated_from_its_commands_and_predicted_from_its_file() {
    let commands: [Vec<f64>; 2] = [0.0, 2.0].map(|phase| {
        let wave = |k: f64| 0.4 * (k * 0.03 + phase).sin() + 0.1 * (k * 0.11).sin();
        (0..600).map(|k| wave(f64::from(k))).collect()
    });
    let folder = folder_of([("a.csv", &commands[0]), ("b.csv", &commands[1])]);
    let folder = folder.path();
    let experiment = read(folder, EXPERIMENT);
    let path = folder.join("experiment.toml");
    fs::write(&path, EXPERIMENT).unwrap();
    let refused = Experiment::read(&path, &mut Registry::linked().unwrap()).unwrap_err().to_string();
    assert!(refused.contains("[drive]"), "{refused}");

    // What the robot of the experiment does when its friction is 0.3 Nm and its delay 35 ms.
    let file = folder.join(DRIVE_FILE);
    let arm = servo(0.4, 0.035, 0.3);
    for (name, command) in ["a.csv", "b.csv"].iter().zip(&commands) {
        write(&folder.join(name), &moved(&arm, command), command);
    }

    let outcome = fit_drives(&experiment, &Progress::silent()).unwrap();
    for (name, truth) in [("back_emf_nm_s_per_rad_0", 0.4), ("delay_s_0", 0.035), ("coulomb_nm_0", 0.3)] {
        let numbers = outcome.json["numbers"].as_array().unwrap();
        let value = numbers.iter().find(|n| n["name"] == name).unwrap()["value"].as_f64().unwrap();
        assert!((value - truth).abs() < 0.01 * truth, "{name}: {value}");
    }
    assert!(outcome.json["held_out_rms"].as_f64().unwrap() < 1e-4, "{}", outcome.text);
    assert!(outcome.text.contains("held-out, all samples"));
    fs::write(&file, file_of(&outcome, DRIVE_FILE)).unwrap();
    let model = CalibratedDrive::read(&file).unwrap().unwrap();
    let source = Source {
        file: folder.join("a.csv"),
        label: "a.csv".into(),
        window_s: None,
        unit: None,
        columns: experiment.recordings.calibration[0].columns.clone(),
        recorded: RecordedAs::default(),
    };
    let in_counts = RecordedAs { counts_per_revolution: Some(vec![4096.0]), ..RecordedAs::default() };
    let refused = model.rollout_file(Source { recorded: in_counts, ..source.clone() }).unwrap_err();
    assert!(refused.to_string().contains("commands"), "{refused}");
    let (predicted, _) = model.rollout_file(source.clone()).unwrap();
    assert_eq!(predicted, file_of(&outcome, "rollout_a.csv"));
    assert!(!outcome.findings, "{}", outcome.text);

    // In degrees positions and commands are those of a motion that is smaller by that factor.
    let numbers = |file: &[u8]| -> Vec<f64> {
        let text = String::from_utf8(file.to_vec()).unwrap();
        text.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect()
    };
    let in_degrees = RecordedAs { angle: Some(AngleUnit::Degree), ..RecordedAs::default() };
    let (small, _) = model.rollout_file(Source { recorded: in_degrees, ..source }).unwrap();
    let pairs = numbers(&small).into_iter().zip(numbers(&predicted));
    assert!(pairs.into_iter().all(|(small, whole)| (small - whole.to_radians()).abs() < 1e-12));

    // A window on the way starts where the robot was, as fast as it was; a model without estimates is judged as it is.
    let window = "window_s = [5.0, 9.0] }]\n";
    let text = EXPERIMENT.trim_end().trim_end_matches(" }]").to_owned() + ", " + window;
    let text = text.replace(r#"["back_emf_nm_s_per_rad", "delay_s", "coulomb_nm"]"#, "[]");
    let text = text.replace("back_emf_nm_s_per_rad = 0.5", "back_emf_nm_s_per_rad = 0.4");
    let text =
        text.replace("delay_s = 0.02", "delay_s = 0.035").replace("coulomb_nm = 0.1", "coulomb_nm = 0.3");
    let outcome = fit_drives(&read(folder, &text), &Progress::silent()).unwrap();
    assert!(outcome.json["held_out_rms"].as_f64().unwrap() < 3e-4, "{}", outcome.text);
    assert_eq!(String::from_utf8_lossy(file_of(&outcome, "rollout_b.csv")).lines().count(), 202);

    // Held-out recordings of a joint with other friction are no all-clear, however little it is.
    let recorded = fs::read(folder.join("b.csv")).unwrap();
    let held_out = |coulomb_nm: f64| {
        let mut arm = model.arm.clone();
        arm.joints[0].mechanics.coulomb_nm = coulomb_nm;
        write(&folder.join("b.csv"), &moved(&arm, &commands[1]), &commands[1]);
        let text = EXPERIMENT.replace("position_deviation_rad = 1e-3", "position_deviation_rad = 5e-3");
        diagnose_drives(&read(folder, &text), &[], &Progress::silent()).unwrap()
    };
    let (same, other) = (held_out(0.3), held_out(0.36));
    fs::write(folder.join("b.csv"), recorded).unwrap();
    assert_eq!(same.json["held_out"]["differ"], serde_json::json!([]), "{}", same.text);
    assert_eq!(other.json["held_out"]["differ"], serde_json::json!([0]), "{}", other.text);
    assert!(other.findings && other.text.contains("joint 0 is missed by"), "{}", other.text);

    // Rows that are fitted judge nothing; parts of one recording that do not overlap do.
    let parts = |fitted: &str, held_out: &str| {
        let text = EXPERIMENT.replace("\"a.csv\"", &format!("\"a.csv\", window_s = {fitted}"));
        let text = text.replace("\"b.csv\"", &format!("\"a.csv\", window_s = {held_out}"));
        let text = text.replace(r#"["back_emf_nm_s_per_rad", "delay_s", "coulomb_nm"]"#, "[]");
        fit_drives(&read(folder, &text), &Progress::silent()).map_err(|e| e.to_string())
    };
    for (fitted, held_out) in [("[0, 6]", "[0, 6]"), ("[0, 6]", "[5.9, 12]"), ("[2, 6]", "[0, 20]")] {
        let refused = parts(fitted, held_out).unwrap_err();
        assert!(refused.contains("rows of a.csv are listed fitted and held out"), "{refused}");
    }
    assert!(parts("[0, 6]", "[6, 12]").is_ok());

    // Commands that a slow host holds are told from those that are on the line between two rows, and short pieces are refused.
    let checked = check_drives(&experiment, &Progress::silent()).unwrap();
    assert_eq!(checked.json["command_of_recordings"], "hold", "{}", checked.text);
    assert!(!checked.findings, "{}", checked.text);
    let linear = EXPERIMENT.replace("[drive]", "[drive]\ncommand = \"linear\"");
    let checked = check_drives(&read(folder, &linear), &Progress::silent()).unwrap();
    assert!(checked.findings && checked.text.contains("write `command = \"hold\"`"), "{}", checked.text);
    let short = EXPERIMENT.replace("[drive]", "[drive]\npiece_s = 1e-9");
    let refused = fit_drives(&read(folder, &short), &Progress::silent()).unwrap_err().to_string();
    assert!(refused.contains("fewer than 10 rows"), "{refused}");

    // A file of earlier versions: K_e under its former name, commands on the line between two rows.
    let former = fs::read_to_string(&file).unwrap().replace("back_emf_nm_s_per_rad", "damping_nm_s_per_rad");
    let (before, after) = former.split_once("\"command\": \"hold\"").unwrap();
    fs::write(&file, before.trim_end().trim_end_matches(',').to_owned() + after).unwrap();
    let former = CalibratedDrive::read(&file).unwrap().unwrap().arm;
    assert_eq!(former.command, CommandSignal::Linear);
    assert_eq!(former.numbers(), model.arm.numbers());

    fs::write(&file, "{ \"drive_schema\": 7 }").unwrap();
    assert!(CalibratedDrive::read(&file).is_err());
    fs::write(&file, "{ \"kind\": \"rd_calibrated\" }").unwrap();
    assert!(CalibratedDrive::read(&file).unwrap().is_none());
}

/// A servo whose robot has dry friction and a delay that the experiment lacks: both are named, and the improved model goes to
/// MuJoCo.
#[test]
fn what_a_servo_lacks_is_named_and_exported() {
    let lacking = EXPERIMENT
        .replace("\"delay_s\", \"coulomb_nm\"", "\"rotor_inertia_kg_m2\"")
        .replace("delay_s = 0.02\ncoulomb_nm = 0.1", "delay_s = 0.0");
    let command = |phase: f64| -> Vec<f64> {
        let wave =
            |t: f64| 0.4 * (1.5 * t + phase).sin() + 0.1 * (5.5 * t).sin() + if t > 12.0 { 0.2 } else { 0.0 };
        (0..1200).map(|k| wave(f64::from(k) * 0.02)).collect()
    };
    let commands = [("a.csv", command(0.0)), ("b.csv", command(1.0))];
    let folder = folder_of([0, 1].map(|k| (commands[k].0, &commands[k].1[..])));
    let folder = folder.path();
    let experiment = read(folder, &lacking);
    let file = folder.join(DRIVE_FILE);
    let arm = servo(0.5, 0.04, 0.2);
    for (name, command) in &commands {
        write(&folder.join(name), &read_out(&moved(&arm, command)), command);
    }
    let outcome = diagnose_drives(&experiment, &[], &Progress::silent()).unwrap();
    assert!(outcome.findings, "{}", outcome.text);
    let missing: Vec<(&str, f64)> = outcome.json["structures"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|s| s["answer"] == "missing")
        .map(|s| (s["id"].as_str().unwrap(), s["numbers"][0]["value"].as_f64().unwrap()))
        .collect();
    for (id, truth) in [("coulomb", 0.2), ("time_delay", 0.04)] {
        let size = missing.iter().find(|m| m.0 == id).unwrap_or_else(|| panic!("{id}: {}", outcome.text)).1;
        assert!((size / truth - 1.0).abs() < 0.1, "{id}: {size}");
    }
    assert_eq!(missing.len(), 2, "{}", outcome.text);
    assert_eq!(outcome.json["verdict"], "named", "{}", outcome.text);

    // The next motion keeps to where the commands have been, and narrows what is wanted.
    let wanted = vec![DeviationGoal { parameter: "rotor_inertia_kg_m2".into(), std: 1e-4 }];
    let (limits, keep_out, diagnosis) = (None, Vec::new(), DiagnosisOptions::default());
    let options = NextOptions { diagnosis, limits, keep_out, wanted, duration_s: 8.0, draws: 12, seed: 1 };
    let registry = Registry::linked().unwrap();
    let plan = plan_next(&experiment, &registry, &options, &Progress::silent()).unwrap();
    let wide = plan.open.iter().find(|open| matches!(open.doubt, Doubt::Wide(..))).unwrap();
    let interval = wide.planned.interval.as_ref().unwrap();
    assert!(0.0 < interval.after && interval.after < interval.now, "{wide:?}");
    assert!(wide.planned.settled >= wide.generic.settled - 1e-4, "{wide:?}");
    let notes = plan.notes.join("\n");
    assert!(notes.contains("record this motion twice") && notes.contains("of the commands"), "{notes}");
    let all = || commands.iter().flat_map(|(_, command)| command);
    let range = [all().copied().fold(0.0, f64::min), all().copied().fold(0.0, f64::max)];
    let motion = plan.motion.unwrap().trajectory;
    motion
        .rows(50.0, |_, q, _, _| assert!(range[0] - 1e-6 < q[0] && q[0] < range[1] + 1e-6, "{q:?}"))
        .unwrap();

    // A window keeps the commands before it, of which nothing is simulated.
    let part = lacking.replace("file = \"b.csv\"", "file = \"b.csv\", window_s = [3.0, 24.0]");
    let of_part =
        diagnose_drives(&read(folder, &part), &["dead_band".to_owned()], &Progress::silent()).unwrap();
    assert_eq!(of_part.json["remainder"].as_array().unwrap().len(), 1, "{}", of_part.text);
    assert!(of_part.findings, "{}", of_part.text);
    fs::write(&file, file_of(&outcome, IMPROVED_DRIVE_FILE)).unwrap();
    let mut model = CalibratedDrive::read(&file).unwrap().unwrap();
    let exported = model.to_mjcf("servo").unwrap_err().to_string();
    assert!(exported.contains("mass"), "a robot without masses is no MuJoCo model: {exported}");
    model.arm.standard_parameters = vec![1e-3, 0.0, 0.0, 1e-3, 0.0, 1e-3, 0.0, 0.0, 0.0, 0.1];
    // Read back and simulated, the file moves as the model does, but for what it lacks.
    let differs = |model: &CalibratedDrive| -> f64 {
        let notes = model.to_mjcf("servo").unwrap().notes;
        let note = notes.iter().find(|note| note.contains("read back and simulated")).unwrap();
        note.rsplit(' ').next().unwrap().parse().unwrap()
    };
    assert!(differs(&model) < 0.01, "{}", differs(&model));
    model.arm.joints[0].mechanics.static_nm = 0.2;
    assert!(differs(&model) > 0.1, "{}", differs(&model));
    model.arm.joints[0].mechanics.static_nm = 0.0;
    model.arm.joints[0].mechanics.coulomb_per_load = 0.1;
    let exported = model.to_mjcf("servo").unwrap();
    let text = |k: usize| String::from_utf8(exported.files[k].1.clone()).unwrap();
    for part in ["delay=\"0.0", "frictionloss=\"0.", "armature=\"0.0", "gainprm=\"10.0\"", "of the load"] {
        assert!(text(0).contains(part), "{part}: {}", text(0));
    }
    assert!(text(1).contains("\"per_load\":0.1") && exported.lost.len() == 1, "{}", text(1));

    // What Isaac Lab cannot express is said with the error that it costs.
    let mechanics = &mut model.arm.joints[0].mechanics;
    (mechanics.static_nm, mechanics.coulomb_nm) = (0.05, 0.2);
    let exported = model.to_isaac("servo", Some(&experiment)).unwrap();
    let python = String::from_utf8(exported.files[0].1.clone()).unwrap();
    for part in
        ["\"friction\": 0.25", "\"dynamic_friction\": 0.2", "\"stiffness\": 10.0", "DelayedPDActuatorCfg("]
    {
        assert!(python.contains(part), "{part}: {python}");
    }
    let [load, speed, all] = &exported.lost[..] else { panic!("{:?}", exported.lost) };
    assert!(load.starts_with("coulomb_per_load_0 0.1000; held-out positions"), "{load}");
    assert!(speed.starts_with("stribeck_velocity_rad_s_0 0.0500"), "{speed}");
    assert!(all.contains("before") && all.contains("after"), "{all}");
    assert_eq!(model.to_isaac("servo", None).unwrap().lost.len(), 2);
}

#[test]
fn a_target_is_refused_and_not_passed_over() {
    let folder = folder_of([("a.csv", &[0.0]), ("b.csv", &[0.0])]);
    let text = EXPERIMENT.replace("[recordings]", "[recordings]\ntarget = [\"b.csv\"]");
    let refused = diagnose_drives(&read(folder.path(), &text), &[], &Progress::silent()).unwrap_err();
    assert!(refused.to_string().contains("b.csv is a target"), "{refused}");
}

/// Presence of files in the folder of public recordings.
fn has_data(folder: &str) -> bool {
    let data = std::env::var_os("AURT_DATA").map(std::path::PathBuf::from);
    let found = data.is_some_and(|data| data.join(folder).is_dir());
    if !found {
        println!("skipped: AURT_DATA names no folder with recordings in {folder}");
    }
    found
}

/// The published friction and offset are within two standard deviations, the mass within one percent: the model's misfit
/// (asymmetric friction) is larger than the noise.
#[test]
fn the_published_values_of_emps_are_found_by_output_error() {
    if !has_data("emps") {
        return;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/5-servo/emps.toml");
    let experiment = Experiment::read_with_drives(&path, &mut Registry::linked().unwrap()).unwrap();
    let outcome = fit_drives(&experiment, &Progress::silent()).unwrap();
    let of = |name: &str| {
        let numbers = outcome.json["numbers"].as_array().unwrap();
        let number = numbers.iter().find(|n| n["name"] == name).unwrap();
        [&number["value"], &number["deviation"]].map(|v| v.as_f64().unwrap())
    };
    // A torque on the joint has the sign opposite to the published offset.
    for (name, published) in
        [("viscous_nm_s_per_rad_0", 203.5034), ("coulomb_nm_0", 20.3935), ("torque_offset_nm_0", 3.1648)]
    {
        let [value, deviation] = of(name);
        assert!((value - published).abs() < 2.0 * deviation, "{name}: {value} ± {deviation}");
    }
    let [mass, _] = of("rotor_inertia_kg_m2_0");
    assert!((mass - 95.1089).abs() < 0.01 * 95.1089, "{mass}");
}

/// A held quadruped as one tree of twelve joints. Legs on a trunk at rest do not feel each other: one of them alone is rolled
/// out as in the tree.
#[test]
fn a_held_quadruped_is_one_tree() {
    if !has_data("go2") {
        return;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/6-quadruped/go2.toml");
    let text = fs::read_to_string(&path).unwrap();
    // The numbers of the description, simulated: the fit takes long in a debug build.
    let begin = text.find("estimate").unwrap();
    let text = text.replace(&text[begin..text.find("# Of the controller").unwrap()], "");
    let of = |text: &str| {
        let experiment = Experiment::parse(text, &path, &mut Registry::linked().unwrap()).unwrap();
        let json = fit_drives(&experiment, &Progress::silent()).unwrap().json;
        let held_out = &json["recordings"][1];
        assert_eq!(held_out["held_out"], true, "{json}");
        let rms: Vec<f64> = held_out["rms"].as_array().unwrap().iter().map(|r| r.as_f64().unwrap()).collect();
        rms
    };
    let tree = of(&text);
    assert_eq!(tree.len(), 12);
    assert!(tree.iter().all(|rms| *rms < 0.1), "{tree:?}");
    let leg = text.replace("base = \"base\"", "base = \"base\"\ntip = \"FR_calf\"");
    let leg = of(&leg.replace("[1, 12]", "[4, 6]").replace("[13, 24]", "[16, 18]"));
    assert!(leg.iter().zip(&tree[3..6]).all(|(a, b)| (a - b).abs() < 1e-9), "{leg:?} {tree:?}");
}

/// Currents and positions alone leave the scale of all torques open, and it is said; with the torque constant given, the
/// rest is determined, and larger by the same factor.
#[test]
fn currents_of_a_bench_leave_the_torque_constant_open() {
    if !has_data("dyno") {
        return;
    }
    const CONSTANT: &str = "torque_constant_nm_per_a";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/7-dyno/current.toml");
    let text = fs::read_to_string(&path).unwrap();
    let fitted = |text: &str| {
        let experiment = Experiment::parse(text, &path, &mut Registry::linked().unwrap()).unwrap();
        fit_drives(&experiment, &Progress::silent()).unwrap().json
    };
    let of = |json: &serde_json::Value, name: &str| {
        let numbers = json["numbers"].as_array().unwrap();
        let number = numbers.iter().find(|n| n["name"] == format!("{name}_0")).unwrap();
        [&number["value"], &number["deviation"]].map(|v| v.as_f64().unwrap())
    };
    let free = fitted(&text);
    let open = free["undetermined"][0].as_str().unwrap();
    let [constant, deviation] = of(&free, CONSTANT);
    assert!(open.contains(CONSTANT) && deviation > 0.5 * constant, "{open}: {constant} ± {deviation}");
    // A deviation that is stated counts for a constant that is given, too.
    let given = text.replacen(&format!("\"{CONSTANT}\", "), "", 1);
    let given = given.replacen(&format!("[drive.deviations]\n{CONSTANT} = 0.1\n"), "[drive.deviations]\n", 1);
    let given =
        fitted(&given.replacen(&format!("{CONSTANT} = 0.1\n"), &format!("{CONSTANT} = 0.10952\n"), 1));
    assert_eq!(given["undetermined"].as_array().unwrap().len(), 0, "{given}");
    for name in ["rotor_inertia_kg_m2", "viscous_nm_s_per_rad", "coulomb_nm"] {
        assert!(open.contains(name), "{name} is as open as the torque constant: {open}");
        let [value, deviation] = of(&given, name);
        assert!(deviation < 0.05 * value, "{name}: {value} ± {deviation}");
        let scale = value / of(&free, name)[0] * constant / 0.10952;
        assert!((scale - 1.0).abs() < 0.02, "{name}: {scale}");
    }
}
