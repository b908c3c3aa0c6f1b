//! A small robot with one file of every kind.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::subject::aurt;

const EXPERIMENT: &str = include_str!("experiment.toml");
const SWEEP: &str = "[sweep.grid]\n\"joint_dynamics.coulomb.model\" = [\"none\", \"square\"]\n";
const SCENARIO: &str = "robot = \"two_link\"\nseed = 7\n[motion]\nkind = \"multi_sine\"\nduration_s = 3.0\nharmonics = 5\n\
                        top_hz = 0.8\nshare = 0.5\n[logger]\nrate_hz = 100\n[[effect]]\nname = \"current_offset\"\njoints = [1]\n\
                        offset_nm = [3.0]\n";
const PLAN: &str = "[recordings]\n[nulls]\nrobots = [\"two_link\"]\ncount = 0\n";
const LIMITS: &str = "lower_rad,upper_rad,velocity_rad_s,acceleration_rad_s2\n-3,3,1,3\n-3,3,1,3\n";

pub struct Bench {
    folder: TempDir,
}

impl Bench {
    pub fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        for (name, text) in [
            ("mdh.csv", "alpha,a,d\n0,0.5,0\n0,0,0\n".to_owned()),
            ("experiment.toml", EXPERIMENT.to_owned()),
            ("sweep.toml", format!("{EXPERIMENT}{SWEEP}")),
            ("scenario.toml", SCENARIO.to_owned()),
            ("plan.toml", PLAN.to_owned()),
            ("limits.csv", LIMITS.to_owned()),
            ("a.csv", recording(0.0)),
            ("b.csv", recording(1.0)),
            ("library.so", "\u{7f}ELF".to_owned()),
        ] {
            fs::write(bench.path().join(name), text).unwrap();
        }
        // The same recording in each format that is no text, as the tests of the readers have it.
        let formats = Path::new(env!("CARGO_MANIFEST_DIR")).join("../aurt-recording/tests/formats");
        for (source, name) in [
            ("compressed.npz", "log.npz"),
            ("version_7.mat", "log.mat"),
            ("zstd.mcap", "log.mcap"),
            ("zstd.parquet", "log.parquet"),
        ] {
            fs::copy(formats.join(source), bench.path().join(name)).unwrap();
        }
        for line in ["run experiment.toml --out ran", "sweep run sweep.toml --out swept"] {
            let output =
                Command::new(aurt()).args(line.split(' ')).current_dir(bench.path()).output().unwrap();
            assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        }
        fs::rename(bench.path().join("ran/rd_calibrated.json"), bench.path().join("model.json")).unwrap();
        fs::remove_dir_all(bench.path().join("ran")).unwrap();
        bench.settle();
        bench
    }

    /// Takes the place of the experiment out of the plan, which is another one in every run: the same seed has to do the
    /// same damage. Hashes differ between programs as well, but no number is sought in them.
    fn settle(&self) {
        let plan = self.path().join("swept/sweep.json");
        let text = fs::read_to_string(&plan).unwrap();
        let place = self.path().canonicalize().unwrap();
        let settled = text.replace(place.to_str().unwrap(), "/bench");
        assert!(settled != text, "the plan names its experiment");
        fs::write(plan, settled).unwrap();
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    pub fn copy(&self) -> TempDir {
        let copy = tempfile::tempdir().unwrap();
        copy_into(self.path(), copy.path());
        copy
    }
}

fn copy_into(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap() {
        let path: PathBuf = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            fs::create_dir(&target).unwrap();
            copy_into(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}

/// Ten seconds of two joints whose torques are those of some inertia, gravity and friction.
fn recording(phase: f64) -> String {
    let mut text = String::from("time,q_0,q_1,tau_0,tau_1\n");
    for k in 0..1000 {
        let t = f64::from(k) / 100.0;
        let angle = |j: f64| {
            let (w, p) = (1.3 + 0.8 * j, phase + j);
            let (s, c) = ((w * t + p).sin(), (w * t + p).cos());
            (s + 0.3 * (2.3 * t).sin(), w * c + 0.69 * (2.3 * t).cos(), -w * w * s - 1.587 * (2.3 * t).sin())
        };
        let ((q0, v0, a0), (q1, v1, a1)) = (angle(0.0), angle(1.0));
        let tau1 = 0.4 * (a0 + a1) + 2.0 * (q0 + q1).cos() + 0.5 * v1 + 0.7 * v1.signum();
        let tau0 = tau1 + 1.1 * a0 + 6.0 * q0.cos() + 0.9 * v0 + v0.signum();
        let _ = writeln!(text, "{t:.3},{q0:.6},{q1:.6},{tau0:.6},{tau1:.6}");
    }
    text
}
