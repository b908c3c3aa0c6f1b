//! Fits of others, judged by recordings of a simulated servo.

use std::fs;
use std::path::Path;

use aurt::Progress;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::driving::{DriveOutcome, second_opinion};
use aurt_plugins::Registry;

use super::drives::{EXPERIMENT, moved, read_out, servo, write};

/// What the servo does: a delay of 28 ms and dry friction of 0.06 Nm, read by an encoder of 4096 ticks a turn.
fn record(folder: &Path) {
    fs::write(folder.join("mdh.csv"), "alpha,a,d\n0,0,0\n").unwrap();
    let arm = servo(0.4, 0.028, 0.06);
    for (name, phase) in [("a.csv", 0.0), ("b.csv", 1.0)] {
        let wave = |t: f64| 0.4 * (1.5 * t + phase).sin() + 0.1 * (5.5 * t).sin();
        let command: Vec<f64> = (0..1200).map(|k| wave(f64::from(k) * 0.02)).collect();
        write(&folder.join(name), &read_out(&moved(&arm, &command)), &command);
    }
}

fn mjcf(joint: &str, actuator: &str) -> String {
    format!(
        "<mujoco><worldbody><body><inertial pos=\"0 0 0\" mass=\"0.1\" diaginertia=\"1e-5 1e-5 1e-5\"/>\
         <joint name=\"j\" {joint}/></body></worldbody><actuator><position joint=\"j\" kp=\"10\" {actuator}/></actuator></mujoco>"
    )
}

#[test]
fn armature_and_damping_that_absorb_delay_and_dry_friction_are_said_to() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    record(folder);
    let path = folder.join("experiment.toml");
    let text = EXPERIMENT.replace("\"coulomb_nm\"]", "\"coulomb_nm\", \"rotor_inertia_kg_m2\"]");
    let experiment = Experiment::parse(&text, &path, &mut Registry::linked().unwrap()).unwrap();
    let judge = |name: &str, text: &str| -> Result<DriveOutcome, String> {
        fs::write(folder.join(name), text).unwrap();
        second_opinion(&experiment, &folder.join(name), None, &Progress::silent()).map_err(|e| e.to_string())
    };
    let outcome = judge("fit.xml", &mjcf("armature=\"0.03\" damping=\"0.75\"", "")).unwrap();
    assert!(outcome.findings, "{}", outcome.text);
    let rms = |of: &str| outcome.json["held_out_rms"][of].as_f64().unwrap();
    assert!(rms("own_model") < 1e-3 && rms("given") > 2.0 * rms("own_model"), "{}", outcome.text);
    assert!(rms("again") <= rms("given") && rms("again") < rms("command"), "{}", outcome.text);
    let numbers = outcome.json["numbers"].as_array().unwrap();
    let of = |name: &str| numbers.iter().find(|n| n["name"] == name).unwrap();
    let change = |name: &str, structure: &str| {
        let parts = of(name)["stands_for"].as_array().unwrap();
        parts.iter().find(|p| p["structure"] == structure).unwrap()["change"].as_f64().unwrap()
    };
    // A servo that is late by T lags like one with K_p T more damping.
    assert!(
        (change("back_emf_nm_s_per_rad_0", "time_delay") - 10.0 * 0.028).abs() < 0.04,
        "{}",
        outcome.text
    );
    assert!(change("back_emf_nm_s_per_rad_0", "coulomb") > 0.02, "{}", outcome.text);
    assert!(change("rotor_inertia_kg_m2_0", "time_delay") > 0.0, "{}", outcome.text);
    let delay = of("rotor_inertia_kg_m2_0")["stands_for"][0]["value"].as_f64().unwrap();
    assert!((delay - 0.028).abs() < 1e-3, "{}", outcome.text);
    let sentence =
        |name: &str| outcome.text.lines().find(|l| l.contains(name) && l.contains("stands for")).unwrap();
    assert!(sentence("rotor_inertia_kg_m2_0").contains("stands for a delay of the command (delay_s_0 0.02"));
    assert!(
        sentence("back_emf_nm_s_per_rad_0").contains("dry friction (coulomb_nm_0 0.0"),
        "{}",
        outcome.text
    );
    assert!(outcome.text.contains("to tell, record") && outcome.text.contains("steps and fast sines"));

    // A fit that has both, and is right, absorbs nothing.
    let right = mjcf("armature=\"0.01\" damping=\"0.4\" frictionloss=\"0.06\"", "delay=\"0.028\"");
    let outcome = judge("right.xml", &right).unwrap();
    assert!(!outcome.findings && !outcome.text.contains("stands for"), "{}", outcome.text);

    // The same, as mujoco.sysid states it for a file with other numbers.
    fs::write(folder.join("bare.xml"), mjcf("armature=\"0.03\"", "")).unwrap();
    let identified = |damping: &str| {
        let numbers =
            [("j_armature", "0.01"), (damping, "0.4"), ("frictionloss", "0.06"), ("delay", "0.028")];
        let text: String = numbers.map(|(name, value)| format!("{name}:\n  value:\n  - {value}\n")).concat();
        fs::write(folder.join("params.yaml"), text).unwrap();
        let [fit, parameters] = ["bare.xml", "params.yaml"].map(|name| folder.join(name));
        second_opinion(&experiment, &fit, Some(&parameters), &Progress::silent()).map_err(|e| e.to_string())
    };
    let corrected = identified("j_damping").unwrap();
    assert_eq!(corrected.json["held_out_rms"], outcome.json["held_out_rms"]);
    let refused = identified("k_damping").unwrap_err();
    assert!(refused.contains("params.yaml:4") && refused.contains("there is no joint `k`"), "{refused}");

    let refused = judge("geared.xml", &mjcf("armature=\"0.03\"", "gear=\"2\"")).unwrap_err();
    assert!(refused.contains("gear") && refused.contains("gains at the joint"), "{refused}");
    let refused = judge("none.json", "{}").unwrap_err();
    assert!(refused.contains("neither `kt`"), "{refused}");
    // Numbers as text would count as absent, here friction of the load.
    let bam = "{\"kt\": 0.2, \"R\": 2.0, \"vin\": 12.0, \"load_friction_base\": \"0.1\"}";
    let refused = judge("bam.json", bam).unwrap_err();
    assert!(
        refused.contains("`load_friction_base` is \"0.1\"") && refused.contains("no number"),
        "{refused}"
    );
}
