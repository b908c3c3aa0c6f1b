//! `aurt check`.

use serde_json::Value;

use crate::support::{Folder, assert_has, column, first_columns, numbers, one_line, with_cells, with_table};

#[test]
fn a_good_recording_has_no_findings() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    let run = folder.run("check exciting_motion.csv --mdh mdh.csv --json").succeeded();
    let report = run.json();
    assert_eq!(report["findings"].as_array().unwrap().len(), 0, "{}", report["findings"]);
    assert_eq!(report["excitation"]["rank"], 48);
    // The demo's motion has harmonics up to 1 Hz, and friction odd ones of these.
    let f_dyn_hz = report["suitable_f_dyn_hz"].as_f64().unwrap();
    assert!((4.0..=6.0).contains(&f_dyn_hz), "{f_dyn_hz}");
    for joint in report["joints"].as_array().unwrap() {
        // The simulated logger writes angles with seven decimals.
        let [low, high] = numbers(&joint["position_rad"])[..] else { panic!("{joint}") };
        assert!(low < high);
        assert!(joint["moving_share"].as_f64().unwrap() > 0.5, "{joint}");
        assert!(joint["bandwidth_hz"].as_f64().unwrap() < 5.0, "{joint}");
    }
}

#[test]
fn a_recording_needs_neither_geometry_nor_measurement() {
    let folder = Folder::new().with_demo(&["other_motion.csv"]);
    folder.write("positions.csv", &first_columns(&folder.read("other_motion.csv"), 4));
    folder.run("check positions.csv").says(&["3 joints, without measurement"]);
}

/// A recording with a column that holds its first value.
fn held(table: &str, column: usize) -> String {
    let first = table.lines().nth(1).unwrap().split(',').nth(column).unwrap();
    with_cells(table, |_, at, _| (at == column).then(|| first.to_owned()))
}

#[test]
fn what_should_be_heeded_gives_status_1() {
    let folder = Folder::new().with_demo(&["other_motion.csv"]);
    // Joint 2 holds its first angle.
    folder.write("held.csv", &held(&folder.read("other_motion.csv"), 3));
    let run = folder.run("check held.csv").found();
    let words = ["only joints 0, 1, 3, 4 and 5 move; the friction of joint 2 is out of reach"];
    assert_has(&one_line(&run.stdout()), &words);
    folder.run("check nowhere.csv").refused(&["nowhere.csv", "no such file"]);
}

#[test]
fn several_recordings_count_together() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "other_motion.csv", "mdh.csv"]);
    // Joint 0 holds its first angle in one recording and moves in the other.
    folder.write("held.csv", &held(&folder.read("exciting_motion.csv"), 1));
    let alone = folder.run("check held.csv --mdh mdh.csv").found();
    assert!(alone.stdout().contains("out of reach"), "{}", alone.stdout());

    let run = folder.run("check held.csv other_motion.csv --mdh mdh.csv --json --out pages");
    let report = run.json();
    let findings = report["findings"].to_string();
    assert!(!findings.contains("out of reach"), "{findings}");
    assert_eq!(report["together"]["excitation"]["rank"], 48);
    assert!(
        report["recordings"][0]["findings"].to_string().contains("only joints 1, 2, 3, 4 and 5 move"),
        "{report}"
    );
    let f_dyn_hz = report["suitable_f_dyn_hz"].as_f64().unwrap();
    let each =
        report["recordings"].as_array().unwrap().iter().map(|r| r["suitable_f_dyn_hz"].as_f64().unwrap());
    assert!(each.clone().all(|f| f <= f_dyn_hz) && each.into_iter().any(|f| f == f_dyn_hz), "{report}");
    assert!(folder.read("pages/held/report.html").contains("held.csv"));
    assert!(folder.read("pages/other_motion/report.html").contains("other_motion.csv"));
}

/// A warning that a calibration gives is a finding of the check before it, in the same words.
#[test]
fn check_and_calibration_mean_the_same_by_badly_excited() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    // Two seconds of the motion do not tell the parameters apart.
    let text = folder.read("exciting_motion.csv");
    let stamps = column(&text, "timestamp");
    let rate_hz = 1.0 / (stamps[1] - stamps[0]);
    let short: String = text.lines().take(1 + (5.0 * rate_hz) as usize).map(|l| format!("{l}\n")).collect();
    folder.write("short.csv", &short);
    folder.run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json --quiet").succeeded();
    let line = "compile-rd --model-rbd rbd.json --friction-torque-model none --friction-viscous-powers 1 --out rd.json --quiet";
    folder.run(line).succeeded();
    let line = "calibrate --model rd.json --data short.csv --gravity 0 0 -9.81 --f-dyn-hz 5 --out-params p.csv \
                --out-calibrated-model m.json --json";
    let calibrated = folder.run(line).succeeded().json();
    let checked = folder.run("check short.csv --mdh mdh.csv --f-dyn-hz 5 --json").json();
    let of = |list: &Value| -> Vec<String> {
        let all = list.as_array().unwrap().iter().map(|w| w.as_str().unwrap().to_owned());
        all.filter(|w| w.contains("badly excited") || w.contains("condition number")).collect()
    };
    let warned = of(&calibrated["warnings"]);
    assert!(!warned.is_empty(), "{calibrated}");
    assert_eq!(of(&checked["findings"]), warned);
}

#[test]
fn columns_that_are_not_recognised_are_asked_about() {
    let folder =
        Folder::new().with_demo(&["other_motion.csv", "mdh.csv", "experiment.toml", "exciting_motion.csv"]);
    let text = folder.read("other_motion.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    let renamed = header.replace("actual_current_", "i");
    assert_ne!(renamed, header);
    folder.write("own.csv", &format!("{renamed}\n{rows}"));
    let run = folder.run("check own.csv").found();
    let said = one_line(&run.stdout());
    assert!(said.contains("nothing measured was recognised; if i0 … i"), "{said}");
    // What the message proposes is accepted as it stands.
    let start = said.find("{ file").unwrap();
    let proposed = said[start..].split(" (or unit").next().unwrap();
    let recordings = format!("[recordings]\ncalibration = [{proposed}]\n");
    folder.write("own.toml", &with_table(&folder.read("experiment.toml"), "[recordings]", &recordings));
    folder.run("run own.toml --out own").succeeded();
}

/// Stamps in ms are told with the key that says so, written by `--fixed` and by `init`; what they propose runs.
#[test]
fn stamps_in_milliseconds_are_told_with_the_fix() {
    let folder = Folder::new().with_whole_demo();
    for name in ["exciting_motion.csv", "other_motion.csv", "point_to_point.csv"] {
        let stamp = |cell: &str| format!("{:.3}", 1e3 * cell.parse::<f64>().unwrap());
        folder.edit(name, |text| with_cells(text, |_, column, cell| (column == 0).then(|| stamp(cell))));
    }
    let run = folder.run("check experiment.toml --fixed fixed.toml");
    let said = one_line(&run.stdout());
    assert_eq!(run.status(), 1, "{said}");
    assert!(said.contains("seem to be in ms") && said.contains("time = \"ms\""), "{said}");
    assert!(!said.contains("no joint moves"), "{said}");
    folder.run("run fixed.toml --out fixed").succeeded();
    let drafted =
        "init exciting_motion.csv other_motion.csv --robot mdh.csv --gravity 0 0 -9.81 --out first.toml";
    folder.run(drafted);
    assert!(folder.read("first.toml").contains("time = \"ms\""));
}

#[test]
fn remarks_are_no_findings() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    let turned = |cell: &str| (cell.parse::<f64>().unwrap() + std::f64::consts::TAU).to_string();
    folder.edit("exciting_motion.csv", |text| {
        with_cells(text, |row, column, cell| (row >= 400 && column == 1).then(|| turned(cell)))
    });
    folder.run("check exciting_motion.csv --mdh mdh.csv").says(&["was unwrapped"]);
}

/// The same recording under two names, or in two roles, is refused by every command.
#[test]
fn a_sample_counts_once() {
    let folder = Folder::new().with_whole_demo();
    let toml = folder.read("experiment.toml");
    folder.write("copy.csv", &folder.read("exciting_motion.csv"));
    let twice = toml.replace("[\"exciting_motion.csv\"]", "[\"exciting_motion.csv\", \"copy.csv\"]");
    folder.write("twice.toml", &twice);
    let question = "target = [\"other_motion.csv\"]\nvalidation = [\"other_motion.csv\"]";
    let asked = toml.replace("validation = [\"other_motion.csv\", \"point_to_point.csv\"]", question);
    folder.write("asked.toml", &asked);
    for line in ["run twice.toml --out out", "diagnose twice.toml --out out", "check twice.toml"] {
        folder.run(line).refused(&["copy.csv", "exciting_motion.csv", "each sample counts once"]);
    }
    let many = vec!["\"other_motion.csv\""; 1000].join(", ");
    folder.write("many.toml", &toml.replace("\"other_motion.csv\", \"point_to_point.csv\"", &many));
    for line in ["run many.toml --out out", "check many.toml"] {
        folder.run(line).refused(&["other_motion.csv", "validation", "each sample counts once"]);
    }
    folder.run("diagnose asked.toml --out out").refused(&["other_motion.csv", "not held-out"]);
    folder.run("check copy.csv exciting_motion.csv").refused(&["the same samples"]);
    // Every second row under another clock is a copy.
    let text = folder.read("exciting_motion.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    let thinned = rows.lines().step_by(2).map(|row| {
        let (stamp, rest) = row.split_once(',').unwrap();
        format!("{:.4},{rest}\n", stamp.parse::<f64>().unwrap() + 7.3)
    });
    folder.write("copy.csv", &format!("{header}\n{}", thinned.collect::<String>()));
    let found = ["copy.csv", "holds every 2nd row of exciting_motion.csv"];
    folder.run("run twice.toml --out out").refused(&found);
    folder.write("held_out.toml", &toml.replace("\"other_motion.csv\", ", "\"copy.csv\", "));
    folder.run("run held_out.toml --out out").refused(&found);
    folder.run("diagnose held_out.toml --out out").refused(&found);
}

/// A recording of a SCARA arm, two links of 0.4 m in the plane and a slow vertical axis that holds still two thirds of the time, whose
/// units are m and N. Its strokes are a share of 45 mm.
fn scara(phase: f64, share: f64) -> String {
    let mut table = "timestamp,actual_q_0,actual_q_1,actual_q_2,tau_0,tau_1,tau_2\n".to_owned();
    let sines = |t: f64, slow: f64| {
        let parts = [(0.7, slow), (0.3, 2.7 * slow)];
        let sum =
            |of: fn(f64, f64, f64) -> f64| parts.iter().map(|(a, w)| of(*a, *w, t + phase)).sum::<f64>();
        [
            sum(|a, w, t| a * (w * t).sin()),
            sum(|a, w, t| a * w * (w * t).cos()),
            sum(|a, w, t| -a * w * w * (w * t).sin()),
        ]
    };
    // Up by 45 mm within a second, or down in 0.56 s, then rest.
    let stroke = |t: f64| {
        let (up, [way, rate]) = match ((t + phase) / 3.0).rem_euclid(2.0) < 1.0 {
            true => (0.0, [0.045, 1.0]),
            false => (0.045, [-0.045, 1.8]),
        };
        let at = (((t + phase) % 3.0) * rate).min(1.0);
        let [s, v] = [at.powi(3) * (10.0 - 15.0 * at + 6.0 * at * at), 30.0 * (at * (1.0 - at)).powi(2)];
        let a = 60.0 * at * (1.0 - at) * (1.0 - 2.0 * at);
        [up + way * s, rate * way * v, rate * rate * way * a].map(|of| share * of)
    };
    let rubs = |v: f64, dry: f64, wet: f64| if v.abs() > 1e-6 { dry * v.signum() + wet * v } else { 0.0 };
    let mut noise = 1_u32;
    for k in 0..6000 {
        let t = f64::from(k) * 0.005;
        let ([q0, v0, a0], [q1, v1, a1], [z, vz, az]) = (sines(t, 1.1), sines(t, 1.7), stroke(t));
        let coupled = 1.1 * q1.cos();
        let torques = [
            (2.9 + 2.0 * coupled) * a0 + (0.9 + coupled) * a1 - 1.1 * q1.sin() * (2.0 * v0 * v1 + v1 * v1)
                + rubs(v0, 4.0, 3.0),
            (0.9 + coupled) * a0 + 0.9 * a1 + 1.1 * q1.sin() * v0 * v0 + rubs(v1, 3.0, 2.0),
            4.0 * (az + 9.81) + rubs(vz, 12.0, 60.0),
        ];
        let mut torque = |of: f64| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            of + 0.2 * (f64::from(noise >> 8) / f64::from(1 << 24) - 0.5)
        };
        let [x, y, w] = torques.map(&mut torque);
        table += &format!("{t:.3},{q0:.6},{q1:.6},{z:.7},{x:.3},{y:.3},{w:.3}\n");
    }
    table
}

/// The SCARA's geometry, two recordings, and the beginning of an experiment on it.
fn scara_folder(share: f64) -> (Folder, String) {
    let folder = Folder::new();
    folder.write(
        "mdh.csv",
        "alpha,a,d,theta,type\n0,0,0.3,0,revolute\n0,0.4,0,0,revolute\n0,0.4,0,0,prismatic\n",
    );
    folder.write("one.csv", &scara(0.0, share));
    folder.write("two.csv", &scara(31.4037, share));
    let robot = "[robot]\nmdh = 'mdh.csv'\nmdh_rows = 'previous'\ngravity_m_s2 = [0, 0, -9.81]";
    (folder, format!("schema = 1\n{robot}\n[recordings]\n"))
}

/// An axis that moves at 23 mm/s at most does not rest, though a joint does that turns at 0.03 rad/s.
#[test]
fn an_axis_that_slides_slowly_is_examined() {
    let (folder, robot) = scara_folder(0.15);
    let (mut last, mut dragged) = (0.0, String::new());
    for line in scara(17.3, 0.15).lines() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if let (Ok(z), Ok(force)) = (cells[3].parse::<f64>(), cells[6].parse::<f64>()) {
            let speed = (z - last).abs() / 0.005;
            last = z;
            let drag = if speed > 0.004 { 6.0 } else { 0.0 };
            cells[6] = format!("{:.3}", force + drag);
        }
        dragged += &(cells.join(",") + "\n");
    }
    folder.write("dragged.csv", &dragged);
    folder.write("arm.toml", &(robot + "calibration = ['one.csv', 'two.csv']\ntarget = ['dragged.csv']\n"));
    let said = folder.run("diagnose arm.toml --out out").found().stdout();
    let headline = said.split("\nchanged in the target:").next().unwrap().replace('\n', " ");
    assert!(headline.starts_with("changed since calibration: ") && headline.contains("on joint 2"), "{said}");
}

#[test]
fn an_axis_that_slides_has_a_rest_and_units_of_its_own() {
    let (folder, robot) = scara_folder(1.0);
    let rest = "calibration = ['one.csv']\nvalidation = ['two.csv']\n[preprocess]\nf_dyn_hz = 5\n";
    folder.write("arm.toml", &(robot + rest));
    folder.run("check arm.toml").succeeded();
    folder.run("run arm.toml --out out").says(&["|q̇| > 0.03 rad/s or 0.003 m/s"]);
    let page = folder.read("out/report.html");
    for axis in ["velocity [m/s]", "position [rad]", "force [N]", "torque [Nm]"] {
        assert!(page.contains(axis), "{axis}");
    }
    let parameters = folder.read("out/calibrated_parameters.csv");
    for (parameter, unit, truth) in [("F_C0_1", "Nm", 3.0), ("F_C0_2", "N", 12.0), ("F_v1_2", "N s/m", 60.0)]
    {
        let line = parameters.lines().find(|line| line.starts_with(parameter)).unwrap();
        let cells: Vec<&str> = line.split(',').collect();
        assert!(cells[2] == unit && (cells[1].parse::<f64>().unwrap() / truth - 1.0).abs() < 0.1, "{line}");
    }
}
