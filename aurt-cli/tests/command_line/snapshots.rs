//! What a person reads, whole: a change of wording shows as a change of a file in `snapshots/`.
//!
//! `INSTA_UPDATE=always cargo test -p aurt-cli snapshots` writes the files anew. Numbers are those of the baseline
//! instruction set, which are the same on every machine.

use insta::assert_snapshot;

use crate::support::{Folder, Run, with_table};

const BASELINE: [(&str, &str); 3] = [("AURT_SIMD", "baseline"), ("NO_COLOR", "1"), ("COLUMNS", "100")];

impl Folder {
    fn read_by_a_person(&self, command: &str) -> Run {
        self.aurt_with(BASELINE, command.split(' '))
    }
}

#[test]
fn mistakes_in_an_experiment() {
    let folder = Folder::new().with_demo(&["mdh.csv", "experiment.toml", "exciting_motion.csv"]);
    let toml = folder
        .read("experiment.toml")
        .replace("model = \"absolute\"", "model = \"absolut\"")
        .replace("f_dyn_hz", "fdyn_hz")
        .replace("-9.81]", "-9.81, 0.0]");
    folder.write("experiment.toml", &toml);
    let said = folder.read_by_a_person("run experiment.toml --out out").refused(&[]);
    assert_snapshot!(said);
}

#[test]
fn a_damaged_recording() {
    let folder = Folder::new().with_whole_demo();
    folder.edit("exciting_motion.csv", |text| text.replacen("0.012", "0,012", 1));
    let said = folder.read_by_a_person("run experiment.toml --out out").refused(&[]);
    assert_snapshot!(said);
}

#[test]
fn what_a_calibration_prints() {
    let folder = Folder::new();
    folder.read_by_a_person("demo --out demo --quiet").succeeded();
    let said = folder.read_by_a_person("run demo/experiment.toml --out out").succeeded().stdout();
    assert_snapshot!(said);
}

#[test]
fn what_a_diagnosis_prints() {
    let folder = Folder::new();
    folder.read_by_a_person("demo --out demo --quiet").succeeded();
    folder.edit("demo/experiment.toml", |text| with_table(text, "[[arm_terms]]", ""));
    let run = folder.read_by_a_person("diagnose demo/experiment.toml --out diagnosis").found();
    assert_snapshot!(run.stdout());
}

#[test]
fn an_explanation() {
    let folder = Folder::new();
    assert_snapshot!(folder.read_by_a_person("explain stribeck").succeeded().stdout());
}
