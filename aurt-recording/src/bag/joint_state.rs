//! `sensor_msgs/msg/JointState` in CDR.
//!
//! Source: ROS 2, `sensor_msgs/msg/JointState.msg`.

use crate::bag::cdr::{BREAKS_OFF, CdrBody, MOST_OF_MESSAGE, TOO_MANY};

/// A message: what each of its joints does, by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct JointState {
    /// `header.stamp`, in ns.
    pub(crate) stamp_ns: i64,
    /// The names as they are written, for telling fast whether they are those of another message.
    pub(crate) names_written: Vec<u8>,
    pub(crate) names: Vec<String>,
    /// Positions, rad or m.
    pub(crate) position: Vec<f64>,
    /// Velocities per second; may be empty.
    pub(crate) velocity: Vec<f64>,
    /// Efforts, Nm or N; may be empty.
    pub(crate) effort: Vec<f64>,
}

impl JointState {
    pub(crate) fn decode(&mut self, bytes: &[u8]) -> Result<(), &'static str> {
        let mut body = CdrBody::of(bytes)?;
        self.stamp_ns = body.time_ns().ok_or(BREAKS_OFF)?;
        body.text().ok_or(BREAKS_OFF)?;
        self.name(&mut body)?;
        for values in [&mut self.position, &mut self.velocity, &mut self.effort] {
            body.numbers(values).ok_or(BREAKS_OFF)?;
        }
        self.bounded()
    }

    pub(super) fn name(&mut self, body: &mut CdrBody<'_>) -> Result<(), &'static str> {
        let (start, count) = body.names()?;
        let written = body.since(start);
        if written != self.names_written || count != self.names.len() {
            self.names_written = written.to_vec();
            let mut names = body.from(start);
            self.names.clear();
            for _ in 0..count {
                self.names.push(String::from_utf8_lossy(names.text().ok_or(BREAKS_OFF)?).into_owned());
            }
        }
        Ok(())
    }

    /// Refuses more values than a machine has joints.
    pub(super) fn bounded(&self) -> Result<(), &'static str> {
        let most = self.position.len().max(self.velocity.len()).max(self.effort.len());
        if most > MOST_OF_MESSAGE { Err(TOO_MANY) } else { Ok(()) }
    }

    pub(super) fn bytes(&self) -> usize {
        let names = self.names.len() * size_of::<String>() + 2 * self.names_written.len();
        names + size_of::<f64>() * (self.position.len() + self.velocity.len() + self.effort.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A message of one joint `a1` at 1.5 s with position 2 and effort −3, in either byte order.
    fn message(big_endian: bool) -> Vec<u8> {
        let word = |v: u32| if big_endian { v.to_be_bytes() } else { v.to_le_bytes() };
        let double = |v: f64| if big_endian { v.to_be_bytes() } else { v.to_le_bytes() };
        let mut bytes = vec![0, u8::from(!big_endian), 0, 0];
        for part in [word(1), word(500_000_000), word(1)] {
            bytes.extend(part);
        }
        bytes.extend([0; 4]); // An empty frame and the alignment after it.
        bytes.extend(word(1));
        bytes.extend(word(3));
        bytes.extend(b"a1\0\0");
        bytes.extend(word(1)); // At 28: 4 bytes of alignment follow.
        bytes.extend(double(2.0));
        bytes.extend(word(0));
        bytes.extend(word(1));
        bytes.extend(double(-3.0));
        bytes
    }

    #[test]
    fn both_byte_orders_are_decoded() {
        for big_endian in [false, true] {
            let mut state = JointState::default();
            state.decode(&message(big_endian)).unwrap();
            assert_eq!(state.stamp_ns, 1_500_000_000);
            assert_eq!(state.names, ["a1"]);
            assert_eq!((state.position, state.velocity, state.effort), (vec![2.0], vec![], vec![-3.0]));
        }
    }

    #[test]
    fn a_message_may_break_off_anywhere() {
        let whole = message(false);
        for end in 0..whole.len() {
            assert!(JointState::default().decode(&whole[..end]).is_err(), "{end}");
        }
        let mut huge = whole;
        huge[24..28].copy_from_slice(&[0xff; 4]);
        assert!(JointState::default().decode(&huge).is_err());
    }

    #[test]
    fn more_joints_than_a_machine_has_are_refused_before_they_are_held() {
        let head = [&[0, 1, 0, 0][..], &[0; 8], &[0; 4]].concat();
        let nameless = [&head[..], &4_000_000_u32.to_le_bytes(), &vec![0; 16_000_000]].concat();
        let mut state = JointState::default();
        assert!(state.decode(&nameless).unwrap_err().contains("1000 joints"));
        assert_eq!(state.names.capacity(), 0);
        let long = [&head[..], &1_u32.to_le_bytes(), &600_u32.to_le_bytes(), &[b'a'; 600]].concat();
        assert!(state.decode(&long).unwrap_err().contains("512 bytes"));
        assert!(state.names_written.is_empty());
    }
}
