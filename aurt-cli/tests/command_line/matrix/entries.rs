//! Ways to hand recordings to commands.

use std::sync::LazyLock;

/// A way to hand recordings to a command: commands and arguments that it stands for, as their help names them; its command lines; what
/// comes out (`file`, or `file#/place` in a JSON document); what of it is the same, by parts of its keys, if the recordings are cut.
pub struct Entry {
    pub takes: Vec<&'static str>,
    pub lines: Vec<&'static str>,
    pub results: Vec<&'static str>,
    pub in_part: Vec<&'static str>,
    /// Whether it knows the robot with its head.
    pub knows_head: bool,
}

/// A row for each entry, its fields apart by ` / `, parts of these by `; `. A shorter recording asks `init` for a wider band.
const TABLE: &str = "run EXPERIMENT.toml / run experiment.toml --out results / results/predicted_tuesday.csv; results/calibrated_parameters.csv / predicted_;  value / head
run EXPERIMENT.toml / run experiment.toml --out results --stream-above 1kB / results/calibrated_parameters.csv /  value / head
check RECORDING|EXPERIMENT.toml / check experiment.toml --json >check.json / check.json#/recordings/0/joints; check.json#/recordings/0/unit / unit / head
check RECORDING|EXPERIMENT.toml / check monday.csv --mdh mdh.csv --gravity 0 -9.81 0 --joint-names shoulder,elbow --json >check.json / check.json#/joints; check.json#/unit / unit / no head
init RECORDING / init monday.csv --robot arm.urdf --tip fore --gravity 0 -9.81 0 --out first.toml / first.toml#/robot; first.toml#/joint_dynamics; first.toml#/preprocess / robot; joint_dynamics / head
compile-rd EXPERIMENT.toml / compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd_2.json / rd_2.json /  / no head
calibrate RECORDING / calibrate --model rd.json --data monday.csv tuesday.csv --out-params p.csv --out-calibrated-model c.json / p.csv /  value / no head
calibrate-validate RECORDING / calibrate-validate --model rd.json --data monday.csv --calibration-data-rel 0.6 --out-params p.csv --out-calibrated-model c.json --out-prediction q.csv / p.csv; q.csv /  value; predicted_ / no head
predict RECORDING / predict --model model.json --data tuesday.csv --out q.csv / q.csv / predicted_ / head
diagnose EXPERIMENT.toml / diagnose experiment.toml --out diagnosis / diagnosis/verdict.json#/effects; diagnosis/verdict.json#/verdict /  / head
next EXPERIMENT.toml / next experiment.toml --tries 8 --duration-s 10 --out motion.csv --json >next.json / next.json#/command / command / head
sensitivity EXPERIMENT.toml / sensitivity table.toml --effects spring --joints 0 --out sensitivity / sensitivity/sensitivity.json#/limits / status / no head
track RECORDING; track EXPERIMENT.toml / track experiment.toml --model model.json wednesday.csv --window-s 1.5 --out track / track/track.json#/recordings/0/drift; track/track.json#/alarms / alarms / head
gains EXPERIMENT.toml / gains experiment.toml --expect --out gains / gains/gains.json#/gains/joints; gains/gains.json#/gains/reference / decided; reference / head
simulate RECORDING / simulate --model model.json --motion tuesday.csv --out moved.csv / moved.csv / q_; torque_ / head
simulate RECORDING / simulate --model model.json --torques tuesday.csv --out moved.csv / moved.csv / torque_ / head
sweep run EXPERIMENT.toml / sweep run experiment.toml --out sweep / sweep/table.csv / name; coefficients / head
sweep plan EXPERIMENT.toml / sweep plan experiment.toml --out sweep; sweep point 1 2 --out sweep; sweep collect --out sweep / sweep/table.csv / name; coefficients / head";

pub static ENTRIES: LazyLock<Vec<Entry>> = LazyLock::new(|| {
    let entry = |row: &'static str| {
        let mut fields = row.split(" / ");
        let [takes, lines, results, in_part] =
            [(); 4].map(|()| fields.next().unwrap().split("; ").collect::<Vec<_>>());
        Entry { takes, lines, results, in_part, knows_head: fields.next() == Some("head") }
    };
    TABLE.lines().map(entry).collect()
});
