//! Every command that takes a recording, on recordings that say the same in another way: the result is the same, or the command
//! refuses. Which commands these are, the help of each tells, so that a new one cannot be left out.

mod entries;

use std::collections::{BTreeMap, BTreeSet};

use aurt::prelude::Robot;
use aurt::recording::{JointTopic, mcap};
use aurt::traits::Motion;
use serde_json::Value;

use self::entries::{ENTRIES, Entry};
use crate::support::{Folder, Run, one_line};

/// An arm of two joints with a head on its upper link, which is no part of the chain.
const URDF: &str = r#"<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.5 0 0"/><mass value="5"/>
  <inertia ixx="0.01" iyy="0.4" izz="0.4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="fore"><inertial><origin xyz="0.5 0 0"/><mass value="3"/>
  <inertia ixx="0.01" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="skull"><inertial><origin xyz="0 0.2 0"/><mass value="2"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="3" effort="200"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="3" effort="200"/></joint>
<joint name="head" type="revolute"><parent link="upper"/><child link="skull"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="3" effort="200"/></joint></robot>"#;

/// Of the table, what `urdf` says; a table has no joints beside its chain.
const MDH: &str = "alpha,a,d\n0,1,0\n0,0,0\n";
const GRAVITY: [f64; 3] = [0.0, -9.81, 0.0];
const DURATION_S: f64 = 14.0;
const RATE_HZ: f64 = 125.0;
/// The part that is left of a recording that is cut in the middle of the motion.
const CUT_S: [f64; 2] = [1.6, 12.4];
/// Rows within the filters' memory of an end do not count.
const MEMORY_S: f64 = 0.352;

/// Values of other arguments, none of which is a recording.
const OTHER_VALUES: &str = "CORNERS ARG BODY DIR DRIVES.toml EFFECT EFFECTS ENGINE ESTIMATOR FMI FORMAT FRICTION_TORQUE_MODEL H HZ JOINTS JSON KG KIND \
    LANG LEARNT.json LIBRARY LIMITS.csv LINK LINK,LINK,… LOAD_TORQUE MDH.csv MDH_ROWS MODEL N NAME NAME,NAME,… NAME|FILE PARAMS.yaml POWER RAD RAD/S RAD/S2 \
    RD_CALIBRATED.json|URDF|XML REST ROWS S SCENARIO.toml SHARE SHELL SIZE TABLE TARGET TOPIC UNIT XML|URDF";

#[test]
fn every_command_that_takes_a_recording_is_in_the_matrix() {
    let folder = Folder::new();
    let help = |command: &str| folder.aurt(command.split(' ').chain(["--help"])).succeeded().stdout();
    let listed = |help: &str, begin: &str| -> Vec<String> {
        let names = help.lines().skip_while(|line| *line != begin).take_while(|line| *line != "Options:");
        let names = names.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
        names.filter(|name| !name.is_empty() && *name != "help").map(str::to_owned).collect()
    };
    let mut takes = BTreeSet::new();
    for command in listed(&folder.run("--help").succeeded().stdout(), "Start here:") {
        let own = help(&command);
        let below = listed(&own, "Commands:");
        let commands: Vec<String> = match below.is_empty() {
            true => vec![command],
            false => below.iter().map(|name| format!("{command} {name}")).collect(),
        };
        for command in commands {
            for line in help(&command).lines().map(str::trim_start) {
                let argument = line.starts_with(['-', '<', '[']).then(|| line.split("  ").next()).flatten();
                let Some((flag, value)) = argument.and_then(|a| a.split_once(['<', '['])) else { continue };
                let value = value.trim_start_matches(['=', '<']).split(['>', ']']).next().unwrap_or_default();
                let is_output = flag.contains("--out") || flag.contains("--fixed") || flag.contains("--path");
                if value.contains("RECORDING") || (value.contains("EXPERIMENT.toml") && !is_output) {
                    takes.insert(format!("{command} {value}"));
                } else {
                    let is_known = is_output
                        || value.contains(' ')
                        || value.contains(':')
                        || OTHER_VALUES.split_whitespace().any(|known| known == value);
                    assert!(
                        is_known,
                        "`aurt {command}` takes `{argument:?}`: call what holds recordings RECORDING"
                    );
                }
            }
        }
    }
    let known = ENTRIES.iter().flat_map(|entry| &entry.takes).map(|&takes| takes.to_owned());
    assert_eq!(takes, known.collect());
}

/// One way to write two recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Written {
    /// Text with the joints in the robot's order.
    Plain,
    /// Text with the joints in another order, and one that is not the robot's.
    Permuted,
    Bag,
    /// Angles in degrees, as the names say; the experiment says so too.
    Degrees,
    /// The measurements of Tuesday are currents by their names.
    Currents,
    /// They begin and end in the middle of the motion.
    Cut,
    /// The head moves.
    Branch,
}

/// A value with its first two derivatives by time.
type Jet = [f64; 3];

/// Sines that begin and end at rest.
fn motion(t: f64, waves: &[[f64; 3]]) -> Jet {
    let times = |a: Jet, b: Jet| -> Jet {
        [a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2]]
    };
    let (from_s, to_s, ramp_s) = (0.8, DURATION_S - 0.8, 1.2);
    // A polynomial of fifth degree from 0 to 1, forwards or backwards.
    let ramp = |s: f64, way: f64| -> Jet {
        let s = (s / ramp_s).clamp(0.0, 1.0);
        let first = 30.0 * s * s * (1.0 - s) * (1.0 - s) / ramp_s;
        let second = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (ramp_s * ramp_s);
        [s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), way * first, second]
    };
    let window = times(ramp(t - from_s, 1.0), ramp(to_s - t, -1.0));
    let mut sum = [0.0; 3];
    for [size, rate, phase] in waves {
        let (sin, cos) = (rate * t + phase).sin_cos();
        sum[0] += size * sin;
        sum[1] += size * rate * cos;
        sum[2] -= size * rate * rate * sin;
    }
    times(sum, window)
}

const DAYS: [&str; 3] = ["monday", "tuesday", "wednesday"];

/// What was recorded on one day: stamps, and of shoulder and elbow positions and torques.
struct Day {
    time_s: Vec<f64>,
    position_rad: [Vec<f64>; 2],
    torque_nm: [Vec<f64>; 2],
}

impl Day {
    fn new(seed: f64) -> Self {
        let waves = [
            [[0.5, 1.3 + 0.1 * seed, 0.2], [0.4, 3.1 - 0.2 * seed, 1.0]],
            [[0.6, 2.1 + 0.1 * seed, 0.7], [0.3, 4.3 - 0.1 * seed, 0.1]],
        ];
        let time_s: Vec<f64> = (0..=(DURATION_S * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ).collect();
        let samples = time_s.len();
        let jets: Vec<Jet> = waves.iter().flat_map(|w| time_s.iter().map(|t| motion(*t, w))).collect();
        let of = |k: usize| -> Vec<f64> { jets.iter().map(|jet| jet[k]).collect() };
        let robot = Robot::from_urdf(URDF, None, Some("fore"), GRAVITY).unwrap();
        let motion = Motion::new(2, time_s.clone(), of(0), of(1), of(2)).unwrap();
        let mut torque = vec![0.0; 2 * samples];
        let standard = robot.described().unwrap().standard_parameters.clone().unwrap();
        robot.rigid_body().torque(motion.view(), &standard, &mut torque, samples);
        let mut state = 0.37 + 0.01 * seed;
        for (tau, [_, velocity, _]) in torque.iter_mut().zip(&jets) {
            let noise: f64 = (0..12).map(|_| (state = (state * 9_301.0 + 0.211_327).fract(), state).1).sum();
            *tau += 2.0 * (velocity / 1e-3).tanh() + 1.5 * velocity + 0.05 * (noise - 6.0);
        }
        let halves = |all: &[f64]| [all[..samples].to_vec(), all[samples..].to_vec()];
        Self { position_rad: halves(&of(0)), torque_nm: halves(&torque), time_s }
    }

    fn write(&self, folder: &Folder, name: &str, written: Written) {
        let head: Vec<f64> = self.time_s.iter().map(|t| 0.8 * (3.0 * t).sin()).collect();
        let rest = vec![0.0; head.len()];
        let ([shoulder, elbow], [shoulder_nm, elbow_nm]) = (&self.position_rad, &self.torque_nm);
        let mut joints = vec![("shoulder", shoulder, shoulder_nm), ("elbow", elbow, elbow_nm)];
        match written {
            Written::Permuted | Written::Bag => {
                joints.insert(0, ("gripper", &head, &rest));
                joints.reverse();
            }
            Written::Branch => joints.push(("head", &head, &rest)),
            _ => {}
        }
        if written == Written::Bag {
            let position: Vec<Vec<f64>> = joints.iter().map(|j| j.1.clone()).collect();
            let effort: Vec<Vec<f64>> = joints.iter().map(|j| j.2.clone()).collect();
            let topic =
                JointTopic { name: "/joint_states", position: &position, velocity: &[], effort: &effort };
            let names: Vec<String> = joints.iter().map(|j| j.0.to_owned()).collect();
            let path = folder.path(&format!("{name}.mcap"));
            std::fs::write(&path, mcap(&path, &self.time_s, 0.0, &names, &[topic], &[]).unwrap()).unwrap();
            return;
        }
        let is_current = written == Written::Currents && name != DAYS[0];
        let (measured, per_nm) = if is_current { ("current", 0.1) } else { ("torque", 1.0) };
        let (angle, factor) =
            if written == Written::Degrees { (" [deg]", 180.0 / std::f64::consts::PI) } else { ("", 1.0) };
        let mut text = "time".to_owned();
        text.extend(joints.iter().map(|j| format!(",{}.position{angle}", j.0)));
        text.extend(joints.iter().map(|j| format!(",{}.{measured}", j.0)));
        for (k, t) in self.time_s.iter().enumerate() {
            if written == Written::Cut && !(CUT_S[0]..CUT_S[1]).contains(t) {
                continue;
            }
            text += &format!("\n{t}");
            text.extend(joints.iter().map(|j| format!(",{}", factor * j.1[k])));
            text.extend(joints.iter().map(|j| format!(",{}", per_nm * j.2[k])));
        }
        folder.write(&format!("{name}.csv"), &(text + "\n"));
    }
}

fn experiment(robot: &str, written: Written) -> String {
    let recording = |name: &str| match written {
        Written::Bag => format!("{{ file = '{name}.mcap', unit = 'Nm' }}"),
        Written::Degrees => format!("{{ file = '{name}.csv', angle = 'deg' }}"),
        _ => format!("'{name}.csv'"),
    };
    format!(
        "schema = 1\n[robot]\n{robot}\ngravity_m_s2 = [0.0, -9.81, 0.0]\n[joint_dynamics]\ncoulomb = {{ model = 'constant' }}\n\
         hysteresis = {{ model = 'sign' }}\nviscous = {{ model = 'polynomial', powers = [1] }}\n[recordings]\n\
         calibration = [{}]\nvalidation = [{}]\n[preprocess]\nf_dyn_hz = 5.0\n[sweep.grid]\n\
         'joint_dynamics.coulomb.model' = ['constant', 'absolute']\n",
        recording("monday"),
        recording("tuesday")
    )
}

fn run(folder: &Folder, line: &str) -> Run {
    let (line, out) = line.split_once(" >").map_or((line, None), |(line, out)| (line, Some(out)));
    let run = folder.run(line);
    if let Some(out) = out.filter(|_| run.status() < 2) {
        folder.write(out, &run.stdout());
    }
    run
}

/// A folder with the three days, of which the last is in no experiment, and what the plain recordings make: the model, and the structure of one.
fn recorded(days: &[Day; 3], written: Written) -> Folder {
    let folder = Folder::new();
    folder.write("arm.urdf", URDF);
    folder.write("mdh.csv", MDH);
    let named = "mdh = 'mdh.csv'\njoint_names = ['shoulder', 'elbow']";
    for written in BTreeSet::from([Written::Plain, written]) {
        folder.write("experiment.toml", &experiment("urdf = 'arm.urdf'\ntip = 'fore'", written));
        folder.write("table.toml", &experiment(named, written));
        days.iter().zip(DAYS).for_each(|(day, name)| day.write(&folder, name, written));
        if written == Written::Plain {
            run(&folder, "run experiment.toml --out plain").succeeded();
            std::fs::copy(folder.path("plain/rd_calibrated.json"), folder.path("model.json")).unwrap();
            run(
                &folder,
                "compile-rbd --mdh mdh.csv --joint-names shoulder,elbow --gravity 0 -9.81 0 --out rbd.json",
            )
            .succeeded();
            run(&folder, "compile-rd --model-rbd rbd.json --experiment table.toml --out rd.json").succeeded();
        }
    }
    folder
}

/// A command line on recordings that are written like this. Of bags it says the unit where their files are named.
fn on(line: &str, written: Written) -> String {
    if written != Written::Bag {
        return line.to_owned();
    }
    let bags = DAYS
        .iter()
        .fold(line.to_owned(), |line, day| line.replace(&format!("{day}.csv"), &format!("{day}.mcap")));
    // `track` takes the unit of the experiment's recordings.
    let says = bags != line && !line.starts_with("track");
    if says { bags.replacen(' ', " --unit Nm ", 1) } else { bags }
}

/// What an entry makes of the recordings, cell by cell, or that it refuses; and all that it says.
fn outcome(folder: &Folder, entry: &Entry, written: Written) -> (Option<BTreeMap<String, Value>>, String) {
    let mut said = String::new();
    for line in &entry.lines {
        let run = run(folder, &on(line, written));
        said += &(run.stdout() + &run.stderr());
        assert!(!said.contains("panicked"), "{line}: {said}");
        if run.status() == 2 {
            return (None, said);
        }
    }
    let mut cells = BTreeMap::new();
    for result in &entry.results {
        let (file, place) = result.split_once('#').unwrap_or((result, ""));
        let text = folder.read(file);
        match file.rsplit('.').next() {
            Some("csv") => {
                let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
                let header = rows.next().unwrap();
                for row in rows {
                    for (name, cell) in header.iter().zip(&row) {
                        let value = cell.parse::<f64>().map_or(Value::from(*cell), Value::from);
                        cells.insert(format!("{file} {} {name}", row[0]), value);
                    }
                }
            }
            kind => {
                let document: Value =
                    if kind == Some("toml") { toml::from_str(&text).unwrap() } else { folder.json(file) };
                let Some(found) = document.pointer(place) else { panic!("{result}: {text}") };
                flatten(result, found, &mut cells);
            }
        }
    }
    (Some(cells), said)
}

fn flatten(key: &str, value: &Value, cells: &mut BTreeMap<String, Value>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| flatten(&format!("{key} {k}"), v, cells)),
        Value::Array(all) => {
            all.iter().enumerate().for_each(|(k, v)| flatten(&format!("{key} {k}"), v, cells))
        }
        _ => drop(cells.insert(key.to_owned(), value.clone())),
    }
}

/// The cells that differ by more than a tolerance.
fn apart(a: &BTreeMap<String, Value>, b: &BTreeMap<String, Value>, most: f64) -> Vec<String> {
    let same = |a: &Value, b: &Value| match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => (a - b).abs() <= most * a.abs().max(1.0),
        _ => a == b,
    };
    let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let differs = |key: &&&String| !a.get(**key).zip(b.get(**key)).is_some_and(|(a, b)| same(a, b));
    keys.iter().filter(differs).map(|key| format!("{key}: {:?} {:?}", a.get(*key), b.get(*key))).collect()
}

/// Cells that are the same if a recording is cut: those of its rows that are beyond the filters' memory.
fn of_part(cells: &BTreeMap<String, Value>, entry: &Entry) -> BTreeMap<String, Value> {
    let is_inside = |key: &str| match key.split(' ').nth(1).and_then(|stamp| stamp.parse::<f64>().ok()) {
        Some(t) if key.contains(".csv") => (CUT_S[0] + MEMORY_S..CUT_S[1] - MEMORY_S).contains(&t),
        _ => true,
    };
    let is_meant = |key: &str| entry.in_part.iter().any(|part| key.contains(part)) && is_inside(key);
    cells.iter().filter(|(key, _)| is_meant(key)).map(|(key, value)| (key.clone(), value.clone())).collect()
}

#[test]
fn what_is_written_in_another_way_gives_the_same_or_is_refused() {
    let days = [Day::new(1.0), Day::new(2.0), Day::new(3.0)];
    let plain: Vec<_> = {
        let folder = recorded(&days, Written::Plain);
        ENTRIES.iter().map(|entry| outcome(&folder, entry, Written::Plain)).collect()
    };
    let ways =
        [Written::Permuted, Written::Bag, Written::Degrees, Written::Currents, Written::Cut, Written::Branch];
    let mut wrong = Vec::new();
    std::thread::scope(|scope| {
        let of_way = |written| {
            let folder = recorded(&days, written);
            let mut wrong = Vec::new();
            for (entry, (plain, _)) in ENTRIES.iter().zip(&plain) {
                let line = entry.lines[0];
                let Some(plain) = plain else {
                    wrong.push(format!("{line} refuses plain recordings"));
                    continue;
                };
                let (found, said) = outcome(&folder, entry, written);
                println!("{written:?} {line}: {}", if found.is_some() { "the same" } else { "refused" });
                let Some(found) = found else { continue };
                let different = match written {
                    Written::Cut => apart(&of_part(plain, entry), &of_part(&found, entry), 0.02),
                    _ => apart(plain, &found, 1e-6),
                };
                // Sweeps go on where points fail; joints that contain foreign motion are not followed.
                let is_told = line.starts_with("sweep") && one_line(&said).contains("one model has one unit")
                    || line.starts_with("track") && written == Written::Branch;
                if let Some(one) = different.first().filter(|_| !is_told) {
                    wrong.push(format!("{written:?} {line}: {} cells, {one}", different.len()));
                }
                let is_told = ["joints beside the chain move (head by", "\"joint\": \"head\""]
                    .iter()
                    .any(|w| one_line(&said).contains(w));
                if written == Written::Branch && entry.knows_head && !is_told {
                    wrong.push(format!("{written:?} {line}: says nothing of the head\n{said}"));
                }
            }
            wrong
        };
        let running: Vec<_> = ways.into_iter().map(|written| scope.spawn(move || of_way(written))).collect();
        wrong.extend(running.into_iter().flat_map(|thread| thread.join().unwrap()));
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
