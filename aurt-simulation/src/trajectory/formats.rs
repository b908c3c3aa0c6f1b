use std::path::Path as File;

use aurt_recording::PlannedMotion;

use super::{MOST_ROWS, Trajectory};
use crate::error::{Complaints, SimulationError};

/// Look-ahead and gain of `servoj`: the middle of the ranges in the URScript manual.
const SERVO: &str = "lookahead_time=0.1, gain=300";

impl Trajectory {
    /// The motion in the format that a file's name ends with, `rate_hz` rows per second: the goal of a `FollowJointTrajectory`
    /// action of ROS 2 (`.yaml`), a URScript program of `servoj` commands (`.script`), a bag of ROS 2 with a
    /// `trajectory_msgs/msg/JointTrajectory` (`.mcap`), else a CSV table.
    ///
    /// # Errors
    /// [`SimulationError::Value`] for a rate that is not positive; [`SimulationError::Recording`] for a bag that cannot be written.
    pub fn formatted(
        &self,
        file: &File,
        rate_hz: f64,
        joint_names: &[String],
    ) -> Result<Vec<u8>, SimulationError> {
        match file.extension().and_then(|ending| ending.to_str()) {
            Some("yaml" | "yml") => self.goal(rate_hz, joint_names),
            Some("script") => self.ur_script(rate_hz),
            Some("mcap") => Ok(self.planned(rate_hz, joint_names)?.to_mcap(file)?),
            _ => self.csv(rate_hz),
        }
    }

    /// The motion as rows, `rate_hz` of them per second; joints without names are `joint1`, `joint2`, ….
    ///
    /// # Errors
    /// [`SimulationError::Value`] for a rate that is not positive.
    pub fn planned(&self, rate_hz: f64, joint_names: &[String]) -> Result<PlannedMotion, SimulationError> {
        let series = || vec![Vec::new(); self.joints()];
        let mut motion = PlannedMotion {
            joint_names: self.names(joint_names),
            time_s: Vec::new(),
            position_rad: series(),
            velocity_rad_s: series(),
            acceleration_rad_s2: series(),
        };
        self.rows(rate_hz, |time_s, q, qd, qdd| {
            motion.time_s.push(time_s);
            let all = [&mut motion.position_rad, &mut motion.velocity_rad_s, &mut motion.acceleration_rad_s2];
            for (series, row) in all.into_iter().zip([q, qd, qdd]) {
                series.iter_mut().zip(row).for_each(|(values, value)| values.push(*value));
            }
        })?;
        Ok(motion)
    }

    fn names(&self, known: &[String]) -> Vec<String> {
        let name = |j: usize| known.get(j).cloned().unwrap_or_else(|| format!("joint{}", j + 1));
        (0..self.joints()).map(name).collect()
    }

    /// The motion as a CSV table, `rate_hz` rows per second: `time, q_0, …, qd_0, …, qdd_0, …`.
    ///
    /// # Errors
    /// [`SimulationError::Value`] for a rate that is not positive.
    pub fn csv(&self, rate_hz: f64) -> Result<Vec<u8>, SimulationError> {
        let n = self.joints();
        let mut text = String::from("time");
        for family in ["q", "qd", "qdd"] {
            text.extend((0..n).map(|j| format!(",{family}_{j}")));
        }
        text.push('\n');
        self.rows(rate_hz, |time_s, q, qd, qdd| {
            text.push_str(&format!("{time_s:.6}"));
            text.extend(q.iter().chain(qd).chain(qdd).map(|x| format!(",{x:.9}")));
            text.push('\n');
        })?;
        Ok(text.into_bytes())
    }

    /// The goal of `control_msgs/action/FollowJointTrajectory`, for `ros2 action send_goal`.
    fn goal(&self, rate_hz: f64, joint_names: &[String]) -> Result<Vec<u8>, SimulationError> {
        let names: Vec<String> = self.names(joint_names).iter().map(|name| format!("{name:?}")).collect();
        let mut text = format!("trajectory:\n  joint_names: [{}]\n  points:\n", names.join(", "));
        self.rows(rate_hz, |time_s, q, qd, qdd| {
            let [q, qd, qdd] = [q, qd, qdd].map(list);
            let nanoseconds = (time_s * 1e9).round() as u64;
            let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
            text.push_str(&format!(
                "  - {{positions: [{q}], velocities: [{qd}], accelerations: [{qdd}], time_from_start: {{sec: {sec}, nanosec: \
                 {nanosec}}}}}\n"
            ));
        })?;
        Ok(text.into_bytes())
    }

    fn ur_script(&self, rate_hz: f64) -> Result<Vec<u8>, SimulationError> {
        let mut text = String::from("def aurt_motion():\n");
        let mut is_first = true;
        self.rows(rate_hz, |_, q, _, _| {
            let q = list(q);
            if is_first {
                text.push_str(&format!("  movej([{q}], a=0.5, v=0.3)\n  sleep(1.0)\n"));
            }
            is_first = false;
            text.push_str(&format!("  servoj([{q}], t={}, {SERVO})\n", 1.0 / rate_hz));
        })?;
        text.push_str("  stopj(2.0)\nend\naurt_motion()\n");
        Ok(text.into_bytes())
    }

    /// Calls `visit` with time, angles, velocities and accelerations `rate_hz` times per second.
    ///
    /// # Errors
    /// [`SimulationError::Value`] for a rate that is not positive, and for more rows than a motion may have.
    pub fn rows(
        &self,
        rate_hz: f64,
        mut visit: impl FnMut(f64, &[f64], &[f64], &[f64]),
    ) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        complaints.within("rate of the trajectory in Hz", rate_hz, 1e-3, 1e5);
        complaints.within("number of rows of the motion", self.duration_s() * rate_hz, 0.0, MOST_ROWS);
        complaints.finish()?;
        let n = self.joints();
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..=(self.duration_s() * rate_hz + 1e-9) as usize {
            let time_s = k as f64 / rate_hz;
            self.at(time_s, &mut q, &mut qd, &mut qdd);
            visit(time_s, &q, &qd, &qdd);
        }
        Ok(())
    }
}

/// Numbers with commas between them.
fn list(values: &[f64]) -> String {
    values.iter().map(|x| format!("{x:.9}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use aurt_recording::{ReadOptions, RecordedJoints, read_recording};

    use crate::{Motion, robots};

    #[test]
    fn every_format_has_every_row() {
        let motion = Motion::Sweeps { duration_s: 10.0, share: 0.5 }.plan(&robots::ur10e(), 1).unwrap();
        let lines = |file: &str| {
            let names: Vec<String> = (0..6).map(|j| format!("axis \"{j}\"")).collect();
            let text = motion.formatted(Path::new(file), 50.0, &names).unwrap();
            String::from_utf8(text).unwrap().lines().map(str::to_owned).collect::<Vec<_>>()
        };
        let (table, goal, script) = (lines("a.csv"), lines("a.yaml"), lines("a.script"));
        assert_eq!([table.len(), goal.len(), script.len()], [502, 504, 507]);
        assert!(goal[1].contains(r#""axis \"0\"", "#), "{}", goal[1]);
        assert!(goal[503].ends_with("time_from_start: {sec: 10, nanosec: 0}}"), "{}", goal[503]);
        assert!(script[3].starts_with("  servoj([") && script[3].contains("t=0.02"), "{}", script[3]);
        assert!(motion.formatted(Path::new("a.script"), -1.0, &[]).is_err());
    }

    #[test]
    fn bags_and_data_sets_are_read_to_the_bit() {
        let motion = Motion::Sweeps { duration_s: 10.0, share: 0.5 }.plan(&robots::ur10e(), 1).unwrap();
        let names: Vec<String> = (1..7).map(|j| format!("axis_{j}")).collect();
        let planned = motion.planned(125.0, &names).unwrap();
        assert_eq!((planned.time_s.len(), planned.time_s[125]), (1251, 1.0));
        let folder = tempfile::tempdir().unwrap();
        let options = ReadOptions { needs_measurement: false, accepts_plan: true, ..ReadOptions::default() };

        let bag = folder.path().join("a.mcap");
        std::fs::write(&bag, motion.formatted(&bag, 125.0, &names).unwrap()).unwrap();
        let read = read_recording(&bag, &options).unwrap();
        assert_eq!(read.joints, RecordedJoints::Named(names.clone()));
        assert_eq!(read.time_s, planned.time_s);
        assert_eq!(read.position_rad, planned.position_rad);
        assert_eq!(read.velocity_rad_s.as_ref(), Some(&planned.velocity_rad_s));
        let measured = ReadOptions { accepts_plan: false, ..options.clone() };
        let refused = read_recording(&bag, &measured).unwrap_err().to_string();
        assert!(
            refused.contains("no topic has messages of the type sensor_msgs/msg/JointState"),
            "{refused}"
        );

        let data_set = folder.path().join("a.lerobot");
        for (name, contents) in planned.to_lerobot(&data_set, 125).unwrap() {
            let file = data_set.join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, contents).unwrap();
        }
        let read = read_recording(&data_set, &options).unwrap();
        let single = |series: &[f64]| series.iter().map(|v| f64::from(*v as f32)).collect::<Vec<_>>();
        assert_eq!(read.joints, RecordedJoints::Named(names));
        assert_eq!(read.time_s, single(&planned.time_s));
        assert_eq!(read.position_rad, planned.position_rad.iter().map(|s| single(s)).collect::<Vec<_>>());
        let notes = read.report.notes().join("\n");
        assert!(notes.contains("LeRobot data set v3.0, 1 episode in 1 file, 125 frames/s"), "{notes}");
    }
}
