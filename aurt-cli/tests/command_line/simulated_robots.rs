//! Diagnoses of simulated robots of which `init` knows the geometry alone.

use serde_json::{Value, json};

use crate::support::Folder;

/// A recording of a UR10e that moves in sines up to a frequency, through a share of its range.
fn simulated(folder: &Folder, name: &str, seed: u32, [rate_hz, top_hz, share]: [f64; 3], effect: &str) {
    let scenario = format!(
        "robot = 'ur10e'\nseed = {seed}\n[motion]\nkind = 'multi_sine'\nduration_s = 40.0\nharmonics = 6\ntop_hz = {top_hz}\n\
         share = {share}\n[logger]\nrate_hz = {rate_hz}\n{effect}"
    );
    folder.write("scenario.toml", &scenario);
    folder.run(format!("simulate --scenario scenario.toml --out {name}.csv --quiet")).succeeded();
}

const CONSTANTS: &str = "--torque-constants 11.976 11.976 9.839 10.763 10.763 10.763";

/// An elastic gear of joint 1.
fn gear_of(stiffness_nm_rad: f64) -> String {
    format!(
        "[[effect]]\nname = 'joint_elasticity'\njoints = [1]\nstiffness_nm_rad = [{stiffness_nm_rad:.1}]\ndamping_nm_s = [60.0]\n"
    )
}

/// One calibration recording does not tell by how much friction differs from day to day; two that agree do.
#[test]
fn friction_of_another_day_is_no_change() {
    let folder = Folder::new();
    let more = |share: f64| {
        format!(
            "[[effect]]\nname = 'friction_level_changed'\njoints = [1, 2]\ncoulomb_change = [{share}, {share}]\n\
             viscous_change = [{share}, {share}]\n"
        )
    };
    let recordings = [
        ("one", 1, String::new()),
        ("two", 4, String::new()),
        ("little", 2, more(0.05)),
        ("much", 3, more(0.4)),
    ];
    for (name, seed, effect) in recordings {
        simulated(&folder, name, seed, [100.0, 0.3, 0.7], &effect);
    }
    let headline = |calibration: &str, target: &str| {
        let experiment = format!("{target}-{}.toml", calibration.len());
        let init = format!("init {calibration} --target {target}.csv --robot ur10e --out {experiment}");
        folder.run(format!("{init} {CONSTANTS}")).succeeded();
        folder.run(format!("diagnose {experiment} --out out")).stdout().replace('\n', " ")
    };
    let usual = headline("one.csv", "little");
    assert!(
        usual.starts_with("nothing has changed by more than recordings of an unchanged robot"),
        "{usual}"
    );
    for (calibration, target) in [("one.csv two.csv", "little"), ("one.csv", "much")] {
        let changed = headline(calibration, target);
        assert!(changed.starts_with("changed since calibration: "), "{changed}");
        assert!(changed.split(';').next().is_some_and(|change| change.contains("friction")), "{changed}");
    }
}

/// Noise of the accelerations is multiplied by what the arm carries: on coarse encoders nothing but noise is left beside a load.
#[test]
fn noise_grows_with_a_load() {
    let folder = Folder::new();
    let load = "[[effect]]\nname = 'payload'\nlink = 5\nmass_kg = 8.0\ncom_m = [0.0, 0.05, 0.12]\nedges_m = [0.2, 0.2, 0.2]\n";
    for (seed, effect) in [(1, ""), (2, ""), (3, load), (4, load)] {
        let coarse = format!("position_decimals = 3\n{effect}");
        simulated(&folder, &seed.to_string(), seed, [200.0, 0.6, 0.7], &coarse);
    }
    let init = "init 1.csv 2.csv --target 3.csv --validation 4.csv --robot ur10e --out experiment.toml";
    folder.run(format!("{init} {CONSTANTS}")).succeeded();
    let said = folder.run("diagnose experiment.toml --out out").stdout();
    assert!(said.starts_with("changed since calibration: a payload of "), "{said}");
    assert!(!said.contains("× noise"), "{said}");
    // A given model carries it as well; what its held-out recording has of the load is a finding of the run.
    let rotors = "[[arm_terms]]\nmodel = 'rotor_inertia'\njoints = [0, 1, 2, 3, 4, 5]\n[recordings]";
    folder.write("given.toml", &folder.read("experiment.toml").replacen("[recordings]", rotors, 1));
    folder.run("run given.toml --out given").found();
    let said = folder.run("diagnose given.toml --model given/rd_calibrated.json --out out_given").stdout();
    let headline = said.split("\nchanged in the target:").next().unwrap().replace('\n', " ");
    assert!(headline.starts_with("changed since calibration: a payload of "), "{said}");
    assert!(!headline.contains(" and ") && !said.contains("× noise"), "{said}");
}

/// A sensor that takes up 6 % of its neighbour's torque since calibration: known laws resemble parts of it.
#[test]
fn a_change_without_a_law_has_no_name() {
    let folder = Folder::new();
    for seed in 1..=4 {
        simulated(&folder, &seed.to_string(), seed, [100.0, 0.3, 0.7], "");
    }
    for name in ["3.csv", "4.csv"] {
        let table = folder.read(name);
        let columns: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let place = |joint| columns.iter().position(|c| *c == format!("actual_current_{joint}")).unwrap();
        let [from, to] = [1, 2].map(place);
        let mixed = |line: &str| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            let [own, other] = [to, from].map(|at| cells[at].parse::<f64>());
            if let (Ok(own), Ok(other)) = (own, other) {
                cells[to] = (own + 0.06 * other).to_string();
            }
            cells.join(",") + "\n"
        };
        folder.write(name, &table.lines().map(mixed).collect::<String>());
    }
    let init = "init 1.csv 2.csv --target 3.csv --validation 4.csv --robot ur10e --out experiment.toml";
    folder.run(format!("{init} {CONSTANTS}")).succeeded();
    let headline = folder.run("diagnose experiment.toml --out out").stdout().replace('\n', " ");
    assert!(
        headline.starts_with("something has changed in the target that no known effect explains;"),
        "{headline}"
    );
    let verdict = folder.json("out/verdict.json");
    let changes =
        verdict["effects"].as_array().unwrap().iter().filter(|e| e["present_in"] == json!(["target"]));
    assert_eq!(changes.count(), 0, "{verdict}");
}

/// The folder of a diagnosis of three recordings up to a frequency, through a share of the range, with an elastic gear; the gear that is
/// claimed; and its stiffness with its deviation.
fn diagnosed_gear(stiffness_nm_rad: f64, motion: [f64; 3]) -> (Folder, Value, [f64; 2]) {
    let folder = Folder::new();
    for seed in 1..=3 {
        simulated(&folder, &seed.to_string(), seed, motion, &gear_of(stiffness_nm_rad));
    }
    let init = "init 1.csv 2.csv --validation 3.csv --robot ur10e --out experiment.toml";
    folder.run(format!("{init} {CONSTANTS}")).succeeded();
    folder.run("diagnose experiment.toml --out out");
    let verdict = folder.json("out/verdict.json");
    let gears = verdict["effects"].as_array().unwrap().iter().filter(|e| e["effect"] == "joint_elasticity");
    let [gear] = &gears.collect::<Vec<_>>()[..] else { panic!("{verdict}") };
    assert_eq!(gear["joints"], json!([1]), "{gear}");
    let gear = (*gear).clone();
    let stiffness = ["value", "std"].map(|key| gear["parameters"]["stiffness_nm_rad"][key].as_f64().unwrap());
    (folder, gear, stiffness)
}

/// The link's ring, beside the rotors that the model lacks as well.
#[test]
fn a_soft_gear_is_found_with_its_stiffness() {
    let (_, gear, [value, std]) = diagnosed_gear(6000.0, [100.0, 0.5, 0.6]);
    assert!((value - 6000.0).abs() < 2.0 * std && std < 0.35 * value, "{gear}");
    assert!(gear["parameters"]["frequency_hz"]["value"].as_f64().is_some(), "{gear}");
}

/// Slow motion tells a soft gear by the pose in which the link hangs: no resonance rings.
#[test]
fn a_gear_that_gives_way_shows_in_slow_motion() {
    let (folder, gear, [value, std]) = diagnosed_gear(4000.0, [125.0, 0.15, 0.7]);
    assert!((value - 4000.0).abs() < 3.0 * std && std < 0.15 * value, "{gear}");
    assert!(folder.read("out/improved.toml").contains("joint_compliance"));
    let indications = folder.json("out/verdict.json")["indications"].to_string();
    assert!(!indications.contains("\"joints\":[1],\"present_in\""), "{indications}");
}
