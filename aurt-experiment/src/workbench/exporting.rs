//! Calibrated models as sources and files of other programs.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

pub use aurt_export::fmu::Kind;
use aurt_export::fmu::{self, Fmu};
pub use aurt_export::into::Format;
use aurt_export::into::{self, Corrected, Original};
use aurt_export::{Check, Export, Provenance, Source, c, mjcf, rust, sdf, urdf};
use aurt_plugins::Registry;
use aurt_plugins::model::model_file::read_json;
use aurt_rbd::robots::{Part, RobotError};
use aurt_simulation::Random;
use aurt_traits::{Motion, MotionView};
use serde_json::Value;

use crate::workbench::failure::Failure;
use crate::workbench::output::OutputFolder;
use crate::workbench::read_back::{TorqueDifference, WrittenDescription, torque_differences};
use aurt::CalibratedModel;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A C99 header and source.
    C,
    Mjcf,
    Rust,
    Urdf,
    Sdf,
    Fmu(Kind),
    /// Actuators of Isaac Lab, of drives alone.
    Isaac,
}

/// A calibrated model with the file that it is in, which exports name.
#[derive(Debug, Clone)]
pub struct ModelFile {
    calibrated: CalibratedModel,
    path: Option<PathBuf>,
    document: Value,
    blake3: String,
}

const OWN_NAME: &str = "rd_calibrated.json";

impl ModelFile {
    pub fn read(path: &Path, registry: &Registry) -> Result<Self, Failure> {
        let (document, text) = read_json(path)?;
        Self::from_document(path, document, &text, registry)
    }

    /// The model in what was read of a file, its value and its text; `path` is what errors call it.
    pub fn from_document(
        path: &Path,
        document: Value,
        text: &str,
        registry: &Registry,
    ) -> Result<Self, Failure> {
        let calibrated = CalibratedModel::from_document(path, &document, text, registry)?;
        Ok(Self { calibrated, path: Some(path.to_owned()), document, blake3: hash(text.as_bytes()) })
    }

    /// A model in memory, with the file that saving makes of it.
    pub fn of(calibrated: CalibratedModel) -> Result<Self, Failure> {
        let contents = calibrated.to_file()?;
        let document = serde_json::from_slice(&contents).unwrap_or_default();
        Ok(Self { calibrated, path: None, document, blake3: hash(&contents) })
    }
}

fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    pub files: Vec<(String, Vec<u8>)>,
    pub changed: Vec<String>,
    pub lost: Vec<String>,
    pub notes: Vec<String>,
    /// Torques of each joint in a MuJoCo or URDF file, which AURT reads too, less those of the model.
    pub differences: Vec<TorqueDifference>,
}

impl From<Export> for Exported {
    fn from(Export { files, lost, notes }: Export) -> Self {
        let files = files.into_iter().map(|(name, text)| (name, text.into_bytes())).collect();
        Self { files, changed: Vec::new(), lost, notes, differences: Vec::new() }
    }
}

impl From<Fmu> for Exported {
    fn from(Fmu { file, bytes, lost, notes }: Fmu) -> Self {
        Self { files: vec![(file, bytes)], changed: Vec::new(), lost, notes, differences: Vec::new() }
    }
}

impl Exported {
    /// The same with the torques of its file, read back, beside those of the model.
    fn read_back(
        mut self,
        calibrated: &CalibratedModel,
        format: Format,
        base: Option<&str>,
        part: &Part,
    ) -> Self {
        let Some((name, contents)) = self.files.first() else { return self };
        let text = String::from_utf8_lossy(contents);
        let written = WrittenDescription { text: &text, path: Path::new(name), format, base, part };
        match torque_differences(calibrated, &written) {
            Ok(differences) => self.differences = differences,
            Err(error) => self.notes.push(format!("its torques were not compared with the model's: {error}")),
        }
        self
    }

    /// Writes the files into a folder, all or none; `inputs` are what must survive. Returns their paths.
    pub fn write(
        &self,
        out: &OutputFolder,
        option: &'static str,
        inputs: &[&Path],
        replaced: Replaced,
    ) -> Result<Vec<PathBuf>, Failure> {
        let paths: Vec<PathBuf> = self.files.iter().map(|(name, _)| out.path().join(name)).collect();
        for path in &paths {
            let refuse = |reason: &str, remedy: &str| Err(Failure::output(option, path, reason, remedy));
            let remedy = "name another folder, remove the file, or overwrite it with `--force` (in Python `force=True`)";
            // An archive of another kind or version has the same name, and importers keep what they have unpacked.
            let is_archive = path.extension().is_some_and(|extension| extension == "fmu");
            if replaced == Replaced::Exports && path.symlink_metadata().is_ok() {
                if is_archive {
                    return refuse("exists", remedy);
                }
                if !is_export(path) {
                    return refuse("exists and is not by `aurt export`", remedy);
                }
            }
            if inputs.iter().any(|input| same_file(path, input)) {
                return refuse("is an input of this command and would be overwritten", "name another folder");
            }
        }
        out.write(&self.files)?;
        Ok(paths)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replaced {
    /// Text files of earlier exports.
    Exports,
    Any,
}

fn is_export(path: &Path) -> bool {
    let mut beginning = Vec::new();
    // Whatever is no regular file, or is not read, is not ours; it is no input that has to survive.
    let mut read = || File::open(path)?.take(HEADING_BYTES).read_to_end(&mut beginning);
    path.is_file() && read().is_ok() && aurt_export::is_export(&String::from_utf8_lossy(&beginning))
}

/// Bytes at the beginning of an export that state where it comes from; `mjcf --into` puts them before the user's own text.
const HEADING_BYTES: u64 = 1 << 16;

fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

impl Target {
    /// All of them as users write them, with what they are; an FMU is of inverse dynamics unless something else is asked for.
    pub const NAMES: [(&str, &str, Self); 7] = [
        ("c", "C99 header and source, and a program that checks them", Self::C),
        ("rust", "Rust crate without dependencies, and a test that checks it", Self::Rust),
        ("mjcf", "MuJoCo model", Self::Mjcf),
        ("urdf", "URDF file", Self::Urdf),
        ("sdf", "SDF file", Self::Sdf),
        ("fmu", "Functional mock-up unit, FMI co-simulation", Self::Fmu(Kind::Inverse)),
        ("isaac", "Actuators of Isaac Lab, of drives", Self::Isaac),
    ];

    pub fn name(self) -> &'static str {
        let is_it = |other: &Self| std::mem::discriminant(other) == std::mem::discriminant(&self);
        Self::NAMES.iter().find(|(.., target)| is_it(target)).map_or("", |(name, ..)| name)
    }

    /// The same; of an FMU, what it computes.
    #[must_use]
    pub const fn of_kind(self, kind: Option<Kind>) -> Self {
        match (self, kind) {
            (Self::Fmu(_), Some(kind)) => Self::Fmu(kind),
            (target, _) => target,
        }
    }

    /// The format of a user's file that the target can correct.
    pub const fn format(self) -> Option<Format> {
        match self {
            Self::Mjcf => Some(Format::Mjcf),
            Self::Urdf => Some(Format::Urdf),
            _ => None,
        }
    }
}

/// States at which exported sources are compared with the model.
const STATES: usize = 32;
/// Samples of a path, for models with memory, and their distance, s.
const PATH: usize = 96;
const PATH_STEP_S: f64 = 0.02;
const SEED: u64 = 1;
/// Positions of the states, rad or m, and accelerations, rad/s² or m/s².
const REACH: f64 = 3.0;
const ACCELERATION: f64 = 10.0;

pub fn export(model: &ModelFile, name: &str, target: Target) -> Result<Exported, Failure> {
    with_source(model, name, |source, calibrated| {
        Ok(match target {
            Target::C => c::export(source, &checks(calibrated)?)?.into(),
            Target::Rust => rust::export(source, &checks(calibrated)?)?.into(),
            Target::Mjcf => {
                let exported = Exported::from(mjcf::export(source)?);
                exported.read_back(calibrated, Format::Mjcf, None, &Part::All)
            }
            Target::Urdf => {
                let exported = Exported::from(urdf::export(source)?);
                exported.read_back(calibrated, Format::Urdf, None, &Part::All)
            }
            Target::Sdf => sdf::export(source)?.into(),
            Target::Fmu(kind) => fmu::export(source, kind)?.into(),
            Target::Isaac => {
                let reason = "is a model of torques, and Isaac Lab's actuators are of drives";
                let remedy = "name drive_calibrated.json of an experiment with [drive]";
                return Err(Failure::argument("MODEL", reason, remedy));
            }
        })
    })
}

/// The dynamics of a model in the user's MuJoCo or URDF file `into`: the same file with other inertias and
/// dynamics of joints, under another name. The robot is the chain from `base` to `tip`; without a tip the joints of the file
/// that have the names of the model's, or all of it.
pub fn correct(
    model: &ModelFile,
    into: &Path,
    format: Format,
    [base, tip]: [Option<&str>; 2],
) -> Result<Exported, Failure> {
    let text = aurt_files::read_text(into, aurt_rbd::robots::MOST_BYTES).map_err(|source| {
        aurt_rbd::robots::RobotErrors::from(RobotError::Unreadable { path: into.to_owned(), source })
    })?;
    // Without a tip it is the part that the model's joints name, or else all of the file.
    let names = model.calibrated.model.rigid_body().joint_names();
    let named = Part::Joints(names.to_vec());
    let is_named = tip.is_none() && aurt_rbd::robots::parse(&text, into, base, &named, None).is_ok();
    let part = &if is_named { named } else { Part::from(tip) };
    let original = Original { text: &text, path: into, format, base, part };
    with_source(model, "robot", |source, calibrated| {
        let Corrected { text, changed, lost, notes } = into::correct(source, &original)?;
        let stem = into.file_stem().unwrap_or_default().to_string_lossy();
        let extension = match format {
            Format::Mjcf => "xml",
            Format::Urdf => "urdf",
        };
        let files = vec![(format!("{stem}_calibrated.{extension}"), text.into_bytes())];
        let exported = Exported { files, changed, lost, notes, differences: Vec::new() };
        Ok(exported.read_back(calibrated, format, base, part))
    })
}

fn with_source(
    ModelFile { calibrated, path, document, blake3 }: &ModelFile,
    name: &str,
    make: impl FnOnce(&Source<'_>, &CalibratedModel) -> Result<Exported, Failure>,
) -> Result<Exported, Failure> {
    let calibration = &calibrated.calibration;
    let file = path.as_deref().unwrap_or(Path::new(OWN_NAME));
    let provenance = Provenance {
        file: file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned()),
        schema: document.get("schema").and_then(Value::as_u64).unwrap_or_default(),
        blake3: blake3.clone(),
        aurt_version: document.get("aurt_version").and_then(Value::as_str).map(str::to_owned),
        recordings: calibration
            .recordings
            .iter()
            .map(|name| match calibrated.origins.blake3(name) {
                Some(hash) => format!("{name} (BLAKE3 {hash})"),
                None => name.clone(),
            })
            .collect(),
    };
    let coefficients = calibration.coefficients();
    let standard: Option<Vec<f64>> =
        calibration.consistent.as_ref().map(|report| report.standard.iter().map(|s| s.value).collect());
    let source = Source {
        name,
        model: &calibrated.model,
        coefficients: &coefficients,
        load: &calibration.load,
        unit: calibration.unit,
        standard: standard.as_deref(),
        provenance: &provenance,
    };
    make(&source, calibrated)
}

fn checks(calibrated: &CalibratedModel) -> Result<Vec<Check>, Failure> {
    let joints = calibrated.model.joints();
    let remembers = calibrated.model.stacks().iter().any(|stack| {
        stack.coulomb().state_len() + stack.hysteresis().state_len() + stack.viscous().state_len() > 0
    }) || calibrated.model.arm_terms().iter().any(|term| term.state_len(joints) > 0);
    let speed = |j: usize| calibrated.calibration.ranges[j].velocity_rad_s;
    let (times, states) = if remembers { along_a_path(joints, speed) } else { random_states(joints, speed) };
    let by_joint =
        |k: usize| -> Vec<f64> { (0..joints).flat_map(|j| states.iter().map(move |s| s[k][j])).collect() };
    let motion = Motion::new(joints, times, by_joint(0), by_joint(1), by_joint(2))?;
    let view: MotionView<'_> = motion.view();
    let torque = calibrated.torque(view)?;
    Ok(states
        .into_iter()
        .enumerate()
        .map(|(n, [q_rad, qd_rad_s, qdd_rad_s2])| Check {
            time_s: view.time_s()[n],
            q_rad,
            qd_rad_s,
            qdd_rad_s2,
            torque_nm: torque.iter().map(|series| series[n]).collect(),
        })
        .collect())
}

type States = (Vec<f64>, Vec<[Vec<f64>; 3]>);

/// States within the velocities of the calibration; in the first, all joints rest.
fn random_states(joints: usize, speed: impl Fn(usize) -> f64) -> States {
    let mut random = Random::new(SEED);
    let mut within = |reach: f64| reach * (2.0 * random.unit() - 1.0);
    let mut states = Vec::with_capacity(STATES);
    for state in 0..STATES {
        let mut draw =
            |reach: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..joints).map(|j| within(reach(j))).collect() };
        let speed = |j: usize| if state == 0 { 0.0 } else { speed(j) };
        states.push([draw(&|_| REACH), draw(&speed), draw(&|_| ACCELERATION)]);
    }
    ((0..STATES).map(|n| n as f64).collect(), states)
}

/// Samples of sines that reverse, of large and of small amplitude in turn, for friction that remembers its path.
fn along_a_path(joints: usize, speed: impl Fn(usize) -> f64) -> States {
    let mut random = Random::new(SEED);
    let waves: Vec<[f64; 2]> =
        (0..joints).map(|_| [4.0 + 4.0 * random.unit(), std::f64::consts::TAU * random.unit()]).collect();
    let times: Vec<f64> = (0..PATH).map(|n| PATH_STEP_S * n as f64).collect();
    let states = times.iter().enumerate().map(|(n, time_s)| {
        let share = if n % 32 < 16 { 0.01 } else { 0.5 };
        [0.0, 1.0, 2.0].map(|derivative| {
            let wave = |(j, [rate, start]): (usize, &[f64; 2])| {
                let phase = rate * time_s + start + derivative * std::f64::consts::FRAC_PI_2;
                share * speed(j) / rate * rate.powf(derivative) * phase.sin()
            };
            waves.iter().enumerate().map(wave).collect()
        })
    });
    let states = states.collect();
    (times, states)
}
