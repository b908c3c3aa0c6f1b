//! Planned motions as LeRobot data sets of one episode, format 3.0.
//!
//! Source: <https://github.com/huggingface/lerobot>, `lerobot/datasets/utils.py` and `lerobot_dataset.py` of version 0.4.

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::error::RecordingError;
use crate::written::parquet::{TableColumn, TableValues, table};
use crate::written::planned_motion::PlannedMotion;

/// The task that the frames of the episode belong to.
const TASK: &str = "execute the planned motion";
const DATA: &str = "data/chunk-000/file-000.parquet";
const EPISODES: &str = "meta/episodes/chunk-000/file-000.parquet";
const TASKS: &str = "meta/tasks.parquet";
const INFO: &str = "meta/info.json";
const STATISTICS: &str = "meta/stats.json";
const COUNTERS: [&str; 4] = ["frame_index", "episode_index", "index", "task_index"];

impl PlannedMotion {
    /// Files that [`Self::to_lerobot`] makes.
    pub const LEROBOT_FILES: [&str; 5] = [INFO, STATISTICS, TASKS, EPISODES, DATA];

    /// The motion as the files of a LeRobot data set, by their names in its folder: one episode of `frames_per_s` frames a second,
    /// without images. `action` has the positions in rad (or m), in single precision as every data set of LeRobot, and so has
    /// `observation.state`. Motors are called as the joints, with `.pos` at the end.
    ///
    /// # Errors
    /// [`RecordingError::Malformed`] for columns that Parquet cannot have; `path` is what it names.
    pub fn to_lerobot(
        &self,
        path: &Path,
        frames_per_s: u32,
    ) -> Result<Vec<(String, Vec<u8>)>, RecordingError> {
        let rows = self.time_s.len();
        let joints = self.position_rad.len();
        let place = |frame: usize| self.position_rad.iter().map(move |series| series[frame] as f32);
        let positions: Vec<f32> = (0..rows).flat_map(place).collect();
        let stamps: Vec<f32> = (0..rows).map(|k| (k as f64 / f64::from(frames_per_s)) as f32).collect();
        let frames: Vec<i64> = (0..rows as i64).collect();
        let zeros = vec![0; rows];
        // A feature with a single number has no lists.
        let list = (joints != 1).then_some(joints);
        let counters = [&frames, &zeros, &frames, &zeros];
        let mut columns: Vec<TableColumn<'_>> = ["action", "observation.state"]
            .map(|name| TableColumn { name, list, values: TableValues::Floats(&positions) })
            .into();
        columns.push(TableColumn { name: "timestamp", list: None, values: TableValues::Floats(&stamps) });
        columns.extend(COUNTERS.iter().zip(counters).map(|(name, values)| integers(name, values)));
        let data = table(path, rows, &columns, &[])?;
        let statistics = statistics(&columns);
        let files = [
            (INFO, text(&self.info(frames_per_s))),
            (STATISTICS, text(&statistics)),
            (TASKS, tasks(path)?),
            (EPISODES, episodes(path, rows as i64)?),
            (DATA, data),
        ];
        Ok(files.map(|(name, contents)| (name.to_owned(), contents)).into())
    }

    fn info(&self, frames_per_s: u32) -> Value {
        let motor = |name: &String| match name.ends_with(".pos") {
            true => name.clone(),
            false => format!("{name}.pos"),
        };
        let motors: Vec<String> = self.joint_names.iter().map(motor).collect();
        let positions = json!({ "dtype": "float32", "shape": [motors.len()], "names": motors });
        let mut features = json!({
            "action": positions,
            "observation.state": positions,
            "timestamp": { "dtype": "float32", "shape": [1], "names": null },
        });
        for counter in COUNTERS {
            features[counter] = json!({ "dtype": "int64", "shape": [1], "names": null });
        }
        json!({
            "codebase_version": "v3.0",
            "robot_type": null,
            "total_episodes": 1,
            "total_frames": self.time_s.len(),
            "total_tasks": 1,
            "chunks_size": 1000,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "fps": frames_per_s,
            "splits": { "train": "0:1" },
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": null,
            "features": features,
        })
    }
}

fn text(value: &Value) -> Vec<u8> {
    format!("{value:#}\n").into_bytes()
}

fn integers<'a>(name: &'a str, values: &'a [i64]) -> TableColumn<'a> {
    TableColumn { name, list: None, values: TableValues::Integers(values) }
}

/// The table of tasks; pandas takes the texts for the names of the rows.
fn tasks(path: &Path) -> Result<Vec<u8>, RecordingError> {
    const INDEX: &str = "__index_level_0__";
    let column = |name: Value, field: &str, kind: &str, stored: &str| json!({ "name": name, "field_name": field, "pandas_type": kind, "numpy_type": stored, "metadata": null });
    let pandas = json!({
        "index_columns": [INDEX],
        "column_indexes": [],
        "columns": [
            column(json!("task_index"), "task_index", "int64", "int64"),
            column(Value::Null, INDEX, "unicode", "object"),
        ],
    });
    let columns = [
        integers("task_index", &[0]),
        TableColumn { name: INDEX, list: None, values: TableValues::Texts(&[TASK]) },
    ];
    table(path, 1, &columns, &[("pandas", pandas.to_string())])
}

fn episodes(path: &Path, frames: i64) -> Result<Vec<u8>, RecordingError> {
    let frames = [frames];
    let columns = [
        integers("episode_index", &[0]),
        TableColumn { name: "tasks", list: Some(1), values: TableValues::Texts(&[TASK]) },
        integers("length", &frames),
        integers("data/chunk_index", &[0]),
        integers("data/file_index", &[0]),
        integers("dataset_from_index", &[0]),
        integers("dataset_to_index", &frames),
        integers("meta/episodes/chunk_index", &[0]),
        integers("meta/episodes/file_index", &[0]),
    ];
    table(path, 1, &columns, &[])
}

/// Smallest and largest value, mean, standard deviation and count of each number of each feature.
fn statistics(columns: &[TableColumn<'_>]) -> Value {
    let mut features = Map::new();
    for column in columns {
        let values: Vec<f64> = match &column.values {
            TableValues::Floats(values) => values.iter().copied().map(f64::from).collect(),
            TableValues::Integers(values) => values.iter().map(|value| *value as f64).collect(),
            TableValues::Doubles(_) | TableValues::Texts(_) => continue,
        };
        let width = column.list.unwrap_or(1);
        let count = values.len() / width;
        let [mut least, mut most, mut mean, mut deviation] = [const { Vec::new() }; 4];
        for number in 0..width {
            let of_number = || values.iter().skip(number).step_by(width).copied();
            let middle = of_number().sum::<f64>() / count as f64;
            least.push(of_number().fold(f64::INFINITY, f64::min));
            most.push(of_number().fold(f64::NEG_INFINITY, f64::max));
            mean.push(middle);
            deviation.push((of_number().map(|v| (v - middle).powi(2)).sum::<f64>() / count as f64).sqrt());
        }
        let feature = json!({ "min": least, "max": most, "mean": mean, "std": deviation, "count": [count] });
        features.insert(column.name.to_owned(), feature);
    }
    Value::Object(features)
}
