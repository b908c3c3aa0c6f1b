//! `aurt sweep` as a person, a queue or a power cut meets it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::Folder;

/// The demo's recordings with this `[sweep]` in place of the demo's own choice of friction.
fn experiment(sweep: &str) -> Folder {
    let folder = Folder::new().with_demo(&["mdh.csv", "exciting_motion.csv", "other_motion.csv"]);
    folder.write(
        "experiment.toml",
        &format!(
            r#"
schema = 1
[robot]
mdh = "mdh.csv"
gravity_m_s2 = [0.0, 0.0, -9.81]
torque_constants_nm_per_a = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
[joint_dynamics]
coulomb = {{ model = "constant" }}
hysteresis = {{ model = "sign" }}
viscous = {{ model = "polynomial", powers = [1] }}
[recordings]
calibration = ["exciting_motion.csv"]
validation = ["other_motion.csv"]
[preprocess]
f_dyn_hz = 5.0
{sweep}"#
        ),
    );
    folder
}

const FEW: &str = "[sweep.grid]\n\"joint_dynamics.coulomb.model\" = [\"none\", \"square\", \"absolute\"]\n";

/// Every file below a folder with its contents, but for the lock.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().unwrap() != "lock" {
                found.push((path.strip_prefix(folder).unwrap().to_owned(), fs::read(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn keys_and_values_that_cannot_be_are_underlined() {
    let folder = experiment(
        "[sweep.grid]\n\"joint_dynamics.coulomb.modell\" = [\"none\"]\n\"preprocess.f_dyn_hz\" = [5, -1]\n",
    );
    let said = folder.run("sweep run experiment.toml --out out").refused(&[
        "`modell`",
        "did you mean `model`",
        "f_dyn_hz",
    ]);
    assert!(said.contains("experiment.toml:17:1]") && said.contains("experiment.toml:18:29]"), "{said}");
    assert!(!folder.path("out").exists());
}

#[test]
fn a_point_that_fails_is_recorded_and_the_others_go_on() {
    // The position filter of the second point is above half the sampling rate.
    let folder = experiment("[sweep.grid]\n\"preprocess.f_dyn_hz\" = [5.0, 2000.0, 2.5]\n");
    let run = folder.run("sweep run experiment.toml --out out");
    let said = run.stdout();
    assert_eq!(run.status(), 1, "{said}");
    assert!(said.contains("points that failed") && said.contains("f_dyn_hz can be at most"), "{said}");
    let table = folder.json("out/table.json");
    assert_eq!(table["ranked"].as_array().unwrap().len(), 2);
    assert_eq!(table["failed"][0]["number"], 2);
    assert_eq!(folder.read("out/table.csv").lines().count(), 4);
    // It is not tried again until something changes that it depends on.
    let again = folder.run("sweep run experiment.toml --out out").found();
    assert!(again.stdout().contains("0 points run"), "{}", again.stdout());
    assert_eq!(folder.run("sweep point 1 2 --out out").status(), 1);
    folder.run("sweep point 4 --out out").refused(&["there is no point 4", "points 1 to 3"]);
}

/// An `sbatch` that runs the elements of the array one after the other, except those that a file names.
const SBATCH: &str = include_str!("files/sbatch.sh");

#[test]
#[cfg(unix)]
fn slurm_is_given_what_has_no_result_yet() {
    use std::os::unix::fs::PermissionsExt;

    let folder = experiment(FEW);
    folder.run("sweep run experiment.toml --out here").succeeded();
    let submit = || {
        Command::new(env!("CARGO_BIN_EXE_aurt"))
            .args(
                "sweep run experiment.toml --out out --engine slurm --slurm-arg=--partition=short".split(' '),
            )
            .current_dir(folder.path(""))
            .env("PATH", format!("{}:/usr/bin:/bin", folder.path("bin").display()))
            .output()
            .unwrap()
    };
    let said = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    if Command::new("/usr/bin/sbatch").arg("--version").output().is_err() {
        let refused = submit();
        assert_eq!(refused.status.code(), Some(2));
        assert!(said(&refused.stderr).contains("sbatch cannot be run"), "{}", said(&refused.stderr));
    }
    fs::create_dir(folder.path("bin")).unwrap();
    let sbatch = folder.write("bin/sbatch", SBATCH);
    fs::set_permissions(&sbatch, fs::Permissions::from_mode(0o755)).unwrap();
    folder.write("bin/lost", "2\n");

    let first = said(&submit().stdout);
    assert!(first.contains("3 of 3 points submitted as job array 41\n"), "{first}");
    let asked = folder.read("bin/asked");
    assert!(asked.contains("--array=1-3 ") && asked.contains(" --partition=short --wrap"), "{asked}");
    let collected = folder.run("sweep collect --out out").found();
    assert!(collected.stdout().contains("points without a result\n  2\n"), "{}", collected.stdout());

    folder.write("bin/lost", "");
    let second = said(&submit().stdout);
    assert!(second.contains("1 of 3 points submitted"), "{second}");
    folder.run("sweep collect --out out").succeeded();
    assert!(said(&submit().stdout).contains("every point has its result already"));
    fs::remove_dir(folder.path("out/slurm")).unwrap();
    assert!(contents(&folder.path("out")) == contents(&folder.path("here")), "the folders differ");
}
