//! The first experiment of a robot: robot, recordings, split and f_dyn, with every guess said in a comment.

use std::path::{Path, PathBuf};

use crate::Experiment;
use crate::workbench::failure::Failure;
use aurt::Error;
use aurt::data::{Loaded, Preprocessing, Purpose, Source};
use aurt::duplicates::{SampleRegister, UsedSeries};
use aurt_calibration::Rest;
use aurt_diagnosis::Role;
use aurt_files::escaped;
use aurt_plugins::Registry;
use aurt_rbd::robots::{DescribedRobot, Part, known_robot};
use aurt_rbd::{MdhRows, MdhTable, RobotDescription};
use aurt_recording::RobotJoints;
use aurt_traits::MeasurementUnit;
use toml_edit::Value;

use crate::doctor::inspection::inspected::{Inspected, Reading};
use crate::doctor::mistakes::{self, Examination, Subject, median_period_s};

const CALIBRATED_SHARE: f64 = 0.7;
const ONE_HELD_OUT_OF: usize = 3;

#[derive(Debug, Clone)]
pub struct Known {
    /// A name that `aurt robots` lists, a robot description file (.urdf, .xml) or a table of MDH parameters.
    pub robot: String,
    /// Which joint the rows of a table lead to, if that is known.
    pub mdh_rows: Option<MdhRows>,
    /// The link of a robot description that its chain starts from.
    pub base: Option<String>,
    pub part: Part,
    /// Gravity in the base frame, if that is known.
    pub gravity_m_s2: Option<[f64; 3]>,
    pub torque_constants_nm_per_a: Option<Vec<f64>>,
    pub recordings: Vec<(Source, Option<Role>)>,
}

#[derive(Debug)]
pub struct Draft {
    pub text: String,
    pub guesses: Vec<String>,
    /// What the setup doctor says of it, before its changes.
    pub examination: Option<Examination>,
}

/// A robot as `[robot]` gives it.
struct Arm {
    line: String,
    joints: RobotJoints,
    is_table: bool,
}

struct Looked {
    inspected: Inspected,
    unit_was_guessed: bool,
    role: Option<Role>,
}

/// Drafts an experiment that is to lie at `path`, and corrects it where the recordings say that it is wrong.
pub fn draft(known: &Known, path: &Path, registry: &mut Registry) -> Result<Draft, Failure> {
    let arm = arm(known, path)?;
    let mut guesses = Vec::new();
    let mut looked: Vec<Looked> = Vec::new();
    let mut register = SampleRegister::default();
    for (source, role) in &known.recordings {
        let one = look(source, *role, &arm.joints)?;
        guesses.extend(one.inspected.loaded.warnings().map(|w| format!("warning: {w}")));
        guesses.extend(
            one.inspected.stamps.map(|stamps| format!("{}: {stamps}, as was done here", source.label)),
        );
        match register.add(&UsedSeries::of(source, &one.inspected.loaded.recording, "recordings")) {
            Ok(()) => looked.push(one),
            Err(Error::Repeated { other, likeness, .. }) => {
                guesses.push(format!("{} {likeness} {} and is left out", source.label, other.display()));
            }
            Err(error) => return Err(error.into()),
        }
    }
    let roles = split(&looked, &mut guesses);
    let f_dyn_hz = aurt_recording::suitable_f_dyn_hz(looked.iter().map(|l| &l.inspected.prepared));
    let keys = bag_keys(known, &arm, &looked, &mut guesses);
    let text = text(known, &arm, &keys, &looked, &roles, f_dyn_hz, path);
    let experiment = Experiment::parse(&text, path, registry).map_err(Failure::Experiment)?;
    let measured = looked.iter().all(|l| l.inspected.loaded.recording.measurement.is_some());
    if !measured {
        return Ok(Draft { text, guesses, examination: None });
    }
    let subject = Subject::of_experiment(&experiment, mistakes::recordings_of(&experiment)?)?;
    let examination = mistakes::examine(&subject, registry)?;
    let (text, left) = mistakes::corrected(&experiment, &subject, &examination)?;
    // A correction that cannot be read back is none.
    Experiment::parse(&text, path, registry).map_err(Failure::Experiment)?;
    let mut head = String::new();
    for sentence in examination.sentences() {
        head.push_str(&format!("# The recordings said otherwise than the first guess. {sentence}\n"));
    }
    for order in left {
        head.push_str(&format!("# To be done by hand: {order}.\n"));
    }
    Ok(Draft { text: head + &text, guesses, examination: Some(examination) })
}

fn arm(known: &Known, experiment: &Path) -> Result<Arm, Failure> {
    let robot = known.robot.as_str();
    if let Some(named) = known_robot(robot) {
        let line = format!("name = {}\n", quoted(&named.name));
        return Ok(Arm { line, joints: of(&named.description()), is_table: false });
    }
    let file = Path::new(robot);
    if !file.is_file() {
        let meant = aurt_rbd::robots::probably_meant(robot)
            .map(|n| format!("did you mean {n}? "))
            .unwrap_or_default();
        return Err(Failure::argument(
            "--robot",
            format!("{robot} is neither a robot known by name nor a file"),
            format!(
                "{meant}`aurt robots` lists the names; else give a .urdf, an MJCF file or a table of MDH parameters"
            ),
        ));
    }
    let written = quoted(&written(file, experiment));
    if file.extension().is_some_and(|e| e == "urdf" || e == "xml") {
        let described = aurt_rbd::robots::read(file, known.base.as_deref(), &known.part, None)
            .map_err(|errors| {
                let remedy = "choose the ends of a chain with `--base` and `--tip`, those of several with `--tips`, or correct \
                              the file";
                Failure::argument("--robot", errors.to_string(), remedy)
            })?;
        let mut ends = match &known.part {
            _ if !described.tip.is_empty() => format!("tip = {}\n", quoted(&described.tip)),
            Part::Tips(tips) => {
                let listed: Vec<String> = tips.iter().map(|tip| quoted(tip)).collect();
                format!("tips = [{}]\n", listed.join(", "))
            }
            _ => String::new(),
        };
        if known.base.is_some() {
            ends.insert_str(0, &format!("base = {}\n", quoted(&described.base)));
        }
        let is_mjcf = aurt_files::read_text(file, aurt_rbd::robots::MOST_BYTES)
            .is_ok_and(|t| aurt_rbd::robots::is_mjcf(&t));
        let key = if is_mjcf { "mjcf" } else { "urdf" };
        return Ok(Arm {
            line: format!("{key} = {written}\n{ends}"),
            joints: of(&described),
            is_table: false,
        });
    }
    let rows = known.mdh_rows.unwrap_or_default();
    let table = MdhTable::from_path(file, rows)?;
    let (name, comment) = match (known.mdh_rows, rows) {
        (Some(MdhRows::Next), _) => ("next", ""),
        (Some(MdhRows::Previous), _) => ("previous", ""),
        (None, _) => (
            "next",
            "      # guessed: row j leads on to joint j + 1, as in the paper; \"previous\" is Craig's",
        ),
    };
    let line = format!("mdh = {written}\nmdh_rows = \"{name}\"{comment}\n");
    Ok(Arm { line, joints: table.rows.len().into(), is_table: true })
}

fn of(described: &DescribedRobot) -> RobotJoints {
    RobotJoints {
        count: described.joints(),
        names: described.joint_names.clone(),
        branches: described.branches.clone(),
        sliding: described.sliding(),
    }
}

/// `topic` and `joint_names`, as they were given; the names that the recordings have, where the robot has none.
fn bag_keys(known: &Known, arm: &Arm, looked: &[Looked], guesses: &mut Vec<String>) -> String {
    let given = known.recordings.first().map(|(source, _)| &source.recorded);
    let mut keys = String::new();
    if let Some(topic) = given.and_then(|g| g.topic.as_ref()) {
        keys.push_str(&format!("topic = {}\n", quoted(topic)));
    }
    let stated = given.and_then(|g| g.joint_names.as_deref());
    let first = looked.first().map_or(&[][..], |l| l.inspected.loaded.recording.joints.names());
    let names = stated.unwrap_or(if arm.joints.names.is_empty() { first } else { &[] });
    if !names.is_empty() {
        let listed: Vec<String> = names.iter().map(|name| quoted(name)).collect();
        if stated.is_none() {
            keys.push_str(
                "# Guessed: the order of the recording is that of the robot's joints, base first.\n",
            );
            guesses.push(format!(
                "the robot has no names for its joints: those of the recordings are taken in this order, base first: {}; if it is \
                 another, correct joint_names",
                names.join(", ")
            ));
        }
        keys.push_str(&format!("joint_names = [{}]\n", listed.join(", ")));
    } else if !first.is_empty() {
        guesses.push(format!("the robot's joints, base first: {}", first.join(", ")));
    }
    keys
}

/// Reads a recording; where it has currents and torques, the currents.
fn look(source: &Source, role: Option<Role>, joints: &RobotJoints) -> Result<Looked, Failure> {
    let read = |unit| {
        let source = Source { unit, ..source.clone() };
        Reading::of(source, |source| Loaded::read(source, Some(joints), Purpose::Calibration))
    };
    let (reading, unit_was_guessed) = match read(source.unit) {
        Ok(reading) => (reading, false),
        Err(error) if source.unit.is_none() => match read(Some(MeasurementUnit::Ampere)) {
            Ok(reading) => (reading, true),
            Err(_) => return Err(error.into()),
        },
        Err(error) => return Err(error.into()),
    };
    let rate_hz = 1.0 / median_period_s(&reading.loaded.recording.time_s);
    Ok(Looked {
        inspected: Inspected::new(reading, &Preprocessing::first_look(rate_hz))?,
        unit_was_guessed,
        role,
    })
}

/// The roles of recordings. Where none is known to validate, those without a role are split: what moves more calibrates, and at
/// least one is held out where there are two. Not beside targets: what validates shows the robot as it is in these, and a
/// diagnosis holds out the ends of them.
fn split(looked: &[Looked], guesses: &mut Vec<String>) -> Vec<Role> {
    let motion = |l: &Looked| {
        let joints = &l.inspected.joints;
        let moving = joints.iter().map(|j| j.moving_share).sum::<f64>() / joints.len().max(1) as f64;
        moving * l.inspected.loaded.recording.duration_s()
    };
    let mut roles: Vec<Role> = looked.iter().map(|l| l.role.unwrap_or(Role::Calibration)).collect();
    if roles.contains(&Role::Validation) {
        return roles;
    }
    if roles.contains(&Role::Target) {
        guesses.push("the diagnosis holds out the last quarter of each target".into());
        return roles;
    }
    let mut open: Vec<usize> = (0..looked.len()).filter(|k| looked[*k].role.is_none()).collect();
    open.sort_by(|a, b| motion(&looked[*a]).total_cmp(&motion(&looked[*b])));
    let held_out = if open.len() < 2 { 0 } else { open.len().div_ceil(ONE_HELD_OUT_OF).min(open.len() - 1) };
    open.iter().take(held_out).for_each(|k| roles[*k] = Role::Validation);
    if held_out > 0 {
        let count = open.len();
        guesses.push(format!("{held_out} of {count} recordings, those with the least motion, are held out"));
    } else if looked.len() == 1 {
        guesses.push("one recording: its beginning calibrates, its end validates".into());
    }
    roles
}

fn text(
    known: &Known,
    arm: &Arm,
    bag_keys: &str,
    looked: &[Looked],
    roles: &[Role],
    f_dyn_hz: Option<f64>,
    path: &Path,
) -> String {
    let mut text = format!("schema = 1\n\n[robot]\n{}", arm.line);
    let gravity = known.gravity_m_s2.unwrap_or([0.0, 0.0, -9.81]);
    let comment = if known.gravity_m_s2.is_some() { "" } else { "      # guessed: the base stands upright" };
    text.push_str(&format!(
        "gravity_m_s2 = [{:?}, {:?}, {:?}]{comment}\n",
        gravity[0], gravity[1], gravity[2]
    ));
    let unit = looked.first().map_or(MeasurementUnit::NewtonMetre, |l| l.inspected.loaded.recording.unit);
    if let Some(constants) = &known.torque_constants_nm_per_a {
        text.push_str(&format!("torque_constants_nm_per_a = {constants:?}\n"));
    } else if unit == MeasurementUnit::Ampere {
        text.push_str(
            "# Currents stay in A. With the drives' torque constants the model is in Nm; without them what joints share is \
             wrong by the ratios of the constants.\n\
             # torque_constants_nm_per_a = [\u{2026}]\n",
        );
    }
    if arm.is_table {
        text.push_str("# Lengths of the table are in m, angles in rad (pi/2 and the like may be written).\n");
    }
    text.push_str(
        "\n# Guessed: Coulomb and viscous friction in every joint; `aurt sweep` and `aurt diagnose` find better ones.\n\
         [joint_dynamics]\ncoulomb = { model = \"constant\" }\nhysteresis = { model = \"sign\" }\n\
         viscous = { model = \"polynomial\", powers = [1] }\n\n[recordings]\n",
    );
    text.push_str(bag_keys);
    for role in [Role::Calibration, Role::Target, Role::Validation] {
        let entries = entries(looked, roles, role, path);
        if !entries.is_empty() {
            text.push_str(&format!("{} = [\n{entries}]\n", role.name()));
        }
    }
    match f_dyn_hz {
        Some(f) => text.push_str(&format!(
            "\n[preprocess]\n# Guessed: the lowest usual value with room above the motion, as `aurt check` suggests.\n\
             f_dyn_hz = {f:?}\n"
        )),
        None => text.push_str("\n[preprocess]\nf_dyn_hz = 10.0      # guessed: nothing moves that would tell\n"),
    }
    let joints = looked.iter().flat_map(|l| &l.inspected.joints).filter(|j| j.moves());
    let rests = joints.map(|j| 1.0 - j.moving_share).fold(0.0, f64::max);
    if rests > Rest::MOST_KEPT {
        text.push_str(&format!(
            "\n[calibration]\n# Joints rest for up to {:.0} % of a recording. There the sign of the velocity is that of noise, and so would be \
             the model's friction.\nrest = \"exclude\"\n",
            100.0 * rests
        ));
    }
    text
}

fn entries(looked: &[Looked], roles: &[Role], role: Role, path: &Path) -> String {
    let mut entries = String::new();
    for (one, own) in looked.iter().zip(roles) {
        let loaded = &one.inspected.loaded;
        let file = quoted(&written(&loaded.source.file, path));
        let duration_s = loaded.recording.duration_s();
        let window = match (looked.len(), role) {
            (1, Role::Calibration) => Some([0.0, CALIBRATED_SHARE * duration_s]),
            (1, Role::Validation) => Some([CALIBRATED_SHARE * duration_s, duration_s]),
            _ if *own == role => None,
            _ => continue,
        };
        let unit = match (one.unit_was_guessed, loaded.source.unit) {
            (true, _) | (false, Some(MeasurementUnit::Ampere)) => ", unit = \"A\"",
            (false, Some(MeasurementUnit::NewtonMetre)) => ", unit = \"Nm\"",
            (false, None) => "",
        };
        let guess =
            if one.unit_was_guessed { "    # Guessed: of currents and torques the currents.\n" } else { "" };
        let columns = loaded.recording.report.columns.join("; ");
        let window =
            window.map_or_else(String::new, |[from, to]| format!(", window_s = [{from:.1}, {to:.1}]"));
        let time =
            one.inspected.stamps.map_or_else(String::new, |s| format!(", time = \"{}\"", s.unit.key()));
        let entry = if unit.is_empty() && window.is_empty() && time.is_empty() {
            file
        } else {
            format!("{{ file = {file}{unit}{time}{window} }}")
        };
        entries.push_str(&format!("    # {columns}\n{guess}    {entry},\n"));
    }
    entries
}

/// A path as the experiment writes it: as given where the experiment lies in the current folder, else absolute.
fn written(file: &Path, experiment: &Path) -> String {
    let here = experiment.parent().is_none_or(|p| p.as_os_str().is_empty() || p == Path::new("."));
    let path: PathBuf =
        if here { file.to_owned() } else { file.canonicalize().unwrap_or_else(|_| file.to_owned()) };
    escaped(&path.to_string_lossy()).to_string()
}

fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}
