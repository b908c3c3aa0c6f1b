//! LeRobot data sets named by their folder.

use std::path::Path;

use aurt_recording::{
    ColumnRef, ColumnsRef, LongRecording, ReadOptions, RecordedAs, is_recording_folder, read_recording,
};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Two files of two episodes of three frames, with positions of two joints.
fn data_set(change: &dyn Fn(&mut Value)) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/lerobot.parquet");
    for name in ["file-000.parquet", "file-001.parquet"] {
        let chunk = folder.path().join("data/chunk-000");
        std::fs::create_dir_all(&chunk).unwrap();
        std::fs::copy(&file, chunk.join(name)).unwrap();
    }
    let mut info = json!({
        "codebase_version": "v3.0",
        "robot_type": "so101",
        "total_episodes": 4,
        "fps": 4,
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "features": {
            "observation.state": { "dtype": "float32", "shape": [2], "names": ["shoulder_pan.pos", "elbow.pos"] },
            "action": { "dtype": "float32", "shape": [2], "names": ["shoulder_pan.pos", "elbow.pos"] },
            "timestamp": { "dtype": "float32", "shape": [1], "names": null },
            "episode_index": { "dtype": "int64", "shape": [1], "names": null }
        }
    });
    change(&mut info);
    std::fs::create_dir(folder.path().join("meta")).unwrap();
    std::fs::write(folder.path().join("meta/info.json"), info.to_string()).unwrap();
    folder
}

fn options(joint_names: Option<&[&str]>) -> ReadOptions {
    let joint_names = joint_names.map(|names| names.iter().map(|n| (*n).to_owned()).collect());
    ReadOptions {
        needs_measurement: false,
        recorded: RecordedAs { joint_names, ..RecordedAs::default() },
        ..ReadOptions::default()
    }
}

const STAMPS: [f64; 12] = [0.0, 0.25, 0.5, 10.5, 10.75, 11.0, 21.0, 21.25, 21.5, 31.5, 31.75, 32.0];

#[test]
fn all_episodes_of_all_files_follow_each_other() {
    let folder = data_set(&|_| ());
    for path in [folder.path().to_owned(), folder.path().join("meta/info.json")] {
        assert!(is_recording_folder(&path));
        let read = read_recording(&path, &options(None)).unwrap();
        assert_eq!(read.time_s, STAMPS);
        let once = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0];
        assert_eq!(read.position_rad[0], [once, once].concat());
        assert_eq!((read.report.rows, read.file.as_path()), (12, folder.path()));
        let notes = read.report.notes().join("\n");
        for part in [
            "12 rows, LeRobot data set v3.0, 4 episodes in 2 files, 4 frames/s",
            "joints in this order: shoulder_pan.pos, elbow.pos",
        ] {
            assert!(notes.contains(part), "{part}\n---\n{notes}");
        }
        assert_eq!(notes.matches("10 s").count(), 1, "{notes}");
    }
    let long = LongRecording::read(folder.path(), &options(None)).unwrap();
    assert_eq!((long.samples(), long.joints()), (12, 2));
}

#[test]
fn joints_are_found_by_name() {
    let names: &[&dyn Fn(&mut Value)] = &[&|_| (), &|info| {
        info["features"]["observation.state"]["names"] =
            json!({ "motors": ["main_shoulder_pan", "main_elbow"] })
    }];
    for change in names {
        let folder = data_set(*change);
        let read = read_recording(folder.path(), &options(Some(&["elbow", "shoulder_pan"]))).unwrap();
        assert_eq!((read.position_rad[0][1], read.position_rad[1][1]), (3.0, 2.0));
        // A robot that lacks a motor of the data set, the gripper say.
        let read = read_recording(folder.path(), &options(Some(&["elbow"]))).unwrap();
        assert_eq!((read.joints(), read.position_rad[0][1]), (1, 3.0));
    }
    // What is selected holds.
    let folder = data_set(&|_| ());
    let mut chosen = options(Some(&["nothing"]));
    chosen.columns.position = Some(ColumnsRef::List(vec![ColumnRef::Name("action_1".into())]));
    assert_eq!(read_recording(folder.path(), &chosen).unwrap().position_rad[0][..3], [1.0, 3.0, 5.0]);
}

#[test]
fn what_is_wrong_is_said_with_its_cure() {
    let error = |change: &dyn Fn(&mut Value), options: &ReadOptions| {
        read_recording(data_set(change).path(), options).unwrap_err().to_string()
    };
    let unknown = error(&|_| (), &options(Some(&["wrist"])));
    assert!(unknown.contains("has the joints shoulder_pan.pos, elbow.pos; wanted are wrist"), "{unknown}");
    assert!(unknown.contains("`wrist` is none of them"), "{unknown}");
    let more = ReadOptions { joints: Some(6.into()), ..options(None) };
    let count = error(&|_| (), &more);
    assert!(count.contains("has 2 numbers, the robot has 6 joints: shoulder_pan.pos, elbow.pos"), "{count}");
    let nameless = error(&|info| info["features"]["observation.state"]["names"] = Value::Null, &more);
    assert!(nameless.contains("without names") && nameless.contains("`columns`"), "{nameless}");
    let stateless = error(
        &|info| {
            info["features"] = json!({ "action": {} });
        },
        &options(None),
    );
    assert!(stateless.contains("no feature `observation.state`; its features are action"), "{stateless}");
    let other = error(&|info| *info = json!({ "fps": "fast" }), &options(None));
    assert!(other.contains("info.json") && other.contains("does not describe a LeRobot data set"), "{other}");
    let measured = error(&|_| (), &ReadOptions::default());
    assert!(measured.contains("file-000.parquet") && measured.contains("torques"), "{measured}");

    let folder = data_set(&|info| info["fps"] = json!(30));
    let notes = read_recording(folder.path(), &options(None)).unwrap().report.notes().join("\n");
    assert!(notes.contains("says 30 frames/s, the stamps of its first file 4.0"), "{notes}");
    let pointer = folder.path().join("data/chunk-000/file-001.parquet");
    std::fs::write(&pointer, "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n").unwrap();
    let lfs = read_recording(folder.path(), &options(None)).unwrap_err().to_string();
    assert!(lfs.contains("file-001.parquet") && lfs.contains("git lfs pull"), "{lfs}");
    std::fs::remove_dir_all(folder.path().join("data")).unwrap();
    let empty = read_recording(folder.path(), &options(None)).unwrap_err().to_string();
    assert!(empty.contains("data/ holds no Parquet files"), "{empty}");
    std::fs::remove_dir_all(folder.path().join("meta")).unwrap();
    let none = read_recording(folder.path(), &options(None)).unwrap_err().to_string();
    assert!(none.contains("is a directory") && none.contains("meta/info.json"), "{none}");
}
