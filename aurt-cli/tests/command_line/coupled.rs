//! A chain in which joints follow others: motions are planned for it, and what its model lacks is found.

use aurt::simulation::Random;
use aurt_rbd::RobotDescription;
use aurt_rbd::robots::DescribedRobot;
use aurt_traits::Motion;
use serde_json::{Value, json};

use crate::support::{Folder, rows};

/// Five joints, of which three move on their own; a parallelogram and a telescope.
const URDF: &str = include_str!("../../../aurt-rbd/tests/descriptions/reference/coupled.urdf");
const TIP: &str = "rod";
/// Dry and viscous friction of the three joints, Nm and Nm s/rad (N and N s/m).
const FRICTION: [(f64, f64); 3] = [(6.0, 10.0), (12.0, 20.0), (9.0, 60.0)];
/// Deviation of the measured torque, Nm (N).
const NOISE: [f64; 3] = [0.2, 0.3, 0.2];

/// What is done to the arm of a recording: mass on a link, and dry friction on a joint.
#[derive(Clone, Copy, Default)]
struct Change {
    mass_kg: f64,
    on_link: usize,
    friction_nm: [f64; 3],
}

fn robot() -> DescribedRobot {
    aurt_rbd::robots::parse(URDF, "coupled.urdf", None, &Some(TIP).into(), None).unwrap()
}

/// Plans a motion of the arm and records what its drives give along it.
fn record(folder: &Folder, name: &str, seed: u64, change: Change) {
    let planned = format!("{name}.motion.csv");
    let line = "excite --robot robot.urdf --duration-s 40 --rate-hz 125 --tries 60 --top-hz 0.5 --quiet";
    folder.run(format!("{line} --tip {TIP} --seed {seed} --out {planned}")).succeeded();
    let table = folder.read(&planned);
    let rows = rows(&table);
    assert_eq!(rows[0].len(), 10, "time and three joints: {}", table.lines().next().unwrap());
    let column = |k: usize| rows.iter().map(|r| r[k]).collect::<Vec<f64>>();
    let columns = |first: usize| (first..first + 3).flat_map(column).collect::<Vec<f64>>();
    // The bracket has to stay within its own limits, −1.2 … 2, and follows the shoulder: 0.2 − q.
    assert!(column(2).iter().all(|q| (-1.5..=1.4).contains(q)));
    let motion = Motion::new(3, column(0), columns(1), columns(4), columns(7)).unwrap();
    let robot = robot();
    let body = robot.rigid_body([0.0, 0.0, -9.81]).unwrap();
    let mut standard = robot.standard_parameters.unwrap();
    standard[10 * change.on_link + 9] += change.mass_kg;
    let mut torque = vec![0.0; 3 * rows.len()];
    body.torque(motion.view(), &standard, &mut torque, rows.len());
    let mut random = Random::new(seed);
    let mut text = String::from("t,q0,q1,q2,tau0,tau1,tau2\n");
    for (k, row) in rows.iter().enumerate() {
        text += &row[0].to_string();
        for q in &row[1..4] {
            // Encoders of 20 bits a turn.
            let step = std::f64::consts::TAU / f64::from(1 << 20);
            text += &format!(",{}", (q / step).round() * step);
        }
        for j in 0..3 {
            let (dry, viscous) = FRICTION[j];
            let speed = row[4 + j];
            // A jump that is 1 mrad/s wide, as a drive at rest is held.
            let friction = (dry + change.friction_nm[j]) * (speed / 1e-3).tanh() + viscous * speed;
            text += &format!(",{}", torque[j * rows.len() + k] + friction + NOISE[j] * random.normal());
        }
        text.push('\n');
    }
    folder.write(name, &text);
}

/// What a diagnosis of the arm says of recordings after such a change.
fn verdict_after(change: Option<Change>) -> (Folder, Value) {
    let folder = Folder::new();
    folder.write("robot.urdf", URDF);
    record(&folder, "before.csv", 1, Change::default());
    record(&folder, "held_out.csv", 2, change.unwrap_or_default());
    let mut target = "";
    if let Some(change) = change {
        record(&folder, "after.csv", 3, change);
        target = "target = ['after.csv']\n";
    }
    folder.write(
        "experiment.toml",
        &format!(
            "schema = 1\n[robot]\nurdf = 'robot.urdf'\ntip = '{TIP}'\ngravity_m_s2 = [0.0, 0.0, -9.81]\n\
             [recordings]\ncalibration = ['before.csv']\n{target}\
             validation = ['held_out.csv']\n[preprocess]\nf_dyn_hz = 5.0\n"
        ),
    );
    let run = folder.run("diagnose experiment.toml --out out --quiet");
    assert!(matches!(run.status(), 0 | 1), "{}{}", run.stdout(), run.stderr());
    let verdict = folder.json("out/verdict.json");
    (folder, verdict)
}

#[test]
fn a_coupled_arm_that_lacks_nothing_is_told_so() {
    let (folder, verdict) = verdict_after(None);
    assert_eq!(verdict["verdict"], "no_mismatch", "{verdict}");
    // How sure that is can be asked of it as of every robot.
    let asked = ["sensitivity", "experiment.toml", "--effects", "spring,joint_elasticity", "--joints", "1"];
    folder.aurt(asked.into_iter().chain(["--out", "sensitivity", "--quiet"])).succeeded();
    let limits = folder.json("sensitivity/sensitivity.json")["limits"].clone();
    let spring = limits.as_array().unwrap().iter().find(|row| row["effect"] == "spring").unwrap();
    assert_eq!((&spring["status"], &spring["unit"]), (&json!("named"), &json!("Nm/rad")), "{spring}");
}

/// The bracket keeps its direction: of a load on it the mass alone makes torque.
#[test]
fn a_load_on_a_link_that_does_not_turn_has_a_mass_and_no_absurd_place() {
    let (_, verdict) = verdict_after(Some(Change { mass_kg: 6.0, on_link: 2, ..Change::default() }));
    let first = &verdict["effects"][0];
    assert_eq!((&verdict["verdict"], &first["effect"]), (&json!("named"), &json!("payload")), "{verdict}");
    let parameters = &first["parameters"];
    assert!((parameters["mass_kg"]["value"].as_f64().unwrap() - 6.0).abs() < 0.6, "{first}");
    let com: Vec<f64> =
        parameters["com_m"]["value"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    assert!(com.iter().all(|metres| metres.abs() < 2.0), "{first}");
}

#[test]
fn a_load_on_a_link_that_follows_is_found() {
    let (folder, verdict) = verdict_after(Some(Change { mass_kg: 4.0, on_link: 4, ..Change::default() }));
    let first = &verdict["effects"][0];
    assert_eq!((&verdict["verdict"], &first["effect"]), (&json!("named"), &json!("payload")), "{verdict}");
    let parameter = |name: &str| first["parameters"][name]["value"].as_f64().unwrap();
    assert!((parameter("mass_kg") - 4.0).abs() < 0.4, "{first}");
    // The rod slides twice as far as the tube that it stands in.
    assert_eq!(parameter("link"), 4.0, "{first}");
    let improved = folder.read("out/improved.toml");
    assert!(improved.contains("link = 4"), "{improved}");
    folder.run("run out/improved.toml --out again --quiet").succeeded();
}

#[test]
fn friction_of_a_coupled_arm_is_found_where_it_is() {
    let (_, verdict) = verdict_after(Some(Change { friction_nm: [0.0, 5.0, 0.0], ..Change::default() }));
    let first = &verdict["effects"][0];
    assert_eq!(verdict["verdict"], "named", "{verdict}");
    // Dry friction alone has grown, which is another effect than the level of all of it.
    assert_eq!((&first["effect"], &first["joints"]), (&json!("coulomb"), &json!([1])), "{verdict}");
    let value = first["parameters"]["coulomb_nm"]["value"].as_f64().unwrap();
    assert!((value - 5.0).abs() < 0.5, "{first}");
}

#[test]
fn what_a_coupled_arm_cannot_have_is_refused() {
    let folder = Folder::new();
    folder.write("robot.urdf", URDF);
    record(&folder, "a.csv", 1, Change::default());
    let text = format!(
        "schema = 1\n[robot]\nurdf = 'robot.urdf'\ntip = '{TIP}'\ngravity_m_s2 = [0.0, 0.0, -9.81]\n\
         [[arm_terms]]\nmodel = 'payload'\nlink = 5\n[recordings]\ncalibration = ['a.csv']\n[preprocess]\nf_dyn_hz = 5.0\n"
    );
    folder.write("experiment.toml", &text);
    // Links, not joints: the rod is link 4.
    folder.run("run experiment.toml --out out --quiet").refused(&["between 0 and 4", "is 5"]);
    folder.write("experiment.toml", &text.replace("[[arm_terms]]\nmodel = 'payload'\nlink = 5\n", ""));
    assert!(matches!(folder.run("run experiment.toml --out out --quiet").status(), 0 | 1));
    let arguments = ["export", "c", "out/rd_calibrated.json", "--out", "exported"];
    folder.aurt(arguments).refused(&["follow others"]);
}
