//! Compressed files that unpack to much more than they take are refused with what they would need; what is not needed is
//! not unpacked.

use std::io::Write;
use std::path::{Path, PathBuf};

use aurt_recording::{JointTopic, LongRecording, ReadOptions, RecordingError, mcap, read_recording};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const MEGABYTE: u64 = 1 << 20;

/// Reads a file with so much memory.
fn read(path: &Path, memory_bytes: u64) -> Result<usize, RecordingError> {
    let options =
        ReadOptions { memory_bytes: Some(memory_bytes), needs_measurement: false, ..ReadOptions::default() };
    read_recording(path, &options).map(|recording| recording.samples())
}

fn needed(path: &Path, memory_bytes: u64) -> u64 {
    match read(path, memory_bytes).unwrap_err() {
        RecordingError::TooLarge { needed_bytes, allowed_bytes, .. } => {
            assert_eq!(allowed_bytes, memory_bytes);
            needed_bytes
        }
        other => panic!("{other}"),
    }
}

/// An archive of arrays of zeros, each with the shape that its header claims and so many numbers.
fn npz(folder: &Path, arrays: &[(&str, &str, usize)]) -> PathBuf {
    let path = folder.join("zeros.npz");
    let mut archive = ZipWriter::new(std::fs::File::create(&path).unwrap());
    let method = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (name, shape, numbers) in arrays {
        archive.start_file(format!("{name}.npy"), method).unwrap();
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
        archive.write_all(b"\x93NUMPY\x01\0").unwrap();
        archive.write_all(&(header.len() as u16).to_le_bytes()).unwrap();
        archive.write_all(header.as_bytes()).unwrap();
        archive.write_all(&vec![0; 8 * numbers]).unwrap();
    }
    archive.finish().unwrap();
    path
}

#[test]
fn arrays_of_zeros_are_refused_with_what_they_need() {
    let folder = tempfile::tempdir().unwrap();
    let rows = 400_000;
    let path = npz(folder.path(), &[("time", "400000,", rows), ("q", "400000, 2", 2 * rows)]);
    assert!(path.metadata().unwrap().len() < MEGABYTE / 32);
    let bytes = needed(&path, 8 * MEGABYTE);
    assert_eq!(bytes, 16 * 3 * rows as u64);
    // Rows that are equal, stamps included, are one.
    assert_eq!(read(&path, bytes).unwrap(), 1);
}

#[test]
fn arrays_that_are_not_needed_take_neither_time_nor_memory() {
    let folder = tempfile::tempdir().unwrap();
    let shapes = [
        ("time", "20,", 20),
        ("q", "20, 2", 40),
        ("pictures", "1000000, 1000000", 1_000_000),
        ("more", "20, 50000000000", 0),
    ];
    let path = npz(folder.path(), &shapes);
    let begin = std::time::Instant::now();
    assert_eq!(read(&path, MEGABYTE).unwrap(), 1);
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}

/// A MAT-file of one variable of zeros for each name, n × 1.
fn mat(folder: &Path, variables: &[(&str, usize)]) -> PathBuf {
    let element = |kind: u32, bytes: &[u8]| {
        let mut all = [kind.to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
        all.extend(bytes);
        all.resize(all.len().next_multiple_of(8), 0);
        all
    };
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend([0, 1, b'I', b'M']);
    for (name, rows) in variables {
        let shape = [(*rows as u32).to_le_bytes(), 1_u32.to_le_bytes()].concat();
        let body = [
            element(6, &[6, 0, 0, 0, 0, 0, 0, 0]),
            element(5, &shape),
            element(1, name.as_bytes()),
            element(9, &vec![0; 8 * rows]),
        ];
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(&element(14, &body.concat())).unwrap();
        let packed = packed.finish().unwrap();
        file.extend([15_u32.to_le_bytes(), (packed.len() as u32).to_le_bytes()].concat());
        file.extend(packed);
    }
    let path = folder.join("zeros.mat");
    std::fs::write(&path, file).unwrap();
    path
}

#[test]
fn variables_of_zeros_are_refused_with_what_they_need() {
    let folder = tempfile::tempdir().unwrap();
    let path = mat(folder.path(), &[("t", 300_000), ("q_0", 300_000), ("unused", 3_000_000)]);
    let bytes = needed(&path, 4 * MEGABYTE);
    assert_eq!(bytes, 16 * 2 * 300_000);
    assert_eq!(read(&path, bytes).unwrap(), 1);
}

fn write_bag(path: &Path, stamps: &[f64], joints: &[String], position: &[Vec<f64>]) {
    let topic = JointTopic { name: "/joint_states", position, velocity: &[], effort: &[] };
    std::fs::write(path, mcap(path, stamps, 0.0, joints, &[topic], &[]).unwrap()).unwrap();
}

/// A message of one joint in a chunk that zstd shrinks to nothing, and a table of constant columns.
#[test]
fn rows_that_no_header_announces_are_counted_while_they_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let joints = ["elbow".to_owned()];
    let stamps: Vec<f64> = (0..200_000).map(|k| 1e-3 * f64::from(k)).collect();
    let zeros = [vec![0.0; stamps.len()]];
    write_bag(&path, &stamps, &joints, &zeros);
    assert!(needed(&path, 3 * MEGABYTE) > 3 * MEGABYTE);
    assert_eq!(read(&path, 16 * MEGABYTE).unwrap(), stamps.len());
    // In pieces less is enough.
    let options =
        ReadOptions { memory_bytes: Some(3 * MEGABYTE), needs_measurement: false, ..ReadOptions::default() };
    assert_eq!(LongRecording::read(&path, &options).unwrap().samples(), stamps.len());
}

#[test]
fn a_table_is_refused_by_the_rows_that_its_footer_states() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.parquet");
    let stamps: Vec<f64> = (0..200_000).map(|k| 1e-3 * f64::from(k)).collect();
    let columns = [("time".to_owned(), stamps.as_slice()), ("q_0".to_owned(), stamps.as_slice())];
    std::fs::write(&path, aurt_recording::parquet(&path, &columns, &[]).unwrap()).unwrap();
    assert!(needed(&path, 3 * MEGABYTE) >= 8 * 2 * 200_000);
    assert_eq!(read(&path, 32 * MEGABYTE).unwrap(), stamps.len());
}

/// Messages with so many joints, three of them.
fn bag(folder: &Path, joints: usize) -> PathBuf {
    let path = folder.join("many.mcap");
    let names: Vec<String> = (0..joints).map(|k| format!("j{k}")).collect();
    let position = vec![vec![0.0; 3]; joints];
    write_bag(&path, &[0.0, 0.1, 0.2], &names, &position);
    path
}

#[test]
fn messages_of_more_joints_than_a_machine_has_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let begin = std::time::Instant::now();
    for (joints, said) in
        [(50_000, "more than 1000 joints"), (150, "150 joints, and robots have at most 128")]
    {
        let error = read(&bag(folder.path(), joints), 64 * MEGABYTE).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("many.mcap"), "{error}");
    }
    // With the robot's joints named, there may be others.
    let options = ReadOptions {
        recorded: aurt_recording::RecordedAs {
            joint_names: Some(vec!["j119".to_owned(), "j3".to_owned()]),
            ..Default::default()
        },
        needs_measurement: false,
        ..ReadOptions::default()
    };
    assert_eq!(read_recording(&folder.path().join("many.mcap"), &options).unwrap().joints(), 2);
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
}

/// Names of topics and types are kept for all of a file, so they are kept short.
#[test]
fn long_names_of_types_are_cut() {
    let folder = tempfile::tempdir().unwrap();
    let record = |kind: u8, body: Vec<u8>| [&[kind][..], &(body.len() as u64).to_le_bytes(), &body].concat();
    let text = |text: &[u8]| [&(text.len() as u32).to_le_bytes()[..], text].concat();
    let mut file = b"\x89MCAP0\r\n".to_vec();
    for id in 1..=20_u16 {
        file.extend(record(3, [&id.to_le_bytes()[..], &text(&vec![b's'; 1 << 20]), &[0; 8]].concat()));
        let channel =
            [&id.to_le_bytes()[..], &id.to_le_bytes(), &text(&[b'0' + id as u8]), &text(b"cdr"), &[0; 4]];
        file.extend(record(4, channel.concat()));
    }
    file.extend(record(2, vec![0; 20]));
    let path = folder.path().join("types.mcap");
    std::fs::write(&path, file).unwrap();
    let error = read(&path, 64 * MEGABYTE).unwrap_err().to_string();
    assert!(error.contains("no topic has messages") && error.len() < 20_000, "{} bytes", error.len());
}

/// Room is made for numbers, not for rows: a row may have thousands.
#[test]
fn wide_rows_are_counted_before_many_are_held() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.parquet");
    let zeros = vec![0.0; 9000];
    let stamps: Vec<f64> = (0..9000).map(|k| 1e-3 * f64::from(k)).collect();
    let names = |k: usize| format!("q_{k}");
    let columns: Vec<(String, &[f64])> = std::iter::once(("time".to_owned(), stamps.as_slice()))
        .chain((0..100).map(|k| (names(k), zeros.as_slice())))
        .collect();
    std::fs::write(&path, aurt_recording::parquet(&path, &columns, &[]).unwrap()).unwrap();
    assert!(needed(&path, 3 * MEGABYTE) < 16 * MEGABYTE);
}
