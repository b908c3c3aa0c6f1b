//! LeRobot data sets: a folder with `meta/info.json` and Parquet files under `data/`.
//!
//! Source: <https://github.com/huggingface/lerobot>, data set formats v2.0, v2.1 (a file for each episode) and v3.0 (files of
//! many episodes).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use aurt_traits::MeasurementUnit;
use serde::Deserialize;
use serde_json::Value;

use crate::error::RecordingError;
use crate::format::{Reading, RecordingInput, refuse_foreign, unreadable};
use crate::memory::Memory;
use crate::parquet::{BETWEEN_EPISODES_S, PARQUET};
use crate::read_options::ReadOptions;
use crate::recorded_as::{ColumnRef, ColumnsRef};
use crate::recording::{RecordedJoints, Recording};
use crate::robot_joints::places;

/// Where a data set describes itself.
const INFO: &str = "meta/info.json";
const INFO_LIMIT: u64 = 64 << 20;
const STATE: &str = "observation.state";
const TORQUES: [&str; 2] = ["observation.effort", "observation.torque"];
const CURRENT: &str = "observation.current";
const VELOCITY: &str = "observation.velocity";
/// How far the frames' distance may be from what the data set says, relative.
const RATE_TOLERANCE: f64 = 0.05;
/// Folders within `data/` that are looked into, one in another.
const DEEPEST: usize = 3;

/// A data set: what it says of itself, and its files.
#[derive(Debug)]
pub(crate) struct DataSet {
    folder: PathBuf,
    info: Info,
    files: Vec<PathBuf>,
}

#[derive(Debug, Deserialize)]
struct Info {
    fps: f64,
    #[serde(default)]
    codebase_version: String,
    #[serde(default)]
    total_episodes: u64,
    features: BTreeMap<String, Feature>,
}

#[derive(Debug, Deserialize)]
struct Feature {
    #[serde(default)]
    shape: Vec<usize>,
    #[serde(default)]
    names: Value,
}

impl Feature {
    fn width(&self) -> usize {
        self.shape.iter().product()
    }

    /// The names of its numbers: a list, or lists by kind (`{"motors": […]}`); none that are not one for each number.
    fn names(&self) -> Vec<String> {
        let of_list = |list: &Value| -> Vec<String> {
            list.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
        };
        let names = match &self.names {
            Value::Object(kinds) => kinds.values().flat_map(of_list).collect(),
            list => of_list(list),
        };
        if names.len() == self.width() { names } else { Vec::new() }
    }
}

/// The folder of the data set that a path names: the folder itself, or its `meta/info.json`.
pub(crate) fn folder_of(path: &Path) -> Option<PathBuf> {
    if path.is_dir() {
        return path.join(INFO).is_file().then(|| path.to_owned());
    }
    let meta = path.parent().filter(|_| path.ends_with(INFO))?;
    Some(meta.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned())
}

impl DataSet {
    /// The data set that a path names, if it names one.
    ///
    /// # Errors
    /// A description that cannot be read, and a data set without files.
    pub fn named(path: &Path) -> Result<Option<Self>, RecordingError> {
        let Some(folder) = folder_of(path) else { return Ok(None) };
        let file = folder.join(INFO);
        let text = aurt_files::read_text(&file, INFO_LIMIT).map_err(|source| unreadable(&file, source))?;
        let info: Info = serde_json::from_str(&text).map_err(|error| {
            RecordingError::malformed(
                &file,
                format!("line {}", error.line()),
                format!("it does not describe a LeRobot data set: {error}"),
                "copy it again, or name the files under data/ one by one",
            )
        })?;
        let mut files = Vec::new();
        collect(&folder.join("data"), DEEPEST, &mut files);
        files.sort();
        let set = Self { folder, info, files };
        if set.files.is_empty() {
            return Err(set.refused(
                "its folder data/ holds no Parquet files",
                "download the whole data set: huggingface-cli download --repo-type dataset NAME --local-dir FOLDER",
            ));
        }
        Ok(Some(set))
    }

    /// Reads all episodes, one after another at a distance of 10 s, in the order of the files' names.
    ///
    /// # Errors
    /// Joints that are not there, and what is wrong with a file.
    pub fn read(
        &self,
        Reading { options, piece_rows, visit }: Reading<'_>,
    ) -> Result<Recording, RecordingError> {
        let (mut options, remarks, joints) = self.selected(options)?;
        let sizes = self.files.iter().filter_map(|file| file.metadata().ok());
        let memory = Memory::of(&self.folder, sizes.map(|file| file.len()).sum(), &options);
        let mut all: Option<Recording> = None;
        let mut clock = Clock::default();
        for file in &self.files {
            let held = all.as_ref().filter(|_| piece_rows == usize::MAX).map_or(0, Recording::bytes);
            options.memory_bytes = Some(memory.allowed_bytes().saturating_sub(held));
            let input = RecordingInput::open(file)?;
            refuse_foreign(file, &input.beginning)?;
            clock.begins_again();
            let mut place = |piece: &Recording| {
                let mut piece = piece.clone();
                piece.joints.clone_from(&joints);
                clock.place(&mut piece.time_s);
                visit(&piece)
            };
            let reading = Reading { options: &options, piece_rows, visit: &mut place };
            let mut recording = (PARQUET.read)(input, reading)?;
            clock.place(&mut recording.time_s);
            all = Some(match all {
                None => recording,
                Some(before) if piece_rows == usize::MAX => joined(before, recording),
                Some(before) => {
                    visit(&before)?;
                    after(&before, recording)
                }
            });
        }
        let Some(mut all) = all else {
            return Err(self.refused("it has no files", "download it again"));
        };
        all.file = self.folder.clone();
        all.joints = joints;
        all.report.format = self.name();
        all.report.remarks.splice(0..0, remarks);
        all.report.remarks.extend(self.other_rate(&clock));
        Ok(all)
    }

    fn name(&self) -> String {
        let (episodes, files) = (self.info.total_episodes, self.files.len());
        let plural = |n: u64, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        format!(
            "LeRobot data set {}, {} in {}, {} frames/s",
            self.info.codebase_version,
            plural(episodes, "episode"),
            plural(files as u64, "file"),
            self.info.fps
        )
    }

    fn other_rate(&self, clock: &Clock) -> Option<String> {
        let found = 1.0 / clock.shortest_s?;
        let differs = (found / self.info.fps - 1.0).abs() > RATE_TOLERANCE;
        differs.then(|| {
            format!(
                "the data set says {} frames/s, the stamps of its first file {found:.4}: the stamps hold",
                self.info.fps
            )
        })
    }

    /// The options with the columns of the robot's joints, and what is to be said of them.
    fn selected(
        &self,
        options: &ReadOptions,
    ) -> Result<(ReadOptions, Vec<String>, RecordedJoints), RecordingError> {
        let mut options = options.clone();
        if !self.info.features.contains_key("timestamp") && options.columns.time.is_none() {
            options.recorded.rate_hz.get_or_insert(self.info.fps);
        }
        if options.columns.position.is_some() {
            let joints = options.joints_read(&[]);
            return Ok((options, Vec::new(), joints));
        }
        let Some(state) = self.info.features.get(STATE).filter(|f| f.width() > 0) else {
            let known: Vec<&str> = self.info.features.keys().map(String::as_str).collect();
            return Err(self.refused(
                &format!("it has no feature `{STATE}`; its features are {}", known.join(", ")),
                "select the columns with `columns`",
            ));
        };
        let names = state.names();
        let places = self.places(&names, state.width(), &options)?;
        let listed: Vec<&str> = places.iter().filter_map(|k| names.get(*k)).map(String::as_str).collect();
        let remarks = if listed.is_empty() {
            Vec::new()
        } else {
            vec![format!("joints in this order: {}", listed.join(", "))]
        };
        let columns = |feature: &str| {
            let width = self.info.features.get(feature)?.width();
            let name = |k: &usize| if width == 1 { feature.to_owned() } else { format!("{feature}_{k}") };
            let fits = width == state.width();
            fits.then(|| ColumnsRef::List(places.iter().map(|k| ColumnRef::Name(name(k))).collect()))
        };
        options.columns.position = columns(STATE);
        options.columns.velocity = options.columns.velocity.take().or_else(|| columns(VELOCITY));
        if options.columns.measurement.is_none() {
            let torque = TORQUES.into_iter().find_map(columns).map(|c| (c, MeasurementUnit::NewtonMetre));
            let current = columns(CURRENT).map(|c| (c, MeasurementUnit::Ampere));
            let found = match options.unit {
                Some(MeasurementUnit::Ampere) => current.or(torque),
                Some(MeasurementUnit::NewtonMetre) => torque,
                None => torque.xor(current),
            };
            if let Some((columns, unit)) = found {
                options.columns.measurement = Some(columns);
                options.unit.get_or_insert(unit);
            }
        }
        let found: Vec<String> = listed.iter().map(|name| plain(name).to_owned()).collect();
        let joints = options.joints_read(&found);
        Ok((options, remarks, joints))
    }

    /// For each of the robot's joints its place in a frame.
    fn places(
        &self,
        names: &[String],
        width: usize,
        options: &ReadOptions,
    ) -> Result<Vec<usize>, RecordingError> {
        let remedy = "name the robot's joints as the data set does, in the robot's order: joint_names = […] in an experiment, \
                      --joint-names on the command line";
        let listed = || if names.is_empty() { "without names".to_owned() } else { names.join(", ") };
        let wanted = options.joint_names();
        if wanted.is_empty() || names.is_empty() {
            return match options.joint_count().filter(|n| *n != width) {
                None => Ok((0..width).collect()),
                Some(robot) => Err(self.refused(
                    &format!("`{STATE}` has {width} numbers, the robot has {robot} joints: {}", listed()),
                    if names.is_empty() { "select the columns with `columns`" } else { remedy },
                )),
            };
        }
        let plainly = |names: &[String]| names.iter().map(|name| plain(name).to_owned()).collect::<Vec<_>>();
        let found = places(wanted, names).or_else(|_| places(&plainly(wanted), &plainly(names)));
        found.map_err(|lacking| RecordingError::JointNames {
            path: self.folder.clone(),
            recorded: names.to_vec(),
            wanted: wanted.to_vec(),
            lacking,
        })
    }

    fn refused(&self, reason: &str, remedy: &str) -> RecordingError {
        RecordingError::malformed(&self.folder, INFO, reason, remedy)
    }
}

/// A motor's name without what versions of LeRobot put before or behind it.
fn plain(name: &str) -> &str {
    let name = name.strip_suffix(".pos").unwrap_or(name);
    name.strip_prefix("main_").or_else(|| name.strip_prefix("follower_")).unwrap_or(name)
}

fn collect(folder: &Path, deepest: usize, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() && deepest > 0 {
            collect(&path, deepest - 1, files);
        } else if path.extension().is_some_and(|e| e == "parquet") {
            files.push(path);
        }
    }
}

/// Moves the stamps of each file to after those of the files before.
#[derive(Debug, Default)]
struct Clock {
    shift_s: Option<f64>,
    last_s: Option<f64>,
    /// The shortest distance of the first stamps, which no gap lengthens.
    shortest_s: Option<f64>,
}

impl Clock {
    fn begins_again(&mut self) {
        self.shift_s = None;
    }

    fn place(&mut self, time_s: &mut [f64]) {
        let (Some(first), Some(last)) = (time_s.first().copied(), time_s.last().copied()) else { return };
        if self.shortest_s.is_none() {
            let distances = time_s.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 0.0);
            self.shortest_s = distances.min_by(f64::total_cmp);
        }
        let last_s = self.last_s;
        let shift =
            *self.shift_s.get_or_insert_with(|| last_s.map_or(0.0, |l| l + BETWEEN_EPISODES_S - first));
        if shift != 0.0 {
            time_s.iter_mut().for_each(|t| *t += shift);
        }
        self.last_s = Some(last + shift);
    }
}

fn joined(mut before: Recording, next: Recording) -> Recording {
    let mut next = after(&before, next);
    before.report = std::mem::take(&mut next.report);
    before.extend(next);
    before
}

fn after(before: &Recording, mut next: Recording) -> Recording {
    let (of_all, report) = (&before.report, &mut next.report);
    report.dropped.iter_mut().for_each(|row| row.line += of_all.rows);
    report.dropped.splice(0..0, of_all.dropped.iter().cloned());
    report.dropped_rows += of_all.dropped_rows;
    report.rows_without_numbers += of_all.rows_without_numbers;
    report.repeated_rows += of_all.repeated_rows;
    let rows = u32::try_from(of_all.rows).unwrap_or(u32::MAX);
    report.absent.iter_mut().for_each(|row| *row = row.saturating_add(rows));
    report.absent.splice(0..0, of_all.absent.iter().copied());
    report.rows += of_all.rows;
    report.remarks.retain(|remark| !of_all.remarks.contains(remark));
    report.remarks.splice(0..0, of_all.remarks.iter().cloned());
    report.origin_s = of_all.origin_s;
    next
}
