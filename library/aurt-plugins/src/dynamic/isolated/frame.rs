//! What host and process say to each other: frames of a text in JSON and numbers.
//!
//! A frame is the length of its text in bytes and the count of its numbers (two little-endian `u64`), the text, and the
//! numbers (little-endian `f64`). Series and columns are numbers, all else is text.

use std::io::{self, Read, Write};

use aurt_traits::{Invariants, MotionView, Parameter, ShapeParameter, Slot};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Map, Value};

use crate::dynamic::description::Described;

/// A longer text is no text of a library that is right.
const LONGEST_TEXT: u64 = 1 << 26;
/// Series of a sample that a request carries for each joint, beside the time.
const SERIES: usize = 4;

/// What the process offers, said first.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Offer {
    pub name: String,
    pub version: String,
    pub models: Vec<OfferedModel>,
}

/// A model that the process offers; requests name it by its place in the list.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct OfferedModel {
    pub slot: Slot,
    pub name: String,
    pub summary: String,
    pub equation: String,
    pub use_when: String,
    pub source: String,
    pub example: String,
}

/// What the host asks for. Instances have numbers that the host gives.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Request {
    /// Makes an instance; with shape parameters in the numbers if `shaped`.
    Create { instance: u64, model: usize, config: Map<String, Value>, shaped: bool },
    /// Asks an instance what it is.
    Describe { instance: u64, robot_joints: usize },
    /// The state before the first sample; numbers are the series of that sample.
    InitialState { instance: u64, size: Size, state_len: usize },
    /// Numbers: the series and the state. The reply's: the columns, one after another, and the state at the end.
    Evaluate { instance: u64, size: Size, state_len: usize, columns: usize },
    /// Ends all instances.
    Forget,
}

/// Samples and joints of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Size {
    pub samples: usize,
    pub joints: usize,
}

/// What the process answers.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Reply {
    Done,
    Described(DescribedText),
    /// Why it could not be done.
    Fault(String),
}

/// [`Described`] as text.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct DescribedText {
    columns: Vec<Parameter>,
    shapes: Vec<ShapeParameter>,
    state_len: usize,
    invariants: u32,
    is_load: bool,
    joints: Vec<usize>,
    acts_on: Vec<bool>,
}

impl From<&Described> for DescribedText {
    fn from(d: &Described) -> Self {
        Self {
            columns: d.columns.clone(),
            shapes: d.shapes.clone(),
            state_len: d.state_len,
            invariants: d.invariants.bits(),
            is_load: d.is_load,
            joints: d.joints.clone(),
            acts_on: d.acts_on.clone(),
        }
    }
}

impl From<DescribedText> for Described {
    fn from(d: DescribedText) -> Self {
        Self {
            columns: d.columns,
            shapes: d.shapes,
            state_len: d.state_len,
            invariants: Invariants::from_bits(d.invariants),
            is_load: d.is_load,
            joints: d.joints,
            acts_on: d.acts_on,
        }
    }
}

impl Size {
    pub(super) const fn numbers(self) -> usize {
        self.samples * (1 + SERIES * self.joints)
    }

    /// Series of a motion and of its load torques, one after another.
    pub(super) fn written(motion: &MotionView<'_>, load: &[f64], load_stride: usize) -> (Self, Vec<f64>) {
        let size = Self { samples: motion.samples(), joints: motion.joints() };
        let mut numbers = Vec::with_capacity(size.numbers());
        numbers.extend_from_slice(motion.time_s());
        for of in [MotionView::position_rad, MotionView::velocity_rad_s, MotionView::acceleration_rad_s2] {
            (0..size.joints).for_each(|joint| numbers.extend_from_slice(of(motion, joint)));
        }
        for joint in 0..size.joints {
            let first = joint * load_stride;
            numbers.extend_from_slice(&load[first..first + size.samples]);
        }
        (size, numbers)
    }

    /// The reverse: time, positions, velocities, accelerations and load torques, joint after joint.
    pub(super) fn read(self, numbers: &[f64]) -> [&[f64]; 1 + SERIES] {
        let (time, rest) = numbers.split_at(self.samples);
        let one = self.samples * self.joints;
        let of = |k: usize| &rest[k * one..(k + 1) * one];
        [time, of(0), of(1), of(2), of(3)]
    }
}

/// Writes a frame.
pub(super) fn write(to: &mut impl Write, text: &impl Serialize, numbers: &[&[f64]]) -> io::Result<()> {
    let text = serde_json::to_vec(text)?;
    let count: usize = numbers.iter().map(|list| list.len()).sum();
    let mut bytes = Vec::with_capacity(16 + text.len() + 8 * count);
    bytes.extend_from_slice(&(text.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&(count as u64).to_le_bytes());
    bytes.extend_from_slice(&text);
    for list in numbers {
        let first = bytes.len();
        bytes.resize(first + 8 * list.len(), 0);
        for (to, x) in bytes[first..].chunks_exact_mut(8).zip(*list) {
            to.copy_from_slice(&x.to_le_bytes());
        }
    }
    to.write_all(&bytes)
}

/// Reads a frame of at most so many numbers.
pub(super) fn read<T: DeserializeOwned>(from: &mut impl Read, most: u64) -> io::Result<(T, Vec<f64>)> {
    let mut head = [0; 16];
    from.read_exact(&mut head)?;
    let [text, count] = [&head[..8], &head[8..]].map(|half| {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(half);
        u64::from_le_bytes(bytes)
    });
    if text > LONGEST_TEXT || count > most {
        let reason = format!("a frame of {text} bytes and {count} numbers, at most {most} were expected");
        return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
    }
    let mut bytes = vec![0; text as usize];
    from.read_exact(&mut bytes)?;
    let text = serde_json::from_slice(&bytes)?;
    bytes.resize(8 * count as usize, 0);
    from.read_exact(&mut bytes)?;
    let number = |bytes: &[u8]| {
        let mut eight = [0; 8];
        eight.copy_from_slice(bytes);
        f64::from_le_bytes(eight)
    };
    Ok((text, bytes.chunks_exact(8).map(number).collect()))
}

#[cfg(test)]
mod tests {
    use aurt_traits::Motion;

    use super::*;

    #[test]
    fn frames_come_back_bit_for_bit_and_no_more_is_believed_than_was_asked_for() {
        let numbers = [0.1, -0.0, f64::NAN, f64::MAX, 5e-324];
        let mut bytes = Vec::new();
        write(&mut bytes, &Reply::Fault("`x`\n".into()), &[&numbers[..2], &numbers[2..]]).unwrap();
        let (reply, back) = read::<Reply>(&mut &bytes[..], 5).unwrap();
        assert!(matches!(reply, Reply::Fault(text) if text == "`x`\n"));
        assert_eq!(back.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), numbers.map(f64::to_bits));
        assert!(read::<Reply>(&mut &bytes[..], 4).is_err());
        assert!(read::<Reply>(&mut &bytes[..bytes.len() - 1], 5).is_err());
        bytes[..8].copy_from_slice(&u64::MAX.to_le_bytes());
        assert!(read::<Reply>(&mut &bytes[..], 5).is_err());
    }

    #[test]
    fn series_of_a_part_of_a_motion_come_back() {
        let of = |first: f64| (0..8).map(|i| first + f64::from(i)).collect::<Vec<_>>();
        let time = vec![0.0, 1.0, 2.0, 3.0];
        let motion = Motion::new(2, time, of(10.0), of(20.0), of(30.0)).unwrap();
        let load = of(40.0);
        let (size, numbers) = Size::written(&motion.view().slice(1..3), &load[1..], 4);
        assert_eq!((size, numbers.len()), (Size { samples: 2, joints: 2 }, size.numbers()));
        let [time, position, velocity, acceleration, load] = size.read(&numbers);
        assert_eq!((time, position), (&[1.0, 2.0][..], &[11.0, 12.0, 15.0, 16.0][..]));
        assert_eq!((velocity, acceleration), (&[21.0, 22.0, 25.0, 26.0][..], &[31.0, 32.0, 35.0, 36.0][..]));
        assert_eq!(load, [41.0, 42.0, 45.0, 46.0]);
    }
}
