//! `aurt gains`: torque constants of the demo's drives, from its unloaded recordings and those with a load of 2 kg.

use crate::support::{Folder, numbers, real_recordings, without_constants};

const CONSTANTS: [f64; 6] = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763];
const TERM: &str = "[[arm_terms]]\nmodel = \"payload\"\nlink = 5\nrecordings = [\"later_motion.csv\", \"later_other_motion.csv\"]\n";

/// The demo without torque constants, with a load on its later recordings.
fn loaded(term: &str, stated: bool) -> Folder {
    let folder = Folder::new().with_whole_demo().with_demo(&["later_motion.csv", "later_other_motion.csv"]);
    let text = folder
        .read("experiment.toml")
        .replace(
            "calibration = [\"exciting_motion.csv\"]",
            "calibration = [\"exciting_motion.csv\", \"other_motion.csv\", \"later_motion.csv\", \"later_other_motion.csv\"]",
        )
        .replace("\nvalidation = [\"other_motion.csv\", \"point_to_point.csv\"]", "")
        .replace("[recordings]", &format!("{term}\n[recordings]"));
    folder.write("loaded.toml", &if stated { text } else { without_constants(&text) });
    folder
}

#[test]
fn constants_come_from_a_known_load() {
    for stated in [false, true] {
        let folder = loaded(TERM, stated);
        let run = folder.run("gains loaded.toml --mass-kg 2 --out gains").succeeded();
        assert!(run.stdout().contains("torque_constants_nm_per_a = ["), "{}", run.stdout());
        let found = folder.json("gains/gains.json");
        for (constant, truth) in numbers(&found["torque_constants_nm_per_a"]).into_iter().zip(CONSTANTS) {
            assert!((constant / truth - 1.0).abs() < 0.1, "{constant} {truth}");
        }
        let scale = |j: usize| if stated { CONSTANTS[j] } else { 1.0 };
        for (j, gain) in found["gains"]["joints"].as_array().unwrap().iter().enumerate() {
            assert_eq!(gain["decided"], "gain");
            let [value, deviation] = ["value", "std_dev"].map(|key| scale(j) * gain[key].as_f64().unwrap());
            assert!((value - CONSTANTS[j]).abs() < 4.0 * deviation, "{j}: {value} ± {deviation}");
        }
        // What is written into the experiment calibrates in Nm.
        let constants = found["torque_constants_nm_per_a"].to_string();
        let with = without_constants(&folder.read("loaded.toml")).replace(
            "[joint_dynamics]",
            &format!("torque_constants_nm_per_a = {constants}\n[joint_dynamics]"),
        );
        folder.write("with.toml", &with);
        folder.run("run with.toml --out results").succeeded();
        let mass = folder.read("results/calibrated_parameters.csv");
        let mass = mass.lines().find(|l| l.starts_with("payload.m_5")).unwrap().split(',').nth(1).unwrap();
        assert!((mass.parse::<f64>().unwrap() - 2.0).abs() < 0.05, "{mass}");
    }
}

#[test]
fn without_a_mass_there_are_ratios_and_expectations_come_first() {
    let folder = loaded(TERM, false);
    let ratios = folder.run("gains loaded.toml --json").succeeded().stdout();
    let found: serde_json::Value = serde_json::from_str(&ratios).unwrap();
    assert!(found["torque_constants_nm_per_a"].is_null(), "{found}");
    let reference = found["gains"]["reference"].as_u64().unwrap() as usize;
    for (j, gain) in found["gains"]["joints"].as_array().unwrap().iter().enumerate() {
        assert_eq!((&gain["decided"], gain["std_dev"].is_null()), (&"ratio".into(), true));
        let expected = CONSTANTS[j] / CONSTANTS[reference];
        assert!((gain["ratio"].as_f64().unwrap() / expected - 1.0).abs() < 0.1, "{gain}");
    }
    let said = folder.run("gains loaded.toml").succeeded().stdout();
    assert!(said.contains("ratios only") && said.contains("not determined"), "{said}");
    let said = folder.run("gains loaded.toml --mass-kg 2 --expect").succeeded().stdout();
    assert!(said.contains("what these recordings determine") && said.contains("± "), "{said}");
    assert!(!said.contains("torque_constants_nm_per_a"), "{said}");
}

#[test]
fn loads_that_tell_nothing_are_refused() {
    let folder = loaded(TERM, false);
    let refused = |folder: &Folder, arguments: &[&str], words: &[&str]| {
        folder.aurt(["gains", "loaded.toml"].iter().chain(arguments)).refused(words);
    };
    refused(&folder, &["--mass-kg", "0"], &["--mass-kg", "above zero"]);
    refused(&folder, &["--mass-kg", "-2"], &["--mass-kg"]);
    refused(&folder, &["--mass-kg", "2", "--mass-std-kg", "-1"], &["below zero"]);
    refused(&folder, &["--mass-std-kg", "1"], &["--mass-kg"]);
    refused(&folder, &["--mass-kg", "2", "--centre-of-mass-m", "0", "1"], &["three numbers"]);
    let always = loaded("[[arm_terms]]\nmodel = \"payload\"\nlink = 5\n", false);
    refused(&always, &["--mass-kg", "2"], &["all recordings", "without it"]);
    refused(&loaded("", false), &["--mass-kg", "2"], &["0 loads", "payload"]);
    let light = loaded(&TERM.replace("link = 5", "link = 5\nparameters = [\"m\"]"), false);
    refused(&light, &["--mass-kg", "2", "--centre-of-mass-m", "0", "0", "0.1"], &["mX, mY and mZ"]);
}

/// The UR10e's constants against those that its controller uses.
#[test]
fn the_gains_of_a_real_robot_are_those_of_its_controller() {
    let Some(data) = real_recordings("the gains of a real robot") else { return };
    let folder = Folder::new();
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/ur10e_gains.toml");
    let text = std::fs::read_to_string(example).unwrap().replace("${AURT_DATA}", data.to_str().unwrap());
    folder.write("ur10e.toml", &text);
    folder.run("gains ur10e.toml --mass-kg 2.805 --out gains").succeeded();
    let found = folder.json("gains/gains.json");
    let constants = numbers(&found["torque_constants_nm_per_a"]);
    for (j, (constant, stated)) in constants.iter().zip(CONSTANTS).enumerate() {
        let deviation = found["gains"]["joints"][j]["std_dev"].as_f64().unwrap();
        assert!((constant / stated - 1.0).abs() < 0.15, "{j}: {constant} ± {deviation}, stated {stated}");
    }
}
