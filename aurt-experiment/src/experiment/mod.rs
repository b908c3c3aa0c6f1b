//! Reading an experiment: one TOML file that says which robot, which models, which recordings and how to fit.
//!
//! Everything that is wrong with the file is found in one pass and reported together, each problem with the place
//! of the key or value at fault. The text is kept as it was written, so that editors can change single keys and
//! leave comments and order alone.

mod calibration;
mod columns;
mod drive;
mod errors;
mod geometry;
mod joined;
mod joint_count;
mod joint_dynamics;
mod magnitude;
mod paths;
mod preprocess;
mod recorded_as;
mod recordings;
mod robot;
mod section;

use std::path::{Path, PathBuf};

use aurt::data::Instrument;
use aurt_calibration::CalibrationOptions;
use aurt_files::{MOST_TABLES, MOST_TEXT_BYTES, read_text, table_beyond};
use aurt_recording::PreprocessOptions;
use aurt_traits::ArmTerm;
use toml::de::DeTable;

pub use self::columns::numbered_columns;
pub use self::drive::Drive;
pub use self::errors::{Complaint, ExperimentErrors, Problem};
pub use self::geometry::Geometry;
use self::joint_count::JointCheck;
pub use self::joint_dynamics::{JointDynamics, JointOverride};
pub use self::recordings::{Recordings, place_among};
pub use self::robot::Robot;
use self::section::{Reader, Section};
use crate::Error;
use aurt_plugins::{Node, NodeKind, Registry};

/// The version of the experiment file that this program reads: `schema = 1`.
pub const SCHEMA: i64 = 1;

/// An experiment, checked: all its files exist, all its models are built, all its lists fit the robot.
#[derive(Debug, Clone)]
pub struct Experiment {
    pub path: PathBuf,
    pub source_text: String,
    pub robot: Robot,
    pub joint_dynamics: JointDynamics,
    /// `[[arm_terms]]`, in the order of writing.
    pub arm_terms: Vec<Box<dyn ArmTerm>>,
    /// `recordings` of each arm term: the files in which it acts, as `[recordings]` writes them; all unless given
    /// (a payload that only some recordings carry).
    pub arm_term_recordings: Vec<Option<Vec<String>>>,
    /// `[instrument]`: of joint j's raw measurement preprocessing makes (raw_j(t + delay_s\[j\]) − offsets\[j\]) / gains\[j\]; the
    /// `torque_constants_nm_per_a` of `[robot]`, if there are any, multiply that, and the model is in Nm.
    pub instrument: Instrument,
    pub recordings: Recordings,
    /// `[preprocess]`, without what `[instrument]` says.
    pub preprocess: PreprocessOptions,
    /// `[calibration]`, and what of `[preprocess]` concerns it.
    pub calibration: CalibrationOptions,
    /// `prior = "description"`, as its `prior_weight`: the inertial parameters of the robot's URDF or MJCF file are what
    /// `"consistent"` estimates are pulled towards, by 1/σ², where σ is the relative standard deviation of the file's masses and
    /// second moments. With zero they decide only what the recordings leave open.
    pub prior_weight: Option<f64>,
    /// `[drive]`: what is between the robot's commands and its torques, where those are not recorded.
    pub drive: Option<Drive>,
    /// `libraries` of `[plugins]`: the dynamic libraries that were loaded for this experiment.
    pub libraries: Vec<PathBuf>,
    /// `[diagnosis]`, as it was written.
    pub diagnosis: Option<Node>,
    /// `[sweep]`, as it was written.
    pub sweep: Option<Node>,
    /// What a person should know of how the file was read.
    pub notes: Vec<String>,
}

impl Experiment {
    /// Reads an experiment whose recordings hold torques or currents from its file. Libraries that it names are loaded into
    /// `registry`.
    pub fn read(path: impl AsRef<Path>, registry: &mut Registry) -> Result<Self, Error> {
        let read = Self::read_with_drives(path, registry)?;
        let Some(drive) = &read.drive else { return Ok(read) };
        let complaint =
            Complaint::new(&drive.span, "[drive]: the recordings hold commands, and this needs torques")
                .help("use `aurt run`, `aurt diagnose` and `aurt next`, and `aurt predict` and `aurt export mjcf` with the drive_calibrated.json that it writes");
        Err(Box::new(ExperimentErrors::new(read.path, read.source_text, vec![complaint])).into())
    }

    /// Reads any experiment from its file.
    pub fn read_with_drives(path: impl AsRef<Path>, registry: &mut Registry) -> Result<Self, Error> {
        let path = path.as_ref();
        let text = read_text(path, MOST_TEXT_BYTES)
            .map_err(|source| aurt_plugins::model::Error::Read { path: path.to_owned(), source })?;
        Ok(Self::parse(&text, path, registry)?)
    }

    /// Reads an experiment from its text; relative paths start at the folder of `path`.
    pub fn parse(text: &str, path: &Path, registry: &mut Registry) -> Result<Self, Box<ExperimentErrors>> {
        let fail = |complaints| Box::new(ExperimentErrors::new(path.to_owned(), text.to_owned(), complaints));
        let root = syntax(text).map_err(fail)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let reader = Reader::new(folder);
        magnitude::check(&root, &reader);
        let (experiment, sizes) = read_sections(&root, &reader, path, text, registry);
        let (mut complaints, checks) = reader.into_complaints();
        if let Some((joints, links)) = sizes {
            complaints.extend(checks.into_iter().flat_map(|check| check.complaints(joints, links)));
        }
        experiment.filter(|_| complaints.is_empty()).ok_or_else(|| fail(complaints))
    }

    pub fn joints(&self) -> usize {
        self.robot.joints()
    }
}

/// The text as a table, or everything that makes it no TOML.
fn syntax(text: &str) -> Result<Node, Vec<Complaint>> {
    if let Some(at) = table_beyond(text) {
        let message = format!("an experiment has at most {MOST_TABLES} tables, and this is one more");
        return Err(vec![Complaint::new(at..at, message)]);
    }
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        let said = |e: &toml::de::Error| {
            Complaint::new(e.span().unwrap_or(0..0), format!("this is not TOML: {}", e.message()))
        };
        return Err(first_of_each_line(text, errors.iter().map(said).collect()));
    }
    let (root, unreadable) = Node::from_toml(table.get_ref(), 0..0);
    if unreadable.is_empty() {
        return Ok(root);
    }
    Err(unreadable.into_iter().map(|span| Complaint::new(span, "the number is too large")).collect())
}

/// The first complaint about each line: what follows it is mostly its consequence.
fn first_of_each_line(text: &str, mut complaints: Vec<Complaint>) -> Vec<Complaint> {
    complaints.sort_by_key(|c| c.span.start);
    let mut line_end = None;
    complaints.retain(|c| {
        let start = c.span.start.min(text.len());
        let is_first = line_end.is_none_or(|end| start > end);
        if is_first {
            let rest = &text.as_bytes()[start..];
            line_end = Some(start + rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len()));
        }
        is_first
    });
    complaints
}

/// All sections, and the numbers of joints and links as soon as they can be known; no experiment where a section is unusable.
fn read_sections(
    root: &Node,
    reader: &Reader,
    path: &Path,
    text: &str,
    registry: &mut Registry,
) -> (Option<Experiment>, Option<(usize, usize)>) {
    let Some(mut top) = Section::new(reader, root, "the experiment") else { return (None, None) };
    read_schema(&mut top);
    let libraries = read_libraries(&mut top, registry);
    top.require("robot", "[robot] with `mdh` (or `urdf`, `mjcf`, `name`) and `gravity_m_s2`");
    let mut instrument = Instrument::default();
    let (mut robot, joints) =
        top.section("robot").map_or((None, None), |section| Robot::read(section, &mut instrument));
    let links = robot.as_ref().map_or(0, |robot| robot.geometry.links());
    let sizes = joints.map(|joints| (joints, links.max(joints)));
    let dynamics = top.section("joint_dynamics");
    let joint_dynamics = JointDynamics::read(dynamics, reader, registry);
    let (arm_terms, arm_term_recordings) = read_arm_terms(&mut top, registry).into_iter().unzip();
    if let Some(mut section) = top.section("instrument") {
        instrument.gains = section.factors("gains");
        instrument.offsets = section.per_joint("offsets");
        instrument.delay_s = section.per_joint("delay_s");
        section.finish();
    }
    top.require("recordings", "[recordings] with `calibration`");
    let recordings = top.section("recordings").map(Recordings::read).unwrap_or_default();
    // What names the joints in the recordings names those of a robot that has no names.
    let stated = recordings.calibration.first().and_then(|source| source.recorded.joint_names.as_ref());
    if let Some((robot, names)) = robot.as_mut().zip(stated).filter(|(robot, _)| robot.joint_names.is_empty())
    {
        robot.joint_names.clone_from(names);
    }
    let preprocess = top.section("preprocess").map(preprocess::read).unwrap_or_default();
    let drive = top.section("drive");
    let driven = drive.is_some();
    for key in ["joint_dynamics", "arm_terms", "instrument", "preprocess"] {
        if let Some(node) = top.take(key).filter(|_| driven) {
            let what = "is for fits of torques; what a [drive] needs, friction too, stands in [drive]";
            top.complain(key, node, what, Some("remove it, or [drive]".to_owned()));
        }
    }
    let drive = drive.and_then(|section| Drive::read(section, joints));
    let calibration = top.section("calibration").map(|s| calibration::read(s, robot.as_ref(), driven));
    let (calibration, prior_weight) = calibration.unwrap_or_default();
    let calibration =
        CalibrationOptions { rest_velocity_rad_s: preprocess.rest_velocity_rad_s, ..calibration };
    let [diagnosis, sweep] = ["diagnosis", "sweep"].map(|key| top.take(key).cloned());
    top.finish();
    let experiment = robot.zip(joint_dynamics).map(|(robot, joint_dynamics)| Experiment {
        path: path.to_owned(),
        source_text: text.to_owned(),
        robot,
        joint_dynamics,
        arm_terms,
        arm_term_recordings,
        instrument,
        recordings,
        preprocess,
        calibration,
        prior_weight,
        drive,
        libraries,
        diagnosis,
        sweep,
        notes: reader.notes(),
    });
    (experiment, sizes)
}

fn read_schema(top: &mut Section<'_, '_>) {
    let Some(node) = top.require("schema", "schema = 1") else { return };
    match node.kind {
        NodeKind::Integer(SCHEMA) => {}
        NodeKind::Integer(n) => {
            let message = format!("is {n}, another version of the experiment file");
            top.complain("schema", node, &message, Some(format!("this program reads schema {SCHEMA}")));
        }
        _ => top.expected("schema", node, &SCHEMA.to_string()),
    }
}

/// Loads what `[plugins]` names, so that the models of the other sections are known.
fn read_libraries(top: &mut Section<'_, '_>, registry: &mut Registry) -> Vec<PathBuf> {
    let Some(mut section) = top.section("plugins") else { return Vec::new() };
    let mut libraries = Vec::new();
    if let Some(node) = section.take("libraries") {
        match &node.kind {
            NodeKind::Array(items) => {
                for item in items {
                    let Some(path) = section.file_of("libraries", item) else { continue };
                    if let Err(error) = registry.load_named_library(&path) {
                        section.reader.complain(Complaint::new(item.span.clone(), error.to_string()));
                    }
                    libraries.push(path);
                }
            }
            _ => section.expected("libraries", node, "a list of files"),
        }
    }
    section.finish();
    libraries
}

/// Arm terms of the largest experiment: eight on each joint of the largest robot, about; the work for a model grows with the square
/// of their number.
const MOST_ARM_TERMS: usize = 1000;

/// An arm term and the recordings in which it acts.
type ScopedTerm = (Box<dyn ArmTerm>, Option<Vec<String>>);

fn read_arm_terms(top: &mut Section<'_, '_>, registry: &Registry) -> Vec<ScopedTerm> {
    let reader = top.reader;
    let mut terms = Vec::new();
    let tables = top.tables("arm_terms");
    if let Some(beyond) = tables.get(MOST_ARM_TERMS) {
        let message =
            format!("an experiment has at most {MOST_ARM_TERMS} arm terms, this one {}", tables.len());
        let help = "a term's `joints` may list many joints, and each physics needs one term on a joint";
        reader.complain(Complaint::new(&beyond.span, message).help(help));
        return terms;
    }
    for table in tables {
        let (table, recordings) = without_scope(table, reader);
        if let Some(term) = joint_dynamics::build::<dyn ArmTerm>(reader, registry, &table) {
            reader.check_joints(JointCheck::ArmTerm { term: term.clone(), table });
            terms.push((term, recordings));
        }
    }
    terms
}

/// Takes `recordings` out of an arm term's table; the rest is the model's.
fn without_scope(table: &Node, reader: &Reader) -> (Node, Option<Vec<String>>) {
    let Some(scope) = table.get("recordings") else { return (table.clone(), None) };
    let mut rest = table.clone();
    if let NodeKind::Table(entries) = &mut rest.kind {
        entries.retain(|e| e.key != "recordings");
    }
    let names = match &scope.kind {
        NodeKind::Array(items) => {
            items.iter().map(|i| i.as_str().map(str::to_owned)).collect::<Option<Vec<String>>>()
        }
        _ => None,
    };
    if names.is_none() {
        reader.complain(
            Complaint::new(scope.span.clone(), "`recordings` of an arm term expects a list of file names")
                .help("write the files in which the term acts as `[recordings]` does: [\"payload_50s.csv\"]"),
        );
    }
    (rest, names)
}
