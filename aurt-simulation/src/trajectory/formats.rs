use std::path::Path as File;

use super::{MOST_ROWS, Trajectory};
use crate::error::{Complaints, SimulationError};

/// Look-ahead and gain of `servoj`: the middle of the ranges in the URScript manual.
const SERVO: &str = "lookahead_time=0.1, gain=300";

impl Trajectory {
    /// The motion in the format that a file's name ends with, `rate_hz` rows per second: a CSV table (`.csv`), the goal of a
    /// `FollowJointTrajectory` action of ROS 2 (`.yaml`), or a URScript program of `servoj` commands (`.script`).
    ///
    /// # Errors
    /// [`SimulationError::Value`] for a rate that is not positive, and for another name.
    pub fn formatted(
        &self,
        file: &File,
        rate_hz: f64,
        joint_names: &[String],
    ) -> Result<Vec<u8>, SimulationError> {
        match file.extension().and_then(|ending| ending.to_str()) {
            Some("yaml" | "yml") => self.goal(rate_hz, joint_names),
            Some("script") => self.ur_script(rate_hz),
            _ => self.csv(rate_hz),
        }
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
        let name = |j: usize| joint_names.get(j).cloned().unwrap_or_else(|| format!("joint{}", j + 1));
        let names: Vec<String> = (0..self.joints()).map(|j| format!("{:?}", name(j))).collect();
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
}
