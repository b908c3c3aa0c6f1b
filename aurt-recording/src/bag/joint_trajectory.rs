//! `trajectory_msgs/msg/JointTrajectory` in CDR: the points of a planned motion as states of its joints.
//!
//! Source: ROS 2, `trajectory_msgs/msg/JointTrajectory.msg`, `JointTrajectoryPoint.msg`.

use crate::bag::cdr::{BREAKS_OFF, CdrBody};
use crate::bag::joint_state::JointState;

/// A message whose points are read one by one.
#[derive(Debug, Default)]
pub(super) struct JointTrajectory {
    message: Vec<u8>,
    /// Place of the next point, and points that are left.
    at: usize,
    left: u32,
    /// `header.stamp`, in ns, which the points count from.
    begin_ns: i64,
    accelerations: Vec<f64>,
}

impl JointTrajectory {
    /// Takes a message, and gives the bytes of the one before in exchange; `state` receives the names.
    pub(super) fn begin(
        &mut self,
        message: &mut Vec<u8>,
        state: &mut JointState,
    ) -> Result<(), &'static str> {
        std::mem::swap(&mut self.message, message);
        self.left = 0;
        let mut body = CdrBody::of(&self.message)?;
        self.begin_ns = body.time_ns().ok_or(BREAKS_OFF)?;
        body.text().ok_or(BREAKS_OFF)?;
        state.name(&mut body)?;
        self.left = body.word().ok_or(BREAKS_OFF)?;
        self.at = body.at;
        Ok(())
    }

    /// Takes the next point: its positions and velocities, at its time; false after the last.
    pub(super) fn next(&mut self, state: &mut JointState) -> Result<bool, &'static str> {
        if self.left == 0 {
            return Ok(false);
        }
        let mut body = CdrBody::of(&self.message)?.from(self.at);
        let mut take = || {
            body.numbers(&mut state.position)?;
            body.numbers(&mut state.velocity)?;
            body.numbers(&mut self.accelerations)?;
            // Efforts of a plan are commands.
            body.numbers(&mut state.effort)?;
            body.time_ns()
        };
        let time_ns = take().ok_or(BREAKS_OFF)?;
        state.bounded()?;
        state.effort.clear();
        state.stamp_ns = self.begin_ns.saturating_add(time_ns);
        (self.at, self.left) = (body.at, self.left - 1);
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bag::cdr::CdrBody;

    /// A message in which joint `a1` is to be at 2 rad with −3 rad/s and 4 rad/s² after 1.5 s, and at 5 rad after 2 s.
    fn message() -> Vec<u8> {
        let mut bytes = vec![0, 1, 0, 0];
        let words = |bytes: &mut Vec<u8>, all: &[u32]| all.iter().for_each(|w| bytes.extend(w.to_le_bytes()));
        words(&mut bytes, &[1, 0, 1, 0, 1, 3]);
        bytes.extend(b"a1\0\0");
        words(&mut bytes, &[2]);
        for value in [2.0_f64, -3.0, 4.0] {
            words(&mut bytes, &[1]);
            bytes.resize(4 + (bytes.len() - 4).next_multiple_of(8), 0);
            bytes.extend(value.to_le_bytes());
        }
        words(&mut bytes, &[0, 1, 500_000_000, 1]);
        bytes.resize(4 + (bytes.len() - 4).next_multiple_of(8), 0);
        bytes.extend(5.0_f64.to_le_bytes());
        words(&mut bytes, &[0, 0, 0, 2, 0]);
        bytes
    }

    #[test]
    fn points_are_states_at_their_times() {
        let (mut trajectory, mut state) = (JointTrajectory::default(), JointState::default());
        trajectory.begin(&mut message(), &mut state).unwrap();
        assert!(trajectory.next(&mut state).unwrap());
        assert_eq!((state.stamp_ns, state.names.as_slice()), (2_500_000_000, &["a1".to_owned()][..]));
        assert_eq!((&state.position, &state.velocity), (&vec![2.0], &vec![-3.0]));
        assert!(trajectory.accelerations == [4.0] && state.effort.is_empty());
        assert!(trajectory.next(&mut state).unwrap());
        assert_eq!((state.stamp_ns, &state.position), (3_000_000_000, &vec![5.0]));
        assert!(state.velocity.is_empty() && !trajectory.next(&mut state).unwrap());
    }

    #[test]
    fn a_message_may_break_off_anywhere() {
        for end in 0..message().len() {
            let (mut trajectory, mut state) = (JointTrajectory::default(), JointState::default());
            let mut cut = message()[..end].to_vec();
            let mut read = || {
                trajectory.begin(&mut cut, &mut state)?;
                while trajectory.next(&mut state)? {}
                Ok::<(), &str>(())
            };
            assert!(read().is_err(), "{end}");
        }
        let body = message();
        assert!(CdrBody::of(&body[..3]).is_err());
    }

    #[test]
    fn a_planned_motion_is_read_with_its_accelerations() {
        let motion = crate::PlannedMotion {
            joint_names: vec!["shoulder".into(), "elbow".into()],
            time_s: vec![0.0, 1.0 / 3.0],
            position_rad: vec![vec![0.1, 0.2], vec![-0.3, f64::MIN_POSITIVE]],
            velocity_rad_s: vec![vec![1.1, 1.2], vec![-1.3, 0.0]],
            acceleration_rad_s2: vec![vec![2.1, 2.2], vec![-2.3, -0.0]],
        };
        let file = motion.to_mcap(std::path::Path::new("a.mcap")).unwrap();
        let messages: Vec<_> = mcap::MessageStream::new(&file).unwrap().collect::<Result<_, _>>().unwrap();
        let [message] = messages.as_slice() else { panic!("{} messages", messages.len()) };
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!(
            (schema.name.as_str(), schema.encoding.as_str()),
            ("trajectory_msgs/msg/JointTrajectory", "ros2msg")
        );
        let (mut trajectory, mut state) = (JointTrajectory::default(), JointState::default());
        trajectory.begin(&mut message.data.to_vec(), &mut state).unwrap();
        assert_eq!(state.names, motion.joint_names);
        for (k, time_ns) in [0, 333_333_333].into_iter().enumerate() {
            assert!(trajectory.next(&mut state).unwrap());
            let of =
                |series: &[Vec<f64>]| series.iter().map(|values| values[k].to_bits()).collect::<Vec<_>>();
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(state.stamp_ns, time_ns);
            assert_eq!(bits(&state.position), of(&motion.position_rad));
            assert_eq!(bits(&state.velocity), of(&motion.velocity_rad_s));
            assert_eq!(bits(&trajectory.accelerations), of(&motion.acceleration_rad_s2));
        }
        assert!(!trajectory.next(&mut state).unwrap());
    }
}
