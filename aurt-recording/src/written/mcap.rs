//! Series of joints as MCAP with `sensor_msgs/msg/JointState`: what ROS 2 records, and Foxglove, rerun and PlotJuggler open.
//!
//! Source: the MCAP specification, <https://mcap.dev/spec>; `sensor_msgs/msg/JointState.msg`; for CDR see `joint_state`.

use std::ops::Range;
use std::path::Path;

use crate::error::RecordingError;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Bytes of messages after which a chunk ends.
const CHUNK_BYTES: usize = 1 << 20;

const HEADER: u8 = 0x01;
const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
const MESSAGE_INDEX: u8 = 0x07;
const CHUNK_INDEX: u8 = 0x08;
const STATISTICS: u8 = 0x0b;
const SUMMARY_OFFSET: u8 = 0x0e;
const DATA_END: u8 = 0x0f;

const SCHEMA_ID: u16 = 1;
const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// What a topic says of all joints, as `[joint][sample]`; empty series are left out of its messages.
#[derive(Debug, Clone, Copy)]
pub struct JointTopic<'a> {
    /// Its name.
    pub name: &'a str,
    /// Positions, rad or m.
    pub position: &'a [Vec<f64>],
    /// Velocities, rad/s or m/s.
    pub velocity: &'a [Vec<f64>],
    /// Efforts, Nm or N.
    pub effort: &'a [Vec<f64>],
}

/// A file with a message of each topic at each stamp. Stamps count in s from `origin_s`, a whole number; `facts` stand with
/// every channel.
///
/// # Errors
/// [`RecordingError::Clock`] for stamps before 1970 or after 2038, which messages cannot have; `path` is what it names.
pub fn mcap(
    path: &Path,
    stamps_s: &[f64],
    origin_s: f64,
    joints: &[String],
    topics: &[JointTopic<'_>],
    facts: &[(&str, String)],
) -> Result<Vec<u8>, RecordingError> {
    let mut file = MAGIC.to_vec();
    record(&mut file, HEADER, |out| {
        text(out, "ros2");
        text(out, concat!("aurt ", env!("CARGO_PKG_VERSION")));
    });
    let mut kinds = Vec::new();
    describe(&mut kinds, topics, facts);
    let mut indices = Vec::new();
    let mut chunk = Chunk::new(kinds.clone(), topics.len());
    for (sample, stamp) in stamps_s.iter().enumerate() {
        let time_ns =
            (origin_s as i64).saturating_mul(1_000_000_000).saturating_add((stamp * 1e9).round() as i64);
        let (seconds, rest) = (time_ns.div_euclid(1_000_000_000), time_ns.rem_euclid(1_000_000_000));
        let Some(seconds) = i32::try_from(seconds).ok().filter(|s| *s >= 0 && stamp.is_finite()) else {
            return Err(RecordingError::Clock {
                path: path.to_owned(),
                reason: format!("the stamp {stamp} s is none that messages of ROS can have (1970 to 2038)"),
                remedy: "write Parquet or CSV, or shift the clock".to_owned(),
            });
        };
        for (channel, topic) in topics.iter().enumerate() {
            let message = cdr([seconds as u32, rest as u32], joints, topic, sample);
            chunk.add(channel, sample, time_ns as u64, &message);
        }
        if chunk.bytes.len() > CHUNK_BYTES {
            indices.push(
                std::mem::replace(&mut chunk, Chunk::new(kinds.clone(), topics.len())).close(&mut file),
            );
        }
    }
    if chunk.messages() > 0 {
        indices.push(chunk.close(&mut file));
    }
    record(&mut file, DATA_END, |out| out.extend(0_u32.to_le_bytes()));
    close(&mut file, kinds, &indices, topics.len());
    Ok(file)
}

/// The summary and the end of the file.
fn close(file: &mut Vec<u8>, kinds: Vec<u8>, indices: &[ChunkIndex], topics: usize) {
    let begin = file.len();
    file.extend(kinds);
    let statistics = file.len();
    let first = indices.iter().map(|i| i.times[0]).min().unwrap_or(0);
    let last = indices.iter().map(|i| i.times[1]).max().unwrap_or(0);
    let counts: Vec<u64> = (0..topics).map(|t| indices.iter().map(|i| i.counts[t]).sum()).collect();
    record(file, STATISTICS, |out| {
        out.extend(counts.iter().sum::<u64>().to_le_bytes());
        out.extend(1_u16.to_le_bytes());
        out.extend((topics as u32).to_le_bytes());
        out.extend([0; 8]);
        out.extend((indices.len() as u32).to_le_bytes());
        out.extend(first.to_le_bytes());
        out.extend(last.to_le_bytes());
        pairs(out, counts.iter().enumerate().map(|(t, count)| (t as u16, *count)));
    });
    let chunks = file.len();
    for index in indices {
        index.write(file);
    }
    let offsets = file.len();
    // Schema and channels stand together; readers go through them one by one.
    let channels = begin + 9 + length_at(file, begin);
    for (kind, group) in [
        (SCHEMA, begin..channels),
        (CHANNEL, channels..statistics),
        (STATISTICS, statistics..chunks),
        (CHUNK_INDEX, chunks..offsets),
    ] {
        if group.is_empty() {
            continue;
        }
        record(file, SUMMARY_OFFSET, |out| {
            out.push(kind);
            out.extend((group.start as u64).to_le_bytes());
            out.extend((group.len() as u64).to_le_bytes());
        });
    }
    record(file, FOOTER, |out| {
        out.extend((begin as u64).to_le_bytes());
        out.extend((offsets as u64).to_le_bytes());
        out.extend(0_u32.to_le_bytes());
    });
    file.extend(MAGIC);
}

/// The length of the record that begins at a place.
fn length_at(file: &[u8], at: usize) -> usize {
    let length = file.get(at + 1..at + 9).and_then(|b| b.try_into().ok()).unwrap_or_default();
    u64::from_le_bytes(length) as usize
}

/// The schema and the channels.
fn describe(out: &mut Vec<u8>, topics: &[JointTopic<'_>], facts: &[(&str, String)]) {
    record(out, SCHEMA, |out| {
        out.extend(SCHEMA_ID.to_le_bytes());
        text(out, "sensor_msgs/msg/JointState");
        text(out, "ros2msg");
        text(out, JOINT_STATE);
    });
    for (id, topic) in topics.iter().enumerate() {
        record(out, CHANNEL, |out| {
            out.extend((id as u16).to_le_bytes());
            out.extend(SCHEMA_ID.to_le_bytes());
            text(out, topic.name);
            text(out, "cdr");
            let mut map = Vec::new();
            for (key, value) in facts {
                text(&mut map, key);
                text(&mut map, value);
            }
            out.extend((map.len() as u32).to_le_bytes());
            out.extend(map);
        });
    }
}

/// Messages that are written together.
struct Chunk {
    bytes: Vec<u8>,
    /// Of the first and of the last message, ns.
    times: [u64; 2],
    /// For each channel the times of its messages and where they are in the chunk.
    places: Vec<Vec<(u64, u64)>>,
}

/// Where a chunk is.
struct ChunkIndex {
    times: [u64; 2],
    chunk: Range<usize>,
    indices: Vec<(u16, u64)>,
    indices_bytes: usize,
    bytes: usize,
    counts: Vec<u64>,
}

impl Chunk {
    fn new(kinds: Vec<u8>, topics: usize) -> Self {
        Self { bytes: kinds, times: [u64::MAX, 0], places: vec![Vec::new(); topics] }
    }

    fn messages(&self) -> usize {
        self.places.iter().map(Vec::len).sum()
    }

    fn add(&mut self, channel: usize, sequence: usize, time_ns: u64, message: &[u8]) {
        let [first, last] = self.times;
        self.times = [first.min(time_ns), last.max(time_ns)];
        self.places[channel].push((time_ns, self.bytes.len() as u64));
        record(&mut self.bytes, MESSAGE, |out| {
            out.extend((channel as u16).to_le_bytes());
            out.extend((sequence as u32).to_le_bytes());
            out.extend(time_ns.to_le_bytes());
            out.extend(time_ns.to_le_bytes());
            out.extend(message);
        });
    }

    fn close(self, file: &mut Vec<u8>) -> ChunkIndex {
        let begin = file.len();
        record(file, CHUNK, |out| {
            out.extend(self.times.iter().flat_map(|time| time.to_le_bytes()));
            out.extend((self.bytes.len() as u64).to_le_bytes());
            out.extend(crc32fast::hash(&self.bytes).to_le_bytes());
            text(out, "");
            out.extend((self.bytes.len() as u64).to_le_bytes());
            out.extend(&self.bytes);
        });
        let end = file.len();
        let mut indices = Vec::new();
        for (channel, places) in self.places.iter().enumerate() {
            indices.push((channel as u16, file.len() as u64));
            record(file, MESSAGE_INDEX, |out| {
                out.extend((channel as u16).to_le_bytes());
                out.extend((16 * places.len() as u32).to_le_bytes());
                for (time, at) in places {
                    out.extend(time.to_le_bytes());
                    out.extend(at.to_le_bytes());
                }
            });
        }
        ChunkIndex {
            times: self.times,
            chunk: begin..end,
            indices,
            indices_bytes: file.len() - end,
            bytes: self.bytes.len(),
            counts: self.places.iter().map(|p| p.len() as u64).collect(),
        }
    }
}

impl ChunkIndex {
    fn write(&self, file: &mut Vec<u8>) {
        record(file, CHUNK_INDEX, |out| {
            out.extend(self.times.iter().flat_map(|time| time.to_le_bytes()));
            out.extend((self.chunk.start as u64).to_le_bytes());
            out.extend((self.chunk.len() as u64).to_le_bytes());
            pairs(out, self.indices.iter().copied());
            out.extend((self.indices_bytes as u64).to_le_bytes());
            text(out, "");
            out.extend((self.bytes as u64).to_le_bytes());
            out.extend((self.bytes as u64).to_le_bytes());
        });
    }
}

/// A record: its kind, its length, and what `fill` writes.
fn record(out: &mut Vec<u8>, kind: u8, fill: impl FnOnce(&mut Vec<u8>)) {
    out.push(kind);
    let at = out.len();
    out.extend([0; 8]);
    fill(out);
    let length = (out.len() - at - 8) as u64;
    out[at..at + 8].copy_from_slice(&length.to_le_bytes());
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

fn pairs(out: &mut Vec<u8>, pairs: impl Iterator<Item = (u16, u64)>) {
    let mut map = Vec::new();
    for (key, value) in pairs {
        map.extend(key.to_le_bytes());
        map.extend(value.to_le_bytes());
    }
    out.extend((map.len() as u32).to_le_bytes());
    out.extend(map);
}

/// A message of a topic: seconds and nanoseconds, the joints' names, and their values at a sample.
fn cdr(stamp: [u32; 2], joints: &[String], topic: &JointTopic<'_>, sample: usize) -> Vec<u8> {
    let mut body = Vec::new();
    body.extend(stamp.iter().flat_map(|word| word.to_le_bytes()));
    word_text(&mut body, "");
    align(&mut body, 4);
    body.extend((joints.len() as u32).to_le_bytes());
    for name in joints {
        align(&mut body, 4);
        word_text(&mut body, name);
    }
    for series in [topic.position, topic.velocity, topic.effort] {
        align(&mut body, 4);
        body.extend((series.len() as u32).to_le_bytes());
        if !series.is_empty() {
            align(&mut body, 8);
        }
        for values in series {
            body.extend(values.get(sample).copied().unwrap_or(f64::NAN).to_le_bytes());
        }
    }
    let mut message = vec![0, 1, 0, 0];
    message.extend(body);
    message
}

/// A text with the zero that ends it.
fn word_text(body: &mut Vec<u8>, text: &str) {
    body.extend((text.len() as u32 + 1).to_le_bytes());
    body.extend(text.as_bytes());
    body.push(0);
}

fn align(body: &mut Vec<u8>, to: usize) {
    body.resize(body.len().next_multiple_of(to), 0);
}
