use std::collections::{HashSet, VecDeque};
use std::path::Path;

use aurt_traits::MOST_JOINTS;

use crate::bag::cdr::MOST_OF_MESSAGE;
use crate::bag::joint_state::JointState;
use crate::bag::joint_trajectory::JointTrajectory;
use crate::bag::messages::Messages;
use crate::bag::topics::Topic;
use crate::branches::{BranchMotion, BranchTrack};
use crate::error::RecordingError;
use crate::read_options::ReadOptions;

/// The way to say which joints of a recording are the robot's.
const NAMES: &str = "joint_names = [\"shoulder\", \"elbow\"] in an experiment, --joint-names shoulder,elbow on the command line";
/// Integers beyond this are not all numbers of double precision.
const EXACT: i64 = 1 << 53;
/// Messages among which one with efforts is looked for, and bytes that they may take.
const LOOKED_AT: usize = 1000;
const LOOKED_AT_BYTES: usize = 1 << 24;
const SECOND_NS: i64 = 1_000_000_000;

/// The rows of a topic: stamp, then positions, velocities and efforts of the wanted joints.
pub(super) struct Joints<'a> {
    messages: Messages<'a>,
    state: JointState,
    /// The message that is read point by point, of a topic of planned motions.
    trajectory: Option<JointTrajectory>,
    /// The joints in the order of the rows.
    names: Vec<String>,
    /// The names that `places` is for, as they are written.
    known: Vec<u8>,
    /// For each wanted joint its place in the message; none if the message lacks one.
    places: Option<Vec<usize>>,
    position: bool,
    velocity: bool,
    effort: bool,
    /// Messages that were read to find out about the stamps.
    ahead: VecDeque<(JointState, i64)>,
    recorder_stamps: bool,
    origin_ns: i64,
    passed_over: usize,
    /// Messages with a value that is not finite, and which of the first.
    not_finite: (usize, String),
    branches: Vec<BranchTrack>,
    /// The names that `beside` is for, as they are written.
    beside_of: Vec<u8>,
    /// Of each of `branches` its place in the message.
    beside: Vec<Option<usize>>,
}

impl<'a> Joints<'a> {
    /// Reads on to the first message that has all joints.
    pub(super) fn open(
        messages: Messages<'a>,
        path: &Path,
        topic: &Topic,
        options: &ReadOptions,
    ) -> Result<Self, RecordingError> {
        let mut joints = Self {
            messages,
            state: JointState::default(),
            trajectory: topic.is_planned.then(JointTrajectory::default),
            names: options.joint_names().to_vec(),
            known: Vec::new(),
            places: None,
            position: true,
            velocity: false,
            effort: false,
            ahead: VecDeque::new(),
            recorder_stamps: false,
            origin_ns: 0,
            passed_over: 0,
            not_finite: (0, String::new()),
            branches: options.branch_tracks(),
            beside_of: Vec::new(),
            beside: Vec::new(),
        };
        let refuse = |reason: String, remedy: String| {
            RecordingError::malformed(path, format!("topic {}", topic.name), reason, remedy)
        };
        if !joints.decode_next()? {
            return Err(refuse("it has no messages".to_owned(), "record it again".to_owned()));
        }
        let mut seen = joints.state.names.clone();
        let mut known: HashSet<String> = seen.iter().cloned().collect();
        if joints.names.is_empty() {
            joints.names.clone_from(&seen);
            // A message may have more if the robot's are named.
            if seen.len() > MOST_JOINTS {
                let reason =
                    format!("its messages have {} joints, and robots have at most {MOST_JOINTS}", seen.len());
                return Err(refuse(reason, format!("name those of the robot: {NAMES}")));
            }
            if let Some(robot) = options.joint_count().filter(|n| *n != seen.len()) {
                let remedy = format!("name those of the robot in its order: {NAMES}");
                let reason = format!(
                    "its messages have {} joints, the robot has {robot}: {}",
                    seen.len(),
                    seen.join(", ")
                );
                return Err(refuse(reason, remedy));
            }
        }
        while joints.placed().is_none() {
            joints.passed_over += 1;
            if !joints.decode_next()? {
                return Err(RecordingError::JointNames {
                    path: path.to_owned(),
                    lacking: joints.names.iter().filter(|n| !seen.contains(n)).cloned().collect(),
                    recorded: seen,
                    wanted: joints.names,
                });
            }
            for name in joints.state.names.iter().filter(|_| joints.known != joints.state.names_written) {
                if known.insert(name.clone()) {
                    seen.push(name.clone());
                }
            }
            if seen.len() > MOST_OF_MESSAGE {
                let reason = format!(
                    "its messages name more than {MOST_OF_MESSAGE} joints, none of them with all of the robot's"
                );
                return Err(refuse(reason, "record the robot's own topic".to_owned()));
            }
        }
        let count = joints.state.names.len();
        joints.position = options.needs_position || joints.state.position.len() == count;
        joints.velocity = joints.state.velocity.len() == count;
        joints.ahead.push_back((joints.state.clone(), joints.messages.log_ns));
        let names = joints.names.clone();
        let has_efforts = |state: &JointState| {
            state.effort.len() == state.names.len() && names.iter().all(|n| state.names.contains(n))
        };
        joints.effort = has_efforts(&joints.state);
        let mut ahead_bytes = joints.state.bytes();
        while joints.ahead.len() < 2
            || !joints.effort && joints.ahead.len() < LOOKED_AT && ahead_bytes < LOOKED_AT_BYTES
        {
            if !joints.decode_next()? {
                break;
            }
            ahead_bytes += joints.state.bytes();
            joints.ahead.push_back((joints.state.clone(), joints.messages.log_ns));
            joints.effort |= has_efforts(&joints.state);
        }
        joints.recorder_stamps = joints.ahead.len() > 1 && joints.ahead.iter().all(|m| m.0.stamp_ns == 0);
        let begin = joints.ahead.front().map_or(0, |(state, log_ns)| joints.stamp_ns(state, *log_ns));
        joints.origin_ns = if begin.abs() < EXACT { 0 } else { begin.div_euclid(SECOND_NS) * SECOND_NS };
        Ok(joints)
    }

    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    pub(super) fn columns(&self) -> Vec<String> {
        let mut columns = vec!["time".to_owned()];
        let families = [("position", self.position), ("velocity", self.velocity), ("effort", self.effort)];
        for (family, _) in families.iter().filter(|(_, there)| *there) {
            columns.extend((0..self.names.len()).map(|joint| format!("{family}_{joint}")));
        }
        columns
    }

    pub(super) fn remarks(&self) -> Vec<String> {
        let mut remarks = vec![format!("joints in this order: {}", self.names.join(", "))];
        if self.recorder_stamps {
            remarks.push(
                "the messages have no time stamps: the recorder's are used, which have more jitter".into(),
            );
        }
        if self.origin_ns != 0 {
            let seconds = self.origin_ns / SECOND_NS;
            remarks.push(format!("time starts at {seconds} s, so that stamps keep nanosecond resolution"));
        }
        remarks
    }

    /// Whole seconds that were taken off the stamps.
    pub(super) const fn origin_s(&self) -> f64 {
        (self.origin_ns / SECOND_NS) as f64
    }

    pub(super) fn irregularities(&self) -> Vec<String> {
        let mut said = Vec::new();
        if self.passed_over > 0 {
            said.push(format!(
                "{} messages were skipped: they lack joints or quantities that the others have",
                self.passed_over
            ));
        }
        if let (count @ 1.., of) = &self.not_finite {
            said.push(format!(
                "{count} messages were skipped: they have values that are no numbers, first {of}"
            ));
        }
        if self.messages.broken_off {
            said.push(format!(
                "the file is truncated: {} messages were read, and its summary is missing",
                self.messages.read
            ));
        }
        said
    }

    /// Of which joint a value is not finite where no message is without such a value.
    pub(super) fn never_finite(&self, rows: usize) -> Option<&str> {
        (rows == 0 && self.not_finite.0 > 0).then_some(self.not_finite.1.as_str())
    }

    /// Fills the next row; false after the last.
    pub(super) fn next(&mut self, row: &mut [f64]) -> Result<bool, RecordingError> {
        loop {
            let log_ns = match self.ahead.pop_front() {
                Some((state, log_ns)) => {
                    self.state = state;
                    log_ns
                }
                None if self.decode_next()? => self.messages.log_ns,
                None => return Ok(false),
            };
            let stamp_ns = self.stamp_ns(&self.state, log_ns);
            let origin_ns = self.origin_ns;
            let (position, velocity, effort) = (self.position, self.velocity, self.effort);
            self.placed();
            let (Some(places), state) = (&self.places, &self.state) else {
                self.passed_over += 1;
                continue;
            };
            let count = state.names.len();
            let families =
                [(position, &state.position), (velocity, &state.velocity), (effort, &state.effort)];
            let read = || families.iter().filter(|(there, _)| *there).map(|(_, values)| *values);
            if read().any(|values| values.len() != count) {
                self.passed_over += 1;
                continue;
            }
            let values = read().flat_map(|values| places.iter().map(|place| values[*place]));
            if let Some(at) = values.clone().position(|v| !v.is_finite()) {
                if self.not_finite.0 == 0 {
                    let family = self.columns().swap_remove(1 + at);
                    let family = family.split('_').next().unwrap_or_default();
                    self.not_finite.1 = format!("the {family} of {}", self.names[at % self.names.len()]);
                }
                self.not_finite.0 += 1;
                continue;
            }
            let time_s = stamp_ns.saturating_sub(origin_ns) as f64 / SECOND_NS as f64;
            for (cell, value) in row.iter_mut().zip(std::iter::once(time_s).chain(values)) {
                *cell = value;
            }
            return Ok(true);
        }
    }

    const fn stamp_ns(&self, state: &JointState, log_ns: i64) -> i64 {
        if self.recorder_stamps { log_ns } else { state.stamp_ns }
    }

    fn decode_next(&mut self) -> Result<bool, RecordingError> {
        let failed = |messages: &Messages<'_>, reason| {
            messages.malformed(format!("a message cannot be decoded: {reason}"), "record it again")
        };
        let (messages, state) = (&mut self.messages, &mut self.state);
        loop {
            if let Some(trajectory) = &mut self.trajectory
                && trajectory.next(state).map_err(|reason| failed(messages, reason))?
            {
                break;
            }
            if !messages.next()? {
                return Ok(false);
            }
            let Some(trajectory) = &mut self.trajectory else {
                state.decode(&messages.payload).map_err(|reason| failed(messages, reason))?;
                break;
            };
            let begun = trajectory.begin(&mut messages.payload, state);
            begun.map_err(|reason| failed(messages, reason))?;
        }
        self.track_branches();
        Ok(true)
    }

    /// Looks at the joints beside the chain, which may have messages of their own.
    fn track_branches(&mut self) {
        let state = &self.state;
        if self.branches.is_empty() || state.position.len() != state.names.len() {
            return;
        }
        if self.beside_of != state.names_written {
            self.beside_of.clone_from(&state.names_written);
            let place = |track: &BranchTrack| state.names.iter().position(|name| *name == track.joint);
            self.beside = self.branches.iter().map(place).collect();
        }
        let stamp_ns = if state.stamp_ns == 0 { self.messages.log_ns } else { state.stamp_ns };
        for (track, place) in self.branches.iter_mut().zip(&self.beside) {
            if let Some(place) = place {
                track.add(stamp_ns as f64 / SECOND_NS as f64, state.position[*place]);
            }
        }
    }

    /// The joints beside the chain that move.
    pub(super) fn branches(self) -> Vec<BranchMotion> {
        self.branches.into_iter().filter_map(BranchTrack::motion).collect()
    }

    /// Where the wanted joints are in the present message.
    fn placed(&mut self) -> Option<&[usize]> {
        if self.known != self.state.names_written || self.known.is_empty() {
            self.known.clone_from(&self.state.names_written);
            let place = |name: &String| self.state.names.iter().position(|n| n == name);
            self.places = self.names.iter().map(place).collect();
        }
        self.places.as_deref()
    }
}
