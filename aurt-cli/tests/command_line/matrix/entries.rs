//! Ways to hand recordings to commands.

/// A way to hand recordings to a command: commands and arguments that it stands for, as their help names them; its command lines; what
/// comes out (`file`, or `file#/place` in a JSON document); what of it is the same, by parts of its keys, if the recordings are cut.
pub struct Entry {
    pub takes: &'static [&'static str],
    pub lines: &'static [&'static str],
    pub results: &'static [&'static str],
    pub in_part: &'static [&'static str],
    /// Whether it knows the robot with its head.
    pub knows_head: bool,
}

pub const ENTRIES: [Entry; 18] = [
    Entry {
        takes: &["run EXPERIMENT.toml"],
        lines: &["run experiment.toml --out results"],
        results: &["results/predicted_tuesday.csv", "results/calibrated_parameters.csv"],
        in_part: &["predicted_", " value"],
        knows_head: true,
    },
    Entry {
        takes: &["run EXPERIMENT.toml"],
        lines: &["run experiment.toml --out results --stream-above 1kB"],
        results: &["results/calibrated_parameters.csv"],
        in_part: &[" value"],
        knows_head: true,
    },
    Entry {
        takes: &["check RECORDING|EXPERIMENT.toml"],
        lines: &["check experiment.toml --json >check.json"],
        results: &["check.json#/recordings/0/joints", "check.json#/recordings/0/unit"],
        in_part: &["unit"],
        knows_head: true,
    },
    Entry {
        takes: &["check RECORDING|EXPERIMENT.toml"],
        lines: &[
            "check monday.csv --mdh mdh.csv --gravity 0 -9.81 0 --joint-names shoulder,elbow --json >check.json",
        ],
        results: &["check.json#/joints", "check.json#/unit"],
        in_part: &["unit"],
        knows_head: false,
    },
    Entry {
        takes: &["init RECORDING"],
        lines: &["init monday.csv --robot arm.urdf --tip fore --gravity 0 -9.81 0 --out first.toml"],
        results: &["first.toml#/robot", "first.toml#/joint_dynamics", "first.toml#/preprocess"],
        // A shorter recording asks for a wider band.
        in_part: &["robot", "joint_dynamics"],
        knows_head: true,
    },
    Entry {
        takes: &["compile-rd EXPERIMENT.toml"],
        lines: &["compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd_2.json"],
        results: &["rd_2.json"],
        in_part: &[""],
        knows_head: false,
    },
    Entry {
        takes: &["calibrate RECORDING"],
        lines: &[
            "calibrate --model rd.json --data monday.csv tuesday.csv --out-params p.csv --out-calibrated-model c.json",
        ],
        results: &["p.csv"],
        in_part: &[" value"],
        knows_head: false,
    },
    Entry {
        takes: &["calibrate-validate RECORDING"],
        lines: &[
            "calibrate-validate --model rd.json --data monday.csv --calibration-data-rel 0.6 --out-params p.csv \
                  --out-calibrated-model c.json --out-prediction q.csv",
        ],
        results: &["p.csv", "q.csv"],
        in_part: &[" value", "predicted_"],
        knows_head: false,
    },
    Entry {
        takes: &["predict RECORDING"],
        lines: &["predict --model model.json --data tuesday.csv --out q.csv"],
        results: &["q.csv"],
        in_part: &["predicted_"],
        knows_head: true,
    },
    Entry {
        takes: &["diagnose EXPERIMENT.toml"],
        lines: &["diagnose experiment.toml --out diagnosis"],
        results: &["diagnosis/verdict.json#/effects", "diagnosis/verdict.json#/verdict"],
        in_part: &[""],
        knows_head: true,
    },
    Entry {
        takes: &["next EXPERIMENT.toml"],
        lines: &["next experiment.toml --tries 8 --duration-s 10 --out motion.csv --json >next.json"],
        results: &["next.json#/command"],
        in_part: &["command"],
        knows_head: true,
    },
    Entry {
        takes: &["sensitivity EXPERIMENT.toml"],
        lines: &["sensitivity table.toml --effects spring --joints 0 --out sensitivity"],
        results: &["sensitivity/sensitivity.json#/limits"],
        in_part: &["status"],
        knows_head: false,
    },
    Entry {
        takes: &["track RECORDING", "track EXPERIMENT.toml"],
        lines: &["track experiment.toml --model model.json wednesday.csv --window-s 1.5 --out track"],
        results: &["track/track.json#/recordings/0/drift", "track/track.json#/alarms"],
        in_part: &["alarms"],
        knows_head: true,
    },
    Entry {
        takes: &["gains EXPERIMENT.toml"],
        lines: &["gains experiment.toml --expect --out gains"],
        results: &["gains/gains.json#/gains/joints", "gains/gains.json#/gains/reference"],
        in_part: &["decided", "reference"],
        knows_head: true,
    },
    Entry {
        takes: &["simulate RECORDING"],
        lines: &["simulate --model model.json --motion tuesday.csv --out moved.csv"],
        results: &["moved.csv"],
        in_part: &["q_", "torque_"],
        knows_head: true,
    },
    Entry {
        takes: &["simulate RECORDING"],
        lines: &["simulate --model model.json --torques tuesday.csv --out moved.csv"],
        results: &["moved.csv"],
        in_part: &["torque_"],
        knows_head: true,
    },
    Entry {
        takes: &["sweep run EXPERIMENT.toml"],
        lines: &["sweep run experiment.toml --out sweep"],
        results: &["sweep/table.csv"],
        in_part: &["name", "coefficients"],
        knows_head: true,
    },
    Entry {
        takes: &["sweep plan EXPERIMENT.toml"],
        lines: &[
            "sweep plan experiment.toml --out sweep",
            "sweep point 1 2 --out sweep",
            "sweep collect --out sweep",
        ],
        results: &["sweep/table.csv"],
        in_part: &["name", "coefficients"],
        knows_head: true,
    },
];
