//! `aurt explain` has a page for every key of an experiment.

use std::collections::BTreeSet;

use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_report::glossary::term;

/// Every table of an experiment, each with a key that it does not have.
const TABLES: [&str; 2] = [
    r#"
zzz = 0
schema = 1
[robot]
zzz = 0
mdh = "mdh.csv"
gravity_m_s2 = [0, 0, -9.81]
[joint_dynamics]
zzz = 0
coulomb    = { model = "square" }
hysteresis = { model = "sign" }
viscous    = { model = "polynomial", powers = [1] }
[[joint_dynamics.override]]
zzz = 0
joints = [1]
[[arm_terms]]
model = "rotor_inertia"
[instrument]
zzz = 0
[recordings]
zzz = 0
calibration = [{ file = "a.csv", zzz = 0, columns = { zzz = 0, time = 0, position = [1, 2] } }]
[preprocess]
zzz = 0
f_dyn_hz = 5.0
[calibration]
zzz = 0
[plugins]
zzz = 0
"#,
    r#"
schema = 1
[robot]
mdh = "mdh.csv"
gravity_m_s2 = [0, 0, -9.81]
[recordings]
calibration = ["a.csv"]
[drive]
zzz = 0
model = "pd_law"
"#,
];

/// The keys that the reader names where it does not know one.
fn known_keys(text: &str) -> BTreeSet<String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("mdh.csv", "alpha,a,d\n0,0.5,0\n0,0.4,0\n"), ("a.csv", "")] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("experiment.toml");
    let errors = Experiment::parse(text, &path, &mut Registry::linked().unwrap()).unwrap_err();
    let helps = errors.problems.iter().filter_map(|problem| problem.help.as_ref());
    let listed: Vec<&str> = helps.filter_map(|help| Some(help.split_once("known keys: ")?.1)).collect();
    assert_eq!(listed.len(), text.matches("zzz = 0").count(), "{errors}");
    listed.iter().flat_map(|keys| keys.split(", ")).map(|key| key.trim_matches('`').to_owned()).collect()
}

#[test]
fn every_key_is_explained() {
    let numbers = aurt_friction::drives::listings();
    let mechanics = aurt_calibration::drives::Mechanics::default().numbers();
    let of_drives = numbers.iter().flat_map(|listing| listing.drive.parameters()).chain(mechanics);
    let of_drives: BTreeSet<String> = of_drives.map(|number| number.parameter.name).collect();
    let keys: BTreeSet<String> = TABLES.into_iter().flat_map(known_keys).collect();
    assert!(keys.len() > 50, "{keys:?}");
    let unexplained: Vec<&String> =
        keys.iter().filter(|key| term(key).is_none() && !of_drives.contains(*key)).collect();
    assert_eq!(unexplained, [""; 0], "keys without a page of `aurt explain`");
}
