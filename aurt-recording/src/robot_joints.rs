//! Which series of a recording is which joint of a robot.

use std::ops::Deref;
use std::path::Path;

use aurt_traits::{Branch, MeasurementUnit};

use crate::branches::{BranchMotion, BranchTrack};
use crate::error::RecordingError;
use crate::noise::white_level_at;
use crate::recording::{RecordedJoints, Recording};

const GRAVITY_M_S2: f64 = 9.806_65;

/// The joints of a robot that recordings are brought into the order of.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RobotJoints {
    /// Their number N.
    pub count: usize,
    /// Their N names, base first; empty where they have none.
    pub names: Vec<String>,
    /// The joints beside the chain, whose motion recordings may show.
    pub branches: Vec<Branch>,
    /// Whether each of them slides, so that its positions are lengths in m; empty where all turn.
    pub sliding: Vec<bool>,
}

/// A recording whose series are those of a robot's joints, in the robot's order: what commands work with, so that none of
/// them can take one joint for another. [`Recording::of_robot`] makes it.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotRecording(Recording);

impl Deref for RobotRecording {
    type Target = Recording;

    fn deref(&self) -> &Recording {
        &self.0
    }
}

impl From<RobotRecording> for Recording {
    fn from(recording: RobotRecording) -> Self {
        recording.0
    }
}

impl RobotRecording {
    /// The joints that it has, as those of a robot.
    pub fn robot_joints(&self) -> RobotJoints {
        RobotJoints { names: self.joints.names().to_vec(), ..self.joints().into() }
    }
}

impl From<usize> for RobotJoints {
    /// So many joints without names.
    fn from(count: usize) -> Self {
        Self { count, ..Self::default() }
    }
}

impl RobotJoints {
    /// The joints of rigid bodies.
    pub fn of(body: &dyn aurt_traits::RigidBodyRegressor) -> Self {
        let (names, branches) = (body.joint_names().to_vec(), body.branches().to_vec());
        let sliding = (0..body.joints()).map(|joint| body.slides(joint)).collect();
        Self { count: body.joints(), names, branches, sliding }
    }

    /// Whether a joint slides: its positions are in m.
    pub fn slides(&self, joint: usize) -> bool {
        self.sliding.get(joint).is_some_and(|slides| *slides)
    }

    /// The names to look for in a file for which the user stated `stated`: those, unless they are the robot's own in another
    /// order.
    pub(crate) fn wanted<'a>(&'a self, stated: Option<&'a [String]>) -> &'a [String] {
        match stated {
            Some(stated) if !self.has_all(stated) => stated,
            _ => &self.names,
        }
    }

    /// The motions beside the chain that its measurements contain, and joints that carry its base turned away from zero.
    ///
    /// Gravity makes at most g h of torque of the first moment h that a joint displaces by a unit of its motion. A range that
    /// makes less than the noise of a measured torque is not seen. Where the measurement is a current, or no masses are stated,
    /// every motion counts: `noise_nm` is empty.
    pub(crate) fn moving(&self, found: &[BranchMotion], noise_nm: &[f64]) -> Vec<BranchMotion> {
        let of_branch = |motion: &BranchMotion| {
            let branch = self.branches.iter().find(|branch| branch.joint == motion.joint)?;
            let range = motion.range_rad[1] - motion.range_rad[0];
            let shows = |joint: &&usize| match (branch.displaced, noise_nm.get(**joint)) {
                (Some(displaced), Some(noise)) => GRAVITY_M_S2 * displaced * range > *noise,
                _ => true,
            };
            let upstream: Vec<usize> = branch.upstream.iter().filter(shows).copied().collect();
            let upstream = if motion.moves { upstream } else { Vec::new() };
            let turns_base = branch.carries_base && !branch.slides;
            (turns_base || !upstream.is_empty()).then(|| BranchMotion {
                slides: branch.slides,
                carries_base: branch.carries_base,
                upstream,
                ..motion.clone()
            })
        };
        found.iter().filter_map(of_branch).collect()
    }

    fn has_all(&self, names: &[String]) -> bool {
        names.len() == self.names.len() && names.iter().all(|name| self.names.contains(name))
    }

    /// For each joint of the robot the series that is its; none if they are in its order already.
    fn places(&self, path: &Path, recorded: &RecordedJoints) -> Result<Option<Vec<usize>>, RecordingError> {
        let names = match recorded {
            RecordedJoints::Named(names) if !self.names.is_empty() => names,
            RecordedJoints::Stated(names) if self.has_all(names) => names,
            _ => return Ok(None),
        };
        let places = places(&self.names, names).map_err(|lacking| RecordingError::JointNames {
            path: path.to_owned(),
            recorded: names.clone(),
            wanted: self.names.clone(),
            lacking,
        })?;
        Ok(Some(places)
            .filter(|p| p.len() != names.len() || p.iter().enumerate().any(|(k, place)| k != *place)))
    }
}

/// The place of each wanted name among names, or those that are not there once and only once.
pub(crate) fn places(wanted: &[String], names: &[String]) -> Result<Vec<usize>, Vec<String>> {
    let place = |wanted: &String| {
        let mut places = names.iter().enumerate().filter(|(_, name)| *name == wanted).map(|(k, _)| k);
        places.next().filter(|_| places.next().is_none())
    };
    let lacking: Vec<String> = wanted.iter().filter(|name| place(name).is_none()).cloned().collect();
    if lacking.is_empty() { Ok(wanted.iter().filter_map(place).collect()) } else { Err(lacking) }
}

impl Recording {
    /// The same recording with the series of a robot's joints alone, in the robot's order: matched by name where both have
    /// names, else as they are.
    ///
    /// # Errors
    /// [`RecordingError::JointNames`] if the recording lacks a joint of the robot; [`RecordingError::Count`] if nothing has
    /// names and the numbers of joints differ.
    pub fn of_robot(mut self, robot: &RobotJoints) -> Result<RobotRecording, RecordingError> {
        if let Some(places) = robot.places(&self.file, &self.joints)? {
            self.track_branches(robot);
            let families =
                [Some(&mut self.position_rad), self.velocity_rad_s.as_mut(), self.measurement.as_mut()];
            for family in families.into_iter().flatten() {
                *family = places.iter().map(|place| family[*place].clone()).collect();
            }
            self.report.remarks.push(format!("joints by name, in this order: {}", robot.names.join(", ")));
        } else if self.joints() != robot.count {
            let names = self.joints.names();
            let named = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
            return Err(RecordingError::count(
                format!("{}: joints{named}", self.file.display()),
                robot.count,
                self.joints(),
            ));
        }
        if !robot.names.is_empty() {
            self.joints = RecordedJoints::Named(robot.names.clone());
        }
        let noise_nm: Vec<f64> = match &self.measurement {
            Some(measurement)
                if self.unit == MeasurementUnit::NewtonMetre && !self.report.branches.is_empty() =>
            {
                measurement.iter().map(|series| white_level_at(&self.time_s, series)).collect()
            }
            _ => Vec::new(),
        };
        self.report.branches = robot.moving(&self.report.branches, &noise_nm);
        Ok(RobotRecording(self))
    }

    /// Looks at the series that are of joints beside the robot's chain.
    fn track_branches(&mut self, robot: &RobotJoints) {
        let beside = self.joints.names().iter().zip(&self.position_rad);
        let beside = beside.filter(|(name, _)| robot.branches.iter().any(|branch| branch.joint == **name));
        let moving = beside.filter_map(|(name, position_rad)| {
            let mut track = BranchTrack::new(name.clone());
            self.time_s.iter().zip(position_rad).for_each(|(t, q)| track.add(*t, *q));
            track.motion()
        });
        let moving: Vec<_> = moving.collect();
        self.report.branches.extend(moving);
    }

    /// The same with names for its joints, series after series.
    ///
    /// # Errors
    /// [`RecordingError::Count`] if there is not one for each joint.
    pub fn with_joint_names(self, names: Vec<String>) -> Result<Self, RecordingError> {
        if names.len() != self.joints() {
            let what = format!("{}: joint names", self.file.display());
            return Err(RecordingError::Count { what, expected: self.joints(), found: names.len() });
        }
        Ok(Self { joints: RecordedJoints::Named(names), ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    fn recording(joints: RecordedJoints) -> Recording {
        let position = (0..joints.names().len().max(2)).map(|j| vec![j as f64; 2]).collect();
        Recording { joints, ..Recording::from_arrays(vec![0.0, 1.0], position).unwrap() }
    }

    fn order(recording: &Recording) -> Vec<f64> {
        recording.position_rad.iter().map(|series| series[0]).collect()
    }

    #[test]
    fn series_are_matched_by_name_where_both_sides_have_names() {
        let robot = RobotJoints { names: names(&["a", "b"]), ..2.into() };
        let of = |joints| recording(joints).of_robot(&robot);
        assert_eq!(order(&of(RecordedJoints::Named(names(&["c", "b", "a"]))).unwrap()), [2.0, 1.0]);
        assert_eq!(order(&of(RecordedJoints::Stated(names(&["b", "a"]))).unwrap()), [1.0, 0.0]);
        // Stated names that are not the robot's say which is which by their order.
        let stated = of(RecordedJoints::Stated(names(&["y", "x"]))).unwrap();
        assert_eq!((order(&stated), stated.joints.names()), (vec![0.0, 1.0], robot.names.as_slice()));
        assert_eq!(order(&of(RecordedJoints::Unnamed).unwrap()), [0.0, 1.0]);
        let nameless = recording(RecordedJoints::Named(names(&["b", "a"]))).of_robot(&2.into()).unwrap();
        assert_eq!((order(&nameless), nameless.joints.names().join("")), (vec![0.0, 1.0], "ba".to_owned()));
    }

    #[test]
    fn what_cannot_be_matched_is_refused_with_both_sides() {
        let robot = RobotJoints { names: names(&["elbow_joint", "b"]), ..2.into() };
        for recorded in [&["b", "elbow_jiont"][..], &["b", "elbow_joint", "elbow_joint"]] {
            let error = recording(RecordedJoints::Named(names(recorded))).of_robot(&robot).unwrap_err();
            let text = error.to_string();
            assert!(text.contains(&recorded.join(", ")) && text.contains("elbow_joint, b"), "{text}");
            assert!(text.contains("joint_names"), "{text}");
        }
        assert!(recording(RecordedJoints::Unnamed).of_robot(&3.into()).is_err());
    }
}
